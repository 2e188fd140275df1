// SPDX-License-Identifier: Zlib
#include <algorithm>
#include <cmath>
#include <map>

#include "framework/math/random.h"
#include "framework/math/tolerances.h"
#include "framework/shape/support_map.h"
#include "oracles/verify/regime.h"
#include "oracles/verify/verdict.h"
#include "oracles/verify/verify.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

constexpr std::string_view kRestingFaces = "resting_faces";
constexpr int kRestingEvery = 8;  // one in this many pairs of boxes and polytopes
// Features of faces at rest are compared again at displacements of one to two times this (m).
constexpr double kBeside = 0.01;
// Number of displacements in this range (count). Fewer: a fault that appears under few motions counts as chance.
constexpr int kPlacesBeside = 1000;
// Up to this many changes of features over the range are chance (count): our methods have more than five on one range
// of 7,500. More: unstable features pass. Fewer: corners that pass each other make a method wrong.
constexpr int kMostChanges = 8;
// A generator that names this test in its failures keeps one point of a patch on purpose.
constexpr std::string_view kPatchTest = "Contacts.FaceContactsSpanThePatch";

template <int D>
struct PlacedHard {
  HardPair<D> pair;
  RefereeAnswer<D> truth = {};
  double s = 0;
  double allowed = 0;  // a generator may prefer one feature to another by this much (m)
  int vertices = 0;
  Labels labels = {};

  bool resting() const { return pair.X_WBNudged.has_value(); }
};

// Motion of faces at rest (m): at least ten rounding errors.
double motionOfRest() { return sizeof(Real) == 8 ? 1e-6 : 1e-5; }

bool hasFaces(ShapeKind k) { return k == ShapeKind::box || k == ShapeKind::polytope; }

/// B's face on A's face, as bodies rest: slightly separated or penetrating, rotated about the normal, hardly tilted.
template <int D>
class RestingFaces {
 public:
  explicit RestingFaces(std::uint64_t seed) : m_random(seed) {}

  HardPair<D> draw(ShapeKind kindA, ShapeKind kindB) {
    Vec<D> halfA, halfB;
    std::vector<Vec<D>> pointsA, pointsB;
    HardPair<D> pair{.a = block(kindA, halfA, pointsA), .b = block(kindB, halfB, pointsB), .family = kRestingFaces};
    pair.pointsA = std::move(pointsA), pair.pointsB = std::move(pointsB);
    Ang<D> v = Ang<D>::Zero();
    v[0] = static_cast<Real>(std::array{0.0, 1e-9, 1e-4}[m_random.below(3)]);
    if constexpr (D == 3) v[2] = uniform(-1, 1);
    pair.X_AB.q = turned(v);
    for (int k = 0; k < D - 1; ++k) pair.X_AB.p[k] = Real(0.4) * std::min(halfA[k], halfB[k]) * uniform(-1, 1);
    const Real gap = kLinearSlop * uniform(-1, 1);
    pair.X_AB.p[D - 1] = halfA[D - 1] + halfB[D - 1] + pair.a.view().radius + pair.b.view().radius + gap;
    Ang<D> w;
    for (int k = 0; k < kAngDim<D>; ++k) w[k] = uniform(-3, 3);
    for (int k = 0; k < D; ++k) pair.X_WA.p[k] = uniform(-3, 3);
    pair.X_WA.q = turned(w);
    pair.X_WB = pair.X_WA * pair.X_AB;
    pair.X_WBNudged = nudged(pair.X_WB);
    return pair;
  }

 private:
  // A motion of a micrometre (f32: ten) and a tenth of a microradian.
  Pose<D> nudged(Pose<D> X) {
    for (int k = 0; k < D; ++k) X.p[k] += static_cast<Real>(motionOfRest()) * uniform(-1, 1);
    Ang<D> v;
    for (int k = 0; k < kAngDim<D>; ++k) v[k] = Real(1e-7) * uniform(-1, 1);
    X.q = turned(v) * X.q;
    return X;
  }
  Real uniform(double lo, double hi) { return static_cast<Real>(m_random.uniform(lo, hi)); }
  static Rot<2> turned(const Ang<2>& v) { return Rot<2>::angle(v[0]); }
  static Rot<3> turned(const Ang<3>& v) { return Rot<3>::vector(v); }

