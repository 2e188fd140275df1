// SPDX-License-Identifier: Zlib
// Libraries of other people's that read files: FCLIB on HDF5, assimp. They print what they please, trust the sizes that
// a file names, and end the process that meets a damaged one. So each call has a process that does nothing else.
#pragma once

#include <functional>
#include <string>

#include "framework/math/space.h"

namespace lpc { inline namespace LPC_PRECISION {

/// What `work` returns, from a process of its own. Throws UserError with the path and what `work` threw, or that the
/// library has failed: it crashed, or took longer than any file needs.
std::string inItsProcess(const std::string& library, const std::string& path, const std::function<std::string()>& work);

}}  // namespace lpc::LPC_PRECISION
