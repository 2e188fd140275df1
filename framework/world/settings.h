// SPDX-License-Identifier: Zlib
// All user settings in one place. The 2009 report calls them Globals (9.1.11, A.3.6), but here they are not global. A
// change of a `Settings` affects worlds and shapes made afterwards, not existing ones.
#pragma once

#include <optional>
#include <string_view>

#include "framework/stage/spec.h"
#include "framework/world/simulation.h"

namespace lpc { inline namespace LPC_PRECISION {

/// `Settings{}` has the defaults of World, Pipeline and ShapeDef.
struct Settings {
  // --- new shapes ----------------------------------------------------------------------------------------------------
  Real density = 1;           // kg/m^D, above 0. Ratios beyond 100 within a pile: slow convergence, soft contacts
  Real restitution = 0;       // (1) 0 to 1. Above 1 each bounce adds energy without end
  Real friction = Real(0.5);  // (1) Coulomb, 0 or more. Far above 1: bodies wedge, and no solver resolves it

  // --- new worlds ----------------------------------------------------------------------------------------------------
  Real gravity = defaultGravity<2>()[1];  // m/s^2 along y. Larger: stacks need more iterations, small bodies tunnel
  /// s. Larger: deeper penetration at the first contact, and fast bodies pass through thin ones. Smaller: more time.
  Real dt = Real(1) / 60;
  bool useRestitution = true;  // off: no body bounces, whatever the shapes' restitution
  /// No bounce below this approach speed (m/s). Larger: bodies do not bounce. Smaller: resting bodies chatter.
  Real restitutionThreshold = kRestitutionThreshold;
  MixRules mixing{};  // how to combine the coefficients of two shapes

  // --- air -----------------------------------------------------------------------------------------------------------
  bool airResistance = false;
  Real linearDrag = Real(0.01);  // N s/m. Above mass / dt drag reverses the motion, and the world explodes
  /// N s^2/m^2. The same danger as for linearDrag; the faster the body, the lower the dangerous value.
  Real quadraticDrag = Real(0.01);

  // --- algorithms ----------------------------------------------------------------------------------------------------
  /// Algorithms of the stages. Settings below may replace some of these algorithms.
  Pipeline stages{};
  /// Penetration depth that contacts keep (m). Sets the parameter `slop` of the solver in `stages`, or of its position
  /// resolver. The report calls it penetrationEpsilon. Default of nearly all methods: 0.005. Larger: resting bodies
  /// visibly overlap. Smaller: contacts of resting bodies come and go.
  std::optional<Real> slop{};
  /// Off: one point per contact, and boxes rock on their faces.
  bool severalContacts = true;
  /// Off: each step starts without cached impulses. Stacks are soft, and need many more iterations.
  bool cacheContacts = true;
  bool sleeping = false;  // on: bodies that hardly move are skipped until an event wakes them
  /// A body falls asleep when its average speed is below this (m/s) and its average angular speed is below
  /// angularSleepSpeed. Larger: bodies freeze in the air at the top of their flight. Smaller: piles never sleep.
  Real linearSleepSpeed = Real(1.5);
  /// Limit of the average angular speed (rad/s). Larger: towers freeze as they fall over. Smaller: slowly rolling
  /// bodies never sleep.
  Real angularSleepSpeed = Real(0.01);
  /// Weight of the past in the running average (1), 0 to 0.999. Larger: bodies fall asleep late. Smaller: bodies fall
  /// asleep at the first still moment.
  Real sleepBias = Real(0.5);
  bool sleepingContacts = false;  // on: contacts of sleeping bodies are made again in each step, which costs time

  /// The algorithms and the numbers of the 2009 report's appendix A.3.6. The report had no correct contact algorithm in
  /// 3D; there contacts are made by `sat_clip`.
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
  /// Air resistance for all moving bodies, against translation and rotation; empty when `airResistance` is off.
  template <int D>
  std::optional<ForceDef<D>> air() const;
};

}}  // namespace lpc::LPC_PRECISION
