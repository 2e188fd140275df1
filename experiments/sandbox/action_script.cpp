// SPDX-License-Identifier: Zlib
#include "experiments/sandbox/action_script.h"

#include <algorithm>

#include "experiments/trial/scene/script_writer.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

template <int D>
class ActionWriter {
 public:
  ActionWriter(const SceneSpec<D>& scene, std::string byHand) : m_scene(scene), m_prefix(std::move(byHand)) {}

  void write(const Action<D>& action) {
    m_step = action.step;
    std::visit(*this, action.what);
  }
  const ScriptWriter<D>& out() const { return m_out; }

  void operator()(const AddBody<D>& d) { m_out.add(m_step, byHand(m_byHand++), d.def); }
  void operator()(const RemoveBody& d) { m_out.remove(m_step, name(d.body)); }
  void operator()(const PushBody<D>& d) { m_out.push(m_step, name(d.body), {d.impulse, d.angular}); }
  void operator()(const PullBody<D>& d) { m_out.pull(m_step, name(d.body), d.force, d.at); }
  void operator()(const SetBody<D>& d) {
    m_out.set(m_step, name(d.body), {d.position, d.rotation, d.velocity, d.angularVelocity});
  }
  void operator()(const JoinBodies<D>& d) {
    const auto end = [&](int body) { return body < 0 ? std::string("world") : name(body); };
    m_out.joint(m_step, m_prefix + "_joint_" + std::to_string(m_joints++), d.def, end(d.bodyA), end(d.bodyB));
  }
  void operator()(const MergeBodies& d) { m_out.merge(m_step, name(d.into), name(d.other)); }
  void operator()(const SplitByShape& d) {
    std::vector<std::string> names = {m_prefix + "_whole_" + std::to_string(m_wholes++)};
    for (int i = 1; i < d.shapes; ++i) names.push_back(byHand(m_byHand++));
    m_out.splitByShape(m_step, name(d.body), names);
  }
  void operator()(const WakeBodies& d) { d.body < 0 ? m_out.wakeAll(m_step) : m_out.wake(m_step, name(d.body)); }
  void operator()(const SetGravity<D>& d) { m_out.gravity(m_step, d.gravity); }
  void operator()(const ChangeBody& d) {
    if (d.friction || d.restitution || d.density) {
      m_out.material(m_step, name(d.body), {d.friction, d.restitution, d.density});
    }
    if (d.pinned) m_out.pin(m_step, name(d.body), *d.pinned);
    if (d.type) m_out.type(m_step, name(d.body), *d.type);
  }
  void operator()(const SetPipeline& d) {
    if (d.competitor == 0) m_out.setPipeline(m_step, Pipeline::parse(d.pipeline));
  }

 private:
  std::string byHand(std::size_t i) const { return m_prefix + "_" + std::to_string(i); }
  std::string name(int body) const {
    const auto i = static_cast<std::size_t>(body);
    return i < m_scene.spawns.size() ? m_scene.spawns[i].called : byHand(i - m_scene.spawns.size());
  }

  const SceneSpec<D>& m_scene;
  std::string m_prefix;  // of all names given here
  ScriptWriter<D> m_out;
  long m_step = 0;
  std::size_t m_byHand = 0;
  int m_joints = 0, m_wholes = 0;
};

// A word with which no name of the scene begins; the scene may be an earlier output of this file.
std::string freshPrefix(const std::string& text) {
  std::string out = "hand";
  for (int i = 2; text.find(out + "_") != text.npos; ++i) out = "hand" + std::to_string(i);
  return out;
}

}  // namespace

template <int D>
std::string scriptOf(std::span<const Action<D>> actions, const SceneSpec<D>& scene, const SceneFile& file, long steps) {
  ActionWriter<D> writer(scene, freshPrefix(file.content()));
  long last = -1;
  for (const Action<D>& action : actions) {
    if (action.step <= steps)
      writer.write(action), last = action.step;  // after a step back, later actions may be redone
  }
  return writer.out().text("manual actions in " + file.name(), last < steps ? steps : std::max(scene.steps, steps + 1),
                           file.scriptText());
}

template std::string scriptOf(std::span<const Action<2>>, const SceneSpec<2>&, const SceneFile&, long);
template std::string scriptOf(std::span<const Action<3>>, const SceneSpec<3>&, const SceneFile&, long);

}}  // namespace lpc::LPC_PRECISION
