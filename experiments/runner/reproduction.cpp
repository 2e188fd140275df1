// SPDX-License-Identifier: Zlib
#include "experiments/runner/reproduction.h"

#include <charconv>
#include <cmath>
#include <filesystem>
#include <limits>
#include <regex>

#include "experiments/runner/code_identity.h"
#include "experiments/runner/locations.h"
#include "framework/math/check.h"
#include "framework/math/names.h"
#include "oracles/corpus/cases.h"
#include "oracles/verify/verify.h"
#include "oracles/witnesses/witness.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

const Case& caseOf(const std::vector<Case>& cases, const std::string& path, const std::string& which) {
  std::vector<std::string> ids;
  for (const Case& c : cases) {
    if (c.id == which) return c;
    ids.push_back(c.id);
  }
  std::size_t number = 0;
  const char* const end = which.data() + which.size();
  const auto [read, error] = std::from_chars(which.data(), end, number);
  if (error == std::errc() && read == end && number < cases.size()) return cases[number];
  const std::string meant = meantName(ids, which);
  throw UserError(path + ": there is no case '" + which + "'; " +
                  (meant.empty() ? "" : "did you mean '" + meant + "'? ") +
                  "valid: the id of a case, or its number, from 0 to " + std::to_string(cases.size() - 1));
}

template <int D>
std::unique_ptr<PairQuery<D>> witnessOf(const Spec& spec) {
  std::vector<std::string> names;
  for (const Registered* r : Registry::instance().list(StageKind::pairQuery, D)) {
    if (r->info.role != AlgorithmRole::witness) continue;
    if (r->info.name == spec.name) return createStage<PairQuery<D>>(spec);
    names.push_back(r->info.name);
  }
  throw UserError("there is no witness of pairs '" + spec.name + "' in " + std::to_string(D) + "D" +
                  validNames(names, spec.name));
}

// The library's answer in the terms of the query: infinite means only the side, NaN no answer.
template <int D>
double saidTo(const Question& q, const PairAnswer<D>& answer, Ending ending) {
  if (ending != Ending::answered || answer.status == QueryStatus::failed) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  constexpr double kApart = std::numeric_limits<double>::infinity();
  if (answer.status == QueryStatus::refused) return kApart;  // of the cores
  if (answer.status == QueryStatus::degenerate) return answer.distance < 0 ? -kApart : kApart;
  return static_cast<double>(answer.distance) / q.unit + q.snippet.rounding;
}

std::string toldOf(const Question& q, double said, Ending ending) {
  std::string out = std::string(q.isRight(said) ? "right" : "wrong") + " here: ";
  if (ending != Ending::answered) {
    out += std::string(endingName(ending));
  } else if (std::isnan(said)) {
    out += "no answer";
  } else {
    out += !std::isinf(said) ? literal(said) : said > 0 ? "apart" : "overlapping";
  }
  out += ", and the truth lies in [" + literal(q.truth.lo) + ", " + literal(q.truth.hi) + "]";
  if (q.unit != 1) out += ", in units of " + literal(q.unit) + " m";
  return out + "; the program returns " + (q.isRight(said) ? "0" : "1");
}

// Text of a file for a comment: it starts no new line, and does not end the comment's line with a backslash.
std::string quoted(const std::string& text) { return "'" + oneLine(text) + "'"; }

std::string titleOf(const Case& c, const Question& q, const Spec& spec, int dimension, const std::string& file) {
  namespace fs = std::filesystem;
  static const std::regex plain("[A-Za-z0-9_.][A-Za-z0-9_.-]*\\.(cpp|cc|cxx|C)");
  const std::string given = fs::path(file).filename().string();
  const std::string source = std::regex_match(given, plain) ? given : "repro.cpp",
                    made = fs::path(source).stem().string();
  const nlohmann::json code = codeHashes(StageKind::pairQuery, spec, dimension);
  std::string out = "// " + code.value("library", spec.name) + ": g++ -std=c++17 -O2 " + source + " " +
                    q.snippet.flags + " -o " + made + " && ./" + made + "\n";
  out += "// LPC's case " + quoted(c.id) + (c.source.empty() ? "" : ", of " + quoted(c.source)) + ", as its witness " +
         quoted(spec.text()) + " asks it: in the frame of one shape, in units of " + literal(q.unit) + " m.\n";
  if (q.snippet.rounding > 0) {
    out += "// Together they are rounded by " + literal(q.snippet.rounding) +
           ", which is left out: their cores are asked.\n";
  }
  return out;
}

template <int D>
Reproduction reproduceIn(const Case& c, const CaseGeometry<D>& g, const Spec& spec, const std::string& file) {
  const auto method = witnessOf<D>(spec);
  const std::string name = "case '" + c.id + "': ";
  if (c.query != CaseQuery::signedDistance && c.query != CaseQuery::contacts) {
    throw UserError(name + "its query is '" + c.queryText + "'; valid: signed_distance, contacts");
  }
  for (const CaseShape<D>* s : {&g.a, &g.b}) {
    if (!s->shape) throw UserError(name + "a shape is none of ours: " + s->refusal);
  }
  const HardPair<D> pair = g.pair();
  PairView<D> view{pair.a.view(), pair.b.view(), pair.X_AB};
  if (view.a.kind > view.b.kind) view = {view.b, view.a, view.X_AB.inverse()};  // in the order of queryPair
  if (!method->supports(view.a.kind, view.b.kind)) {
    throw UserError(name + spec.name + " is not asked " + std::string(shapeKindName(view.a.kind)) + " against " +
                    std::string(shapeKindName(view.b.kind)) + " in " + std::to_string(D) + "D");
  }
  auto& witness = dynamic_cast<Witness<D>&>(*method);
  const std::optional<Question> question = witness.question(view);
  if (!question) throw UserError(name + "the adapter of " + spec.name + " has no words for a program");
  if (!question->truth.decided) throw UserError(name + "the referee has no proved interval for it");
  const PairAnswer<D> answer = queryPair(witness, view.a, view.b, view.X_AB);
  const Ending ending = witness.endings()[0];
  std::string told =
      spec.text() + " on " + c.id + " is " + toldOf(*question, saidTo(*question, answer, ending), ending);
  const Verdict verdict = judge(view, pairTruth(view), answer, AlgorithmRole::witness, ending);
  if (verdict.failure == "wrong_normal") told += ", since it asks for no normal, which is wrong";
  return {question->program(titleOf(c, *question, spec, D, file)), told};
}

}  // namespace

std::string keptCases() { return homeDirectory() + "/tests/regressions/hard_cases.json"; }

Reproduction reproduce(const std::string& casesFile, const std::string& which, const std::string& witness,
                       const std::string& file) {
  const std::vector<Case> cases = readCases(casesFile);
  const Case& c = caseOf(cases, casesFile, which);
  const Spec spec = Spec::parse(witness);
  return std::visit([&](const auto& g) { return reproduceIn(c, g, spec, file); }, c.geometry);
}

}}  // namespace lpc::LPC_PRECISION
