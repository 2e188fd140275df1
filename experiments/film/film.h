// SPDX-License-Identifier: Zlib
#pragma once

#include <string>

#include "framework/math/space.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Writes the film of a recording and says in one line what is seen of it. `out` names its kind (film_file.h). All
/// throw UserError for what cannot be read or written, and Interrupted where an InterruptGuard lives and Ctrl-C comes.
std::string filmRecording(const std::string& recording, const std::string& out);

/// Says what is in a recording, in one line.
std::string describeRecording(const std::string& recording);

/// Says in one line at which step two recordings part: where a body is farther from its twin than `tolerance` (m and
/// rad). Where `out` is not empty, films both beside one another, the first on the left, from the step before that, and
/// says so in a second line.
std::string compareRecordings(const std::string& a, const std::string& b, double tolerance, const std::string& out);

}}  // namespace lpc::LPC_PRECISION
