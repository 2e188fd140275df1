// SPDX-License-Identifier: Zlib
#include "experiments/trial/scene/script_writer.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>

#include "experiments/trial/formats/body_type_name.h"
#include "experiments/trial/scene/scene_parsed.h"
#include "framework/math/names.h"
#include "framework/shape/curved_core.h"
#include "framework/shape/surface.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

std::string inQuotes(const std::string& text) {
  if (oneLine(text) != text)
    throw UserError("'" + oneLine(text) + "' has several lines; valid in a script: one line of text");
  if (text.find_first_of("\"\\") == text.npos) return '"' + text + '"';
  std::ostringstream out;
  out << toml::value<std::string>(text);
  return out.str();
}

// Always with a point or an exponent: an integer of TOML has no signed zero and only 64 bits.
std::string numberText(Real x) {
  if (!std::isfinite(x)) throw UserError("a number that is not finite cannot be written into a script");
  const std::string text = asText(double(x));
  return text.find_first_of(".e") == text.npos ? text + ".0" : text;
}

template <class Numbers>
std::string listText(const Numbers& numbers) {
  std::string out;
  for (const Real x : numbers) out += (out.empty() ? "" : ", ") + numberText(x);
  return "[" + out + "]";
}
std::string rotationText(const Rot<2>& q) { return listText(std::array{q.c, q.s}); }
std::string rotationText(const Rot<3>& q) { return listText(std::array{q.w, q.x, q.y, q.z}); }
std::string angularText(const Ang<2>& w) { return numberText(w[0]); }
std::string angularText(const Ang<3>& w) { return listText(w); }

template <int D>
std::string pointsText(std::span<const Vec<D>> all) {
  std::string out;
  for (const Vec<D>& p : all) out += (out.empty() ? "" : ", ") + listText(p);
  return "[" + out + "]";
}

std::string keyLine(const std::string& key, const std::string& value) { return key + " = " + value + "\n"; }
std::string flagText(bool x) { return x ? "true" : "false"; }

// Reading a hull computes it again from its corners, and rounded normals of slivers may differ: then the normals are
// written. A hull that still differs is refused.
bool sameHull(const Polytope<2>& a, const Polytope<2>& b) { return a.vertices == b.vertices && a.normals == b.normals; }
bool sameHull(const Polytope<3>& a, const Polytope<3>& b) {
  const auto same = [](const auto& f, const auto& g) {
    return f.normal == g.normal && f.offset == g.offset && f.begin == g.begin && f.end == g.end;
  };
  return a.vertices == b.vertices && a.loop == b.loop &&
         std::equal(a.faces.begin(), a.faces.end(), b.faces.begin(), b.faces.end(), same);
}
constexpr const char* kOtherHull = "a polytope with corners that give a different hull cannot be written into a script";

std::string normalsField(ShapeKind kind, const Polytope<2>& hull) {
  if (sameHull(hull, *Shape<2>::ofCorners(kind, hull.vertices).view().hull)) return "";
  throw UserError(kOtherHull);
}
std::string normalsField(ShapeKind kind, const Polytope<3>& hull) {
  if (sameHull(hull, *Shape<3>::ofCorners(kind, hull.vertices).view().hull)) return "";
  std::vector<Vec<3>> all;
  for (const auto& face : hull.faces) all.push_back(face.normal);
  if (kind != ShapeKind::polytope || !sameHull(hull, *hullWithNormals(hull.vertices, all))) throw UserError(kOtherHull);
  return ", normals = " + pointsText<3>(all);
}

