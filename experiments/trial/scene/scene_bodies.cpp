// SPDX-License-Identifier: Zlib
// Bodies and shapes of scene files.
#include <algorithm>
#include <array>
#include <cmath>

#include "experiments/trial/formats/body_type_name.h"
#include "experiments/trial/scene/scene_parsed.h"
#include "framework/math/inverse_inertia.h"
#include "framework/math/names.h"
#include "framework/shape/curved_core.h"
#include "framework/shape/mass.h"
#include "framework/shape/shape_tolerances.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

// A polytope with the given number of `corners`, at random positions on a circle or ball of this `radius`. Each corner
// stays in its own sector; otherwise some would be needles: a triangle has at least 0.4 radius^2, a hull of four
// corners 0.15 radius^3. Two numbers are drawn for each corner in either dimension.
template <int D>
std::vector<Vec<D>> drawCorners(TableReader& shape, SceneNumbers& numbers) {
  constexpr double kTurn = 6.283185307179586, kGoldenTurn = 2.399963229728653;  // of Vogel's spiral, pi (3 - sqrt 5)
  constexpr double kOfShare = 0.8, kOfTurn = 0.4;  // fraction of its sector by which a corner may move
  constexpr long kMost = 1000;
  const auto radius = static_cast<Real>(numbers.number(shape.require("radius")));
  const toml::node& place = shape.require("corners");
  const long n = numbers.whole(shape, "corners", 0, numbers.rehearsing() ? 0 : D + 1, kMost);
  std::vector<Vec<D>> corners;
  if (numbers.rehearsing()) return corners;
  numbers.count(place, "points", n);
  const auto chance = [&] { return numbers.expressions.evaluate("rand(0, 1)"); };
  for (long k = 0; k < n; ++k) {
    const double u = chance(), v = chance(), first = (1 - kOfShare) / 2;
    const double share = (static_cast<double>(k) + first + kOfShare * u) / static_cast<double>(n);
    double s, c;
    if constexpr (D == 2) {
      sinCos(kTurn * share, s, c);
      corners.emplace_back(radius * static_cast<Real>(c), radius * static_cast<Real>(s));
    } else {
      const double y = 1 - 2 * share, r = std::sqrt(1 - y * y);
      sinCos(kGoldenTurn * (static_cast<double>(k) + kOfTurn * v), s, c);
      corners.push_back(radius * Vec<3>(static_cast<Real>(r * c), static_cast<Real>(y), static_cast<Real>(r * s)));
    }
  }
  return corners;
}

// A block that makes nothing in this dimension may belong to the other one: all kinds of both dimensions are valid,
// with the sizes of both.
template <int D>
bool rehearseCurved(TableReader& shape, SceneNumbers& numbers, const std::string& kind) {
  for (const auto& [curved, made] : curvedKinds<D>()) {
    if (shapeKindName(curved) != kind) continue;
    for (const std::string_view s : made.sizes) numbers.number(shape, std::string(s), 0);
    return true;
  }
  return false;
}

