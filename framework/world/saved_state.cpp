// SPDX-License-Identifier: Zlib
#include "framework/world/saved_state.h"

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

#include "framework/math/user_numbers.h"
#include "framework/shape/shape_tolerances.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

void require(bool sound, std::string_view otherwise, std::string_view rest = "") {
  if (sound) return;
  throw UserError("load: the saved world is damaged (" + std::string(otherwise) + std::string(rest) + ")");
}

bool isFlag(std::uint8_t x) { return x <= 1; }
bool isAmount(Real x) { return x >= 0 && std::isfinite(x); }
template <class Table>
bool holds(const Table& table, std::int64_t i) {
  return i >= 0 && i < static_cast<std::int64_t>(table.size());
}

template <int D>
bool isBody(const Bodies<D>& b, std::int32_t slot) {
  return holds(b.used, slot) && b.used[static_cast<std::size_t>(slot)];
}

template <int D>
void checkBodies(const Bodies<D>& b, std::size_t userForces) {
  const std::size_t n = b.pose.size();
  require(n <= std::size_t(std::numeric_limits<std::int32_t>::max()), "more bodies than can be counted");
  for (const std::size_t size :
       {b.motion.size(), b.mass.size(), b.invInertiaBody.size(), b.center.size(), b.type.size(), b.used.size(),
        b.awake.size(), b.canSleep.size(), b.pinned.size(), b.sleep.size(), b.solver.size(), b.generation.size(),
        b.userData.size(), b.rotatable.size(), b.gravityScale.size(), b.givenMass.size(), userForces}) {
    require(size == n, "the tables of bodies have unequal lengths");
  }
  for (std::size_t i = 0; i < n; ++i) {
    require(b.type[i] <= BodyType::dynamic, "a body of unknown type");
    require(isFlag(b.used[i]) && isFlag(b.awake[i]) && isFlag(b.canSleep[i]) && isFlag(b.pinned[i]) &&
                isFlag(b.rotatable[i]),
            "a body's flag is neither 0 nor 1");
    require(isAmount(b.mass[i]), "a mass is not a finite number >= 0");
    require(!b.used[i] || b.type[i] != BodyType::dynamic || b.mass[i] > 0, "a dynamic body without mass");
    require(b.center[i].allFinite(), "a centre of mass is not finite");
    require(std::isfinite(b.gravityScale[i]), "a body's gravity scale is not finite");
    const auto& given = b.givenMass[i];
    require(!given || (isAmount(given->mass) && given->center.allFinite() && given->inertia.allFinite() &&
                       isInertia(given->inertia)),
            "a given mass belongs to no body");
  }
}

// True when the size is within reach of the arithmetic. convexHull measures from any given point; this measures from a
// corner.
template <int D>
bool isExtent(const std::vector<Vec<D>>& vertices) {
  return std::all_of(vertices.begin(), vertices.end(), [&](const Vec<D>& v) {
    return v.allFinite() && double((v - vertices[0]).cwiseAbs().maxCoeff()) <= 2 * kLargestExtent;
  });
}
template <int D>
bool isNormal(const Vec<D>& n) {
  return std::abs(double(n.norm()) - 1) < kFaceNormalError;
}

void checkHull(const Polytope<2>& hull) {
  require(hull.vertices.size() >= 3 && hull.normals.size() == hull.vertices.size(), "a polygon with missing edges");
  require(isExtent<2>(hull.vertices), "a polygon's vertex is not finite");
  require(std::all_of(hull.normals.begin(), hull.normals.end(), isNormal<2>),
          "a polygon's normal is not a unit vector");
}

void checkHull(const Polytope<3>& hull) {
  require(hull.vertices.size() >= 4 && hull.vertices.size() + hull.faces.size() == hull.edges.size() + 2 &&
              hull.loop.size() == 2 * hull.edges.size(),
          "a polytope that is not closed");
  require(isExtent<3>(hull.vertices), "a polytope's vertex is not finite");
  for (const int v : hull.loop) require(holds(hull.vertices, v), "a polytope's face refers to an invalid vertex");
  std::int64_t end = 0;
  for (const auto& f : hull.faces) {
    require(f.begin == end && std::int64_t(f.end) - f.begin >= 3, "a polytope's face with fewer than three corners");
    require(isNormal<3>(f.normal) && std::isfinite(f.offset), "a polytope's face with an invalid plane");
    end = f.end;
  }
  require(end == static_cast<std::int64_t>(hull.loop.size()), "the faces of a polytope do not use all its corners");
  // Edge walks rely on this: an edge runs in the direction of its first face, and against that of its second.
  std::vector<std::array<int, 3>> sides;
  for (std::size_t f = 0; f < hull.faces.size(); ++f) {
    const auto& face = hull.faces[f];
    for (int i = face.begin; i < face.end; ++i) {
      const int next = i + 1 < face.end ? i + 1 : face.begin;
      sides.push_back(
          {hull.loop[static_cast<std::size_t>(i)], hull.loop[static_cast<std::size_t>(next)], static_cast<int>(f)});
    }
  }
  std::sort(sides.begin(), sides.end());
  const auto isSide = [&](int from, int to, int face) {
    return std::binary_search(sides.begin(), sides.end(), std::array<int, 3>{from, to, face});
  };
  for (const auto& e : hull.edges) {
    require(holds(hull.vertices, e.v0) && holds(hull.vertices, e.v1) && e.v0 != e.v1 && holds(hull.faces, e.faceA) &&
                holds(hull.faces, e.faceB),
            "a polytope's edge refers to an invalid vertex or face");
    require(isSide(e.v0, e.v1, e.faceA) && isSide(e.v1, e.v0, e.faceB), "a polytope's edge is not on its faces");
  }
}

