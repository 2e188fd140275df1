// SPDX-License-Identifier: Zlib
// What a user may set, in one place: the Globals of the 2009 report (9.1.11, A.3.6) without their being global. A
// change of a `Settings` reaches what is made of it afterwards, and no world or shape that is there.
#pragma once

#include <optional>
#include <string_view>

#include "framework/stage/spec.h"
#include "framework/world/simulation.h"

namespace lpc { inline namespace LPC_PRECISION {

/// `Settings{}` is what World, Pipeline and ShapeDef are by themselves.
struct Settings {
  // --- new shapes ----------------------------------------------------------------------------------------------------
  Real density = 1;           // kg/m^D, above 0. Ratios beyond 100 within a pile: slow to converge, soft
  Real restitution = 0;       // (1) 0 to 1. Above 1 each bounce adds energy, for ever
  Real friction = Real(0.5);  // (1) Coulomb, 0 or more. Far above 1: wedges that no solver finds the answer to

  // --- new worlds ----------------------------------------------------------------------------------------------------
  Real gravity = defaultGravity<2>()[1];  // m/s^2 along y. Larger: stacks need more iterations, small things tunnel
  /// s. Larger: deeper penetration at the first contact, and what is fast passes through what is thin. Smaller: time.
  Real dt = Real(1) / 60;
  bool useRestitution = true;  // off: nothing bounces, whatever its shapes say
  /// Approach slower than this does not bounce (m/s). Larger: dead balls. Smaller: resting bodies chatter.
  Real restitutionThreshold = kRestitutionThreshold;
  MixRules mixing{};  // how two shapes' coefficients become their contact's

  // --- air -----------------------------------------------------------------------------------------------------------
  bool airResistance = false;
  Real linearDrag = Real(0.01);  // N s/m. Above mass / dt it turns motion round, and the world explodes
  /// N s^2/m^2. Danger as above, and the sooner the faster a body is.
  Real quadraticDrag = Real(0.01);

  // --- algorithms ----------------------------------------------------------------------------------------------------
  /// What those below leave to others.
  Pipeline stages{};
  /// The depth that contacts keep (m), of the position resolver or solver in `stages`, whichever it is: the report's
  /// penetrationEpsilon, 0.005, which nearly all have by themselves. Larger: what rests overlaps to be seen. Smaller:
  /// contacts of what rests come and go.
  std::optional<Real> slop{};
  /// Off: one point per contact, and boxes rock on their faces.
  bool severalContacts = true;
  /// Off: each step begins from nothing. Stacks are soft, and need many more iterations.
  bool cacheContacts = true;
  bool sleeping = false;  // on: who hardly moves is left out of a step until something happens to it
  /// Fall asleep below this average speed (m/s). Larger: bodies freeze in the air at the top of their way. Smaller:
  /// piles never sleep.
  Real linearSleepSpeed = Real(1.5);
  /// And below this (rad/s). Larger: towers freeze as they fall over. Smaller: what rolls a little never sleeps.
  Real angularSleepSpeed = Real(0.01);
  /// Weight of the average so far (1), 0 to 0.999. Larger: sleep comes late. Smaller: at the first still moment.
  Real sleepBias = Real(0.5);
  bool sleepingContacts = false;  // on: those of sleepers are made anew in each step, at the cost of who is awake

  /// The numbers of the 2009 report's appendix A.3.6, and its algorithms: in 3D, where it had none that were right, the
  /// contacts of `sat_clip`.
  static Settings lpc2009(int dimension = 2);
  /// By the name that a scene gives it. Throws UserError with the valid ones.
  static Settings named(std::string_view name, int dimension = 2);

  // --- what an engine takes ------------------------------------------------------------------------------------------
  template <int D>
  WorldSettings<D> world() const;
  /// Throws UserError for a `slop` where `stages` have nobody who takes one.
  Pipeline pipeline() const;
  template <int D>
  ShapeDef<D> shape(const Shape<D>& of) const;
  /// To be added to a world, on all that moves and on its rotation; nothing where there is none.
  template <int D>
  std::optional<ForceDef<D>> air() const;
};

}}  // namespace lpc::LPC_PRECISION
