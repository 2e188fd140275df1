// SPDX-License-Identifier: Zlib
#include <algorithm>
#include <cmath>
#include <iomanip>
#include <limits>
#include <sstream>

#include "framework/math/check.h"
#include "framework/math/names.h"
#include "framework/math/tolerances.h"
#include "framework/shape/mass.h"
#include "framework/stage/stage_narrowphase.h"
#include "oracles/referee/referee.h"
#include "oracles/verify/case_impact.h"
#include "oracles/verify/verify.h"
#include "oracles/witnesses/witness.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

// In addition to the case's own tolerance, times s. The single precision build reads rounded inputs.
constexpr double kTolerance = pairTolerance();
// A case found in single precision has rotations of seven digits, which the double build normalises.
double toleranceOf(const Case& c) {
  return c.finding && c.finding->precision == "f32" ? pairTolerance(true) : kTolerance;
}
// Relative error of mass properties and areas: the precision that remains for a hundredth of a metre far from the
// origin.
constexpr double kRelative = sizeof(Real) == 8 ? 1e-9 : 1e-2;

constexpr std::string_view kReferee = "referee", kUnknownMethod = "unknown_method", kSide = "side",
                           kSideAlone = "by the side alone: the method claims no distance",
                           kWrongSide = "wrong_side";  // as in the verdict of a case with a finding
constexpr std::string_view kNoShape = "unsupported_shape", kNotDecided = "undecided", kNothing = "nothing_expected";

// The registered pair queries of one dimension, created once: a witness keeps its process from case to case.
template <int D>
struct Method {
  const Registered* entry;
  std::unique_ptr<PairQuery<D>> query;

  const Witness<D>* witness() const { return dynamic_cast<const Witness<D>*>(query.get()); }
  Ending ending() const { return witness() ? witness()->endings()[0] : Ending::answered; }
};
template <int D>
using Methods = std::vector<Method<D>>;

template <int D>
Methods<D> methods() {
  Methods<D> out;
  for (const Registered* entry : Registry::instance().list(StageKind::pairQuery, D)) {
    out.push_back({entry, createStage<PairQuery<D>>(Spec::parse(entry->info.name))});
  }
  return out;
}

template <int D>
void judge(const CaseExpected& expected, const CaseGeometry<D>& g, const PairAnswer<D>& answer, double tolerance,
           bool claimsGap, CaseResult& row) {
  const ShapeView<D>&a = g.a.shape->view(), &b = g.b.shape->view();
  const double s = errorScale(a, g.a.X_WS, b, g.b.X_WS, expected.distance);
  const double allowed = expected.tolerance + tolerance * s;
  row.value = static_cast<double>(answer.distance);
  row.error = std::abs(row.value - expected.distance) / s;
  row.verdict = CaseVerdict::wrong;
  if (!std::isfinite(row.value) || !answer.normal.allFinite()) {
    row.reason = "not finite";
    return;
  }
  const bool witnessOfASide = row.role == AlgorithmRole::witness && answer.status == QueryStatus::degenerate;
  if (witnessOfASide || (row.value >= 0 && !claimsGap)) {
    row.verdict = row.value * expected.distance >= 0 || std::abs(expected.distance) <= allowed ? CaseVerdict::ok
                                                                                               : CaseVerdict::wrong;
    row.reason = row.verdict == CaseVerdict::ok ? kSideAlone : kSide;
    return;
  }
  if (!(std::abs(row.value - expected.distance) <= allowed)) {
    const bool otherSide = (row.value < 0) != (expected.distance < 0) && std::abs(expected.distance) > allowed;
    row.reason = otherSide ? kSide : "distance";
    return;
  }
  const Vecd<D> n = (g.a.X_WS.q * answer.normal).template cast<double>();
  if (n.isZero(0)) {
    // A missing normal is allowed only when the boundaries touch, and for witnesses.
    const bool stated = std::abs(expected.distance) <= allowed || row.role != AlgorithmRole::competitor;
    row.verdict = stated ? CaseVerdict::ok : CaseVerdict::wrong;
    row.reason = stated ? "" : "no normal";
    return;
  }
  if (std::abs(n.norm() - 1) > 2 * static_cast<double>(kUnitTolerance)) {
    row.reason = "normal is not unit";
    return;
  }
  const Interval along = separationAlong(a, g.a.X_WS, b, g.b.X_WS, n);
  if (along.hi < expected.distance - allowed) {
    std::ostringstream reason;
    reason << std::setprecision(3) << "the separation along the normal is too small by "
           << expected.distance - along.hi;
    row.reason = reason.str();
    return;
  }
  row.verdict = CaseVerdict::ok;
}

