// SPDX-License-Identifier: Zlib
// Runs a scene and records, step by step, its physical quantities.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <deque>
#include <limits>
#include <utility>

#include "experiments/trial/formats/output_file.h"
#include "experiments/trial/measure/control.h"
#include "experiments/trial/measure/edge.h"
#include "experiments/trial/measure/ghost_hits.h"
#include "experiments/trial/measure/memory_counter.h"
#include "experiments/trial/measure/tunnelling.h"
#include "experiments/trial/measure/world_metrics.h"
#include "experiments/trial/scene/saved_scene.h"
#include "experiments/trial/scene/scene_event.h"
#include "experiments/trial/scene/scene_file.h"
#include "experiments/trial/scene/simulation_of_scene.h"
#include "experiments/trial/trial.h"
#include "framework/math/worse.h"
#include "framework/problem/contact_problem.h"
#include "framework/scene/director.h"
#include "framework/scene/recording.h"
#include "framework/scene/trajectory.h"
#include "framework/stage/spec.h"
#include "framework/world/pose_penetration.h"
#include "framework/world/world.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr long kPoseEvery = 60;
// The exact query of all pairs costs more than a step of a small scene, so it runs only now and then.
constexpr long kPenetrationEvery = 10;
constexpr double kPoseBytes = 1e6;
// A scene at rest settles by this time, or by the end of its file's steps (s).
constexpr double kAtRest = 2;
constexpr double kSameTime = 1e-5;  // f32 has rounded dt
// No scene has bodies faster than light: such a run ends, also without a limit of its own.
constexpr double kLightSpeed = 299792458;  // m/s

std::string underscored(std::string name) {
  std::replace(name.begin(), name.end(), '.', '_');
  return name;
}

// "split_solver catto split_impulse", or the engine: the title of a recording.
std::string resolverOf(const std::string& pipeline) {
  if (const auto engine = engineOf(pipeline)) return engine->name;
  const Spec solver = Pipeline::parse(pipeline)[StageKind::solver];
  std::string out = solver.name;
  for (const char* part : {"velocity", "position"}) {
    if (const Spec* resolver = solver.find(part)) out += " " + resolver->name;
  }
  return out;
}

// The velocity problem of a step, and its residual.
template <int D>
class Residual final : public VelocityWatcher<D> {
 public:
  void see(const VelocityInput<D>& in) override {
    m_problem.set(in);
    m_problem.freeVelocities(in, m_free);
    m_manifolds = in.manifolds, m_joints = in.joints;
    m_seen = true;
  }
  /// m/s, of the last step; NaN if its solver exposed no problem.
  double take() {
    if (!std::exchange(m_seen, false)) return kNan;
    m_problem.impulses(m_manifolds, m_joints, m_impulses);
    return m_problem.naturalMap(m_impulses, m_free).natural;
  }

 private:
  ContactProblem<D> m_problem;
  std::vector<double> m_free, m_impulses;
  std::span<Manifold<D>> m_manifolds;
  std::span<JointRecord<D>> m_joints;
  bool m_seen = false;
};

template <int D>
class WorldTrial {
 public:
  /// After `restsAfter` s a scene that should rest is at rest; a run that ends earlier is not judged by that.
  WorldTrial(const TrialRequest& request, SceneSpec<D> scene, double restsAfter, MemoryCounter memory)
      : m_asked(request.world()),
        m_progress(request.progress),
        m_restsAfter(restsAfter),
        m_memory(memory),
        m_timed(m_asked.timed),
        m_again(m_timed && m_asked.repeat > 0),
        m_scene(scene),
        m_director(std::move(scene)),
        m_world(makeWorld()) {
    const auto open = [&](const std::string& path, std::unique_ptr<OutputFile>& file) {
      if (!path.empty()) file = std::make_unique<OutputFile>(path);
    };
    // Not in timed trials: observing takes time within the step.
    if (auto* world = dynamic_cast<World<D>*>(m_simulation.get()); world && !m_timed) world->watch(&m_residual);
    open(request.record, m_recording), open(request.profile, m_profile), open(request.trajectory, m_trajectory);
    m_asJson = request.trajectory.ends_with(".json");
    for (const SaveRequest& s : request.saves) m_saves.emplace_back(s.step, s.scene);
    m_world.profiler().keepFrames(m_profile != nullptr);
    if (m_memory) m_world.profiler().countMemory(m_memory);
  }