// `kind = "box", half = [...]`, the fields of an inline table.
template <int D>
std::string shapeFields(const ShapeView<D>& v) {
  const std::string rounding = ", rounding = " + numberText(v.radius);
  const std::string kind = "kind = \"" + std::string(shapeKindName(v.kind)) + "\"";
  switch (v.core()) {
    case CoreClass::point:
      return kind + ", radius = " + numberText(v.radius);
    case CoreClass::segment: {
      const std::string length = ", half_length = " + numberText(v.half[0]);
      return kind + length + (v.kind == ShapeKind::capsule ? ", radius = " + numberText(v.radius) : "");
    }
    case CoreClass::box:
      return kind + ", half = " + listText(v.half) + rounding;
    case CoreClass::hull: {
      const std::span<const Vec<D>> corners(v.hull->vertices);
      return kind + ", points = " + pointsText<D>(corners) + normalsField(v.kind, *v.hull) + rounding;
    }
    case CoreClass::curved: {
      std::string sizes;
      const auto& names = curvedKind<D>(v.kind).sizes;
      for (std::size_t i = 0; i < names.size(); ++i) {
        sizes += ", " + std::string(names[i]) + " = " + numberText(v.curved->sizes()[i]);
      }
      return kind + sizes + rounding;
    }
    case CoreClass::plane:
      return kind;
  }
  return kind;
}

template <int D>
std::string shapeFields(const Shape<D>& shape) {
  if (const Surface<D>* surface = shape.surface()) {
    const std::string at = ", points = " + pointsText<D>(surface->points());
    if constexpr (D == 2) {
      const bool closed = surface->corners().size() == surface->points().size();
      return "kind = \"chain\"" + at + ", closed = " + flagText(closed);
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
      parts += (parts.empty() ? "{ " : ", { ") + shapeFields(part.shape) + ", offset = " + listText(part.X_SP.p) +
               ", rotation = " + rotationText(part.X_SP.q) + " }";
    }
    return "kind = \"compound\", parts = [" + parts + "]";
  }
  return shapeFields(shape.view());
}

template <int D>
std::string shapeTable(const ShapeDef<D>& s) {
  if (s.userData != 0) throw UserError("a shape with user data cannot be written into a script");
  return "  { " + shapeFields(s.shape) + ", offset = " + listText(s.X_BS.p) + ", rotation = " + rotationText(s.X_BS.q) +
         ", density = " + numberText(s.density) + ", friction = " + numberText(s.friction) +
         ", restitution = " + numberText(s.restitution) + ", category = " + std::to_string(s.category) +
         ", mask = " + std::to_string(s.mask) + " },\n";
}

template <int D>
std::string massKeys(const MassProperties<D>& m) {
  std::string inertia;
  if constexpr (D == 2) {
    inertia = numberText(m.inertia(0, 0));
  } else {
    for (int i = 0; i < 3; ++i) inertia += (i ? ", " : "[") + listText(Vec<3>(m.inertia.row(i).transpose()));
    inertia += "]";
  }
  return keyLine("mass", numberText(m.mass)) + keyLine("center", listText(m.center)) + keyLine("inertia", inertia);
}

// The file without the lines of those keys: TOML has at most one of them in a line.
std::string withoutKeys(const std::string& text, const toml::table& table, const std::vector<const char*>& keys) {
  std::set<std::size_t> gone;
  for (const char* key : keys) {
    const toml::node* node = table.get(key);
    if (!node) continue;
    for (auto line = node->source().begin.line; line <= node->source().end.line; ++line) gone.insert(line);
  }
  std::string out, line;
  std::istringstream in(text);
  for (std::size_t number = 1; std::getline(in, line); ++number) {
    if (!gone.count(number)) out += line + '\n';
  }
  return out;
}

}  // namespace

template <int D>
void ScriptWriter<D>::event(const char* what, long step, const std::string& keys) {
  m_events += "\n[[event]]\n" + keyLine("do", inQuotes(what)) + keyLine("step", std::to_string(step)) + keys;
}

