// SPDX-License-Identifier: Zlib
// Physics problems with a formula, and what our methods make of them:
//
//   TEST_F(KnownAnswer, catenary) { known("sag, 4 links", "split_solver", 2.7486, measured); }
//
// docs/known_answers.md has a row for each figure, with an interval that holds the error: relative, or absolute when
// the answer is 0. An error below it fails as one above it does, so that the table stays true when a method improves.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "tests/every_solver.h"
#include "tests/small_worlds.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test {

inline constexpr double kG = 9.81, kPi = 3.141592653589793, kDegree = kPi / 180;  // m/s^2, 1, rad
inline constexpr bool kDouble = sizeof(Real) == 8;

// Sanitizers make a minute of these: fewer methods then. What the others do under them, other tests say.
#if defined(LPC_SANITIZED)
inline constexpr bool kAllMethods = false;
#else
inline constexpr bool kAllMethods = true;
#endif

struct AnswerBound {
  double low = 0, high = 0;
};
using AnswerKey = std::tuple<std::string, std::string, std::string>;  // answer, figure, method

/// The rows between `<!-- answers -->` and `<!-- end -->` that are measured in this precision.
inline const std::map<AnswerKey, AnswerBound>& answerTable() {
  static const std::map<AnswerKey, AnswerBound> rows = [] {
    const auto cells = [](const std::string& line) {
      std::vector<std::string> out;
      std::istringstream in(line);
      std::string cell;
      std::getline(in, cell, '|');  // before the first bar
      while (std::getline(in, cell, '|')) {
        const auto first = cell.find_first_not_of(' '), last = cell.find_last_not_of(' ');
        out.push_back(first == std::string::npos ? "" : cell.substr(first, last - first + 1));
      }
      return out;
    };
    std::map<AnswerKey, AnswerBound> out;
    std::ifstream in(LPC_SOURCE_DIR "/docs/known_answers.md");
    bool inside = false;
    for (std::string line; std::getline(in, line);) {
      if (line == "<!-- answers -->" || line == "<!-- end -->") inside = line == "<!-- answers -->";
      const std::vector<std::string> c = cells(line);
      if (!inside || c.size() != 7) continue;
      AnswerBound b;
      if (std::sscanf(c[kDouble ? 5 : 6].c_str(), "%lf .. %lf", &b.low, &b.high) == 2) out[{c[0], c[1], c[2]}] = b;
    }
    return out;
  }();
  return rows;
}

/// What is wrong with an error, in words; empty when nothing is.
inline std::string fault(const AnswerBound* bound, double error) {
  if (!bound) return "docs/known_answers.md has no bound for it";
  if (error < bound->low) return "better, or wrong to the other side? Correct docs/known_answers.md";
  return error <= bound->high ? "" : "worse than docs/known_answers.md says";  // so is NaN
}

/// Named by the answer: every row of it must be measured, by known().
class KnownAnswer : public testing::Test {
 public:
  static std::string answer() { return testing::UnitTest::GetInstance()->current_test_info()->name(); }
  static std::set<AnswerKey>& seen() {
    static std::set<AnswerKey> keys;
    return keys;
  }

 protected:
  void TearDown() override {
    if (!kAllMethods) return;
    for (const auto& [key, bound] : answerTable()) {
      if (std::get<0>(key) != answer()) continue;
      EXPECT_TRUE(seen().contains(key)) << "a row that nobody measures: " << std::get<1>(key) << ", "
                                        << std::get<2>(key);
    }
  }
};

/// Holds a measured figure against its row. LPC_PRINT_ANSWERS=1 prints what was measured.
inline void known(const std::string& figure, const std::string& method, double expected, double measured) {
  const double error = expected == 0 ? measured : (measured - expected) / std::abs(expected);
  char text[120];
  std::snprintf(text, sizeof text, "%.9g | %.9g | %.3g", expected, measured, error);
  const std::string row = KnownAnswer::answer() + " | " + figure + " | " + method + " | " + text;
  if (std::getenv("LPC_PRINT_ANSWERS")) std::printf("row | %s\n", row.c_str());
  const AnswerKey key{KnownAnswer::answer(), figure, method};
  const auto found = answerTable().find(key);
  EXPECT_EQ(fault(found == answerTable().end() ? nullptr : &found->second, error), "") << row;
  KnownAnswer::seen().insert(key);
}

template <int D>
std::string in(const std::string& figure) {
  return figure + (D == 2 ? ", 2D" : ", 3D");
}

/// The one of two measured values that is further from the truth.
inline double worse(double a, double b, double truth) { return std::abs(a - truth) > std::abs(b - truth) ? a : b; }

/// Methods that a row judges together, by the worst of them.
struct Methods {
  std::string name;
  std::vector<std::string> solvers;
};

/// Those, and the solvers besides split_solver and soft_step, each by itself.
inline std::vector<Methods> andSolvers(std::vector<Methods> first) {
  if (!kAllMethods) return first;
  for (const char* solver : {"tgs", "tgs_ngs", "pgs_soft", "xpbd", "avbd"}) first.push_back({solver, {solver}});
  return first;
}
/// The velocity resolvers that are to solve a step to the end.
inline std::vector<Methods> toTheEnd() {
  return {{"split_solver{velocity=proximal_newton}", {"split_solver{velocity=proximal_newton}"}},
          {"split_solver{velocity=direct_lcp}", {"split_solver{velocity=direct_lcp}"}},
          {"split_solver{velocity=admm}", {"split_solver{velocity=admm}"}},
          {"split_solver{velocity=nncg}", {"split_solver{velocity=nncg}"}}};
}
/// Those, the other solvers, and the resolvers that solve to the end.
inline std::vector<Methods> andOthers(std::vector<Methods> first) {
  if (!kAllMethods) return first;
  first = andSolvers(std::move(first));
  for (const Methods& m : toTheEnd()) first.push_back(m);
  return first;
}
inline std::vector<Methods> allMethods() {
  return andOthers({{"split_solver", {"split_solver"}}, {"soft_step", {"soft_step"}}});
}

/// split_solver with each velocity resolver, and `set` besides: "impact=poisson,".
inline std::vector<std::string> everyVelocity(const std::string& set = "") {
  std::vector<std::string> solvers;
  for (const Registered* r : Registry::instance().list(StageKind::velocity, 2)) {
    if (competes(*r)) solvers.push_back("split_solver{" + set + "velocity=" + r->info.name + "}");
  }
  return solvers;
}

/// K(m), the complete elliptic integral of the first kind, by the arithmetic-geometric mean.
inline double ellipticK(double m) {
  double a = 1, b = std::sqrt(1 - m);
  while (std::abs(a - b) > 1e-15) {
    const double mean = (a + b) / 2;
    b = std::sqrt(a * b), a = mean;
  }
  return kPi / (2 * a);
}

/// An empty world with that solver.
template <int D>
World<D> worldOf(const std::string& solver, const Vec<D>& gravity = defaultGravity<D>()) {
  WorldSettings<D> settings;
  settings.gravity = gravity;
  return World<D>(Pipeline::parse("solver=" + solver), settings);
}

}}}  // namespace lpc::LPC_PRECISION::test
