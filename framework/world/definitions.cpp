// SPDX-License-Identifier: Zlib
#include "framework/world/definitions.h"

#include <cmath>
#include <cstdio>
#include <optional>

#include "framework/math/inverse_inertia.h"
#include "framework/math/user_numbers.h"
#include "framework/shape/surface.h"
#include "framework/stage/stage_narrowphase.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

template <int D>
bool isFinite(const MassProperties<D>& m) {
  return std::isfinite(m.mass) && m.center.allFinite() && m.inertia.allFinite();
}

// The largest coefficient of a shape: no rule that mixes two of them overflows, not even their product in f32. Larger:
// it would be infinite. Smaller: refuses more.
constexpr Real kLargestCoefficient = Real(1e18);

void checkCoefficient(Real value, const std::string& subject, const char* what) {
  checkAmount(value, subject, what);
  if (value <= kLargestCoefficient) return;
  throw UserError(subject + ": " + what + " is " + std::to_string(value) + "; valid: 0 to 1e18");
}

template <int D>
void checkShape(const ShapeDef<D>& s, const std::string& subject) {
  checkPose(s.X_BS, subject + ", shape");
  checkAmount(s.density, subject, "density");
  checkCoefficient(s.friction, subject, "friction");
  checkCoefficient(s.restitution, subject, "restitution");
}

template <int D>
void checkGivenMass(const MassProperties<D>& m, const std::string& subject) {
  checkAmount(m.mass, subject, "the mass (kg)");
  if (!m.center.allFinite() || !m.inertia.allFinite())
    throw UserError(subject + ": its centre or inertia is not finite");
  if (isInertia(m.inertia)) return;
  throw UserError(subject + ": the inertia is not that of a rigid body; valid: " +
                  (D == 2 ? "a number >= 0"
                          : "a symmetric matrix with principal values >= 0, each at most the sum of the other two"));
}

// Mass properties in the world frame.
template <int D>
MassProperties<D> weightOf(const BodyDef<D>& def) {
  MassProperties<D> mass;
  for (const ShapeDef<D>& s : def.shapes) {
    mass = combined(mass, transformed(massProperties(s.shape, s.density), s.X_BS));
  }
  return transformed(def.mass ? *def.mass : mass, def.X_WB);
}

// One rigid motion with the momenta of both bodies.
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
std::string bodyLabel(const BodyDef<D>& def) {
  return def.name.empty() ? "body" : "body '" + def.name + "'";
}

template <int D>
CheckedBody<D> checkBody(const BodyDef<D>& def) {
  const std::string subject = bodyLabel(def);
  checkPose(def.X_WB, subject);
  checkMotion(Motion<D>{def.velocity, def.angularVelocity}, subject);
  if (!std::isfinite(def.gravityScale)) throw UserError(subject + ": the gravity scale is not finite");
  CheckedBody<D> w;
  w.shapes = def.shapes;
  for (ShapeDef<D>& s : w.shapes) {
    checkShape(s, subject);
    const ShapePart<D> near = centredPart<D>({s.shape, s.X_BS});
    s.shape = near.shape, s.X_BS = near.X_SP;
    const MassProperties<D> part = transformed(massProperties(s.shape, s.density), s.X_BS);
    w.mass = combined(w.mass, part);
    if (!isFinite(part) || !isFinite(w.mass)) {
      throw UserError(subject + ": its mass, " + std::to_string(part.mass) +
                      " kg, or its inertia is too large; valid: smaller ones");
    }
    if (s.shape.isPlane() && def.type != BodyType::fixed) {
      throw UserError(subject + ": a plane on a moving body; valid: a fixed body, or a bounded shape");
    }
    if (s.shape.surface() && def.type != BodyType::fixed) {
      throw UserError(subject + ": a " + (D == 2 ? "chain" : "mesh") +
                      " on a moving body; valid for moving bodies: convex shapes or a compound of them");
    }
    markKinds(s.shape, w.kinds);
  }
  if (def.mass) {
    checkGivenMass(*def.mass, subject);
    w.mass = *def.mass;
  }
  if (def.type == BodyType::dynamic && !(w.mass.mass > 0)) {
    throw UserError(subject +
                    ": a dynamic body without mass; valid: a mass, a shape with density > 0, or a fixed body");
  }
  if (def.type == BodyType::dynamic) {
    std::optional<Inertia<D>> inverse = Inertia<D>(Inertia<D>::Zero());
    if (def.rotatable && w.mass.inertia.trace() > 0) inverse = inverseInertia<D>(w.mass.inertia);
    if (!std::isfinite(1 / w.mass.mass) || !inverse) {
      char kilograms[32];
      std::snprintf(kilograms, sizeof kilograms, "%g", double(w.mass.mass));
      throw UserError(subject + ": its mass, " + kilograms +
                      " kg, or its inertia is too small to invert; valid: larger ones");
    }
    w.invInertia = *inverse;
  }
  return w;
}

template <int D>
BodyDef<D> merged(const BodyDef<D>& a, const BodyDef<D>& b) {
  if (a.type != b.type || a.type == BodyType::kinematic) {
    throw UserError("merge: the bodies differ in type or are kinematic; valid: two dynamic or two fixed bodies");
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
  return def;
}

template <int D>
std::vector<BodyDef<D>> splitDefinition(const BodyDef<D>& whole, const Vec<D>& center) {
  std::vector<BodyDef<D>> parts;
  for (const ShapeDef<D>& s : whole.shapes) {
    BodyDef<D>& part = parts.emplace_back(whole);
    part.shapes = {s}, part.mass.reset();
    const Vec<D> by = whole.X_WB.q * Vec<D>(checkBody(part).mass.center - center);
    if (&s != &whole.shapes[0]) part.velocity += cross(whole.angularVelocity, by);
    if (whole.pinned) part.velocity.setZero();
  }
  return parts;
}

#define LPC_INSTANTIATE(D)                                          \
  template std::string bodyLabel(const BodyDef<D>&);                \
  template CheckedBody<D> checkBody(const BodyDef<D>&);             \
  template BodyDef<D> merged(const BodyDef<D>&, const BodyDef<D>&); \
  template std::vector<BodyDef<D>> splitDefinition(const BodyDef<D>&, const Vec<D>&)
LPC_INSTANTIATE(2);
LPC_INSTANTIATE(3);
#undef LPC_INSTANTIATE

}}  // namespace lpc::LPC_PRECISION