// Runs the referee on the case: it checks the file's expected value, and replaces it in `expected` where it knows
// better.
template <int D>
CaseResult judgeExpected(const Case& c, const CaseGeometry<D>& g, CaseExpected& expected) {
  CaseResult row{
      .id = c.id, .method = std::string(kReferee), .role = AlgorithmRole::referee, .expected = expected.distance};
  if (!g.a.shape || !g.b.shape) {
    row.reason = kNoShape;
    return row;
  }
  const ShapeView<D>&a = g.a.shape->view(), &b = g.b.shape->view();
  const RefereeAnswer<D> truth = referee(a, g.a.X_WS, b, g.b.X_WS);
  if (!truth.decided) {
    row.reason = kNotDecided;
    return row;
  }
  row.value = truth.interval().middle(), row.verdict = CaseVerdict::ok;
  if (!std::isnan(expected.distance)) {
    const double s = errorScale(a, g.a.X_WS, b, g.b.X_WS, expected.distance);
    const double off = truth.interval().distanceTo(expected.distance);
    row.error = off / s;
    if (off <= expected.tolerance + toleranceOf(c) * s) return row;
    row.verdict = CaseVerdict::wrong, row.reason = "the file's expected value is not the distance";
  }
  expected.distance = row.value, expected.tolerance = truth.interval().width();
  return row;
}

template <int D>
void askMethod(const Case& c, const CaseExpected& expected, const CaseGeometry<D>& g, Method<D>& method,
               CaseResult& row) {
  const auto end = [&](CaseVerdict verdict, const std::string& reason) { row.verdict = verdict, row.reason = reason; };
  if (!g.a.shape || !g.b.shape) return end(CaseVerdict::refused, std::string(kNoShape));
  const ShapeView<D>&a = g.a.shape->view(), &b = g.b.shape->view();
  if (!method.query->supports(std::min(a.kind, b.kind), std::max(a.kind, b.kind))) {
    return end(CaseVerdict::refused, std::string(kNoShape));
  }
  const PairAnswer<D> answer = queryPair(*method.query, a, b, g.a.X_WS.inverse() * g.b.X_WS);
  if (const Ending ending = method.ending(); ending == Ending::hung)
    return end(CaseVerdict::hang, "no answer in time");
  else if (ending != Ending::answered)
    return end(CaseVerdict::failed, std::string(endingName(ending)));
  if (answer.status == QueryStatus::refused || answer.status == QueryStatus::failed) {
    return end(answer.status == QueryStatus::refused ? CaseVerdict::refused : CaseVerdict::failed,
               "declared, yet status " + std::string(queryStatusName(answer.status)));
  }
  if (std::isnan(expected.distance)) return end(CaseVerdict::refused, std::string(kNotDecided));
  judge<D>(expected, g, answer, std::max(toleranceOf(c), verifyTolerance(method.witness())),
           method.query->claimsGap(std::min(a.kind, b.kind), std::max(a.kind, b.kind)), row);
}

template <int D>
void runDistance(const Case& c, const CaseGeometry<D>& g, Methods<D>& methods, std::vector<CaseResult>& rows) {
  CaseExpected expected = c.expected;
  if (g.a.shape && g.b.shape) rows.push_back(judgeExpected(c, g, expected));
  for (Method<D>& method : methods) {
    const AlgorithmInfo& info = method.entry->info;
    rows.push_back({.id = c.id,
                    .method = info.name,
                    .role = info.role,
                    .expected = expected.distance,
                    .sideAlone = owesSideAlone(StageKind::pairQuery, info)});
    askMethod(c, expected, g, method, rows.back());
  }
}

