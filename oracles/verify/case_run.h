// SPDX-License-Identifier: Zlib
// Every method on the cases of a corpus.
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

}}  // namespace lpc::LPC_PRECISION
