// SPDX-License-Identifier: Zlib
#include "oracles/referee/support_sweep.h"

#include <algorithm>
#include <cmath>
#include <queue>

#include "framework/shape/curved_core.h"
#include "oracles/referee/posed_core.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

// A simplex of directions: an arc in 2D, a spherical triangle in 3D.
template <int D>
struct Cell {
  std::array<Vecd<D>, static_cast<std::size_t>(D)> corner;
  double bound = 0;  // upper bound of the separation along the cell's directions
  bool operator<(const Cell& b) const { return bound < b.bound; }
};

template <int D>
class Sweep {
 public:
  Sweep(const SupportFunction<D>& a, const SupportFunction<D>& b) : m_a(a), m_b(b) {}

  Interval run(const SweepLimits& limits) {
    for (int signs = 0; signs < (1 << D); ++signs) {
      Cell<D> orthant;
      for (int k = 0; k < D; ++k) orthant.corner[at(k)] = Vecd<D>::Unit(k) * ((signs >> k) & 1 ? -1.0 : 1.0);
      push(orthant);
    }
    int cells = 1 << D;
    while (cells < limits.maxCells && m_open.top().bound - m_best > limits.width) {
      const Cell<D> cell = m_open.top();
      m_open.pop();
      split(cell);
      cells += 2;
    }
    const double rounding = 64 * 2.3e-16 * (m_reach + std::abs(m_best));
    return {m_best - rounding, std::max(m_open.top().bound, m_best) + rounding};
  }

 private:
  static std::size_t at(int k) { return static_cast<std::size_t>(k); }

  // Halves the longest side, so that cells stay round.
  void split(const Cell<D>& cell) {
    int from = 0, to = 1;
    for (int i = 0; i < D; ++i) {
      for (int j = i + 1; j < D; ++j) {
        if (cell.corner[at(i)].dot(cell.corner[at(j)]) < cell.corner[at(from)].dot(cell.corner[at(to)])) {
          from = i, to = j;
        }
      }
    }
    const Vecd<D> middle = (cell.corner[at(from)] + cell.corner[at(to)]).normalized();
    Cell<D> half = cell;
    half.corner[at(from)] = middle;
    push(half);
    half = cell;
    half.corner[at(to)] = middle;
    push(half);
  }

  // Every point m of the Minkowski difference bounds the separation along d by m . d. Over the cap of angle r around
  // the cell's middle c, that is at most |m| cos(angle(m, c) - r). Uses the support points of each corner and of the
  // middle.
  void push(Cell<D> cell) {
    Vecd<D> c = Vecd<D>::Zero();
    for (const auto& corner : cell.corner) c += corner;
    c.normalize();
    double cosine = 1;
    for (const auto& corner : cell.corner) cosine = std::min(cosine, c.dot(corner));
    const double r = std::acos(std::clamp(cosine, -1.0, 1.0)) * (1 + 1e-12) + 1e-15;
    cell.bound = std::numeric_limits<double>::infinity();
    const auto take = [&](const Vecd<D>& d) {
      const Vecd<D> m = m_b(-d) - m_a(d);
      m_best = std::max(m_best, m.dot(d));
      const double length = m.norm();
      m_reach = std::max(m_reach, length);
      if (length == 0) {
        cell.bound = std::min(cell.bound, 0.0);
        return;
      }
      const double angle = std::acos(std::clamp(m.dot(c) / length, -1.0, 1.0));
      cell.bound = std::min(cell.bound, length * std::cos(std::max(0.0, angle - r)));
    };
    take(c);
    for (const auto& corner : cell.corner) take(corner);
    m_open.push(cell);
  }

  const SupportFunction<D>&m_a, &m_b;
  std::priority_queue<Cell<D>> m_open;
  double m_best = -std::numeric_limits<double>::infinity(), m_reach = 0;
};

template <int D>
SupportFunction<D> supportOfCurved(const ShapeView<D>& shape, const Pose<D>& X_WS) {
  Eigen::Matrix<double, D, D> r;
  const auto rotation = rotationOf<double>(X_WS.q);
  for (int i = 0; i < D; ++i) {
    for (int j = 0; j < D; ++j) r(i, j) = rotation[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
  }
  return [core = shape.curved, r, p = Vecd<D>(X_WS.p.template cast<double>()),
          radius = static_cast<double>(shape.radius)](const Vecd<D>& d) -> Vecd<D> {
    const Vecd<D> local = r.transpose() * d;
    std::array<long double, static_cast<std::size_t>(D)> along;
    for (int k = 0; k < D; ++k) along[static_cast<std::size_t>(k)] = local[k];
    const auto q = core->support(along);
    Vecd<D> point;
    for (int k = 0; k < D; ++k) point[k] = static_cast<double>(q[static_cast<std::size_t>(k)]);
    return p + r * point + radius * d;
  };
}

template <int D>
SupportFunction<D> supportOf(const ShapeView<D>& shape, const Pose<D>& X_WS) {
  if (shape.curved) return supportOfCurved(shape, X_WS);
  std::vector<Vec<D>> core;
  coreVertices(shape, core);
  std::vector<Point<double, D>> posed;
  poseVertices<double, D>(core, X_WS, posed);
  std::vector<Vecd<D>> points;
  for (const auto& p : posed) points.push_back(Eigen::Map<const Vecd<D>>(p.data()));
  return [points, radius = static_cast<double>(shape.radius)](const Vecd<D>& d) -> Vecd<D> {
    std::size_t best = 0;
    for (std::size_t i = 1; i < points.size(); ++i) {
      if (points[i].dot(d) > points[best].dot(d)) best = i;
    }
    return points[best] + radius * d;
  };
}

}  // namespace

template <int D>
Interval sweepDirections(const SupportFunction<D>& a, const SupportFunction<D>& b, const SweepLimits& limits) {
  return Sweep<D>(a, b).run(limits);
}

template <int D>
Interval sweepDirections(const ShapeView<D>& a, const Pose<D>& X_WA, const ShapeView<D>& b, const Pose<D>& X_WB,
                         const SweepLimits& limits) {
  return sweepDirections<D>(supportOf(a, X_WA), supportOf(b, X_WB), limits);
}

template Interval sweepDirections(const SupportFunction<2>&, const SupportFunction<2>&, const SweepLimits&);
template Interval sweepDirections(const SupportFunction<3>&, const SupportFunction<3>&, const SweepLimits&);
template Interval sweepDirections(const ShapeView<2>&, const Pose<2>&, const ShapeView<2>&, const Pose<2>&,
                                  const SweepLimits&);
template Interval sweepDirections(const ShapeView<3>&, const Pose<3>&, const ShapeView<3>&, const Pose<3>&,
                                  const SweepLimits&);

}}  // namespace lpc::LPC_PRECISION
