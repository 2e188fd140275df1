// SPDX-License-Identifier: Zlib
#include "oracles/hard_pairs.h"

#include <array>
#include <limits>

#include "framework/support_map.h"

namespace lpc::inline LPC_PRECISION {
namespace {

constexpr std::array<std::string_view, 8> kFamilies = {
    "random", "kissing_faces", "near_parallel", "ties", "size_ratio", "slivers", "below_tolerance", "core_contact"};

Rot<2> rotation(const Vec<2>&, double angle) { return Rot<2>::angle(angle); }
Rot<3> rotation(const Vec<3>& axis, double angle) { return Rot<3>::vector(static_cast<Real>(angle) * axis); }

template <int D>
class Drawer {
 public:
  explicit Drawer(std::uint64_t seed) : m_random(seed) {}

  HardPair<D> draw(ShapeKind kindA, ShapeKind kindB, double scale) {
    const std::size_t number = m_random.below(2 * kFamilies.size()), family = number < kFamilies.size() ? number : 0;
    m_squeeze = family == 5 ? 1e-4 : 1;
    const double ratio = family == 4 ? pick({1e-2, 1e-3, 1e-4}) : 1;
    HardPair<D> pair{shape(kindA, scale), shape(kindB, ratio * scale), {}, kFamilies[family]};
    const ShapeView<D>&a = pair.a.view(), &b = pair.b.view();
    const double size = boundingRadius(b) + boundingRadius(a);
    pair.X_AB.q = rotation(direction(), m_random.uniform(-3.14159, 3.14159));
    switch (family) {
      case 1: {  // equal orientation, the gap a few last bits
        pair.X_AB.q = Rot<D>{};
        touch(pair, Vec<D>::Unit(static_cast<int>(m_random.below(D))), size * eps() * pick({0, 1, -1, 4, -4}));
        break;
      }
      case 2:
        pair.X_AB.q = rotation(direction(), pick({0, 1e-15, 1e-12, 1e-9, 1e-6, 1e-3}));
        touch(pair, Vec<D>::Unit(static_cast<int>(m_random.below(D))), size * m_random.uniform(-0.1, 0.1));
        break;
      case 3:
        pair.X_AB.q = Rot<D>{};
        if (m_random.below(2)) touch(pair, Vec<D>::Ones().normalized(), -size * pick({0, 0.1, 0.5}));
        break;
      case 6:
        touch(pair, direction(), size * pick({1e-6, -1e-6, 1e-9, -1e-9, 1e-12}));
        break;
      case 7:
        pair.X_AB.p = pick({0, 0.5, 1}) * static_cast<Real>(1) * coreSupport(a, direction());
        break;
      default:
        if (m_random.below(2)) {
          touch(pair, direction(), m_random.uniform(-0.3, 0.3) * (family ? boundingRadius(b) : size));
        } else {
          pair.X_AB.p = static_cast<Real>(m_random.uniform(0, 1.2) * size) * direction();
        }
        break;
    }
    return pair;
  }

 private:
  static double eps() { return static_cast<double>(std::numeric_limits<Real>::epsilon()); }
  Real pick(std::initializer_list<double> values) {
    return static_cast<Real>(values.begin()[m_random.below(values.size())]);
  }
  Vec<D> direction() {
    Vec<D> v;
    do {
      for (int k = 0; k < D; ++k) v[k] = static_cast<Real>(m_random.uniform(-1, 1));
    } while (!(v.norm() > Real(0.01) && v.norm() <= 1));
    return v.normalized();
  }
  Real length(double scale) { return static_cast<Real>(scale * m_random.uniform(0.1, 1)); }
  Vec<D> half(double scale) {
    Vec<D> h;
    for (int k = 0; k < D; ++k) h[k] = length(scale);
    h[static_cast<int>(m_random.below(D))] *= static_cast<Real>(m_squeeze);
    return h;
  }

  Shape<D> shape(ShapeKind kind, double scale) {
    const Real rounding = m_random.below(4) == 0 ? length(scale) / 4 : Real(0);
    switch (kind) {
      case ShapeKind::sphere:
        return Shape<D>::sphere(length(scale));
      case ShapeKind::capsule: {
        const Real l = length(scale);
        return Shape<D>::capsule(l, length(scale) / 2);
      }
      case ShapeKind::segment:
        return Shape<D>::segment(length(scale));
      case ShapeKind::box:
        return Shape<D>::box(half(scale), rounding);
      case ShapeKind::polytope:
        break;
    }
    // A simplex, so that there is a volume, and up to twelve more points.
    const Vec<D> h = half(scale);
    std::vector<Vec<D>> points(1, -h);
    for (int k = 0; k < D; ++k) {
      points.push_back(-h);
      points.back()[k] = 2 * h[k];
    }
    for (std::uint64_t n = m_random.below(13); n > 0; --n) points.push_back(h.cwiseProduct(direction()) * Real(1.5));
    return Shape<D>::polytope(std::span<const Vec<D>>(points), rounding);
  }

  // Puts B so that its lowest point along n lies `gap` above A's highest one.
  void touch(HardPair<D>& pair, const Vec<D>& n, double gap) {
    const ShapeView<D>&a = pair.a.view(), &b = pair.b.view();
    const Vec<D> top = coreSupport(a, n) + a.radius * n;
    const Vec<D> bottom = pair.X_AB.q * coreSupport(b, Vec<D>(pair.X_AB.q.inverse() * Vec<D>(-n))) - b.radius * n;
    pair.X_AB.p = top - bottom + static_cast<Real>(gap) * n;
  }

  Random m_random;
  double m_squeeze = 1;
};

}  // namespace

template <int D>
HardPair<D> hardPair(ShapeKind a, ShapeKind b, double scale, std::uint64_t seed, int index) {
  const auto kinds = static_cast<std::uint64_t>(static_cast<int>(a) * kShapeKinds + static_cast<int>(b));
  Random stream(seed * 1000003 + kinds * 7919 + static_cast<std::uint64_t>(index));
  return Drawer<D>(stream.next()).draw(a, b, scale);
}

template HardPair<2> hardPair(ShapeKind, ShapeKind, double, std::uint64_t, int);
template HardPair<3> hardPair(ShapeKind, ShapeKind, double, std::uint64_t, int);

}  // namespace lpc::inline LPC_PRECISION
