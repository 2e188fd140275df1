// SPDX-License-Identifier: Zlib
#include "oracles/verify/metamorphic.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "framework/math/check.h"
#include "framework/math/random.h"
#include "framework/shape/curved_core.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

constexpr bool kDouble = sizeof(Real) == 8;

// Coordinate k of the image is that of axis from[k], possibly negated.
template <int D>
struct SignedPermutation {
  std::array<int, static_cast<std::size_t>(D)> from{};
  std::array<bool, static_cast<std::size_t>(D)> negated{};

  int axis(int k) const { return from[static_cast<std::size_t>(k)]; }
  bool turned(int k) const { return negated[static_cast<std::size_t>(k)]; }
  int turns() const { return static_cast<int>(std::count(negated.begin(), negated.end(), true)); }
  bool sameAxes() const { return std::is_sorted(from.begin(), from.end()); }
  template <class V>
  V operator*(const V& v) const {
    V out = v;
    for (int k = 0; k < D; ++k) {
      const auto x = v[static_cast<decltype(std::size(v))>(axis(k))];
      out[static_cast<decltype(std::size(v))>(k)] = turned(k) ? -x : x;
    }
    return out;
  }
  bool reflects() const {
    int inversions = 0;
    for (int i = 0; i < D; ++i) {
      for (int j = i + 1; j < D; ++j) inversions += axis(i) > axis(j);
    }
    return (inversions + turns()) % 2 == 1;
  }
  Rot<2> turn(const Rot<2>& q) const { return reflects() ? q.inverse() : q; }
  // A rotation axis is an axial vector: a reflection negates it in addition.
  Rot<3> turn(const Rot<3>& q) const {
    const Vec<3> v = (*this) * q.imag();
    return reflects() ? Rot<3>{q.w, -v[0], -v[1], -v[2]} : Rot<3>{q.w, v[0], v[1], v[2]};
  }
};

template <int D>
std::vector<SignedPermutation<D>> signedPermutations() {
  std::vector<SignedPermutation<D>> out;
  SignedPermutation<D> p;
  for (int k = 0; k < D; ++k) p.from[static_cast<std::size_t>(k)] = k;
  do {
    for (int bits = 0; bits < 1 << D; ++bits) {
      for (int k = 0; k < D; ++k) p.negated[static_cast<std::size_t>(k)] = (bits >> k & 1) == 1;
      out.push_back(p);
    }
  } while (std::next_permutation(p.from.begin(), p.from.end()));
  return out;
}

// True when the image is again a shape of this kind in its own frame. A curved core is tested by its support function,
// to the last bit, so that no kind need be known here.
template <int D>
bool admits(const ShapeView<D>& shape, const SignedPermutation<D>& p) {
  switch (shape.core()) {
    case CoreClass::point:
    case CoreClass::box:
    case CoreClass::hull:
      return true;
    case CoreClass::segment:
      return p.axis(0) == 0;
    case CoreClass::plane:
      return p.axis(1) == 1 && !p.turned(1);
    case CoreClass::curved:
      break;
  }
  Random random(1);
  for (int i = 0; i < 20; ++i) {
    std::array<long double, static_cast<std::size_t>(D)> d;
    for (auto& x : d) x = random.uniform(-1, 1);
    if (shape.curved->support(p * d) != p * shape.curved->support(d)) return false;
  }
  return true;
}

// Keeps faces and edges: a new hull of the points might drop others.
template <class MapPoint, class MapNormal>
Shape<2> mappedHull(const ShapeView<2>& shape, bool reflects, Real factor, MapPoint point, MapNormal normal) {
  auto hull = std::make_shared<Polytope<2>>(*shape.hull);
  for (Vec<2>& v : hull->vertices) v = point(v);
  for (Vec<2>& n : hull->normals) n = normal(n);
  if (reflects) {  // counter-clockwise again; normal i belongs to the edge from vertex i
    std::reverse(hull->vertices.begin(), hull->vertices.end());
    std::reverse(hull->normals.begin(), hull->normals.end() - 1);
  }
  return Shape<2>::polytope(std::move(hull), factor * shape.radius);
}
template <class MapPoint, class MapNormal>
Shape<3> mappedHull(const ShapeView<3>& shape, bool reflects, Real factor, MapPoint point, MapNormal normal) {
  auto hull = std::make_shared<Polytope<3>>(*shape.hull);
  const Vec<3> moved = point(Vec<3>(Vec<3>::Zero()));
  for (Vec<3>& v : hull->vertices) v = point(v);
  for (auto& face : hull->faces) {
    face.normal = normal(face.normal);
    face.offset = factor * face.offset + face.normal.dot(moved);
    if (reflects) std::reverse(hull->loop.begin() + face.begin, hull->loop.begin() + face.end);
  }
  for (auto& edge : hull->edges) {
    if (reflects) std::swap(edge.v0, edge.v1);
  }
  linkVertices(*hull);
  if (shape.kind == ShapeKind::triangle) {
    return Shape<3>::ofCorners(shape.kind, hull->vertices, factor * shape.radius);
  }
  return Shape<3>::polytope(std::move(hull), factor * shape.radius);
}

