// SPDX-License-Identifier: Zlib
// What a result depends on beside its inputs: the code. A key holds the content of the shared code (`core`) and of each
// algorithm that takes part, never the commit: a new algorithm file changes no other key.
#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>

#include "framework/stage/registry.h"

namespace lpc { inline namespace LPC_PRECISION {

/// XXH128 in hexadecimal.
std::string hexHash(std::string_view bytes);
/// Over framework, trial code, compiler and flags, as built into this program.
const std::string& coreHash();
/// A source as built into this program: its path in the project, and the library (with its version) that it calls.
struct SourceHash {
  std::string_view path, hash, library = {};
};
/// Over those of the oracles that judge: families, referee, verdicts, what adapters share. A file from which a witness
/// is registered is in the keys of trials that name the witness, and in no other.
std::string judgesHash(std::span<const SourceHash> sources);
/// Over an algorithm's own file and the kernels of its group: all headers, and the .cpp files that register nothing.
std::string methodHash(const Registered& entry, std::span<const SourceHash> sources);
/// Of this program; "not built" without the oracles.
const std::string& oraclesHash();
/// {"velocity/catto": hash, ...} for the algorithm of `spec` (canonical: nested stages are followed) in `dimension`:
/// methodHash(); for one of a plugin, the plugin's bytes; for a witness "library", too.
nlohmann::json codeHashes(StageKind stage, const Spec& spec, int dimension);
/// Loads the plugin (see loadPlugin) and remembers which algorithms are its.
void adoptPlugin(const std::string& path);
/// JSON: cpu, cores, memory_gib, os, compiler, flags, governor.
std::string machineDescription();

}}  // namespace lpc::LPC_PRECISION
