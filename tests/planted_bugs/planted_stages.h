// SPDX-License-Identifier: Zlib
// Stages with one planted bug each, for pipelines of whole worlds, under the names planted_...: the properties of
// worlds must catch them. They are no competitors, so tests over the registry skip them.
//
// Include it in one file of a test program.
#pragma once

#include <algorithm>

#include "framework/stage/profiler.h"
#include "framework/stage/stage_broadphase.h"
#include "framework/stage/stage_narrowphase.h"
#include "framework/stage/stage_sleep.h"
#include "framework/stage/stage_solver.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test {

inline AlgorithmInfo planted(const std::string& stage) {
  return {.name = "planted_" + stage,
          .summary = "planted bugs",
          .paper = "",
          .complexity = "that of what it spoils",
          .role = AlgorithmRole::witness};
}

/// The default solver, spoiled.
template <int D>
class PlantedSolver final : public Solver<D> {
 public:
  enum class Bug {
    none,
    remembers,      // has a state that is not saved
    remembersRuns,  // has a state that outlives the world
    countsBodies,   // depends on the number of bodies
    watches,        // depends on whether it is profiled
    farIsCoarse,    // stores positions as float
    heats,          // each step increases every speed by a thousandth
    shares,         // every body gets a little of every speed
    creeps,         // each step moves every body by 0.01 mm
    turns,          // moving sideways turns a body
    hops,           // every hundredth step lifts every body
    divides,        // divides by a parameter that may be 0
    writesDown      // no bug: its state is in the saved memory of solvers
  };
  struct Params {
    Bug bug = Bug::none;
    Real divisor = 1;
    void visit(ParamVisitor& v) {
      v.choice("bug", bug,
               {"none", "remembers", "remembers_runs", "counts_bodies", "watches", "far_is_coarse", "heats", "shares",
                "creeps", "turns", "hops", "divides", "writes_down"},
               "what is wrong");
      v.real("divisor", divisor, 0, 1, "1", "of bug=divides");
    }
  };
  explicit PlantedSolver(const Params& params)
      : m_bug(params.bug), m_divisor(params.divisor), m_right(createStage<Solver<D>>({"split_solver", {}})) {}
  static AlgorithmInfo info() { return planted("solver"); }

  void step(const StepInput<D>& in) override {
    m_right->step(in);
    static long runs = 0;
    ++m_steps, ++runs;
    for (std::size_t i = 0; i < in.bodies.pose.size(); ++i) {
      if (in.bodies.active(static_cast<int>(i))) spoil(in, in.bodies.pose[i], in.bodies.motion[i], runs);
    }
    if (m_bug == Bug::writesDown) writeDown(in);
    if (m_bug == Bug::remembersRuns) in.work[WorkCount::rowUpdates] += static_cast<std::uint64_t>(runs);
  }

 private:
  void spoil(const StepInput<D>& in, Pose<D>& pose, Motion<D>& motion, long runs) const {
    const Real little = Real(1e-9);
    switch (m_bug) {
      case Bug::none:
        break;
      case Bug::remembers:
        motion.v[0] += little * static_cast<Real>(m_steps % 7);
        break;
      case Bug::remembersRuns:
        motion.v[0] += little * static_cast<Real>(runs % 7);
        break;
      case Bug::countsBodies:
        motion.v[0] += little * static_cast<Real>(in.bodies.size());
        break;
      case Bug::watches:
        motion.v[0] += little * static_cast<Real>(in.profiler.frames().size());
        break;
      case Bug::farIsCoarse:
        for (int d = 0; d < D; ++d) pose.p[d] = static_cast<float>(pose.p[d]);
        break;
      case Bug::heats:
        motion.v *= Real(1.001), motion.w *= Real(1.001);
        break;
      case Bug::shares:
        for (const Motion<D>& other : in.bodies.motion) motion.v += Real(1e-12) * other.v;
        break;
      case Bug::creeps:
        pose.p[0] += Real(1e-5);
        break;
      case Bug::turns:
        pose.q = integrateRotation(pose.q, Ang<D>::Constant(Real(0.01) * motion.v[0] * in.dt).eval());
        break;
      case Bug::hops:
        if (m_steps % 100 == 0) motion.v[1] += Real(0.01);
        break;
      case Bug::divides:
        motion.v[0] += little / m_divisor;
        break;
      case Bug::writesDown:
        break;
    }
  }

