// SPDX-License-Identifier: Zlib
// Every method for the time of impact, on moving pairs of every kind: against the referee, and against itself.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <map>

#include "oracles/referee/impact_bracket.h"
#include "tests/check_property.h"
#include "tests/generators.h"
#include "tests/planted_bugs/time_of_impact_bugs.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace time_of_impact_test {
namespace time_of_impact_test {

using namespace wrong_casts;

constexpr int kRuns = 500;

template <int D>
struct Drawn {
  Shape<D> a = Shape<D>::sphere(1), b = Shape<D>::sphere(1);
  ShapeMotion<D> A, B;

  MovingPair<D> pair() const { return {a.view(), b.view(), A, B}; }
};

template <int D>
std::ostream& operator<<(std::ostream& out, const ShapeMotion<D>& m) {
  out << "X_WC " << m.X_WC << "\nX_CS " << m.X_CS << "\nv " << listText<D>(m.motion.v) << " w";
  for (int k = 0; k < kAngDim<D>; ++k) out << ' ' << m.motion.w[k];
  return out;
}
template <int D>
std::ostream& operator<<(std::ostream& out, const Drawn<D>& c) {
  return out << "\nA " << c.a << '\n' << c.A << "\nB " << c.b << '\n' << c.B << '\n';
}

// Most pairs approach: B moves roughly towards A. Within the second they hit, miss, or fly through.
template <int D>
Drawn<D> drawMoving(Draw& draw) {
  const ShapePairCase<D> c = drawShapePair<D>(draw);
  Drawn<D> out{c.a, c.b, {}, {}};
  const int strange = draw.below(16);  // the generator draws pairs of the other kinds
  if (strange == 14 || strange == 15) {
    const auto curved = draw.below(static_cast<int>(curvedKinds<D>().size()));
    out.b = drawSketch<D>(draw, std::next(curvedKinds<D>().begin(), curved)->first).build(sizeOf(c.a));
  }
  if (strange == 13) out.b = Shape<D>::plane();
  if (out.a.kind() > out.b.kind()) std::swap(out.a, out.b);
  const Real size = strange == 13 ? sizeOf(out.a) : std::max(sizeOf(out.a), sizeOf(out.b));
  Vec<D> way = Real(3) * size * draw.real(0, 1) * drawDirection<D>(draw);
  for (auto* m : {&out.A, &out.B}) {
    m->X_WC = c.X_WA;
    if (draw.coin()) m->X_WC.q = drawRotation<D>(draw);
    if (draw.coin()) m->X_CS = drawPose<D>(draw, draw.real(0, 1) * size);
    if (draw.coin()) {
      for (int k = 0; k < kAngDim<D>; ++k) m->motion.w[k] = draw.signedUnit() * draw.pick({Real(1), Real(10)});
    }
  }
  out.B.X_WC.p += way * draw.pick({Real(1), Real(2), Real(0), Real(3)});
  const Real speed = draw.pick({Real(1), Real(3), Real(30), Real(0)});
  out.B.motion.v = -speed * (way + size * draw.real(0, 2) * drawDirection<D>(draw));
  if (draw.coin()) {  // both move
    const Vec<D> both = size * draw.signedUnit() * drawDirection<D>(draw);
    out.A.motion.v += both, out.B.motion.v += both;
  }
  if (out.b.isPlane()) {  // the plane does not move, and the other shape comes down on it
    out.B = {};
    if (draw.coin()) out.B.X_WC.q = drawRotation<D>(draw);
    const Vec<D> up = out.B.X_WC.q * Vec<D>(Vec<D>::Unit(1));
    out.A.X_WC.p = Real(2) * size * draw.real(0, 1) * up + size * drawVector<D>(draw);
    out.A.motion.v = -speed * size * draw.real(0, 1) * up + size * draw.signedUnit() * drawDirection<D>(draw);
  }
  return out;
}
template <int D>
Gen<Drawn<D>> movingPairs() {
  return Gen<Drawn<D>>(drawMoving<D>);
}

template <int D>
TimeOfImpactAnswer<D> cast(TimeOfImpact<D>& method, const MovingPair<D>& pair, WorkDone& work, Real duration = 1) {
  TimeOfImpactAnswer<D> answer;
  method.cast({&pair, 1}, duration, {&answer, 1}, work);
  return answer;
}
template <int D>
TimeOfImpactAnswer<D> cast(TimeOfImpact<D>& method, const MovingPair<D>& pair, Real duration = 1) {
  WorkDone work;
  return cast(method, pair, work, duration);
}

// Checks without a referee (C1 to C3): the shapes touch at the time of impact, and are apart at 64 times before it;
// without a hit, at all times.
template <int D>
class Question {
 public:
  Question(const MovingPair<D>& pair, Real duration) : m_pair(pair), m_duration(duration) {}

