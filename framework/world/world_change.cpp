// SPDX-License-Identifier: Zlib
// What may be otherwise from the next step on: bodies that are there, gravity, algorithms. The 2009 engine had it for
// bodies in part: its shapes, once in a world, were for ever.
#include <algorithm>
#include <utility>

#include "framework/math/inverse_inertia.h"
#include "framework/world/stage_engine.h"
#include "framework/world/world.h"

namespace lpc { inline namespace LPC_PRECISION {

template <int D>
BodyDef<D> World<D>::definition(Handle body) const {
  const std::size_t i = slotOf(body);
  const Bodies<D>& b = m_bodies;
  BodyDef<D> def;
  def.type = b.type[i], def.X_WB = pose(body);
  def.velocity = b.motion[i].v, def.angularVelocity = b.motion[i].w;
  def.pinned = b.pinned[i], def.rotatable = b.rotatable[i], def.awake = b.awake[i];
  def.canSleep = b.canSleep[i] || b.type[i] != BodyType::dynamic;
  def.userData = b.userData[i], def.gravityScale = b.gravityScale[i], def.mass = b.givenMass[i];
  for (const std::int32_t shape : m_shapesOf.of(i)) {
    const ShapeRecord<D>& s = m_shapes[static_cast<std::size_t>(shape)];
    def.shapes.resize(std::max(def.shapes.size(), static_cast<std::size_t>(s.index) + 1));
    def.shapes[static_cast<std::size_t>(s.index)] = {.shape = s.shape,
                                                     .X_BS = {s.X_CS.p + b.center[i], s.X_CS.q},
                                                     .density = s.density,
                                                     .friction = s.friction,
                                                     .restitution = s.restitution,
                                                     .category = s.category,
                                                     .mask = s.mask,
                                                     .userData = s.userData};
  }
  return def;
}

namespace {

template <int D>
bool sameBits(const Pose<D>& a, const Pose<D>& b) {
  if constexpr (D == 2) {
    return a.p == b.p && a.q.c == b.q.c && a.q.s == b.q.s;
  } else {
    return a.p == b.p && a.q.w == b.q.w && a.q.imag() == b.q.imag();
  }
}

}  // namespace

template <int D>
bool World<D>::sameShape(const ShapeRecord<D>& record, const ShapeDef<D>& def) const {
  const Vec<D>& center = m_bodies.center[static_cast<std::size_t>(record.body)];
  return record.shape.same(def.shape) && sameBits<D>({record.X_CS.p + center, record.X_CS.q}, def.X_BS);
}

// Everything that is told from a body's centre of mass, when that has moved within the body.
template <int D>
void World<D>::moveCenter(std::size_t body, const Vec<D>& by) {
  if (by.isZero(0)) return;
  const auto slot = static_cast<std::int32_t>(body);
  m_visits += m_manifolds.size() + m_forces.size();
  for (Manifold<D>& m : m_manifolds) {
    if (m.bodyA != slot && m.bodyB != slot) continue;
    for (ContactPoint<D>& c : m.points) (m.bodyA == slot ? c.localA : c.localB) -= by;
    m.X_AB.p += m.bodyA == slot ? Vec<D>(-by) : Vec<D>(m.X_AB.q * by);
  }
  for (const std::int32_t joint : m_jointsOf.of(body, m_visits)) {
    JointRecord<D>& j = m_joints[static_cast<std::size_t>(joint)];
    (j.bodyA == slot ? j.X_CaJ : j.X_CbJ).p -= by;
  }
  for (ForceRecord<D>& f : m_forces) {
    if (f.kind && f.bodyA == slot) f.localA -= by;
    if (f.kind && f.bodyB == slot) f.localB -= by;
  }
}

template <int D>
void World<D>::change(Handle body, const BodyDef<D>& def) {
  const std::size_t i = slotOf(body);
  const std::int32_t slot = body.slot;
  const Weighed weighed = weigh(def, slot);
  auto& b = m_bodies;
  if (def.type != BodyType::dynamic) {
    for (const std::int32_t joint : m_jointsOf.of(i, m_visits)) {
      const JointRecord<D>& j = m_joints[static_cast<std::size_t>(joint)];
      const std::int32_t other = j.bodyA == slot ? j.bodyB : j.bodyA;
      if (other >= 0 && b.type[static_cast<std::size_t>(other)] == BodyType::dynamic) continue;
      throw UserError("change: a joint would be left between two bodies that do not move; valid: remove it first");
    }
  }

  // Who of the shapes is still there: of equal ones the first is taken first.
  std::vector<std::size_t> had, kept(weighed.shapes.size(), m_shapes.size());
  for (const std::int32_t s : m_shapesOf.of(i, m_visits)) had.push_back(static_cast<std::size_t>(s));
  for (std::size_t k = 0; k < kept.size(); ++k) {
    const auto same =
        std::find_if(had.begin(), had.end(), [&](std::size_t s) { return sameShape(m_shapes[s], weighed.shapes[k]); });
    if (same == had.end()) continue;
    kept[k] = *same;
    had.erase(same);
  }
  const auto isGone = [&](std::int32_t shape) {
    return std::find(had.begin(), had.end(), static_cast<std::size_t>(shape)) != had.end();
  };
  // Two bodies that do not move have no contact, and nobody would end it.
  const bool stops = def.type != BodyType::dynamic && b.type[i] == BodyType::dynamic;
  const auto bothStay = [&](const auto& pair) {
    if (!stops || (pair.bodyA != slot && pair.bodyB != slot)) return false;
    return b.type[static_cast<std::size_t>(pair.bodyA == slot ? pair.bodyB : pair.bodyA)] != BodyType::dynamic;
  };
  if (stops || !had.empty()) {  // else all contacts stay, and are not looked at
    m_visits += m_manifolds.size() + m_records.size();
    endContacts(
        [&](const auto& pair) { return isGone(pair.shapeA) || isGone(pair.shapeB) || bothStay(pair) ? slot : -1; });
  }

  const BodyDef<D> before = definition(body);
  const Vec<D> by = weighed.mass.center - b.center[i];
  const Pose<D> X_WC = b.pose[i];
  write(i, def, weighed);
  // To the last bit where it was, unless it was put elsewhere.
  const bool stays = sameBits<D>(def.X_WB, before.X_WB);
  b.pose[i] = {stays ? Vec<D>(X_WC.p + X_WC.q * by) : Vec<D>(def.X_WB * b.center[i]), def.X_WB.q};
  const bool goesOn = def.velocity == before.velocity && def.angularVelocity == before.angularVelocity;
  if (def.type == BodyType::fixed) {
    b.motion[i] = {};
  } else {
    b.motion[i] = {def.velocity, def.angularVelocity};
    if (goesOn) b.motion[i].v += cross(b.motion[i].w, Vec<D>(X_WC.q * by));
  }
  m_userForces[i].torque += cross(Vec<D>(X_WC.p - b.pose[i].p), m_userForces[i].force);
  moveCenter(i, by);

  for (std::size_t k = had.size(); k-- > 0;) freeShape(had[k]);  // from the end of its list
  for (std::size_t k = 0; k < kept.size(); ++k) {
    const auto index = static_cast<std::int32_t>(k);
    if (kept[k] == m_shapes.size()) continue;
    const Pose<D> X_CS = m_shapes[kept[k]].X_CS;
    fillShape(kept[k], weighed.shapes[k], slot, index);
    m_shapes[kept[k]].X_CS = {X_CS.p - by, X_CS.q};
    m_fast.forget(kept[k]);
    m_boxes.remove(kept[k]), m_boxes.add(kept[k], m_shapes[kept[k]]);  // its filter may be another
  }
  const std::size_t none = m_shapes.size();
  for (std::size_t k = 0; k < kept.size(); ++k) {
    if (kept[k] >= none) putShape(weighed.shapes[k], slot, static_cast<std::int32_t>(k));
  }
  for (const std::int32_t joint : m_jointsOf.of(i, m_visits)) {
    JointRecord<D>& j = m_joints[static_cast<std::size_t>(joint)];
    j.kind->weigh(j, massBetween(m_bodies, j.bodyA, j.bodyB));
  }
  touched(i);
}

namespace {

// In the world.
template <int D>
MassProperties<D> weightOf(const BodyDef<D>& def) {
  MassProperties<D> mass;
  for (const ShapeDef<D>& s : def.shapes) {
    mass = combined(mass, transformed(massProperties(s.shape, s.density), s.X_BS));
  }
  return transformed(def.mass ? *def.mass : mass, def.X_WB);
}

// One motion of both with the momenta of the two.
template <int D>
Motion<D> together(const BodyDef<D>& a, const BodyDef<D>& b, const MassProperties<D>& A, const MassProperties<D>& B) {
  const MassProperties<D> all = combined(A, B);
  Motion<D> out;
  out.v = (A.mass * a.velocity + B.mass * b.velocity) / all.mass;
  const Ang<D> spin = A.inertia * a.angularVelocity + B.inertia * b.angularVelocity +
                      cross(Vec<D>(A.center - all.center), Vec<D>(A.mass * (a.velocity - out.v))) +
                      cross(Vec<D>(B.center - all.center), Vec<D>(B.mass * (b.velocity - out.v)));
  if (all.inertia.trace() > 0) out.w = inverseAtItsScale(all.inertia) * spin;
  return out;
}

}  // namespace

template <int D>
void World<D>::merge(Handle into, Handle other) {
  if (slotOf(into) == slotOf(other)) throw UserError("merge: a body with itself; valid: two bodies");
  const BodyDef<D> a = definition(into), b = definition(other);
  if (a.type != b.type || a.type == BodyType::kinematic) {
    throw UserError("merge: bodies of two types, or kinematic ones; valid: two dynamic bodies, or two fixed ones");
  }
  BodyDef<D> def = a;
  const Pose<D> X_AB = poseBetween(a.X_WB, b.X_WB);
  for (const ShapeDef<D>& s : b.shapes) {
    def.shapes.push_back(s);
    def.shapes.back().X_BS = X_AB * s.X_BS;
  }
  if (a.type == BodyType::dynamic) {
    const MassProperties<D> A = weightOf(a), B = weightOf(b);
    if (a.mass || b.mass) def.mass = transformed(combined(A, B), a.X_WB.inverse());
    const Motion<D> motion = together(a, b, A, B);
    def.velocity = motion.v, def.angularVelocity = motion.w;
  }
  weigh(def, into.slot);  // throws before anything has changed
  const Pose<D> X_AcBc = poseBetween(poseOf(m_bodies, into.slot), poseOf(m_bodies, other.slot));
  const auto ofBoth = [&](std::int32_t from, std::int32_t to) {
    return std::minmax(from, to) == std::minmax(into.slot, other.slot);
  };
  for (ForceRecord<D>& f : m_forces) {
    if (!f.kind || ofBoth(f.bodyA, f.bodyB)) continue;  // goes with `other`
    if (f.bodyA == other.slot) f.bodyA = into.slot, f.localA = X_AcBc * f.localA;
    if (f.bodyB == other.slot) f.bodyB = into.slot, f.localB = X_AcBc * f.localB;
  }
  const std::span<const std::int32_t> joints = m_jointsOf.of(static_cast<std::size_t>(other.slot), m_visits);
  for (const std::int32_t joint : std::vector<std::int32_t>(joints.begin(), joints.end())) {
    const auto slot = static_cast<std::size_t>(joint);
    JointRecord<D>& j = m_joints[slot];
    if (ofBoth(j.bodyA, j.bodyB)) continue;
    unlistJoint(slot);
    (j.bodyA == other.slot ? j.bodyA : j.bodyB) = into.slot;
    Pose<D>& X_CJ = j.bodyA == into.slot ? j.X_CaJ : j.X_CbJ;
    X_CJ = X_AcBc * X_CJ;
    listJoint(slot);
  }
  // What was to push it in the coming step pushes both.
  const auto a0 = static_cast<std::size_t>(into.slot), b0 = static_cast<std::size_t>(other.slot);
  const Vec<D> arm = m_bodies.pose[b0].p - m_bodies.pose[a0].p, force = m_userForces[b0].force;
  m_userForces[a0].torque += m_userForces[b0].torque + cross(arm, force);
  m_userForces[a0].force += force;
  remove(other);
  change(into, def);
}

template <int D>
std::vector<Handle> World<D>::takeApart(Handle body) {
  const BodyDef<D> whole = definition(body);
  std::vector<BodyDef<D>> parts;
  for (const ShapeDef<D>& s : whole.shapes) {
    BodyDef<D>& part = parts.emplace_back(whole);
    part.shapes = {s}, part.mass.reset();
    const Vec<D> center = weigh(part, body.slot).mass.center;  // throws before anything has changed
    const Vec<D> by = whole.X_WB.q * Vec<D>(center - m_bodies.center[static_cast<std::size_t>(body.slot)]);
    if (&s != &whole.shapes[0]) part.velocity += cross(whole.angularVelocity, by);
    if (whole.pinned) part.velocity.setZero();
  }
  std::vector<Handle> out = {body};
  if (parts.empty()) return out;
  change(body, parts[0]);  // which keeps the motion that it had
  for (std::size_t k = 1; k < parts.size(); ++k) out.push_back(add(parts[k]));
  return out;
}

template <int D>
void World<D>::setGravity(const Vec<D>& gravity) {
  if (!gravity.allFinite()) throw UserError("setGravity: gravity is not finite");
  m_settings.gravity = gravity;
  wakeAll();
}

template <int D>
void changeGravity(Simulation<D>& simulation, const Vec<D>& gravity) {
  if (auto* world = dynamic_cast<World<D>*>(&simulation)) return world->setGravity(gravity);
  auto* engine = dynamic_cast<ChangesGravity<D>*>(&simulation);
  if (!engine) throw UserError("this engine keeps the gravity that it began with");
  engine->setGravity(gravity);
}
template void changeGravity(Simulation<2>&, const Vec<2>&);
template void changeGravity(Simulation<3>&, const Vec<3>&);

template <int D>
void World<D>::exchange(const Pipeline& pipeline) {
  StageSet<D> stages(pipeline);
  std::array<bool, kShapeKinds> kinds{};
  for (std::size_t k = 0; k < kShapeKinds; ++k) kinds[k] = m_kindCount[k] > 0;
  requireStages(stages, pipeline, kinds, "exchange: ");
  // With every parameter written out: the same algorithm is no other one where a text leaves out what it says by
  // itself.
  const auto whole = [](StageKind kind, const Spec& spec) {
    return Registry::instance().find(kind, D, spec.name).canonical(spec).text();
  };
  const auto isAnother = [&](StageKind kind) { return whole(kind, pipeline[kind]) != whole(kind, m_pipeline[kind]); };
  const bool solver = isAnother(StageKind::solver), contacts = isAnother(StageKind::contacts),
             sleep = isAnother(StageKind::sleep);
  for (std::size_t i = 0; i < m_bodies.pose.size(); ++i) {
    if (solver) m_bodies.solver[i] = {};
    if (sleep) m_bodies.sleep[i] = {};
  }
  for (JointRecord<D>& j : m_joints) {
    if (solver) j.memory = {};
  }
  for (Manifold<D>& m : m_manifolds) {
    for (ContactPoint<D>& c : m.points) {
      if (solver) c.memory = {};
      if (contacts) c.feature = ~std::uint64_t{0};  // another generator counts features otherwise
    }
  }
  if (contacts) m_records.clear();
  m_pipeline = pipeline;
  m_stages = std::move(stages);
  indexShapes();
  wakeAll();
}

// Boxes and what is fast, anew: no history is in them.
template <int D>
void World<D>::indexShapes() {
  m_boxes = BoxIndex<D>(stage<Broadphase>(), m_settings.margin);
  m_fast = FastParts<D>();
  for (std::size_t i = 0; i < m_shapes.size(); ++i) {
    if (m_shapes[i].body >= 0) m_boxes.add(i, m_shapes[i]);
  }
}

template <int D>
void World<D>::applyImpulse(Handle body, const Wrench<D>& impulse) {
  const std::size_t i = slotOf(body);
  if (!impulse.force.allFinite() || !impulse.torque.allFinite()) {
    throw UserError("applyImpulse: an impulse is not finite");
  }
  if (m_bodies.type[i] != BodyType::dynamic) return;
  if (!m_bodies.pinned[i]) m_bodies.motion[i].v += impulse.force / m_bodies.mass[i];
  if (m_settings.features.rotation) {
    m_bodies.motion[i].w += rotateInertia(m_bodies.pose[i].q, m_bodies.invInertiaBody[i]) * impulse.torque;
  }
  touched(i);
}

template <int D>
void World<D>::applyImpulse(Handle body, const Vec<D>& impulse, const Vec<D>& point) {
  const std::size_t i = slotOf(body);
  if (!point.allFinite()) throw UserError("applyImpulse: the point is not finite");
  applyImpulse(body, {impulse, cross(Vec<D>(point - m_bodies.pose[i].p), impulse)});
}

template <int D>
void World<D>::applyAngularImpulse(Handle body, const Ang<D>& impulse) {
  applyImpulse(body, {Vec<D>::Zero(), impulse});
}

template <int D>
void World<D>::wakeAll() {
  for (std::size_t i = 0; i < m_bodies.used.size(); ++i) {
    if (m_bodies.used[i] && m_bodies.type[i] == BodyType::dynamic) touched(i);
  }
}

// The members of this file; the class as a whole is instantiated in world.cpp.
#define LPC_INSTANTIATE(D)                                                            \
  template BodyDef<D> World<D>::definition(Handle) const;                             \
  template bool World<D>::sameShape(const ShapeRecord<D>&, const ShapeDef<D>&) const; \
  template void World<D>::moveCenter(std::size_t, const Vec<D>&);                     \
  template void World<D>::change(Handle, const BodyDef<D>&);                          \
  template void World<D>::merge(Handle, Handle);                                      \
  template std::vector<Handle> World<D>::takeApart(Handle);                           \
  template void World<D>::setGravity(const Vec<D>&);                                  \
  template void World<D>::exchange(const Pipeline&);                                  \
  template void World<D>::indexShapes();                                              \
  template void World<D>::applyImpulse(Handle, const Wrench<D>&);                     \
  template void World<D>::applyImpulse(Handle, const Vec<D>&, const Vec<D>&);         \
  template void World<D>::applyAngularImpulse(Handle, const Ang<D>&);                 \
  template void World<D>::wakeAll()
LPC_INSTANTIATE(2);
LPC_INSTANTIATE(3);
#undef LPC_INSTANTIATE

}}  // namespace lpc::LPC_PRECISION
