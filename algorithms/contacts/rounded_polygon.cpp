// SPDX-License-Identifier: Zlib
// The contact generator of the 2009 report (3.5.2, 6.2, 9.1.4), 2D only: every shape is a polygon that is expanded by a
// radius, a circle one of one vertex, a capsule one of two. Axes are each edge's normal and the direction between the
// closest pair of vertices. Where this differs from the report:
//
// - "The running time is O(E + V)". All V vertices projected onto each of E normals, as 3.5.2 has it, are E V; so is
// the
//   search for the closest pair. Here a corner at hand dismisses most edges, for others the foremost one is looked for
//   from the last one's, which goes round once while the edge does, and the pair is looked for on two edges: E + V.
// - Two circles with one centre: the direction between their vertices is 0 / 0, and they have no other axis. Here any
//   direction is one, and the depth is the sum of the radii.
// - The direction between the closest vertices bears a contact only where no edge faces the nearest point. Here it is
//   asked for there alone: as the report needs it, of two corners, and of two segments on one line, whose normals say 0
//   or noise however far apart they are. Below rounding the best edge's normal stands for it.
// - "More than one (maybe two in 2D)": which, and how they are known again in the next step, is left open. Here both
//   ends of what the two edges have in common, numbered by their vertices.
// - Which of two equal axes leads is left open, too. Of a square on a square rounding would say so anew in each step.
//   Here it is the first shape's, unless the other's is better by the pair's tolerance.
// - "Invalid contacts" of what is pressed deep into each other (9.1.10). More than half through a body, the
//   shortest way out is its far side: that lies in the question, and is declared in `failures`.
#include "algorithms/contacts/clip2.h"
#include "algorithms/contacts/plane_patch.h"
#include "algorithms/contacts/sat_axes2.h"

namespace lpc::inline LPC_PRECISION {
namespace {

using namespace contacts;

// A vector of the plane in two registers. Eigen reads a Vec<2> as one packet, and waits for it where its two numbers
// were just written one by one: with Vec<2> a pair took 400 ns instead of 165.
struct Xy {
  Real x, y;

