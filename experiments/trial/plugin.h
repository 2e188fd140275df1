// SPDX-License-Identifier: Zlib
#pragma once

#include <map>
#include <string>
#include <vector>

#include "framework/stage/plugin.h"

namespace lpc { inline namespace LPC_PRECISION {

/// The precision that a plugin was built for ("f64"), read from its bytes without loading it. Throws UserError when the
/// file is no plugin.
std::string pluginPrecision(const std::string& path);

/// Loads the library, so that its algorithms are in the registry. Throws UserError when version, precision or compiler
/// differ from this program's.
void loadPlugin(const std::string& path);

}}  // namespace lpc::LPC_PRECISION
