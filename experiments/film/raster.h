// SPDX-License-Identifier: Zlib
#pragma once

#include <string>

#include "experiments/film/picture.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Writes the picture as a PNG file, without its labels. Throws CannotWrite.
void writePng(const std::string& path, const Picture& picture);

}}  // namespace lpc::LPC_PRECISION
