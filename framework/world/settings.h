// SPDX-License-Identifier: Zlib
// All user settings in one place: the Globals of the 2009 report (9.1.11, A.3.6), but not global. A change of a
// `Settings` affects worlds and shapes made afterwards, not existing ones.
#pragma once

#include <optional>
#include <string_view>

#include "framework/stage/spec.h"
#include "framework/world/simulation.h"

namespace lpc { inline namespace LPC_PRECISION {

/// `Settings{}` has the defaults of World, Pipeline and ShapeDef.
struct Settings {
  // --- new shapes ----------------------------------------------------------------------------------------------------
  Real density = 1;           // kg/m^D, above 0. Ratios beyond 100 within a pile: slow to converge, soft
  Real restitution = 0;       // (1) 0 to 1. Above 1 each bounce adds energy without end
  Real friction = Real(0.5);  // (1) Coulomb, 0 or more. Far above 1: wedges that no solver resolves

  // --- new worlds ----------------------------------------------------------------------------------------------------
  Real gravity = defaultGravity<2>()[1];  // m/s^2 along y. Larger: stacks need more iterations, small bodies tunnel
  /// s. Larger: deeper penetration at the first contact, and fast bodies pass through thin ones. Smaller: more time.
  Real dt = Real(1) / 60;
  bool useRestitution = true;  // off: nothing bounces, whatever the shapes' restitution
  /// No bounce below this approach speed (m/s). Larger: bodies do not bounce. Smaller: resting bodies chatter.
  Real restitutionThreshold = kRestitutionThreshold;
  MixRules mixing{};  // combine the coefficients of two shapes

  // --- air -----------------------------------------------------------------------------------------------------------
  bool airResistance = false;
  Real linearDrag = Real(0.01);  // N s/m. Above mass / dt it reverses motion, and the world explodes
  /// N s^2/m^2. Danger as above, at a lower value the faster a body is.
  Real quadraticDrag = Real(0.01);

  // --- algorithms ----------------------------------------------------------------------------------------------------
  /// Algorithms of the stages; settings below may replace some of them.
  Pipeline stages{};
  /// Penetration depth that contacts keep (m), of the position resolver or the solver in `stages`, whichever takes it:
  /// the report's penetrationEpsilon. Default of nearly all methods: 0.005. Larger: resting bodies visibly overlap.
  /// Smaller: contacts of resting bodies come and go.
  std::optional<Real> slop{};
  /// Off: one point per contact, and boxes rock on their faces.
  bool severalContacts = true;
  /// Off: each step starts without cached impulses. Stacks are soft, and need many more iterations.
  bool cacheContacts = true;
  bool sleeping = false;  // on: bodies that hardly move are skipped until an event wakes them
  /// Bodies fall asleep below this average speed (m/s). Larger: bodies freeze in the air at the top of their flight.
  /// Smaller: piles never sleep.
  Real linearSleepSpeed = Real(1.5);
  /// And below this angular speed (rad/s). Larger: towers freeze as they fall over. Smaller: slowly rolling bodies
  /// never sleep.
  Real angularSleepSpeed = Real(0.01);
  /// Weight of the past in the running average (1), 0 to 0.999. Larger: bodies fall asleep late. Smaller: at the first
  /// still moment.
  Real sleepBias = Real(0.5);
  bool sleepingContacts = false;  // on: contacts of sleeping bodies are made again in each step, which costs time

  /// The algorithms and the numbers of the 2009 report's appendix A.3.6. In 3D, where the report had no correct contact
  /// algorithm, the contacts of `sat_clip`.
  static Settings lpc2009(int dimension = 2);
  /// Returns the settings that have this name in scene files. Throws UserError with the valid names.
  static Settings named(std::string_view name, int dimension = 2);

  // --- conversion to world settings, pipeline, shapes and forces -----------------------------------------------------
  template <int D>
  WorldSettings<D> world() const;
  /// The pipeline with all settings applied. Throws UserError for a `slop` when no stage in `stages` takes one.
  Pipeline pipeline() const;
  template <int D>
  ShapeDef<D> shape(const Shape<D>& of) const;
  /// Air resistance for all moving bodies, also against rotation; empty without air resistance.
  template <int D>
  std::optional<ForceDef<D>> air() const;
};

}}  // namespace lpc::LPC_PRECISION
