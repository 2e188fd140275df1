// SPDX-License-Identifier: Zlib
#pragma once

#include <string>

#include "framework/math/space.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Throws UserError where results could not be written to the store `path`: it is another file, damaged, of another
/// schema or read-only, or there is no folder to make it in. Makes nothing.
void checkStore(const std::string& path);

}}  // namespace lpc::LPC_PRECISION