  std::string fault(const TimeOfImpactAnswer<D>& answer, Real allowed = 1) {
    const Real t = answer.t;
    if (!(t >= 0 && t <= m_duration)) return "the time is not within the motion: " + std::to_string(t);
    if (answer.status == QueryStatus::failed || answer.status == QueryStatus::refused) return "no answer";
    const Real band = allowed * static_cast<Real>(kImpactBand);
    if (answer.hit && distance(t) > band * size(t)) return "apart by " + std::to_string(distance(t)) + " at impact";
    for (int k = 0; k <= 64; ++k) {
      const Real s = t * Real(k) / 64;
      if (s == 0 && answer.hit && t == 0) continue;  // deep in each other from the start
      if (distance(s) < -band * size(s)) return "in each other at " + std::to_string(s) + " of " + std::to_string(t);
    }
    if (!answer.hit && answer.status == QueryStatus::converged && t < m_duration) return "ends early without a hit";
    return "";
  }

 private:
  Real distance(Real t) {
    const PairView<D> view = m_pair.at(t);
    return queryPair(*m_query, view.a, view.b, view.X_AB, QueryNeed::distance).distance;
  }
  Real size(Real t) const {
    const auto at = [&](const ShapeMotion<D>& m) { return m.bodyAt(t) * m.X_CS; };
    return static_cast<Real>(errorScale(m_pair.a, at(m_pair.A), m_pair.b, at(m_pair.B), 0));
  }

  MovingPair<D> m_pair;
  Real m_duration;
  std::unique_ptr<PairQuery<D>> m_query = createStage<PairQuery<D>>(Spec{"gjk_epa", {}});
};

template <int D>
class Properties {
 public:
  explicit Properties(TimeOfImpact<D>& method) : m_method(method) {}

  using Fault = std::string (Properties::*)(const Drawn<D>&, Draw&);
  static const std::map<std::string, Fault>& all() {
    using P = Properties;
    static const std::map<std::string, Fault> list = {{"C1 touches at impact", &P::answered},
                                                      {"C2 apart before", &P::answered},
                                                      {"C3 none is missed", &P::answered},
                                                      {"C4 still or receding", &P::still},
                                                      {"C5 time reversal", &P::reversed},
                                                      {"C6 faster and shorter", &P::hastened},
                                                      {"C7 swapped", &P::swapped},
                                                      {"C8 any speed ends", &P::extremes},
                                                      {"C9 both carried along", &P::carried}};
    return list;
  }
  std::string fault(const Drawn<D>& drawn, Draw& draw, const std::string& only) {
    if (!m_method.supports(drawn.a.kind(), drawn.b.kind())) return "";
    for (const auto& [name, f] : all()) {
      if (!only.empty() && only != name) continue;
      if (const std::string text = (this->*f)(drawn, draw); !text.empty()) return name + ": " + text;
    }
    return "";
  }

