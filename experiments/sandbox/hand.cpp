// SPDX-License-Identifier: Zlib
#include "experiments/sandbox/hand.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "framework/draw/draw_simulation.h"
#include "framework/math/check.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

constexpr Real kSpring = 12;  // rad/s, of the drag spring: half a second per oscillation
constexpr DrawColour kPreview{40, 120, 220, 120}, kPreviewEdge{20, 80, 180}, kSelected{230, 90, 20},
    kSpringLine{200, 40, 40};

constexpr ToolInfo kTools[] = {
    {Tool::grab, "grab", "drag a body; select by a click or a rectangle"},
    {Tool::circle, "circle", "drag from centre to rim; in 3D a ball"},
    {Tool::box, "box", "drag from corner to corner"},
    {Tool::capsule, "capsule", "drag from end to end"},
    {Tool::polygon, "polygon", "click the corners, then Enter; in 3D a prism"},
    {Tool::compound, "compound", "drag several boxes, then Enter: one body"},
    {Tool::joint, "joint", "click one body, then another, or empty space for the world"},
};

std::optional<DrawnKind> drawnBy(Tool tool) {
  switch (tool) {
    case Tool::circle:
      return DrawnKind::circle;
    case Tool::box:
    case Tool::compound:
      return DrawnKind::box;
    case Tool::capsule:
      return DrawnKind::capsule;
    case Tool::polygon:
      return DrawnKind::polygon;
    case Tool::grab:
    case Tool::joint:
      break;
  }
  return std::nullopt;
}

Rot<2> turnBy(const ViewCamera<2>&, Real angle) { return Rot<2>::angle(angle); }
Rot<3> turnBy(const ViewCamera<3>& camera, Real angle) { return Rot<3>::vector(angle * camera.towards()); }

Ang<2> spinTurned(const Rot<2>&, const Ang<2>& w) { return w; }
Ang<3> spinTurned(const Rot<3>& q, const Ang<3>& w) { return q * w; }

Rot<2> facing(const ViewCamera<2>&) { return {}; }
// Rotates x to the window's right, y up and z to the viewer.
Rot<3> facing(const ViewCamera<3>& camera) {
  Mat<3> m;
  m << camera.right(), camera.up(), camera.towards();
  const Eigen::Quaternion<Real> q(m);
  return Rot<3>{q.w(), q.x(), q.y(), q.z()}.normalized();
}

// m: closer ends coincide up to rounding.
constexpr Real kGap = std::max(Real(1e-6), 1000 * std::numeric_limits<Real>::epsilon());

// Whether the two ends of a joint of this kind may be apart, as for a rod or a spring: no rigid row is violated.
template <int D>
bool spans(const JointDef<D>& def, const Pose<D>& X_WA, const Pose<D>& X_WB) {
  try {
    const JointRecord<D> joint = makeJoint(def, X_WA, X_WB);
    JointRows<D> rows;
    joint.kind->rows(joint, X_WA, X_WB, rows);
    const auto broken = [](const ConstraintRow<D>& row) {
      return row.binds() && !row.angular && std::abs(row.error) > kGap;
    };
    return std::none_of(rows.all().begin(), rows.all().end(), broken);
  } catch (const UserError&) {
    return false;
  }
}

}  // namespace

std::span<const ToolInfo> tools() { return kTools; }

template <int D>
Vec<D> Hand<D>::target(const Vec<2>& pixel) const {
  return onPlane<D>(m_camera, pixel, m_carried->target);
}

template <int D>
DrawingPlane<D> Hand<D>::plane() const {
  return {*m_planeThrough, facing(m_camera)};
}

template <int D>
Vec<2> Hand<D>::planePoint(const Vec<2>& pixel) const {
  const DrawingPlane<D> at = plane();
  return (at.q.inverse() * Vec<D>(onPlane<D>(m_camera, pixel, at.origin) - at.origin)).template head<2>();
}

template <int D>
void Hand<D>::press(const Vec<2>& pixel, bool addToSelection) {
  m_cursor = pixel;
  const Picked<D> picked = pick(m_session.world(), m_camera, pixel);
  if (tool == Tool::joint) return join(pixel);
  if (drawnBy(tool)) {
    if (!m_planeThrough) m_planeThrough = freePoint(m_session.world(), m_camera, pixel);
    if (m_points.empty()) m_points.emplace_back();
    m_points.back() = planePoint(pixel);
    m_points.push_back(m_points.back());  // the end, which follows the cursor
    return;
  }
  const int body = picked.slot < 0 ? -1 : m_session.bodyAt(picked.slot);
  if (body < 0) {
    if (!addToSelection) m_selected.clear();
    m_corner = pixel;
    return;
  }
  const bool has = std::find(m_selected.begin(), m_selected.end(), body) != m_selected.end();
  if (addToSelection && has) {
    std::erase(m_selected, body);
    return;
  }
  if (!addToSelection && !has) m_selected.clear();
  if (!has) m_selected.push_back(body);
  const Pose<D> X_WB = m_session.world().pose(m_session.handle(body));
  m_carried = Carried{body, X_WB.inverse() * picked.point, picked.point, {}};
  if (m_paused) setPaused(true);
}

