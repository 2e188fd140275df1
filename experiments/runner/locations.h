// SPDX-License-Identifier: Zlib
// Finds scenes, sweeps and workers. A name is looked up in experiments/; a path is used as it is.
#pragma once

#include <string>
#include <vector>

#include "framework/math/space.h"

namespace lpc { inline namespace LPC_PRECISION {

/// The directory that contains experiments/: $LPC_HOME, or the source directory of the build.
std::string homeDirectory();
/// All *.toml of experiments/<folder>, sorted by name.
std::vector<std::string> listToml(const std::string& folder);
/// Charts that a sweep can name in `report`, from the files of reports/charts, sorted by name.
std::vector<std::string> chartsOfSweeps();
/// A path that exists, or experiments/<folder>/NAME.toml. A number is a name, too, as on the command line of the 2009
/// sandbox: 5 is the scene preset_5, 1 the script director_1. Throws UserError with the valid names.
std::string findToml(const std::string& folder, const std::string& nameOrPath);
/// A path that exists, or experiments/problems/*.json. Throws UserError with the valid names.
std::string findProblems(const std::string& nameOrPath);
/// lpc-worker-<precision> beside this program, or lpc-engine-worker-<precision>, which has engines and no witnesses.
/// Throws UserError if it was not built.
std::string workerPath(const std::string& precision, bool engine = false);
/// The commit of the sources, with "+" if they were changed; empty if unknown.
std::string commitOfSources();

}}  // namespace lpc::LPC_PRECISION
