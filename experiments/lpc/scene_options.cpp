// SPDX-License-Identifier: Zlib
#include "experiments/lpc/scene_options.h"

#include <cstdlib>

#include "framework/check.h"

namespace lpc::inline LPC_PRECISION {

ParameterValues readParameters(const std::vector<std::string>& texts) {
  ParameterValues out;
  for (const std::string& text : texts) {
    const std::size_t equals = text.find('=');
    const std::string name = text.substr(0, equals);
    char* end = nullptr;
    const char* given = equals == std::string::npos ? "" : text.c_str() + equals + 1;
    const double value = std::strtod(given, &end);
    if (!*given || (*end && name != kJointParameter)) {
      throw UserError("--param " + text + " is not NAME=NUMBER, or joint=KIND");
    }
    out[name] = *end ? ParameterValue(std::string(given)) : ParameterValue(value);
  }
  return out;
}

}  // namespace lpc::inline LPC_PRECISION
