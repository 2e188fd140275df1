// SPDX-License-Identifier: Zlib
#pragma once

#include <span>
#include <string>

#include "framework/math/space.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Writes a PNG file of red, green and blue, row by row from the top: whole or not at all (OutputFile). Throws
/// CannotWrite.
void writePng(const std::string& path, int width, int height, std::span<const unsigned char> rgb);

}}  // namespace lpc::LPC_PRECISION
