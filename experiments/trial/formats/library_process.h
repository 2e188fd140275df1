// SPDX-License-Identifier: Zlib
// Isolates external libraries that read files: FCLIB on HDF5, assimp. They print messages, trust sizes in the file, and
// abort on damaged files. Each call therefore runs in a process of its own.
#pragma once

#include <functional>
#include <string>

#include "framework/math/space.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Returns what `work` returns, run in a child process. Throws UserError with the path and what `work` threw, or that
/// the library crashed or took longer than any file needs.
std::string inItsProcess(const std::string& library, const std::string& path, const std::function<std::string()>& work);

}}  // namespace lpc::LPC_PRECISION
