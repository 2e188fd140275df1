// SPDX-License-Identifier: Zlib
#include "framework/world/body_queries.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "framework/math/user_numbers.h"
#include "framework/shape/parts_near.h"
#include "framework/stage/registry.h"
#include "framework/stage/stage_time_of_impact.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

// Calls meet(view, X_WP) for each part when the ray hits its box, grown by rounding errors. A surface has two sides for
// rays: the ray's direction decides by which side it enters.
template <int D, class Meet>
void meetOfSurface(const Surface<D>& surface, const Pose<D>& X_WS, const Vec<D>& p, const Vec<D>& direction, Real maxT,
                   std::vector<std::int32_t>& near, const Meet& meet) {
  const Vec<D> start = X_WS.q.inverse() * Vec<D>(p - X_WS.p), along = X_WS.q.inverse() * direction;
  const Real rounding = kTurnedBox * (p.cwiseAbs().maxCoeff() + X_WS.p.cwiseAbs().maxCoeff() + surface.reach());
  WorkDone work;
  surface.tree().find([&](const Aabb<D>& box) { return castRay(box.grown(rounding), start, along, maxT) >= 0; }, near,
                      work);
  for (const std::int32_t i : near) {
    const PlacedView<D>& part = surface.parts()[static_cast<std::size_t>(i)];
    meet(part.view, X_WS * part.X_SP);
  }
}

template <int D>
bool meets(const QueryFilter<D>& filter, BodyHandle body, const ShapeRecord<D>& s) {
  return (filter.category & s.mask) && (filter.mask & s.category) && (!filter.accepts || filter.accepts(body, s));
}

// Queries of two shapes use the most exact algorithms of LPC.
constexpr const char* kGapQuery = "by_kind";
constexpr const char* kCast = "conservative_advancement{query=by_kind}";

// The answer for (a, b), in the world's axes relative to X_WA.p.
template <int D>
PairAnswer<D> answerOf(PairQuery<D>& method, const ShapeView<D>& a, const Pose<D>& X_WA, const ShapeView<D>& b,
                       const Pose<D>& X_WB, QueryNeed need) {
  const PairAnswer<D> out = queryPair(method, a, b, poseBetween(X_WA, X_WB), need);
  if (out.status == QueryStatus::refused) throw UserError(std::string(kGapQuery) + " does not support these shapes");
  return out;
}

// Where a part that moves without rotation first touches a part of a body.
template <int D>
TimeOfImpactAnswer<D> castPart(TimeOfImpact<D>& method, const ShapeView<D>& part, const Pose<D>& X_WP,
                               const Vec<D>& displacement, const ShapeView<D>& target, const Pose<D>& X_WT) {
  MovingPair<D> pair{part, target, {.X_WC = X_WP}, {.X_WC = X_WT}};
  pair.A.motion.v = displacement;
  if (part.kind > target.kind) std::swap(pair.a, pair.b), std::swap(pair.A, pair.B);
  if (!method.supports(pair.a.kind, pair.b.kind)) throw UserError("castFirst does not support these shapes");
  TimeOfImpactAnswer<D> out;
  WorkDone work;
  method.cast({&pair, 1}, Real(1), {&out, 1}, work);
  return out;
}

// The convex parts of a shape that a query moves.
template <int D>
std::vector<std::pair<ShapeView<D>, Pose<D>>> partsOf(const char* query, const Shape<D>& shape, const Pose<D>& X_WS) {
  const auto refuse = [&](const char* why) { throw UserError(std::string(query) + ": " + why); };
  if (shape.surface()) refuse("the shape is a surface; valid: a convex shape or a compound");
  if (shape.kind() == ShapeKind::plane) refuse("the shape is a plane; valid: a convex shape or a compound");
  checkPose(X_WS, query);
  std::vector<std::pair<ShapeView<D>, Pose<D>>> out;
  forParts(shape, X_WS, [&](const ShapeView<D>& part, const Pose<D>& X_WP) { out.emplace_back(part, X_WP); });
  return out;
}

}  // namespace