template <int D>
Shape<D> inAxes(const Shape<D>& shape, const SignedPermutation<D>& p) {
  const ShapeView<D>& v = shape.view();
  const auto map = [&](const Vec<D>& x) { return p * x; };
  if (v.core() == CoreClass::hull) return mappedHull(v, p.reflects(), Real(1), map, map);
  if (v.core() == CoreClass::box) return Shape<D>::box(map(v.half).cwiseAbs(), v.radius);
  return shape;
}

template <int D>
std::optional<RelatedPairs<D>> inAxes(const PosedPair<D>& pair, bool mirror, Random& random) {
  std::vector<SignedPermutation<D>> possible;
  for (const SignedPermutation<D>& p : signedPermutations<D>()) {
    const bool isMirror = p.sameAxes() && p.turns() == 1, isNothing = p.sameAxes() && p.turns() == 0;
    if (isMirror != mirror || isNothing) continue;
    if (admits(pair.a.view(), p) && admits(pair.b.view(), p)) possible.push_back(p);
  }
  if (possible.empty()) return std::nullopt;
  const SignedPermutation<D>& p = possible[random.below(possible.size())];
  const PosedPair<D> image{inAxes(pair.a, p), inAxes(pair.b, p), {p * pair.X_AB.p, p.turn(pair.X_AB.q)}};
  return RelatedPairs<D>{.before = pair, .after = image};
}

template <int D>
Shape<D> scaled(const Shape<D>& shape, Real k) {
  const ShapeView<D>& v = shape.view();
  switch (v.core()) {
    case CoreClass::point:
      return Shape<D>::sphere(k * v.radius);
    case CoreClass::segment:
      if (v.kind == ShapeKind::segment) return Shape<D>::segment(k * v.half[0]);
      return Shape<D>::capsule(k * v.half[0], k * v.radius);
    case CoreClass::box:
      return Shape<D>::box(k * v.half, k * v.radius);
    case CoreClass::curved: {
      std::vector<Real> sizes(v.curved->sizes().begin(), v.curved->sizes().end());
      for (Real& size : sizes) size *= k;
      return Shape<D>::curved(v.kind, sizes, k * v.radius);
    }
    case CoreClass::plane:
      return shape;
    case CoreClass::hull:
      break;
  }
  return mappedHull(
      v, false, k, [&](const Vec<D>& x) { return Vec<D>(k * x); }, [](const Vec<D>& n) { return n; });
}

template <int D>
RelatedPairs<D> scaled(const PosedPair<D>& pair, Random& random) {
  constexpr int kFar = kDouble ? 20 : 4;  // fourth powers of lengths must not underflow
  constexpr std::array<int, 4> kPowers = {-kFar, -1, 1, kFar};
  const Real k = std::ldexp(Real(1), kPowers[random.below(kPowers.size())]);
  const PosedPair<D> image{scaled(pair.a, k), scaled(pair.b, k), {k * pair.X_AB.p, pair.X_AB.q}};
  return {.before = pair, .after = image, .factor = static_cast<double>(k)};
}

// Rotations with exact matrices.
Rot<2> exactTurn(Random& random, Rot<2>) {
  return std::array<Rot<2>, 4>{{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}}[random.below(4)];
}
Rot<3> exactTurn(Random& random, Rot<3>) {
  const auto k = random.below(12);
  const auto half = [&](int bit) { return Real(k >> bit & 1 ? -0.5 : 0.5); };
  if (k < 8) return {Real(0.5), half(0), half(1), half(2)};
  return {Real(k == 8), Real(k == 9), Real(k == 10), Real(k == 11)};
}

// Moves the points of A, or of B when A has none; B is then rotated by an exact rotation. Coordinates have kBits bits
// and the translation kMoreBits more: both fit into a number.
template <int D>
std::optional<RelatedPairs<D>> translated(const PosedPair<D>& pair, Random& random) {
  constexpr int kBits = kDouble ? 40 : 20, kMoreBits = kDouble ? 10 : 2;
  const bool ofA = pair.a.view().core() == CoreClass::hull;
  const ShapeView<D>& view = (ofA ? pair.a : pair.b).view();
  if (view.core() != CoreClass::hull) return std::nullopt;
  Real size = pair.X_AB.p.cwiseAbs().maxCoeff();
  for (const Vec<D>& v : view.hull->vertices) size = std::max(size, v.cwiseAbs().maxCoeff());
  int exponent = 0;
  std::frexp(size, &exponent);
  const Real grid = std::ldexp(Real(1), exponent - kBits);
  const auto snap = [&](const Vec<D>& v) {
    Vec<D> out;
    for (int k = 0; k < D; ++k) out[k] = std::nearbyint(v[k] / grid) * grid;
    return out;
  };
  std::vector<Vec<D>> points;
  for (const Vec<D>& v : view.hull->vertices) points.push_back(snap(v));
  PosedPair<D> before = pair;
  Shape<D>& hull = ofA ? before.a : before.b;
  hull = Shape<D>::ofCorners(view.kind, points, view.radius);
  before.X_AB.p = snap(pair.X_AB.p);
  if (!ofA) before.X_AB.q = exactTurn(random, before.X_AB.q);
  Vec<D> way;
  for (int k = 0; k < D; ++k) way[k] = static_cast<Real>(random.uniform(-1, 1)) * size;
  way = std::ldexp(Real(1), kMoreBits) * snap(way);
  PosedPair<D> after = before;
  (ofA ? after.a : after.b) = mappedHull(
      hull.view(), false, Real(1), [&](const Vec<D>& x) { return Vec<D>(x + way); }, [](const Vec<D>& n) { return n; });
  if (ofA) {
    after.X_AB.p += way;
  } else {
    after.X_AB.p -= before.X_AB.q * way;
  }
  return RelatedPairs<D>{.before = before, .after = after};
}