template <int D>
Shape<D> readConvex(TableReader& shape, SceneNumbers& numbers, const std::string& kind) {
  const auto size = [&](const std::string& key) { return static_cast<Real>(numbers.number(shape.require(key))); };
  const auto rounding = static_cast<Real>(numbers.number(shape, "rounding", 0));
  if (kind == "sphere" || kind == "circle") return Shape<D>::sphere(size("radius"));
  if (kind == "box") return Shape<D>::box(numbers.vector<D>(shape.require("half")), rounding);
  if (kind == "capsule") return Shape<D>::capsule(size("half_length"), size("radius"));
  if (kind == "polytope" && shape.find("file")) return readHull<D>(shape, numbers, rounding);
  if (kind == "polytope" && shape.find("corners")) {
    const std::vector<Vec<D>> corners = drawCorners<D>(shape, numbers);
    return numbers.rehearsing() ? Shape<D>() : Shape<D>::polytope(corners, rounding);
  }
  if (kind == "polytope") {
    const std::vector<Vec<D>> corners = readPoints<D>(shape, numbers);
    if constexpr (D == 3) {
      if (const toml::node* n = shape.find("normals")) {
        std::vector<Vec<3>> normals;
        const toml::array* list = n->as_array();
        if (!list) shape.fail(*n, "'normals' is " + describe(*n) + "; valid: a list of vectors, one for each face");
        for (const toml::node& normal : *list) normals.push_back(numbers.vector<3>(normal));
        return Shape<3>::polytope(hullWithNormals(corners, normals), rounding);
      }
    }
    return Shape<D>::polytope(corners, rounding);
  }
  if (kind == "segment") return Shape<D>::segment(size("half_length"));
  if (kind == "triangle") return Shape<D>::ofCorners(ShapeKind::triangle, readPoints<D>(shape, numbers), rounding);
  if (kind == "mesh") return readSurface<D>(shape, numbers);
  if (kind == "chain") {
    const bool closed = shape.flag("closed", false);
    return Shape<D>::chain(readPoints<D>(shape, numbers), closed);
  }
  if (kind == "plane") return Shape<D>::plane();
  std::vector<std::string> valid = {"sphere", "circle", "box", "capsule", "polytope", "plane", "compound"};
  for (const char* own : D == 2 ? std::array{"segment", "chain"} : std::array{"triangle", "mesh"}) valid.push_back(own);
  if (numbers.rehearsing()) {
    const bool planar = rehearseCurved<2>(shape, numbers, kind), solid = rehearseCurved<3>(shape, numbers, kind);
    if (planar || solid) return {};
  }
  for (const auto& [curved, made] : curvedKinds<D>()) {
    const std::string name(shapeKindName(curved));
    valid.push_back(name);
    if (name != kind) continue;
    std::vector<Real> sizes;
    for (const std::string_view s : made.sizes) sizes.push_back(size(std::string(s)));
    return Shape<D>::curved(curved, sizes, rounding);
  }
  shape.fail(shape.require("kind"), "unknown shape kind '" + kind + "'" + validNames(valid, kind));
}

template <int D>
ShapePart<D> readPlaced(TableReader& shape, SceneNumbers& numbers);

template <int D>
Shape<D> readCompound(TableReader& shape, SceneNumbers& numbers) {
  const std::string overlap = shape.string("overlap", "counted");
  if (overlap != "counted" && overlap != "refused") {
    shape.fail(*shape.find("overlap"), "'overlap' is '" + overlap + "'; valid: counted, refused");
  }
  constexpr long kMostParts = 10000;  // more are a typing error
  std::vector<ShapePart<D>> parts;
  shape.require("parts");
  for (const toml::table* t : shape.blocks("parts")) {
    TableReader part(*t, shape.file(), "a part");
    const std::string kind = part.requireString("kind");
    if (kind == "plane" || kind == "compound" || kind == "mesh" || kind == "chain") {
      part.fail("a part is a " + kind + "; valid: bounded convex shapes");
    }
    const long n = numbers.whole(part, "repeat", 1, 0, kMostParts);
    numbers.count(part.raw(), "shapes", n);
    for (long i = 0; i < n; ++i) {
      numbers.expressions.setLocal("part", static_cast<double>(i));
      parts.push_back(readPlaced<D>(part, numbers));
    }
    numbers.expressions.setLocal("part", 0);
    if (n == 0) {
      const SceneNumbers::Rehearsal rehearsal(numbers);
      readPlaced<D>(part, numbers);
    }
    part.finish();
    if (parts.size() > static_cast<std::size_t>(kMostParts)) shape.fail("more than 10000 parts");
  }
  if (numbers.rehearsing()) return {};
  return Shape<D>::compound(parts, overlap == "refused" ? PartOverlap::refused : PartOverlap::counted);
}

