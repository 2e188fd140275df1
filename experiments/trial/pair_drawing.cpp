// SPDX-License-Identifier: Zlib
#include "experiments/trial/pair_drawing.h"

#include <array>
#include <cmath>

#include "framework/shape/curved_core.h"
#include "framework/shape/support_map.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

// On a circle each point in its own sector, on a sphere anywhere: no two so near that a hull would merge them.
Vec<2> onBall2(int i, int of, Random& random) {
  const Rot<2> turn = Rot<2>::angle(static_cast<Real>(6.283185307179586 * (i + random.uniform(0, 0.8)) / of));
  return {turn.c, turn.s};
}
Vec<3> onBall3(Random& random) {
  for (;;) {
    const double x = random.uniform(-1, 1), y = random.uniform(-1, 1), z = random.uniform(-1, 1);
    const double square = x * x + y * y + z * z;
    if (square > 0.01 && square < 1) return Vec<3>(Real(x), Real(y), Real(z)).normalized();
  }
}

// No point on an ellipsoid lies within the hull of others, so the number of vertices is that of the points.
template <int D>
Shape<D> drawHull(int vertices, double size, Random& random) {
  Vec<D> half;
  for (int d = 0; d < D; ++d) half[d] = static_cast<Real>(size * random.uniform(0.2, 1));
  std::vector<Vec<D>> points;
  for (int i = 0; i < vertices; ++i) {
    if constexpr (D == 2) {
      points.push_back(half.cwiseProduct(onBall2(i, vertices, random)));
    } else {
      points.push_back(half.cwiseProduct(onBall3(random)));
    }
  }
  return Shape<D>::polytope(points);
}

template <int D>
Shape<D> drawShape(ShapeKind kind, double size, int vertices, Random& random) {
  const auto length = [&] { return static_cast<Real>(size * random.uniform(0.2, 1)); };
  switch (coreClass(kind)) {
    case CoreClass::point:
      return Shape<D>::sphere(length());
    case CoreClass::segment: {
      if (kind == ShapeKind::segment) return Shape<D>::segment(length());
      const Real half = length();
      return Shape<D>::capsule(half, length() / 2);
    }
    case CoreClass::box: {
      Vec<D> half;
      for (int d = 0; d < D; ++d) half[d] = length();
      return Shape<D>::box(half);
    }
    case CoreClass::curved: {
      std::vector<Real> sizes;
      for (std::size_t i = 0; i < curvedKind<D>(kind).sizes.size(); ++i) sizes.push_back(length());
      return Shape<D>::curved(kind, sizes);
    }
    case CoreClass::plane:
      return Shape<D>::plane();
    case CoreClass::hull:
      if (vertices > 0 && kind != ShapeKind::triangle) return drawHull<D>(vertices, size, random);
      break;
  }
  std::vector<Vec<D>> points;
  for (int i = 0; i < (kind == ShapeKind::triangle ? 3 : 12); ++i) {
    Vec<D> p;
    for (int d = 0; d < D; ++d) p[d] = static_cast<Real>(size * random.uniform(-1, 1));
    points.push_back(p);
  }
  return Shape<D>::ofCorners(kind, points);
}

Rot<2> drawRotation2(Random& random) { return Rot<2>::angle(random.uniform(-3.14159, 3.14159)); }
Rot<3> drawRotation3(Random& random) {
  return Rot<3>::vector(Vec<3>(Real(random.uniform(-3, 3)), Real(random.uniform(-3, 3)), Real(random.uniform(-3, 3))));
}

// Position of B: a multiple of the sum of both radii from A, along a direction.
enum class Along { anything, anAxis };  // an axis: the shapes are not rotated either, so that faces are parallel
enum class Then { stays, touches };     // touches: moved along that direction until the distance is 0 to 1e-9 m

// One family of pairs. All families draw the same random numbers, also unused ones: stored results depend on the
// numbers that follow.
template <int D>
DrawnPair<D> drawFrom(const PairRequest<D>& request, Random& random, Along along, Then then,
                      const std::function<double(const std::array<double, 3>&)>& place) {
  const double sizeB = request.index / 6 % 3 == 2 ? 0.01 : 1;  // every third round has sizes 1 : 100
  DrawnPair<D> pair{drawShape<D>(request.kindA, 1, request.vertices, random),
                    drawShape<D>(request.kindB, sizeB, request.vertices, random),
                    {}};
  Rot<D> q;
  if constexpr (D == 2) {
    q = drawRotation2(random);
  } else {
    q = drawRotation3(random);
  }
  Vec<D> direction = Vec<D>::Zero();
  for (int d = 0; d < D; ++d) direction[d] = static_cast<Real>(random.uniform(-1, 1));
  if (!(direction.norm() > Real(1e-3))) direction[0] = 1;
  if (along == Along::anAxis) {
    direction = Vec<D>::Unit(static_cast<int>(random.below(D)));
  } else {
    pair.X_AB.q = q;
  }
  direction.normalize();
  const Real reach = boundingRadius(pair.a.view()) + boundingRadius(pair.b.view());
  const double apart = random.uniform(1.1, 4), near = random.uniform(0.8, 1.2), within = random.uniform(0.1, 0.8);
  pair.X_AB.p = direction * (reach * static_cast<Real>(place({apart, near, within})));
  if (then == Then::touches) {
    for (int turn = 0; turn < 40; ++turn) {
      const double gap = request.trueDistance(pair);
      if (std::abs(gap) < 1e-9) break;
      pair.X_AB.p -= direction * static_cast<Real>(gap);
    }
  }
  return pair;
}

