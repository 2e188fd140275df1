// SPDX-License-Identifier: Zlib
// Subcommands of `lpc`: one file each, which registers itself at its end. main.cpp knows none of them.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "framework/math/space.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace lpc { inline namespace LPC_PRECISION {

/// A wrapper around CLI11, which only main.cpp compiles.
class Option {
 public:
  explicit Option(CLI::Option* option) : m_option(option) {}
  Option& required();
  /// Shows the default in the help.
  Option& showDefault();
  Option& commaSeparated();
  /// Shows FILE in the help.
  Option& file();
  /// Makes the value optional; `given` tells whether the option was used.
  Option& valueOptional();
  Option& range(long lo, long hi);
  Option& range(double lo, double hi);
  /// Requires, or excludes, another option, so that no option is ignored silently.
  Option& with(const Option& other);
  Option& without(const Option& other);
  /// Valid once the command line is parsed.
  bool given() const;

 private:
  CLI::Option* m_option;
};

class CommandLine {
 public:
  explicit CommandLine(CLI::App* app) : m_app(app) {}
  CommandLine subcommand(const char* name, const char* summary);
  /// "--name", or a name without dashes for a positional argument. `value` must outlive the command line; its types are
  /// listed in main.cpp.
  template <class T>
  Option option(const char* name, T& value, const char* meaning);
  Option flag(const char* name, bool& value, const char* meaning);
  void footer(const char* text);
  /// Runs if this subcommand was given.
  void callback(std::function<void()> body);

 private:
  CLI::App* m_app;
};

/// State shared by all subcommands.
struct Session {
  std::vector<std::string> plugins;  // --plugin, loaded before any subcommand runs
  int exitCode = 0;                  // 1: it ran, and found an error
};

/// Adds the plugins to a command that a store keeps; without them the command would mean something else.
inline void addPlugins(std::vector<std::string>& command, const Session& session) {
  for (auto it = session.plugins.rbegin(); it != session.plugins.rend(); ++it) {
    command.insert(command.begin(), {"--plugin", *it});
  }
}

/// Adds the subcommand to `app`. Its callback throws UserError for mistakes of the user (exit code 2).
using AddCommand = void (*)(CommandLine& app, Session& session);

struct CommandRegistrar {
  CommandRegistrar(const char* name, AddCommand add);
};

#define LPC_COMMAND(name, add) static const ::lpc::CommandRegistrar add##Registrar(name, add)

}}  // namespace lpc::LPC_PRECISION