template <int D>
void Hand<D>::setPaused(bool paused) {
  m_paused = paused;
  if (!m_carried) return;
  const BodyHandle h = m_session.handle(m_carried->body);
  if (!m_session.world().valid(h)) return m_carried.reset();
  m_carried->placed.clear();
  if (!paused) return;
  std::vector<int> all = there(m_selected);
  if (std::find(all.begin(), all.end(), m_carried->body) == all.end()) all = {m_carried->body};
  for (const int body : all) {
    m_carried->placed.push_back({body, m_session.world().pose(m_session.handle(body)).p - m_carried->target});
  }
}

template <int D>
std::vector<int> Hand<D>::there(const std::vector<int>& bodies) const {
  std::vector<int> out;
  for (const int body : bodies) {
    if (m_session.world().valid(m_session.handle(body))) out.push_back(body);
  }
  return out;
}

template <int D>
void Hand<D>::move(const Vec<2>& pixel) {
  m_cursor = pixel;
  if (m_carried) carry(pixel);
  if (m_points.size() > 1) m_points.back() = planePoint(pixel);
}

template <int D>
void Hand<D>::carry(const Vec<2>& pixel) {
  m_carried->target = target(pixel);
  if (!m_paused) return;
  if (!m_session.world().valid(m_session.handle(m_carried->body))) return m_carried.reset();
  for (const Placed& p : m_carried->placed) {
    if (!m_session.world().valid(m_session.handle(p.body))) continue;
    m_session.perform(SetBody<D>{.body = p.body, .position = m_carried->target + p.p_PB});
  }
}

template <int D>
void Hand<D>::pull(bool keepRotation) {
  if (!m_carried || m_paused) return;
  const BodyHandle h = m_session.handle(m_carried->body);
  const Simulation<D>& world = m_session.world();
  if (!world.valid(h)) return m_carried.reset();
  const auto i = static_cast<std::size_t>(h.slot);
  const Bodies<D>& b = world.bodies();
  if (b.type[i] != BodyType::dynamic) return;
  if (keepRotation) m_session.perform(SetBody<D>{.body = m_carried->body, .angularVelocity = Ang<D>::Zero()});
  const Vec<D> arm = b.pose[i].q * Vec<D>(m_carried->at - b.center[i]);
  const Vec<D> v = b.motion[i].v + cross(b.motion[i].w, arm);
  const Vec<D> way = m_carried->target - (b.pose[i].p + arm);
  m_session.perform(
      PullBody<D>{m_carried->body, b.mass[i] * (kSpring * kSpring * way - 2 * kSpring * v), m_carried->at});
}

template <int D>
void Hand<D>::turn(Real angle) {
  std::vector<int> bodies = m_selected;
  if (m_carried) {
    bodies.clear();
    for (const Placed& p : m_carried->placed) bodies.push_back(p.body);
    if (!m_paused) bodies.push_back(m_carried->body);
  }
  bodies = there(bodies);
  if (bodies.empty()) return;
  if (m_carried && there({m_carried->body}).empty()) return m_carried.reset();
  const auto row = [&](int body) { return static_cast<std::size_t>(m_session.handle(body).slot); };
  const Bodies<D>& b = m_session.world().bodies();
  Real mass = 0;  // of the moving ones
  Vec<D> moment = Vec<D>::Zero(), momentum = moment, middle = moment;
  for (const int body : bodies) {
    const std::size_t i = row(body);
    middle += b.pose[i].p / static_cast<Real>(bodies.size());
    if (b.type[i] == BodyType::dynamic) {
      mass += b.mass[i], moment += b.mass[i] * b.pose[i].p, momentum += b.mass[i] * b.motion[i].v;
    }
  }
  Vec<D> about = mass > 0 ? Vec<D>(moment / mass) : middle;
  const Vec<D> common = mass > 0 ? Vec<D>(momentum / mass) : momentum;
  if (m_carried) about = m_session.world().pose(m_session.handle(m_carried->body)) * m_carried->at;
  const Rot<D> q = turnBy(m_camera, angle);
  for (const int body : bodies) {
    const Pose<D> X_WB = m_session.world().pose(m_session.handle(body));
    SetBody<D> set{.body = body, .position = about + q * Vec<D>(X_WB.p - about), .rotation = (q * X_WB.q).normalized()};
    const std::size_t i = row(body);
    if (b.type[i] == BodyType::dynamic) {
      const Vec<D> v = common + q * Vec<D>(b.motion[i].v - common);
      const Ang<D> w = spinTurned(q, b.motion[i].w);
      if (v != b.motion[i].v) set.velocity = v;
      if (w != b.motion[i].w) set.angularVelocity = w;
    }
    m_session.perform(set);
  }
  setPaused(m_paused);
}

