// SPDX-License-Identifier: Zlib
// The table of the cases' results.
#include <cmath>
#include <iomanip>
#include <map>
#include <ostream>
#include <sstream>

#include "framework/math/check.h"
#include "framework/math/names.h"
#include "oracles/corpus/hard_pairs.h"
#include "oracles/verify/case_run.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

bool hasValue(const CaseResult& row) { return row.verdict == CaseVerdict::ok || row.verdict == CaseVerdict::wrong; }

// Returns `otherwise` when the file has no expected value.
std::string expectedOr(const CaseResult& row, const char* otherwise) {
  return std::isnan(row.expected) ? otherwise : numberText(row.expected);
}

std::string reasonOf(const CaseResult& row) {
  if (!row.again) return row.reason;
  return *row.again ? "fails again: " + row.reason
                    : row.reason + (row.reason.empty() ? "" : ", ") + "different from the failure found earlier";
}

void print(const CaseResult& row, std::ostream& out) {
  out << std::left << std::setw(40) << oneLine(row.id) << ' ' << std::setw(19) << row.method << ' ' << std::setw(9)
      << row.precision << ' ' << std::setw(7) << caseVerdictName(row.verdict) << ' ';
  if (hasValue(row)) {
    out << std::setprecision(17) << row.value << ' ' << expectedOr(row, "-") << ' ' << std::setprecision(2)
        << row.error;
  } else {
    out << "- - -";
  }
  if (const std::string reason = reasonOf(row); !reason.empty()) out << ' ' << reason;
  out << '\n';
}

// A method with several parameters has commas.
std::string cell(const std::string& text) {
  std::ostringstream quoted;
  quoted << std::quoted(text, '"', '"');
  return text.find_first_of(",\"\n\r") == std::string::npos ? text : quoted.str();
}

void write(const CaseResult& row, std::ostream& csv) {
  csv << cell(row.id) << ',' << cell(row.method) << ',' << row.precision << ',' << caseVerdictName(row.verdict) << ','
      << std::setprecision(17);
  if (hasValue(row)) {
    csv << row.value << ',' << expectedOr(row, "") << ',' << row.error;
  } else {
    csv << ",,";
  }
  csv << ',' << std::quoted(reasonOf(row), '"', '"') << '\n';
}

}  // namespace

int printCases(const std::vector<CaseResult>& rows, std::ostream& out, std::ostream* csv, bool skipBroken) {
  std::map<std::string, std::map<CaseVerdict, int>> summary;
  int faults = 0, found = 0, again = 0, contradicted = 0, unread = 0;
  out << std::left << std::setw(40) << "id" << ' ' << std::setw(19) << "method"
      << " precision verdict value expected error/s reason\n";
  if (csv) *csv << "id,method,precision,verdict,value,expected,error,reason\n";
  for (const CaseResult& row : rows) {
    print(row, out);
    if (csv) write(row, *csv);
    ++summary[row.method][row.verdict];
    faults += isOurFault(row), found += row.again.has_value(), again += row.again.value_or(false);
    unread += row.unread, contradicted += isFilesFault(row) && !row.unread;
  }
  for (const auto& [method, counts] : summary) {
    out << std::left << std::setw(19) << method;
    for (const auto& [verdict, count] : counts) out << "  " << caseVerdictName(verdict) << ' ' << count;
    out << '\n';
  }
  if (found > 0) out << "failures found earlier: " << found << ", of which " << again << " still fail" << '\n';
  if (unread > 0) out << "cases that cannot be read" << (skipBroken ? ", skipped: " : ": ") << unread << '\n';
  if (contradicted > 0) out << "expected values of the file that the referee contradicts: " << contradicted << '\n';
  out << "wrong answers of LPC's own methods: " << faults << '\n';
  return faults > 0 || contradicted > 0 || (unread > 0 && !skipBroken) ? 1 : 0;
}

int verifyCases(const std::string& path, std::ostream& out, std::ostream* csv) {
  return printCases(runCases(readCases(path)), out, csv);
}

}}  // namespace lpc::LPC_PRECISION
