// SPDX-License-Identifier: Zlib
// The code that a result depends on besides its inputs. A key contains hashes of the shared code (`core`) and of each
// participating algorithm, but never the commit: a new algorithm file changes no other key.
#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>

#include "framework/stage/registry.h"

namespace lpc { inline namespace LPC_PRECISION {

/// XXH128 in hexadecimal.
std::string hexHash(std::string_view bytes);
/// Hash of framework, trial code, compiler and flags, as built into this program.
const std::string& coreHash();
/// A source built into this program: its path in the project, and the library (with its version) that it calls.
struct SourceHash {
  std::string_view path, hash, library = {};
};
/// Hash of the judging part of the oracles: families, referee, verdicts, and the code shared by adapters. A file that
/// registers a witness is in the keys of trials of that witness only.
std::string judgesHash(std::span<const SourceHash> sources);
/// Hash of an algorithm's own file and the kernels of its group: all headers, and the .cpp files that register nothing.
std::string methodHash(const Registered& entry, std::span<const SourceHash> sources);
/// Of this program; "not built" without the oracles.
const std::string& oraclesHash();
/// {"velocity/catto": hash, ...} for the algorithm of `spec` (canonical, with nested stages) in `dimension`:
/// methodHash(); for a plugin's algorithm the plugin's bytes; for a witness also "library".
nlohmann::json codeHashes(StageKind stage, const Spec& spec, int dimension);
/// Loads the plugin (see loadPlugin) and remembers its algorithms. Throws UserError also when its initialisers throw,
/// abort, exit or loop, or register a name that exists.
void adoptPlugin(const std::string& path);
bool anyPlugin();  // since the start of the program
bool isOfPlugin(const Registered& entry);
/// JSON: cpu, cores, memory_gib, os, compiler, flags, governor.
std::string machineDescription();

}}  // namespace lpc::LPC_PRECISION
