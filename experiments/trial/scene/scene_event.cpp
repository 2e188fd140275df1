// SPDX-License-Identifier: Zlib
// Script actions between steps: one entry per kind of [[event]], with its fields, its checks and its action.
#include "experiments/trial/scene/scene_event.h"

#include <optional>
#include <utility>

#include "experiments/trial/scene/scene_names.h"
#include "framework/scene/director.h"
#include "framework/world/stage_engine.h"
#include "framework/world/world.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

template <int D, class Act>
typename SceneSpec<D>::Event& addEvent(const EventBlock<D>& e, int body, Act act) {
  return e.scene.events.emplace_back(
      typename SceneSpec<D>::Event{e.step, body, std::move(act), e.number, e.place, false});
}
// act(world, handle of the body)
template <int D, class Act>
void addAction(const EventBlock<D>& e, int body, Act act) {
  addEvent<D>(e, body, [act = std::move(act)](Director<D>& director, Simulation<D>& world, int i) {
    act(world, director.body(i));
  });
}
// act(director, world, body), for a world of LPC, not of an engine.
template <int D, class Act>
void addOurs(const EventBlock<D>& e, int body, std::string_view what, Act act) {
  addEvent<D>(e, body, [act = std::move(act), what](Director<D>& director, Simulation<D>& simulation, int i) {
    auto* world = dynamic_cast<World<D>*>(&simulation);
    if (!world)
      throw UserError("'" + std::string(what) + "' is not supported by engines; valid: a pipeline of LPC's stages");
    act(director, *world, i);
  }).oursAlone = true;
}

// Removes the body with this event; its own `remove` may not come earlier.
template <int D>
void takeOut(const EventBlock<D>& e, const char* key, int body) {
  auto& spawn = e.scene.spawns[static_cast<std::size_t>(body)];
  if (spawn.removeAt >= 0 && (spawn.removedBy >= 0 || spawn.removeAt < e.step)) {
    e.block.fail(*e.block.find(key), "this body is already removed at step " + std::to_string(spawn.removeAt));
  }
  spawn.removeAt = e.step, spawn.removedBy = e.number;
}

// A body that forces move.
template <int D>
int dynamicBody(const EventBlock<D>& e) {
  const int body = e.bodyOf("body");
  const auto& spawn = e.scene.spawns[static_cast<std::size_t>(body)];
  if (spawn.body.type != BodyType::dynamic && !spawn.retyped) {
    e.block.fail(*e.block.find("body"), "'body' is not dynamic, so forces do not move it; valid: a dynamic body");
  }
  return body;
}

// p_B of the key `at`; without it the centre of mass.
template <int D>
std::optional<Vec<D>> pointOf(const EventBlock<D>& e) {
  const toml::node* at = e.block.find("at");
  return at ? std::optional(e.numbers.template vector<D>(*at)) : std::nullopt;
}
// From the centre of mass to that point, in world axes (m).
template <int D>
Vec<D> armOf(const Simulation<D>& world, BodyHandle body, const std::optional<Vec<D>>& at) {
  const auto i = static_cast<std::size_t>(body.slot);
  return at ? Vec<D>(world.bodies().pose[i].q * Vec<D>(*at - world.bodies().center[i])) : Vec<D>(Vec<D>::Zero());
}

template <int D>
void requireOneOf(const EventBlock<D>& e, std::initializer_list<const char*> keys) {
  std::string list;
  for (const char* key : keys) {
    if (e.block.find(key)) return;
    list += (list.empty() ? "" : ", ") + std::string(key);
  }
  e.block.fail("an event without effect; valid: at least one of " + list);
}

struct Add {
  static constexpr std::string_view kName = "add", kMeaning = "adds a body; keys as in [[body]]";
  static constexpr bool kNames = true;
  template <int D>
  static void read(const EventBlock<D>& e) {
    const int body = e.addBody();
    if (e.numbers.rehearsing()) return;
    e.scene.spawns[static_cast<std::size_t>(body)].addedBy = e.number;
    addEvent<D>(e, body, [](Director<D>& director, Simulation<D>& world, int i) { director.addBody(world, i); });
  }
};

