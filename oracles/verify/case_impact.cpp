// SPDX-License-Identifier: Zlib
#include "oracles/verify/case_impact.h"

#include <sstream>

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

std::string oneDigit(double number) {
  std::ostringstream out;
  out.precision(1);
  out << number;
  return out.str();
}

}  // namespace

template <int D>
void runImpact(const Case& c, const CaseGeometry<D>& g, std::vector<CaseResult>& rows) {
  const bool shapes = g.a.shape && g.b.shape;
  double expected = c.expected.impact;
  ImpactBracket bracket;
  Interval touch;
  if (shapes) {
    bracket = impactBracket(movingPair(g), g.duration), touch = firstTouch(movingPair(g), g.duration);
    CaseResult& row = rows.emplace_back(
        CaseResult{.id = c.id, .method = "referee", .role = AlgorithmRole::referee, .expected = c.expected.impact});
    row.value = std::isfinite(touch.hi) ? touch.middle() : touch.hi;
    if (touch.distanceTo(row.expected) > 0) {
      row.error =
          std::isfinite(row.expected) && row.expected <= static_cast<double>(g.duration) && row.expected <= bracket.met
              ? impactError(movingPair(g), static_cast<Real>(row.expected))
              : kNever;
    }
    if (std::isfinite(touch.hi)) row.reason = "within " + oneDigit(touch.width()) + " s";
    row.verdict = row.error <= kImpactBand ? CaseVerdict::ok : CaseVerdict::wrong;
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
    row.value = answer.hit ? static_cast<double>(answer.t) : kNever;
    if (answer.hit) {
      row.error = impactError(pair, answer.t);
    } else if (std::isfinite(bracket.met)) {
      row.error = kNever;
    }
    if (answer.status != QueryStatus::converged) {
      row.verdict = CaseVerdict::failed, row.reason = queryStatusName(answer.status);
    } else if (!bracket.decided) {
      row.verdict = CaseVerdict::refused, row.reason = "undecided";
    } else {
      row.reason = impactFault(pair, g.duration, answer, bracket);
      row.verdict = row.reason.empty() ? CaseVerdict::ok : CaseVerdict::wrong;
    }
  }
}

template void runImpact(const Case&, const CaseGeometry<2>&, std::vector<CaseResult>&);
template void runImpact(const Case&, const CaseGeometry<3>&, std::vector<CaseResult>&);

}}  // namespace lpc::LPC_PRECISION