CaseVerdict verdictOf(Tally end) {
  switch (end) {
    case Tally::agree:
    case Tally::tie:
      return CaseVerdict::ok;
    case Tally::wrong:
      return CaseVerdict::wrong;
    case Tally::undecided:
    case Tally::refused:
      return CaseVerdict::refused;
    case Tally::hung:
      return CaseVerdict::hang;
    default:
      return CaseVerdict::failed;
  }
}

void tell(const Verdict& verdict, CaseResult& row) {
  row.verdict = verdictOf(verdict.end), row.value = verdict.value, row.error = verdict.error.value_or(0);
  row.reason = verdict.sideAlone && verdict.end == Tally::agree ? std::string(kSideAlone) : verdict.failure;
}

template <int D>
void runContacts(const Case& c, const CaseGeometry<D>& g, std::vector<CaseResult>& rows) {
  CaseExpected expected = c.expected;
  if (g.a.shape && g.b.shape) rows.push_back(judgeExpected(c, g, expected));
  for (const Registered* r : Registry::instance().list(StageKind::contacts, D)) {
    const Candidate<ContactGenerator<D>> method = {
        r->info.name, r->info, [r] { return createStage<ContactGenerator<D>>(Spec::parse(r->info.name)); }};
    CaseResult& row = rows.emplace_back(
        CaseResult{.id = c.id, .method = r->info.name, .role = r->info.role, .expected = expected.distance});
    if (!g.a.shape || !g.b.shape || !method.create()->supports(g.a.shape->kind(), g.b.shape->kind())) {
      row.reason = kNoShape;
      continue;
    }
    tell(verifyPair(g.pair(), method), row);
  }
}

double measureOf(const Polytope<2>& hull) {
  double twice = 0;
  const Vecd<2> origin = hull.vertices[0].cast<double>();
  for (std::size_t i = 1; i + 1 < hull.vertices.size(); ++i) {
    const Vecd<2> u = hull.vertices[i].cast<double>() - origin, v = hull.vertices[i + 1].cast<double>() - origin;
    twice += u[0] * v[1] - u[1] * v[0];
  }
  return twice / 2;
}

double measureOf(const Polytope<3>& hull) {
  double six = 0;
  const Vecd<3> origin = hull.vertices[0].cast<double>();
  const auto at = [&](int i) -> Vecd<3> {
    const auto vertex = static_cast<std::size_t>(hull.loop[static_cast<std::size_t>(i)]);
    return hull.vertices[vertex].cast<double>() - origin;
  };
  for (const auto& face : hull.faces) {
    for (int i = face.begin + 1; i + 1 < face.end; ++i) six += at(face.begin).dot(at(i).cross(at(i + 1)));
  }
  return six / 6;
}

template <int D>
CaseResult runHull(const Case& c, const CaseGeometry<D>& g) {
  CaseResult row{.id = c.id, .method = "convex_hull", .expected = c.expected.measure};
  std::shared_ptr<const Polytope<D>> hull;
  try {
    hull = convexHull(std::span<const Vec<D>>(g.points));
  } catch (const UserError& error) {
    row.verdict = c.expected.degenerate ? CaseVerdict::ok : CaseVerdict::failed;
    row.reason = error.what();
    return row;
  }
  row.value = measureOf(*hull);
  if (!c.expected.degenerate && c.expected.hullVertices.empty() && std::isnan(c.expected.measure)) {
    row.reason = kNothing;
    return row;
  }
  double extent = 0;
  for (const Vec<D>& p : g.points) extent = std::max(extent, (p - g.points[0]).template cast<double>().norm());
  row.verdict = CaseVerdict::ok;
  if (c.expected.degenerate) return row;  // any outcome is right, except an endless loop
  // The expected vertices must be exactly ours, because points inside an edge are dropped.
  for (const auto& want : c.expected.hullVertices) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Vec<D>& have : hull->vertices) {
      double square = 0;
      for (std::size_t d = 0; d < D; ++d)
        square += std::pow(static_cast<double>(have[static_cast<int>(d)]) - want[d], 2);
      nearest = std::min(nearest, std::sqrt(square));
    }
    if (nearest > kTolerance * extent) row.verdict = CaseVerdict::wrong, row.reason = "a vertex is missing";
  }
  if (!c.expected.hullVertices.empty() && hull->vertices.size() != c.expected.hullVertices.size()) {
    row.verdict = CaseVerdict::wrong;
    row.reason = std::to_string(hull->vertices.size()) + " vertices";
  }
  if (std::isfinite(c.expected.measure)) {
    row.error = std::abs(row.value - c.expected.measure) / std::abs(c.expected.measure);
  }
  if (row.error > kRelative) row.verdict = CaseVerdict::wrong, row.reason = "area or volume";
  return row;
}

