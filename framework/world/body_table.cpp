// SPDX-License-Identifier: Zlib
#define XXH_INLINE_ALL  // one hash needs no library at link time
#include "framework/world/body_table.h"

#include <xxhash.h>

#include <algorithm>
#include <string>

#include "framework/math/check.h"

namespace lpc { inline namespace LPC_PRECISION {
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
std::size_t BodyTable<D>::slotOf(BodyHandle body) const {
  if (!valid(body)) throw UserError("world: no body has the handle " + std::to_string(body.slot) + " (removed?)");
  return static_cast<std::size_t>(body.slot);
}

template <int D>
std::uint64_t BodyTable<D>::hash() const {
  XXH64_state_t* state = XXH64_createState();
  XXH64_reset(state, 0);
  const auto put = [&](const auto& x) { XXH64_update(state, &x, sizeof x); };
  for (std::size_t i = 0; i < bodies.pose.size(); ++i) {
    put(bodies.used[i]);
    if (!bodies.used[i]) continue;
    const Pose<D>& x = bodies.pose[i];
    XXH64_update(state, x.p.data(), sizeof(Real) * D);
    put(x.q);
    XXH64_update(state, bodies.motion[i].v.data(), sizeof(Real) * D);
    XXH64_update(state, bodies.motion[i].w.data(), sizeof(Real) * kAngDim<D>);
  }
  const std::uint64_t h = XXH64_digest(state);
  XXH64_freeState(state);
  return h;
}

template <int D>
std::size_t BodyTable<D>::takeSlot() {
  auto& b = bodies;
  const std::size_t i = m_bodySlots.take(visits);
  if (i < b.used.size()) return i;
  b.pose.emplace_back(), b.motion.emplace_back(), b.center.emplace_back(Vec<D>::Zero());
  b.invMass.push_back(0), b.mass.push_back(0);
  b.invInertia.push_back(Inertia<D>::Zero()), b.invInertiaBody.push_back(Inertia<D>::Zero());
  b.type.push_back(BodyType::fixed);
  b.used.push_back(0), b.awake.push_back(0), b.canSleep.push_back(0), b.pinned.push_back(0), b.rotatable.push_back(0);
  b.gravityScale.push_back(0), b.givenMass.emplace_back();
  b.sleep.push_back({}), b.solver.push_back({}), b.generation.push_back(0), b.userData.push_back(0);
  userForces.emplace_back();
  return i;
}

// Writes all data of a body except its shapes, pose and velocity.
template <int D>
void BodyTable<D>::write(std::size_t i, const BodyDef<D>& def, const CheckedBody<D>& checked) {
  auto& b = bodies;
  const bool dynamic = def.type == BodyType::dynamic;
  b.used[i] = 1, b.type[i] = def.type;
  b.awake[i] = def.awake || !dynamic, b.canSleep[i] = def.canSleep && dynamic, b.pinned[i] = def.pinned;
  b.rotatable[i] = def.rotatable, b.gravityScale[i] = def.gravityScale, b.givenMass[i] = def.mass;
  b.center[i] = checked.mass.center;
  b.mass[i] = dynamic ? checked.mass.mass : Real(0);
  b.invInertiaBody[i] = checked.invInertia;
  b.sleep[i] = {}, b.solver[i] = {}, b.userData[i] = def.userData;
}

template <int D>
std::size_t BodyTable<D>::add(const BodyDef<D>& def, const CheckedBody<D>& checked) {
  const std::size_t i = takeSlot();
  write(i, def, checked);
  auto& b = bodies;
  b.pose[i] = {def.X_WB * b.center[i], def.X_WB.q};
  b.motion[i] = def.type == BodyType::fixed ? Motion<D>{} : Motion<D>{def.velocity, def.angularVelocity};
  userForces[i] = {};
  for (std::size_t s = 0; s < checked.shapes.size(); ++s) {
    putShape(checked.shapes[s], static_cast<std::int32_t>(i), static_cast<std::int32_t>(s));
  }
  events.push_back({SleepEvent::bodyAdded, static_cast<std::int32_t>(i), -1});
  return i;
}

template <int D>
void BodyTable<D>::countKinds(const Shape<D>& shape, int change) {
  forParts(shape, Pose<D>{},
           [&](const ShapeView<D>& v, const auto&) { m_kindCount[static_cast<std::size_t>(v.kind)] += change; });
}

template <int D>
void BodyTable<D>::fillShape(std::size_t slot, const ShapeDef<D>& def, std::int32_t body, std::int32_t index) {
  const Vec<D>& center = bodies.center[static_cast<std::size_t>(body)];
  shapes[slot] = {def.shape,    {def.X_BS.p - center, def.X_BS.q},
                  body,         index,
                  def.friction, def.restitution,
                  def.category, def.mask,
                  def.userData, def.density};
}

template <int D>
void BodyTable<D>::putShape(const ShapeDef<D>& def, std::int32_t body, std::int32_t index) {
  const std::size_t i = m_shapeSlots.take(visits);
  if (i == shapes.size()) shapes.emplace_back();
  countKinds(def.shape, 1);
  fillShape(i, def, body, index);
  m_shapesOf.add(static_cast<std::size_t>(body), i, visits);
  boxes.add(i, shapes[i]);
}

template <int D>
void BodyTable<D>::freeShape(std::size_t slot) {
  countKinds(shapes[slot].shape, -1);
  m_shapesOf.remove(static_cast<std::size_t>(shapes[slot].body), slot, visits);
  shapes[slot] = ShapeRecord<D>{};
  m_shapeSlots.give(slot, visits);
  boxes.remove(slot);
}

template <int D>
void BodyTable<D>::remove(std::size_t body) {
  while (!m_shapesOf.of(body).empty()) freeShape(static_cast<std::size_t>(m_shapesOf.of(body).back()));
  std::erase_if(events, [&](const SleepEvent& e) { return e.body == static_cast<std::int32_t>(body); });
  freeBody(body);
  m_bodySlots.give(body, visits);
}

template <int D>
void BodyTable<D>::freeBody(std::size_t i) {
  auto& b = bodies;
  b.pose[i] = {}, b.motion[i] = {}, b.invMass[i] = b.mass[i] = 0, b.center[i] = Vec<D>::Zero();
  b.invInertia[i] = b.invInertiaBody[i] = Inertia<D>::Zero();
  b.type[i] = BodyType::fixed, b.used[i] = b.awake[i] = b.canSleep[i] = b.pinned[i] = b.rotatable[i] = 0;
  b.gravityScale[i] = 0, b.givenMass[i].reset();
  b.sleep[i] = {}, b.solver[i] = {}, b.userData[i] = 0, userForces[i] = {};
  ++b.generation[i];
}

template <int D>
void BodyTable<D>::clear() {
  visits += bodies.used.size() + shapes.size();
  events.clear();
  for (std::size_t s = 0; s < shapes.size(); ++s) {
    if (shapes[s].body < 0) continue;
    shapes[s] = ShapeRecord<D>{};
    boxes.remove(s);
  }
  for (std::size_t i = 0; i < bodies.used.size(); ++i) {
    if (bodies.used[i]) freeBody(i);
  }
  m_kindCount = {};
  m_shapesOf.clear();
  const auto isFree = [](const auto&) { return true; };
  m_bodySlots.read(bodies.used, isFree), m_shapeSlots.read(shapes, isFree);
}

template <int D>
BodyDef<D> BodyTable<D>::definition(std::size_t i) const {
  const Bodies<D>& b = bodies;
  BodyDef<D> def;
  def.type = b.type[i], def.X_WB = frame(i);
  def.velocity = b.motion[i].v, def.angularVelocity = b.motion[i].w;
  def.pinned = b.pinned[i], def.rotatable = b.rotatable[i], def.awake = b.awake[i];
  def.canSleep = b.canSleep[i] || b.type[i] != BodyType::dynamic;
  def.userData = b.userData[i], def.gravityScale = b.gravityScale[i], def.mass = b.givenMass[i];
  for (const std::int32_t shape : m_shapesOf.of(i)) {
    const ShapeRecord<D>& s = shapes[static_cast<std::size_t>(shape)];
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

template <int D>
bool BodyTable<D>::sameShape(const ShapeRecord<D>& record, const ShapeDef<D>& def) const {
  const Vec<D>& center = bodies.center[static_cast<std::size_t>(record.body)];
  return record.shape.same(def.shape) && sameBits<D>({record.X_CS.p + center, record.X_CS.q}, def.X_BS);
}

// Of several equal shapes, the first is matched first.
template <int D>
typename BodyTable<D>::ShapeMatch BodyTable<D>::match(std::size_t body, std::span<const ShapeDef<D>> defs) {
  ShapeMatch out;
  out.kept.assign(defs.size(), kNew);
  auto& had = out.removed;
  for (const std::int32_t s : m_shapesOf.of(body, visits)) had.push_back(static_cast<std::size_t>(s));
  for (std::size_t k = 0; k < defs.size(); ++k) {
    const auto same =
        std::find_if(had.begin(), had.end(), [&](std::size_t s) { return sameShape(shapes[s], defs[k]); });
    if (same == had.end()) continue;
    out.kept[k] = *same;
    had.erase(same);
  }
  return out;
}

template <int D>
Vec<D> BodyTable<D>::rewrite(std::size_t i, const BodyDef<D>& def, const CheckedBody<D>& checked,
                             const ShapeMatch& match) {
  const auto slot = static_cast<std::int32_t>(i);
  auto& b = bodies;
  const BodyDef<D> before = definition(i);
  const Vec<D> by = checked.mass.center - b.center[i];
  const Pose<D> X_WC = b.pose[i];
  write(i, def, checked);
  // Unless the definition moved it, the body stays bit for bit.
  const bool stays = sameBits<D>(def.X_WB, before.X_WB);
  b.pose[i] = {stays ? Vec<D>(X_WC.p + X_WC.q * by) : Vec<D>(def.X_WB * b.center[i]), def.X_WB.q};
  const bool goesOn = def.velocity == before.velocity && def.angularVelocity == before.angularVelocity;
  if (def.type == BodyType::fixed) {
    b.motion[i] = {};
  } else {
    b.motion[i] = {def.velocity, def.angularVelocity};
    if (goesOn) b.motion[i].v += cross(b.motion[i].w, Vec<D>(X_WC.q * by));
  }
  userForces[i].torque += cross(Vec<D>(X_WC.p - b.pose[i].p), userForces[i].force);

  for (std::size_t k = match.removed.size(); k-- > 0;) freeShape(match.removed[k]);  // from the end of its list
  for (std::size_t k = 0; k < match.kept.size(); ++k) {
    const std::size_t kept = match.kept[k];
    if (kept == kNew) continue;
    const Pose<D> X_CS = shapes[kept].X_CS;
    fillShape(kept, checked.shapes[k], slot, static_cast<std::int32_t>(k));
    shapes[kept].X_CS = {X_CS.p - by, X_CS.q};
    boxes.remove(kept), boxes.add(kept, shapes[kept]);  // its filter may have changed
  }
  for (std::size_t k = 0; k < match.kept.size(); ++k) {
    if (match.kept[k] == kNew) putShape(checked.shapes[k], slot, static_cast<std::int32_t>(k));
  }
  return by;
}

template <int D>
std::array<bool, kShapeKinds> BodyTable<D>::kinds() const {
  std::array<bool, kShapeKinds> out{};
  for (std::size_t k = 0; k < kShapeKinds; ++k) out[k] = m_kindCount[k] > 0;
  return out;
}

template <int D>
std::array<bool, kShapeKinds> BodyTable<D>::kindsWith(const CheckedBody<D>& checked, std::int32_t inPlaceOf) const {
  std::array<int, kShapeKinds> others = m_kindCount;
  if (inPlaceOf >= 0) {
    for (const std::int32_t s : m_shapesOf.of(static_cast<std::size_t>(inPlaceOf))) {
      forParts(shapes[static_cast<std::size_t>(s)].shape, Pose<D>{},
               [&](const ShapeView<D>& v, const auto&) { --others[static_cast<std::size_t>(v.kind)]; });
    }
  }
  std::array<bool, kShapeKinds> out = checked.kinds;
  for (std::size_t k = 0; k < kShapeKinds; ++k) out[k] = out[k] || others[k] > 0;
  return out;
}

template <int D>
void BodyTable<D>::touch(std::size_t body) {
  ++visits;
  bodies.awake[body] = 1;
  events.push_back({SleepEvent::userChange, static_cast<std::int32_t>(body), -1});
  boxes.touch(body);
}

template <int D>
void BodyTable<D>::wakeAll() {
  for (std::size_t i = 0; i < bodies.used.size(); ++i) {
    if (bodies.used[i] && bodies.type[i] == BodyType::dynamic) touch(i);
  }
}

template <int D>
void BodyTable<D>::refreshMasses(bool rotation) {
  auto& b = bodies;
  for (std::size_t i = 0; i < b.pose.size(); ++i) {
    if (!b.active(static_cast<int>(i))) {
      b.invMass[i] = 0, b.invInertia[i] = Inertia<D>::Zero();
      continue;
    }
    b.invMass[i] = b.pinned[i] ? Real(0) : 1 / b.mass[i];
    if (rotation) b.invInertia[i] = rotateInertia(b.pose[i].q, b.invInertiaBody[i]);
  }
}

template <int D>
void BodyTable<D>::stopSleepers(std::span<const std::uint8_t> awakeBefore) {
  for (std::size_t i = 0; i < bodies.awake.size(); ++i) {
    if (awakeBefore[i] && !bodies.awake[i]) bodies.motion[i] = {};
  }
}

template <int D>
void BodyTable<D>::index(Broadphase<D>& broadphase, Real margin) {
  boxes = BoxIndex<D>(broadphase, margin);
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    if (shapes[i].body >= 0) boxes.add(i, shapes[i]);
  }
}

template <int D>
void BodyTable<D>::recount() {
  m_bodySlots.read(bodies.used, [](std::uint8_t used) { return used == 0; });
  m_shapeSlots.read(shapes, [](const ShapeRecord<D>& r) { return r.body < 0; });
  m_kindCount = {};
  m_shapesOf.clear();
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    if (shapes[i].body < 0) continue;
    countKinds(shapes[i].shape, 1);
    m_shapesOf.add(static_cast<std::size_t>(shapes[i].body), i, visits);
  }
}

template class BodyTable<2>;
template class BodyTable<3>;

}}  // namespace lpc::LPC_PRECISION
