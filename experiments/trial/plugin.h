// SPDX-License-Identifier: Zlib
#pragma once

#include <map>
#include <string>
#include <vector>

#include "framework/stage/plugin.h"

namespace lpc { inline namespace LPC_PRECISION {

/// The precision of a plugin ("f64"), read from its bytes without loading it. Throws UserError if the file is not a
/// plugin.
std::string pluginPrecision(const std::string& path);

/// Loads the library, which registers its algorithms. Throws UserError if version, precision or compiler differ from
/// this program's.
void loadPlugin(const std::string& path);

}}  // namespace lpc::LPC_PRECISION
