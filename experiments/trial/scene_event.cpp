// SPDX-License-Identifier: Zlib
// What a script may do between steps: one entry per kind of [[event]], with its fields, its mistakes and its action.
#include "experiments/trial/scene_event.h"

#include <optional>

namespace lpc::inline LPC_PRECISION {
namespace {

template <int D>
void addEvent(const EventBlock<D>& e, int body, std::function<void(Simulation<D>&, Handle)> act) {
  e.scene.events.push_back({e.step, body, std::move(act)});
}

// A body that forces move.
template <int D>
int dynamicBody(const EventBlock<D>& e) {
  const int body = e.bodyOf("body");
  if (e.scene.spawns[static_cast<std::size_t>(body)].body.type != BodyType::dynamic) {
    e.block.fail(*e.block.find("body"), "'body' is one that forces do not move; valid: a dynamic body");
  }
  return body;
}

// p_B of `at`; none: the centre of mass.
template <int D>
std::optional<Vec<D>> pointOf(const EventBlock<D>& e) {
  const toml::node* at = e.block.find("at");
  return at ? std::optional(e.numbers.template vector<D>(*at)) : std::nullopt;
}
// From the centre of mass to that point, in the world's axes (m).
template <int D>
Vec<D> armOf(const Simulation<D>& world, Handle body, const std::optional<Vec<D>>& at) {
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
  static constexpr std::string_view kName = "add", kMeaning = "brings a body in; its keys are those of a [[body]]";
  static constexpr bool kNames = true;
  template <int D>
  static void read(const EventBlock<D>& e) {
    e.addBody();
  }
};

struct Remove {
  static constexpr std::string_view kName = "remove", kMeaning = "takes a body out, and its joints: body";
  static constexpr bool kNames = false;
  template <int D>
  static void read(const EventBlock<D>& e) {
    auto& spawn = e.scene.spawns[static_cast<std::size_t>(e.bodyOf("body"))];
    if (spawn.removeAt >= 0) {
      e.block.fail(*e.block.find("body"),
                   "this body is removed at step " + std::to_string(spawn.removeAt) + " already");
    }
    spawn.removeAt = e.step;
  }
};

struct Push {
  static constexpr std::string_view kName = "push";
  static constexpr std::string_view kMeaning =
      "a blow: body, impulse (N s), angular_impulse (N m s), at (m, in its frame)";
  static constexpr bool kNames = false;
  template <int D>
  static void read(const EventBlock<D>& e) {
    const int body = dynamicBody(e);
    requireOneOf(e, {"impulse", "angular_impulse"});
    const Vec<D> impulse = e.numbers.template vector<D>(e.block, "impulse");
    const Ang<D> angular = readAngular<D>(e.block, e.numbers, "angular_impulse");
    addEvent<D>(e, body, [impulse, angular, at = pointOf(e)](Simulation<D>& world, Handle h) {
      const Ang<D> turn = cross(armOf(world, h, at), impulse) + angular;
      if (!turn.allFinite()) throw EventOverflow("a push comes to an angular impulse beyond all numbers");
      world.applyImpulse(h, {impulse, turn});
    });
  }
};

struct Set {
  static constexpr std::string_view kName = "set";
  static constexpr std::string_view kMeaning = "body, and what it gets: position, angle, velocity, angular_velocity";
  static constexpr bool kNames = false;
  template <int D>
  static void read(const EventBlock<D>& e) {
    const int body = e.bodyOf("body");
    requireOneOf(e, {"position", "angle", "velocity", "angular_velocity"});
    const bool fixed = e.scene.spawns[static_cast<std::size_t>(body)].body.type == BodyType::fixed;
    const auto given = [&](const char* key, auto value) {
      return e.block.find(key) ? std::optional(value) : std::nullopt;
    };
    for (const char* key : {"velocity", "angular_velocity"}) {
      const toml::node* n = e.block.find(key);
      if (n && fixed) e.block.fail(*n, "'" + std::string(key) + "' of a fixed body; valid: position, angle");
    }
    const auto position = given("position", e.numbers.template vector<D>(e.block, "position"));
    const auto angle = given("angle", readAngle<D>(e.block, e.numbers, "angle"));
    const auto v = given("velocity", e.numbers.template vector<D>(e.block, "velocity"));
    const auto w = given("angular_velocity", readAngular<D>(e.block, e.numbers, "angular_velocity"));
    addEvent<D>(e, body, [=](Simulation<D>& world, Handle h) {
      Pose<D> X_WB = world.pose(h);
      if (position) X_WB.p = *position;
      if (angle) X_WB.q = rotationOf(*angle);
      if (position || angle) world.setPose(h, X_WB);
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
      "for one step, or each until `until`: body, force (N), torque (N m), at (m); strength (N) towards a point (m)";
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
    addEvent<D>(e, body, [force, torque, strength, goal, at = pointOf(e)](Simulation<D>& world, Handle h) {
      const Vec<D> center = world.bodies().pose[static_cast<std::size_t>(h.slot)].p;
      const Vec<D> point = center + armOf(world, h, at), way = goal - point;
      const Real far = way.norm();
      const Vec<D> pull = far > 0 ? Vec<D>(strength * (way / far)) : Vec<D>(Vec<D>::Zero());
      const Vec<D> sum = force + pull;
      if (!sum.allFinite() || !point.allFinite()) throw EventOverflow("an event's force is beyond all numbers");
      world.applyForce(h, sum, point);
      world.applyTorque(h, torque);
    });
  }
};

struct Joint {
  static constexpr std::string_view kName = "joint", kMeaning = "joins two bodies; its keys are those of a [[joint]]";
  static constexpr bool kNames = false;
  template <int D>
  static void read(const EventBlock<D>& e) {
    auto joint = e.readJoint(e.block);
    joint.step = e.step;
    e.scene.joints.push_back(std::move(joint));
  }
};

template <class E, int D>
constexpr EventKind<D> eventEntry() {
  return {E::kName, E::kMeaning, E::kNames, E::template read<D>};
}

}  // namespace

template <int D>
std::span<const EventKind<D>> eventKinds() {
  static constexpr EventKind<D> kKinds[] = {eventEntry<Add, D>(),  eventEntry<Force, D>(),  eventEntry<Joint, D>(),
                                            eventEntry<Push, D>(), eventEntry<Remove, D>(), eventEntry<Set, D>()};
  return kKinds;
}

template std::span<const EventKind<2>> eventKinds();
template std::span<const EventKind<3>> eventKinds();

}  // namespace lpc::inline LPC_PRECISION
