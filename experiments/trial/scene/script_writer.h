// SPDX-License-Identifier: Zlib
// A script of what was done by calls on a World between its steps: `lpc run SCENE --script FILE` then does the same, to
// the last bit of every number. One method for each kind of [[event]] (scene_event.cpp), with what the call was given.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "framework/world/world.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Bodies are called as a script does: by a name that `add` or `takeApart` gave, by that of the scene, or "#12", the
/// thirteenth of the scene's own; so are joints and forces. `step`: the number of steps that the script's world has
/// made, those before a `clear` as well. Calls come in the order of the deeds. All throw UserError, and have written
/// nothing, for what a script cannot say: names with line breaks, numbers that are not finite, user data.
template <int D>
class ScriptWriter {
 public:
  void add(long step, const std::string& name, const BodyDef<D>& body);
  void remove(long step, const std::string& body);
  /// World::applyImpulse: an impulse at the centre of mass and one about it.
  void push(long step, const std::string& body, const Wrench<D>& impulse);
  /// World::applyForce at the centre of mass, where the body is then, and applyTorque.
  void force(long step, const std::string& body, const Wrench<D>& force);
  /// World::applyForce at a point of the body, in its own frame (m).
  void pull(long step, const std::string& body, const Vec<D>& force, const Vec<D>& at);
  /// World::setPose and setMotion of what is given.
  struct Place {
    std::optional<Vec<D>> position = {};  // m, of its own frame
    std::optional<Rot<D>> rotation = {};
    std::optional<Vec<D>> velocity = {};         // m/s
    std::optional<Ang<D>> angularVelocity = {};  // rad/s
  };
  void set(long step, const std::string& body, const Place& place);
  void set(long step, const std::string& body, const Pose<D>& X_WB);      // World::setPose
  void set(long step, const std::string& body, const Motion<D>& motion);  // World::setMotion
  /// The handles of both definitions count for nothing: `a` and `b` are their bodies, "world" or, of a force, ""
  /// nobody.
  void joint(long step, const std::string& name, const JointDef<D>& def, const std::string& a, const std::string& b);
  void unjoin(long step, const std::string& joint);
  void addForce(long step, const std::string& name, const ForceDef<D>& def, const std::string& a, const std::string& b);
  void removeForce(long step, const std::string& force);
  void merge(long step, const std::string& into, const std::string& other);
  /// One name for each shape; the first is the body itself, which keeps its former name, too.
  void takeApart(long step, const std::string& body, std::span<const std::string> names);
  void wake(long step, const std::string& body);
  void wakeAll(long step);
  void gravity(long step, const Vec<D>& gravity);
  void clear(long step);
  void exchange(long step, const Pipeline& pipeline);
  struct Material {
    std::optional<Real> friction = {}, restitution = {}, density = {};
  };
  /// World::change of the body's definition: of all its shapes what is given.
  void material(long step, const std::string& body, const Material& material);
  // World::change, as material.
  void pin(long step, const std::string& body, bool pinned);
  void type(long step, const std::string& body, BodyType type);

  /// The script's file; `steps`: how long it plays, if it knows. Where it joins bodies, it needs `joints`. `before`:
  /// the text of another script, which it then is, too: within a step what that does comes first.
  std::string text(const std::string& summary, std::optional<long> steps = {}, const std::string& before = "") const;

 private:
  void event(const char* what, long step, const std::string& keys);

  std::string m_events;
  bool m_joins = false;
};

}}  // namespace lpc::LPC_PRECISION
