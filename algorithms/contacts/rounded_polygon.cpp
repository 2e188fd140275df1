// SPDX-License-Identifier: Zlib
// The contact generator of the 2009 report (3.5.2, 6.2, 9.1.4), 2D only: every shape is a polygon expanded by a radius,
// a circle has one vertex, a capsule two. Axes are each edge's normal and the direction between the closest pair of
// vertices. Differences from the report:
//
// - "The running time is O(E + V)". Projecting all V vertices onto each of E normals, as in 3.5.2, is O(E V); so is the
// search for the closest pair. Here a known corner rejects most edges. For the other edges the search for the support
// vertex starts at that of the previous edge, so it goes round once. The closest pair is searched on two edges only:
// O(E + V).
// - Two circles with one centre: the direction between their vertices is 0 / 0, and there is no other axis. Here any
// direction is used, and the depth is the sum of the radii.
// - The direction between the closest vertices matters only where no edge faces the nearest point. Here it is tested
// only for the cases in which the report needs it: two corners, and two segments on one line, whose normals give 0 or
// noise at any distance. Below rounding the best edge's normal replaces it.
// - "More than one (maybe two in 2D)": the report leaves open which points, and how they are matched in the next step.
// Here both ends of the common interval of the two edges, numbered by their vertices.
// - The report leaves open which of two equal axes is the reference. For a square on a square, rounding would decide
// anew in each step. Here it is the first shape's, unless the other's is better by the pair's tolerance.
// - "Invalid contacts" of deeply overlapping shapes (9.1.10). More than half through a body, the shortest way out is
// its far side: that is inherent in the question, and is declared in `failures`.
#include "algorithms/contacts/clip/clip2.h"
#include "algorithms/contacts/patch/plane_patch.h"
#include "algorithms/contacts/sat/sat_axes2.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using namespace contacts;

// The vertices of a core that is not a hull, in its own frame; room for one shape.
using OwnVertices2 = std::array<Vec<2>, 4>;

const std::array<Vec<2>, 4> kEdgeNormals2 = {Vec<2>(0, -1), Vec<2>(1, 0), Vec<2>(0, 1), Vec<2>(-1, 0)};
const std::array<Vec<2>, 2> kSegmentNormals2 = {Vec<2>(0, -1), Vec<2>(0, 1)};

// The shape as a polygon in its own frame, so that only needed vertices are rotated. One vertex has no edge, two
// vertices have two.
Core2 roundedPolygon(const ShapeView<2>& s, OwnVertices2& own) {
  const Xy h = s.half;
  switch (s.core()) {
    case CoreClass::point:
      own[0] = Vec<2>(0, 0);
      return {own.data(), nullptr, 1};
    case CoreClass::segment:
      own[0] = Vec<2>(-h.x(), 0), own[1] = Vec<2>(h.x(), 0);
      return {own.data(), kSegmentNormals2.data(), 2};
    case CoreClass::box:
      own[0] = Vec<2>(-h.x(), -h.y()), own[1] = Vec<2>(h.x(), -h.y()), own[2] = Vec<2>(h.x(), h.y()),
      own[3] = Vec<2>(-h.x(), h.y());
      return {own.data(), kEdgeNormals2.data(), 4};
    case CoreClass::hull:
      return {s.hull->vertices.data(), s.hull->normals.data(), static_cast<int>(s.hull->vertices.size())};
    case CoreClass::curved:
    case CoreClass::plane:
      break;
  }
  LPC_ASSERT(false);  // no polygon
  return {};
}
Xy vertex(const Core2& c, int i) { return c.v[i]; }
Xy normal(const Core2& c, int i) { return c.n[i]; }

// The same for a box by its half extents: a pair of boxes needs only four vertices and one normal.
struct Box2 {
  Xy half;
  static constexpr int count = 4;
};
const IndexedArray<Xy, 4> kBoxCorners2 = {Xy(-1, -1), Xy(1, -1), Xy(1, 1), Xy(-1, 1)};
const IndexedArray<Xy, 4> kBoxNormals2 = {Xy(0, -1), Xy(1, 0), Xy(0, 1), Xy(-1, 0)};
Xy vertex(const Box2& c, int i) { return product(kBoxCorners2[i], c.half); }
Xy normal(const Box2&, int i) { return kBoxNormals2[i]; }

