// SPDX-License-Identifier: Zlib
// Pairs that `lpc verify` found, with the bits of the query. A method was wrong on each, was mended, and must stay
// right. Each build runs the cases of its own precision. Also: which contents of such a file are refused, and which
// methods a case queries.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <sstream>

#include "framework/math/check.h"
#include "oracles/verify/case_run.h"

namespace lpc { inline namespace LPC_PRECISION { namespace {

const std::string kFile = std::string(LPC_SOURCE_DIR) + "/tests/regressions/found_cases.json";
const std::string kPrecision = sizeof(Real) == 8 ? "f64" : "f32";

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (std::size_t at = text.find(part); at != text.npos; at = text.find(part, at + 1)) ++n;
  return n;
}

TEST(FoundCases, MendedCasesStayRight) {
  std::ifstream file(kFile);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  std::size_t asked = 0;
  for (const Case& c : parseCases(text, kFile)) {
    if (!c.finding || c.finding->precision != kPrecision) continue;
    const Verdict verdict = askAgain(c, c.finding->method);
    EXPECT_TRUE(verdict.end == Tally::agree || verdict.end == Tally::tie) << c.id << ": " << verdict.failure;
    ++asked;
  }
  EXPECT_EQ(asked, count(text, "\"precision\": \"" + kPrecision + '"'));
  EXPECT_GT(asked, 0u);
}

// --- the file --------------------------------------------------------------------------------------------------------

std::string finding(const std::string& stage, const std::string& method) {
  return R"("found": {"stage": ")" + stage + R"(", "precision": ")" + kPrecision + R"(", "method": ")" + method +
         R"(", "failure": "x", "error": null, "seed": 1, "number": 1})";
}
std::string listed(const std::string& fields) { return R"({"cases": [{"id": "c", )" + fields + "}]}"; }

std::string complaint(const std::string& text) {
  try {
    parseCases(text, "f.json");
  } catch (const UserError& error) {
    return error.what();
  }
  return "";
}

constexpr const char* kBoxes =
    R"("dim": 2, "shapeA": {"type": "box", "half_extents": [1, 1]}, "poseA": {"t": [0, 0]},
    "shapeB": {"type": "box", "half_extents": [1, 1]}, "poseB": {"t": [3, 0]}, )";

std::string boxes(const std::string& query, const std::string& distance, const std::string& found) {
  return listed(kBoxes + (R"("query": ")" + query + R"(", "expected": {"signed_distance": )" + distance + "}" + found));
}

TEST(FoundCases, AnExpectedValueMayBeNull) {
  for (const std::string& query : {std::string("signed_distance"), std::string("contacts")}) {
    EXPECT_EQ(complaint(boxes(query, "1", "")), "");
    EXPECT_EQ(complaint(boxes(query, "null", "")), "");
    EXPECT_EQ(complaint(boxes(query, "true", "")),
              "f.json: case 'c': field 'signed_distance' holds true; valid: a number");
    const bool contacts = query == "contacts";
    const std::string found = finding(contacts ? "contacts" : "pair_query", contacts ? "sat_clip" : "sat");
    // Then the referee has nothing to confirm; the methods are still judged.
    const std::vector<CaseResult> rows = runCases(parseCases(boxes(query, "null", ", " + found), "f.json"));
    EXPECT_GT(rows.size(), 2u);
    for (const CaseResult& row : rows) {
      EXPECT_NE(row.role, AlgorithmRole::referee);
      EXPECT_TRUE(row.verdict == CaseVerdict::ok || row.reason == "unsupported_shape") << row.method;
    }
    std::ostringstream table, csv;
    EXPECT_EQ(printCases(rows, table, &csv), 0);
    EXPECT_EQ((table.str() + csv.str()).find("nan"), std::string::npos) << table.str() << csv.str();
  }
}

TEST(FoundCases, CountEqualsTheLengthOfTheList) {
  std::string text = boxes("contacts", "1", "");
  text.insert(1, R"("count": 1, )");
  EXPECT_EQ(complaint(text), "");
  text.replace(text.find("1, "), 1, "2");
  EXPECT_EQ(complaint(text), "f.json: field 'count' holds 2, and the list 'cases' has 1");
}

std::string script(const std::string& slots, const std::string& steps) {
  return listed(R"("dim": 2, "query": "broadphase", "slots": )" + slots + R"(, "steps": [)" + steps + "], " +
                finding("broadphase", "naive") + R"(, "expected": {})");
}
std::string added(int slot, const std::string& hi = "[1, 1]") {
  return R"({"added": )" + std::to_string(slot) + R"(, "lo": [0, 0], "hi": )" + hi +
         R"(, "body": 1, "active": true, "category": 1, "mask": 1})";
}
std::string removed(int slot) { return R"({"removed": )" + std::to_string(slot) + "}"; }
std::string moved(int slot) { return R"({"moved": )" + std::to_string(slot) + R"(, "lo": [0, 0], "hi": [1, 1]})"; }

