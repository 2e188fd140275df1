// SPDX-License-Identifier: Zlib
// Physics problems with a formula, and the error of each method:
//
//   TEST_F(KnownAnswer, catenary) { known("sag, 4 links", "split_solver", 2.7486, measured); }
//
// answers.data has a row for each figure and method, with an interval of the error: relative, or absolute if the right
// value is 0. An error below the interval fails, too, so the data stay true when a method improves.
// reports/known_answers.py writes docs/known_answers.md from the same file.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "tests/every_solver.h"
#include "tests/small_worlds.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test {

inline constexpr double kG = 9.81, kPi = 3.141592653589793, kDegree = kPi / 180;  // m/s^2, 1, rad
inline constexpr bool kDouble = sizeof(Real) == 8;

// With sanitizers all methods take a minute: run fewer. Other tests run the rest under sanitizers.
#if defined(LPC_SANITIZED)
inline constexpr bool kAllMethods = false;
#else
inline constexpr bool kAllMethods = true;
#endif

struct AnswerBound {
  double low = 0, high = 0;
};
using AnswerKey = std::tuple<std::string, std::string, std::string>;  // answer, figure, method

/// The rows of answers.data that are measured in this precision.
inline const std::map<AnswerKey, AnswerBound>& answerTable() {
  static const std::map<AnswerKey, AnswerBound> rows = [] {
    std::map<AnswerKey, AnswerBound> out;
    std::ifstream in(LPC_SOURCE_DIR "/tests/known_answers/answers.data");
    std::string answer;
    for (std::string line; std::getline(in, line);) {
      if (line.starts_with("[")) answer = line.substr(1, line.find(']') - 1);
      std::vector<std::string> c;
      for (std::size_t from = 0, to = 0; to != line.npos; from = to + 3) {
        to = line.find(" | ", from);
        c.push_back(line.substr(from, to - from));
      }
      AnswerBound b;
      if (c.size() == 6 && std::sscanf(c[kDouble ? 4 : 5].c_str(), "%lf .. %lf", &b.low, &b.high) == 2) {
        out[{answer, c[0], c[1]}] = b;
      }
    }
    return out;
  }();
  return rows;
}

/// Says why an error is outside its interval; empty if it is inside.
inline std::string fault(const AnswerBound* bound, double error) {
  if (!bound) return "tests/known_answers/answers.data has no row for it";
  if (error < bound->low)
    return "below the interval of tests/known_answers/answers.data: better, or wrong with the other sign";
  return error <= bound->high ? "" : "above the interval of tests/known_answers/answers.data";  // also NaN
}

/// The test's name is the name of the problem. Fails if a row of the problem was not measured by known().
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
      EXPECT_TRUE(seen().contains(key)) << "no test measures this row: " << std::get<1>(key) << ", "
                                        << std::get<2>(key);
    }
  }
};

/// Compares a measured figure with its row. LPC_PRINT_ANSWERS=1 prints each measured value.
inline void known(const std::string& figure, const std::string& method, double expected, double measured) {
  const double error = expected == 0 ? measured : (measured - expected) / std::abs(expected);
  char text[120];
  std::snprintf(text, sizeof text, "%.9g | %.9g | %.3g", expected, measured, error);
  const std::string row = KnownAnswer::answer() + " | " + figure + " | " + method + " | " + text;
  if (std::getenv("LPC_PRINT_ANSWERS")) std::printf("f%d | %s\n", kDouble ? 64 : 32, row.c_str());
  const AnswerKey key{KnownAnswer::answer(), figure, method};
  const auto found = answerTable().find(key);
  EXPECT_EQ(fault(found == answerTable().end() ? nullptr : &found->second, error), "") << row;
  KnownAnswer::seen().insert(key);
}

template <int D>
std::string in(const std::string& figure) {
  return figure + (D == 2 ? ", 2D" : ", 3D");
}

/// Returns the measured value that is farther from the right one.
inline double worse(double a, double b, double truth) { return std::abs(a - truth) > std::abs(b - truth) ? a : b; }

/// Methods that share a row; the row holds the worst error.
struct Methods {
  std::string name;
  std::vector<std::string> solvers;
};

/// Appends each solver other than split_solver and soft_step.
inline std::vector<Methods> andSolvers(std::vector<Methods> first) {
  if (!kAllMethods) return first;
  for (const char* solver : {"tgs", "tgs_ngs", "pgs_soft", "xpbd", "avbd"}) first.push_back({solver, {solver}});
  return first;
}
/// The velocity resolvers that solve a step exactly or to a tolerance.
inline std::vector<Methods> toTheEnd() {
  return {{"split_solver{velocity=proximal_newton}", {"split_solver{velocity=proximal_newton}"}},
          {"split_solver{velocity=direct_lcp}", {"split_solver{velocity=direct_lcp}"}},
          {"split_solver{velocity=admm}", {"split_solver{velocity=admm}"}},
          {"split_solver{velocity=nncg}", {"split_solver{velocity=nncg}"}}};
}
/// Appends the other solvers and the resolvers of toTheEnd().
inline std::vector<Methods> andOthers(std::vector<Methods> first) {
  if (!kAllMethods) return first;
  first = andSolvers(std::move(first));
  for (const Methods& m : toTheEnd()) first.push_back(m);
  return first;
}
inline std::vector<Methods> allMethods() {
  return andOthers({{"split_solver", {"split_solver"}}, {"soft_step", {"soft_step"}}});
}

/// split_solver with each velocity resolver; `set` holds further parameters, such as "impact=poisson,".
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

/// An empty world with this solver.
template <int D>
World<D> worldOf(const std::string& solver, const Vec<D>& gravity = defaultGravity<D>()) {
  WorldSettings<D> settings;
  settings.gravity = gravity;
  return World<D>(Pipeline::parse("solver=" + solver), settings);
}

}}}  // namespace lpc::LPC_PRECISION::test
