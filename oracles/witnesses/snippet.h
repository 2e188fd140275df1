// SPDX-License-Identifier: Zlib
// A query of a witness as a program that uses only its library: for that library's issue tracker.
#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>

#include "oracles/referee/referee.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Parts of the program, from the adapter of a library.
struct Snippet {
  std::string flags = {};  // for g++: "-lode"
  std::string head = {};   // #include lines, then functions
  std::string body = {};   // of main: ends with `double distance`; +-infinite for a side only, NaN for no answer
  double rounding = 0;     // of both shapes (m), when the library has no rounding and queries the cores
};

/// A query as the library gets it, in a unit in which the larger shape is about 1.
struct Question {
  Snippet snippet;
  double unit = 1;  // m; a power of two: all numbers below are in this unit
  struct Truth {
    bool decided = false;  // false: there is no proof
    double lo = 0, hi = 0;
  } truth;             // distance of the shapes that the library supports
  double allowed = 0;  // tolerance outside of the truth's interval, for rounding

  /// True when `distance` (as above) is right. The program returns 0 in this case.
  bool isRight(double distance) const;
  /// The whole program; the lines of `title` become its first comments.
  std::string program(const std::string& title) const;
};

/// A C++ double with all digits.
std::string literal(double x);
/// "1, 2, 3": row by row.
std::string literals(const Eigen::MatrixXd& m);
/// `static void NAME(const double* d, double* p)`: p is the support point of the core along d, in its own frame, equal
/// to coreSupport to the last bit. Throws UserError for a kind without this text.
std::string coreSupportText(const std::string& name, const ShapeView<3>& shape);

}}  // namespace lpc::LPC_PRECISION