// The bodies of these proxies, each once, with a convex part for which `holds` is true; `holds` gets the part and its
// pose. Tests only the parts of a surface near the box.
template <int D>
template <class Holds>
std::vector<BodyHandle> BodyQueries<D>::bodiesOf(std::vector<ProxyId>& found, const Aabb<D>& box,
                                                 const Holds& holds) const {
  std::sort(found.begin(), found.end());
  std::vector<BodyHandle> out;
  std::vector<std::int32_t> near;
  WorkDone work;
  for (ProxyId id : found) {
    const ShapeRecord<D>& s = m_table.shapes[static_cast<std::size_t>(id)];
    const Pose<D> X_WS = m_table.bodies.pose[static_cast<std::size_t>(s.body)] * s.X_CS;
    bool held = false;
    forPartsNear(s.shape, X_WS, {}, box, near, work,
                 [&](std::int32_t, const auto& part, const Pose<D>& X_WP) { held = held || holds(part, X_WP); });
    const BodyHandle h = m_table.handle(s.body);
    if (held && std::find(out.begin(), out.end(), h) == out.end()) out.push_back(h);
  }
  return out;
}

template <int D>
std::vector<BodyHandle> BodyQueries<D>::at(const Vec<D>& point) const {
  std::vector<ProxyId> found;
  m_table.boxes.at(point, found);
  return bodiesOf(found, {point, point},
                  [&](const auto& shape, const Pose<D>& X_WS) { return containsPoint(shape, X_WS, point); });
}

template <int D>
std::vector<BodyHandle> BodyQueries<D>::overlap(const Aabb<D>& box) const {
  std::vector<ProxyId> found;
  m_table.boxes.overlap(box, found);
  return bodiesOf(found, box, [&](const auto& shape, const Pose<D>& X_WS) { return overlapsBox(shape, X_WS, box); });
}

// Calls f(body, record, X_WS) for each shape with a box that overlaps `box` and passes the filter, by slots.
template <int D>
template <class F>
void BodyQueries<D>::forShapesNear(const Aabb<D>& box, const Filter& filter, const F& f) const {
  std::vector<ProxyId> found;
  m_table.boxes.overlap(box, found);
  std::sort(found.begin(), found.end());
  for (const ProxyId id : found) {
    const ShapeRecord<D>& s = m_table.shapes[static_cast<std::size_t>(id)];
    const BodyHandle body = m_table.handle(s.body);
    if (filter && !meets(*filter, body, s)) continue;
    f(body, s, m_table.bodies.pose[static_cast<std::size_t>(s.body)] * s.X_CS);
  }
}

template <int D>
std::vector<BodyHandle> BodyQueries<D>::overlap(const Shape<D>& shape, const Pose<D>& X_WS,
                                                const Filter& filter) const {
  const auto parts = partsOf("overlap", shape, X_WS);
  const Aabb<D> box = boundingBox(shape, X_WS);
  const auto method = createStage<PairQuery<D>>(Spec::parse(kGapQuery));
  std::vector<BodyHandle> out;
  std::vector<std::int32_t> near;
  WorkDone work;
  forShapesNear(box, filter, [&](BodyHandle body, const ShapeRecord<D>& s, const Pose<D>& X_WO) {
    if (std::find(out.begin(), out.end(), body) != out.end()) return;
    bool held = false;
    forPartsNear(s.shape, X_WO, {}, box, near, work, [&](std::int32_t, const auto& other, const Pose<D>& X_WP) {
      for (const auto& [part, X] : parts) {
        held = held || answerOf(*method, part, X, other, X_WP, QueryNeed::boolean).distance <= 0;
      }
    });
    if (held) out.push_back(body);
  });
  return out;
}

