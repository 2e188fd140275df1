// SPDX-License-Identifier: Zlib
#include "experiments/trial/measure/tunnelling.h"

#include <algorithm>

namespace lpc { inline namespace LPC_PRECISION {

template <int D>
bool Tunnelling<D>::collectFixed(const Simulation<D>& world) {
  const Bodies<D>& b = world.bodies();
  std::size_t known = 0;
  bool same = true;
  const auto forFixed = [&](const auto& f) {
    for (std::size_t i = 0; i < b.pose.size(); ++i) {
      if (b.used[i] && b.type[i] == BodyType::fixed) f(Place{static_cast<std::int32_t>(i), b.generation[i], b.pose[i]});
    }
  };
  forFixed([&](const Place& now) {
    same = same && known < m_fixed.size() && m_fixed[known].same(now);
    ++known;
  });
  if (same && known == m_fixed.size()) return false;
  m_fixed.clear(), m_parts.clear();
  forFixed([&](const Place& now) { m_fixed.push_back(now); });
  const auto shapes = world.shapes();
  for (std::size_t s = 0; s < shapes.size(); ++s) {
    const std::int32_t body = shapes[s].body;
    if (body < 0 || b.type[static_cast<std::size_t>(body)] != BodyType::fixed) continue;
    if (shapes[s].shape.isPlane()) continue;  // it has no other side
    forParts(shapes[s].shape, b.pose[static_cast<std::size_t>(body)] * shapes[s].X_CS,
             [&](const ShapeView<D>& view, const Pose<D>& X_WP) {
               m_parts.push_back({boundingBox(view, X_WP), 0, view, X_WP, static_cast<std::int32_t>(s)});
             });
  }
  std::sort(m_parts.begin(), m_parts.end(), [](const Part& a, const Part& c) { return a.box.lo[0] < c.box.lo[0]; });
  for (std::size_t i = 0; i < m_parts.size(); ++i) {
    m_parts[i].farthest = i ? std::max(m_parts[i - 1].farthest, m_parts[i].box.hi[0]) : m_parts[i].box.hi[0];
  }
  return true;
}

template <int D>
void Tunnelling<D>::place(const Simulation<D>& world) {
  const bool other = collectFixed(world);
  const Bodies<D>& b = world.bodies();
  std::vector<std::size_t> fresh;
  m_bodies.resize(b.pose.size());
  for (std::size_t i = 0; i < m_bodies.size(); ++i) {
    Body& body = m_bodies[i];
    if (!b.used[i] || b.type[i] != BodyType::dynamic || !b.pose[i].p.allFinite()) continue;
    if (!body.known || body.generation != b.generation[i]) {
      body = Body{.known = true, .generation = b.generation[i], .reach = std::numeric_limits<Real>::infinity()};
      fresh.push_back(i);
    } else if (other || body.last != b.pose[i].p) {
      fresh.push_back(i);
    }
  }
  if (fresh.empty()) return;
  for (const ShapeRecord<D>& s : world.shapes()) {
    if (s.body < 0 || !m_bodies[static_cast<std::size_t>(s.body)].known) continue;
    Body& body = m_bodies[static_cast<std::size_t>(s.body)];
    forParts(s.shape, s.X_CS, [&](const ShapeView<D>& part, const Pose<D>& X_CP) {
      const Aabb<D> box = boundingBox(part, Pose<D>{});
      body.reach = std::min(body.reach, Real(0.5) * (box.hi - box.lo).minCoeff());
      body.holdsCenter = body.holdsCenter || containsPoint(part, X_CP, Vec<D>(Vec<D>::Zero()));
    });
  }
  for (const std::size_t i : fresh) {
    m_bodies[i].outside = false, m_bodies[i].last = b.pose[i].p;
    move(world, i, b.pose[i].p);
  }
}

// Between two tests a body as small as its reach cannot go around a fixed shape: a path shorter than twice the reach,
// with both ends at least the reach away from the shape, does not cross it.
template <int D>
void Tunnelling<D>::observe(const Simulation<D>& world) {
  const Bodies<D>& b = world.bodies();
  for (std::size_t i = 0; i < m_bodies.size(); ++i) {
    Body& body = m_bodies[i];
    if (!body.known || !b.used[i] || b.generation[i] != body.generation || !b.pose[i].p.allFinite()) continue;
    const Vec<D> now = b.pose[i].p;
    if ((now - body.last).norm() > body.reach) move(world, i, body.last);
    if (!body.outside || (now - body.from).norm() > body.reach) move(world, i, now);
    body.last = now;
  }
}

template <int D>
void Tunnelling<D>::finish(const Simulation<D>& world) {
  for (std::size_t i = 0; i < m_bodies.size(); ++i) {
    if (m_bodies[i].known) move(world, i, m_bodies[i].last);
  }
}

template <int D>
void Tunnelling<D>::move(const Simulation<D>& world, std::size_t slot, const Vec<D>& to) {
  Body& body = m_bodies[slot];
  if (!body.holdsCenter || body.tunnelled) return;
  const Vec<D> from = body.outside ? body.from : to;
  const Aabb<D> path{from.cwiseMin(to), from.cwiseMax(to)};
  bool inside = false, through = false;
  auto part = std::upper_bound(m_parts.begin(), m_parts.end(), path.hi[0],
                               [](Real x, const Part& p) { return x < p.box.lo[0]; });
  while (part != m_parts.begin() && (--part)->farthest >= path.lo[0]) {
    if (!part->box.overlaps(path)) continue;
    const bool ends = containsPoint(part->view, part->X_WP, to);
    const bool enters = body.outside && rayEntry(part->view, part->X_WP, from, Vec<D>(to - from), Real(1)).t >= 0;
    if (!(ends || enters) || !mayCollide(world, static_cast<std::int32_t>(slot), part->shape)) continue;
    inside = inside || ends, through = through || enters;
  }
  if (inside) return;  // it may still be pushed back
  body.tunnelled = through, m_count += through;
  body.from = to, body.outside = true;
}

template <int D>
bool Tunnelling<D>::mayCollide(const Simulation<D>& world, std::int32_t body, std::int32_t shape) {
  const ShapeRecord<D>& fixed = world.shapes()[static_cast<std::size_t>(shape)];
  if (world.settings().model.joints) {
    for (const JointRecord<D>& j : world.joints()) {
      const bool ofBoth = (j.bodyA == body && j.bodyB == fixed.body) || (j.bodyB == body && j.bodyA == fixed.body);
      if (ofBoth && j.active() && !j.collide) return false;
    }
  }
  return std::ranges::any_of(world.shapes(), [&](const ShapeRecord<D>& s) {
    return s.body == body && (s.category & fixed.mask) && (fixed.category & s.mask);
  });
}

template class Tunnelling<2>;
template class Tunnelling<3>;

}}  // namespace lpc::LPC_PRECISION
