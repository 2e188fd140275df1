// SPDX-License-Identifier: Zlib
#pragma once

#include <string>

#include "framework/math/space.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Writes the film of a recording and describes it in one line. The ending of `out` decides its kind (film_file.h). All
/// functions throw UserError for files that cannot be read or written, and Interrupted on Ctrl-C if an InterruptGuard
/// exists.
std::string filmRecording(const std::string& recording, const std::string& out);

/// Describes a recording in one line.
std::string describeRecording(const std::string& recording);

/// Says in one line at which step two recordings diverge: where a body is farther from its counterpart than `tolerance`
/// (m and rad). If `out` is not empty, films both side by side, the first on the left, from the step before that, and
/// adds a second line.
std::string compareRecordings(const std::string& a, const std::string& b, double tolerance, const std::string& out);

}}  // namespace lpc::LPC_PRECISION