struct Remove {
  static constexpr std::string_view kName = "remove", kMeaning = "removes a body and its joints: body";
  static constexpr bool kNames = false;
  template <int D>
  static void read(const EventBlock<D>& e) {
    const int body = e.bodyOf("body");
    takeOut(e, "body", body);
    addAction<D>(e, body, [](Simulation<D>& world, BodyHandle h) { world.remove(h); });
  }
};

struct Push {
  static constexpr std::string_view kName = "push";
  static constexpr std::string_view kMeaning =
      "applies an impulse: body, impulse (N s), angular_impulse (N m s), at (m, in the body's frame)";
  static constexpr bool kNames = false;
  template <int D>
  static void read(const EventBlock<D>& e) {
    const int body = dynamicBody(e);
    requireOneOf(e, {"impulse", "angular_impulse"});
    const Vec<D> impulse = e.numbers.template vector<D>(e.block, "impulse");
    const Ang<D> angular = readAngular<D>(e.block, e.numbers, "angular_impulse");
    addAction<D>(e, body, [impulse, angular, at = pointOf(e)](Simulation<D>& world, BodyHandle h) {
      const Ang<D> turn = cross(armOf(world, h, at), impulse) + angular;
      if (!turn.allFinite()) throw EventOverflow("the angular impulse of a push is not finite");
      world.applyImpulse(h, {impulse, turn});
    });
  }
};

struct Set {
  static constexpr std::string_view kName = "set";
  static constexpr std::string_view kMeaning =
      "sets the state of a body: body, position, angle or rotation, velocity, angular_velocity";
  static constexpr bool kNames = false;
  template <int D>
  static void read(const EventBlock<D>& e) {
    const int body = e.bodyOf("body");
    requireOneOf(e, {"position", "angle", "rotation", "velocity", "angular_velocity"});
    const auto& spawn = e.scene.spawns[static_cast<std::size_t>(body)];
    const bool fixed = spawn.body.type == BodyType::fixed && !spawn.retyped;
    const auto given = [&](const char* key, auto value) {
      return e.block.find(key) ? std::optional(value) : std::nullopt;
    };
    for (const char* key : {"velocity", "angular_velocity"}) {
      const toml::node* n = e.block.find(key);
      if (n && fixed) e.block.fail(*n, "'" + std::string(key) + "' of a fixed body; valid: position, angle, rotation");
    }
    const auto position = given("position", e.numbers.template vector<D>(e.block, "position"));
    const bool turned = e.block.find("angle") || e.block.find("rotation");
    const Rot<D> q = readRotation<D>(e.block, e.numbers);
    const auto v = given("velocity", e.numbers.template vector<D>(e.block, "velocity"));
    const auto w = given("angular_velocity", readAngular<D>(e.block, e.numbers, "angular_velocity"));
    addAction<D>(e, body, [=](Simulation<D>& world, BodyHandle h) {
      Pose<D> X_WB = world.pose(h);
      if (position) X_WB.p = *position;
      if (turned) X_WB.q = q;
      if (position || turned) world.setPose(h, X_WB);
      Motion<D> motion = world.bodies().motion[static_cast<std::size_t>(h.slot)];
      if (v) motion.v = *v;
      if (w) motion.w = *w;
      if (v || w) world.setMotion(h, motion);
    });
  }
};