template <int D>
std::optional<BodyCastHit<D>> BodyQueries<D>::castFirst(const Shape<D>& shape, const Pose<D>& X_WS,
                                                        const Vec<D>& displacement, const Filter& filter) const {
  const auto parts = partsOf("castFirst", shape, X_WS);
  if (!displacement.allFinite()) throw UserError("castFirst: the displacement is not finite");
  const Aabb<D> start = boundingBox(shape, X_WS);
  const Aabb<D> box = start.merged({start.lo + displacement, start.hi + displacement});
  const auto method = createStage<TimeOfImpact<D>>(Spec::parse(kCast));
  std::optional<BodyCastHit<D>> best;
  std::vector<std::int32_t> near;
  WorkDone work;
  forShapesNear(box, filter, [&](BodyHandle body, const ShapeRecord<D>& s, const Pose<D>& X_WO) {
    forPartsNear(s.shape, X_WO, {}, box, near, work, [&](std::int32_t, const auto& target, const Pose<D>& X_WP) {
      const Aabb<D> bounds = boundingBox(target, X_WP);
      if (target.core() != CoreClass::plane && castBox(start, displacement, Real(1), bounds) < 0) return;
      for (const auto& [part, X] : parts) {
        const TimeOfImpactAnswer<D> found = castPart(*method, part, X, displacement, target, X_WP);
        if (!found.hit || (best && found.t >= best->t)) continue;
        const bool turned = part.kind > target.kind;  // then the answer is of (target, part), in the target's frame
        const Pose<D> X_WA = turned ? X_WP : Pose<D>{Vec<D>(X.p + found.t * displacement), X.q};
        const Vec<D> n = X_WA.q * found.there.normal;
        best = {body,
                s.index,
                found.t,
                Vec<D>(turned ? n : Vec<D>(-n)),
                X_WA * (turned ? found.there.pA : found.there.pB),
                s.userData};
      }
    });
  });
  return best;
}

template <int D>
std::optional<ClosestBody<D>> BodyQueries<D>::closest(const Vec<D>& point, Real maxDistance,
                                                      const Filter& filter) const {
  if (!point.allFinite()) throw UserError("closest: the point is not finite");
  if (!(maxDistance >= 0)) {
    throw UserError("closest: maxDistance is " + std::to_string(maxDistance) + "; valid: a number >= 0");
  }
  const Shape<D> dot = Shape<D>::sphere(0);
  const Pose<D> X_WD{point, {}};
  const auto method = createStage<PairQuery<D>>(Spec::parse(kGapQuery));
  std::optional<ClosestBody<D>> best;
  const auto reach = [&] { return best ? best->distance : maxDistance; };
  std::vector<std::int32_t> near;
  WorkDone work;
  const auto visit = [&](BodyHandle body, const ShapeRecord<D>& s, const Pose<D>& X_WO) {
    const auto measure = [&](std::int32_t, const ShapeView<D>& part, const Pose<D>& X_WP) {
      ClosestBody<D> found{body, s.index, 0, point, s.userData};
      if (!containsPoint(part, X_WP, point)) {
        const PairAnswer<D> answer = answerOf(*method, dot.view(), X_WD, part, X_WP, QueryNeed::closestPoints);
        found.distance = std::max(Real(0), answer.distance), found.point = point + answer.pB;
      }
      if (best ? found.distance < reach() : found.distance <= reach()) best = found;
    };
    forPartsNear(s.shape, X_WO, {}, Aabb<D>{point, point}.grown(reach()), near, work, measure);
  };
  forShapesNear(Aabb<D>{point, point}.grown(maxDistance), filter, visit);
  return best;
}

