// SPDX-License-Identifier: Zlib
// What a witness is asked, as a program against its library alone: for that library's issue tracker.
#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>

#include "oracles/referee/referee.h"

namespace lpc { inline namespace LPC_PRECISION {

/// What an adapter says of its library.
struct Snippet {
  std::string flags = {};  // of g++: "-lode"
  std::string head = {};   // #include lines, then functions
  std::string body = {};   // of main: ends with `double distance`, +-infinite for a side and no more, NaN for no answer
  double rounding = 0;     // of both shapes (m), where the library knows none and is asked the cores
};

/// A question as the library has it: in a unit in which the larger shape is about 1.
struct Question {
  Snippet snippet;
  double unit = 1;  // m; a power of two: all that follows is in it
  struct Truth {
    bool decided = false;  // false: nothing is proved
    double lo = 0, hi = 0;
  } truth;             // of the distance of the shapes that the library knows
  double allowed = 0;  // beyond the truth's interval, for rounding

  /// Is that the distance (as `distance` above)? The program returns 0 when it is.
  bool isRight(double distance) const;
  /// The whole program; `title` is its first line and others, each a comment.
  std::string program(const std::string& title) const;
};

/// A double of C++ with all digits.
std::string literal(double x);
/// "1, 2, 3": row by row.
std::string literals(const Eigen::MatrixXd& m);
/// `static void NAME(const double* d, double* p)`: p is a point of the core, in its own frame, that lies farthest
/// along d, to the last bit as coreSupport has it. Throws UserError for a kind that nobody has written so.
std::string coreSupportText(const std::string& name, const ShapeView<3>& shape);

}}  // namespace lpc::LPC_PRECISION
