// SPDX-License-Identifier: Zlib
// The `lpc` program. Exit codes: 0 fine, 1 it ran and something is not right, 2 the user's mistake, one clear line.
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <iostream>
#include <map>

#include "experiments/lpc/command.h"
#include "experiments/runner/code_identity.h"
#include "framework/check.h"
#include "framework/plugin.h"

namespace lpc::inline LPC_PRECISION {
namespace {

std::map<std::string, AddCommand>& commands() {
  static std::map<std::string, AddCommand> all;
  return all;
}

int run(int argc, char** argv) {
  CLI::App app{"Large Polygon Collider: sweeps, verifies and compares rigid-body collision algorithms", "lpc"};
  app.footer(
      "Examples:\n"
      "  lpc list\n"
      "  lpc run pyramid --param base=10 --pipeline \"solver=split_solver{velocity=catto{iterations=20}}\"\n"
      "  lpc sweep broadphase_crossover --store results/mine.db\n"
      "  lpc report results/mine.db\n"
      "  lpc SUBCOMMAND --help");
  app.set_version_flag("--version", std::string("lpc ") + LPC_VERSION_TEXT);
  app.require_subcommand(1);
  app.fallthrough();
  Session session;
  app.add_option("--plugin", session.plugins, "shared library with algorithms of your own (may be repeated)")
      ->type_name("FILE");
  // Once the command line is known and before the subcommand runs.
  app.parse_complete_callback([&] {
    for (const std::string& path : session.plugins) adoptPlugin(path);
  });
  for (const auto& [name, add] : commands()) add(app, session);
  try {
    if (argc > 1 && argv[1][0] != '-' && !commands().count(argv[1])) {
      std::string valid;
      for (const auto& [name, add] : commands()) valid += (valid.empty() ? "" : ", ") + name;
      throw UserError("there is no subcommand '" + std::string(argv[1]) + "'; valid: " + valid);
    }
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) return app.exit(e);  // --help, --version
    std::cerr << "lpc: " << e.what() << " (see lpc --help)\n";
    return 2;
  } catch (const UserError& e) {
    std::cerr << "lpc: " << e.what() << "\n";
    return 2;
  } catch (const std::exception& e) {
    std::cerr << "lpc: " << e.what() << "\n";
    return 1;
  }
  errno = 0;
  std::cout.flush();
  if (std::fflush(stdout) != 0 || std::ferror(stdout) || !std::cout) {
    std::cerr << "lpc: standard output cannot be written" << (errno ? std::string(": ") + std::strerror(errno) : "")
              << "\n";
    return 2;
  }
  return session.exitCode;
}

}  // namespace

CommandRegistrar::CommandRegistrar(const char* name, AddCommand add) { commands()[name] = add; }

}  // namespace lpc::inline LPC_PRECISION

int main(int argc, char** argv) { return lpc::run(argc, argv); }