  // A box, or its corners as a polytope; in 3D often a prism on an n-gon.
  Shape<D> block(ShapeKind kind, Vec<D>& half, std::vector<Vec<D>>& points) {
    for (int k = 0; k < D; ++k) half[k] = uniform(0.3, 1);
    const Real rounding = m_random.below(4) == 0 ? Real(0.1) : Real(0);
    if (kind == ShapeKind::box) return Shape<D>::box(half, rounding);
    const auto n = static_cast<int>(4 + m_random.below(5));
    for (int i = 0; i < n; ++i) {
      Vec<D> p = half;
      if constexpr (D == 3) {
        const double angle = 6.283185307179586 * (i + 0.5) / n;
        p[0] *= static_cast<Real>(std::cos(angle)), p[1] *= static_cast<Real>(std::sin(angle));
      } else {
        p[0] *= i % 2 ? Real(1) : Real(-1);
      }
      points.push_back(p);
      p[D - 1] = -p[D - 1];
      points.push_back(p);
    }
    return Shape<D>::polytope(std::span<const Vec<D>>(points), rounding);
  }

  Random m_random;
};

// Moves B by `far` (m) along the faces (n: their normal in the world), in a direction independent of their sides: they
// rest as before.
template <int D>
HardPair<D> movedBeside(HardPair<D> pair, const Vecd<D>& n, double far) {
  Vecd<D> aside;
  if constexpr (D == 2) {
    aside = {-n[1], n[0]};
  } else {
    const RealMatrix<3, 2> across = tangents(Vec<3>(n.template cast<Real>()));
    aside = (across * Vec<2>(Real(0.8), Real(0.6))).template cast<double>();
  }
  const Vec<D> way = (far * aside).template cast<Real>();
  pair.X_WB.p += way, pair.X_WBNudged->p += way;
  return pair;
}

// A length (m) that is far above generators' tolerances: the thickness of a core, or half the length of a core without
// thickness.
template <int D>
double coreSize(const ShapeView<D>& s) {
  if (s.core() == CoreClass::point || s.core() == CoreClass::plane) return std::numeric_limits<double>::max();
  const Aabb<D> box = boundingBox(s, Pose<D>{});
  const Vecd<D> half = (box.hi - box.lo).template cast<double>() / 2 - Vecd<D>::Constant(static_cast<double>(s.radius));
  return s.core() == CoreClass::box || s.core() == CoreClass::curved ? half.minCoeff() : half.norm();
}

template <int D>
HardPair<D> drawnPair(ShapeKind a, ShapeKind b, std::uint64_t seed, int index) {
  if (!hasFaces(a) || !hasFaces(b) || index % kRestingEvery != 0) return hardPair<D>(a, b, seed, index);
  return RestingFaces<D>(seed * 1000003 + static_cast<std::uint64_t>(index)).draw(a, b);
}

template <int D>
PlacedHard<D> placedPair(HardPair<D> pair) {
  PlacedHard<D> placed{.pair = std::move(pair)};
  const HardPair<D>& p = placed.pair;
  placed.vertices = coreVertexCount<D>(p.a.view()) + coreVertexCount<D>(p.b.view());
  placed.truth = referee<D>(p.a.view(), p.X_WA, p.b.view(), p.X_WB);
  placed.s = errorScale<D>(p.a.view(), p.X_WA, p.b.view(), p.X_WB, placed.truth.interval().middle());
  const double thinner = 0.01 * std::min(coreSize(p.a.view()), coreSize(p.b.view()));
  placed.allowed = std::min(static_cast<double>(kLinearSlop) / 10, thinner) +
                   1000 * static_cast<double>(std::numeric_limits<Real>::epsilon()) * placed.s;
  // The regime is computed in A's frame.
  RefereeAnswer<D> inA = placed.truth;
  inA.normal = p.X_WA.q.matrix().template cast<double>().transpose() * placed.truth.normal;
  placed.labels = {{"family", std::string(p.family)}, {"regime", std::string(regimeOf(p, inA))}};
  return placed;
}

