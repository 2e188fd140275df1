// SPDX-License-Identifier: Zlib
// The features that scenes need, by name.
#include "experiments/trial/scene_parsed.h"
#include "framework/names.h"

namespace lpc::inline LPC_PRECISION {
namespace {

struct FeatureName {
  const char* name;
  bool Features::*flag;
};
constexpr FeatureName kFeatures[] = {{"cache", &Features::cache},       {"friction", &Features::friction},
                                     {"joints", &Features::joints},     {"restitution", &Features::restitution},
                                     {"rotation", &Features::rotation}, {"sleeping", &Features::sleeping}};
constexpr Features kNothing{false, false, false, false, false, false};

}  // namespace

void setFeature(Features& features, const std::string& name) {
  for (const FeatureName& f : kFeatures) {
    if (name == f.name) {
      features.*(f.flag) = true;
      return;
    }
  }
  std::vector<std::string> names;
  for (const FeatureName& f : kFeatures) names.push_back(f.name);
  throw UserError("unknown feature '" + name + "'" + validNames(names, name));
}

std::string featuresText(const Features& features) {
  std::string out;
  for (const FeatureName& f : kFeatures) {
    if (features.*(f.flag)) out += (out.empty() ? "" : ",") + std::string(f.name);
  }
  return out;
}

Features featuresFromText(std::string_view text) {
  Features out = kNothing;
  while (!text.empty()) {
    const std::size_t comma = text.find(',');
    setFeature(out, std::string(text.substr(0, comma)));
    text = comma == std::string_view::npos ? "" : text.substr(comma + 1);
  }
  return out;
}

}  // namespace lpc::inline LPC_PRECISION
