// SPDX-License-Identifier: Zlib
#include <algorithm>
#include <numbers>

#include "framework/shape/curved_core.h"
#include "framework/shape/curved_ray.h"

namespace lpc { inline namespace LPC_PRECISION { namespace {

// A solid ellipsoid with its axes along the frame's axes; in 2D an ellipse.
template <int D>
class Ellipsoid final : public CurvedBase<D, Ellipsoid<D>>, public ExactRays<D> {
 public:
  explicit Ellipsoid(std::span<const Real> sizes) {
    for (std::size_t k = 0; k < m_sizes.size(); ++k) m_sizes[k] = sizes[k];
  }

  std::span<const Real> sizes() const override { return m_sizes; }
  Vec<D> half() const override { return Eigen::Map<const Eigen::Matrix<Real, D, 1>>(m_sizes.data()); }

  // The sphere's support point, mapped by the stretch that makes the ellipsoid: p = S (S d) / |S d|.
  template <class N>
  CorePoint<N, D> extreme(const CorePoint<N, D>& d) const {
    CorePoint<N, D> p = d;
    N largest = 0, square = 0;
    for (std::size_t k = 0; k < p.size(); ++k) p[k] *= m_sizes[k], largest = std::max(largest, std::abs(p[k]));
    if (!(largest > 0)) return {m_sizes[0]};
    for (N& x : p) x /= largest, square += x * x;
    const N length = std::sqrt(square);
    for (std::size_t k = 0; k < p.size(); ++k) p[k] = m_sizes[k] * (p[k] / length);
    return p;
  }

  void supportFace(const Vec<D>& d, std::vector<Vec<D>>& corners) const override {
    corners.assign(1, this->support(d));
  }

  MassProperties<D> massProperties(Real density) const override {
    double volume = D == 2 ? std::numbers::pi : 4 * std::numbers::pi / 3, squares = 0;
    for (const Real a : m_sizes) volume *= a, squares += double(a) * a;
    MassProperties<D> m;
    m.mass = static_cast<Real>(density * volume);
    for (int k = 0; k < kAngDim<D>; ++k) {  // in 2D about z, which is not an axis of the ellipse
      const double own = D == 2 ? 0 : double(m_sizes[k]);
      m.inertia(k, k) = static_cast<Real>(density * volume * (squares - own * own) / (D + 2));
    }
    return m;
  }

  // The unit ball's ray, in the space where the ellipsoid is that ball.
  RayEntry<D> ray(const Vec<D>& p, const Vec<D>& d) const override {
    const Vec<D> m = p.cwiseQuotient(half()), u = d.cwiseQuotient(half());
    const Real uu = u.squaredNorm(), middle = -m.dot(u) / uu;
    const Vec<D> closest = m + middle * u;
    const Real aside = closest.norm();
    RaySpan<D> span;
    if (!(aside <= 1)) {
      span.never();
    } else {
      const Real back = std::sqrt((1 - aside) * (1 + aside) / uu);
      span.from(middle - back, Vec<D>(closest - back * u).cwiseQuotient(half()).normalized());
      span.until(middle + back);
    }
    return span.entry();
  }
  // The nearest point is x = S^2 p / (S^2 + s) with s >= 0 (Eberly 2013); |x / S| - 1 falls with s and is convex, so
  // Newton's steps never pass the root.
  Vec<D> outwards(const Vec<D>& p) const override {
    const Vec<D> squares = half().cwiseAbs2();
    Real s = std::max(Real(0), Vec<D>(p.cwiseAbs().cwiseProduct(half()) - squares).maxCoeff());
    for (int step = 0; step < kMostNearestSteps; ++step) {
      const Vec<D> below = squares + Vec<D>::Constant(s);
      const Vec<D> unit = p.cwiseProduct(half()).cwiseQuotient(below);
      const Real fall = 2 * unit.cwiseAbs2().cwiseQuotient(below).sum(), next = s + (unit.squaredNorm() - 1) / fall;
      if (!(next > s)) break;
      s = next;
    }
    return p.cwiseQuotient(Vec<D>(squares + Vec<D>::Constant(s))).normalized();
  }

 private:
  IndexedArray<Real, D> m_sizes;
};

const CurvedRegistrar<Ellipsoid, 2, 3> ellipsoidRegistrar{ShapeKind::ellipsoid,
                                                          {{"half_x", "half_y"}, {"half_x", "half_y", "half_z"}}};

}  // namespace
}}  // namespace lpc::LPC_PRECISION
