// SPDX-License-Identifier: Zlib
// Draws a simulation in the state after its last step. Calls no function that would update the simulation, so that
// drawing does not affect any step.
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "framework/draw/debug_draw.h"
#include "framework/stage/params.h"
#include "framework/world/links.h"

namespace lpc { inline namespace LPC_PRECISION {

// Colours with a meaning, for legends.
inline constexpr DrawColour kDrawnFixed{205, 205, 200};  // a static body
inline constexpr DrawColour kDrawnBearing{214, 39, 40};  // a contact with an impulse in the last step
inline constexpr DrawColour kDrawnIdle{90, 110, 140};    // a contact without an impulse
inline constexpr DrawColour kDrawnNormal{44, 110, 44};
inline constexpr DrawColour kDrawnImpulse{214, 39, 40};
inline constexpr DrawColour kDrawnFriction{230, 120, 20};
inline constexpr DrawColour kDrawnBox{150, 150, 160};
inline constexpr DrawColour kDrawnPair{120, 90, 170};
inline constexpr DrawColour kDrawnJoint{20, 110, 160};
inline constexpr DrawColour kDrawnForce{140, 90, 40};  // a spring force
inline constexpr DrawColour kDrawnJointError{200, 0, 120};
inline constexpr DrawColour kDrawnCentre{30, 30, 30};
inline constexpr DrawColour kDrawnVelocity{0, 130, 120};

struct DrawLayers {
  bool shapes = true, sleep = true, islands = false;
  bool contacts = false, normals = false, impulses = false, friction = false;
  bool boxes = false, structure = false, pairs = false;
  bool joints = true, jointErrors = false;
  bool centres = false, velocities = false;

  Real normalLength = Real(0.25);  // m
  Real impulseLength = 1;          // m per N s
  Real velocityTime = Real(0.1);   // s
  /// Draws everything in this colour, and only the edges of shapes: to overlay one simulation on another of the same
  /// scene.
  std::optional<DrawColour> tint = {};

  void visit(ParamVisitor& v) {
    v.real("normal_length", normalLength, 0, 10, "m", "length of normals");
    v.real("impulse_length", impulseLength, 0, 100, "m/(N s)", "length of an impulse");
    v.real("velocity_time", velocityTime, 0, 10, "s", "velocities are drawn as the motion in this time");
  }
};

/// All switches of a `DrawLayers`, for menus.
struct DrawLayer {
  std::string_view name, meaning;
  bool DrawLayers::*on;
};
inline constexpr std::array<DrawLayer, 14> kDrawLayers = {{
    {"shapes", "the convex parts of all bodies", &DrawLayers::shapes},
    {"sleep", "sleeping bodies are paler", &DrawLayers::sleep},
    {"islands", "connected bodies have the same colour", &DrawLayers::islands},
    {"contacts", "contact points, red with an impulse in the last step", &DrawLayers::contacts},
    {"normals", "contact normals, from the first body to the second", &DrawLayers::normals},
    {"impulses", "normal impulses of contacts in the last step", &DrawLayers::impulses},
    {"friction", "friction impulses on the second body", &DrawLayers::friction},
    {"boxes", "boxes of the last broadphase, including half the contact margin", &DrawLayers::boxes},
    {"structure", "structure of the broadphase: cells or tree nodes", &DrawLayers::structure},
    {"pairs", "pairs passed to the contact generator in the last step, from box to box", &DrawLayers::pairs},
    {"joints", "joints and springs: anchors, the line between them, and lines to the centres of mass",
     &DrawLayers::joints},
    {"joint errors", "visible joint errors, and their size", &DrawLayers::jointErrors},
    {"centres", "centres of mass of moving bodies", &DrawLayers::centres},
    {"velocities", "velocities of the centres of mass", &DrawLayers::velocities},
}};

/// Look of a body: colours alternate, so that neighbours differ.
Look bodyLook(std::size_t slot, BodyType type, bool awake);

/// False for a pose that is not finite: the body cannot be drawn.
template <int D>
bool isPlace(const Pose<D>& X_WC) {
  return X_WC.p.allFinite() && (X_WC.q * Vec<D>(Vec<D>::UnitX())).allFinite();
}

/// Draws a joint or a spring force.
template <int D>
void drawLink(const Link<D>& link, const std::optional<DrawColour>& tint, DebugDraw<D>& draw);

/// Draws a simulation. Data that the simulation does not report is not drawn: contacts and islands of an engine; boxes,
/// structure and pairs of anything but a `World`.
template <int D>
void drawSimulation(const Simulation<D>& simulation, const DrawLayers& layers, DebugDraw<D>& draw);

}}  // namespace lpc::LPC_PRECISION
