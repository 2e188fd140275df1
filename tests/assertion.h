// SPDX-License-Identifier: Zlib
// RapidCheck's RC_ASSERT decomposes whole expressions: as many templates per assertion as operators, a third of a
// test's compile time. This one decomposes only the comparison.
#pragma once

#include <rapidcheck/Assertions.h>
#include <rapidcheck/Log.h>

#include <string>

namespace lpc { inline namespace LPC_PRECISION { namespace test {

/// The text of a failed assertion and the values of its operands.
struct Claim {
  bool holds;
  std::string values;

  explicit operator bool() const { return holds; }
};

// The operands are no longer literals: here 0 is an int with another sign or width than the other operand.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wsign-compare"
#pragma GCC diagnostic ignored "-Wconversion"
template <class L>
struct LeftSide {
  const L& left;

  explicit operator bool() const { return static_cast<bool>(left); }
  template <class R>
  Claim operator==(const R& right) const {
    return claim(left == right, "==", right);
  }
  template <class R>
  Claim operator!=(const R& right) const {
    return claim(left != right, "!=", right);
  }
  template <class R>
  Claim operator<(const R& right) const {
    return claim(left < right, "<", right);
  }
  template <class R>
  Claim operator<=(const R& right) const {
    return claim(left <= right, "<=", right);
  }
  template <class R>
  Claim operator>(const R& right) const {
    return claim(left > right, ">", right);
  }
  template <class R>
  Claim operator>=(const R& right) const {
    return claim(left >= right, ">=", right);
  }

 private:
  template <class R>
  Claim claim(bool holds, const char* relation, const R& right) const {
    if (holds) return {true, {}};
    return {false, rc::toString(left) + ' ' + relation + ' ' + rc::toString(right)};
  }
};
#pragma GCC diagnostic pop

/// `claims << a + b < c` is (claims << a + b) < c.
struct Claims {
  template <class L>
  LeftSide<L> operator<<(const L& left) const {
    return {left};
  }
};
inline constexpr Claims claims;

inline Claim claimOf(Claim c) { return c; }
inline Claim claimOf(bool holds) { return {holds, holds ? "true" : "false"}; }
template <class L>
Claim claimOf(const LeftSide<L>& whole) {
  return {static_cast<bool>(whole), rc::toString(whole.left)};
}

/// Ends the running case as a failure.
[[noreturn]] void failCase(const char* file, int line, const char* assertion, const std::string& values);

}}}  // namespace lpc::LPC_PRECISION::test

#undef RC_ASSERT
#define RC_ASSERT(expression)                                                                     \
  do {                                                                                            \
    if (const auto claim = ::lpc::test::claimOf(::lpc::test::claims << expression); !claim.holds) \
      ::lpc::test::failCase(__FILE__, __LINE__, "RC_ASSERT(" #expression ")", claim.values);      \
  } while (false)
