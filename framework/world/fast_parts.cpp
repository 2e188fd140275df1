// SPDX-License-Identifier: Zlib
#include "framework/world/fast_parts.h"

#include <algorithm>

#include "framework/math/tolerances.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

// Compare a point at distance r that turns by an angle with one on the straight path between the end positions. At each
// time the two are at most min(r angle^2 / 8, 2 r) apart.
template <int D>
Aabb<D> sweptBox(const ShapeView<D>& view, const ShapeMotion<D>& motion, Real dt, Real r) {
  const Real angle = motion.motion.w.norm() * dt;
  const Aabb<D> ends =
      boundingBox(view, motion.X_WC * motion.X_CS).merged(boundingBox(view, motion.bodyAt(dt) * motion.X_CS));
  return angle > 0 ? ends.grown(r * std::min(Real(2), angle * angle / 8)) : ends;
}

}  // namespace

template <int D>
FastParts<D>::FastParts() = default;

template <int D>
void FastParts<D>::forget(std::size_t shape) {
  if (shape < m_radii.size()) m_radii[shape].clear();
}

template <int D>
InnerOuterRadii<D> FastParts<D>::innerOuterRadii(const ShapeView<D>& part) {
  InnerOuterRadii<D> radii;
  if (part.core() == CoreClass::hull) {
    for (const Vec<D>& v : part.hull->vertices) radii.center += v;
    radii.center /= static_cast<Real>(part.hull->vertices.size());
  }
  radii.outer = boundingRadius(part);
  Pose<D> X_PartPoint;
  X_PartPoint.p = radii.center;
  if (!m_query) m_query = createStage<PairQuery<D>>({"gjk_epa", {}});  // most worlds never need it
  const Shape<D> point = Shape<D>::sphere(0);
  const PairAnswer<D> depth = queryPair(*m_query, part, point.view(), X_PartPoint, QueryNeed::distance);
  radii.inner = std::max(Real(0), -depth.distance);
  return radii;
}

// Calls f(part) for each part with finite pose and motion; of a surface only for parts near the box.
template <int D>
template <class F>
void FastParts<D>::forParts(std::size_t shape, const BodySweeps<D>& sweeps, Real threshold, const Bodies<D>& bodies,
                            const ShapeRecord<D>& record, const Aabb<D>& near, const F& f) {
  const auto body = static_cast<std::size_t>(record.body);
  const bool moves = bodies.awake[body] && bodies.type[body] != BodyType::fixed;
  auto& radii = m_radii[shape];
  if (moves && radii.empty()) {
    lpc::forParts(record.shape, record.X_CS,
                  [&](const ShapeView<D>& view, const Pose<D>&) { radii.push_back(innerOuterRadii(view)); });
  }
  const auto take = [&](std::int32_t number, const ShapeView<D>& view, const Pose<D>& X_CP) {
    Part part{record.body, static_cast<std::int32_t>(shape), number, view, X_CP, {}, 0, {}, false};
    const ShapeMotion<D> motion = sweeps.of(part.body, X_CP);
    if (moves) {
      part.radii = radii[static_cast<std::size_t>(number)];
      const Real reach = X_CP.p.norm() + part.radii.outer - view.radius;  // a rounding radius turns with its core
      part.maxTravel = (motion.motion.v.norm() + motion.motion.w.norm() * reach) * sweeps.dt;
      if (!std::isfinite(part.maxTravel) || !motion.X_WC.p.allFinite()) return;  // takes no part in collision
      // A part that moves less is near enough for ordinary contacts.
      part.fast = part.maxTravel > threshold * std::max(part.radii.inner, kLinearSlop);
      part.box = sweptBox(view, motion, sweeps.dt, reach);
    } else {
      part.box = boundingBox(view, motion.X_WC * X_CP);
    }
    f(part);
  };
  forPartsNear(record.shape, record.X_CS, sweeps.start[body], near, m_parts, *m_work, take);
}

template <int D>
std::span<const typename FastParts<D>::Pair> FastParts<D>::find(const BodySweeps<D>& sweeps, Real threshold,
                                                                const Bodies<D>& bodies,
                                                                std::span<const ShapeRecord<D>> shapes,
                                                                const BoxIndex<D>& boxes, WorkDone& work) {
  m_work = &work;
  m_radii.resize(shapes.size());
  m_fast.clear(), m_pairs.clear();
  Real slowest = 0;  // largest motion of a part that is not fast: the boxes of the start may be off by this much
  for (std::size_t s = 0; s < shapes.size(); ++s) {
    if (shapes[s].body < 0) continue;
    const auto body = static_cast<std::size_t>(shapes[s].body);
    if (!bodies.awake[body] || bodies.type[body] == BodyType::fixed) continue;
    forParts(s, sweeps, threshold, bodies, shapes[s], {}, [&](const Part& part) {
      if (part.fast) m_fast.push_back(part);
      if (!part.fast) slowest = std::max(slowest, part.maxTravel);
    });
  }
  const auto pair = [&](const Part& p, const Part& q) {
    const ShapeRecord<D>&a = shapes[static_cast<std::size_t>(p.shape)], &b = shapes[static_cast<std::size_t>(q.shape)];
    const auto isDynamic = [&](const Part& part) {
      return bodies.type[static_cast<std::size_t>(part.body)] == BodyType::dynamic;
    };
    if (p.body == q.body || (!isDynamic(p) && !isDynamic(q)) || !(a.category & b.mask) || !(b.category & a.mask) ||
        !p.box.overlaps(q.box))
      return;
    m_pairs.push_back(p < q ? Pair{p, q} : Pair{q, p});
  };
  for (const Part& fast : m_fast) {
    m_near.clear();
    boxes.overlap(fast.box.grown(slowest), m_near);
    for (const ProxyId other : m_near) {
      const auto s = static_cast<std::size_t>(other);
      forParts(s, sweeps, threshold, bodies, shapes[s], fast.box, [&](const Part& part) {
        if (!part.fast) pair(fast, part);
      });
    }
  }
  Aabb<D> places;
  for (const Part& p : m_fast) places = places.merged({p.box.lo, p.box.lo});
  Eigen::Index k = 0;
  if (!m_fast.empty()) (places.hi - places.lo).maxCoeff(&k);  // the axis along which the parts are farthest apart
  std::sort(m_fast.begin(), m_fast.end(), [&](const Part& a, const Part& b) { return a.box.lo[k] < b.box.lo[k]; });
  for (std::size_t i = 0; i < m_fast.size(); ++i) {
    for (std::size_t j = i + 1; j < m_fast.size() && m_fast[j].box.lo[k] <= m_fast[i].box.hi[k]; ++j) {
      pair(m_fast[i], m_fast[j]);
    }
  }
  std::sort(m_pairs.begin(), m_pairs.end(),
            [](const Pair& p, const Pair& q) { return p.a < q.a || (!(q.a < p.a) && p.b < q.b); });
  return m_pairs;
}

template class FastParts<2>;
template class FastParts<3>;

}}  // namespace lpc::LPC_PRECISION
