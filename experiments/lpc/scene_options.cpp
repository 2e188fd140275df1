// SPDX-License-Identifier: Zlib
#include "experiments/lpc/scene_options.h"

#include <charconv>
#include <cmath>

#include "framework/math/check.h"
#include "framework/world/settings.h"
#include "framework/world/stage_engine.h"

namespace lpc { inline namespace LPC_PRECISION {

std::optional<double> finiteNumber(const std::string& text) {
  double value = 0;
  const char* end = text.data() + text.size();
  const auto [read, error] = std::from_chars(text.data(), end, value);
  return error == std::errc() && read == end && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

ParameterValues readParameters(const std::vector<std::string>& texts) {
  ParameterValues out;
  for (const std::string& text : texts) {
    const std::size_t equals = text.find('=');
    const std::string name = text.substr(0, equals), given = equals == text.npos ? "" : text.substr(equals + 1);
    const std::optional<double> value = finiteNumber(given);
    if (given.empty() || (!value && name != kJointParameter)) {
      throw UserError("--param " + text + " is not NAME=NUMBER, or joint=KIND");
    }
    out[name] = value ? ParameterValue(*value) : ParameterValue(given);
  }
  return out;
}

std::string pipelineOf(const std::string& given, int dimension, bool noSleeping) {
  std::string text = given;
  if (text == "2009" || text.starts_with("2009 ")) {
    Pipeline pipeline = Settings::named("2009", dimension).pipeline();
    pipeline.replace(text.substr(4));
    text = pipeline.text();
  }
  if (!noSleeping || engineOf(text)) return text;  // engines never sleep here
  Pipeline pipeline = Pipeline::parse(text);
  pipeline.replace("sleep=none");
  return pipeline.text();
}

}}  // namespace lpc::LPC_PRECISION
