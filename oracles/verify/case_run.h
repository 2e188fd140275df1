// SPDX-License-Identifier: Zlib
// Runs every method on the cases of a corpus.
#pragma once

#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "oracles/corpus/cases.h"
#include "oracles/verify/verdict.h"

namespace lpc { inline namespace LPC_PRECISION {

enum class CaseVerdict { ok, wrong, refused, failed, hang };
std::string_view caseVerdictName(CaseVerdict verdict);

/// Result of one method on one case.
struct CaseResult {
  std::string id, method;
  std::string precision = sizeof(Real) == 8 ? "f64" : "f32";
  AlgorithmRole role = AlgorithmRole::competitor;
  CaseVerdict verdict = CaseVerdict::refused;
  std::string reason = {};  // unsupported_shape, unsupported_query, undecided, what is wrong, or what was not judged
  double value = 0;
  double expected = 0;     // by which it was judged; NaN when nobody knows. The referee's: what the file has
  double error = 0;        // |value - expected| / s, s as in `errorScale`; of a time of impact: the separation then / s
  bool sideAlone = false;  // an approximate pair query, of which only the side is judged
  bool unread = false;     // the case cannot be read, and no method was run
  /// For the method of the finding: true when it fails in the same way again.
  std::optional<bool> again = {};
};

/// Runs a method (with parameters, as gjk_epa{iterations=20}) on the input of the case's finding, and judges as `lpc
/// verify` does; `unsupported_shape` when it does not take the shapes. Throws UserError when the method does not exist.
/// Precondition: the case has a finding.
Verdict askAgain(const Case& c, const std::string& method);

/// Methods to run on a case with a finding: the method of the finding; the referee when there is an expected value;
/// then the other methods of its stage. For broadphases only the method of the finding.
std::vector<std::string> methodsToAsk(const Case& c);
/// The role of a method in its row; competitor for a method that is not registered here.
AlgorithmRole roleOf(const Case& c, const std::string& method);
/// Runs one method on a case with a finding. A method that is not registered gives `refused`. For the method of the
/// finding throws UserError instead, so that it cannot be mistaken for fixed.
CaseResult askFound(const Case& c, const std::string& method);

/// The row of a case that cannot be read.
CaseResult unreadRow(const Case& c);

/// Runs every case with every registered method that takes its query. Contacts are checked as in verifyContacts; hulls
/// and mass properties are computed by `convexHull` and `massProperties`. The referee is in the table too: where it is
/// `wrong`, it contradicts the file. Methods are judged by the file's value, or by the referee's if the file has none
/// or is contradicted. A case with a finding is run as it was found, with the method of the finding first; a case of
/// the other precision is run in this one.
std::vector<CaseResult> runCases(const std::vector<Case>& cases);

/// True for a result that fails the run: a competitor that is wrong (an approximate pair query: on the wrong side),
/// fails, or rejects what it declares to support.
bool isOurFault(const CaseResult& result);

/// True for a result that shows a mistake in the file: a value that the referee contradicts, or an unread case.
bool isFilesFault(const CaseResult& result);

/// Prints a header, one line per case and method (`-` when there is no value) and a summary. Writes the same lines to
/// `csv`. Returns 1 when isOurFault() or isFilesFault() is true for a row, otherwise 0; with `skipBroken` an unread
/// case does not count.
int printCases(const std::vector<CaseResult>& rows, std::ostream& out, std::ostream* csv = nullptr,
               bool skipBroken = false);

/// Reads, runs and prints a file of cases, all in this precision.
int verifyCases(const std::string& path, std::ostream& out, std::ostream* csv = nullptr);

}}  // namespace lpc::LPC_PRECISION