 private:
  std::string answered(const Drawn<D>& c, Draw&) { return Question<D>(c.pair(), 1).fault(cast(m_method, c.pair())); }
  // No motion; or both bodies only separate, along the normal of their gap.
  std::string still(const Drawn<D>& c, Draw&) {
    MovingPair<D> pair = c.pair();
    pair.A.motion = pair.B.motion = {};
    const PairView<D> view = pair.at(0);
    const PairAnswer<D> now = queryPair(*createStage<PairQuery<D>>(Spec{"gjk_epa", {}}), view.a, view.b, view.X_AB);
    const Real size = boundingRadius(view.a) + (c.b.isPlane() ? Real(0) : boundingRadius(view.b));
    if (!(now.distance > Real(1e-3) * size)) return "";
    if (cast(m_method, pair).hit) return "a still pair meets";
    const Vec<D> away = 10 * size * (pair.A.bodyAt(0).q * (pair.A.X_CS.q * now.normal));
    (c.b.isPlane() ? pair.A.motion.v : pair.B.motion.v) = c.b.isPlane() ? Vec<D>(-away) : away;
    return cast(m_method, pair).hit ? "a receding pair meets" : "";
  }
  // With time reversed, a pair hits if and only if it did before.
  std::string reversed(const Drawn<D>& c, Draw&) {
    const TimeOfImpactAnswer<D> forward = cast(m_method, c.pair());
    MovingPair<D> back = c.pair();
    for (ShapeMotion<D>* m : {&back.A, &back.B}) {
      m->X_WC = m->bodyAt(1);
      m->motion.v = -m->motion.v, m->motion.w = -m->motion.w;
    }
    const TimeOfImpactAnswer<D> answer = cast(m_method, back);
    if (answer.hit != forward.hit && answer.status == QueryStatus::converged &&
        forward.status == QueryStatus::converged) {
      // Rounding decides about grazing.
      TimeOfImpactAnswer<D> other{QueryStatus::converged, false, 1, {}};
      const Question<D> seenBack(back, 1);
      if (!Question<D>(c.pair(), 1).fault(other, 16).empty()) return "one way they meet, the other they do not";
    }
    return Question<D>(back, 1).fault(answer);
  }
  std::string hastened(const Drawn<D>& c, Draw& draw) {
    const Real k = draw.pick({Real(8), Real(0.125), Real(1024)});
    MovingPair<D> pair = c.pair();
    for (ShapeMotion<D>* m : {&pair.A, &pair.B}) m->motion.v *= k, m->motion.w *= k;
    TimeOfImpactAnswer<D> answer = cast(m_method, pair, 1 / k);
    answer.t *= k;
    return Question<D>(c.pair(), 1).fault(answer, 2);
  }
  std::string swapped(const Drawn<D>& c, Draw&) {
    if (c.a.kind() != c.b.kind()) return "";
    return Question<D>(c.pair(), 1).fault(cast(m_method, MovingPair<D>{c.b.view(), c.a.view(), c.B, c.A}), 2);
  }
  std::string extremes(const Drawn<D>& c, Draw& draw) {
    MovingPair<D> pair = c.pair();
    const Real speed = draw.pick({Real(0), std::numeric_limits<Real>::denorm_min(), Real(1e-300), Real(1e6)});
    if (c.b.isPlane()) return "";
    const Real size = boundingRadius(pair.a) + boundingRadius(pair.b);
    pair.B.motion.v = speed * size * (c.pair().A.X_WC.p - c.pair().B.X_WC.p);
    pair.A.motion = {}, pair.B.motion.w.setZero();
    return Question<D>(pair, 1).fault(cast(m_method, pair));
  }
  std::string carried(const Drawn<D>& c, Draw& draw) {
    if (c.b.isPlane()) return "";
    MovingPair<D> pair = c.pair();
    const Vec<D> wind = (boundingRadius(pair.a) + boundingRadius(pair.b)) * drawVector<D>(draw);
    pair.A.motion.v += wind, pair.B.motion.v += wind;
    return Question<D>(c.pair(), 1).fault(cast(m_method, pair), 4);
  }