struct Force {
  static constexpr std::string_view kName = "force";
  static constexpr std::string_view kMeaning =
      "applies a force for one step, or for each step until `until`: body, force (N), torque (N m), at (m); or "
      "strength (N) towards a point (m)";
  static constexpr bool kNames = false;
  template <int D>
  static void read(const EventBlock<D>& e) {
    const int body = dynamicBody(e);
    requireOneOf(e, {"force", "torque", "strength"});
    const Vec<D> force = e.numbers.template vector<D>(e.block, "force");
    const Ang<D> torque = readAngular<D>(e.block, e.numbers, "torque");
    const auto strength = static_cast<Real>(e.numbers.between(e.block, "strength", 0, 0, kLargest));
    if (e.block.find("strength")) e.block.require("towards");
    const Vec<D> goal = e.numbers.template vector<D>(e.block, "towards");
    addAction<D>(e, body, [force, torque, strength, goal, at = pointOf(e)](Simulation<D>& world, BodyHandle h) {
      const Vec<D> center = world.bodies().pose[static_cast<std::size_t>(h.slot)].p;
      const Vec<D> point = center + armOf(world, h, at), way = goal - point;
      const Real far = way.norm();
      const Vec<D> pull = far > 0 ? Vec<D>(strength * (way / far)) : Vec<D>(Vec<D>::Zero());
      const Vec<D> sum = force + pull;
      if (!sum.allFinite() || !point.allFinite()) throw EventOverflow("an event's force is not finite");
      world.applyForce(h, sum, point);
      world.applyTorque(h, torque);
    });
  }
};

struct Joint {
  static constexpr std::string_view kName = "joint", kMeaning = "adds a joint; keys as in [[joint]]";
  static constexpr bool kNames = false;
  template <int D>
  static void read(const EventBlock<D>& e) {
    const int joint = e.addJoint();
    addEvent<D>(e, -1, [joint](Director<D>& director, Simulation<D>& world, int) { director.addJoint(world, joint); });
  }
};

struct Unjoin {
  static constexpr std::string_view kName = "unjoin", kMeaning = "removes a named joint: joint";
  static constexpr bool kNames = false;
  template <int D>
  static void read(const EventBlock<D>& e) {
    const int joint = e.jointOf("joint");
    addEvent<D>(e, -1,
                [joint](Director<D>& director, Simulation<D>& world, int) { world.remove(director.joint(joint)); });
  }
};

struct AddForce {
  static constexpr std::string_view kName = "add_force";
  static constexpr std::string_view kMeaning = "adds a lasting force; keys as in [[force]]";
  static constexpr bool kNames = false;
  template <int D>
  static void read(const EventBlock<D>& e) {
    const int force = e.addForce();
    addEvent<D>(e, -1, [force](Director<D>& director, Simulation<D>& world, int) { director.addForce(world, force); });
  }
};

struct RemoveForce {
  static constexpr std::string_view kName = "remove_force", kMeaning = "removes a named force: force";
  static constexpr bool kNames = false;
  template <int D>
  static void read(const EventBlock<D>& e) {
    const int force = e.forceOf("force");
    addEvent<D>(e, -1,
                [force](Director<D>& director, Simulation<D>& world, int) { world.remove(director.force(force)); });
  }
};

struct Merge {
  static constexpr std::string_view kName = "merge";
  static constexpr std::string_view kMeaning = "merges two dynamic or two fixed bodies: into, other";
  static constexpr bool kNames = false;
  template <int D>
  static void read(const EventBlock<D>& e) {
    const int into = e.bodyOf("into"), other = e.bodyOf("other");
    const auto typeOf = [&](int body) { return e.scene.spawns[static_cast<std::size_t>(body)].body.type; };
    if (!e.numbers.rehearsing()) {
      if (into == other) e.block.fail(*e.block.find("other"), "'other' equals 'into'; valid: two different bodies");
      const auto retyped = [&](int body) { return e.scene.spawns[static_cast<std::size_t>(body)].retyped; };
      const bool known = !retyped(into) && !retyped(other);  // otherwise their types are known only at run time
      if (known && (typeOf(into) != typeOf(other) || typeOf(into) == BodyType::kinematic)) {
        e.block.fail(*e.block.find("other"), "these two bodies cannot be merged; valid: both dynamic, or both fixed");
      }
      takeOut(e, "other", other);
    }
    addOurs<D>(e, into, kName, [other](Director<D>& director, World<D>& world, int body) {
      world.merge(director.body(body), director.body(other));
    });
  }
};

