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
      app.subcommand("replay", "Draws a recording, or two beside one another from the step in which they part");
  auto o = std::make_shared<ReplayOptions>();
  command.option("recording", o->recording, "what lpc run --record wrote").required();
  command.option("--film", o->film,
                 "NAME.svg, which moves; NAME.strip.svg, eight moments; or NAME/, a folder of PNG files");
  Option beside = command.option("--beside", o->beside, "another recording, of the same scene");
  beside.file();
  command
      .option(
          "--tolerance", o->tolerance,
          "with --beside: how far bodies are from their twins where runs part (m and rad). Larger values find the step "
          "in which it is seen")
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
