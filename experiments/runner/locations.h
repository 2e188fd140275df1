// SPDX-License-Identifier: Zlib
// Where things are: scenes, sweeps, workers. A name is looked up in experiments/, a path is taken as it is.
#pragma once

#include <string>
#include <vector>

#include "framework/math/space.h"

namespace lpc { inline namespace LPC_PRECISION {

/// The directory with experiments/ in it: $LPC_HOME, or where the program was built.
std::string homeDirectory();
/// All *.toml of experiments/<folder>, sorted by name.
std::vector<std::string> listToml(const std::string& folder);
/// Charts that a sweep can name in `report`, by the files of reports/charts, sorted by name.
std::vector<std::string> chartsOfSweeps();
/// A path that exists, or experiments/<folder>/NAME.toml. A number is a name, too, as on the 2009 sandbox's command
/// line: 5 is the scene preset_5, 1 the script director_1. Throws UserError with the valid names.
std::string findToml(const std::string& folder, const std::string& nameOrPath);
/// A path that exists, or experiments/problems/*.json. Throws UserError with the valid names.
std::string findProblems(const std::string& nameOrPath);
/// lpc-worker-<precision> beside this program, or lpc-engine-worker-<precision>, which has engines and no witnesses.
/// Throws UserError when it was not built.
std::string workerPath(const std::string& precision, bool engine = false);
/// The commit of the sources, with "+" when they were changed; empty when unknown.
std::string commitOfSources();

}}  // namespace lpc::LPC_PRECISION
