// SPDX-License-Identifier: Zlib
// A scene as plain data, as read from its file: the objects that enter the world, with the step of each.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "framework/world/simulation.h"

namespace lpc { inline namespace LPC_PRECISION {

template <int D>
class Director;

template <int D>
struct SceneSpec {
  struct Spawn {
    long step = 0;  // before this step; 0 = from the start
    BodyDef<D> body;
    long removeAt = -1;        // before this step; -1 = never
    BodyHandle existing = {};  // a body of the saved world; default: added by the script
    // Blocks of the events that add and remove this body, in the order of all events; -1: none.
    int addedBy = -1, removedBy = -1;
    bool retyped = false;     // an event changes the body's type; `body` has the type at the start
    bool part = false;        // an event splits it off another body; `body` has only a valid name and type
    bool exact = false;       // not moved by `perturb`
    std::string called = {};  // its name in events of a script that is played in the scene; stays valid when more
                              // events are appended
  };
  /// Bodies are indices into `spawns`; -1 is the world.
  struct Joint {
    int bodyA = -1, bodyB = -1;
    JointDef<D> def;       // without the bodies' handles
    long step = 0;         // not before this step
    bool byEvent = false;  // added by an event, among the other events
  };
  struct Force {
    int bodyA = -1, bodyB = -1;  // -1: none
    ForceDef<D> def;             // without the bodies' handles
    long step = 0;               // not before this step
    long removeAt = -1;          // before this step; -1 = never
    bool byEvent = false;        // added by an event, among the other events
  };
  /// An event before this step, in the order of the file. It follows the step's scheduled additions, and precedes
  /// scheduled removals of bodies. The kinds of [[event]] in a scene file are entries of a table
  /// (experiments/trial/scene/scene_event.cpp).
  struct Event {
    long step = 0;
    int body = -1;  // an index into `spawns`
    std::function<void(Director<D>&, Simulation<D>&, int body)> act;
    int block = 0;                             // number of the block in the file
    std::shared_ptr<const std::string> place;  // file and line of the block
    bool oursAlone = false;                    // only for a World, not for engines
  };
  /// Limits of a correct run; 0: no limit, except for `speed`. The quoted word is the outcome of a trial that exceeds
  /// the limit.
  struct Limits {
    /// "collapsed": a body is farther than this from where it was added (m). Sagging under soft contacts is allowed:
    /// the body has only sunk and still rests on another body, and all bodies touch the same bodies as after one
    /// second.
    Real drift = 0;
    Real creep = 0;   // "collapsed": at the end a body has moved by more than this in the last second (m/s)
    Real speed = 0;   // "exploded": a body is faster than this (m/s); 0: the speed of light
    Real energy = 0;  // "diverged": energy is this many times its start; only if the start is above 1e-6 J
    /// "sank": the scene is a stack of this many levels at rest. At the end a body has sagged, penetrates another, or
    /// sinks by more than kRestShare of the smallest body (experiments/trial/measure/rest.h).
    Real levels = 0;
    Real fall = 0;          // how far a body may fall before it comes to rest (m)
    bool mayLeave = false;  // false: "left" when a body is below everything that could hold it
  };

  /// A scene with an analytic solution: a body slides down a plane from rest. Bodies are indices into `spawns`.
  struct Slope {
    int body = -1;
    Real angle = 0;     // inclination, rad
    Real friction = 0;  // Coulomb's coefficient of the body and the plane
  };

  std::string name, summary;
  std::string saved;  // bytes of the world with which the scene begins (World::save); its bodies come first in `spawns`
  WorldSettings<D> settings;  // with the model that the scene needs
  Real dt = Real(1) / 60;     // s
  long steps = 600;
  std::vector<Spawn> spawns;  // sorted by step; bodies split off others are at the end
  std::vector<Joint> joints;  // added with the later of their bodies
  std::vector<Event> events;  // sorted by step and block
  std::vector<Force> forces;  // added with the later of their bodies
  Limits limits;
  std::optional<Slope> slope;
  bool seeded = false;  // reading the scene used the seed: another seed gives another scene
};

}}  // namespace lpc::LPC_PRECISION
