// SPDX-License-Identifier: Zlib
// An expression of a scene gives a finite number or an error, the same one when repeated, and changes no name.
#include "experiments/parse/expression.h"
#include "tests/fuzz/target.h"

namespace lpc { inline namespace LPC_PRECISION {

void fuzz(std::string_view input) {
  const std::string text(input);
  Expressions names(7);
  names.setGlobal("n", 5), names.setGlobal("lean", 0.25);
  names.setLocal("i", 3), names.setLocal("k", 2);
  for (int again = 0; again < 2; ++again) {
    try {
      names.evaluate(text);
    } catch (const UserError&) {
    }
  }
  demand(names.evaluate("n") == 5 && names.evaluate("i * k") == 6, "an expression has changed a name");
}

}}  // namespace lpc::LPC_PRECISION