template <class C>
int after(const C& c, int i) {
  return i + 1 < c.count ? i + 1 : 0;
}
template <class C>
int before(const C& c, int i) {
  return (i > 0 ? i : c.count) - 1;
}

// Distance of p beyond edge i (m).
template <class C>
Real beyond(const C& c, int i, const Xy& p) {
  return dot(normal(c, i), p - vertex(c, i));
}

// The support vertex along d, by hill climbing from `at`. It compares edges instead of projections: two projections may
// be equal at a short edge before a long one, and the climb would stop before the long one.
template <class C>
int climb(const C& c, const Xy& d, int at) {
  const int start = at;
  for (int k = after(c, at); dot(d, vertex(c, k) - vertex(c, at)) > 0; k = after(c, at)) at = k;
  if (at != start) return at;
  for (int k = before(c, at); dot(d, vertex(c, k) - vertex(c, at)) > 0; k = before(c, at)) at = k;
  return at;
}

// Of the two edges at the support vertex `at` along d, the one with the normal more along d; it is the best of all
// edges.
template <class C>
int edgeAt(const C& c, const Xy& d, int at) {
  if (c.count == 1) return 0;
  const int other = before(c, at);
  return dot(normal(c, other), d) > dot(normal(c, at), d) ? other : at;
}

struct BestEdge {
  int edge = -1;   // none is better than the known separation
  int corner = 0;  // support vertex of the other polygon against the edge
  Real separation = -std::numeric_limits<Real>::infinity();
};

// The support vertex along d, by brute force.
int foremost(const Core2& c, const Xy& d) {
  int best = 0;
  Real most = dot(d, c.v[0]);
  for (int k = 1; k < c.count; ++k) {
    const Real far = dot(d, c.v[k]);
    best = far > most ? k : best, most = std::max(far, most);
  }
  return best;
}

// The edge of p beyond which q lies farthest, if that beats `known`. Any point of q gives an upper bound for an edge,
// so a known point rejects most edges: at first `bound(i)`, then the support vertex of the previous edge. `at`: where
// the search for a support vertex starts.
template <class C, class Bound>
BestEdge outermostEdge(const C& p, const C& q, const Pose<2>& X_PQ, Real known, int at, const Bound& bound,
                       std::uint64_t& axes) {
  BestEdge best{.separation = known};
  int first = 0;
  Real most = bound(0);
  for (int i = 1; i < p.count; ++i) {
    const Real here = bound(i);
    first = here > most ? i : first, most = std::max(here, most);
  }
  if (!(most > known)) return best;
  Xy corner{0, 0};
  const auto measure = [&](int i) {
    ++axes;
    at = climb(q, turnedBack(X_PQ.q, -normal(p, i)), at);
    corner = placed(X_PQ, vertex(q, at));
    const Real here = beyond(p, i, corner);
    if (here > best.separation) best = {i, at, here};
  };
  measure(first);
  if (best.separation >= most) return best;
  for (int i = after(p, first); i != first; i = after(p, i)) {
    if (beyond(p, i, corner) > best.separation) measure(i);
  }
  return best;
}

// A point inside a polygon.
Xy within(const Core2& c) { return Real(0.5) * (Xy(c.v[0]) + Xy(c.v[c.count / 2])); }

// Two edges that face each other along the unit n, in frame 1. A polygon of one vertex is an edge of zero length.
struct Facing {
  Xy a1, b1, a2, b2, n;
  int ia1, ib1, ia2, ib2;

  Edge2 edge1() const { return {a1, b1, ia1, ib1}; }
  Edge2 edge2() const { return {a2, b2, ia2, ib2}; }
};

