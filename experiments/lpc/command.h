// SPDX-License-Identifier: Zlib
// Subcommands of `lpc`: one file each, which registers itself at its foot. main.cpp knows none of them.
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

/// The command line, in front of CLI11: main.cpp alone compiles it.
class Option {
 public:
  explicit Option(CLI::Option* option) : m_option(option) {}
  Option& required();
  /// In the help, what it is when nothing is said.
  Option& showDefault();
  Option& commaSeparated();
  /// FILE in the help.
  Option& file();
  /// May stand alone; then `given` tells that it does.
  Option& valueOptional();
  Option& range(long lo, long hi);
  Option& range(double lo, double hi);
  /// Stands only beside, or never beside, the other: what an option would not do is not given in vain.
  Option& with(const Option& other);
  Option& without(const Option& other);
  /// Once the command line is known.
  bool given() const;

 private:
  CLI::Option* m_option;
};

class CommandLine {
 public:
  explicit CommandLine(CLI::App* app) : m_app(app) {}
  CommandLine subcommand(const char* name, const char* summary);
  /// "--name", or a name without dashes for what stands at a place. `value` outlives the command line; its types are
  /// listed in main.cpp.
  template <class T>
  Option option(const char* name, T& value, const char* meaning);
  Option flag(const char* name, bool& value, const char* meaning);
  void footer(const char* text);
  /// Run when this subcommand was given.
  void callback(std::function<void()> body);

 private:
  CLI::App* m_app;
};

/// What all subcommands share.
struct Session {
  std::vector<std::string> plugins;  // --plugin, loaded before any subcommand runs
  int exitCode = 0;                  // 1: it ran, and found something wrong
};

/// Before what a store keeps of a command: without its plugins it would mean something else.
inline void addPlugins(std::vector<std::string>& command, const Session& session) {
  for (auto it = session.plugins.rbegin(); it != session.plugins.rend(); ++it) {
    command.insert(command.begin(), {"--plugin", *it});
  }
}

/// Adds the subcommand to `app`. Its callback throws UserError for what the user got wrong (exit code 2).
using AddCommand = void (*)(CommandLine& app, Session& session);

struct CommandRegistrar {
  CommandRegistrar(const char* name, AddCommand add);
};

#define LPC_COMMAND(name, add) static const ::lpc::CommandRegistrar add##Registrar(name, add)

}}  // namespace lpc::LPC_PRECISION