template <int D>
ShapePart<D> readPlaced(TableReader& shape, SceneNumbers& numbers) {
  ShapePart<D> placed;
  const std::string kind = shape.requireString("kind");
  try {
    placed.shape = kind == "compound" ? readCompound<D>(shape, numbers) : readConvex<D>(shape, numbers, kind);
  } catch (const PlacedError&) {
    throw;
  } catch (const UserError& e) {  // of the shape factories
    const std::string_view what = e.what();
    if (!numbers.rehearsing()) shape.fail(what.starts_with(kind) ? std::string(what) : kind + ": " + std::string(what));
  }
  placed.X_SP.p = numbers.vector<D>(shape, "offset");
  placed.X_SP.q = readRotation<D>(shape, numbers);
  return placed;
}

template <int D>
ShapeDef<D> readShape(TableReader& shape, SceneNumbers& numbers, const toml::table* defaults,
                      const Settings& settings) {
  const ShapePart<D> placed = readPlaced<D>(shape, numbers);
  ShapeDef<D> def = settings.shape<D>(placed.shape);
  def.X_BS = placed.X_SP;
  const auto material = [&](const char* key, Real& value) {
    if (const toml::node* n = shape.find(key)) {
      value = static_cast<Real>(numbers.between(*n, key, 0, kLargest));
    } else if (defaults && defaults->get(key)) {
      value = static_cast<Real>(numbers.between(*defaults->get(key), key, 0, kLargest));
    }
  };
  material("density", def.density);
  material("friction", def.friction);
  material("restitution", def.restitution);
  constexpr long kAllBits = 0xffffffff;
  def.category = static_cast<std::uint32_t>(numbers.whole(shape, "category", def.category, 0, kAllBits));
  def.mask = static_cast<std::uint32_t>(numbers.whole(shape, "mask", def.mask, 0, kAllBits));
  shape.finish();
  return def;
}

// A number is the same about every axis; a list of three is the diagonal, and three rows are the matrix. 2D uses what
// is about z.
Inertia<3> readInertia(TableReader& body, SceneNumbers& numbers, const toml::node& inertia) {
  if (!inertia.is_array()) return static_cast<Real>(numbers.number(inertia)) * Inertia<3>::Identity();
  const toml::array& list = *inertia.as_array();
  if (list.size() != 3) {
    body.fail(inertia, "'inertia' is a list of " + std::to_string(list.size()) +
                           "; valid: a number, a list of three, or three rows of three");
  }
  if (!list.get(0)->is_array()) return numbers.vector<3>(inertia).asDiagonal();
  Inertia<3> rows;
  for (int i = 0; i < 3; ++i) rows.row(i) = numbers.vector<3>(*list.get(static_cast<std::size_t>(i))).transpose();
  return rows;
}

// Mass given by hand replaces the mass of the shapes. Values not given are those of the shapes, scaled to this mass.
template <int D>
void readMass(TableReader& body, SceneNumbers& numbers, BodyDef<D>& def) {
  const toml::node *mass = body.find("mass"), *center = body.find("center"), *inertia = body.find("inertia");
  if (!mass) {
    if (center || inertia) body.fail(center ? *center : *inertia, "a centre or inertia needs a 'mass' (kg)");
    return;
  }
  MassProperties<D> given;
  for (const ShapeDef<D>& s : def.shapes) {
    given = combined(given, transformed(massProperties(s.shape, s.density), s.X_BS));
  }
  const Real kilograms = static_cast<Real>(numbers.between(*mass, "mass", 0, kLargest));
  given.inertia *= given.mass > 0 ? kilograms / given.mass : Real(0);
  given.mass = kilograms;
  if (center) given.center = numbers.vector<D>(*center);
  if (inertia) {
    const Inertia<3> all = readInertia(body, numbers, *inertia);
    if constexpr (D == 2) {
      given.inertia(0, 0) = all(2, 2);
    } else {
      given.inertia = all;
    }
    if (!numbers.rehearsing() && !isInertia(given.inertia)) {
      body.fail(*inertia, std::string("the inertia is not that of a rigid body; valid: a number >= 0, or ") +
                              (D == 2 ? "a list whose third is one"
                                      : "three numbers >= 0, each at most the sum of the other two"));
    }
  }
  def.mass = given;
}

