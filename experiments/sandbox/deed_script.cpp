// SPDX-License-Identifier: Zlib
#include "experiments/sandbox/deed_script.h"

#include "experiments/trial/script_writer.h"

namespace lpc::inline LPC_PRECISION {
namespace {

template <int D>
class DeedWriter {
 public:
  explicit DeedWriter(int ofScene) : m_ofScene(ofScene) {}

  void write(const Deed<D>& deed) {
    m_step = deed.step;
    std::visit(*this, deed.what);
  }
  std::string text(const std::string& summary, long steps) const { return m_out.text(summary, steps); }

  void operator()(const AddBody<D>& d) { m_out.add(m_step, name(m_ofScene + m_byHand++), d.def); }
  void operator()(const RemoveBody& d) { m_out.remove(m_step, name(d.body)); }
  void operator()(const PushBody<D>& d) { m_out.push(m_step, name(d.body), {d.impulse, d.angular}); }
  void operator()(const PullBody<D>& d) { m_out.pull(m_step, name(d.body), d.force, d.at); }
  void operator()(const SetBody<D>& d) {
    m_out.set(m_step, name(d.body), {d.position, d.rotation, d.velocity, d.angularVelocity});
  }
  void operator()(const JoinBodies<D>& d) {
    const auto end = [&](int body) { return body < 0 ? std::string("world") : name(body); };
    m_out.joint(m_step, "joint_" + std::to_string(m_joints++), d.def, end(d.bodyA), end(d.bodyB));
  }
  void operator()(const MergeBodies& d) { m_out.merge(m_step, name(d.into), name(d.other)); }
  void operator()(const TakeApart& d) {
    std::vector<std::string> names = {"whole_" + std::to_string(m_wholes++)};
    for (int i = 1; i < d.shapes; ++i) names.push_back(name(m_ofScene + m_byHand++));
    m_out.takeApart(m_step, name(d.body), names);
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
  void operator()(const ExchangeStages& d) {
    if (d.lane == 0) m_out.exchange(m_step, Pipeline::parse(d.pipeline));
  }

 private:
  std::string name(int body) const {
    return body < m_ofScene ? "#" + std::to_string(body) : "hand_" + std::to_string(body - m_ofScene);
  }

  ScriptWriter<D> m_out;
  long m_step = 0;
  int m_ofScene, m_byHand = 0, m_joints = 0, m_wholes = 0;
};

}  // namespace

template <int D>
std::string scriptOf(std::span<const Deed<D>> deeds, int ofScene, const std::string& summary, long steps) {
  DeedWriter<D> writer(ofScene);
  for (const Deed<D>& deed : deeds) writer.write(deed);
  return writer.text(summary, steps);
}

template std::string scriptOf(std::span<const Deed<2>>, int, const std::string&, long);
template std::string scriptOf(std::span<const Deed<3>>, int, const std::string&, long);

}  // namespace lpc::inline LPC_PRECISION