// The same for one body, without the broadphase.
template <int D>
template <class Holds>
bool BodyQueries<D>::anyPart(std::size_t i, const Aabb<D>& box, const Holds& holds) const {
  std::vector<std::int32_t> near;
  WorkDone work;
  bool held = false;
  for (const std::int32_t shape : m_table.shapesOf(i)) {
    const ShapeRecord<D>& s = m_table.shapes[static_cast<std::size_t>(shape)];
    forPartsNear(s.shape, m_table.bodies.pose[i] * s.X_CS, {}, box, near, work,
                 [&](std::int32_t, const auto& part, const Pose<D>& X_WP) { held = held || holds(part, X_WP); });
  }
  return held;
}

template <int D>
bool BodyQueries<D>::contains(std::size_t body, const Vec<D>& point) const {
  return anyPart(body, {point, point},
                 [&](const auto& shape, const Pose<D>& X_WS) { return containsPoint(shape, X_WS, point); });
}

template <int D>
bool BodyQueries<D>::intersects(std::size_t body, const Aabb<D>& box) const {
  return anyPart(body, box, [&](const auto& shape, const Pose<D>& X_WS) { return overlapsBox(shape, X_WS, box); });
}

template <int D>
std::vector<BodyRayHit<D>> BodyQueries<D>::rayAll(const Vec<D>& p, const Vec<D>& direction, Real maxT,
                                                  const Filter& filter) const {
  if (!p.allFinite() || !direction.allFinite()) throw UserError("ray: its start or direction is not finite");
  if (direction.isZero(0)) throw UserError("ray: its direction is zero; valid: any other direction, of any length");
  if (!(maxT >= 0)) throw UserError("ray: maxT is " + std::to_string(maxT) + "; valid: a number >= 0");
  // The longest coordinate becomes 0.5 to 1; otherwise the squares of short and long directions are 0 and infinite. A
  // power of two leaves all other bits unchanged.
  int exponent = 0;
  std::frexp(direction.cwiseAbs().maxCoeff(), &exponent);
  const Vec<D> along = direction.unaryExpr([&](Real x) { return std::ldexp(x, -exponent); });
  const Real end = std::ldexp(maxT, exponent);
  std::vector<RayHit<D>> found;
  m_table.boxes.ray(p, along, end, found);  // the first box need not hold the first hit
  std::vector<BodyRayHit<D>> out;
  std::vector<std::int32_t> near;
  for (const RayHit<D>& hit : found) {
    const ShapeRecord<D>& s = m_table.shapes[static_cast<std::size_t>(hit.proxy)];
    const BodyHandle body = m_table.handle(s.body);
    if (filter && !meets(*filter, body, s)) continue;
    const Pose<D> X_WS = m_table.bodies.pose[static_cast<std::size_t>(s.body)] * s.X_CS;
    RayEntry<D> first;
    const auto meet = [&](const ShapeView<D>& part, const Pose<D>& X_WP) {
      const RayEntry<D> entry = rayEntry(part, X_WP, p, along, end);
      if (entry.t >= 0 && (first.t < 0 || entry.t < first.t)) first = entry;
    };
    if (const Surface<D>* surface = s.shape.surface()) {
      meetOfSurface(*surface, X_WS, p, along, end, near, meet);
    } else {
      forParts(s.shape, X_WS, meet);
    }
    const Real t = std::ldexp(first.t, -exponent);
    if (t >= 0 && std::isfinite(t)) out.push_back({body, s.index, t, first.normal, s.userData});
  }
  std::sort(out.begin(), out.end(), [](const auto& a, const auto& b) {
    return std::tuple(a.t, a.body.slot, a.shape) < std::tuple(b.t, b.body.slot, b.shape);
  });
  return out;
}

template <int D>
std::optional<BodyRayHit<D>> BodyQueries<D>::rayFirst(const Vec<D>& p, const Vec<D>& direction, Real maxT,
                                                      const Filter& filter) const {
  const std::vector<BodyRayHit<D>> hits = rayAll(p, direction, maxT, filter);
  return hits.empty() ? std::nullopt : std::optional(hits.front());
}

template class BodyQueries<2>;
template class BodyQueries<3>;

}}  // namespace lpc::LPC_PRECISION
