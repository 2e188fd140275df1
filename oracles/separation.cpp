// SPDX-License-Identifier: Zlib
#include <algorithm>

#include "oracles/bounded.h"
#include "oracles/posed_core.h"
#include "oracles/referee.h"

namespace lpc::inline LPC_PRECISION {
namespace {

template <int D>
Bounded along(const std::vector<Point<Bounded, D>>& vertices, const Vecd<D>& d, bool least) {
  Bounded best;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    Bounded dot;
    for (std::size_t k = 0; k < D; ++k) dot = dot + vertices[i][k] * Bounded(d[static_cast<int>(k)]);
    if (!least) dot = -dot;
    best = i == 0 ? dot : lesser(best, dot);
  }
  return best;
}

}  // namespace

template <int D>
Interval separationAlong(const ShapeView<D>& a, const Pose<D>& X_WA, const ShapeView<D>& b, const Pose<D>& X_WB,
                         const Vecd<D>& d) {
  std::vector<Vec<D>> core;
  std::vector<Point<Bounded, D>> posedA, posedB;
  coreVertices(a, core);
  poseVertices<Bounded, D>(core, X_WA, posedA);
  coreVertices(b, core);
  poseVertices<Bounded, D>(core, X_WB, posedB);
  Bounded square;
  for (int k = 0; k < D; ++k) square = square + Bounded(d[k]) * Bounded(d[k]);
  const Bounded gap = along<D>(posedB, d, true) + along<D>(posedA, d, false);
  const Bounded radii = Bounded(static_cast<double>(a.radius)) + Bounded(static_cast<double>(b.radius));
  const Bounded separation = gap / sqrt(square) - radii;
  return {roundDown(separation.lo()), roundUp(separation.hi())};
}

template <int D>
double errorScale(const ShapeView<D>& a, const Pose<D>& X_WA, const ShapeView<D>& b, const Pose<D>& X_WB, double phi) {
  double extent = 0, coordinate = 0;
  const auto measure = [&](const ShapeView<D>& shape, const Pose<D>& X_WS) {
    std::vector<Vec<D>> core;
    coreVertices(shape, core);
    Vecd<D> lo = core[0].template cast<double>(), hi = lo;
    const double radius = static_cast<double>(shape.radius);
    coordinate = std::max(coordinate, X_WS.p.template cast<double>().cwiseAbs().maxCoeff());
    for (const Vec<D>& v : core) {
      coordinate = std::max(coordinate, v.template cast<double>().cwiseAbs().maxCoeff());
      lo = lo.cwiseMin(v.template cast<double>());
      hi = hi.cwiseMax(v.template cast<double>());
      const Vec<D> world = X_WS * v;
      coordinate = std::max(coordinate, world.template cast<double>().cwiseAbs().maxCoeff() + radius);
    }
    extent = std::max(extent, (hi - lo).maxCoeff() + 2 * radius);
  };
  measure(a, X_WA);
  measure(b, X_WB);
  return extent + std::max(phi, 0.0) + coordinate;
}

template Interval separationAlong(const ShapeView<2>&, const Pose<2>&, const ShapeView<2>&, const Pose<2>&,
                                  const Vecd<2>&);
template Interval separationAlong(const ShapeView<3>&, const Pose<3>&, const ShapeView<3>&, const Pose<3>&,
                                  const Vecd<3>&);
template double errorScale(const ShapeView<2>&, const Pose<2>&, const ShapeView<2>&, const Pose<2>&, double);
template double errorScale(const ShapeView<3>&, const Pose<3>&, const ShapeView<3>&, const Pose<3>&, double);

}  // namespace lpc::inline LPC_PRECISION
