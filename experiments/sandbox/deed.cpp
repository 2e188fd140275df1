// SPDX-License-Identifier: Zlib
#include "experiments/sandbox/deed.h"

#include "framework/math/check.h"
#include "framework/world/stage_engine.h"
#include "framework/world/world.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

template <int D>
World<D>& worldOf(Simulation<D>& simulation, const char* what) {
  if (auto* world = dynamic_cast<World<D>*>(&simulation)) return *world;
  throw UserError(std::string("an engine cannot ") + what + "; valid: a pipeline of stages");
}

template <int D>
struct Player {
  int lane;
  Simulation<D>& world;
  Cast<D>& cast;

  std::size_t row(int body) const { return static_cast<std::size_t>(cast[body].slot); }

  void operator()(const AddBody<D>& d) { cast.add(world.add(d.def)); }
  void operator()(const RemoveBody& d) { world.remove(cast[d.body]); }
  void operator()(const PushBody<D>& d) { world.applyImpulse(cast[d.body], {d.impulse, d.angular}); }
  void operator()(const PullBody<D>& d) {
    if (!world.valid(cast[d.body])) throw UserError("the body that is pulled is gone");
    const Bodies<D>& b = world.bodies();
    const Pose<D>& X_WC = b.pose[row(d.body)];
    const Vec<D> arm = X_WC.q * Vec<D>(d.at - b.center[row(d.body)]);
    world.applyForce(cast[d.body], d.force, X_WC.p + arm);
  }
  void operator()(const SetBody<D>& d) {
    Pose<D> X_WB = world.pose(cast[d.body]);
    if (d.position) X_WB.p = *d.position;
    if (d.rotation) X_WB.q = *d.rotation;
    if (d.position || d.rotation) world.setPose(cast[d.body], X_WB);
    Motion<D> motion = world.bodies().motion[row(d.body)];
    if (d.velocity) motion.v = *d.velocity;
    if (d.angularVelocity) motion.w = *d.angularVelocity;
    if (d.velocity || d.angularVelocity) world.setMotion(cast[d.body], motion);
  }
  void operator()(const JoinBodies<D>& d) {
    if (!world.settings().features.joints)
      throw UserError("in a world that was saved without joints a joint holds nothing");
    JointDef<D> def = d.def;
    def.bodyA = d.bodyA < 0 ? Handle{} : cast[d.bodyA], def.bodyB = cast[d.bodyB];
    if (d.bodyA >= 0 && !world.valid(def.bodyA)) throw UserError("the body that is joined is gone");
    world.add(def);
  }
  void operator()(const MergeBodies& d) { worldOf(world, "merge bodies").merge(cast[d.into], cast[d.other]); }
  void operator()(const TakeApart& d) {
    World<D>& own = worldOf(world, "take a body apart");
    if (!own.valid(cast[d.body]) || static_cast<int>(own.shapesOf(row(d.body)).size()) != d.shapes) {
      throw UserError("a body that is taken apart has other shapes");
    }
    const std::vector<Handle> parts = own.takeApart(cast[d.body]);
    for (std::size_t i = 1; i < parts.size(); ++i) cast.add(parts[i]);
  }
  void operator()(const WakeBodies& d) {
    auto* own = dynamic_cast<World<D>*>(&world);
    if (!own) return;  // an engine has no sleeping to change
    d.body < 0 ? own->wakeAll() : own->wake(cast[d.body]);
  }
  void operator()(const SetGravity<D>& d) { changeGravity(world, d.gravity); }
  void operator()(const ChangeBody& d) {
    World<D>& own = worldOf(world, "change a body");
    BodyDef<D> def = own.definition(cast[d.body]);
    for (ShapeDef<D>& s : def.shapes) {
      s.friction = d.friction.value_or(s.friction), s.restitution = d.restitution.value_or(s.restitution);
      s.density = d.density.value_or(s.density);
    }
    def.pinned = d.pinned.value_or(def.pinned), def.type = d.type.value_or(def.type);
    own.change(cast[d.body], def);
  }
  void operator()(const ExchangeStages& d) {
    if (d.lane == lane) worldOf(world, "exchange its stages").exchange(Pipeline::parse(d.pipeline));
  }
};

}  // namespace

template <int D>
Handle Cast<D>::operator[](int body) const {
  const int ofScene = static_cast<int>(m_scene.scene().spawns.size());
  if (body < ofScene) return m_scene.body(body);
  const auto i = static_cast<std::size_t>(body - ofScene);
  return i < m_hand.size() ? m_hand[i] : Handle{};
}

template <int D>
void play(const Deed<D>& deed, int lane, Simulation<D>& world, Cast<D>& cast) {
  std::visit(Player<D>{lane, world, cast}, deed.what);
}

template class Cast<2>;
template class Cast<3>;
template void play(const Deed<2>&, int, Simulation<2>&, Cast<2>&);
template void play(const Deed<3>&, int, Simulation<3>&, Cast<3>&);

}}  // namespace lpc::LPC_PRECISION