template <int D>
using Manifolds = std::map<std::int32_t, std::vector<Manifold<D>>>;  // by shapeA

// All pairs in one call, as in a world.
template <int D>
Manifolds<D> generate(ContactGenerator<D>& generator, const std::vector<PlacedHard<D>>& placed, bool nudge,
                      double& spent) {
  std::vector<ShapeRecord<D>> shapes;
  std::vector<Pose<D>> pose;
  std::vector<ShapePair> pairs;
  for (const PlacedHard<D>& p : placed) {
    const auto slot = static_cast<std::int32_t>(shapes.size());
    if (!nudge || p.resting()) pairs.push_back({slot, slot + 1});
    shapes.push_back({.shape = p.pair.a, .body = slot});
    shapes.push_back({.shape = p.pair.b, .body = slot + 1});
    pose.push_back(p.pair.X_WA);
    pose.push_back(nudge && p.resting() ? *p.pair.X_WBNudged : p.pair.X_WB);
  }
  PartPairs<D> partPairs;
  WorkDone work;
  const auto convexPairs = partPairs.of(pairs, shapes, pose, kContactMargin, work);
  std::vector<Manifold<D>> fresh;
  const double before = threadNanoseconds();
  generator.generate({convexPairs, shapes, pose, kContactMargin, true}, fresh, work);
  spent = threadNanoseconds() - before;
  Manifolds<D> out;
  for (const Manifold<D>& m : fresh) out[m.shapeA].push_back(m);
  return out;
}

// Signed distance of the world point from the shape, negative inside (m).
template <int D>
double pointDistance(const Vec<D>& p_W, const ShapeView<D>& shape, const Pose<D>& X_WS) {
  return referee<D>(Shape<D>::sphere(0).view(), {p_W, {}}, shape, X_WS).interval().middle();
}

// How far the contact points are misplaced (m): a point must be in its shape; for a shape without rounding it must be
// on the surface.
template <int D>
double besideSurfaces(const PlacedHard<D>& k, const Manifold<D>& m) {
  const HardPair<D>& p = k.pair;
  double most = 0;
  for (int i = 0; i < m.count; ++i) {
    const ContactPoint<D>& c = m.points[static_cast<std::size_t>(i)];
    const double a = pointDistance<D>(p.X_WA * c.localA, p.a.view(), p.X_WA);
    const double b = pointDistance<D>(p.X_WB * c.localB, p.b.view(), p.X_WB);
    most = std::max({most, a, b});
    if (p.a.view().radius == 0) most = std::max(most, -a);
    if (p.b.view().radius == 0) most = std::max(most, -b);
  }
  return most;
}

template <int D>
bool sameFeatures(const std::vector<Manifold<D>>& a, const std::vector<Manifold<D>>& b) {
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i].count != b[i].count) return false;
    for (std::size_t k = 0; k < static_cast<std::size_t>(a[i].count); ++k) {
      if (a[i].points[k].feature != b[i].points[k].feature) return false;
    }
  }
  return true;
}