template <int D>
CaseResult runMass(const Case& c, const CaseGeometry<D>& g) {
  CaseResult row{.id = c.id, .method = "mass_properties", .expected = c.expected.measure};
  if (!g.a.shape) {
    row.reason = kNoShape;
    return row;
  }
  if (std::isnan(c.expected.measure) && std::isnan(c.expected.center[0]) && c.expected.inertia.empty()) {
    row.reason = kNothing;
    return row;
  }
  const MassProperties<D> m = transformed(massProperties(g.a.shape->view(), static_cast<Real>(c.density)), g.a.X_WS);
  row.value = static_cast<double>(m.mass);
  if (std::isfinite(c.expected.measure))
    row.error = std::abs(row.value / c.density - c.expected.measure) / c.expected.measure;
  row.verdict = CaseVerdict::wrong;
  double coordinate = 0, offset = 0, inertia = 0, inertiaOff = 0;
  for (std::size_t d = 0; d < D && std::isfinite(c.expected.center[d]); ++d) {
    coordinate = std::max(coordinate, std::abs(c.expected.center[d]));
    offset = std::max(offset, std::abs(static_cast<double>(m.center[static_cast<int>(d)]) - c.expected.center[d]));
  }
  for (std::size_t i = 0; i < c.expected.inertia.size(); ++i) {
    const int rows = static_cast<int>(m.inertia.rows()), k = static_cast<int>(i);
    const double have = static_cast<double>(m.inertia(k / rows, k % rows));
    inertia = std::max(inertia, std::abs(c.expected.inertia[i]));
    inertiaOff = std::max(inertiaOff, std::abs(have - c.expected.inertia[i]));
  }
  if (!(row.error <= kRelative)) {
    row.reason = "mass";
  } else if (!(offset <= kTolerance * (1 + coordinate))) {
    row.reason = "centre of mass";
  } else if (!(inertiaOff <= kRelative * inertia)) {
    row.reason = "inertia";
  } else {
    row.verdict = CaseVerdict::ok;
  }
  return row;
}

template <int D>
void runCase(const Case& c, const CaseGeometry<D>& g, Methods<D>& methods, std::vector<CaseResult>& rows) {
  if (!c.mistake.empty()) {
    rows.push_back(unreadRow(c));
    return;
  }
  if (c.finding) {
    for (const std::string& method : methodsToAsk(c)) rows.push_back(askFound(c, method));
    return;
  }
  switch (c.query) {
    case CaseQuery::signedDistance:
      runDistance<D>(c, g, methods, rows);
      return;
    case CaseQuery::contacts:
      runContacts<D>(c, g, rows);
      return;
    case CaseQuery::convexHull:
      rows.push_back(runHull<D>(c, g));
      return;
    case CaseQuery::massProperties:
      rows.push_back(runMass<D>(c, g));
      return;
    case CaseQuery::timeOfImpact:
      runImpact<D>(c, g, rows);
      return;
    case CaseQuery::broadphase:  // only with a finding
    case CaseQuery::unknown:
      rows.push_back({.id = c.id, .method = "-", .reason = "unsupported_query"});
      return;
  }
}

}  // namespace

std::string_view caseVerdictName(CaseVerdict verdict) {
  constexpr std::array<std::string_view, 5> kNames = {"ok", "wrong", "refused", "failed", "hang"};
  return kNames[static_cast<std::size_t>(verdict)];
}

