// SPDX-License-Identifier: Zlib
#pragma once

#include <string>

#include "framework/math/space.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Throws UserError if results could not be written to the store `path`: it is another kind of file, damaged, of
/// another schema or read-only, or its folder does not exist. Creates nothing.
void checkStore(const std::string& path);

}}  // namespace lpc::LPC_PRECISION
