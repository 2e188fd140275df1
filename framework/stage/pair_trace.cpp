// SPDX-License-Identifier: Zlib
#include "framework/stage/pair_trace.h"

#include "framework/math/names.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

std::string digits(Real value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.6g", static_cast<double>(value));
  return buffer;
}

template <int D>
std::string vectorText(const Vec<D>& v) {
  std::string out = "(";
  for (int k = 0; k < D; ++k) out += (k ? ", " : "") + digits(v[k]);
  return out + ")";
}

// Names of the methods that can record their steps for such a pair.
template <int D>
std::vector<std::string> tracers(const PairView<D>& pair) {
  std::vector<std::string> out;
  for (const Registered* entry : Registry::instance().list(StageKind::pairQuery, D)) {
    if (entry->info.role != AlgorithmRole::competitor) continue;
    const auto method = createStage<PairQuery<D>>(Spec{entry->info.name, {}});
    const bool supports = method->supports(pair.a.kind, pair.b.kind);
    if (supports && method->traces(pair.a.kind, pair.b.kind)) out.push_back(entry->info.name);
  }
  return out;
}

}  // namespace

template <int D>
PairTrace<D> tracePair(std::string_view query, const ShapeView<D>& a, const ShapeView<D>& b, const Pose<D>& X_AB) {
  const Spec spec = Spec::parse(query);
  const auto method = createStage<PairQuery<D>>(spec);
  PairTrace<D> out;
  out.swapped = a.kind > b.kind;
  out.pair = out.swapped ? PairView<D>{b, a, X_AB.inverse()} : PairView<D>{a, b, X_AB};
  const ShapeKind first = out.pair.a.kind, second = out.pair.b.kind;
  const bool supports = method->supports(first, second);
  if (!supports || !method->traces(first, second)) {
    const std::string lacks = supports ? "' cannot show its steps for " : "' does not support ";
    throw UserError("'" + spec.name + lacks + std::string(shapeKindName(first)) + " against " +
                    std::string(shapeKindName(second)) + "; valid: " + joined(tracers(out.pair)));
  }
  method->trace(out.pair, out);
  TraceStep<D> last;
  if (!out.steps.empty()) last.best = out.steps.back().best, last.bestAxis = out.steps.back().bestAxis;
  last.words = "answer, " + std::string(queryStatusName(out.answer.status));
  last.direction = out.answer.normal, last.bound = out.answer.distance;
  last.supportA = out.answer.pA, last.supportB = out.answer.pB, last.support = last.supportB - last.supportA;
  out.steps.push_back(std::move(last));
  return out;
}

template <int D>
std::string describe(const TraceStep<D>& step) {
  std::string out = step.words;
  if (!step.corners.empty()) {
    out += ": " + std::to_string(step.corners.size()) + (step.corners.size() == 1 ? " corner" : " corners");
  }
  if (!step.faces.empty()) out += ", " + std::to_string(step.faces.size()) + (D == 2 ? " edges" : " faces");
  if (step.nearest) out += ", " + digits(step.nearest->norm()) + " m from the origin";
  if (!step.direction.isZero(0)) {
    out += "; along " + vectorText<D>(step.direction) + (step.atMost ? " at most " : " ") + digits(step.bound) + " m";
  }
  if (step.kind != TraceKind::answer && std::isfinite(step.best)) out += "; best " + digits(step.best) + " m";
  return out;
}

template <int D>
std::string describe(const PairTrace<D>& trace) {
  std::string out;
  for (std::size_t i = 0; i < trace.steps.size(); ++i) {
    out += std::to_string(i) + " " + describe(trace.steps[i]) + "\n";
  }
  return out;
}

template PairTrace<2> tracePair(std::string_view, const ShapeView<2>&, const ShapeView<2>&, const Pose<2>&);
template PairTrace<3> tracePair(std::string_view, const ShapeView<3>&, const ShapeView<3>&, const Pose<3>&);
template std::string describe(const TraceStep<2>&);
template std::string describe(const TraceStep<3>&);
template std::string describe(const PairTrace<2>&);
template std::string describe(const PairTrace<3>&);

}}  // namespace lpc::LPC_PRECISION