template <int D>
void Hand<D>::release(const Vec<2>& pixel) {
  m_cursor = pixel;
  m_carried.reset();
  if (m_corner) {
    for (const std::int32_t slot : within(m_session.world(), m_camera, *m_corner, pixel)) {
      const int body = m_session.bodyAt(slot);
      if (std::find(m_selected.begin(), m_selected.end(), body) == m_selected.end()) m_selected.push_back(body);
    }
    m_corner.reset();
  }
  const auto kind = drawnBy(tool);
  if (!kind || *kind == DrawnKind::polygon || m_points.empty()) return;
  m_points.back() = planePoint(pixel);
  std::optional<BodyDef<D>> def = drawnShape<D>(*kind, m_points, plane());
  m_points.clear();
  if (def && tool == Tool::compound) {
    m_pieces.push_back(std::move(*def));
    return;
  }
  m_planeThrough.reset();
  if (def) add(std::move(*def));
}

template <int D>
void Hand<D>::finish() {
  if (tool == Tool::polygon && m_points.size() > 3) {
    m_points.pop_back();  // the one that follows the cursor
    if (std::optional<BodyDef<D>> def = drawnShape<D>(DrawnKind::polygon, m_points, plane())) add(std::move(*def));
  }
  if (tool == Tool::compound && !m_pieces.empty()) {
    BodyDef<D> whole = m_pieces.front();
    for (std::size_t i = 1; i < m_pieces.size(); ++i) {
      ShapeDef<D> shape = m_pieces[i].shapes.front();
      shape.X_BS = whole.X_WB.inverse() * m_pieces[i].X_WB * shape.X_BS;
      whole.shapes.push_back(std::move(shape));
    }
    add(std::move(whole));
  }
  cancel();
}

template <int D>
void Hand<D>::cancel() {
  m_points.clear(), m_pieces.clear();
  m_planeThrough.reset(), m_first.reset(), m_corner.reset(), m_carried.reset();
}

template <int D>
void Hand<D>::add(BodyDef<D> def) {
  if (drawsStatic) def.type = BodyType::fixed;
  m_session.perform(AddBody<D>{std::move(def)});
}

template <int D>
void Hand<D>::join(const Vec<2>& pixel) {
  const Picked<D> picked = pick(m_session.world(), m_camera, pixel);
  const int body = picked.slot < 0 ? -1 : m_session.bodyAt(picked.slot);
  if (!m_first) {
    if (body >= 0) m_first = {body, picked.point};
    return;
  }
  JoinBodies<D> joined{m_first->body, body, {}};
  Vec<D> from = m_first->point, to = picked.point;
  m_first.reset();
  if (body < 0) {  // the world's end is A's
    std::swap(joined.bodyA, joined.bodyB);
    std::swap(from, to);
  }
  joined.def.kind = joint;
  joined.def.X_WJ.p = from;
  joined.def.X_WJb = Pose<D>{to, {}};
  const auto poseOfBody = [&](int b) {
    return poseOf(m_session.world().bodies(), b < 0 ? -1 : m_session.handle(b).slot);
  };
  if (!spans(joined.def, poseOfBody(joined.bodyA), poseOfBody(joined.bodyB))) {
    joined.def.X_WJ.p = body < 0 ? to : from;  // position of the first click
    joined.def.X_WJb.reset();
  }
  m_session.perform(std::move(joined));
}

template <int D>
std::vector<int> Hand<D>::chosen() const {
  std::vector<int> out = there(m_selected);
  if (!out.empty()) return out;
  const std::int32_t slot = pick(m_session.world(), m_camera, m_cursor).slot;
  return slot < 0 ? out : std::vector<int>{m_session.bodyAt(slot)};
}

template <int D>
void Hand<D>::removeSelected() {
  for (const int body : chosen()) m_session.perform(RemoveBody{body});
  m_selected.clear(), m_carried.reset();
}

