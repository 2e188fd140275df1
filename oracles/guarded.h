// SPDX-License-Identifier: Zlib
// Other people's code asked in a child process: on known inputs it throws, aborts on its own assertions, faults or
// never returns, and must take nothing with it but the one answer.
#pragma once

#include <functional>

#include "framework/stage_narrowphase.h"

namespace lpc::inline LPC_PRECISION {

/// A witness takes microseconds; one that takes this long will not come back.
inline constexpr int kWitnessMilliseconds = 300;

/// Fills answers[0 .. count) by ask(i), which runs in a child; it may throw. What it throws on, crashes on, or does not
/// answer within `milliseconds` is QueryStatus::failed, and the next ones go on in a new child.
void askGuarded(int count, int milliseconds, const std::function<PairAnswer<3>(int)>& ask, PairAnswers<3>& answers);

}  // namespace lpc::inline LPC_PRECISION
