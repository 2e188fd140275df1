// SPDX-License-Identifier: Zlib
#include "oracles/verify/case_impact.h"

#include "oracles/referee/impact_bracket.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

template <int D>
MovingPair<D> movingPair(const CaseGeometry<D>& g) {
  MovingPair<D> pair{g.a.shape->view(), g.b.shape->view(), {.X_WC = g.a.X_WS}, {}};
  pair.B = {g.X_WBodyB, g.X_WBodyB.inverse() * g.b.X_WS, g.motionB};
  if (pair.a.kind > pair.b.kind) std::swap(pair.a, pair.b), std::swap(pair.A, pair.B);
  return pair;
}

// Speed of the fastest point of B times the error in time, relative to s.
template <int D>
double errorOf(const CaseGeometry<D>& g, double time, double expected) {
  if (time == expected) return 0;  // both without impact
  const double s = errorScale(g.a.shape->view(), g.a.X_WS, g.b.shape->view(), g.b.X_WS, 0);
  const double reach = static_cast<double>((g.b.X_WS.p - g.X_WBodyB.p).norm() + boundingRadius(g.b.shape->view()));
  const double speed = static_cast<double>(g.motionB.v.norm()) + static_cast<double>(g.motionB.w.norm()) * reach;
  return std::abs(time - expected) * speed / s;
}

}  // namespace

template <int D>
void runImpact(const Case& c, const CaseGeometry<D>& g, std::vector<CaseResult>& rows) {
  const bool shapes = g.a.shape && g.b.shape;
  double expected = c.expected.impact;
  const auto tell = [&](CaseResult& row, double time) {
    row.value = time, row.error = std::isnan(row.expected) ? 0 : errorOf(g, time, row.expected);
    row.verdict = row.error <= kImpactBand ? CaseVerdict::ok : CaseVerdict::wrong;
  };
  if (shapes) {
    const ImpactBracket bracket = impactBracket(movingPair(g), g.duration);
    CaseResult& row = rows.emplace_back(
        CaseResult{.id = c.id, .method = "referee", .role = AlgorithmRole::referee, .expected = c.expected.impact});
    // Separated by more than the contact band until then.
    tell(row, bracket.free < static_cast<double>(g.duration) ? bracket.free : bracket.met);
    if (!bracket.decided) row.verdict = CaseVerdict::refused, row.reason = "undecided";
    if (row.verdict == CaseVerdict::wrong) row.reason = "the file's expected time is wrong";
    if (row.verdict == CaseVerdict::wrong || (bracket.decided && std::isnan(expected))) expected = row.value;
  }
  for (const Registered* r : Registry::instance().list(StageKind::timeOfImpact, D)) {
    const auto method = createStage<TimeOfImpact<D>>(Spec::parse(r->info.name));
    CaseResult& row =
        rows.emplace_back(CaseResult{.id = c.id, .method = r->info.name, .role = r->info.role, .expected = expected});
    const MovingPair<D> pair = shapes ? movingPair(g) : MovingPair<D>{};
    if (!shapes || !method->supports(pair.a.kind, pair.b.kind)) {
      row.reason = "unsupported_shape";
      continue;
    }
    TimeOfImpactAnswer<D> answer;
    WorkDone work;
    method->cast({&pair, 1}, g.duration, {&answer, 1}, work);
    tell(row, answer.hit ? static_cast<double>(answer.t) : kNever);
    if (std::isnan(expected)) row.verdict = CaseVerdict::refused;
    if (answer.status != QueryStatus::converged) row.verdict = CaseVerdict::failed;
    if (row.verdict != CaseVerdict::ok) row.reason = queryStatusName(answer.status);
    if (row.verdict == CaseVerdict::refused) row.reason = "undecided";
  }
}

template void runImpact(const Case&, const CaseGeometry<2>&, std::vector<CaseResult>&);
template void runImpact(const Case&, const CaseGeometry<3>&, std::vector<CaseResult>&);

}}  // namespace lpc::LPC_PRECISION