  TrialResult run() {
    std::unique_ptr<Recorder<D>> recorder;
    if (m_recording) recorder = std::make_unique<Recorder<D>>(m_recording->stream(), resolverOf(m_asked.pipeline));
    std::unique_ptr<TrajectoryWriter<D>> rows;
    if (m_trajectory) {
      const auto format = m_asJson ? TrajectoryFormat::asJson : TrajectoryFormat::asCsv;
      rows = std::make_unique<TrajectoryWriter<D>>(m_trajectory->stream(), format);
    }
    const auto record = [&] {
      if (recorder) recorder->frame(m_world), m_recording->check();
      if (rows) rows->frame(m_world), m_trajectory->check();
    };
    direct(0);
    start();
    keepPoses(0);
    record();
    save(0);
    long step = 0;
    for (; step < m_scene.steps && m_out.outcome == "ok"; ++step) {
      if (step > 0) direct(step);
      if (m_out.outcome != "ok") break;
      if (!m_again) m_tunnelling.place(m_world), m_ghosts.before(m_world);
      const double before = cpuSeconds();
      m_world.step(m_scene.dt);
      const double seconds = cpuSeconds() - before;
      observe(step, seconds);
      if ((step + 1) % m_poseEvery == 0 && step + 1 < m_scene.steps) keepPoses(step + 1);
      record();
      save(step + 1);
      if (m_progress && (step + 1) % 500 == 0) {
        std::fprintf(stderr, "step %ld of %ld, %d bodies\n", step + 1, m_scene.steps, m_world.bodyCount());
      }
    }
    if (step > 0) keepPoses(step);
    finish(step);
    if (m_profile) m_world.profiler().writeCsv(m_profile->stream()), m_profile->check();  // both files or none
    if (rows) rows->finish(), m_trajectory->check();
    for (const auto& file : {m_recording.get(), m_profile.get(), m_trajectory.get()}) {
      if (file) file->finish();
    }
    for (SavedScene& s : m_saves) s.finish();
    return std::move(m_out);
  }

 private:
  MemoryUse memoryNow() const { return m_memory ? m_memory() : MemoryUse{}; }

  void addMemory(const char* scope, const MemoryUse& use, long step) {
    if (!m_memory) return;
    auto it = std::find_if(m_out.memory.begin(), m_out.memory.end(), [&](const auto& m) { return m.scope == scope; });
    if (it == m_out.memory.end()) it = m_out.memory.insert(it, {scope, {}});
    it->use += use;
    if (use.allocations > 0) it->lastStep = step;
  }

  Simulation<D>& makeWorld() {
    const MemoryUse before = memoryNow();
    m_simulation = simulationOf(m_asked.pipeline, m_scene);
    addMemory("scene", memoryNow() - before, 0);
    return *m_simulation;
  }

  // Runs the script's actions after this number of steps: memory that no step uses.
  void direct(long step) {
    const MemoryUse before = memoryNow();
    try {
      m_director.advance(m_world);
    } catch (const EventOverflow& e) {
      m_out.fail("diverged", e.what(), step);
    }
    addMemory("scene", memoryNow() - before, step);
  }

  // Saves the world after this number of steps, before the script's next actions.
  void save(long step) {
    for (SavedScene& s : m_saves) {
      const auto* world = dynamic_cast<const World<D>*>(m_simulation.get());
      if (!world) throw UserError("the state of an engine cannot be saved; valid: a pipeline of LPC's stages");
      if (s.step() == step) s.write(*world, m_scene, m_asked.pipeline);
    }
  }

