// SPDX-License-Identifier: Zlib
// A program of one engine alone, LPC_BARE, in one precision, LPC_BARE_PRECISION: prints the median processor time of a
// step.
#include <time.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>

#include "experiments/bench/bare_pyramid.h"

namespace {

constexpr int kWarmUpSteps = 10;  // not counted, as in trials: caches are cold and vectors grow

double cpuSeconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

int usage(const char* program) {
  std::printf(
      "usage: %s [--steps N]\n\n"
      "Steps the scene `pyramid` of 210 boxes by the engine's own API, and prints the median time of a step and how "
      "far a\n"
      "box is from where it came. --steps: how many, 600; the first %d are not timed. One pinned thread and a quiet\n"
      "machine are the caller's business.\n"
      "Example: taskset -c 1 build/release/bin/%s --steps 300\n",
      program, kWarmUpSteps, program);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const char* slash = std::strrchr(argv[0], '/');
  const char* program = slash ? slash + 1 : argv[0];
  int steps = 600;
  for (int i = 1; i < argc; i += 2) {
    if (!std::strcmp(argv[i], "--help") || !std::strcmp(argv[i], "-h")) return usage(program);
    if (std::strcmp(argv[i], "--steps") != 0) {
      std::fprintf(stderr, "%s: unknown argument '%s'; valid: --steps, --help\n", program, argv[i]);
      return 2;
    }
    const char* text = i + 1 < argc ? argv[i + 1] : "";
    const char* end = text + std::strlen(text);
    const auto [stop, error] = std::from_chars(text, end, steps);
    if (stop != end || error != std::errc{} || steps <= kWarmUpSteps) {
      std::fprintf(stderr, "%s: --steps needs a number over %d, not '%s'\n", program, kWarmUpSteps, text);
      return 2;
    }
  }
  const auto pyramid = bare::LPC_BARE({});
  const std::vector<bare::Placed> start = pyramid->boxes();
  std::vector<double> seconds;
  for (int i = 0; i < steps; ++i) {
    const double before = cpuSeconds();
    pyramid->step();
    if (i >= kWarmUpSteps) seconds.push_back(cpuSeconds() - before);
  }
  double drift = 0;
  const std::vector<bare::Placed> end = pyramid->boxes();
  for (std::size_t i = 0; i < end.size(); ++i) {
    const double x = end[i][0] - start[i][0], y = end[i][1] - start[i][1], z = end[i][2] - start[i][2];
    drift = std::max(drift, std::sqrt(x * x + y * y + z * z));
  }
  const auto middle = seconds.begin() + static_cast<std::ptrdiff_t>(seconds.size() / 2);
  std::nth_element(seconds.begin(), middle, seconds.end());
  std::printf("precision %s, %d steps, median %.5g ms a step, drift %.5g m\n", LPC_BARE_PRECISION, steps, 1e3 * *middle,
              drift);
}