struct SplitByShape {
  static constexpr std::string_view kName = "take_apart";
  static constexpr std::string_view kMeaning =
      "splits a body into one body per shape: body, names (the first names the body that remains)";
  static constexpr bool kNames = false;
  template <int D>
  static void read(const EventBlock<D>& e) {
    const int body = e.bodyOf("body");
    e.block.require("names");
    const std::vector<std::string> names = e.block.strings("names");
    for (const std::string& name : names) {
      checkName(e.block, "names", name);
      if (name.empty()) e.block.fail(*e.block.find("names"), "a name in 'names' is empty");
    }
    if (names.empty()) e.block.fail(*e.block.find("names"), "'names' is empty; valid: one for each shape of the body");
    std::vector<int> parts;
    const BodyType type = e.scene.spawns[static_cast<std::size_t>(body)].body.type;
    for (const std::string& name : names) {
      const bool first = &name == &names.front();
      if (e.numbers.rehearsing() || first) {
        if (!first || name != e.scene.spawns[static_cast<std::size_t>(body)].body.name) e.nameBody(name, body);
        parts.push_back(body);
        continue;
      }
      typename SceneSpec<D>::Spawn part;
      part.step = e.step, part.addedBy = e.number, part.part = true;
      part.body.type = type, part.body.name = name;
      part.retyped = e.scene.spawns[static_cast<std::size_t>(body)].retyped;
      parts.push_back(e.addPart(std::move(part)));
    }
    addOurs<D>(e, body, kName, [parts](Director<D>& director, World<D>& world, int of) {
      const BodyHandle whole = director.body(of);
      if (!world.valid(whole)) throw UserError("the body no longer exists");
      const std::size_t shapes = world.shapesOf(static_cast<std::size_t>(whole.slot)).size();
      if (shapes != parts.size()) {
        throw UserError("the body has " + std::to_string(shapes) + " shapes, but the number of 'names' is " +
                        std::to_string(parts.size()) + "; valid: one for each");
      }
      const std::vector<BodyHandle> bodies = world.splitByShape(whole);
      for (std::size_t i = 1; i < bodies.size(); ++i) director.setBody(parts[i], bodies[i]);
    });
  }
};

struct Wake {
  static constexpr std::string_view kName = "wake", kMeaning = "wakes a body, or all bodies without 'body': body";
  static constexpr bool kNames = false;
  template <int D>
  static void read(const EventBlock<D>& e) {
    const int body = e.block.find("body") ? e.bodyOf("body") : -1;
    addAction<D>(e, body, [all = body < 0](Simulation<D>& simulation, BodyHandle h) {
      auto* world = dynamic_cast<World<D>*>(&simulation);
      if (!world) return;  // an engine has no sleeping to change
      all ? world->wakeAll() : world->wake(h);
    });
  }
};

struct Gravity {
  static constexpr std::string_view kName = "gravity", kMeaning = "sets gravity and wakes all bodies: gravity (m/s^2)";
  static constexpr bool kNames = false;
  template <int D>
  static void read(const EventBlock<D>& e) {
    const Vec<D> gravity = e.numbers.template vector<D>(e.block.require("gravity"));
    addAction<D>(e, -1, [gravity](Simulation<D>& simulation, BodyHandle) { changeGravity(simulation, gravity); });
  }
};

struct Clear {
  static constexpr std::string_view kName = "clear";
  static constexpr std::string_view kMeaning = "removes all bodies, joints and forces; later events may add new ones";
  static constexpr bool kNames = false;
  template <int D>
  static void read(const EventBlock<D>& e) {
    if (!e.numbers.rehearsing()) e.clear();
    addOurs<D>(e, -1, kName, [](Director<D>&, World<D>& world, int) { world.clear(); });
  }
};