  void start() {
    m_seen.timed = m_timed;
    if (const double every = m_asked.posesEvery; every > 0) {
      m_poseEvery = std::max(1L, std::lround(std::min(every / double(m_scene.dt), 1e15)));
    }
    if (m_again) m_seen.deepest = m_seen.meanDepth = kNan;
    m_seen.start = stateInvariants(m_world);
    m_seen.energyMax = m_seen.start.kinetic + m_seen.start.potential;
    m_seen.startDepth = m_again || !std::isfinite(m_seen.energyMax) ? kNan : m_penetration.of(m_world).max;
    // In a room with walls momentum changes; alone in space it is conserved.
    m_seen.isolated = m_scene.settings.gravity.norm() == 0 && m_scene.forces.empty() && m_scene.events.empty();
    for (const ForceRecord<D>& f : m_world.forces()) m_seen.isolated = m_seen.isolated && !f.kind;
    for (const JointRecord<D>& j : m_world.joints()) m_seen.isolated = m_seen.isolated && (!j.kind || j.bodyA >= 0);
    Real highest = -std::numeric_limits<Real>::infinity();
    for (std::size_t i = 0; i < m_scene.spawns.size(); ++i) {
      const auto& spawn = m_scene.spawns[i];
      const bool dynamic = spawn.body.type == BodyType::dynamic;
      if (!dynamic || spawn.body.pinned || spawn.step > 0) m_seen.isolated = false;
      if (!dynamic || spawn.part) continue;  // the initial position of a part is unknown
      m_dynamic.push_back(static_cast<int>(i));
      if (spawn.step == 0 && spawn.body.X_WB.p[1] > highest) {
        highest = spawn.body.X_WB.p[1];
        m_top = static_cast<int>(i);
      }
    }
    std::vector<std::int32_t> here;
    for (const int i : m_dynamic) {
      if (m_world.valid(m_director.body(i))) here.push_back(m_director.body(i).slot);
    }
    m_seen.settling.start(m_world, std::move(here));
    if (!m_scene.limits.mayLeave) m_edge.start(m_world);
    const double bytes = static_cast<double>(m_scene.spawns.size()) * 8 * (D == 2 ? 4 : 8);
    while (bytes * static_cast<double>(m_scene.steps) / static_cast<double>(m_poseEvery) > kPoseBytes &&
           m_poseEvery < m_scene.steps) {
      m_poseEvery *= 2;
    }
  }

  /// m from the initial position of spawn i; NaN if it does not exist.
  double moved(int i) const {
    const BodyHandle h = m_director.body(i);
    if (!m_world.valid(h)) return kNan;
    return (m_world.pose(h).p - m_scene.spawns[static_cast<std::size_t>(i)].body.X_WB.p).norm();
  }

  void observe(long step, double seconds) {
    m_seen.now = invariants(m_world), m_seen.frame = m_world.profiler().frame(), m_seen.seconds = seconds;
    m_seen.steps = step + 1;
    m_seen.drift = 0, m_seen.height = kNan;
    int farthest = -1;
    for (int i : m_dynamic) {
      if (!m_world.valid(m_director.body(i))) continue;
      const double way = moved(i);
      if (way > m_seen.drift || std::isnan(way)) m_seen.drift = way, farthest = i;
      if (!std::isnan(way)) m_seen.height = std::fmax(m_seen.height, m_world.pose(m_director.body(i)).p[1]);
    }
    m_seen.weight = 0;
    const Bodies<D>& b = m_world.bodies();
    for (std::size_t i = 0; i < b.mass.size(); ++i) {
      if (b.used[i] && b.type[i] == BodyType::dynamic) m_seen.weight += double(b.mass[i]);
    }
    m_seen.topDrift = m_top < 0 ? kNan : moved(m_top);
    m_seen.naturalMap = m_residual.take();
    m_seen.settling.observe(m_world, m_scene.dt);
    m_seen.slid = m_scene.slope ? moved(m_scene.slope->body) : kNan;
    const double energy = m_seen.now.kinetic + m_seen.now.potential;
    m_seen.energyMax = worse(m_seen.energyMax, energy);
    if (!m_again) m_tunnelling.observe(m_world), m_ghosts.observe(m_world, double(m_scene.dt));
    m_seen.lostTime += m_seen.frame.lostTime;
    m_seen.depth = kNan;
    if (!m_again && m_seen.now.finite && ((step + 1) % kPenetrationEvery == 0 || step + 1 == m_scene.steps)) {
      const auto depths = m_penetration.of(m_world);
      m_seen.depth = depths.max, m_seen.meanDepth = depths.mean;
      m_seen.deepest = worse(m_seen.deepest, depths.max);
    }
    putSeries(m_seen);
    if (m_memory) {
      for (const Profiler::Time& t : m_seen.frame.times) addMemory(t.name, t.memory, step + 1);
      addMemory("elsewhere", m_seen.frame.elsewhere, step + 1);
    }
    if (m_timed) {
      for (const Profiler::Time& t : m_seen.frame.times) {
        auto& list = m_seen.series["sec_" + underscored(t.name)];
        list.resize(static_cast<std::size_t>(step), 0.0);  // a stage may appear late
        list.push_back(t.seconds);
      }
    }
    for (std::size_t i = 0; i < m_work.counts.size(); ++i) m_work.counts[i] += m_seen.frame.work.counts[i];
    judge(step, m_seen.now, energy, m_seen.drift, farthest);
  }

