// SPDX-License-Identifier: Zlib
#include "framework/world/settings.h"

#include <charconv>

#include "framework/math/names.h"
#include "framework/stage/registry.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

Spec shortest(Real number) {  // the shortest text that reads back as this number
  char text[32];
  return {.name = {text, std::to_chars(text, text + sizeof text, number).ptr}, .fields = {}};
}

// Sets the slop of the solver itself, or of its position resolver.
void setSlop(Spec& solver, Real slop) {
  const auto takes = [](StageKind stage, const std::string& name) {
    return Registry::instance().parameter(stage, name, "slop") != nullptr;
  };
  if (takes(StageKind::solver, solver.name)) return solver.set("slop", shortest(slop));
  if (const ParamInfo* part = Registry::instance().parameter(StageKind::solver, solver.name, "position")) {
    const Spec* given = solver.find("position");
    Spec resolver = given ? *given : Spec::parse(part->defaultText);
    resolver.set("slop", shortest(slop));
    if (takes(StageKind::position, resolver.name)) return solver.set("position", resolver);
  }
  throw UserError("settings: a slop for solver=" + solver.text() +
                  ", which has no slop; valid: a solver or position resolver with the parameter 'slop'");
}

}  // namespace

Settings Settings::lpc2009(int dimension) {
  Settings s;
  s.density = 1, s.restitution = Real(0.4), s.friction = Real(0.5);
  s.gravity = Real(-9.8), s.dt = Real(1) / 60;
  s.restitutionThreshold = Real(0.2);
  s.mixing = {.friction = MixRule::geometricMean, .restitution = MixRule::arithmeticMean};  // A.4
  s.stages = Pipeline::parse("broadphase=region_tree solver=split_solver{velocity=catto,position=split_impulse}");
  if (dimension == 2) s.stages.replace("contacts=rounded_polygon");
  s.sleeping = true;
  return s;
}

Settings Settings::named(std::string_view name, int dimension) {
  if (name == "2009") return lpc2009(dimension);
  throw UserError("unknown settings '" + std::string(name) + "'" + validNames({"2009"}, std::string(name)));
}

template <int D>
WorldSettings<D> Settings::world() const {
  WorldSettings<D> out;
  out.gravity = gravity * Vec<D>::Unit(1);
  out.restitutionThreshold = restitutionThreshold;
  out.model.restitution = useRestitution;
  out.mixing = mixing;
  out.sleepingContacts = sleepingContacts;
  return out;
}

Pipeline Settings::pipeline() const {
  Pipeline out = stages;
  if (!severalContacts) out[StageKind::contacts] = Spec::parse("deepest_point");
  if (!cacheContacts) out[StageKind::cache] = Spec::parse("none");
  if (slop) setSlop(out[StageKind::solver], *slop);
  if (sleeping) {
    Spec& sleep = out[StageKind::sleep];
    sleep = Spec::parse("split_average");
    sleep.set("linear", shortest(linearSleepSpeed));
    sleep.set("angular", shortest(angularSleepSpeed));
    sleep.set("bias", shortest(sleepBias));
  }
  return out;
}

template <int D>
ShapeDef<D> Settings::shape(const Shape<D>& of) const {
  ShapeDef<D> out;
  out.shape = of;
  out.density = density, out.friction = friction, out.restitution = restitution;
  return out;
}

template <int D>
std::optional<ForceDef<D>> Settings::air() const {
  if (!airResistance) return std::nullopt;
  Spec drag{.name = "drag", .fields = {}};
  drag.set("linear", shortest(linearDrag)), drag.set("angular_linear", shortest(linearDrag));
  drag.set("quadratic", shortest(quadraticDrag)), drag.set("angular_quadratic", shortest(quadraticDrag));
  return ForceDef<D>{.kind = drag.text()};
}

template WorldSettings<2> Settings::world() const;
template WorldSettings<3> Settings::world() const;
template ShapeDef<2> Settings::shape(const Shape<2>&) const;
template ShapeDef<3> Settings::shape(const Shape<3>&) const;
template std::optional<ForceDef<2>> Settings::air() const;
template std::optional<ForceDef<3>> Settings::air() const;

}}  // namespace lpc::LPC_PRECISION
