// SPDX-License-Identifier: Zlib
// The groups of benchmarks of lpc-bench, generated from the registry at run time. Names are
// stage/dimension/algorithm/input/...; every benchmark reports work per operation and whether its answers were right.
#pragma once

#include <benchmark/benchmark.h>

#include <string>
#include <vector>

#include "framework/math/work.h"
#include "framework/stage/registry.h"

namespace lpc { inline namespace LPC_PRECISION { namespace bench {

void addBroadphases();
void addPairQueries();
void addContactGenerators();
void addManifolds();
void addStreams();
void addSolvers();

/// The default, and each other value of each choice: the modes of an algorithm compete, too.
std::vector<std::string> specsOf(const Registered& algorithm);

/// Counters of work, per operation.
void report(benchmark::State& state, const WorkDone& work, double operations);

}}}  // namespace lpc::LPC_PRECISION::bench