// Fault of a pair's manifold, empty when it has none; `off` is its size (m) when it is a length.
template <int D>
std::string_view faultOf(const PlacedHard<D>& k, const Manifold<D>& m, double& deepest, double& off) {
  const double phi = k.truth.interval().middle(), allowed = 2 * k.allowed;
  deepest = std::numeric_limits<double>::infinity();
  if (m.count < 1 || m.count > kManifoldPoints<D>) return "wrong_count";
  for (std::size_t i = 0; i < static_cast<std::size_t>(m.count); ++i) {
    const ContactPoint<D>& c = m.points[i];
    if (!std::isfinite(c.separation) || !c.localA.allFinite() || !c.localB.allFinite()) return "not_finite";
    if (i > 0 && c.feature <= m.points[i - 1].feature) return "wrong_features";
    deepest = std::min(deepest, static_cast<double>(c.separation));
  }
  if (!m.normal.allFinite()) return "not_finite";
  const Vecd<D> n = m.normal.template cast<double>();
  if (!(std::abs(n.norm() - 1) <= static_cast<double>(kUnitTolerance))) return "wrong_normal";
  const HardPair<D>& p = k.pair;
  off = phi - separationAlong<D>(p.a.view(), p.X_WA, p.b.view(), p.X_WB, n).hi;
  if (off > allowed) return "wrong_normal";
  off = std::abs(deepest - phi);
  if (!(off <= allowed)) return "wrong_depth";
  const double beside = besideSurfaces(k, m);
  if (beside <= k.allowed) return "";
  off = beside;
  return "wrong_points";
}

template <int D>
const std::vector<Manifold<D>>* manifoldsOf(const Manifolds<D>& all, std::size_t i) {
  const auto at = all.find(static_cast<std::int32_t>(2 * i));
  return at == all.end() ? nullptr : &at->second;
}

// Counts changes of features in the range of displacements: under the small motion at each place, and from place to
// place. Stops above kMostChanges. A missing manifold is a change.
template <int D>
int changesBeside(const PlacedHard<D>& k, ContactGenerator<D>& generator) {
  int changes = 0;
  std::vector<PlacedHard<D>> at(1, k);
  std::vector<Manifold<D>> last;
  for (int i = 0; i < kPlacesBeside && changes <= kMostChanges; ++i) {
    at[0].pair = movedBeside<D>(k.pair, k.truth.normal, kBeside * (1 + static_cast<double>(i) / kPlacesBeside));
    for (const bool nudge : {false, true}) {
      double ignored = 0;
      const Manifolds<D> all = generate(generator, at, nudge, ignored);
      const auto* here = manifoldsOf<D>(all, 0);
      changes += !here || (!last.empty() && !sameFeatures(last, *here));
      last = here ? *here : std::vector<Manifold<D>>{};
    }
  }
  return changes;
}

// Fault after a small motion of faces at rest. Their margin is far larger than the motion: they must keep their
// manifold. A corner is named while it lies on the other face, and not when it lies far beside it. So names change
// somewhere along every path, with every generator. A pair drawn at such a place is a tie. But such places are rare.
template <int D>
std::string_view faultOfMotion(const PlacedHard<D>& k, const std::vector<Manifold<D>>& found,
                               const std::vector<Manifold<D>>* nudged, ContactGenerator<D>& generator, Verdict& v) {
  v.wrongSide = !nudged;
  if (!nudged) return "wrong_side";
  if (nudged->size() != 1) return "wrong_count";
  if (sameFeatures(found, *nudged)) return "";
  if (changesBeside(k, generator) > kMostChanges) return "wrong_features";
  v.end = Tally::tie;
  return "";
}

template <int D>
Verdict judge(const PlacedHard<D>& k, const std::vector<Manifold<D>>* found, const std::vector<Manifold<D>>* nudged,
              bool onePoint, ContactGenerator<D>& generator) {
  Verdict v;
  const auto wrong = [&](std::string_view failure) {
    v.end = failure == "not_finite" ? Tally::notFinite : Tally::wrong, v.failure = failure;
    return v;
  };
  if (!k.truth.decided || 10 * k.truth.interval().width() > k.allowed) return withoutAnswer(Tally::undecided);
  const double phi = k.truth.interval().middle(), margin = static_cast<double>(kContactMargin);
  if (!found) {
    v.wrongSide = phi < margin - 2 * k.allowed;
    return v.wrongSide ? wrong("wrong_side") : v;
  }
  v.wrongSide = phi > margin + 2 * k.allowed;
  if (v.wrongSide) return wrong("wrong_side");
  if (found->size() != 1) return wrong("wrong_count");
  double deepest = 0, off = 0;
  const std::string_view fault = faultOf(k, found->front(), deepest, off);
  if (std::isfinite(deepest)) v.value = deepest, v.error = std::max(off, std::abs(deepest - phi)) / k.s;
  if (!fault.empty()) return wrong(fault);
  if (k.resting() && !onePoint && found->front().count < (D == 2 ? 2 : 3)) return wrong("wrong_patch");
  const std::string_view moved = k.resting() ? faultOfMotion(k, *found, nudged, generator, v) : "";
  return moved.empty() ? v : wrong(moved);
}

