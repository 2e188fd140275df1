// SPDX-License-Identifier: Zlib
#include <algorithm>

#include "oracles/referee/posed_support.h"
#include "oracles/referee/referee.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

// Largest |coordinate| of the shape's core in its own frame, in the world, and its longest side (m).
template <int D>
struct CoreSize {
  double own = 0, world = 0, side = 0;
};

template <int D>
CoreSize<D> sizeOf(const ShapeView<D>& shape, const Pose<D>& X_WS) {
  CoreSize<D> size;
  size.world = X_WS.p.template cast<double>().cwiseAbs().maxCoeff();
  switch (shape.core()) {
    case CoreClass::plane:  // unbounded: its extent does not matter
      return size;
    case CoreClass::curved: {
      size.own = static_cast<double>(shape.half.maxCoeff()), size.side = 2 * size.own;
      const Aabb<D> box = boundingBox(shape, X_WS);
      size.world = std::max<double>(size.world, std::max(box.hi.cwiseAbs().maxCoeff(), box.lo.cwiseAbs().maxCoeff()));
      return size;
    }
    case CoreClass::point:
    case CoreClass::segment:
    case CoreClass::box:
    case CoreClass::hull:
      break;
  }
  std::vector<Vec<D>> core;
  coreVertices(shape, core);
  Vecd<D> lo = core[0].template cast<double>(), hi = lo;
  for (const Vec<D>& v : core) {
    size.own = std::max(size.own, v.template cast<double>().cwiseAbs().maxCoeff());
    lo = lo.cwiseMin(v.template cast<double>());
    hi = hi.cwiseMax(v.template cast<double>());
    const Vec<D> world = X_WS * v;
    size.world =
        std::max(size.world, world.template cast<double>().cwiseAbs().maxCoeff() + static_cast<double>(shape.radius));
  }
  size.side = (hi - lo).maxCoeff();
  return size;
}

}  // namespace

template <int D>
Interval separationAlong(const ShapeView<D>& a, const Pose<D>& X_WA, const ShapeView<D>& b, const Pose<D>& X_WB,
                         const Vecd<D>& d) {
  Point<Real80, D> direction;
  for (std::size_t k = 0; k < D; ++k) direction[k] = d[static_cast<int>(k)];
  const bool planeA = a.core() == CoreClass::plane, planeB = b.core() == CoreClass::plane;
  if (planeA || planeB) {
    // A half-space is unbounded except along its normal: a direction equal to the normal within rounding counts as the
    // normal.
    const RefereeAnswer<D> truth = refereeOfPlane(a, X_WA, b, X_WB);
    const double off = (d.normalized() - truth.normal).norm(), s = errorScale(a, X_WA, b, X_WB, truth.hi);
    return {truth.lo - off * s, truth.hi - off * s};
  }
  const Bounded radii = Bounded(static_cast<double>(a.radius)) + Bounded(static_cast<double>(b.radius));
  const Bounded separation = separationOfCores(PosedSupport<D>(a, X_WA), PosedSupport<D>(b, X_WB), direction) - radii;
  return {roundDown(separation.lo()), roundUp(separation.hi())};
}

template <int D>
double posedScale(const ShapeView<D>& a, const ShapeView<D>& b, double phi) {
  const auto extent = [](const ShapeView<D>& shape) {
    return sizeOf(shape, Pose<D>{}).side + 2 * static_cast<double>(shape.radius);
  };
  return std::max(extent(a), extent(b)) + std::max(phi, 0.0);
}

template <int D>
double errorScale(const ShapeView<D>& a, const Pose<D>& X_WA, const ShapeView<D>& b, const Pose<D>& X_WB, double phi) {
  double coordinate = 0;
  const auto measure = [&](const ShapeView<D>& shape, const Pose<D>& X_WS) {
    const CoreSize<D> size = sizeOf(shape, X_WS);
    coordinate = std::max({coordinate, size.own, size.world});
  };
  measure(a, X_WA);
  measure(b, X_WB);
  return posedScale(a, b, phi) + coordinate;
}

template Interval separationAlong(const ShapeView<2>&, const Pose<2>&, const ShapeView<2>&, const Pose<2>&,
                                  const Vecd<2>&);
template Interval separationAlong(const ShapeView<3>&, const Pose<3>&, const ShapeView<3>&, const Pose<3>&,
                                  const Vecd<3>&);
template double posedScale(const ShapeView<2>&, const ShapeView<2>&, double);
template double posedScale(const ShapeView<3>&, const ShapeView<3>&, double);
template double errorScale(const ShapeView<2>&, const Pose<2>&, const ShapeView<2>&, const Pose<2>&, double);
template double errorScale(const ShapeView<3>&, const Pose<3>&, const ShapeView<3>&, const Pose<3>&, double);

}}  // namespace lpc::LPC_PRECISION