  TimeOfImpact<D>& m_method;
};

template <int D>
auto holdsFor(TimeOfImpact<D>& method, const std::string& only = "") {
  return [&method, only] {
    const Drawn<D> drawn = *movingPairs<D>();
    RapidCheckDraw draw;
    const std::string fault = Properties<D>(method).fault(drawn, draw, only);
    if (!fault.empty()) {
      RC_LOG() << drawn;
      RC_FAIL(fault);
    }
  };
}

template <int D>
void forEach(const std::function<void(const AlgorithmInfo&, TimeOfImpact<D>&)>& f) {
  int methods = 0;
  for (const Registered* r : Registry::instance().list(StageKind::timeOfImpact, D)) {
    if (r->info.role != AlgorithmRole::competitor) continue;
    SCOPED_TRACE(r->info.name);
    f(r->info, *createStage<TimeOfImpact<D>>(Spec{r->info.name, {}}));
    ++methods;
  }
  EXPECT_GE(methods, 2);
}

template <int D>
void properties() {
  forEach<D>([](const AlgorithmInfo& info, TimeOfImpact<D>& method) {
    check("time of impact " + info.name + " in " + std::to_string(D) + "D", holdsFor<D>(method), kRuns);
  });
}
TEST(TimeOfImpact, Properties2) { properties<2>(); }
TEST(TimeOfImpact, Properties3) { properties<3>(); }

template <int D>
void bugsAreCaught() {
  std::map<std::string, std::unique_ptr<TimeOfImpact<D>>> twins;
  twins["C1 touches at impact"] = std::make_unique<ForgetsTheFirst<D>>();
  twins["C2 apart before"] = std::make_unique<WaitsForOverlap<D>>();
  twins["C3 none is missed"] = std::make_unique<LooksAtTheEnds<D>>();
  twins["C4 still or receding"] = std::make_unique<SpeedWithoutSign<D>>();
  twins["C5 time reversal"] = std::make_unique<ForgetsTurning<D>>();
  twins["C6 faster and shorter"] = std::make_unique<WholeMilliseconds<D>>();
  twins["C7 swapped"] = std::make_unique<ForgetsTheFirst<D>>();
  twins["C8 any speed ends"] = std::make_unique<DividesByTheSpeed<D>>();
  twins["C9 both carried along"] = std::make_unique<ForgetsTheFirst<D>>();
  for (const auto& [name, unused] : Properties<D>::all()) {
    ASSERT_TRUE(twins.contains(name)) << name << " has no planted bug";
    expectFalsified(name + ": " + std::to_string(D) + "D", holdsFor<D>(*twins[name], name), kRuns);
  }
  TurnsAboutTheShape<D> shape;
  expectFalsified("C3 none is missed: turns about the shape, " + std::to_string(D) + "D",
                  holdsFor<D>(shape, "C3 none is missed"), kRuns);
  PlaneTurnsAlong<D> plane;
  expectFalsified("C3 none is missed: a plane turns along, " + std::to_string(D) + "D",
                  holdsFor<D>(plane, "C3 none is missed"), kRuns);
}
TEST(TimeOfImpact, PlantedBugs2) { bugsAreCaught<2>(); }
TEST(TimeOfImpact, PlantedBugs3) { bugsAreCaught<3>(); }

// --- against the referee ---------------------------------------------------------------------------------------------

struct Judged {
  int pairs = 0, hits = 0, limits = 0, undecided = 0;
  WorkDone work;
  std::string first;  // the first fault
};

// Drawn once: brackets of curved shapes are slow.
template <int D>
struct Case {
  Drawn<D> drawn;
  ImpactBracket bracket;
};
template <int D>
const std::vector<Case<D>>& cases() {
  static const std::vector<Case<D>> all = [] {
    std::vector<Case<D>> out;
    PlainDraw draw(seedOf("times of impact before the referee"));
    const int least = D == 2 ? 2000 : 500;  // 500 pairs in 2D would not catch the planted bug of planes
    for (int n = std::max(caseCount(2000), least); n > 0; --n) {
      const Drawn<D> drawn = drawMoving<D>(draw);
      out.push_back({drawn, impactBracket(drawn.pair(), Real(1))});
    }
    return out;
  }();
  return all;
}

template <int D>
Judged judge(TimeOfImpact<D>& method) {
  Judged out;
  for (const Case<D>& c : cases<D>()) {
    const MovingPair<D> pair = c.drawn.pair();
    if (!method.supports(pair.a.kind, pair.b.kind)) continue;
    ++out.pairs;
    if (!c.bracket.decided) {
      ++out.undecided;
      continue;
    }
    const TimeOfImpactAnswer<D> answer = cast(method, pair, out.work);
    out.hits += answer.hit, out.limits += answer.status == QueryStatus::iterationLimit;
    const std::string fault = impactFault(pair, Real(1), answer, c.bracket);
    if (fault.empty() || !out.first.empty()) continue;
    std::ostringstream text;
    text << fault << c.drawn;
    out.first = text.str();
  }
  return out;
}

template <int D>
void truth() {
  forEach<D>([](const AlgorithmInfo& info, TimeOfImpact<D>& method) {
    const Judged seen = judge(method);
    const auto perPair = [&](WorkCount c) { return double(seen.work[c]) / seen.pairs; };
    std::printf("%dD %s: %d pairs, %d hits, %d at their limit, %d undecided; each %.1f queries, %.0f support points\n",
                D, info.name.c_str(), seen.pairs, seen.hits, seen.limits, seen.undecided,
                perPair(WorkCount::pairQueries), perPair(WorkCount::supportCalls));
    EXPECT_EQ(seen.first, "");
    EXPECT_GT(seen.hits, seen.pairs / 4) << "the cases drawn are not representative";
    EXPECT_LT(seen.hits, seen.pairs * 3 / 4);
    EXPECT_LE(seen.undecided, seen.pairs / 20);
    EXPECT_LE(seen.limits, seen.pairs / 50);
  });
}
TEST(TimeOfImpact, AgreesWithTheReferee2) { truth<2>(); }
TEST(TimeOfImpact, AgreesWithTheReferee3) { truth<3>(); }

template <int D>
void refereeSees() {
  const auto seen = [&](const char* bug, TimeOfImpact<D>& twin) {
    EXPECT_NE(judge(twin).first, "") << bug << " was not seen";
    recordPlantedBug(std::string("time of impact before the referee: ") + bug + std::to_string(D) + "D", 1,
                     static_cast<int>(cases<D>().size()));
  };
  LooksAtTheEnds<D> ends;
  WaitsForOverlap<D> late;
  SpeedWithoutSign<D> sign;
  ForgetsTheFirst<D> first;
  ForgetsTurning<D> turning;
  TurnsAboutTheShape<D> shape;
  PlaneTurnsAlong<D> plane;
  seen("a plane turns along, ", plane);
  seen("looks at both ends, ", ends), seen("a little late, ", late), seen("speed without its sign, ", sign);
  seen("forgets the first body, ", first), seen("forgets turning, ", turning), seen("turns about the shape, ", shape);
}
TEST(TimeOfImpact, RefereeSeesPlantedBugs2) { refereeSees<2>(); }
TEST(TimeOfImpact, RefereeSeesPlantedBugs3) { refereeSees<3>(); }

// --- known answers -------------------------------------------------------------------------------------------------

// A rod turns above a floor that its tip almost reaches.
template <int D>
MovingPair<D> closeMiss(Real gap, Shape<D>& rod, Shape<D>& floor) {
  Vec<D> half = Vec<D>::Constant(Real(0.05));
  half[0] = 1;
  rod = Shape<D>::box(half);
  floor = Shape<D>::box(Vec<D>::Constant(10));
  MovingPair<D> pair{rod.view(), floor.view(), {}, {}};
  pair.B.X_WC.p[1] = -10 - std::sqrt(Real(1) + Real(0.0025)) - gap;
  pair.A.motion.w[kAngDim<D> - 1] = 10;
  return pair;
}
template <int D>
void closeMisses() {
  forEach<D>([](const AlgorithmInfo& info, TimeOfImpact<D>& method) {
    bool decided = true;
    for (const Real gap : {Real(1e-3), Real(1e-4), Real(1e-5), Real(1e-6)}) {
      if (sizeof(Real) == 4 && gap < Real(1e-3)) continue;  // contact, at this precision
      Shape<D> rod = Shape<D>::sphere(1), floor = rod;
      const TimeOfImpactAnswer<D> answer = cast(method, closeMiss(gap, rod, floor));
      EXPECT_FALSE(answer.hit) << gap;
      decided = decided && answer.status == QueryStatus::converged && answer.t == 1;
    }
    const bool declared = std::any_of(info.failures.begin(), info.failures.end(), [](const auto& f) {
      return std::string_view(f.test) == "TimeOfImpact.CloseMissesAreDecided";
    });
    if (sizeof(Real) == 8) {
      EXPECT_EQ(decided, !declared) << "what is declared is not what is seen";
    }
  });
}
TEST(TimeOfImpact, CloseMissesAreDecided) { closeMisses<2>(), closeMisses<3>(); }

// A rod turns at 10 rad/s, and rises so fast that its corner comes down on the floor at 1 mm/s.
template <int D>
void slowClosings() {
  forEach<D>([](const AlgorithmInfo& info, TimeOfImpact<D>& method) {
    Shape<D> rod = Shape<D>::sphere(1), floor = rod;
    MovingPair<D> pair = closeMiss<D>(0, rod, floor);
    pair.B.X_WC.p[1] = -10;
    constexpr double kTime = 0.05, kAngle = 0.5, kClosing = 1e-3;
    const double c = std::cos(kAngle), s = std::sin(kAngle), w = 10, up = w * (c - 0.05 * s) - kClosing;
    Ang<D> start = Ang<D>::Zero();
    start[kAngDim<D> - 1] = static_cast<Real>(kAngle - w * kTime);
    pair.A.X_WC.q = integrateRotation({}, start);
    pair.A.X_WC.p[1] = static_cast<Real>(s + 0.05 * c - up * kTime), pair.A.motion.v[1] = static_cast<Real>(up);
    const TimeOfImpactAnswer<D> answer = cast(method, pair);
    EXPECT_LE(double(answer.t), kTime + 1e-12);
    const bool declared = std::any_of(info.failures.begin(), info.failures.end(), [](const auto& f) {
      return std::string_view(f.test) == "TimeOfImpact.SlowClosingsAreDecided";
    });
    if (sizeof(Real) == 8) {
      EXPECT_EQ(answer.hit && answer.status == QueryStatus::converged, !declared)
          << "what is declared is not what is seen";
    }
  });
}
TEST(TimeOfImpact, SlowClosingsAreDecided) { slowClosings<2>(), slowClosings<3>(); }

// NaN and infinity give a status at once. A motion of zero duration is a query at its start.
TEST(TimeOfImpact, NanAndInfiniteMotionsFail) {
  forEach<3>([](const AlgorithmInfo&, TimeOfImpact<3>& method) {
    const Shape<3> ball = Shape<3>::sphere(1);
    const auto apart = [&] {
      MovingPair<3> pair{ball.view(), ball.view(), {}, {}};
      pair.B.X_WC.p[0] = 3;
      return pair;
    };
    constexpr Real kNan = std::numeric_limits<Real>::quiet_NaN(), kInfinity = std::numeric_limits<Real>::infinity();
    for (const Real wrong : {kNan, kInfinity}) {
      MovingPair<3> pair = apart();
      pair.A.motion.v[1] = wrong;
      EXPECT_EQ(cast(method, pair).status, QueryStatus::failed) << wrong;
      pair = apart(), pair.B.motion.w[2] = wrong;
      EXPECT_FALSE(cast(method, pair).hit) << wrong;
      pair = apart(), pair.B.X_WC.p[0] = kNan;
      EXPECT_EQ(cast(method, pair).status, QueryStatus::failed) << wrong;
    }
    const TimeOfImpactAnswer<3> still = cast(method, apart(), Real(0));
    EXPECT_TRUE(still.status == QueryStatus::converged && !still.hit && still.t == 0);
  });
}

// The tip of a rod that turns by 90 degrees in a second about its middle reaches a ball beside it.
TEST(TimeOfImpact, ATurningRodReachesABall) {
  forEach<2>([](const AlgorithmInfo&, TimeOfImpact<2>& method) {
    const Shape<2> ball = Shape<2>::sphere(Real(0.1)), rod = Shape<2>::capsule(1, Real(0.1));
    MovingPair<2> pair{ball.view(), rod.view(), {}, {}};
    pair.A.X_WC.p = {Real(0.8), Real(0.8)};  // at 45 degrees, 1.131 m from the middle
    pair.B.motion.w[0] = Real(1.5707963267948966);
    const TimeOfImpactAnswer<2> answer = cast(method, pair);
    ASSERT_TRUE(answer.hit);
    // The tip at (cos, sin) is 0.2 from the ball. With c the cosine of the angle between both, 1 + d^2 - 2 d c = 0.04.
    const double d = 0.8 * std::sqrt(2.0), c = (1 + d * d - 0.04) / (2 * d);
    const double expected = (0.78539816339744831 - std::acos(c)) / 1.5707963267948966;
    EXPECT_NEAR(answer.t, expected, sizeof(Real) == 8 ? 1e-9 : 1e-4);
  });
}

}  // namespace time_of_impact_test
}}}}  // namespace lpc::LPC_PRECISION::test::time_of_impact_test
