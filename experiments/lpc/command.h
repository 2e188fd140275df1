// SPDX-License-Identifier: Zlib
// Subcommands of `lpc`: one file each, which registers itself at its foot. main.cpp knows none of them.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "framework/space.h"

namespace lpc::inline LPC_PRECISION {

/// What all subcommands share.
struct Session {
  std::vector<std::string> plugins;  // --plugin, loaded before any subcommand runs
  int exitCode = 0;                  // 1: it ran, and found something wrong
};

/// Adds the subcommand to `app`. Its callback throws UserError for what the user got wrong (exit code 2).
using AddCommand = void (*)(CLI::App& app, Session& session);

struct CommandRegistrar {
  CommandRegistrar(const char* name, AddCommand add);
};

#define LPC_COMMAND(name, add) static const ::lpc::CommandRegistrar commandRegistrar(name, add)

}  // namespace lpc::inline LPC_PRECISION