template <int D>
void checkShapes(const SavedState<D>& saved, const ContactGenerator<D>& contacts) {
  std::array<bool, kShapeKinds> kinds{};
  for (const ShapeRecord<D>& s : saved.shapes) {
    require(s.body == -1 || isBody(saved.bodies, s.body), "a shape refers to an invalid body");
    if (s.body < 0) continue;
    markKinds(s.shape, kinds);
    forParts(s.shape, s.X_CS, [&](const ShapeView<D>& part, const auto&) {
      if (part.kind == ShapeKind::polytope) checkHull(*part.hull);  // a triangle was built again from its corners
    });
    require(s.X_CS.p.allFinite() && isUnit(s.X_CS.q), "a shape's pose is invalid");
    require(isAmount(s.friction) && isAmount(s.restitution) && isAmount(s.density),
            "friction, restitution or density is not a finite number >= 0");
    require(!s.shape.isPlane() || saved.bodies.type[static_cast<std::size_t>(s.body)] == BodyType::fixed,
            "a plane on a body that is not fixed");
    require(!s.shape.surface() || saved.bodies.type[static_cast<std::size_t>(s.body)] == BodyType::fixed,
            "a mesh or chain on a body that is not fixed");
  }
  requireContacts(contacts, kinds, "load: this world's contact generator");
}

// Checks the owners of a manifold's or record's shapes. `subject` names the manifold or record in messages.
template <int D, class Pair>
void checkPair(const SavedState<D>& saved, const Pair& p, std::string_view subject) {
  const auto isShapeOf = [&](std::int32_t shape, std::int32_t body) {
    return holds(saved.shapes, shape) && saved.shapes[static_cast<std::size_t>(shape)].body == body;
  };
  require(isBody(saved.bodies, p.bodyA) && isBody(saved.bodies, p.bodyB) && p.bodyA < p.bodyB, subject,
          " refers to an invalid body");
  require(isShapeOf(p.shapeA, p.bodyA) && isShapeOf(p.shapeB, p.bodyB), subject, " refers to an invalid shape");
  require(p.partA >= 0 && p.partB >= 0, subject, " has a negative part number");
}

template <int D>
void checkRecords(const SavedState<D>& saved) {
  const PairRecord* before = nullptr;
  for (const PairRecord& r : saved.records) {
    checkPair(saved, r, "a record");
    require(!before || before->key() < r.key(), "pair records out of order");
    before = &r;
  }
}

template <int D>
void checkManifolds(const SavedState<D>& saved) {
  const Manifold<D>* before = nullptr;
  for (const Manifold<D>& m : saved.manifolds) {
    checkPair(saved, m, "a contact");
    require(m.count >= 1 && m.count <= kManifoldPoints<D>, "a contact with an invalid number of points");
    require(isFlag(m.begun) && isFlag(m.ignored), "a contact's flag is neither 0 nor 1");
    require(!before || !(m.key() < before->key()), "contacts out of order");
    before = &m;
  }
}

}  // namespace

template <int D>
void requireValidState(const SavedState<D>& saved, const ContactGenerator<D>& contacts) {
  const WorldSettings<D>& s = saved.settings;
  require(s.gravity.allFinite() && isAmount(s.margin) && isAmount(s.restitutionThreshold), "a setting is not finite");
  for (const MixRule rule : {s.mixing.friction, s.mixing.restitution}) {
    require(static_cast<std::size_t>(rule) < kMixRuleNames.size(), "an unknown mixing rule");
  }
  require(isAmount(saved.time) && isAmount(saved.lastDt) && isAmount(saved.sinceContacts),
          "the time is not a finite number >= 0");
  require(saved.steps >= 0 && saved.steps <= std::numeric_limits<std::int64_t>::max() / 2,
          "the number of steps has overflowed");
  checkBodies(saved.bodies, saved.userForces.size());
  checkShapes(saved, contacts);
  for (const JointRecord<D>& j : saved.joints) {
    if (!j.kind) continue;
    require((j.bodyA == -1 || isBody(saved.bodies, j.bodyA)) && isBody(saved.bodies, j.bodyB) && j.bodyA != j.bodyB,
            "a joint refers to an invalid body");
    require(isFlag(j.collide) && isFlag(j.broken), "a joint's flag is neither 0 nor 1");
    require(j.breakForce > 0 && j.breakTorque > 0, "a joint's break force or torque is not above 0");
    require(isUnit(j.X_CaJ.q) && isUnit(j.X_CbJ.q), "a joint's frame is not a rotation");
    require(j.X_CaJ.p.allFinite() && j.X_CbJ.p.allFinite(), "a joint's frame is not at a finite position");
  }
  for (const ForceRecord<D>& f : saved.forces) {
    if (!f.kind) continue;
    const ForceEnds ends = f.kind->ends();
    require((f.bodyA == -1 || (ends.from && isBody(saved.bodies, f.bodyA))) &&
                (f.bodyB == -1 ? ends.all : isBody(saved.bodies, f.bodyB) && f.bodyA != f.bodyB),
            "a force refers to an invalid body");
    require(f.localA.allFinite() && f.localB.allFinite(), "a force's anchor is not finite");
  }
  checkManifolds(saved);
  checkRecords(saved);
  for (const SleepEvent& e : saved.events) {
    require(e.kind <= SleepEvent::bodyAdded, "an event of unknown kind");
    require(holds(saved.bodies.used, e.body) && (e.other == -1 || holds(saved.bodies.used, e.other)),
            "an event refers to an invalid body");
  }
}

template void requireValidState(const SavedState<2>&, const ContactGenerator<2>&);
template void requireValidState(const SavedState<3>&, const ContactGenerator<3>&);

}}  // namespace lpc::LPC_PRECISION