namespace {

int dimensionOf(const Case& c) { return std::holds_alternative<CaseGeometry<2>>(c.geometry) ? 2 : 3; }

// The method of the case's finding is not registered.
[[noreturn]] void failUnknown(const Case& c) {
  const std::string name = Spec::parse(c.finding->method).name;
  std::vector<std::string> names;
  for (const Registered* r : Registry::instance().list(c.finding->stage, dimensionOf(c))) names.push_back(r->info.name);
  throw UserError("case '" + c.id + "': the method '" + name + "' is neither built in nor of a --plugin" +
                  validNames(names, name));
}

const Registered* registered(const Case& c, const std::string& method) {
  const auto& all = Registry::instance().all();
  const auto at = all.find({c.finding->stage, dimensionOf(c), Spec::parse(method).name});
  return at == all.end() ? nullptr : &at->second;
}

}  // namespace

std::vector<std::string> methodsToAsk(const Case& c) {
  std::vector<std::string> out{c.finding->method};
  if (c.finding->stage == StageKind::broadphase) return out;  // the definition by pairs of boxes is the judge
  const auto hasShapes = [](const auto& g) { return g.a.shape && g.b.shape; };
  if (std::isfinite(c.expected.distance) && std::visit(hasShapes, c.geometry)) out.emplace_back(kReferee);
  for (const Registered* r : Registry::instance().list(c.finding->stage, dimensionOf(c))) {
    if (r->info.name != out[0]) out.push_back(r->info.name);
  }
  return out;
}

AlgorithmRole roleOf(const Case& c, const std::string& method) {
  if (method == kReferee) return AlgorithmRole::referee;
  const Registered* r = registered(c, method);
  return r ? r->info.role : AlgorithmRole::competitor;
}

CaseResult unreadRow(const Case& c) {
  return {.id = c.id, .method = "-", .reason = c.mistake, .expected = kUnknown, .unread = true};
}

CaseResult askFound(const Case& c, const std::string& method) {
  if (!c.mistake.empty()) return unreadRow(c);
  if (method == kReferee) {
    CaseExpected expected = c.expected;
    return std::visit([&](const auto& g) { return judgeExpected(c, g, expected); }, c.geometry);
  }
  CaseResult row{.id = c.id, .method = method, .role = roleOf(c, method), .expected = c.expected.distance};
  const bool found = method == c.finding->method;
  const Registered* entry = registered(c, method);
  if (!entry) {
    if (found) failUnknown(c);
    row.reason = kUnknownMethod;
    return row;
  }
  row.sideAlone = owesSideAlone(entry->stage, entry->info);
  const Verdict verdict = askAgain(c, method);
  tell(verdict, row);
  if (found) row.again = verdict.failure == c.finding->failure;
  return row;
}

std::vector<CaseResult> runCases(const std::vector<Case>& cases) {
  std::vector<CaseResult> rows;
  Methods<2> in2 = methods<2>();
  Methods<3> in3 = methods<3>();
  for (const Case& c : cases) {
    if (const auto* g = std::get_if<CaseGeometry<2>>(&c.geometry)) runCase(c, *g, in2, rows);
    if (const auto* g = std::get_if<CaseGeometry<3>>(&c.geometry)) runCase(c, *g, in3, rows);
  }
  return rows;
}

bool isOurFault(const CaseResult& result) {
  if (result.role != AlgorithmRole::competitor || result.unread) return false;
  if (result.sideAlone && result.verdict == CaseVerdict::wrong) {
    return result.reason == kSide || result.reason == kWrongSide;
  }
  const bool undeclared = result.reason == kNoShape || result.reason == "unsupported_query" ||
                          result.reason == kUnknownMethod || result.reason == kNotDecided || result.reason == kNothing;
  return result.verdict != CaseVerdict::ok && !(result.verdict == CaseVerdict::refused && undeclared);
}

bool isFilesFault(const CaseResult& result) {
  return result.unread || (result.role == AlgorithmRole::referee && result.verdict == CaseVerdict::wrong);
}

}}  // namespace lpc::LPC_PRECISION