bool keepsOnePoint(const AlgorithmInfo& info) {
  const auto declares = [](const FailureMode& f) { return f.test == kPatchTest; };
  return std::any_of(info.failures.begin(), info.failures.end(), declares);
}

}  // namespace

template <int D>
Verdict verifyPair(const HardPair<D>& pair, const Candidate<ContactGenerator<D>>& method) {
  const std::vector<PlacedHard<D>> placed{placedPair(pair)};
  const auto generator = method.create();
  double spent = 0;
  const Manifolds<D> fresh = generate(*generator, placed, false, spent),
                     nudged = generate(*generator, placed, true, spent);
  return judge(placed[0], manifoldsOf<D>(fresh, 0), manifoldsOf<D>(nudged, 0), keepsOnePoint(method.info), *generator);
}

template Verdict verifyPair(const HardPair<2>&, const Candidate<ContactGenerator<2>>&);
template Verdict verifyPair(const HardPair<3>&, const Candidate<ContactGenerator<3>>&);

template <int D>
void verifyContacts(ShapeKind kindA, ShapeKind kindB, const VerifyRange& range,
                    std::span<const Candidate<ContactGenerator<D>>> methods, Verified& out) {
  std::vector<PlacedHard<D>> placed;
  for (int i = 0; i < range.count; ++i) {
    placed.push_back(placedPair(drawnPair<D>(kindA, kindB, range.seed, range.first + i)));
  }
  for (const Candidate<ContactGenerator<D>>& m : methods) {
    const auto generator = m.create();
    if (!generator->supports(kindA, kindB)) continue;
    double spent = 0, ignored = 0;
    Manifolds<D> fresh, nudged;
    if (!range.ended) {
      fresh = generate(*generator, placed, false, spent);
      nudged = generate(*generator, placed, true, ignored);
    }
    LedgerKey subject = subjectOf(StageKind::contacts, D, m.name);
    subject.kindA = shapeKindName(kindA), subject.kindB = shapeKindName(kindB);
    for (std::size_t i = 0; i < placed.size(); ++i) {
      const auto of = [i](const Manifolds<D>& all) { return manifoldsOf<D>(all, i); };
      const Verdict verdict = range.ended ? withoutAnswer(*range.ended)
                                          : judge(placed[i], of(fresh), of(nudged), keepsOnePoint(m.info), *generator);
      const auto text = [&] {
        const int index = range.first + static_cast<int>(i);
        return caseText<D>(inputName(subject, range.seed, index), StageKind::contacts, placed[i].pair,
                           findingText(subject, verdict, range.seed, index) + expectedText(placed[i].truth));
      };
      book(out.ledger, subject, m.info.role, placed[i].labels, verdict, spent / range.count, text);
      if (!verdict.failure.empty() && verdict.end != Tally::undecided) {
        out.keep({m.name, verdict.failure, placed[i].vertices, placed[i].s, text()});
      }
    }
  }
}

template void verifyContacts(ShapeKind, ShapeKind, const VerifyRange&, std::span<const Candidate<ContactGenerator<2>>>,
                             Verified&);
template void verifyContacts(ShapeKind, ShapeKind, const VerifyRange&, std::span<const Candidate<ContactGenerator<3>>>,
                             Verified&);

}}  // namespace lpc::LPC_PRECISION