template <int D>
void ScriptWriter<D>::add(long step, const std::string& name, const BodyDef<D>& body) {
  if (body.userData != 0) throw UserError("a body with user data cannot be written into a script");
  std::string keys = keyLine("name", inQuotes(name)) + keyLine("type", inQuotes(bodyTypeName(body.type))) +
                     keyLine("position", listText(body.X_WB.p)) + keyLine("rotation", rotationText(body.X_WB.q)) +
                     keyLine("velocity", listText(body.velocity)) +
                     keyLine("angular_velocity", angularText(body.angularVelocity));
  if (body.pinned) keys += keyLine("pinned", flagText(true));
  if (!body.rotatable) keys += keyLine("rotatable", flagText(false));
  if (!body.canSleep) keys += keyLine("can_sleep", flagText(false));
  if (!body.awake) keys += keyLine("awake", flagText(false));
  if (body.gravityScale != 1) keys += keyLine("gravity_scale", numberText(body.gravityScale));
  if (body.mass) keys += massKeys(*body.mass);
  std::string shapes;
  for (const ShapeDef<D>& s : body.shapes) shapes += shapeTable(s);
  keys += keyLine("exact", flagText(true));
  event("add", step, keys + keyLine("shapes", shapes.empty() ? "[]" : "[\n" + shapes + "]"));
}

template <int D>
void ScriptWriter<D>::remove(long step, const std::string& body) {
  event("remove", step, keyLine("body", inQuotes(body)));
}

template <int D>
void ScriptWriter<D>::push(long step, const std::string& body, const Wrench<D>& impulse) {
  event("push", step,
        keyLine("body", inQuotes(body)) + keyLine("impulse", listText(impulse.force)) +
            keyLine("angular_impulse", angularText(impulse.torque)));
}

template <int D>
void ScriptWriter<D>::force(long step, const std::string& body, const Wrench<D>& force) {
  event("force", step,
        keyLine("body", inQuotes(body)) + keyLine("force", listText(force.force)) +
            keyLine("torque", angularText(force.torque)));
}

template <int D>
void ScriptWriter<D>::pull(long step, const std::string& body, const Vec<D>& force, const Vec<D>& at) {
  event("force", step,
        keyLine("body", inQuotes(body)) + keyLine("force", listText(force)) + keyLine("at", listText(at)));
}

template <int D>
void ScriptWriter<D>::set(long step, const std::string& body, const Place& place) {
  std::string keys = keyLine("body", inQuotes(body));
  if (place.position) keys += keyLine("position", listText(*place.position));
  if (place.rotation) keys += keyLine("rotation", rotationText(*place.rotation));
  if (place.velocity) keys += keyLine("velocity", listText(*place.velocity));
  if (place.angularVelocity) keys += keyLine("angular_velocity", angularText(*place.angularVelocity));
  event("set", step, keys);
}

template <int D>
void ScriptWriter<D>::set(long step, const std::string& body, const Pose<D>& X_WB) {
  set(step, body, Place{.position = X_WB.p, .rotation = X_WB.q});
}

template <int D>
void ScriptWriter<D>::set(long step, const std::string& body, const Motion<D>& motion) {
  set(step, body, Place{.velocity = motion.v, .angularVelocity = motion.w});
}

template <int D>
void ScriptWriter<D>::joint(long step, const std::string& name, const JointDef<D>& def, const std::string& a,
                            const std::string& b) {
  std::string keys = keyLine("name", inQuotes(name)) + keyLine("kind", inQuotes(def.kind)) + keyLine("a", inQuotes(a)) +
                     keyLine("b", inQuotes(b)) + keyLine("anchor", listText(def.X_WJ.p)) +
                     keyLine("rotation", rotationText(def.X_WJ.q));
  if (def.X_WJb) {
    if (rotationText(def.X_WJb->q) != rotationText(def.X_WJ.q)) {
      throw UserError("a joint with rotated frames at creation cannot be written into a script");
    }
    keys += keyLine("anchor_b", listText(def.X_WJb->p));
  }
  if (def.collide) keys += keyLine("collide", flagText(true));
  if (std::isfinite(def.breakForce)) keys += keyLine("break_force", numberText(def.breakForce));
  if (std::isfinite(def.breakTorque)) keys += keyLine("break_torque", numberText(def.breakTorque));
  event("joint", step, keys);
  m_joins = true;
}

template <int D>
void ScriptWriter<D>::unjoin(long step, const std::string& joint) {
  event("unjoin", step, keyLine("joint", inQuotes(joint)));
}

