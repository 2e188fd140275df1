// SPDX-License-Identifier: Zlib
// Pairs that `lpc verify` found, with the bits that a method was asked: it was wrong, is mended, and stays right. Each
// build takes the cases of its own precision. And what a file of such cases may not hold.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "framework/check.h"
#include "oracles/cases.h"

namespace lpc::inline LPC_PRECISION {
namespace {

const std::string kFile = std::string(LPC_SOURCE_DIR) + "/tests/regressions/found_cases.json";
const std::string kPrecision = sizeof(Real) == 8 ? "f64" : "f32";

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (std::size_t at = text.find(part); at != text.npos; at = text.find(part, at + 1)) ++n;
  return n;
}

TEST(FoundCases, MendedOnesStayRight) {
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

TEST(FoundCases, CountIsThatOfTheList) {
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

// What ProxyChanges allows, and no more: a slot that is freed, taken again and moved in one step.
TEST(FoundCases, ScriptsAreWhatAWorldCouldTell) {
  const std::string first = "[" + added(0) + "], ";
  EXPECT_EQ(complaint(script("2", first + "[" + moved(0) + "]")), "");
  EXPECT_EQ(complaint(script("2", first + "[" + removed(0) + ", " + added(0) + ", " + moved(0) + "]")), "");
  EXPECT_EQ(complaint(script("2", first + "[" + removed(0) + "], [" + added(0) + "], [" + removed(0) + "]")), "");
  const std::string inOrder = " in the same step; valid: removed, added, moved, each once at most and in this order";
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
  EXPECT_EQ(complaint(script("2", "[" + added(0, "[1e300, 1]") + "]")),
            sizeof(Real) == 8 ? "" : "f.json: case 'c': slot 0: 'lo' or 'hi' is too large for f32");
}

// The judge looks at every two slots in every step: what it would never come to an end of is not taken.
TEST(FoundCases, ScriptsAreOfASizeThatCanBeJudged) {
  for (const char* const slots : {"0", "2001", "1000000"}) {
    EXPECT_EQ(complaint(script(slots, "")),
              std::string("f.json: case 'c': field 'slots' holds ") + slots + "; valid: a whole number from 1 to 2000");
  }
  std::string steps = "[]";
  for (int i = 1; i < 100; ++i) steps += ", []";
  EXPECT_EQ(complaint(script("2000", steps)), "");
  EXPECT_EQ(complaint(script("2", steps + ", []")), "f.json: case 'c': field 'steps' has 101; valid: at most 100");
}

}  // namespace
}  // namespace lpc::inline LPC_PRECISION