struct Apart : NoParams {
  static constexpr const char *kName = "apart", *kMeaning = "up to four times as far as they could touch";
  template <int D>
  DrawnPair<D> draw(const PairRequest<D>& request, Random& random) const {
    return drawFrom<D>(request, random, Along::anything, Then::stays, [](const auto& drawn) { return drawn[0]; });
  }
};
struct Near : NoParams {
  static constexpr const char *kName = "near", *kMeaning = "about as far as they could touch";
  template <int D>
  DrawnPair<D> draw(const PairRequest<D>& request, Random& random) const {
    return drawFrom<D>(request, random, Along::anything, Then::stays, [](const auto& drawn) { return drawn[1]; });
  }
};
struct Touching : NoParams {
  static constexpr const char *kName = "touching", *kMeaning = "within 1e-9 m of touching, anyhow turned";
  template <int D>
  DrawnPair<D> draw(const PairRequest<D>& request, Random& random) const {
    return drawFrom<D>(request, random, Along::anything, Then::touches, [](const auto&) { return 1.0; });
  }
};
struct Overlapping : NoParams {
  static constexpr const char *kName = "overlapping", *kMeaning = "most of them overlap, shallow or deep";
  template <int D>
  DrawnPair<D> draw(const PairRequest<D>& request, Random& random) const {
    return drawFrom<D>(request, random, Along::anything, Then::stays, [](const auto& drawn) { return drawn[2]; });
  }
};
struct Centred : NoParams {
  static constexpr const char *kName = "centred", *kMeaning = "both centres at one place";
  template <int D>
  DrawnPair<D> draw(const PairRequest<D>& request, Random& random) const {
    return drawFrom<D>(request, random, Along::anything, Then::stays, [](const auto&) { return 0.0; });
  }
};
struct ParallelFaces : NoParams {
  static constexpr const char *kName = "parallel_faces",
                              *kMeaning = "not turned, within 1e-9 m of touching along an axis";
  template <int D>
  DrawnPair<D> draw(const PairRequest<D>& request, Random& random) const {
    return drawFrom<D>(request, random, Along::anAxis, Then::touches, [](const auto&) { return 1.0; });
  }
};

// Families in which methods differ. A new family does not join: stored results use these six.
struct InTurn : NoParams {
  static constexpr const char* kName = "in_turn";
  static constexpr const char* kMeaning = "apart, near, touching, overlapping, centred, parallel_faces, and again";
  template <int D>
  DrawnPair<D> draw(const PairRequest<D>& request, Random& random) const {
    using Draw = DrawnPair<D> (*)(const PairRequest<D>&, Random&);
    constexpr Draw kTurns[] = {one<Apart, D>,       one<Near, D>,    one<Touching, D>,
                               one<Overlapping, D>, one<Centred, D>, one<ParallelFaces, D>};
    return kTurns[request.index % 6](request, random);
  }
  template <class E, int D>
  static DrawnPair<D> one(const PairRequest<D>& request, Random& random) {
    return E{}.template draw<D>(request, random);
  }
};

template <class E, int D>
DrawnPair<D> draw(const Spec& spec, const PairRequest<D>& request, Random& random) {
  return readEntry<E>(spec).template draw<D>(request, random);
}
template <class E>
PairDrawing drawingEntry() {
  return {entryInfo<E>(), draw<E, 2>, draw<E, 3>};
}

}  // namespace

const std::vector<PairDrawing>& pairDrawings() {
  static const std::vector<PairDrawing> all = {
      drawingEntry<InTurn>(),      drawingEntry<Apart>(),   drawingEntry<Near>(),         drawingEntry<Touching>(),
      drawingEntry<Overlapping>(), drawingEntry<Centred>(), drawingEntry<ParallelFaces>()};
  return all;
}

}}  // namespace lpc::LPC_PRECISION
