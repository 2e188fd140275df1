// SPDX-License-Identifier: Zlib
// Every pair query, witnesses included, on seeded pairs of every two kinds of shape, against the referee's interval. A
// method is wrong when the referee's proof says so; methods that merely differ from each other are not compared.
#pragma once

#include <cstdint>
#include <iosfwd>
#include <string>
#include <vector>

#include "framework/registry.h"
#include "framework/shape.h"

namespace lpc::inline LPC_PRECISION {

struct VerifyOptions {
  int dimension = 3;
  int pairs = 200;  // per two kinds
  std::uint64_t seed = 1;
  double scale = 1;                       // size of the shapes (m)
  std::vector<std::string> methods = {};  // pipeline specs, as gjk_epa{tolerance=1e-10}; empty: all that are registered
};

/// One method on one pair of kinds. Errors are |distance - referee's interval| / s (errorScale), over the answers with
/// a value; a wrong side is a wrong yes or no where the true distance is beyond the tolerance.
struct VerifyRow {
  ShapeKind a = ShapeKind::sphere, b = ShapeKind::sphere;
  std::string method;
  Role role = Role::competitor;
  bool supported = true;
  int asked = 0, undecided = 0;  // of the asked, those that the referee could not decide
  int refused = 0, failed = 0, wrongSide = 0;
  int disagreements = 0;  // value, or depth along the normal, off by more than the tolerance
  double maxError = 0, medianError = 0;
  std::string worst = {};  // the case of the largest error, as a line of a corpus of cases; empty when all agree
};

/// 1e-12 of the pair's size in double precision, 1e-5 in single.
double verifyTolerance();

std::vector<VerifyRow> verifyPairs(const VerifyOptions& options);

/// The table for people, and below it the worst case of each row that disagrees. Returns the number of competitors'
/// rows with a refusal, failure, wrong side or disagreement: those are our faults.
int printVerification(const std::vector<VerifyRow>& rows, std::ostream& out);

}  // namespace lpc::inline LPC_PRECISION
