// SPDX-License-Identifier: Zlib
// Runs a scene and writes down, step by step, what physics says about it.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <nlohmann/json.hpp>

#include "experiments/trial/output_file.h"
#include "experiments/trial/scene_file.h"
#include "experiments/trial/trial.h"
#include "framework/director.h"
#include "framework/invariants.h"
#include "framework/pose_penetration.h"
#include "framework/recording.h"
#include "framework/stage_engine.h"
#include "framework/world.h"

namespace lpc::inline LPC_PRECISION {
namespace {

using nlohmann::json;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
// Not counted in times: caches are cold and vectors grow.
constexpr long kWarmUp = 10;
constexpr long kPoseEvery = 60;
// The exact query of all pairs costs more than a step of a small scene: it is asked now and then.
constexpr long kPenetrationEvery = 10;
constexpr double kPoseBytes = 1e6;
// No body of any scene is meant to be faster than light: a run that gets there ends, also without a limit of its own.
constexpr double kLightSpeed = 299792458;  // m/s

std::string underscored(std::string name) {
  std::replace(name.begin(), name.end(), '.', '_');
  return name;
}

template <int D>
std::unique_ptr<Simulation<D>> simulationOf(const json& trial, const WorldSettings<D>& settings) {
  const std::string pipeline = trial.at("pipeline");
  if (const auto engine = engineOf(pipeline)) return createStage<Engine<D>>(*engine)->start(settings);
  return std::make_unique<World<D>>(Pipeline::parse(pipeline), settings);
}

template <int D>
class WorldTrial {
 public:
  WorldTrial(const json& request, SceneSpec<D> scene)
      : m_request(request),
        m_timed(request.at("trial").value("timed", false)),
        m_engine(request.at("trial").contains("engine")),
        m_scene(scene),
        m_director(std::move(scene)),
        m_simulation(simulationOf(request.at("trial"), m_scene.settings)),
        m_world(*m_simulation) {
    const auto open = [&](const char* name, std::unique_ptr<OutputFile>& file) {
      if (request.contains(name)) file = std::make_unique<OutputFile>(request.at(name).template get<std::string>());
    };
    open("record", m_recording), open("profile", m_profile);
    m_world.profiler().keepFrames(m_profile != nullptr);
  }

  TrialResult run() {
    std::unique_ptr<Recorder<D>> recorder;
    if (m_recording) recorder = std::make_unique<Recorder<D>>(m_recording->stream());
    const auto record = [&] {
      if (recorder) recorder->frame(m_world), m_recording->check();
    };
    m_director.advance(m_world);
    start();
    keepPoses(0);
    record();
    long step = 0;
    for (; step < m_scene.steps && m_out.outcome == "ok"; ++step) {
      if (step > 0) m_director.advance(m_world);
      const double before = cpuSeconds();
      m_world.step(m_scene.dt);
      const double seconds = cpuSeconds() - before;
      observe(step, seconds);
      if ((step + 1) % m_poseEvery == 0 && step + 1 < m_scene.steps) keepPoses(step + 1);
      record();
      if (m_request.value("progress", false) && (step + 1) % 500 == 0) {
        std::fprintf(stderr, "step %ld of %ld, %d bodies\n", step + 1, m_scene.steps, m_world.bodyCount());
      }
    }
    if (step > 0) keepPoses(step);
    finish(step);
    if (m_profile) m_world.profiler().writeCsv(m_profile->stream()), m_profile->check();  // both files or none
    for (const auto& file : {m_recording.get(), m_profile.get()}) {
      if (file) file->finish();
    }
    return std::move(m_out);
  }

