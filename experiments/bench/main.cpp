// SPDX-License-Identifier: Zlib
#include "experiments/bench/bench_groups.h"

namespace lpc { inline namespace LPC_PRECISION { namespace bench {

std::vector<std::string> specsOf(const Registered& algorithm) {
  std::vector<std::string> specs = {algorithm.info.name};
  for (const ParamInfo& p : algorithm.params) {
    if (p.type != "choice") continue;
    for (const std::string& choice : p.choices) {
      if (choice != p.defaultText) specs.push_back(algorithm.info.name + "{" + p.name + "=" + choice + "}");
    }
  }
  return specs;
}

void report(benchmark::State& state, const WorkDone& work, double operations) {
  for (std::size_t k = 0; k < work.counts.size(); ++k) {
    if (work.counts[k] == 0) continue;
    state.counters[std::string(kCountNames[k])] = static_cast<double>(work.counts[k]) / operations;
  }
}

}}}  // namespace lpc::LPC_PRECISION::bench

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  lpc::bench::addBroadphases();
  lpc::bench::addPairQueries();
  lpc::bench::addContactGenerators();
  lpc::bench::addManifolds();
  lpc::bench::addStreams();
  lpc::bench::addSolvers();
  benchmark::RunSpecifiedBenchmarks();
}