struct SetPipeline {
  static constexpr std::string_view kName = "exchange";
  static constexpr std::string_view kMeaning = "replaces the algorithms or parameters of the named stages: pipeline";
  static constexpr bool kNames = false;
  template <int D>
  static void read(const EventBlock<D>& e) {
    const std::string text = e.block.requireString("pipeline");
    try {
      Pipeline any;
      any.replace(text);
      StageSet<D>{any};
    } catch (const UserError& error) {
      if (!e.numbers.rehearsing()) e.block.fail(*e.block.find("pipeline"), error.what());
    }
    addOurs<D>(e, -1, kName, [text](Director<D>&, World<D>& world, int) {
      Pipeline pipeline = world.pipeline();
      pipeline.replace(text);
      world.setPipeline(pipeline);
    });
  }
};

// World::change of a body in its present state.
template <int D, class Change>
void addChange(const EventBlock<D>& e, std::string_view what, Change change) {
  addOurs<D>(e, e.bodyOf("body"), what, [change](Director<D>& director, World<D>& world, int body) {
    BodyDef<D> def = world.definition(director.body(body));
    change(def);
    world.change(director.body(body), def);
  });
}

struct Material {
  static constexpr std::string_view kName = "material";
  static constexpr std::string_view kMeaning =
      "sets the material of all shapes of a body: body, friction, restitution, density (kg/m^D)";
  static constexpr bool kNames = false;
  template <int D>
  static void read(const EventBlock<D>& e) {
    requireOneOf(e, {"friction", "restitution", "density"});
    const auto given = [&](const char* key) {
      const toml::node* n = e.block.find(key);
      return n ? std::optional(static_cast<Real>(e.numbers.between(*n, key, 0, kLargest))) : std::nullopt;
    };
    const auto friction = given("friction"), restitution = given("restitution"), density = given("density");
    addChange<D>(e, kName, [=](BodyDef<D>& def) {
      for (ShapeDef<D>& s : def.shapes) {
        s.friction = friction.value_or(s.friction), s.restitution = restitution.value_or(s.restitution);
        s.density = density.value_or(s.density);
      }
    });
  }
};

struct Pin {
  static constexpr std::string_view kName = "pin";
  static constexpr std::string_view kMeaning = "pins a body's centre of mass: body; pinned = false releases it";
  static constexpr bool kNames = false;
  template <int D>
  static void read(const EventBlock<D>& e) {
    const bool pinned = e.block.flag("pinned", true);
    addChange<D>(e, kName, [pinned](BodyDef<D>& def) { def.pinned = pinned; });
  }
};

struct Type {
  static constexpr std::string_view kName = "type";
  static constexpr std::string_view kMeaning = "sets the type of a body: body, type (dynamic, fixed, kinematic)";
  static constexpr bool kNames = false;
  template <int D>
  static void read(const EventBlock<D>& e) {
    e.block.require("type");
    const BodyType type = readBodyType(e.block);
    const int body = e.bodyOf("body");
    if (!e.numbers.rehearsing()) e.scene.spawns[static_cast<std::size_t>(body)].retyped = true;
    addChange<D>(e, kName, [type](BodyDef<D>& def) { def.type = type; });
  }
};

template <class E, int D>
constexpr EventKind<D> eventEntry() {
  return {E::kName, E::kMeaning, E::kNames, E::template read<D>};
}

}  // namespace

template <int D>
std::span<const EventKind<D>> eventKinds() {
  static constexpr EventKind<D> kKinds[] = {
      eventEntry<Add, D>(),         eventEntry<AddForce, D>(), eventEntry<Clear, D>(),
      eventEntry<SetPipeline, D>(), eventEntry<Force, D>(),    eventEntry<Gravity, D>(),
      eventEntry<Joint, D>(),       eventEntry<Material, D>(), eventEntry<Merge, D>(),
      eventEntry<Pin, D>(),         eventEntry<Push, D>(),     eventEntry<Remove, D>(),
      eventEntry<RemoveForce, D>(), eventEntry<Set, D>(),      eventEntry<SplitByShape, D>(),
      eventEntry<Type, D>(),        eventEntry<Unjoin, D>(),   eventEntry<Wake, D>()};
  return kKinds;
}

template std::span<const EventKind<2>> eventKinds();
template std::span<const EventKind<3>> eventKinds();

}}  // namespace lpc::LPC_PRECISION