// Only what ProxyChanges allows: a slot may be freed, reused and moved in one step.
TEST(FoundCases, ScriptsObeyProxyChanges) {
  const std::string first = "[" + added(0) + "], ";
  EXPECT_EQ(complaint(script("2", first + "[" + moved(0) + "]")), "");
  EXPECT_EQ(complaint(script("2", first + "[" + removed(0) + ", " + added(0) + ", " + moved(0) + "]")), "");
  EXPECT_EQ(complaint(script("2", first + "[" + removed(0) + "], [" + added(0) + "], [" + removed(0) + "]")), "");
  const std::string inOrder = " in the same step; valid: removed, added, moved, each at most once and in this order";
  const std::pair<std::string, std::string> bad[] = {
      {added(1) + ", " + removed(1), "slot 1 is removed after it was added" + inOrder},
      {removed(0) + ", " + added(0) + ", " + removed(0), "slot 0 is removed after it was added" + inOrder},
      {moved(0) + ", " + moved(0), "slot 0 is moved after it was moved" + inOrder},
      {moved(0) + ", " + removed(0), "slot 0 is removed after it was moved" + inOrder},
      {moved(1), "slot 1 is moved but free"},
      {added(0), "slot 0 is added but in use"},
      {added(2), "field 'added' holds 2; valid: a whole number from 0 to 1"},
      {added(1, "[-1, 1]"), "slot 1: 'lo' is above 'hi'"},
  };
  for (const auto& [step, message] : bad) {
    EXPECT_EQ(complaint(script("2", first + "[" + step + "]")), "f.json: case 'c': " + message);
  }
  const std::vector<CaseResult> rows = runCases(parseCases(script("2", "[" + added(0, "[1e300, 1]") + "]"), "f.json"));
  EXPECT_EQ(rows.at(0).unread, sizeof(Real) == 4) << "too large for f32";
}

// The check compares all pairs of slots in every step, so cases that would take too long are refused.
TEST(FoundCases, OversizedScriptsAreRefused) {
  for (const char* const slots : {"0", "2001", "1000000"}) {
    EXPECT_EQ(complaint(script(slots, "")),
              std::string("f.json: case 'c': field 'slots' holds ") + slots + "; valid: a whole number from 1 to 2000");
  }
  std::string steps = "[]";
  for (int i = 1; i < 100; ++i) steps += ", []";
  EXPECT_EQ(complaint(script("2000", steps)), "");
  EXPECT_EQ(complaint(script("2", steps + ", []")), "f.json: case 'c': field 'steps' has 101; valid: at most 100");
}

// --- queried methods -------------------------------------------------------------------------------------------------

Case parsed(const std::string& text) { return parseCases(text, "f.json").front(); }

// A hull that is flat in this precision may be valid in another, in which the methods to query were chosen.
TEST(FoundCases, InvalidShapesAreRefused) {
  const std::string flat = R"({"type": "convex", "points": [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]]})";
  for (const std::string& method : {std::string("sat"), std::string("gjk_epa")}) {
    const Case c = parsed(listed(R"("dim": 3, "query": "signed_distance", "shapeA": )" + flat +
                                 R"(, "poseA": {"t": [0, 0, 0]}, "shapeB": {"type": "sphere", "radius": 1},
        "poseB": {"t": [0, 0, 3]}, "expected": {"signed_distance": 2}, )" +
                                 finding("pair_query", method)));
    const std::vector<std::string> methods = methodsToAsk(c);
    EXPECT_EQ(std::count(methods.begin(), methods.end(), "referee"), 0);
    for (const std::string& asked : {method, std::string("referee")}) {
      const CaseResult row = askFound(c, asked);
      EXPECT_EQ(row.verdict, CaseVerdict::refused) << asked;
      EXPECT_EQ(row.reason, "unsupported_shape") << asked;
      EXPECT_EQ(row.role, asked == "referee" ? AlgorithmRole::referee : AlgorithmRole::competitor);
      EXPECT_FALSE(isOurFault(row));
    }
    EXPECT_EQ(askAgain(c, method).failure, "unsupported_shape");
  }
}

// A circle in a circular ellipse with the same centre: every normal is equally good, so the referee cannot decide.
TEST(FoundCases, UndecidedCasesAreNoFault) {
  for (const bool found : {false, true}) {
    const Case c = parsed(listed(R"("dim": 2, "query": "contacts", "shapeA": {"type": "ellipsoid", "radii": [1, 1]},
        "poseA": {"t": [0, 0]}, "shapeB": {"type": "sphere", "radius": 0.5}, "poseB": {"t": [0, 0]},
        "expected": {"signed_distance": -1.5})" +
                                 (found ? ", " + finding("contacts", "deepest_point") : "")));
    int undecided = 0;
    for (const CaseResult& row : runCases({c})) {
      EXPECT_FALSE(isOurFault(row)) << row.method << ": " << row.reason;
      EXPECT_EQ(row.verdict, CaseVerdict::refused) << row.method;
      undecided += row.reason == "undecided";
    }
    EXPECT_EQ(undecided, 5) << "the referee, sat_clip, query_clip, deepest_point, persistent_manifold";
  }
}

// A method that no longer exists was not mended.
TEST(FoundCases, UnknownMethodsAreAUserError) {
  const Case c = parsed(boxes("signed_distance", "1", ", " + finding("pair_query", "gjk_ep{iterations=20}")));
  try {
    runCases({c});
    ADD_FAILURE() << "it was asked";
  } catch (const UserError& error) {
    const std::string message = error.what();
    EXPECT_TRUE(
        message.starts_with("case 'c': the method 'gjk_ep' is neither built in nor of a --plugin; "
                            "did you mean 'gjk_epa'? valid: "))
        << message;
  }
  EXPECT_EQ(askFound(c, "nobody").reason, "unknown_method");  // as for a method that exists in another precision only
}

}  // namespace
}}  // namespace lpc::LPC_PRECISION
