// SPDX-License-Identifier: Zlib
// The `lpc` program. Exit codes: 0 success, 1 it ran and something is wrong, 2 mistake of the user, reported in one
// line.
#include <fcntl.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <type_traits>
#include <utility>

#include "experiments/lpc/command.h"
#include "experiments/lpc/scene_options.h"
#include "experiments/runner/code_identity.h"
#include "experiments/runner/worker_pool.h"
#include "framework/math/check.h"
#include "framework/math/names.h"
#include "framework/stage/plugin.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

std::map<std::string, AddCommand>& commands() {
  static std::map<std::string, AddCommand> all;
  return all;
}

// Like CLI::Range, which accepts NaN.
template <class T>
CLI::Validator within(T lo, T hi) {
  std::ostringstream range;
  range << lo << " to " << hi;
  const auto check = [lo, hi, valid = range.str()](std::string& text) {
    T value{};
    const bool fits = CLI::detail::lexical_cast(text, value) && lo <= value && value <= hi;
    return fits ? std::string() : "'" + text + "' is not in range; valid: " + valid;
  };
  return CLI::Validator(check, "in [" + range.str() + "]");
}

// The number type of a value or of its elements; void: text.
template <class T>
struct NumberIn : std::conditional<std::is_arithmetic_v<T>, T, void> {};
template <class T>
struct NumberIn<std::optional<T>> : NumberIn<T> {};
template <class T>
struct NumberIn<std::vector<T>> : NumberIn<T> {};

// CLI11 accepts nan, hexadecimal numbers, 010 as 8, blanks and empty text, and clamps numbers that are too large.
template <class T>
CLI::Validator wholeNumberOnly() {
  using Read = std::conditional_t<std::is_signed_v<T>, T, long>;
  return CLI::Validator(
      [](std::string& text) {
        Read value = 0;
        const char* end = text.data() + text.size();
        const auto [read, error] = std::from_chars(text.data(), end, value);
        const Read least = std::is_signed_v<T> ? std::numeric_limits<Read>::min() : 0;
        if (error != std::errc() || read != end || value < least) {
          return "'" + text + "' is not a valid integer; valid: " + std::to_string(least) + " to " +
                 std::to_string(std::numeric_limits<Read>::max());
        }
        text = std::to_string(value);
        return std::string();
      },
      "");
}
CLI::Validator finiteNumberOnly() {
  const auto check = [](std::string& text) {
    return finiteNumber(text)
               ? std::string()
               : "'" + text + "' is not a finite number in double precision; valid: such as 0.5 or 1e-3; 0, or " +
                     "a magnitude from 2.3e-308 to 1.7e308";
  };
  return CLI::Validator(check, "");
}

// Names and texts go into stores and requests, which are UTF-8.
void requireUtf8(const char* argument) {
  try {
    static_cast<void>(nlohmann::json(argument).dump());
  } catch (const nlohmann::json::type_error&) {
    throw UserError("the argument '" + oneLine(argument) + "' is not UTF-8; valid: UTF-8 text");
  }
}

// Opens closed standard streams. Otherwise the next opened file or socket would get their number, and be overwritten,
// or lost by a worker as its input. Reading such a stream fails, and writing reports an error.
void takeStandardStreams() {
  for (const int stream : {0, 1, 2}) {
    if (fcntl(stream, F_GETFD) < 0) open("/dev/null", stream == 1 ? O_RDONLY : O_WRONLY);
  }
}

