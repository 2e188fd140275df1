// SPDX-License-Identifier: Zlib
#include "oracles/verify.h"

#include <iostream>
#include <memory>

#include "experiments/lpc/command.h"
#include "framework/check.h"
#include "oracles/cases.h"

namespace lpc::inline LPC_PRECISION {
namespace {

struct Arguments {
  VerifyOptions options;
  std::vector<int> dimensions;
  std::string cases;
};

void addVerify(CLI::App& app, Session& session) {
  auto* command = app.add_subcommand(
      "verify", "Every pair query and witness on seeded pairs of shapes (or on a file of cases) before the referee");
  auto arguments = std::make_shared<Arguments>();
  command->add_option("--dimension", arguments->dimensions, "2, 3 or both (default)")->delimiter(',');
  command->add_option("--pairs", arguments->options.pairs, "pairs per two kinds of shape")
      ->capture_default_str()
      ->check(CLI::Range(1, 10000000));
  command->add_option("--seed", arguments->options.seed, "of the pairs")->capture_default_str();
  command->add_option("--scale", arguments->options.scale, "size of the shapes (m)")
      ->capture_default_str()
      ->check(CLI::Range(1e-6, 1e6));
  command->add_option("--methods", arguments->options.methods,
                      "pair queries with parameters, separated by spaces; default: all");
  command->add_option("--cases", arguments->cases, "a file of cases instead of seeded pairs")->type_name("FILE");
  command->footer(
      "Exit code 1 when one of our own methods is wrong; witnesses are only recorded.\n"
      "Examples:\n"
      "  lpc verify --pairs 1000 --seed 7\n"
      "  lpc verify --dimension 3 --methods sat gjk_epa{iterations=20} fcl_libccd\n"
      "  lpc verify --cases tests/regressions/hard_cases.json");
  command->callback([arguments, &session] {
    if (!arguments->cases.empty()) {
      session.exitCode = verifyCases(arguments->cases, std::cout);
      return;
    }
    std::vector<int> dimensions = arguments->dimensions;
    if (dimensions.empty()) dimensions = {2, 3};
    int faults = 0;
    for (const int d : dimensions) {
      arguments->options.dimension = d;
      const std::vector<VerifyRow> rows = verifyPairs(arguments->options);
      std::cout << d << "D, " << arguments->options.pairs << " pairs per two kinds, seed " << arguments->options.seed
                << ", tolerance " << verifyTolerance() << " of the pair's size\n";
      faults += printVerification(rows, std::cout);
      std::cout << "\n";
    }
    std::cout << (faults ? "WRONG: " + std::to_string(faults) + " rows of our own methods"
                         : std::string("our own methods: all right"))
              << "\n";
    session.exitCode = faults ? 1 : 0;
  });
}

LPC_COMMAND("verify", addVerify);

}  // namespace
}  // namespace lpc::inline LPC_PRECISION
