// SPDX-License-Identifier: Zlib
// The pinned histories, with the compiler and options of this build.
#include <cstdio>
#include <fstream>
#include <iostream>

#include "tests/determinism/pinned.h"
#include "tests/determinism/trace.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace {

constexpr const char* kUsage =
    "usage: determinism                  prints the hash of each scene\n"
    "       determinism --pinned FILE    compares them with those in FILE\n"
    "       determinism --trace FILE     writes every number of every step\n"
    "       determinism --compare FILE   runs against a trace and tells the first difference of each scene\n";

int comparePinned(const std::string& path) {
  const std::vector<std::string> pinned = pinnedLines(path), here = hashLines();
  int differ = pinned.size() != here.size();
  for (std::size_t i = 0; i < here.size(); ++i) {
    if (i < pinned.size() && pinned[i] == here[i]) continue;
    std::printf("here %s, pinned %s\n", here[i].c_str(), i < pinned.size() ? pinned[i].c_str() : "nothing");
    ++differ;
  }
  return differ > 0;
}

template <int D>
void traceAll(std::ostream& out) {
  for (const auto& scene : pinnedScenes<D>()) writeTrace(scene, out);
}

template <int D>
int compareAll(const std::string& path) {
  int differ = 0;
  for (const auto& scene : pinnedScenes<D>()) {
    std::ifstream in(path);
    if (const auto d = firstDifference(scene, in)) std::fputs(d->text.c_str(), stdout), ++differ;
  }
  return differ;
}

int run(const std::vector<std::string>& arguments) {
  if (arguments.empty()) {
    for (const std::string& line : hashLines()) std::puts(line.c_str());
    return 0;
  }
  if (arguments.size() == 2 && arguments[0] == "--pinned") return comparePinned(arguments[1]);
  if (arguments.size() == 2 && arguments[0] == "--trace") {
    std::ofstream out(arguments[1]);
    traceAll<2>(out), traceAll<3>(out);
    if (!out.flush()) throw UserError(arguments[1] + ": cannot be written");
    return 0;
  }
  if (arguments.size() == 2 && arguments[0] == "--compare") {
    return compareAll<2>(arguments[1]) + compareAll<3>(arguments[1]) > 0;
  }
  std::fputs(kUsage, stderr);
  return 2;
}

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::test

int main(int argc, char** argv) {
  try {
    return lpc::test::run({argv + 1, argv + argc});
  } catch (const lpc::UserError& e) {
    std::cerr << "determinism: " << e.what() << '\n';
    return 2;
  }
}