  static void writeDown(const StepInput<D>& in) {
    const auto next = [](Real& x) { return Real(1e-9) * static_cast<Real>(static_cast<int>(x += 1) % 7); };
    for (std::size_t i = 0; i < in.bodies.solver.size(); ++i) {
      if (in.bodies.active(static_cast<int>(i))) in.bodies.motion[i].v[0] += next(in.bodies.solver[i][5]);
    }
    for (JointRecord<D>& j : in.joints) {
      if (j.active()) in.bodies.motion[static_cast<std::size_t>(j.bodyB)].v[1] += next(j.memory[7]);
    }
  }

  Bug m_bug;
  Real m_divisor;
  std::unique_ptr<Solver<D>> m_right;
  long m_steps = 0;
};
LPC_REGISTER(Solver, PlantedSolver, 2, 3);

/// split_average, spoiled.
template <int D>
class PlantedSleep final : public SleepPolicy<D> {
 public:
  enum class Bug {
    deaf,          // ignores all events: lost supports and forces wake no body
    deafToJoints,  // ignores removed joints
    nowhere,       // ignores supports: sleeps in the air
    adrift,        // falls asleep before it is at rest
    crowd,         // no body sleeps while any body moves
    wall,          // a struck sleeper stays asleep
    slips          // a sleeper does not notice that its support slides away
  };
  struct Params {
    Bug bug = Bug::deaf;
    void visit(ParamVisitor& v) {
      v.choice("bug", bug, {"deaf", "deaf_to_joints", "nowhere", "adrift", "crowd", "wall", "slips"}, "what is wrong");
    }
  };
  explicit PlantedSleep(const Params& params)
      : m_bug(params.bug),
        m_right(createStage<SleepPolicy<D>>(
            Spec::parse(m_bug == Bug::slips ? "split_average{wake_separation=1e6}" : "split_average"))) {}
  static AlgorithmInfo info() { return planted("sleep"); }

  void decide(const SleepInput<D>& in, std::span<std::uint8_t> awake, std::span<std::array<Real, 2>> memory) override {
    SleepInput<D> heard = in;
    std::vector<SleepEvent> events(in.events.begin(), in.events.end());
    const auto unheard = [](const SleepEvent& e) { return e.kind == SleepEvent::jointRemoved; };
    if (m_bug == Bug::deafToJoints) std::erase_if(events, unheard), heard.events = events;
    if (m_bug == Bug::deaf) heard.events = {};
    const std::vector<std::uint8_t> before(awake.begin(), awake.end());
    m_right->decide(heard, awake, memory);
    bool anybody = false;
    for (const Motion<D>& m : in.bodies.motion) anybody = anybody || m.v.norm() > Real(1.5);
    for (std::size_t i = 0; i < awake.size(); ++i) {
      if (!in.bodies.used[i] || in.bodies.type[i] != BodyType::dynamic) continue;
      const Real speed = in.bodies.motion[i].v.norm();
      if (m_bug == Bug::nowhere && speed < Real(1.5)) awake[i] = 0;
      if (m_bug == Bug::adrift && speed < Real(0.1) && i % 2 == 0) awake[i] = 0;
      if (m_bug == Bug::crowd && anybody) awake[i] = 1;
      if (m_bug == Bug::wall && !before[i]) awake[i] = 0;
    }
  }

 private:
  Bug m_bug;
  std::unique_ptr<SleepPolicy<D>> m_right;
};
LPC_REGISTER(SleepPolicy, PlantedSleep, 2, 3);