template <int D>
void Hand<D>::makeStatic() {
  for (const int body : chosen()) {
    const auto i = static_cast<std::size_t>(m_session.handle(body).slot);
    const bool fixed = m_session.world().bodies().type[i] == BodyType::fixed;
    m_session.perform(ChangeBody{.body = body, .type = fixed ? BodyType::dynamic : BodyType::fixed});
  }
}

template <int D>
void Hand<D>::pin() {
  for (const int body : chosen()) {
    const auto i = static_cast<std::size_t>(m_session.handle(body).slot);
    m_session.perform(ChangeBody{.body = body, .pinned = !m_session.world().bodies().pinned[i]});
  }
}

template <int D>
void Hand<D>::merge() {
  const std::vector<int> bodies = chosen();
  for (std::size_t i = 1; i < bodies.size(); ++i) m_session.perform(MergeBodies{bodies[0], bodies[i]});
  m_selected.resize(std::min<std::size_t>(m_selected.size(), 1));
}

template <int D>
void Hand<D>::splitByShape() {
  for (const int body : chosen()) {
    int shapes = 0;
    for (const ShapeRecord<D>& s : m_session.world().shapes()) shapes += s.body == m_session.handle(body).slot;
    m_session.perform(SplitByShape{body, shapes});
  }
}

template <int D>
void Hand<D>::wake() {
  m_session.perform(WakeBodies{});
}

template <int D>
std::optional<BodyDef<D>> Hand<D>::preview() const {
  const auto kind = drawnBy(tool);
  return kind && m_planeThrough ? drawnShape<D>(*kind, m_points, plane()) : std::nullopt;
}

template <int D>
void Hand<D>::drawSelected(std::size_t competitor, DebugDraw<D>& out) const {
  const Simulation<D>& world = m_session.world(competitor);
  std::vector<std::int32_t> slots;
  for (const int body : m_selected) {
    if (const BodyHandle h = m_session.handle(body, competitor); world.valid(h)) slots.push_back(h.slot);
  }
  for (const ShapeRecord<D>& s : world.shapes()) {
    if (s.body < 0 || std::find(slots.begin(), slots.end(), s.body) == slots.end()) continue;
    const Pose<D>& X_WC = world.bodies().pose[static_cast<std::size_t>(s.body)];
    if (!isPlace(X_WC)) continue;
    forParts(s.shape, X_WC * s.X_CS, [&](const ShapeView<D>& view, const Pose<D>& X_WS) {
      out.shape(view, X_WS, {.fill = kSelected, .edge = kSelected, .moves = true, .outline = true});
    });
  }
}

template <int D>
void Hand<D>::draw(DebugDraw<D>& out) const {
  const Simulation<D>& world = m_session.world();
  const auto drawShapes = [&](const BodyDef<D>& def) {
    for (const ShapeDef<D>& s : def.shapes) {
      forParts(s.shape, def.X_WB * s.X_BS, [&](const ShapeView<D>& view, const Pose<D>& X_WS) {
        out.shape(view, X_WS, {kPreview, kPreviewEdge});
      });
    }
  };
  for (const BodyDef<D>& piece : m_pieces) drawShapes(piece);
  if (const auto def = preview()) drawShapes(*def);
  if (m_planeThrough) {
    const DrawingPlane<D> at = plane();
    for (const Vec<2>& p : m_points) {
      Vec<D> in = Vec<D>::Zero();
      in.template head<2>() = p;
      out.point(at.origin + at.q * in, 5, kPreviewEdge);
    }
  }
  drawSelected(0, out);
  if (m_carried && world.valid(m_session.handle(m_carried->body))) {
    out.line(world.pose(m_session.handle(m_carried->body)) * m_carried->at, m_carried->target, kSpringLine);
  }
  if (m_first) out.point(m_first->point, 7, kSpringLine);
  if (m_corner) {
    const Vec<D> through = onPlane<D>(m_camera, *m_corner, Vec<D>::Zero());
    const auto at = [&](Real x, Real y) { return onPlane<D>(m_camera, Vec<2>(x, y), through); };
    const Vec<2>&a = *m_corner, &b = m_cursor;
    out.line(at(a[0], a[1]), at(b[0], a[1]), kSelected), out.line(at(b[0], a[1]), at(b[0], b[1]), kSelected);
    out.line(at(b[0], b[1]), at(a[0], b[1]), kSelected), out.line(at(a[0], b[1]), at(a[0], a[1]), kSelected);
  }
}

template class Hand<2>;
template class Hand<3>;

}}  // namespace lpc::LPC_PRECISION