 private:
  void start() {
    const Invariants<D> now = invariants(m_world);
    m_out.metrics["energy_start"] = now.kinetic + now.potential;
    m_energyMax = now.kinetic + now.potential;
    m_momentum = now.momentum;
    // In a room with walls momentum comes and goes; alone in space it must stay.
    m_momentumMatters = m_scene.settings.gravity.norm() == 0 && m_scene.springs.empty();
    Real highest = -std::numeric_limits<Real>::infinity();
    for (std::size_t i = 0; i < m_scene.spawns.size(); ++i) {
      const auto& spawn = m_scene.spawns[i];
      const bool dynamic = spawn.body.type == BodyType::dynamic;
      if (!dynamic || spawn.body.pinned || spawn.step > 0) m_momentumMatters = false;
      if (!dynamic) continue;
      m_dynamic.push_back(static_cast<int>(i));
      if (spawn.step == 0 && spawn.body.X_WB.p[1] > highest) {
        highest = spawn.body.X_WB.p[1];
        m_top = static_cast<int>(i);
      }
    }
    const double bytes = static_cast<double>(m_scene.spawns.size()) * 8 * (D == 2 ? 4 : 8);
    while (bytes * static_cast<double>(m_scene.steps) / static_cast<double>(m_poseEvery) > kPoseBytes &&
           m_poseEvery < m_scene.steps) {
      m_poseEvery *= 2;
    }
  }

  void put(const std::string& name, double value) { m_out.series[name].push_back(value); }

  void observe(long step, double seconds) {
    const Invariants<D> now = invariants(m_world);
    const Profiler::Frame& frame = m_world.profiler().frame();
    double drift = 0, height = -std::numeric_limits<double>::infinity();
    int last = -1, farthest = -1;
    m_topDrift = kNan;
    for (int i : m_dynamic) {
      const Handle h = m_director.body(i);
      if (!m_world.valid(h)) continue;
      const Vec<D> p = m_world.pose(h).p;
      const double moved = (p - m_scene.spawns[static_cast<std::size_t>(i)].body.X_WB.p).norm();
      if (moved > drift) drift = moved, farthest = i;
      height = std::max<double>(height, p[1]);
      if (i == m_top) m_topDrift = moved;
      last = i;
    }
    if (now.finite && ((step + 1) % kPenetrationEvery == 0 || step + 1 == m_scene.steps)) {
      const auto depths = m_penetration.of(m_world);
      m_deepest = std::max(m_deepest, depths.max), m_meanDepth = depths.mean;
    }
    const double energy = now.kinetic + now.potential;
    m_energyMax = std::max(m_energyMax, energy);
    put("kinetic", now.kinetic), put("potential", now.potential), put("max_speed", now.maxSpeed);
    put("max_penetration", now.maxPenetration), put("mean_penetration", now.meanPenetration);
    put("complementarity", now.signorini), put("cone_excess", now.coulomb);
    put("joint_error", now.jointError), put("drift", drift), put("height", std::isinf(height) ? kNan : height);
    put("pairs", frame.pairs), put("points", frame.points), put("bodies", frame.bodies), put("awake", frame.awake);
    if (last >= 0) {
      const Pose<D> pose = m_world.pose(m_director.body(last));
      put("x_last", pose.p[0]), put("y_last", pose.p[1]);
      m_lastMoved = (pose.p - m_scene.spawns[static_cast<std::size_t>(last)].body.X_WB.p).norm();
    } else {
      put("x_last", kNan), put("y_last", kNan);
    }
    if (m_timed) {
      put("seconds", seconds);
      for (const Profiler::Time& t : frame.times) {
        auto& list = m_out.series["sec_" + underscored(t.name)];
        list.resize(static_cast<std::size_t>(step), 0.0);  // a stage may come late
        list.push_back(t.seconds);
      }
    }
    for (std::size_t i = 0; i < m_work.counts.size(); ++i) m_work.counts[i] += frame.work.counts[i];
    m_last = now;
    judge(step, now, energy, drift, farthest);
  }

  void judge(long step, const Invariants<D>& now, double energy, double drift, int farthest) {
    const auto& limits = m_scene.limits;
    const double start = m_out.metrics["energy_start"];
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
    } else if (limits.drift > 0 && drift > static_cast<double>(limits.drift)) {
      std::snprintf(why, sizeof why, "body %d is %.4g m from where it came, over %.4g m", farthest, drift,
                    static_cast<double>(limits.drift));
      m_out.fail("collapsed", why, step + 1);
    }
  }

