// SPDX-License-Identifier: Zlib
#include "experiments/sandbox/action.h"

#include "framework/math/check.h"
#include "framework/world/stage_engine.h"
#include "framework/world/world.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

template <int D>
World<D>& worldOf(Simulation<D>& simulation, const char* what) {
  if (auto* world = dynamic_cast<World<D>*>(&simulation)) return *world;
  throw UserError(std::string("an engine cannot ") + what + "; valid: a pipeline of LPC's stages");
}

template <int D>
struct Player {
  int competitor;
  Simulation<D>& world;
  BodyNumbers<D>& numbers;

  std::size_t row(int body) const { return static_cast<std::size_t>(numbers[body].slot); }

  void operator()(const AddBody<D>& d) { numbers.add(world.add(d.def)); }
  void operator()(const RemoveBody& d) { world.remove(numbers[d.body]); }
  void operator()(const PushBody<D>& d) { world.applyImpulse(numbers[d.body], {d.impulse, d.angular}); }
  void operator()(const PullBody<D>& d) {
    if (!world.valid(numbers[d.body])) throw UserError("the dragged body no longer exists");
    const Bodies<D>& b = world.bodies();
    const Pose<D>& X_WC = b.pose[row(d.body)];
    const Vec<D> arm = X_WC.q * Vec<D>(d.at - b.center[row(d.body)]);
    world.applyForce(numbers[d.body], d.force, X_WC.p + arm);
  }
  void operator()(const SetBody<D>& d) {
    Pose<D> X_WB = world.pose(numbers[d.body]);
    if (d.position) X_WB.p = *d.position;
    if (d.rotation) X_WB.q = *d.rotation;
    if (d.position || d.rotation) world.setPose(numbers[d.body], X_WB);
    Motion<D> motion = world.bodies().motion[row(d.body)];
    if (d.velocity) motion.v = *d.velocity;
    if (d.angularVelocity) motion.w = *d.angularVelocity;
    if (d.velocity || d.angularVelocity) world.setMotion(numbers[d.body], motion);
  }
  void operator()(const JoinBodies<D>& d) {
    if (!world.settings().model.joints) throw UserError("joints are disabled in this saved world");
    JointDef<D> def = d.def;
    def.bodyA = d.bodyA < 0 ? BodyHandle{} : numbers[d.bodyA], def.bodyB = numbers[d.bodyB];
    if (d.bodyA >= 0 && !world.valid(def.bodyA)) throw UserError("the body to be joined no longer exists");
    world.add(def);
  }
  void operator()(const MergeBodies& d) { worldOf(world, "merge bodies").merge(numbers[d.into], numbers[d.other]); }
  void operator()(const SplitByShape& d) {
    World<D>& own = worldOf(world, "split a body");
    if (!own.valid(numbers[d.body]) || static_cast<int>(own.shapesOf(row(d.body)).size()) != d.shapes) {
      throw UserError("the body to be split has different shapes now");
    }
    const std::vector<BodyHandle> parts = own.splitByShape(numbers[d.body]);
    for (std::size_t i = 1; i < parts.size(); ++i) numbers.add(parts[i]);
  }
  void operator()(const WakeBodies& d) {
    auto* own = dynamic_cast<World<D>*>(&world);
    if (!own) return;  // an engine has no sleeping to change
    d.body < 0 ? own->wakeAll() : own->wake(numbers[d.body]);
  }
  void operator()(const SetGravity<D>& d) { changeGravity(world, d.gravity); }
  void operator()(const ChangeBody& d) {
    World<D>& own = worldOf(world, "change a body");
    BodyDef<D> def = own.definition(numbers[d.body]);
    for (ShapeDef<D>& s : def.shapes) {
      s.friction = d.friction.value_or(s.friction), s.restitution = d.restitution.value_or(s.restitution);
      s.density = d.density.value_or(s.density);
    }
    def.pinned = d.pinned.value_or(def.pinned), def.type = d.type.value_or(def.type);
    own.change(numbers[d.body], def);
  }
  void operator()(const SetPipeline& d) {
    if (d.competitor == competitor) worldOf(world, "exchange its stages").setPipeline(Pipeline::parse(d.pipeline));
  }
};

}  // namespace

template <int D>
BodyHandle BodyNumbers<D>::operator[](int body) const {
  const int ofScene = static_cast<int>(m_scene.scene().spawns.size());
  if (body < ofScene) return m_scene.body(body);
  const auto i = static_cast<std::size_t>(body - ofScene);
  return i < m_hand.size() ? m_hand[i] : BodyHandle{};
}

template <int D>
void play(const Action<D>& action, int competitor, Simulation<D>& world, BodyNumbers<D>& numbers) {
  std::visit(Player<D>{competitor, world, numbers}, action.what);
}

template class BodyNumbers<2>;
template class BodyNumbers<3>;
template void play(const Action<2>&, int, Simulation<2>&, BodyNumbers<2>&);
template void play(const Action<3>&, int, Simulation<3>&, BodyNumbers<3>&);

}}  // namespace lpc::LPC_PRECISION
