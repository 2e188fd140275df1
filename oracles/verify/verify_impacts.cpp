// SPDX-License-Identifier: Zlib
// Times of impact for random motions of hard pairs, bracketed from both sides by the referee's signed distances.
#include <algorithm>
#include <cmath>

#include "framework/math/random.h"
#include "oracles/referee/impact_bracket.h"
#include "oracles/verify/verify.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

template <int D>
struct DrawnMotion {
  HardPair<D> shapes;
  ShapeMotion<D> A, B;
  std::string family, speed;  // labels

  MovingPair<D> pair() const { return {shapes.a.view(), shapes.b.view(), A, B}; }
};

template <int D>
Vec<D> direction(Random& random) {
  Vec<D> d;
  for (int k = 0; k < D; ++k) d[k] = static_cast<Real>(random.uniform(-1, 1));
  const Real length = d.norm();
  return length > Real(0.1) ? Vec<D>(d / length) : Vec<D>::Unit(0);
}

/// Within a second most pairs touch, miss each other or pass through each other: B of a hard pair is moved away and
/// sent back past its place. A third rotates, a third moves along with the body that it hits.
template <int D>
DrawnMotion<D> drawMotion(ShapeKind kindA, ShapeKind kindB, std::uint64_t seed, int index) {
  DrawnMotion<D> out{hardPair<D>(kindA, kindB, seed, index), {}, {}, {}, {}};
  constexpr std::uint64_t kSpread = 0xd1342543de82ef95u;  // odd: no two indices of a seed start with the same state
  Random random((seed + 1) * kSpread + static_cast<std::uint64_t>(index));
  const bool planeA = kindA == ShapeKind::plane, onPlane = planeA || kindB == ShapeKind::plane;
  out.A.X_WC = out.shapes.X_WA, out.B.X_WC = out.shapes.X_WB;
  const Real reachA = boundingRadius(out.shapes.a.view()), reachB = boundingRadius(out.shapes.b.view());
  const Real size = onPlane ? std::min(reachA, reachB) : std::max(reachA, reachB);
  const double decade = random.uniform(-1, 3);  // sizes per second
  out.speed = decade < 0   ? "0.1 to 1 sizes/s"
              : decade < 1 ? "1 to 10 sizes/s"
              : decade < 2 ? "10 to 100 sizes/s"
                           : "100 to 1000 sizes/s";
  const auto speed = static_cast<Real>(std::pow(10.0, decade));
  Vec<D> away = direction<D>(random);
  ShapeMotion<D>&moves = onPlane && !planeA ? out.A : out.B, &other = &moves == &out.A ? out.B : out.A;
  if (onPlane) away = other.X_WC.q * Vec<D>(Vec<D>::Unit(1));  // up
  const double far = random.uniform(0, 4), aside = random.uniform(0, 0.5);
  moves.X_WC.p += static_cast<Real>(far) * size * away;
  moves.motion.v = speed * size * (-away + static_cast<Real>(aside) * direction<D>(random));
  const std::uint64_t family = random.below(3);
  out.family = family == 0 ? "straight" : family == 1 ? "turning" : "carried along";
  for (ShapeMotion<D>* m : {&out.A, &out.B}) {
    if (onPlane && m == &other) continue;  // it does not move
    Ang<D> w;
    for (int k = 0; k < kAngDim<D>; ++k) w[k] = static_cast<Real>(random.uniform(-20, 20));
    const Vec<D> lever = static_cast<Real>(random.uniform(0, 0.5)) * size * direction<D>(random);
    if (family != 1) continue;
    m->motion.w = w;
    m->X_CS.p = lever, m->X_WC.p -= m->X_WC.q * lever;
  }
  if (family == 2 && !onPlane) {
    const Vec<D> wind = speed * size * direction<D>(random);
    out.A.motion.v += wind, out.B.motion.v += wind;
  }
  return out;
}

// Name of a fault: "late: 0.3, but ..." gives "late".
std::string failureOf(const std::string& fault) {
  std::string name = fault.substr(0, std::min(fault.find(':'), fault.find(" at ")));
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
}

// The error is the separation at the time found, relative to s: the error in time times the approach speed. An answer
// without impact has no error.
template <int D>
Verdict judged(const MovingPair<D>& pair, Real duration, const TimeOfImpactAnswer<D>& answer,
               const ImpactBracket& bracket) {
  if (answer.status == QueryStatus::failed) return withoutAnswer(Tally::notFinite);
  if (answer.status == QueryStatus::refused) return withoutAnswer(Tally::refused);
  Verdict out;
  out.capped = answer.status != QueryStatus::converged;
  out.value = static_cast<double>(answer.t);
  if (!bracket.decided) {
    out.end = Tally::undecided;
    return out;
  }
  const std::string fault = impactFault(pair, duration, answer, bracket);
  if (!fault.empty()) {
    out.end = Tally::wrong, out.failure = failureOf(fault);
    out.wrongSide = out.failure == "missed";
  }
  if (answer.hit && std::isfinite(answer.t)) {
    if (const double error = impactError(pair, answer.t); std::isfinite(error)) out.error = error;
  }
  return out;
}

}  // namespace

template <int D>
void verifyImpacts(ShapeKind kindA, ShapeKind kindB, const VerifyRange& range,
                   std::span<const Candidate<TimeOfImpact<D>>> methods, Verified& out) {
  constexpr Real kDuration = 1;
  std::vector<std::unique_ptr<TimeOfImpact<D>>> able;
  for (const Candidate<TimeOfImpact<D>>& m : methods) {
    able.push_back(m.create());
    if (!able.back()->supports(kindA, kindB)) able.back().reset();
  }
  if (std::none_of(able.begin(), able.end(), [](const auto& m) { return m != nullptr; })) return;
  for (int index = range.first; index < range.first + range.count; ++index) {
    const DrawnMotion<D> drawn = drawMotion<D>(kindA, kindB, range.seed, index);
    const MovingPair<D> pair = drawn.pair();
    const ImpactBracket bracket = range.ended ? ImpactBracket{} : impactBracket(pair, kDuration);
    for (std::size_t i = 0; i < methods.size(); ++i) {
      if (!able[i]) continue;
      Verdict verdict = withoutAnswer(range.ended.value_or(Tally::threw));
      double spent = 0;
      if (!range.ended) {
        TimeOfImpactAnswer<D> answer;
        WorkDone work;
        const double before = threadNanoseconds();
        able[i]->cast({&pair, 1}, kDuration, {&answer, 1}, work);
        spent = threadNanoseconds() - before;
        verdict = judged(pair, kDuration, answer, bracket);
      }
      LedgerKey subject = subjectOf(StageKind::timeOfImpact, D, methods[i].name);
      subject.kindA = shapeKindName(kindA), subject.kindB = shapeKindName(kindB);
      book(out.ledger, subject, methods[i].info.role, {{"family", drawn.family}, {"regime", drawn.speed}}, verdict,
           spent, [] { return std::string(); });
    }
  }
}

template void verifyImpacts(ShapeKind, ShapeKind, const VerifyRange&, std::span<const Candidate<TimeOfImpact<2>>>,
                            Verified&);
template void verifyImpacts(ShapeKind, ShapeKind, const VerifyRange&, std::span<const Candidate<TimeOfImpact<3>>>,
                            Verified&);

}}  // namespace lpc::LPC_PRECISION
