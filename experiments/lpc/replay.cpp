// SPDX-License-Identifier: Zlib
#include <cstdio>
#include <memory>
#include <optional>

#include "experiments/film/film.h"
#include "experiments/lpc/command.h"
#include "experiments/runner/worker_pool.h"
#include "experiments/trial/formats/output_file.h"

namespace lpc { inline namespace LPC_PRECISION { namespace {

struct ReplayOptions {
  std::string recording, film, beside;
  double tolerance = 1e-6;
};

void replay(const ReplayOptions& o) {
  keepApart({{"the recording", o.recording}, {"the recording", o.beside}}, {{"--film", o.film}});
  std::optional<InterruptGuard> interrupts;  // an interrupted film leaves nothing half-written
  if (!o.film.empty()) interrupts.emplace();
  if (!o.beside.empty()) {
    std::printf("%s\n", compareRecordings(o.recording, o.beside, o.tolerance, o.film).c_str());
    return;
  }
  std::string text = describeRecording(o.recording);
  if (!o.film.empty()) text += "\n" + filmRecording(o.recording, o.film);
  std::printf("%s\n", text.c_str());
}

void addReplay(CommandLine& app, Session&) {
  CommandLine command =
      app.subcommand("replay", "Draws a recording, or two side by side from the step in which they diverge");
  auto o = std::make_shared<ReplayOptions>();
  command.option("recording", o->recording, "file written by lpc run --record").required();
  command.option("--film", o->film,
                 "NAME.svg (animated), NAME.strip.svg (eight moments) or NAME/ (folder of PNG files)");
  Option beside = command.option("--beside", o->beside, "second recording of the same scene");
  beside.file();
  command
      .option("--tolerance", o->tolerance,
              "with --beside: distance between equal bodies at which the runs count as diverged (m and rad); larger "
              "values find a visible difference")
      .showDefault()
      .range(0.0, 1e9)
      .with(beside);
  command.footer(
      "Example: lpc replay pyramid.rec --film pyramid.svg\n"
      "         lpc replay catto.rec --beside soft_step.rec --tolerance 0.01 --film both.strip.svg");
  command.callback([o] { replay(*o); });
}

LPC_COMMAND("replay", addReplay);

}  // namespace
}}  // namespace lpc::LPC_PRECISION
