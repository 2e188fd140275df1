// SPDX-License-Identifier: Zlib
#include "experiments/trial/script_writer.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "experiments/trial/scene_parsed.h"
#include "framework/curved_core.h"
#include "framework/names.h"
#include "framework/surface.h"

namespace lpc::inline LPC_PRECISION {
namespace {

std::string quoted(const std::string& text) {
  if (oneLine(text) != text) throw UserError("'" + oneLine(text) + "' is not one line of text, as a script needs");
  if (text.find_first_of("\"\\") == text.npos) return '"' + text + '"';
  std::ostringstream out;
  out << toml::value<std::string>(text);
  return out.str();
}

// Always with a point or an exponent: a whole number of TOML has no sign of zero and 64 bits.
std::string number(Real x) {
  if (!std::isfinite(x)) throw UserError("a number that is not finite cannot be written into a script");
  const std::string text = asText(double(x));
  return text.find_first_of(".e") == text.npos ? text + ".0" : text;
}

template <class Numbers>
std::string list(const Numbers& numbers) {
  std::string out;
  for (const Real x : numbers) out += (out.empty() ? "" : ", ") + number(x);
  return "[" + out + "]";
}
std::string rotation(const Rot<2>& q) { return list(std::array{q.c, q.s}); }
std::string rotation(const Rot<3>& q) { return list(std::array{q.w, q.x, q.y, q.z}); }
std::string angular(const Ang<2>& w) { return number(w[0]); }
std::string angular(const Ang<3>& w) { return list(w); }

template <int D>
std::string points(std::span<const Vec<D>> all) {
  std::string out;
  for (const Vec<D>& p : all) out += (out.empty() ? "" : ", ") + list(p);
  return "[" + out + "]";
}

std::string line(const std::string& key, const std::string& value) { return key + " = " + value + "\n"; }
std::string flag(bool x) { return x ? "true" : "false"; }

// A hull is sought again from its corners, and normals of slivers, which are made of rounding, may come out otherwise:
// then they are written. What comes out otherwise all the same must not be.
bool sameFaces(const Polytope<2>& a, const Polytope<2>& b) {
  return a.vertices == b.vertices && a.normals == b.normals;
}
bool sameFaces(const Polytope<3>& a, const Polytope<3>& b) {
  const auto same = [](const auto& f, const auto& g) {
    return f.normal == g.normal && f.offset == g.offset && f.begin == g.begin && f.end == g.end;
  };
  return a.vertices == b.vertices && a.loop == b.loop &&
         std::equal(a.faces.begin(), a.faces.end(), b.faces.begin(), b.faces.end(), same);
}
constexpr const char* kOtherHull =
    "a polytope whose hull is another when it is sought from its corners cannot be written";

std::string normals(ShapeKind kind, const Polytope<2>& hull) {
  if (sameFaces(hull, *Shape<2>::ofCorners(kind, hull.vertices).view().hull)) return "";
  throw UserError(kOtherHull);
}
std::string normals(ShapeKind kind, const Polytope<3>& hull) {
  if (sameFaces(hull, *Shape<3>::ofCorners(kind, hull.vertices).view().hull)) return "";
  std::vector<Vec<3>> all;
  for (const auto& face : hull.faces) all.push_back(face.normal);
  if (kind != ShapeKind::polytope || !sameFaces(hull, *hullWithNormals(hull.vertices, all)))
    throw UserError(kOtherHull);
  return ", normals = " + points<3>(all);
}

// `kind = "box", half = [...]`, the fields of an inline table.
template <int D>
std::string fields(const ShapeView<D>& v) {
  const std::string rounding = ", rounding = " + number(v.radius);
  const std::string kind = "kind = \"" + std::string(shapeKindName(v.kind)) + "\"";
  switch (v.core()) {
    case CoreClass::point:
      return kind + ", radius = " + number(v.radius);
    case CoreClass::segment: {
      const std::string length = ", half_length = " + number(v.half[0]);
      return kind + length + (v.kind == ShapeKind::capsule ? ", radius = " + number(v.radius) : "");
    }
    case CoreClass::box:
      return kind + ", half = " + list(v.half) + rounding;
    case CoreClass::hull: {
      const std::span<const Vec<D>> corners(v.hull->vertices);
      return kind + ", points = " + points<D>(corners) + normals(v.kind, *v.hull) + rounding;
    }
    case CoreClass::curved: {
      std::string sizes;
      const auto& names = curvedKind<D>(v.kind).sizes;
      for (std::size_t i = 0; i < names.size(); ++i) {
        sizes += ", " + std::string(names[i]) + " = " + number(v.curved->sizes()[i]);
      }
      return kind + sizes + rounding;
    }
    case CoreClass::plane:
      return kind;
  }
  return kind;
}

template <int D>
std::string fields(const Shape<D>& shape) {
  if (const Surface<D>* surface = shape.surface()) {
    const std::string at = ", points = " + points<D>(surface->points());
    if constexpr (D == 2) {
      const bool closed = surface->corners().size() == surface->points().size();
      return "kind = \"chain\"" + at + ", closed = " + flag(closed);
    } else {
      std::string triangles;
      for (const auto& t : surface->corners()) {
        triangles += (triangles.empty() ? "[" : ", [") + std::to_string(t[0]) + ", " + std::to_string(t[1]) + ", " +
                     std::to_string(t[2]) + "]";
      }
      return "kind = \"mesh\"" + at + ", triangles = [" + triangles + "]";
    }
  }
  if (!shape.convex()) {
    std::string parts;
    for (const ShapePart<D>& part : shape.parts()) {
      parts += (parts.empty() ? "{ " : ", { ") + fields(part.shape) + ", offset = " + list(part.X_SP.p) +
               ", rotation = " + rotation(part.X_SP.q) + " }";
    }
    return "kind = \"compound\", parts = [" + parts + "]";
  }
  return fields(shape.view());
}

template <int D>
std::string shapeTable(const ShapeDef<D>& s) {
  if (s.userData != 0) throw UserError("the user data of a shape cannot be written into a script");
  return "  { " + fields(s.shape) + ", offset = " + list(s.X_BS.p) + ", rotation = " + rotation(s.X_BS.q) +
         ", density = " + number(s.density) + ", friction = " + number(s.friction) +
         ", restitution = " + number(s.restitution) + ", category = " + std::to_string(s.category) +
         ", mask = " + std::to_string(s.mask) + " },\n";
}

template <int D>
std::string massKeys(const MassProperties<D>& m) {
  std::string inertia;
  if constexpr (D == 2) {
    inertia = number(m.inertia(0, 0));
  } else {
    for (int i = 0; i < 3; ++i) inertia += (i ? ", " : "[") + list(Vec<3>(m.inertia.row(i).transpose()));
    inertia += "]";
  }
  return line("mass", number(m.mass)) + line("center", list(m.center)) + line("inertia", inertia);
}

const char* typeName(BodyType type) {
  switch (type) {
    case BodyType::fixed:
      return "\"fixed\"";
    case BodyType::kinematic:
      return "\"kinematic\"";
    case BodyType::dynamic:
      return "\"dynamic\"";
  }
  return "";
}

}  // namespace

template <int D>
void ScriptWriter<D>::event(const char* what, long step, const std::string& keys) {
  m_events += "\n[[event]]\n" + line("do", quoted(what)) + line("step", std::to_string(step)) + keys;
}

template <int D>
void ScriptWriter<D>::add(long step, const std::string& name, const BodyDef<D>& body) {
  if (body.userData != 0) throw UserError("the user data of a body cannot be written into a script");
  std::string keys = line("name", quoted(name)) + line("type", typeName(body.type)) +
                     line("position", list(body.X_WB.p)) + line("rotation", rotation(body.X_WB.q)) +
                     line("velocity", list(body.velocity)) + line("angular_velocity", angular(body.angularVelocity));
  if (body.pinned) keys += line("pinned", flag(true));
  if (!body.rotatable) keys += line("rotatable", flag(false));
  if (!body.canSleep) keys += line("can_sleep", flag(false));
  if (!body.awake) keys += line("awake", flag(false));
  if (body.gravityScale != 1) keys += line("gravity_scale", number(body.gravityScale));
  if (body.mass) keys += massKeys(*body.mass);
  std::string shapes;
  for (const ShapeDef<D>& s : body.shapes) shapes += shapeTable(s);
  event("add", step, keys + line("shapes", shapes.empty() ? "[]" : "[\n" + shapes + "]"));
}

template <int D>
void ScriptWriter<D>::remove(long step, const std::string& body) {
  event("remove", step, line("body", quoted(body)));
}

template <int D>
void ScriptWriter<D>::push(long step, const std::string& body, const Wrench<D>& impulse) {
  event("push", step,
        line("body", quoted(body)) + line("impulse", list(impulse.force)) +
            line("angular_impulse", angular(impulse.torque)));
}

template <int D>
void ScriptWriter<D>::force(long step, const std::string& body, const Wrench<D>& force) {
  event("force", step,
        line("body", quoted(body)) + line("force", list(force.force)) + line("torque", angular(force.torque)));
}

template <int D>
void ScriptWriter<D>::set(long step, const std::string& body, const Pose<D>& X_WB) {
  event("set", step, line("body", quoted(body)) + line("position", list(X_WB.p)) + line("rotation", rotation(X_WB.q)));
}

template <int D>
void ScriptWriter<D>::set(long step, const std::string& body, const Motion<D>& motion) {
  event("set", step,
        line("body", quoted(body)) + line("velocity", list(motion.v)) + line("angular_velocity", angular(motion.w)));
}

template <int D>
void ScriptWriter<D>::joint(long step, const std::string& name, const JointDef<D>& def, const std::string& a,
                            const std::string& b) {
  std::string keys = line("name", quoted(name)) + line("kind", quoted(def.kind)) + line("a", quoted(a)) +
                     line("b", quoted(b)) + line("anchor", list(def.X_WJ.p)) + line("rotation", rotation(def.X_WJ.q));
  if (def.X_WJb) {
    if (rotation(def.X_WJb->q) != rotation(def.X_WJ.q)) {
      throw UserError("a joint whose two frames are turned against each other cannot be written into a script");
    }
    keys += line("anchor_b", list(def.X_WJb->p));
  }
  if (def.collide) keys += line("collide", flag(true));
  if (std::isfinite(def.breakForce)) keys += line("break_force", number(def.breakForce));
  if (std::isfinite(def.breakTorque)) keys += line("break_torque", number(def.breakTorque));
  event("joint", step, keys);
}

template <int D>
void ScriptWriter<D>::unjoin(long step, const std::string& joint) {
  event("unjoin", step, line("joint", quoted(joint)));
}

template <int D>
void ScriptWriter<D>::addForce(long step, const std::string& name, const ForceDef<D>& def, const std::string& a,
                               const std::string& b) {
  std::string keys = line("name", quoted(name)) + line("kind", quoted(def.kind));
  if (!a.empty()) keys += line("a", quoted(a));
  if (!b.empty()) keys += line("b", quoted(b));
  if (def.anchorA) keys += line("anchor_a", list(*def.anchorA));
  if (def.anchorB) keys += line("anchor_b", list(*def.anchorB));
  event("add_force", step, keys);
}

template <int D>
void ScriptWriter<D>::removeForce(long step, const std::string& force) {
  event("remove_force", step, line("force", quoted(force)));
}

template <int D>
void ScriptWriter<D>::merge(long step, const std::string& into, const std::string& other) {
  event("merge", step, line("into", quoted(into)) + line("other", quoted(other)));
}

template <int D>
void ScriptWriter<D>::takeApart(long step, const std::string& body, std::span<const std::string> names) {
  std::string all;
  for (const std::string& name : names) all += (all.empty() ? "" : ", ") + quoted(name);
  event("take_apart", step, line("body", quoted(body)) + line("names", "[" + all + "]"));
}

template <int D>
void ScriptWriter<D>::wake(long step, const std::string& body) {
  event("wake", step, line("body", quoted(body)));
}

template <int D>
void ScriptWriter<D>::wakeAll(long step) {
  event("wake", step, "");
}

template <int D>
void ScriptWriter<D>::gravity(long step, const Vec<D>& gravity) {
  event("gravity", step, line("gravity", list(gravity)));
}

template <int D>
void ScriptWriter<D>::clear(long step) {
  event("clear", step, "");
}

template <int D>
void ScriptWriter<D>::exchange(long step, const Pipeline& pipeline) {
  event("exchange", step, line("pipeline", quoted(pipeline.text())));
}

template <int D>
void ScriptWriter<D>::material(long step, const std::string& body, const Material& material) {
  std::string keys = line("body", quoted(body));
  if (material.friction) keys += line("friction", number(*material.friction));
  if (material.restitution) keys += line("restitution", number(*material.restitution));
  if (material.density) keys += line("density", number(*material.density));
  event("material", step, keys);
}

template <int D>
void ScriptWriter<D>::pin(long step, const std::string& body, bool pinned) {
  event("pin", step, line("body", quoted(body)) + line("pinned", flag(pinned)));
}

template <int D>
std::string ScriptWriter<D>::text(const std::string& summary, std::optional<long> steps) const {
  return line("summary", quoted(summary)) + (steps ? line("steps", std::to_string(*steps)) : "") + m_events;
}

template class ScriptWriter<2>;
template class ScriptWriter<3>;

}  // namespace lpc::inline LPC_PRECISION