  void judge(long step, const Invariants<D>& now, double energy, double drift, int farthest) {
    const auto& limits = m_scene.limits;
    const double start = m_seen.start.kinetic + m_seen.start.potential;
    char why[160];
    if (!now.finite) {
      m_out.fail("diverged", "nan", step + 1);
    } else if (limits.energy > 0 && start > 1e-6 && energy > static_cast<double>(limits.energy) * start) {
      std::snprintf(why, sizeof why, "energy %.4g J is over %.3g times the start's %.4g J", energy,
                    static_cast<double>(limits.energy), start);
      m_out.fail("diverged", why, step + 1);
    } else if (const double limit = limits.speed > 0 ? static_cast<double>(limits.speed) : kLightSpeed;
               now.maxSpeed > limit) {
      std::snprintf(why, sizeof why, "speed %.4g m/s is over %.4g m/s", now.maxSpeed, limit);
      m_out.fail("exploded", why, step + 1);
    } else if (const std::string left = m_edge.left(m_world); !left.empty()) {
      m_out.fail("left", left, step + 1);
    } else if (limits.drift > 0 && drift > static_cast<double>(limits.drift) && !onlySags()) {
      std::snprintf(why, sizeof why, "body %d is %.4g m from where it entered the world, over %.4g m", farthest, drift,
                    static_cast<double>(limits.drift));
      m_out.fail("collapsed", why, step + 1);
    }
  }

  bool onlySags() const {
    const auto limit = static_cast<double>(m_scene.limits.drift);
    const Settling<D>& s = m_seen.settling;
    return s.lateral <= limit && s.rise <= limit && s.stands(m_world);
  }

  // Number of dynamic bodies with the centre inside the shape of a fixed one.
  double fellThrough() const {
    const Bodies<D>& b = m_world.bodies();
    std::vector<std::pair<ShapeView<D>, Pose<D>>> fixed;
    for (const ShapeRecord<D>& s : m_world.shapes()) {
      if (s.body < 0 || b.type[static_cast<std::size_t>(s.body)] != BodyType::fixed) continue;
      forParts(s.shape, b.pose[static_cast<std::size_t>(s.body)] * s.X_CS,
               [&](const ShapeView<D>& part, const Pose<D>& X_WP) { fixed.emplace_back(part, X_WP); });
    }
    double count = 0;
    for (std::size_t i = 0; i < b.pose.size(); ++i) {
      if (!b.used[i] || b.type[i] != BodyType::dynamic || !b.pose[i].p.allFinite()) continue;
      count += std::any_of(fixed.begin(), fixed.end(),
                           [&](const auto& f) { return containsPoint(f.first, f.second, b.pose[i].p); });
    }
    return count;
  }

  // slot, position, rotation (angle, or quaternion w x y z) of every body
  void keepPoses(long step) {
    if (m_again) return;
    std::vector<double>& data = m_out.poses[step];
    const Bodies<D>& b = m_world.bodies();
    for (std::size_t i = 0; i < b.pose.size(); ++i) {
      if (!b.used[i]) continue;
      data.push_back(static_cast<double>(i));
      for (int d = 0; d < D; ++d) data.push_back(b.pose[i].p[d]);
      putRotation(data, b.pose[i].q);
    }
  }
  static void putRotation(std::vector<double>& data, const Rot<2>& q) { data.push_back(q.radians()); }
  static void putRotation(std::vector<double>& data, const Rot<3>& q) {
    for (Real x : {q.w, q.x, q.y, q.z}) data.push_back(x);
  }