template <class C>
Facing facing(const C& c1, int i1, const C& c2, int i2, const Pose<2>& X_12, const Xy& n) {
  const int j1 = after(c1, i1), j2 = after(c2, i2);
  return {
      vertex(c1, i1), vertex(c1, j1), placed(X_12, vertex(c2, i2)), placed(X_12, vertex(c2, j2)), n, i1, j1, i2, j2};
}
template <class C>
Facing facingFirst(const C& c1, const C& c2, const Pose<2>& X_12, const BestEdge& best) {
  const Xy n = normal(c1, best.edge);
  return facing(c1, best.edge, c2, edgeAt(c2, turnedBack(X_12.q, -n), best.corner), X_12, n);
}
template <class C>
Facing facingSecond(const C& c1, const C& c2, const Pose<2>& X_12, const BestEdge& best) {
  const Xy n = -turned(X_12.q, normal(c2, best.edge));
  return facing(c1, edgeAt(c1, n, best.corner), c2, best.edge, X_12, n);
}

// Both ends of the common interval of the edges along n. Numbers as in clip2.h: of the two vertices at this end,
// whichever of them cuts.
void clip(const Facing& f, const PlacedPair<2>& pair, Patch2& out) {
  f.n.to(out.normal), out.count = 0;
  // Edge 1 runs along t, edge 2 against it.
  const Xy t = f.n.left();
  const Real lo1 = dot(t, f.a1), hi1 = dot(t, f.b1), lo2 = dot(t, f.b2), hi2 = dot(t, f.a2);
  const Real lo = std::max(lo1, lo2), hi = std::min(hi1, hi2);
  if (hi < lo) return;
  // An edge that is seen end-on is no longer than rounding: its ends are one point.
  const Real per1 = hi1 - lo1 > pair.rounding ? 1 / (hi1 - lo1) : Real(0);
  const Real per2 = hi2 - lo2 > pair.rounding ? 1 / (hi2 - lo2) : Real(0);
  const auto p1At = [&](Real where) { return f.a1 + std::min((where - lo1) * per1, Real(1)) * (f.b1 - f.a1); };
  const auto p2At = [&](Real where) { return f.b2 + std::min((where - lo2) * per2, Real(1)) * (f.a2 - f.b2); };
  const Xy low1 = p1At(lo), low2 = p2At(lo), high1 = p1At(hi), high2 = p2At(hi);
  const Real low = dot(low2 - low1, f.n), high = dot(high2 - high1, f.n);
  bool keepsLow = low <= pair.limit, keepsHigh = high <= pair.limit;
  if (hi - lo <= pair.rounding) {  // a single point
    (high < low ? keepsLow : keepsHigh) = false;
  }
  if (keepsLow) write(out.points[0], low1, low2, low, featureNumber(featureCode(f.ia1), featureCode(f.ib2)));
  out.count = int{keepsLow};
  if (!keepsHigh) return;
  write(out.points[out.count++], high1, high2, high, featureNumber(featureCode(f.ib1), featureCode(f.ia2)));
}

// Whether a line orthogonal to n separates the edges. Touching edges are not separated.
bool parted(const Facing& f, const Xy& n) {
  return std::min(dot(n, f.a2), dot(n, f.b2)) > std::max(dot(n, f.a1), dot(n, f.b1));
}

// For overlapping cores: the support corner and the end of the edge that it lies beside, a case that only rounding
// causes.
void beside(const Facing& f, Real separation, const PlacedPair<2>& pair, Patch2& out) {
  f.n.to(out.normal), out.count = 0;
  const Xy t = f.n.left();
  Real least = std::numeric_limits<Real>::infinity();
  for (int k = 0; k < 4; ++k) {
    const Xy &p1 = k & 1 ? f.b1 : f.a1, &p2 = k & 2 ? f.b2 : f.a2;
    const Real height = dot(p2 - p1, f.n), aside = std::abs(dot(p2 - p1, t));
    if (height > separation + pair.tolerance || !(aside < least)) continue;
    least = aside, out.count = int{height <= pair.limit};
    write(out.points[0], p1, p2, height,
          featureNumber(featureCode(k & 1 ? f.ib1 : f.ia1), featureCode(k & 2 ? f.ib2 : f.ia2)));
  }
}

