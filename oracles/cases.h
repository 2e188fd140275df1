// SPDX-License-Identifier: Zlib
// Corpora of hard inputs: reading a file of cases, and running every method on them. The schema stands at the top of
// tests/regressions/hard_cases.json and, of what `lpc verify` found, found_cases.json beside it, so that corpora can be
// exchanged with others.
#pragma once

#include <array>
#include <iosfwd>
#include <limits>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "framework/problem/body.h"
#include "framework/shape/shape.h"
#include "framework/stage/registry.h"
#include "oracles/box_script.h"
#include "oracles/hard_pairs.h"
#include "oracles/verdict.h"

namespace lpc::inline LPC_PRECISION {

enum class CaseQuery { signedDistance, contacts, broadphase, convexHull, massProperties, timeOfImpact, unknown };

/// A shape of a case as ours. Frames differ: a case's capsule has an axis or two end points, ours lies along x, so the
/// pose contains that turn.
template <int D>
struct CaseShape {
  std::optional<Shape<D>> shape;  // empty: refused
  Pose<D> X_WS;
  std::string refusal;  // why it is refused, for instance "cylinder"
};

template <int D>
struct CaseGeometry {
  CaseShape<D> a, b;
  std::optional<Pose<D>> X_WBNudged = {};  // of a contacts case of faces at rest
  std::vector<Vec<D>> points;              // of a convex hull case
  Motion<D> motionB;                       // of a time of impact case; A stands still
  Pose<D> X_WBodyB;                        // about whose origin B turns
  Real duration = 0;                       // s
  BoxScript<D> script;                     // of a broadphase case

  /// Both shapes as `lpc verify` asks them; neither may be refused.
  HardPair<D> pair() const;
};

/// Of a case that `lpc verify` wrote: what was wrong. Its poses are the bits that the method was asked in this
/// precision; another build normalises the rotations.
struct CaseFinding {
  StageKind stage = StageKind::pairQuery;
  std::string precision, method;  // the method with the parameters that it had
  std::string failure;            // as in names of files: wrong_distance
  double error = 0;               // over s; NaN where there is none
  std::uint64_t seed = 0;         // with the kinds of its shapes the name of the pair, on the day when it was found
  int number = 0;
};

inline constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// What must come out. Which fields count depends on the query; of hulls and masses only what the file states is
/// compared. 2D uses the first two components.
struct CaseExpected {
  double distance = 0;        // signed, m; NaN in a case with a finding whose referee had none
  double tolerance = 0;       // how well the file knows `distance` (m)
  double measure = kUnknown;  // area or volume (m^D)
  double impact = kUnknown;   // s; infinite: they never touch
  bool degenerate = false;    // a hull that may be refused
  std::vector<std::array<double, 3>> hullVertices;
  std::array<double, 3> center{kUnknown, kUnknown, kUnknown};
  std::vector<double> inertia;  // about the centre: one number in 2D, nine in 3D (row by row)
};

struct Case {
  std::string id, source, queryText;
  CaseQuery query = CaseQuery::unknown;
  double density = 1;  // of a mass case, kg/m^D
  std::optional<CaseFinding> finding = {};
  std::variant<CaseGeometry<2>, CaseGeometry<3>> geometry;
  CaseExpected expected;
};

/// Throws UserError that names the file, the case and the field when the file is not in the schema. A shape or query
/// that we lack is no error: it is read and later refused.
std::vector<Case> readCases(const std::string& path);
/// The same of a file's text; `path` is for messages.
std::vector<Case> parseCases(const std::string& text, const std::string& path);

enum class CaseVerdict { ok, wrong, refused, failed, hang };
std::string_view caseVerdictName(CaseVerdict verdict);

/// One case and one method.
struct CaseResult {
  std::string id, method;
  AlgorithmRole role = AlgorithmRole::competitor;
  CaseVerdict verdict = CaseVerdict::refused;
  std::string reason = {};  // unsupported_shape, unsupported_query, undecided, what is wrong, or was not judged
  double value = 0;
  double expected = 0;     // NaN where the file has none
  double error = 0;        // |value - expected| / s, s as in `errorScale`
  bool sideAlone = false;  // an approximate pair query: it owes no more
  /// Of the method that was found wrong on the case: does it fail in the same way again?
  std::optional<bool> again = {};
};

/// Asks a method (with parameters, as gjk_epa{iterations=20}) what the case's finding says was asked, and judges as
/// `lpc verify` does; `unsupported_shape` where it does not take the shapes. Throws UserError where it does not exist.
/// Precondition: the case has a finding.
Verdict askAgain(const Case& c, const std::string& method);

/// Who is asked about a case with a finding: the method that was found, the referee where there is an expected value,
/// then the others of its stage (of broadphases the method alone).
std::vector<std::string> methodsToAsk(const Case& c);
/// The role that one of them has in its row; of a method that is not registered here, a competitor's.
AlgorithmRole roleOf(const Case& c, const std::string& method);
/// One of them. One that is not registered here refuses; the method that was found must be (else UserError): nobody
/// shall take it for mended.
CaseResult askFound(const Case& c, const std::string& method);

/// Every case with every method that takes its query: signed distances with each registered pair query, contacts with
/// each generator (by the check of verifyContacts), times of impact with each method that finds them, hulls with
/// `convexHull`, mass properties with `massProperties`. The referee stands in the table, too: where it is `wrong`, it
/// contradicts the file. A case with a finding is asked as it was found, its own method first; one of the other
/// precision is asked in this one.
std::vector<CaseResult> runCases(const std::vector<Case>& cases);

/// Is it one that must not happen: a competitor that is wrong (an approximate pair query: on the wrong side), fails, or
/// refuses what it declares?
bool isOurFault(const CaseResult& result);

/// Prints one line per case and method (id, method, verdict, value, expected value, error/s, reason; `-` where there is
/// no value) and a summary; into `csv` go the same lines with a head. Returns 0 when none is our fault, else 1.
int printCases(const std::vector<CaseResult>& rows, std::ostream& out, std::ostream* csv = nullptr);

/// Reads, runs and prints, all in this precision.
int verifyCases(const std::string& path, std::ostream& out, std::ostream* csv = nullptr);

}  // namespace lpc::inline LPC_PRECISION