template <int D>
void ScriptWriter<D>::addForce(long step, const std::string& name, const ForceDef<D>& def, const std::string& a,
                               const std::string& b) {
  std::string keys = keyLine("name", inQuotes(name)) + keyLine("kind", inQuotes(def.kind));
  if (!a.empty()) keys += keyLine("a", inQuotes(a));
  if (!b.empty()) keys += keyLine("b", inQuotes(b));
  if (def.anchorA) keys += keyLine("anchor_a", listText(*def.anchorA));
  if (def.anchorB) keys += keyLine("anchor_b", listText(*def.anchorB));
  event("add_force", step, keys);
}

template <int D>
void ScriptWriter<D>::removeForce(long step, const std::string& force) {
  event("remove_force", step, keyLine("force", inQuotes(force)));
}

template <int D>
void ScriptWriter<D>::merge(long step, const std::string& into, const std::string& other) {
  event("merge", step, keyLine("into", inQuotes(into)) + keyLine("other", inQuotes(other)));
}

template <int D>
void ScriptWriter<D>::splitByShape(long step, const std::string& body, std::span<const std::string> names) {
  std::string all;
  for (const std::string& name : names) all += (all.empty() ? "" : ", ") + inQuotes(name);
  event("take_apart", step, keyLine("body", inQuotes(body)) + keyLine("names", "[" + all + "]"));
}

template <int D>
void ScriptWriter<D>::wake(long step, const std::string& body) {
  event("wake", step, keyLine("body", inQuotes(body)));
}

template <int D>
void ScriptWriter<D>::wakeAll(long step) {
  event("wake", step, "");
}

template <int D>
void ScriptWriter<D>::gravity(long step, const Vec<D>& gravity) {
  event("gravity", step, keyLine("gravity", listText(gravity)));
}

template <int D>
void ScriptWriter<D>::clear(long step) {
  event("clear", step, "");
}

template <int D>
void ScriptWriter<D>::setPipeline(long step, const Pipeline& pipeline) {
  event("exchange", step, keyLine("pipeline", inQuotes(pipeline.text())));
}

template <int D>
void ScriptWriter<D>::material(long step, const std::string& body, const Material& material) {
  std::string keys = keyLine("body", inQuotes(body));
  if (material.friction) keys += keyLine("friction", numberText(*material.friction));
  if (material.restitution) keys += keyLine("restitution", numberText(*material.restitution));
  if (material.density) keys += keyLine("density", numberText(*material.density));
  event("material", step, keys);
}

template <int D>
void ScriptWriter<D>::pin(long step, const std::string& body, bool pinned) {
  event("pin", step, keyLine("body", inQuotes(body)) + keyLine("pinned", flagText(pinned)));
}

template <int D>
void ScriptWriter<D>::type(long step, const std::string& body, BodyType type) {
  event("type", step, keyLine("body", inQuotes(body)) + keyLine("type", inQuotes(bodyTypeName(type))));
}

template <int D>
std::string ScriptWriter<D>::text(const std::string& summary, std::optional<long> steps,
                                  const std::string& before) const {
  const toml::table other = parseToml(before, "the script before");
  std::set<std::string> needs;
  for (const std::string& need : TableReader(other, "the script before", "the script").strings("needs")) {
    needs.insert(need);
  }
  if (m_joins) needs.insert("joints");
  std::vector<const char*> keys = {"summary", "needs"};  // its own are above
  if (steps) keys.push_back("steps");
  std::string list;
  for (const std::string& need : needs) list += (list.empty() ? "" : ", ") + inQuotes(need);
  return keyLine("summary", inQuotes(summary)) + (needs.empty() ? "" : keyLine("needs", "[" + list + "]")) +
         (steps ? keyLine("steps", std::to_string(*steps)) : "") + withoutKeys(before, other, keys) + m_events;
}

template class ScriptWriter<2>;
template class ScriptWriter<3>;

}}  // namespace lpc::LPC_PRECISION