// The corner of a box farthest along d.
int cornerOfBox(const Xy& d) { return (d.y() < 0 ? 0 : 3) ^ (d.x() < 0 ? 0 : 1); }

// The best edge of each polygon; that of the second one only if it is better by the pair's tolerance, so that equal
// edges do not alternate.
struct BestEdges {
  BestEdge first, second;
};

template <class C>
BestEdge searchSecond(const C& c1, const C& c2, const Pose<2>& X_12, int first, Real known, std::uint64_t& axes) {
  Pose<2> X_21{.q = X_12.q.inverse()};
  (-turnedBack(X_12.q, X_12.p)).to(X_21.p);
  const int i = std::max(first, 0);
  const Xy a = placed(X_21, vertex(c1, i)), b = placed(X_21, vertex(c1, after(c1, i)));
  return outermostEdge(
      c2, c1, X_21, known, i, [&](int j) { return std::min(beyond(c2, j, a), beyond(c2, j, b)); }, axes);
}

// Contacts between the edges that face each other at the best one.
template <class C>
void collideEdges(const PlacedPair<2>& pair, const C& c1, const C& c2, BestEdges& best, Patch2& out, WorkDone& work) {
  const Pose<2>& X_12 = pair.X_12;
  Real separation = best.second.edge >= 0 ? best.second.separation : best.first.separation;
  if (separation > pair.limit || std::max(best.first.edge, best.second.edge) < 0) return;  // far apart, or not finite
  bool isSecond = best.second.edge >= 0;
  Facing f;
  for (;;) {
    f = isSecond ? facingSecond(c1, c2, X_12, best.second) : facingFirst(c1, c2, X_12, best.first);
    clip(f, pair, out);
    if (out.deepest() <= separation + pair.tolerance) return;
    if (isSecond) break;
    const BestEdge second =
        searchSecond(c1, c2, X_12, best.first.edge, best.first.separation, work[WorkCount::axisTests]);
    if (second.edge < 0) break;
    best.second = second, separation = second.separation, isSecond = true;
  }
  // Cores that are apart: their closest points, along the vector between them.
  closestOfEdges(f.edge1(), f.edge2(), f.n, true, pair, out);
  const bool flat = c1.count <= 2 && c2.count <= 2;
  if (!(separation > 0 || (flat && parted(f, out.normal)))) beside(f, separation, pair, out);
}

void collideBoxes(const PlacedPair<2>& pair, Patch2& out, WorkDone& work) {
  const Box2 c1{pair.view1().half}, c2{pair.view2().half};
  const Rot<2>& R_12 = pair.X_12.q;
  Axis2 axis1, axis2;
  work[WorkCount::axisTests] += 4;
  bestEdgesOfBoxes(c1.half, c2.half, pair.X_12, axis1, axis2);
  if (std::max(axis1.separation, axis2.separation) > pair.limit) return;
  BestEdges best;
  best.first = {axis1.edge, cornerOfBox(turnedBack(R_12, -normal(c1, axis1.edge))), axis1.separation};
  if (axis2.separation > axis1.separation + pair.tolerance) {
    best.second = {axis2.edge, cornerOfBox(-turned(R_12, normal(c2, axis2.edge))), axis2.separation};
  }
  collideEdges(pair, c1, c2, best, out, work);
}

// No edges: the direction between the vertices is the only axis. If it is zero, any direction is used.
void collidePoints(const PlacedPair<2>& pair, Patch2& out) {
  const Xy to = pair.X_12.p;
  const Real distance = std::sqrt(dot(to, to));
  const Xy n = distance > pair.rounding ? to / distance : Xy{1, 0};
  n.to(out.normal);
  const Real separation = dot(to, n);
  out.count = int{separation <= pair.limit};
  write(out.points[0], {0, 0}, to, separation, 0);
}

