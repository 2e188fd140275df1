// SPDX-License-Identifier: Zlib
// Writes a script of calls on a World between steps: `lpc run SCENE --script FILE` then repeats them bit by bit. One
// method for each kind of [[event]] (scene_event.cpp), with the arguments of the call.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "framework/world/world.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Bodies, joints and forces are named as in a script: by a name from `add` or `splitByShape`, by the scene's name, or
/// "#12", the thirteenth of the scene. `step`: number of steps of the script's world, including those before a `clear`.
/// Calls come in the order of the actions. All throw UserError, and write nothing, for what a script cannot express:
/// names with line breaks, numbers that are not finite, user data.
template <int D>
class ScriptWriter {
 public:
  void add(long step, const std::string& name, const BodyDef<D>& body);
  void remove(long step, const std::string& body);
  /// World::applyImpulse: an impulse at the centre of mass, and one about it.
  void push(long step, const std::string& body, const Wrench<D>& impulse);
  /// World::applyForce at the body's present centre of mass, and applyTorque.
  void force(long step, const std::string& body, const Wrench<D>& force);
  /// World::applyForce at a point of the body, in its own frame (m).
  void pull(long step, const std::string& body, const Vec<D>& force, const Vec<D>& at);
  /// World::setPose and setMotion of the given values.
  struct Place {
    std::optional<Vec<D>> position = {};  // m, of the body's frame
    std::optional<Rot<D>> rotation = {};
    std::optional<Vec<D>> velocity = {};         // m/s
    std::optional<Ang<D>> angularVelocity = {};  // rad/s
  };
  void set(long step, const std::string& body, const Place& place);
  void set(long step, const std::string& body, const Pose<D>& X_WB);      // World::setPose
  void set(long step, const std::string& body, const Motion<D>& motion);  // World::setMotion
  /// The handles in both definitions are ignored: `a` and `b` are their bodies, "world", or, for a force, "" for none.
  void joint(long step, const std::string& name, const JointDef<D>& def, const std::string& a, const std::string& b);
  void unjoin(long step, const std::string& joint);
  void addForce(long step, const std::string& name, const ForceDef<D>& def, const std::string& a, const std::string& b);
  void removeForce(long step, const std::string& force);
  void merge(long step, const std::string& into, const std::string& other);
  /// One name for each shape; the first is the body itself, which also keeps its former name.
  void splitByShape(long step, const std::string& body, std::span<const std::string> names);
  void wake(long step, const std::string& body);
  void wakeAll(long step);
  void gravity(long step, const Vec<D>& gravity);
  void clear(long step);
  void setPipeline(long step, const Pipeline& pipeline);
  struct Material {
    std::optional<Real> friction = {}, restitution = {}, density = {};
  };
  /// World::change of the body's definition: sets the given values of all its shapes.
  void material(long step, const std::string& body, const Material& material);
  // World::change, like material.
  void pin(long step, const std::string& body, bool pinned);
  void type(long step, const std::string& body, BodyType type);

  /// The script's file; `steps`: its length, if known. Where it joins bodies, it needs `joints`. `before`: the text of
  /// another script, which it includes; within a step the actions of that script come first.
  std::string text(const std::string& summary, std::optional<long> steps = {}, const std::string& before = "") const;

 private:
  void event(const char* what, long step, const std::string& keys);

  std::string m_events;
  bool m_joins = false;
};

}}  // namespace lpc::LPC_PRECISION