/// Forgets the last pair that it found.
template <int D>
class PlantedBroadphase final : public Broadphase<D> {
 public:
  using Params = NoParams;
  explicit PlantedBroadphase(const Params&) : m_right(createStage<Broadphase<D>>({"naive", {}})) {}
  static AlgorithmInfo info() { return planted("broadphase"); }

  void update(const Proxies<D>& proxies, const ProxyChanges& changes) override { m_right->update(proxies, changes); }
  void findPairs(const Proxies<D>& proxies, std::vector<ProxyPair>& out, WorkDone& work) override {
    m_right->findPairs(proxies, out, work);
    if (!out.empty()) out.pop_back();
  }

 private:
  std::unique_ptr<Broadphase<D>> m_right;
};
LPC_REGISTER(Broadphase, PlantedBroadphase, 2, 3);

/// Returns every manifold twice.
template <int D>
class PlantedContacts final : public ContactGenerator<D> {
 public:
  using Params = NoParams;
  explicit PlantedContacts(const Params&) : m_right(createStage<ContactGenerator<D>>({"sat_clip", {}})) {}
  static AlgorithmInfo info() { return planted("contacts"); }

  bool supports(ShapeKind a, ShapeKind b) const override { return m_right->supports(a, b); }
  void generate(const ContactInput<D>& in, std::vector<Manifold<D>>& fresh, WorkDone& work) override {
    m_right->generate(in, fresh, work);
    fresh.insert(fresh.end(), fresh.begin(), fresh.end());
  }

 private:
  std::unique_ptr<ContactGenerator<D>> m_right;
};
LPC_REGISTER(ContactGenerator, PlantedContacts, 2, 3);

/// No bug: distributes the points of each manifold over several children, as shapes with several parts do.
template <int D>
class PlantedParts final : public ContactGenerator<D> {
 public:
  using Params = NoParams;
  explicit PlantedParts(const Params&) : m_right(createStage<ContactGenerator<D>>({"sat_clip", {}})) {}
  static AlgorithmInfo info() { return planted("children"); }

  bool supports(ShapeKind a, ShapeKind b) const override { return m_right->supports(a, b); }
  void generate(const ContactInput<D>& in, std::vector<Manifold<D>>& fresh, WorkDone& work) override {
    m_whole.clear();
    m_right->generate(in, m_whole, work);
    for (const Manifold<D>& whole : m_whole) {
      for (int i = 0; i < whole.count; ++i) {
        Manifold<D> m = whole;
        m.count = 1, m.points = {whole.points[static_cast<std::size_t>(i)]};
        m.partA = i / 2, m.partB = i % 2;
        fresh.push_back(m);
      }
    }
  }

 private:
  std::unique_ptr<ContactGenerator<D>> m_right;
  std::vector<Manifold<D>> m_whole;
};
LPC_REGISTER(ContactGenerator, PlantedParts, 2, 3);

/// persistent_manifold with points of its own instead of the world's: they are not saved.
template <int D>
class PlantedKeeper final : public ContactGenerator<D> {
 public:
  using Params = NoParams;
  explicit PlantedKeeper(const Params&) : m_right(createStage<ContactGenerator<D>>({"persistent_manifold", {}})) {}
  static AlgorithmInfo info() { return planted("keeper"); }

  bool supports(ShapeKind a, ShapeKind b) const override { return m_right->supports(a, b); }
  void generate(const ContactInput<D>& in, std::vector<Manifold<D>>& fresh, WorkDone& work) override {
    ContactInput<D> own = in;
    own.old = m_old;
    m_right->generate(own, fresh, work);
    m_old = fresh;
    std::sort(m_old.begin(), m_old.end(), [](const auto& a, const auto& b) { return a.key() < b.key(); });
  }

 private:
  std::unique_ptr<ContactGenerator<D>> m_right;
  std::vector<Manifold<D>> m_old;
};
LPC_REGISTER(ContactGenerator, PlantedKeeper, 2, 3);

}}}  // namespace lpc::LPC_PRECISION::test