void collidePolygons(const PlacedPair<2>& pair, Patch2& out, WorkDone& work) {
  OwnVertices2 own1, own2;
  const Core2 c1 = roundedPolygon(pair.view1(), own1), c2 = roundedPolygon(pair.view2(), own2);
  if (c2.count == 1) return collidePoints(pair, out);  // kinds are in order: the first is one, too
  const Pose<2>& X_12 = pair.X_12;
  BestEdges best;
  std::uint64_t& axes = work[WorkCount::axisTests];
  if (c1.count > 1) {
    const int at = foremost(c2, turnedBack(X_12.q, within(c1) - placed(X_12, within(c2))));
    const Xy corner = placed(X_12, c2.v[at]);
    best.first = outermostEdge(
        c1, c2, X_12, best.first.separation, at, [&](int i) { return beyond(c1, i, corner); }, axes);
  }
  if (!(best.first.separation > pair.limit)) {
    best.second = searchSecond(c1, c2, X_12, best.first.edge, best.first.separation + pair.tolerance, axes);
  }
  collideEdges(pair, c1, c2, best, out, work);
}

void collide(const PlacedPair<2>& pair, Patch2& out, WorkDone& work) {
  out.count = 0;
  const CoreClass core1 = pair.view1().core();
  if (core1 == CoreClass::box && pair.view2().core() == CoreClass::box) return collideBoxes(pair, out, work);
  collidePolygons(pair, out, work);
  // A vertex touches in one point with the same number at any position.
  if (core1 == CoreClass::point) out.points[0].feature = featureNumber(featureCode(0), kNoFeature);
}

template <int D>
class RoundedPolygon final : public ContactGenerator<D> {
 public:
  struct Params {
    Real bias = kBias;
    void visit(ParamVisitor& v) {
      v.real("bias", bias, 0, kLinearSlop, "m", "depths that differ by less are alike: the first body's edge wins");
    }
  };
  explicit RoundedPolygon(const Params& params) : m_params(params) {}

  static AlgorithmInfo info() {
    return {
        .name = "rounded_polygon",
        .summary = "every shape a polygon with a radius: normals of edges, then the nearest vertices; no curved cores",
        .paper = "lpc2009",
        .complexity = "e + v",
        .failures = {{"a body that is more than half through a thin one",
                      "the shortest way out is the far side: it is pushed through",
                      "Contacts.DeepBodiesGoBackWhereTheyCameFrom"}}};
  }

  bool supports(ShapeKind a, ShapeKind b) const override {
    const CoreClass first = coreClass(a), second = coreClass(b);
    if (first == CoreClass::curved || second == CoreClass::curved) return false;  // no polygon
    return first != CoreClass::plane || second != CoreClass::plane;
  }

  void generate(const ContactInput<D>& in, std::vector<Manifold<D>>& fresh, WorkDone& work) override {
    work[WorkCount::pairQueries] += in.pairs.size();
    for (std::size_t from = 0; from < in.pairs.size(); from += kBlock) {
      const std::size_t count = std::min(kBlock, in.pairs.size() - from);
      for (std::size_t i = 0; i < count; ++i) m_placed[i] = placePair(in, in.pairs[from + i], m_params.bias);
      for (std::size_t i = 0; i < count; ++i) {
        if (!hasPlane(m_placed[i])) collide(m_placed[i], m_patches[i], work);
      }
      for (std::size_t i = 0; i < count; ++i) {
        Patch2& patch = m_patches[i];
        if (hasPlane(m_placed[i])) {
          const Vec<D> n = planePatch(m_placed[i], Reduction::spread, m_plane, work);
          addPatch<D>(in, m_placed[i], n, m_plane.points, fresh);
        } else {
          addPatch<D>(in, m_placed[i], patch.normal, {patch.points.data(), patch.points.data() + patch.count}, fresh);
        }
      }
    }
  }

 private:
  Params m_params;
  // Pairs are placed, collided and added in blocks of this size (count): each of the three is one long chain of
  // dependent operations, and independent work beside it keeps the processor busy. Pair by pair, boxes took longer.
  static constexpr std::size_t kBlock = 16;
  std::array<PlacedPair<D>, kBlock> m_placed;
  std::array<Patch2, kBlock> m_patches;
  PlaneScratch<D> m_plane;
};

}  // namespace

LPC_REGISTER(ContactGenerator, RoundedPolygon, 2);

}}  // namespace lpc::LPC_PRECISION
