// SPDX-License-Identifier: Zlib
// Names of the model features that scenes need, and counts of their bodies.
#include "experiments/trial/formats/body_type_name.h"
#include "experiments/trial/scene/scene_parsed.h"
#include "framework/math/names.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

struct ModelFlag {
  const char* name;
  bool PhysicsModel::*flag;
};
constexpr ModelFlag kModelFlags[] = {{"cache", &PhysicsModel::cache},
                                     {"continuous", &PhysicsModel::continuous},
                                     {"friction", &PhysicsModel::friction},
                                     {"joints", &PhysicsModel::joints},
                                     {"restitution", &PhysicsModel::restitution},
                                     {"rotation", &PhysicsModel::rotation},
                                     {"sleeping", &PhysicsModel::sleeping}};
constexpr PhysicsModel kNothing{false, false, false, false, false, false, false};

}  // namespace

void setModelFlag(PhysicsModel& model, const std::string& name) {
  for (const ModelFlag& f : kModelFlags) {
    if (name == f.name) {
      model.*(f.flag) = true;
      return;
    }
  }
  std::vector<std::string> names;
  for (const ModelFlag& f : kModelFlags) names.push_back(f.name);
  throw UserError("unknown part of the model '" + name + "'" + validNames(names, name));
}

std::string modelText(const PhysicsModel& model) {
  std::string out;
  for (const ModelFlag& f : kModelFlags) {
    if (model.*(f.flag)) out += (out.empty() ? "" : ",") + std::string(f.name);
  }
  return out;
}

PhysicsModel modelFromText(std::string_view text) {
  PhysicsModel out = kNothing;
  while (!text.empty()) {
    const std::size_t comma = text.find(',');
    setModelFlag(out, std::string(text.substr(0, comma)));
    text = comma == std::string_view::npos ? "" : text.substr(comma + 1);
  }
  return out;
}

template <int D>
std::map<std::string, int> census(const SceneSpec<D>& scene) {
  std::map<std::string, int> out;
  for (const auto& spawn : scene.spawns) {
    if (spawn.part) continue;  // of a body that is counted already
    const BodyDef<D>& b = spawn.body;
    const std::string type = bodyTypeName(b.type);
    ++out[type];
    if (b.pinned) ++out["pinned"];
    if (!b.rotatable) ++out["non-rotatable"];
    if (spawn.step > 0) ++out["scripted"];
    if (spawn.removeAt >= 0) ++out["removed"];
    for (const ShapeDef<D>& s : b.shapes) {
      const std::string composite = s.shape.surface() ? (D == 2 ? "chain" : "mesh") : "compound";
      ++out[type + " " + (s.shape.convex() ? std::string(shapeKindName(s.shape.kind())) : composite)];
    }
  }
  if (!scene.events.empty()) out["event"] = static_cast<int>(scene.events.size());
  for (const auto& joint : scene.joints) ++out[Spec::parse(joint.def.kind).name];
  for (const auto& force : scene.forces) ++out["force " + Spec::parse(force.def.kind).name];
  return out;
}

template std::map<std::string, int> census(const SceneSpec<2>&);
template std::map<std::string, int> census(const SceneSpec<3>&);

}}  // namespace lpc::LPC_PRECISION
