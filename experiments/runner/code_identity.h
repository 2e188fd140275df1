// SPDX-License-Identifier: Zlib
// What a result depends on beside its inputs: the code. A key holds the content of the shared code (`core`) and of each
// algorithm that takes part, never the commit: a new algorithm file changes no other key.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "framework/registry.h"

namespace lpc::inline LPC_PRECISION {

/// XXH128 in hexadecimal.
std::string hexHash(std::string_view bytes);
/// Over framework, trial code, compiler and flags, as built into this program.
const std::string& coreHash();
/// Over the oracles, as built into this program: families, referee, verdicts; "not built" without them.
const std::string& oraclesHash();
/// {"velocity/catto": hash, ...} for the algorithm of `spec` (canonical: nested stages are followed) in `dimension`:
/// its own file and its group's kernel headers; for one of a plugin, the plugin's bytes.
nlohmann::json codeHashes(StageKind stage, const Spec& spec, int dimension);
/// Loads the plugin (see loadPlugin) and remembers which algorithms are its.
void adoptPlugin(const std::string& path);
/// JSON: cpu, cores, memory_gib, os, compiler, flags, governor.
std::string machineDescription();

}  // namespace lpc::inline LPC_PRECISION