std::vector<std::pair<int, int>> edgesOf(const Polytope<2>& hull) {
  std::vector<std::pair<int, int>> out;
  const int n = static_cast<int>(hull.vertices.size());
  for (int i = 0; i < n; ++i) out.emplace_back(i, (i + 1) % n);
  return out;
}
std::vector<std::pair<int, int>> edgesOf(const Polytope<3>& hull) {
  std::vector<std::pair<int, int>> out;
  for (const auto& edge : hull.edges) out.emplace_back(edge.v0, edge.v1);
  return out;
}

template <int D>
Shape<D> ofMorePoints(const Shape<D>& shape, std::vector<Vec<D>> points, Random& random) {
  const ShapeView<D>& v = shape.view();
  if (v.kind != ShapeKind::polytope) return shape;
  const auto& corners = v.hull->vertices;
  for (std::size_t n = 1 + random.below(3); n > 0; --n) points.push_back(points[random.below(points.size())]);
  for (const auto& [i, j] : edgesOf(*v.hull)) {
    if (random.below(2) == 0) continue;
    points.push_back((corners[static_cast<std::size_t>(i)] + corners[static_cast<std::size_t>(j)]) / 2);
  }
  for (std::size_t i = points.size(); i > 1; --i) std::swap(points[i - 1], points[random.below(i)]);
  return Shape<D>::polytope(std::span<const Vec<D>>(points), v.radius);
}

template <int D>
RelatedPairs<D> carried(const HardPair<D>& hard, const PosedPair<D>& pair, Random& random) {
  Ang<D> turn;
  for (int k = 0; k < kAngDim<D>; ++k) turn[k] = static_cast<Real>(random.uniform(-3, 3));
  Pose<D> X;
  if constexpr (D == 2) {
    X.q = Rot<2>::angle(static_cast<double>(turn[0]));
  } else {
    X.q = Rot<3>::vector(turn);
  }
  for (int k = 0; k < D; ++k) X.p[k] = static_cast<Real>(3 * hard.scale * random.uniform(-1, 1));
  return {.before = pair, .after = {pair.a, pair.b, poseBetween(X, X * pair.X_AB)}};
}

}  // namespace

template <int D>
std::optional<RelatedPairs<D>> relatedPairs(Relation relation, const HardPair<D>& hard, std::uint64_t choice) {
  Random random(choice * kRelations + static_cast<std::uint64_t>(relation));
  const PosedPair<D> pair{hard.a, hard.b, hard.X_AB};
  const bool anyHull = !hard.pointsA.empty() || !hard.pointsB.empty();
  try {
    switch (relation) {
      case Relation::swap:
        if (pair.a.kind() != pair.b.kind()) return std::nullopt;
        return RelatedPairs<D>{.before = pair, .after = {pair.b, pair.a, pair.X_AB.inverse()}};
      case Relation::mirror:
      case Relation::permutation:
        return inAxes(pair, relation == Relation::mirror, random);
      case Relation::scale:
        return scaled(pair, random);
      case Relation::translation:
        return translated(pair, random);
      case Relation::extraVertices: {
        if (!anyHull) return std::nullopt;
        Shape<D> a = ofMorePoints(pair.a, hard.pointsA, random);  // no expression draws twice
        Shape<D> b = ofMorePoints(pair.b, hard.pointsB, random);
        return RelatedPairs<D>{.before = pair, .after = {std::move(a), std::move(b), pair.X_AB}};
      }
      case Relation::motion:
        return carried(hard, pair, random);
      case Relation::kCount:
        break;
    }
  } catch (const UserError&) {  // on the grid, or in single precision, a sliver may be too flat for a hull
  }
  return std::nullopt;
}

template std::optional<RelatedPairs<2>> relatedPairs(Relation, const HardPair<2>&, std::uint64_t);
template std::optional<RelatedPairs<3>> relatedPairs(Relation, const HardPair<3>&, std::uint64_t);

}}  // namespace lpc::LPC_PRECISION
