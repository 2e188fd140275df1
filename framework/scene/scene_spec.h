// SPDX-License-Identifier: Zlib
// A scene as plain data, after its file was read: who comes into the world when.
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
    long removeAt = -1;  // before this step; -1 = never
    Handle there = {};   // of a body of the saved world; nobody: it comes by itself
    // The blocks of the events that bring it and take it out, each in its turn among all events; -1: none.
    int broughtBy = -1, takenBy = -1;
    bool retyped = false;     // by an event: of `body` the type is what it comes with
    bool part = false;        // of a body that an event takes apart: of `body` its name and type alone are known
    bool exact = false;       // `perturb` leaves it where it is
    std::string called = {};  // by events of a script that plays in the scene, whatever events stand below them
  };
  /// Bodies are named by their place in `spawns`; -1 is the world.
  struct Joint {
    int bodyA = -1, bodyB = -1;
    JointDef<D> def;       // without the bodies' handles
    long step = 0;         // not before this step
    bool byEvent = false;  // made by one, in its turn
  };
  struct Force {
    int bodyA = -1, bodyB = -1;  // -1: nobody
    ForceDef<D> def;             // without the bodies' handles
    long step = 0;               // not before this step
    long removeAt = -1;          // before this step; -1 = never
    bool byEvent = false;        // added by one, in its turn
  };
  /// What a script does before this step, in the order of the file: after what comes in it by itself, and before what
  /// goes by itself. The kinds of a scene file's [[event]] are entries of a table
  /// (experiments/trial/scene/scene_event.cpp).
  struct Event {
    long step = 0;
    int body = -1;  // a place in `spawns`
    std::function<void(Director<D>&, Simulation<D>&, int body)> act;
    int block = 0;                             // its number in the file
    std::shared_ptr<const std::string> place;  // file and line of the block
    bool oursAlone = false;                    // an engine cannot do it
  };
  /// What must hold at every step of a right run, 0 = no demand. A breach ends the trial with that outcome.
  struct Limits {
    /// "collapsed": a body is farther than this from where it came into the world (m). Not where it has only sunk,
    /// still rests on something, and all bodies touch whom they touched after a second: soft contacts sag and hold.
    Real drift = 0;
    Real creep = 0;  // "collapsed": at the end a body has moved by more than this in the last second (m/s)
    Real speed = 0;  // "exploded": a body is faster than this (m/s)
    Real energy =
        0;  // "exploded": mechanical energy above this many times its start (only from a start above the floor)
    /// "sank": the scene rests, with so many bodies on each other, but at its end one has sagged, is in another or
    /// sinks by more than kRestShare of the smallest body (experiments/trial/measure/rest.h).
    Real levels = 0;
    Real fall = 0;          // how far a body may fall before it rests (m)
    bool mayLeave = false;  // else "left": a body is below all that could hold it
  };

  /// A closed form that the scene has: a body slides down a plane from rest. Bodies are places in `spawns`.
  struct Slope {
    int body = -1;
    Real angle = 0;     // inclination, rad
    Real friction = 0;  // Coulomb's coefficient of body and plane
  };

  std::string name, summary;
  std::string saved;  // bytes of the world that it begins with (World::save), whose bodies come first in `spawns`
  WorldSettings<D> settings;  // with the features that the scene needs
  Real dt = Real(1) / 60;     // s
  long steps = 600;
  std::vector<Spawn> spawns;  // sorted by step, but for parts of others at the end
  std::vector<Joint> joints;  // made when the later of their bodies comes
  std::vector<Event> events;  // sorted by step and block
  std::vector<Force> forces;  // made when the later of their bodies comes
  Limits limits;
  std::optional<Slope> slope;
  bool seeded = false;  // whether the seed decided anything: another one is then another scene
};

}}  // namespace lpc::LPC_PRECISION