  // slot, position, rotation (angle, or quaternion w x y z) of every body
  void keepPoses(long step) {
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
    auto& m = m_out.metrics;
    const auto largest = [&](const char* name) {
      double x = 0;
      for (double v : m_out.series[name]) x = std::isnan(v) ? v : std::max(x, v);
      return x;
    };
    const auto end = [&](const char* name) {
      const auto& list = m_out.series[name];
      return list.empty() ? 0.0 : list.back();
    };
    m["steps_done"] = static_cast<double>(steps);
    m["bodies"] = largest("bodies"), m["contacts_end"] = end("points");
    m["max_penetration"] = largest("max_penetration"), m["mean_penetration_end"] = end("mean_penetration");
    m["penetration_poses"] = m_deepest, m["mean_penetration_poses_end"] = m_meanDepth;
    m["max_drift"] = largest("drift"), m["end_drift_max"] = end("drift"), m["end_drift_top"] = m_topDrift;
    m["energy_end"] = end("kinetic") + end("potential"), m["energy_max"] = m_energyMax;
    m["max_speed"] = largest("max_speed"), m["max_speed_end"] = end("max_speed");
    m["complementarity_max"] = largest("complementarity"), m["cone_excess_max"] = largest("cone_excess");
    m["joint_error_max"] = largest("joint_error"), m["slope_distance"] = m_lastMoved;
    m["momentum_error"] = m_momentumMatters && steps > 0 ? (m_last.momentum - m_momentum).norm() : kNan;
    for (std::size_t i = 0; i < m_work.counts.size(); ++i) {
      m["work_" + std::string(kCountNames[i])] =
          m_engine ? kNan
          : steps  ? static_cast<double>(m_work.counts[i]) / static_cast<double>(steps)
                   : 0;
    }
    if (m_timed) {
      const auto timesOf = [&](const std::string& name) {
        const auto& list = m_out.series[name];
        return std::vector<double>(list.begin() + std::min<long>(kWarmUp, static_cast<long>(list.size())), list.end());
      };
      for (auto& [name, list] : m_out.series) {
        if (name.starts_with("sec_")) list.resize(static_cast<std::size_t>(steps), 0.0);
      }
      m["ms_per_step_median"] = 1e3 * quantile(timesOf("seconds"), 0.5);
      m["ms_per_step_p25"] = 1e3 * quantile(timesOf("seconds"), 0.25);
      m["ms_per_step_p75"] = 1e3 * quantile(timesOf("seconds"), 0.75);
      for (const auto& [name, list] : m_out.series) {
        if (name.starts_with("sec_")) m["us_" + name.substr(4)] = 1e6 * quantile(timesOf(name), 0.5);
      }
    }
    char text[20];
    std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(m_world.hash()));
    m_out.hash = text;
  }

  const json& m_request;
  bool m_timed, m_engine;  // an engine does not count its work
  SceneSpec<D> m_scene;
  Director<D> m_director;
  std::unique_ptr<Simulation<D>> m_simulation;
  Simulation<D>& m_world;
  PosePenetration<D> m_penetration;
  std::unique_ptr<OutputFile> m_recording, m_profile;
  TrialResult m_out;
  std::vector<int> m_dynamic;
  int m_top = -1;
  long m_poseEvery = kPoseEvery;
  double m_energyMax = 0, m_topDrift = kNan, m_lastMoved = kNan;
  double m_deepest = 0, m_meanDepth = 0;  // on poses, m
  bool m_momentumMatters = false;
  Eigen::Matrix<double, D, 1> m_momentum = Eigen::Matrix<double, D, 1>::Zero();
  Invariants<D> m_last;
  Work m_work;
};

template <int D>
TrialResult runWorld(const json& request) {
  const json& t = request.at("trial");
  const SceneFile file = SceneFile::load(request.at("scene_file").get<std::string>());
  SceneSpec<D> scene = file.build<D>(t.at("params").get<ParameterValues>(), t.at("seed").get<std::uint64_t>());
  scene.dt = static_cast<Real>(t.at("dt").get<double>());
  scene.steps = t.at("steps").get<long>();
  scene.settings.features = featuresFromText(t.at("features").get<std::string>());
  try {
    return WorldTrial<D>(request, std::move(scene)).run();
  } catch (const CannotWrite&) {
    throw;
  } catch (const UserError& e) {
    // The scene was read before: what is wrong now is this pipeline with this scene.
    TrialResult out;
    out.fail("unsupported", e.what(), 0);
    return out;
  }
}

}  // namespace

TrialResult runWorldTrial(const json& request) {
  return request.at("trial").at("dimension").get<int>() == 2 ? runWorld<2>(request) : runWorld<3>(request);
}

}  // namespace lpc::inline LPC_PRECISION
