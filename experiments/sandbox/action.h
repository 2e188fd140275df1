// SPDX-License-Identifier: Zlib
// Actions of the hand on a simulation between two steps: each is one that an [[event]] of a script can express, so that
// actions by hand can be replayed.
#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "framework/scene/director.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Bodies by number: those of the scene in the order of their addition, then those added by hand.
template <int D>
class BodyNumbers {
 public:
  BodyNumbers(const Director<D>& scene, std::vector<BodyHandle>& hand) : m_scene(scene), m_hand(hand) {}
  /// An invalid handle if the body has not been added.
  BodyHandle operator[](int body) const;
  void add(BodyHandle body) { m_hand.push_back(body); }

 private:
  const Director<D>& m_scene;
  std::vector<BodyHandle>& m_hand;
};

template <int D>
struct AddBody {
  BodyDef<D> def;
};
struct RemoveBody {
  int body;
};
/// An impulse (N s) at the centre of mass and an angular one (N m s), at once.
template <int D>
struct PushBody {
  int body;
  Vec<D> impulse = Vec<D>::Zero();
  Ang<D> angular = Ang<D>::Zero();
};
/// A force (N) at a point of the body (m, in the body's frame), for the coming step.
template <int D>
struct PullBody {
  int body;
  Vec<D> force;
  Vec<D> at;
};
/// Sets the given values.
template <int D>
struct SetBody {
  int body;
  std::optional<Vec<D>> position = {};  // of the body's frame (m)
  std::optional<Rot<D>> rotation = {};
  std::optional<Vec<D>> velocity = {};         // m/s
  std::optional<Ang<D>> angularVelocity = {};  // rad/s
};
template <int D>
struct JoinBodies {
  int bodyA, bodyB;  // -1: the world
  JointDef<D> def;   // without the bodies' handles
};
struct MergeBodies {
  int into, other;
};
/// The first shape stays with the body; the others become new bodies.
struct SplitByShape {
  int body;
  int shapes;  // number of shapes of the body
};
struct WakeBodies {
  int body = -1;  // -1: all
};
template <int D>
struct SetGravity {
  Vec<D> gravity;  // m/s^2
};
/// Sets the given values: coefficients of all its shapes, and the body's type.
struct ChangeBody {
  int body;
  std::optional<Real> friction = {}, restitution = {}, density = {};
  std::optional<bool> pinned = {};
  std::optional<BodyType> type = {};
};
/// Changes one competitor only.
struct SetPipeline {
  int competitor;
  std::string pipeline;
};

template <int D>
struct Action {
  using What = std::variant<AddBody<D>, RemoveBody, PushBody<D>, PullBody<D>, SetBody<D>, JoinBodies<D>, MergeBodies,
                            SplitByShape, WakeBodies, SetGravity<D>, ChangeBody, SetPipeline>;
  long step;  // before this one
  What what;
};

/// Throws UserError, with the reason, if the world rejects it, or if the simulation is not a `World` and only that
/// could do it.
template <int D>
void play(const Action<D>& action, int competitor, Simulation<D>& world, BodyNumbers<D>& numbers);

}}  // namespace lpc::LPC_PRECISION