// The checks of World::add, with the position in the file.
template <int D>
void checkMass(const BodyDef<D>& def, const TableReader& body) {
  MassProperties<D> all;
  for (const ShapeDef<D>& s : def.shapes) {
    if (s.shape.isPlane() && def.type != BodyType::fixed)
      body.fail("a plane on a moving body; valid: type = \"fixed\"");
    if (s.shape.surface() && def.type != BodyType::fixed) {
      body.fail("a mesh or chain on a moving body; valid: type = \"fixed\", or convex shapes and compounds of them");
    }
    all = combined(all, transformed(massProperties(s.shape, s.density), s.X_BS));
  }
  if (def.mass) all = *def.mass;
  if (def.type == BodyType::dynamic && (!(all.mass > 0) || !std::isfinite(all.mass))) {
    body.fail("a dynamic body has a mass of " + asText(all.mass) + " kg; valid: finite and above 0, or another type");
  }
  if (!std::isfinite(all.mass) || !all.center.allFinite() || !all.inertia.allFinite()) {
    body.fail("the body's mass, " + asText(all.mass) + " kg, or its inertia is too large; valid: smaller ones");
  }
  if (def.type != BodyType::dynamic) return;
  const bool turns = def.rotatable && all.inertia.trace() > 0;
  if (!std::isfinite(1 / all.mass) || (turns && !inverseInertia<D>(all.inertia))) {
    body.fail("the body's mass, " + asText(all.mass) +
              " kg, or its inertia is too small to invert; valid: larger ones");
  }
}

}  // namespace

std::shared_ptr<const Polytope<3>> hullWithNormals(std::span<const Vec<3>> corners, std::span<const Vec<3>> normals) {
  auto hull = std::make_shared<Polytope<3>>(*convexHull(corners));
  if (normals.size() != hull->faces.size()) {
    throw UserError("polytope: " + std::to_string(normals.size()) + " normals are given, but the number of faces is " +
                    std::to_string(hull->faces.size()) + "; valid: one for each, or none");
  }
  for (std::size_t f = 0; f < normals.size(); ++f) {
    auto& face = hull->faces[f];
    const Vec<3>& n = normals[f];
    if (!((n - face.normal).norm() < kGivenNormal) || !(std::abs(n.norm() - 1) < kFaceNormalError)) {
      throw UserError("polytope: normal " + std::to_string(f) +
                      " does not match its face; valid: a unit vector as the " +
                      "hull of the corners has it, up to rounding");
    }
    face.normal = n;
    double offset = -std::numeric_limits<double>::infinity();  // nothing is outside, as in convexHull
    for (const Vec<3>& v : hull->vertices) offset = std::max(offset, n.cast<double>().dot(v.cast<double>()));
    face.offset = static_cast<Real>(offset);
  }
  linkVertices(*hull);
  return hull;
}

void SceneNumbers::count(const toml::node& place, std::string_view what, long n) {
  if (m_rehearsing || (m_counts[what] += n) <= kMostOfEach) return;
  failAt(m_file, place,
         "more than " + std::to_string(kMostOfEach) + " " + std::string(what) + " in all blocks together");
}

double SceneNumbers::number(const toml::node& node) {
  double value = 1;  // value of an expression in a rehearsal
  if (node.is_number()) {
    value = *node.value<double>();
    if (!std::isfinite(value)) failAt(m_file, node, describe(node) + " found; valid: a finite number");
  } else if (node.is_string()) {
    try {
      const std::string text = *node.value<std::string>();
      m_rehearsing ? expressions.check(text) : void(value = expressions.evaluate(text));
    } catch (const UserError& e) {
      failAt(m_file, node, e.what());
    }
  } else {
    failAt(m_file, node, describe(node) + " found; valid: a number or an expression");
  }
  constexpr double kMost = std::numeric_limits<Real>::max();
  if (std::abs(value) <= kMost) return value;
  failAt(m_file, node, asText(value) + " is too large for this precision; valid: up to " + asText(kMost));
}

double SceneNumbers::number(TableReader& table, const std::string& key, double fallback) {
  const toml::node* n = table.find(key);
  return n ? number(*n) : fallback;
}

