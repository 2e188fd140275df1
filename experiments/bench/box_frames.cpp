// SPDX-License-Identifier: Zlib
#include "experiments/bench/box_frames.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "framework/math/random.h"

namespace lpc { inline namespace LPC_PRECISION { namespace bench {
namespace {

// Of unit variance, without libm, which has other last bits on other machines.
double normal(Random& random) {
  double sum = 0;
  for (int k = 0; k < 12; ++k) sum += random.uniform();
  return sum - 6;
}

template <int D>
void put(Proxies<D>& proxies, int i, const Vec<D>& center, Real size) {
  const auto k = static_cast<std::size_t>(i);
  proxies.setBox(i, {center.array() - size / 2, center.array() + size / 2});
  proxies.active[k] = 1, proxies.body[k] = i, proxies.category[k] = proxies.mask[k] = 1;
}

template <int D>
std::vector<ProxyPair> sweepAll(const Proxies<D>& proxies) {
  std::vector<ProxyId> order(static_cast<std::size_t>(proxies.size()));
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = static_cast<ProxyId>(k);
  const auto& lo = proxies.lo[0];
  std::sort(order.begin(), order.end(),
            [&](ProxyId a, ProxyId b) { return lo[static_cast<std::size_t>(a)] < lo[static_cast<std::size_t>(b)]; });
  std::vector<ProxyPair> pairs;
  for (std::size_t k = 0; k < order.size(); ++k) {
    const Real end = proxies.hi[0][static_cast<std::size_t>(order[k])];
    for (std::size_t l = k + 1; l < order.size() && lo[static_cast<std::size_t>(order[l])] <= end; ++l) {
      if (!proxies.boxesOverlap(order[k], order[l])) continue;
      pairs.push_back({std::min(order[k], order[l]), std::max(order[k], order[l])});
    }
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

template <int D>
Proxies<D> uniformBoxes(int count) {
  Random random(1);
  Proxies<D> proxies;
  proxies.resize(count);
  const double side = std::pow(count * std::pow(2.0, D) / 5, 1.0 / D);
  for (int i = 0; i < count; ++i) {
    Vec<D> center;
    for (int d = 0; d < D; ++d) center[d] = static_cast<Real>(random.uniform(0, side));
    put<D>(proxies, i, center, Real(1));
  }
  return proxies;
}

// The same boxes at the same positions, scaled by `spread`.
template <int D>
Proxies<D> clusteredBoxes(int count, double spread) {
  Random random(2);
  Proxies<D> proxies;
  proxies.resize(count);
  std::vector<Vec<D>> clusters(static_cast<std::size_t>(std::max(8, count / 200)));
  const double side = 10 * std::pow(static_cast<double>(clusters.size()), 1.0 / D);
  for (Vec<D>& c : clusters) {
    for (int d = 0; d < D; ++d) c[d] = static_cast<Real>(random.uniform(0, side));
  }
  for (int i = 0; i < count; ++i) {
    Vec<D> center = clusters[random.below(clusters.size())];
    const Real size = static_cast<Real>(0.1 * std::pow(100.0, random.uniform()));
    for (int d = 0; d < D; ++d) center[d] = static_cast<Real>(spread * (center[d] + 2 * normal(random)));
    put<D>(proxies, i, center, size);
  }
  return proxies;
}

template <int D>
Proxies<D> clusteredBoxes(int count) {
  double lo = 0.01, hi = 100;
  for (int k = 0; k < 24; ++k) {
    const double middle = std::sqrt(lo * hi);
    const double pairs = static_cast<double>(sweepAll(clusteredBoxes<D>(count, middle)).size());
    if (std::abs(pairs - 2.5 * count) < 0.01 * count) return clusteredBoxes<D>(count, middle);
    (pairs > 2.5 * count ? lo : hi) = middle;
  }
  return clusteredBoxes<D>(count, std::sqrt(lo * hi));
}

}  // namespace

template <int D>
BoxFrames<D>::BoxFrames(BoxLayout layout, int count)
    : m_proxies(layout == BoxLayout::uniform ? uniformBoxes<D>(count) : clusteredBoxes<D>(count)) {
  Random random(3);
  for (int i = 0; i < count; ++i) {
    Vec<D> direction;
    for (int d = 0; d < D; ++d) direction[d] = static_cast<Real>(normal(random));
    const Aabb<D> box = m_proxies.box(i);
    m_step.push_back(direction * (Real(0.02) * (box.hi[0] - box.lo[0]) / direction.norm()));
    m_all.push_back(i);
  }
}

template <int D>
void BoxFrames<D>::advance() {
  const Real sign = m_frame++ / 10 % 2 == 0 ? Real(1) : Real(-1);
  for (std::size_t d = 0; d < D; ++d) {
    for (std::size_t i = 0; i < m_step.size(); ++i) {
      const Real step = sign * m_step[i][static_cast<Eigen::Index>(d)];
      m_proxies.lo[d][i] += step, m_proxies.hi[d][i] += step;
    }
  }
}

template <int D>
std::vector<ProxyPair> BoxFrames<D>::pairs() const {
  return sweepAll(m_proxies);
}

template <int D>
BoxFrames<D> boxFrames(BoxLayout layout, int count) {
  static std::map<std::pair<BoxLayout, int>, BoxFrames<D>> made;
  const auto key = std::pair(layout, count);
  auto it = made.find(key);
  if (it == made.end()) it = made.emplace(key, BoxFrames<D>(layout, count)).first;
  return it->second;
}

template class BoxFrames<2>;
template class BoxFrames<3>;
template BoxFrames<2> boxFrames(BoxLayout, int);
template BoxFrames<3> boxFrames(BoxLayout, int);

}}}  // namespace lpc::LPC_PRECISION::bench
