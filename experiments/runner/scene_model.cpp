// SPDX-License-Identifier: Zlib
#include "experiments/runner/scene_model.h"

#include <algorithm>
#include <sstream>

#include "framework/math/names.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

std::vector<std::string> listOf(const std::string& features) {
  std::vector<std::string> out;
  std::istringstream in(features);
  for (std::string name; std::getline(in, name, ',');) out.push_back(name);
  return out;
}

std::vector<std::string> allModelFlags() { return listOf(modelText(PhysicsModel{})); }

bool holds(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

}  // namespace

std::vector<std::string> modelNames() {
  std::vector<std::string> out = {kMinimalModel, "all", "2d", "3d"};
  for (const char* sign : {"+", "-"}) {
    for (const std::string& feature : allModelFlags()) out.push_back(sign + feature);
  }
  return out;
}

void applyModel(const SceneFile& file, const std::string& model, WorldCell& cell) {
  if (!holds(modelNames(), model)) throw UserError("unknown model '" + model + "'" + validNames(modelNames(), model));
  std::vector<std::string> features = listOf(modelText(file.model()));
  if (model == "2d" || model == "3d") {
    cell.dimension = model == "2d" ? 2 : 3;
  } else if (model == "all") {
    features = allModelFlags();
  } else if (model[0] == '+' && !holds(features, model.substr(1))) {
    features.push_back(model.substr(1));
  } else if (model[0] == '-') {
    std::erase(features, model.substr(1));
  }
  std::string text;
  for (const std::string& f : features) text += (text.empty() ? "" : ",") + f;
  cell.features = modelText(modelFromText(text));
}

std::vector<std::string> otherModels(const SceneFile& file, int dimension) {
  std::vector<std::string> out;
  if (file.has(5 - dimension)) out.push_back(dimension == 2 ? "3d" : "2d");
  const std::vector<std::string> needed = listOf(modelText(file.model()));
  for (const std::string& feature : allModelFlags()) out.push_back((holds(needed, feature) ? "-" : "+") + feature);
  return out;
}

}}  // namespace lpc::LPC_PRECISION