double SceneNumbers::between(const toml::node& node, const std::string& key, double lo, double hi) {
  const double value = number(node);
  if (value >= lo && value <= hi) return value;
  failAt(m_file, node,
         "'" + key + "' is " + asText(value) +
             "; valid: " + (hi == kLargest ? asText(lo) + " or more" : asText(lo) + " to " + asText(hi)));
}

double SceneNumbers::between(TableReader& table, const std::string& key, double fallback, double lo, double hi) {
  const toml::node* n = table.find(key);
  return n ? between(*n, key, lo, hi) : fallback;
}

long SceneNumbers::whole(TableReader& table, const std::string& key, long fallback, long lo, long hi) {
  const toml::node* n = table.find(key);
  if (!n) return fallback;
  const double value = between(*n, key, static_cast<double>(lo), static_cast<double>(hi));
  if (value != std::floor(value)) failAt(m_file, *n, "'" + key + "' is " + asText(value) + "; valid: whole numbers");
  return static_cast<long>(value);
}

template <int D>
Vec<D> SceneNumbers::vector(const toml::node& node) {
  const toml::array* list = node.as_array();
  if (!list || list->size() < 2 || list->size() > 3) {
    failAt(m_file, node, describe(node) + " found; valid: a list of two or three numbers or expressions");
  }
  Vec<D> out = Vec<D>::Zero();
  for (std::size_t i = 0; i < list->size(); ++i) {
    const double x = number(*list->get(i));
    if (i < D) out[static_cast<int>(i)] = static_cast<Real>(x);
  }
  return out;
}

template <int D>
Vec<D> SceneNumbers::vector(TableReader& table, const std::string& key) {
  const toml::node* n = table.find(key);
  return n ? vector<D>(*n) : Vec<D>(Vec<D>::Zero());
}

BodyType readBodyType(TableReader& body) {
  const std::string type = body.string("type", bodyTypeName(BodyType::dynamic));
  if (type == "static") return BodyType::fixed;
  std::vector<std::string> names;
  for (const BodyType known : kBodyTypes) {
    names.emplace_back(bodyTypeName(known));
    if (type == names.back()) return known;
  }
  body.fail(*body.find("type"), "unknown type '" + type + "'" + validNames(names, type));
}

template <int D>
BodyDef<D> readBody(TableReader& body, SceneNumbers& numbers, const toml::table* defaults, const Settings& settings) {
  BodyDef<D> def;
  def.type = readBodyType(body);
  def.X_WB.p = numbers.vector<D>(body, "position");
  def.X_WB.q = readRotation<D>(body, numbers);
  def.velocity = numbers.vector<D>(body, "velocity");
  def.angularVelocity = readAngular<D>(body, numbers, "angular_velocity");
  def.pinned = body.flag("pinned", false);
  def.rotatable = body.flag("rotatable", true);
  def.canSleep = body.flag("can_sleep", true);
  def.awake = body.flag("awake", true);
  const std::vector<const toml::table*> shapes = body.blocks("shapes");
  if (shapes.empty() && def.type == BodyType::dynamic && !body.find("mass")) {
    body.fail("a body needs 'shapes' or 'mass'");
  }
  for (const toml::table* t : shapes) {
    TableReader shape(*t, body.file(), "a shape");
    numbers.count(*t, "shapes");
    def.shapes.push_back(readShape<D>(shape, numbers, defaults, settings));
  }
  def.gravityScale = static_cast<Real>(numbers.number(body, "gravity_scale", 1));
  readMass(body, numbers, def);
  if (!numbers.rehearsing()) checkMass(def, body);
  return def;
}

template Vec<2> SceneNumbers::vector<2>(const toml::node&);
template Vec<3> SceneNumbers::vector<3>(const toml::node&);
template Vec<2> SceneNumbers::vector<2>(TableReader&, const std::string&);
template Vec<3> SceneNumbers::vector<3>(TableReader&, const std::string&);
template BodyDef<2> readBody(TableReader&, SceneNumbers&, const toml::table*, const Settings&);
template BodyDef<3> readBody(TableReader&, SceneNumbers&, const toml::table*, const Settings&);

}}  // namespace lpc::LPC_PRECISION