  void finish(long steps) {
    m_seen.supportsChanged = static_cast<double>(m_seen.settling.supportsChanged(m_world).value_or(-1));
    if (m_seen.supportsChanged < 0) m_seen.supportsChanged = kNan;
    m_seen.fellThrough = fellThrough();
    m_tunnelling.finish(m_world);
    m_seen.tunnelled = m_again ? kNan : m_tunnelling.count();
    m_seen.ghostHits = m_again ? kNan : m_ghosts.count();
    if (m_asked.ofEngine()) m_seen.lostTime = kNan;
    if (const double limit = m_scene.limits.creep;
        limit > 0 && m_out.outcome == "ok" && m_seen.settling.creep() > limit) {
      char why[160];
      std::snprintf(why, sizeof why, "at the end a body moves by %.4g m in a second, over %.4g m",
                    m_seen.settling.creep(), limit);
      m_out.fail("collapsed", why, steps);
    }
    if (m_scene.limits.levels > 0 && steps > 0) judgeRest(steps);
    m_out.metrics = worldMetrics(m_seen);
    auto& m = m_out.metrics;
    for (std::size_t i = 0; i < m_work.counts.size(); ++i) {
      m["work_" + std::string(kCountNames[i])] =
          m_asked.ofEngine() ? kNan
          : steps            ? static_cast<double>(m_work.counts[i]) / static_cast<double>(steps)
                             : 0;
    }
    for (auto& [name, list] : m_seen.series) {
      if (!name.starts_with("sec_")) continue;
      list.resize(static_cast<std::size_t>(steps), 0.0);
      m["us_" + name.substr(4)] = 1e6 * m_seen.quantileOf(name, 0.5);
    }
    if (m_asked.series) {
      if (m_again) std::erase_if(m_seen.series, [](const auto& entry) { return entry.first != "seconds"; });
      m_out.series = std::move(m_seen.series);
    }
    char text[20];
    std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(m_world.hash()));
    m_out.hash = text;
  }

  void judgeRest(long steps) {
    Rest& rest = m_seen.rest;
    rest.size = smallestBody(m_world);
    rest.levels = double(m_scene.limits.levels), rest.fall = double(m_scene.limits.fall);
    rest.sag = m_seen.settling.sag, rest.sinking = m_seen.settling.sinking();
    // A repeat measures only here, since its outcome is that of the first run.
    rest.depth = m_seen.now.finite ? m_penetration.of(m_world).max : kNan;
    const double time = static_cast<double>(steps) * double(m_scene.dt);
    if (m_out.outcome != "ok" || time < m_restsAfter * (1 - kSameTime)) return;
    if (!(rest.share() <= kRestShare)) return m_out.fail("sank", rest.reason(), steps);
    const typename SceneSpec<D>::Spawn* far = nullptr;
    for (const int i : m_dynamic) {
      const auto& spawn = m_scene.spawns[static_cast<std::size_t>(i)];
      if (!far || spawn.body.X_WB.p.norm() > far->body.X_WB.p.norm()) far = &spawn;
    }
    if (!far || m_scene.settings.gravity.norm() == 0) return;
    const Control control = dropAlone(m_asked.pipeline, m_scene, far->body);
    if (!control.falls()) m_out.fail("frozen", control.reason(), steps);
  }

  const WorldRequest& m_asked;
  bool m_progress;
  double m_restsAfter;
  MemoryCounter m_memory;
  TrialResult m_out;
  bool m_timed;
  bool m_again;  // a repeat of a timed trial: its bits are those of the first, so it reports only times
  SceneSpec<D> m_scene;
  Director<D> m_director;
  std::unique_ptr<Simulation<D>> m_simulation;
  Simulation<D>& m_world;
  PosePenetration<D> m_penetration;
  Tunnelling<D> m_tunnelling;
  Edge<D> m_edge;
  GhostHits<D> m_ghosts;
  Residual<D> m_residual;
  std::unique_ptr<OutputFile> m_recording, m_profile, m_trajectory;
  bool m_asJson = false;  // the trajectory's format
  std::deque<SavedScene> m_saves;
  std::vector<int> m_dynamic;
  int m_top = -1;
  long m_poseEvery = kPoseEvery;
  WorldSeen<D> m_seen{m_scene};
  WorkDone m_work;
};

template <int D>
TrialResult runWorld(const TrialRequest& request) {
  const WorldRequest& asked = request.world();
  const SceneFile file = SceneFile::load(request.sceneFile, request.scriptFile);
  SceneSpec<D> scene = file.build<D>(asked.params, asked.seed);
  const double restsAfter = std::min(kAtRest, static_cast<double>(scene.steps) * double(scene.dt));
  scene.dt = static_cast<Real>(asked.dt);
  scene.steps = asked.steps;
  scene.settings.model = modelFromText(asked.features);
  MemoryCounter memory = nullptr;
  if (request.memory) {
    memory = memoryCounter();
    if (!memory)
      throw UserError(
          "--memory: this build has sanitizers, which allocate uncounted memory; valid: a build without sanitizers");
  }
  try {
    return WorldTrial<D>(request, std::move(scene), restsAfter, memory).run();
  } catch (const CannotWrite&) {
    throw;
  } catch (const UserError& e) {
    // The scene was read before: an error now belongs to this pipeline with this scene.
    TrialResult out;
    out.fail("unsupported", e.what(), 0);
    return out;
  }
}

}  // namespace

TrialResult runWorldTrial(const TrialRequest& request) {
  return request.world().dimension == 2 ? runWorld<2>(request) : runWorld<3>(request);
}

}}  // namespace lpc::LPC_PRECISION
