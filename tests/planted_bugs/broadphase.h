// SPDX-License-Identifier: Zlib
// Wrong twins of the naive broadphase, each with a mistake that real ones had. The conformance test must refuse them.
#pragma once

#include "framework/stage_broadphase.h"

namespace lpc::inline LPC_PRECISION::test {

/// Reports what `meet` and the filters let through; the twins change one of the two.
template <int D>
class PlantedBug : public Broadphase<D> {
 public:
  void findPairs(const Proxies<D>& proxies, std::vector<ProxyPair>& out, Work&) override {
    for (ProxyId a = 0; a < proxies.size(); ++a) {
      for (ProxyId b = a + 1; b < proxies.size(); ++b) {
        if (meet(proxies, a, b) && filter(proxies, a, b)) out.push_back({a, b});
      }
    }
  }

 protected:
  virtual bool meet(const Proxies<D>& proxies, ProxyId a, ProxyId b) { return proxies.boxesOverlap(a, b); }
  virtual bool filter(const Proxies<D>& proxies, ProxyId a, ProxyId b) { return proxies.mayCollide(a, b); }
};

/// `<` for `<=`: boxes that only touch are missed.
template <int D>
class OpenBoxes final : public PlantedBug<D> {
  bool meet(const Proxies<D>& proxies, ProxyId a, ProxyId b) override {
    const Aabb<D> p = proxies.box(a), q = proxies.box(b);
    return (p.lo.array() < q.hi.array()).all() && (q.lo.array() < p.hi.array()).all();
  }
};

/// A tree that never compares what stands in its root, across the centre, with what stands below.
template <int D>
class ForgetsCenterLine final : public PlantedBug<D> {
  bool meet(const Proxies<D>& proxies, ProxyId a, ProxyId b) override {
    const auto crosses = [&](ProxyId i) {
      return proxies.lo[0][static_cast<std::size_t>(i)] <= 0 && proxies.hi[0][static_cast<std::size_t>(i)] >= 0;
    };
    return proxies.boxesOverlap(a, b) && crosses(a) == crosses(b);
  }
};

/// Keeps its own boxes and overlooks that a slot can have a new tenant between two updates.
template <int D>
class StaleSlot final : public PlantedBug<D> {
 public:
  void update(const Proxies<D>& proxies, const ProxyChanges& changes) override {
    m_boxes.resize(static_cast<std::size_t>(proxies.size()));
    m_known.resize(m_boxes.size());
    for (ProxyId i : changes.added) {
      const auto k = static_cast<std::size_t>(i);
      if (!m_known[k]) m_boxes[k] = proxies.box(i), m_known[k] = true;
    }
    for (ProxyId i : changes.moved) {
      const auto k = static_cast<std::size_t>(i);
      if (!std::count(changes.added.begin(), changes.added.end(), i)) m_boxes[k] = proxies.box(i);
    }
    for (ProxyId i : changes.removed) {
      if (proxies.isFree(i)) m_known[static_cast<std::size_t>(i)] = false;
    }
  }

 private:
  bool meet(const Proxies<D>&, ProxyId a, ProxyId b) override {
    return m_boxes[static_cast<std::size_t>(a)].overlaps(m_boxes[static_cast<std::size_t>(b)]);
  }
  std::vector<Aabb<D>> m_boxes;
  std::vector<bool> m_known;
};

/// A grid that reports a pair in every cell in which the two meet; here the cells are 4 m wide, along x.
template <int D>
class Duplicates final : public PlantedBug<D> {
 public:
  void findPairs(const Proxies<D>& proxies, std::vector<ProxyPair>& out, Work& work) override {
    PlantedBug<D>::findPairs(proxies, out, work);
    for (std::size_t k = 0, n = out.size(); k < n; ++k) {
      const Aabb<D> a = proxies.box(out[k].a), b = proxies.box(out[k].b);
      if (std::floor(std::max(a.lo[0], b.lo[0]) / 4) < std::floor(std::min(a.hi[0], b.hi[0]) / 4))
        out.push_back(out[k]);
    }
  }
};

/// Reports pairs of which neither is awake.
template <int D>
class WakesTheDead final : public PlantedBug<D> {
  bool filter(const Proxies<D>& proxies, ProxyId a, ProxyId b) override {
    const auto i = static_cast<std::size_t>(a), j = static_cast<std::size_t>(b);
    return proxies.body[i] != proxies.body[j] && (proxies.category[i] & proxies.mask[j]) &&
           (proxies.category[j] & proxies.mask[i]);
  }
};

/// Claims to be conservative with spheres inside the boxes instead of around them.
template <int D>
class InnerSpheres final : public PlantedBug<D> {
  bool meet(const Proxies<D>& proxies, ProxyId a, ProxyId b) override {
    const Aabb<D> p = proxies.box(a), q = proxies.box(b);
    const Real reach = ((p.hi - p.lo).minCoeff() + (q.hi - q.lo).minCoeff()) / 2;
    return (p.center() - q.center()).squaredNorm() <= reach * reach;
  }
};

}  // namespace lpc::inline LPC_PRECISION::test