int run(int argc, char** argv) {
  takeStandardStreams();
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
  app.add_option("--plugin", session.plugins, "shared library with your own algorithms (may be repeated)")
      ->type_name("FILE");
  // Once the command line is parsed and before the subcommand runs.
  app.parse_complete_callback([&] {
    for (const std::string& path : session.plugins) adoptPlugin(path);
  });
  CommandLine line(&app);
  for (const auto& [name, add] : commands()) add(line, session);
  try {
    std::for_each(argv, argv + argc, requireUtf8);
    if (argc > 1 && argv[1][0] != '-' && !commands().count(argv[1])) {
      std::vector<std::string> names;
      for (const auto& [name, add] : commands()) names.push_back(name);
      throw UserError("unknown subcommand '" + std::string(argv[1]) + "'" + validNames(names, argv[1]));
    }
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() != 0) {
      std::cerr << "lpc: " << oneLine(e.what()) << " (see lpc --help)\n";
      return 2;
    }
    app.exit(e);  // --help, --version
  } catch (const UserError& e) {
    std::cerr << "lpc: " << oneLine(e.what()) << "\n";
    return 2;
  } catch (const Interrupted& e) {
    std::cerr << "lpc: " << oneLine(e.what()) << "\n";
    return 130;
  } catch (const std::filesystem::filesystem_error& e) {
    const std::string place = e.path1().empty() ? "the working directory" : e.path1().string();
    std::cerr << "lpc: " << oneLine(place + ": " + e.code().message()) << "\n";
    return 2;
  } catch (const std::exception& e) {
    const auto* ofJson = dynamic_cast<const nlohmann::json::type_error*>(&e);
    const bool notUtf8 = ofJson && ofJson->id == 316;  // the working directory's name, TMPDIR
    std::cerr << "lpc: " << (notUtf8 ? "a name or text is not UTF-8: " : "") << oneLine(e.what()) << "\n";
    return notUtf8 ? 2 : 1;
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

Option& Option::required() {
  m_option->required();
  return *this;
}
Option& Option::showDefault() {
  m_option->capture_default_str();
  return *this;
}
Option& Option::commaSeparated() {
  m_option->delimiter(',');
  return *this;
}
Option& Option::file() {
  m_option->type_name("FILE");
  return *this;
}
Option& Option::valueOptional() {
  m_option->expected(0, 1);
  return *this;
}
Option& Option::range(long lo, long hi) {
  m_option->check(within<long>(lo, hi));
  return *this;
}
Option& Option::range(double lo, double hi) {
  m_option->check(within<double>(lo, hi));
  return *this;
}
Option& Option::with(const Option& other) {
  m_option->needs(other.m_option);
  return *this;
}
Option& Option::without(const Option& other) {
  m_option->excludes(other.m_option);
  return *this;
}
bool Option::given() const { return m_option->count() > 0; }

CommandLine CommandLine::subcommand(const char* name, const char* summary) {
  return CommandLine(m_app->add_subcommand(name, summary));
}
template <class T>
Option CommandLine::option(const char* name, T& value, const char* meaning) {
  CLI::Option* option = m_app->add_option(name, value, meaning);
  using Number = typename NumberIn<T>::type;
  if constexpr (std::is_integral_v<Number>) option->transform(wholeNumberOnly<Number>());
  if constexpr (std::is_floating_point_v<Number>) option->transform(finiteNumberOnly());
  return Option(option);
}
Option CommandLine::flag(const char* name, bool& value, const char* meaning) {
  return Option(m_app->add_flag(name, value, meaning));
}
void CommandLine::footer(const char* text) { m_app->footer(text); }
void CommandLine::callback(std::function<void()> body) { m_app->callback(std::move(body)); }

template Option CommandLine::option(const char*, int&, const char*);
template Option CommandLine::option(const char*, long&, const char*);
template Option CommandLine::option(const char*, double&, const char*);
template Option CommandLine::option(const char*, std::uint64_t&, const char*);
template Option CommandLine::option(const char*, std::string&, const char*);
template Option CommandLine::option(const char*, std::vector<int>&, const char*);
template Option CommandLine::option(const char*, std::vector<std::string>&, const char*);
template Option CommandLine::option(const char*, std::optional<int>&, const char*);
template Option CommandLine::option(const char*, std::optional<double>&, const char*);
template Option CommandLine::option(const char*, std::optional<long>&, const char*);
template Option CommandLine::option(const char*, std::optional<std::uint64_t>&, const char*);

}}  // namespace lpc::LPC_PRECISION

int main(int argc, char** argv) { return lpc::run(argc, argv); }