  Xy(Real x_, Real y_) : x(x_), y(y_) {}
  Xy(const Vec<2>& v) : x(v[0]), y(v[1]) {}
  Vec<2> vec() const { return {x, y}; }
  void to(Vec<2>& v) const { v[0] = x, v[1] = y; }
  // Friends, which hide no operators of Vec<2>.
  friend Xy operator+(const Xy& a, const Xy& b) { return {a.x + b.x, a.y + b.y}; }
  friend Xy operator-(const Xy& a, const Xy& b) { return {a.x - b.x, a.y - b.y}; }
  friend Xy operator-(const Xy& a) { return {-a.x, -a.y}; }
  friend Xy operator*(Real s, const Xy& a) { return {s * a.x, s * a.y}; }
};
Real dot(const Xy& a, const Xy& b) { return a.x * b.x + a.y * b.y; }
Xy turned(const Rot<2>& q, const Xy& a) { return {q.c * a.x - q.s * a.y, q.s * a.x + q.c * a.y}; }
Xy turnedBack(const Rot<2>& q, const Xy& a) { return {q.c * a.x + q.s * a.y, q.c * a.y - q.s * a.x}; }
Xy placed(const Pose<2>& X, const Xy& a) { return Xy(X.p) + turned(X.q, a); }

// The vertices of a core that is no hull, in its own frame; room for one shape.
using OwnVertices2 = std::array<Vec<2>, 4>;

const std::array<Vec<2>, 4> kBoxNormals2 = {Vec<2>(0, -1), Vec<2>(1, 0), Vec<2>(0, 1), Vec<2>(-1, 0)};
const std::array<Vec<2>, 2> kSegmentNormals2 = {Vec<2>(0, -1), Vec<2>(0, 1)};

// As a polygon in its own frame, so that nothing is turned that is not asked for. One vertex has no edge, two have two.
Core2 roundedPolygon(const ShapeView<2>& s, OwnVertices2& own) {
  const Xy h = s.half;
  switch (s.core()) {
    case CoreClass::point:
      own[0] = Vec<2>(0, 0);
      return {own.data(), nullptr, 1};
    case CoreClass::segment:
      own[0] = Vec<2>(-h.x, 0), own[1] = Vec<2>(h.x, 0);
      return {own.data(), kSegmentNormals2.data(), 2};
    case CoreClass::box:
      own[0] = Vec<2>(-h.x, -h.y), own[1] = Vec<2>(h.x, -h.y), own[2] = Vec<2>(h.x, h.y), own[3] = Vec<2>(-h.x, h.y);
      return {own.data(), kBoxNormals2.data(), 4};
    case CoreClass::hull:
      return {s.hull->vertices.data(), s.hull->normals.data(), static_cast<int>(s.hull->vertices.size())};
    case CoreClass::curved:
    case CoreClass::plane:
      break;
  }
  LPC_ASSERT(false);  // no polygon
  return {};
}

int after(const Core2& c, int i) { return i + 1 < c.count ? i + 1 : 0; }
int before(const Core2& c, int i) { return (i > 0 ? i : c.count) - 1; }

// How far p lies beyond edge i (m).
Real beyond(const Core2& c, int i, const Xy& p) { return dot(c.n[i], p - Xy(c.v[i])); }

// The vertex farthest along d, by way of its neighbours from `at`. Edges are what is compared, and not projections of
// vertices: of a short edge before a long one two projections may be equal, and the climb would end before the long
// one.
int climb(const Core2& c, const Xy& d, int at) {
  const int start = at;
  for (int k = after(c, at); dot(d, Xy(c.v[k]) - Xy(c.v[at])) > 0; k = after(c, at)) at = k;
  if (at != start) return at;
  for (int k = before(c, at); dot(d, Xy(c.v[k]) - Xy(c.v[at])) > 0; k = before(c, at)) at = k;
  return at;
}

// Of the two edges at vertex `at`, the farthest along d, the one whose normal is more along d: of all edges, the most.
int edgeAt(const Core2& c, const Xy& d, int at) {
  if (c.count == 1) return 0;
  const int other = before(c, at);
  return dot(c.n[other], d) > dot(c.n[at], d) ? other : at;
}

struct BestEdge {
  int edge = -1;   // none is better than what was known
  int corner = 0;  // of the other polygon, its foremost against the edge
  Real separation = -std::numeric_limits<Real>::infinity();
};

// The vertex farthest along d, of all.
int foremost(const Core2& c, const Xy& d) {
  int best = 0;
  Real most = dot(d, c.v[0]);
  for (int k = 1; k < c.count; ++k) {
    const Real far = dot(d, c.v[k]);
    best = far > most ? k : best, most = std::max(far, most);
  }
  return best;
}

// The edge of p that q lies farthest beyond, of those that beat `known`. Any point of q bounds from above how far q
// lies beyond an edge, so that most edges are dismissed by a point at hand: at first `bound(i)`, then the foremost one
// against the edge before. `at`: where to begin to look for that one.
template <class Bound>
BestEdge outermostEdge(const Core2& p, const Core2& q, const Pose<2>& X_PQ, Real known, int at, const Bound& bound,
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
    at = climb(q, turnedBack(X_PQ.q, -Xy(p.n[i])), at);
    corner = placed(X_PQ, q.v[at]);
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

// Some point of a polygon.
Xy within(const Core2& c) { return Real(0.5) * (Xy(c.v[0]) + Xy(c.v[c.count / 2])); }

// Two edges that face each other along the unit n, in frame 1. A polygon of one vertex is an edge from there to there.
struct Facing {
  Xy a1, b1, a2, b2, n;
  int ia1, ib1, ia2, ib2;

  Edge2 edge1() const { return {a1.vec(), b1.vec(), ia1, ib1}; }
  Edge2 edge2() const { return {a2.vec(), b2.vec(), ia2, ib2}; }
};

Facing facing(const Core2& c1, int i1, const Core2& c2, int i2, const Pose<2>& X_12, const Xy& n) {
  const int j1 = after(c1, i1), j2 = after(c2, i2);
  return {c1.v[i1], c1.v[j1], placed(X_12, c2.v[i2]), placed(X_12, c2.v[j2]), n, i1, j1, i2, j2};
}
Facing facingFirst(const Core2& c1, const Core2& c2, const Pose<2>& X_12, const BestEdge& best) {
  const Xy n = c1.n[best.edge];
  return facing(c1, best.edge, c2, edgeAt(c2, turnedBack(X_12.q, -n), best.corner), X_12, n);
}
Facing facingSecond(const Core2& c1, const Core2& c2, const Pose<2>& X_12, const BestEdge& best) {
  const Xy n = -turned(X_12.q, c2.n[best.edge]);
  return facing(c1, edgeAt(c1, n, best.corner), c2, best.edge, X_12, n);
}

// A contact of the cores in frame 1, before it is brought to the bodies.
struct Contact2 {
  Xy p1{0, 0}, p2{0, 0};
  Real separation = 0;
  std::uint64_t feature = 0;
};
struct Contacts2 {
  Xy n{1, 0};
  int count = 0;
  std::array<Contact2, 2> points;

  void add(const Contact2& c, Real limit) {
    if (c.separation <= limit) points[static_cast<std::size_t>(count++)] = c;
  }
  Real deepest() const {
    if (count == 0) return std::numeric_limits<Real>::infinity();
    return count == 1 ? points[0].separation : std::min(points[0].separation, points[1].separation);
  }
};

// Both ends of the interval that the edges have in common as seen along n. Numbers as in clip2.h: of the two vertices
// at this end, whichever of them cuts.
void clip(const Facing& f, const PlacedPair<2>& pair, Contacts2& out) {
  out.n = f.n, out.count = 0;
  // Edge 1 runs along t, edge 2 against it.
  const Xy t{-f.n.y, f.n.x};
  const Real lo1 = dot(t, f.a1), hi1 = dot(t, f.b1), lo2 = dot(t, f.b2), hi2 = dot(t, f.a2);
  const Real lo = std::max(lo1, lo2), hi = std::min(hi1, hi2);
  if (hi < lo) return;
  // An edge that is seen end-on is no longer than rounding: its ends are one place.
  const Real per1 = hi1 - lo1 > pair.rounding ? 1 / (hi1 - lo1) : Real(0);
  const Real per2 = hi2 - lo2 > pair.rounding ? 1 / (hi2 - lo2) : Real(0);
  const auto put = [&](Contact2& to, Real where, int i1, int i2) {
    to.p1 = f.a1 + std::min((where - lo1) * per1, Real(1)) * (f.b1 - f.a1);
    to.p2 = f.b2 + std::min((where - lo2) * per2, Real(1)) * (f.a2 - f.b2);
    to.separation = dot(to.p2 - to.p1, f.n);
    to.feature = featureNumber(featureCode(i1), featureCode(i2));
  };
  auto& [low, high] = out.points;
  put(low, lo, f.ia1, f.ib2), put(high, hi, f.ib1, f.ia2);
  bool keepsLow = low.separation <= pair.limit, keepsHigh = high.separation <= pair.limit;
  if (hi - lo <= pair.rounding) {  // one place
    (high.separation < low.separation ? keepsLow : keepsHigh) = false;
  }
  if (!keepsLow) low = high;
  out.count = int{keepsLow} + int{keepsHigh};
}

// The nearest points of two edges of cores that are apart, along the way from one to the other.
void nearest(const Facing& f, const PlacedPair<2>& pair, Contacts2& out) {
  Patch2 patch;
  closestOfEdges(f.edge1(), f.edge2(), f.n.vec(), true, pair, patch);
  out.n = patch.normal, out.count = patch.count;
  if (patch.count == 0) return;
  const PatchPoint<2>& p = patch.points[0];
  out.points[0] = {p.p1, p.p2, p.separation, p.feature};
}

// Do the edges lie on two sides of a line across n? Edges that touch do not.
bool parted(const Facing& f, const Xy& n) {
  return std::min(dot(n, f.a2), dot(n, f.b2)) > std::max(dot(n, f.a1), dot(n, f.b1));
}

// Of cores that overlap: the foremost corner and the end of the edge that it lies beside, which only rounding makes.
void beside(const Facing& f, Real separation, const PlacedPair<2>& pair, Contacts2& out) {
  out.n = f.n, out.count = 0;
  const Xy t{-f.n.y, f.n.x};
  Real least = std::numeric_limits<Real>::infinity();
  for (int k = 0; k < 4; ++k) {
    const Xy &p1 = k & 1 ? f.b1 : f.a1, &p2 = k & 2 ? f.b2 : f.a2;
    const Real height = dot(p2 - p1, f.n), aside = std::abs(dot(p2 - p1, t));
    if (height > separation + pair.tolerance || !(aside < least)) continue;
    least = aside, out.count = 0;
    out.add({p1, p2, height, featureNumber(featureCode(k & 1 ? f.ib1 : f.ia1), featureCode(k & 2 ? f.ib2 : f.ia2))},
            pair.limit);
  }
}

// The corner of a box farthest along d.
int cornerOfBox(const Xy& d) { return (d.y < 0 ? 0 : 3) ^ (d.x < 0 ? 0 : 1); }

// Of each polygon the best edge; of the second one only if it is better by the pair's tolerance, so that equals do not
// take turns. False: farther than the limit.
struct BestEdges {
  BestEdge first, second;
};
bool searchBoxes(const PlacedPair<2>& pair, BestEdges& best) {
  Axis2 axis1, axis2;
  bestEdgesOfBoxes(pair.view1().half, pair.view2().half, pair.X_12, axis1, axis2);
  if (std::max(axis1.separation, axis2.separation) > pair.limit) return false;
  const Rot<2>& R_12 = pair.X_12.q;
  best.first = {axis1.edge, cornerOfBox(turnedBack(R_12, -Xy(kBoxNormals2[static_cast<std::size_t>(axis1.edge)]))),
                axis1.separation};
  if (axis2.separation > axis1.separation + pair.tolerance) {
    best.second = {axis2.edge, cornerOfBox(-turned(R_12, kBoxNormals2[static_cast<std::size_t>(axis2.edge)])),
                   axis2.separation};
  }
  return true;
}

// No edges: the direction between the vertices is the only axis. Where it is none, any direction is as good.
void collidePoints(const PlacedPair<2>& pair, Contacts2& out) {
  const Xy to = pair.X_12.p;
  const Real distance = std::sqrt(dot(to, to));
  out.n = distance > pair.rounding ? Xy{to.x / distance, to.y / distance} : Xy{1, 0};
  out.add({{0, 0}, to, dot(to, out.n), 0}, pair.limit);
}

void collidePolygons(const PlacedPair<2>& pair, const Core2& c1, const Core2& c2, Contacts2& out, WorkDone& work) {
  const Pose<2>& X_12 = pair.X_12;
  out.count = 0;
  if (c2.count == 1) return collidePoints(pair, out);  // kinds are in order: the first is one, too
  BestEdges best;
  std::uint64_t& axes = work[WorkCount::axisTests];
  const auto searchSecond = [&](Real known) {
    const Pose<2> X_21{(-turnedBack(X_12.q, X_12.p)).vec(), X_12.q.inverse()};
    const int i = std::max(best.first.edge, 0);
    const Xy a = placed(X_21, c1.v[i]), b = placed(X_21, c1.v[after(c1, i)]);
    best.second = outermostEdge(
        c2, c1, X_21, known, i, [&](int j) { return std::min(beyond(c2, j, a), beyond(c2, j, b)); }, axes);
  };
  if (pair.view1().core() == CoreClass::box && pair.view2().core() == CoreClass::box) {
    axes += 4;
    if (!searchBoxes(pair, best)) return;
  } else {
    if (c1.count > 1) {
      const int at = foremost(c2, turnedBack(X_12.q, within(c1) - placed(X_12, within(c2))));
      const Xy corner = placed(X_12, c2.v[at]);
      best.first = outermostEdge(
          c1, c2, X_12, best.first.separation, at, [&](int i) { return beyond(c1, i, corner); }, axes);
    }
    if (!(best.first.separation > pair.limit)) searchSecond(best.first.separation + pair.tolerance);
  }
  Real separation = best.second.edge >= 0 ? best.second.separation : best.first.separation;
  if (separation > pair.limit || std::max(best.first.edge, best.second.edge) < 0) return;  // far, or no numbers
  Facing f = best.second.edge >= 0 ? facingSecond(c1, c2, X_12, best.second) : facingFirst(c1, c2, X_12, best.first);
  const auto clipped = [&] {
    clip(f, pair, out);
    return out.deepest() <= separation + pair.tolerance;
  };
  if (clipped()) return;
  if (best.first.edge >= 0 && best.second.edge < 0) {
    searchSecond(best.first.separation);
    if (best.second.edge >= 0) {
      separation = best.second.separation;
      f = facingSecond(c1, c2, X_12, best.second);
      if (clipped()) return;
    }
  }
  nearest(f, pair, out);
  const bool flat = c1.count <= 2 && c2.count <= 2;
  if (!(separation > 0 || (flat && parted(f, out.n)))) beside(f, separation, pair, out);
}

// As placePair, with Xy.
PlacedPair<2> placePolygons(const ContactInput<2>& in, const ConvexPair<2>& pair, Real bias) {
  const auto poseOf = [&](std::int32_t shape) -> const Pose<2>& {
    return in.pose[static_cast<std::size_t>(in.shapes[static_cast<std::size_t>(shape)].body)];
  };
  PlacedPair<2> out;
  out.pair = &pair;
  out.swapped = pair.a.kind > pair.b.kind;
  const Pose<2>& X_W1 = poseOf(out.swapped ? pair.shapes.b : pair.shapes.a);
  const Pose<2>& X_W2 = poseOf(out.swapped ? pair.shapes.a : pair.shapes.b);
  const Pose<2>&X_C1 = out.X_C1(), &X_C2 = out.X_C2();
  out.R_W1 = X_W1.q * X_C1.q;
  const Xy p_12 = turnedBack(out.R_W1, (Xy(X_W2.p) - Xy(X_W1.p)) + (turned(X_W2.q, X_C2.p) - turned(X_W1.q, X_C1.p)));
  out.X_12.p[0] = p_12.x, out.X_12.p[1] = p_12.y;
  out.X_12.q = out.R_W1.inverse() * (X_W2.q * X_C2.q);
  const ShapeView<2>&s1 = out.view1(), &s2 = out.view2();
  out.limit = in.margin + s1.radius + s2.radius;
  out.rounding = kNoise * (coreReach(s1) + coreReach(s2) + std::abs(p_12.x) + std::abs(p_12.y));
  out.tolerance = std::max(std::min(bias, kThinPart * std::min(coreThickness(s1), coreThickness(s2))), out.rounding);
  return out;
}

// As addPatch, with Xy. A vertex touches in one place, whose number is the same wherever it is.
void addContacts(const ContactInput<2>& in, const PlacedPair<2>& pair, Contacts2& c, std::vector<Manifold<2>>& fresh) {
  if (c.count == 0) return;
  struct Started {  // made where it stays, not copied there
    const ContactInput<2>& in;
    const ConvexPair<2>& pair;
    operator Manifold<2>() const { return startManifold(in, pair); }
  };
  Manifold<2>& m = fresh.emplace_back(Started{in, *pair.pair});
  const Real r1 = pair.view1().radius, r2 = pair.view2().radius;
  const Xy n_W = turned(pair.R_W1, c.n);
  (pair.swapped ? -n_W : n_W).to(m.normal);
  m.count = c.count;
  if (pair.view1().core() == CoreClass::point) c.points[0].feature = featureNumber(featureCode(0), kNoFeature);
  const auto featureOf = [&](std::size_t i) {
    const std::uint64_t feature = c.points[i].feature;
    return pair.swapped ? feature << 32 | feature >> 32 : feature;
  };
  const std::size_t lower = c.count == 2 && featureOf(1) < featureOf(0) ? 1 : 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(c.count); ++i) {
    const Contact2& p = c.points[i ^ lower];
    ContactPoint<2>& to = m.points[i];
    const Xy local1 = placed(pair.X_C1(), p.p1 + r1 * c.n);
    const Xy local2 = placed(pair.X_C2(), turnedBack(pair.X_12.q, p.p2 - r2 * c.n - Xy(pair.X_12.p)));
    (pair.swapped ? local2 : local1).to(to.localA), (pair.swapped ? local1 : local2).to(to.localB);
    to.separation = p.separation - r1 - r2;
    to.feature = featureOf(i ^ lower);
  }
  // Beyond 65,536 vertices numbers may coincide.
  if (c.count == 2 && m.points[1].feature == m.points[0].feature) ++m.points[1].feature;
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
    Contacts2 contacts;
    for (const ConvexPair<D>& pair : in.pairs) {
      const PlacedPair<D> place = placePolygons(in, pair, m_params.bias);
      if (hasPlane(place)) {
        const Vec<D> n = planePatch(place, Reduction::spread, m_plane);
        addPatch<D>(in, place, n, m_plane.points, fresh);
        continue;
      }
      OwnVertices2 own1, own2;
      collidePolygons(place, roundedPolygon(place.view1(), own1), roundedPolygon(place.view2(), own2), contacts, work);
      addContacts(in, place, contacts, fresh);
    }
  }

 private:
  Params m_params;
  PlaneScratch<D> m_plane;
};

}  // namespace

LPC_REGISTER(ContactGenerator, RoundedPolygon, 2);

}  // namespace lpc::inline LPC_PRECISION
