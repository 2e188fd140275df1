// SPDX-License-Identifier: Zlib
#include "oracles/corpus/cases.h"

#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "framework/math/check.h"
#include "framework/math/nesting.h"
#include "framework/shape/curved_core.h"
#include "oracles/referee/referee.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using Json = nlohmann::json;

// An error of a case, not of a shape in it.
struct BadCase : UserError {
  explicit BadCase(const std::string& what, bool tooLarge = false) : UserError(what), beyond(tooLarge) {}
  bool beyond;  // valid, but not in this precision
};

// The current position in the file, for error messages.
struct Place {
  bool bits = false;  // the case was found in this precision: its rotations are used unchanged

  [[noreturn]] void fail(const std::string& what) const { throw BadCase(what); }
  const Json& field(const Json& object, const char* name) const {
    if (!object.is_object() || !object.contains(name)) fail(std::string("field '") + name + "' is missing");
    return object.at(name);
  }
  double number(const Json& value, const char* name) const {
    if (!value.is_number()) fail(std::string("field '") + name + "' holds " + value.dump() + "; valid: a number");
    return value.get<double>();
  }
  Real real(double value, const char* name) const {
    if (std::isfinite(static_cast<Real>(value))) return static_cast<Real>(value);
    throw BadCase(std::string("field '") + name + "' holds " + numberText(value) + ", which is too large for " +
                      (sizeof(Real) == 8 ? "f64" : "f32"),
                  true);
  }
  // A field that must be there.
  Real length(const Json& object, const char* name) const { return real(number(field(object, name), name), name); }
  double number(const Json& object, const char* name, double otherwise) const {
    if (!object.contains(name) || object.at(name).is_null()) return otherwise;
    return number(object.at(name), name);
  }
  std::string text(const Json& object, const char* name) const {
    const Json& value = field(object, name);
    if (!value.is_string()) fail(std::string("field '") + name + "' holds " + value.dump() + "; valid: a text");
    return value.get<std::string>();
  }
  double whole(const Json& object, const char* name, double most, double least = 0) const {
    const double x = number(field(object, name), name);
    if (!(x >= least && x <= most) || x != std::floor(x)) {
      fail(std::string("field '") + name + "' holds " + numberText(x) + "; valid: a whole number from " +
           numberText(least) + " to " + numberText(most));
    }
    return x;
  }
  template <int D>
  Vecd<D> doubles(const Json& value, const char* name) const {
    if (!value.is_array() || value.size() != D) {
      fail(std::string("field '") + name + "' holds " + value.dump() + "; valid: " + std::to_string(D) + " numbers");
    }
    Vecd<D> v;
    for (int d = 0; d < D; ++d) v[d] = number(value[static_cast<std::size_t>(d)], name);
    return v;
  }
  template <int D>
  Vec<D> vector(const Json& value, const char* name) const {
    return doubles<D>(value, name).unaryExpr([&](double x) { return real(x, name); });
  }
  template <int D>
  std::vector<Vec<D>> points(const Json& object) const {
    std::vector<Vec<D>> out;
    for (const Json& p : field(object, "points")) out.push_back(vector<D>(p, "points"));
    return out;
  }
};

Rot<2> readRotation(const Place& at, const Json& pose, Vec<2>) {
  if (!pose.contains("cos_sin")) return Rot<2>::angle(at.number(pose, "angle", 0));
  const Vecd<2> q = at.doubles<2>(pose.at("cos_sin"), "cos_sin");
  if (!(std::abs(q.squaredNorm() - 1) < 1e-3))
    at.fail("cos_sin is not a rotation: its square is " + std::to_string(q.squaredNorm()));
  const Vecd<2> unit = at.bits ? q : q.normalized();
  return {static_cast<Real>(unit[0]), static_cast<Real>(unit[1])};
}

Rot<3> readRotation(const Place& at, const Json& pose, Vec<3>) {
  const auto real = [](double x) { return static_cast<Real>(x); };
  if (pose.contains("q_wxyz") && pose.at("q_wxyz").is_array() && pose.at("q_wxyz").size() == 4) {
    const Json& q = pose.at("q_wxyz");
    double c[4], norm = 0;
    for (std::size_t i = 0; i < 4; ++i) c[i] = at.number(q[i], "q_wxyz"), norm += c[i] * c[i];
    if (!(std::abs(norm - 1) < 1e-3)) at.fail("q_wxyz is not a unit quaternion: its square is " + std::to_string(norm));
    // A norm of one within rounding stays as it is: the exact bits are the case's input.
    const double k = at.bits || std::abs(norm - 1) < 1e-15 ? 1 : 1 / std::sqrt(norm);
    return {real(k * c[0]), real(k * c[1]), real(k * c[2]), real(k * c[3])};
  }
  if (!pose.contains("R")) return {};
  const Json& rows = pose.at("R");
  if (!rows.is_array() || rows.size() != 3) at.fail("field 'R' is not a list of three rows");
  Eigen::Matrix3d m;
  for (int i = 0; i < 3; ++i) {
    const Json& row = rows[static_cast<std::size_t>(i)];
    if (!row.is_array() || row.size() != 3) at.fail("field 'R' is not a list of three rows");
    for (int j = 0; j < 3; ++j) m(i, j) = at.number(row[static_cast<std::size_t>(j)], "R");
  }
  if (!((m * m.transpose() - Eigen::Matrix3d::Identity()).norm() < 1e-3) || !(m.determinant() > 0)) {
    at.fail("field 'R' is not a rotation");
  }
  const Eigen::Quaterniond q = Eigen::Quaterniond(m).normalized();
  return {real(q.w()), real(q.x()), real(q.y()), real(q.z())};
}

template <int D>
Pose<D> readPose(const Place& at, const Json& pose) {
  return {at.vector<D>(at.field(pose, "t"), "t"), readRotation(at, pose, Vec<D>{})};
}

// The rotation from x to the unit vector d.
Rot<2> turnFromX(const Vec<2>& d) { return Rot<2>{d[0], d[1]}.normalized(); }
Rot<3> turnFromX(const Vec<3>& d) {
  if (d[0] < Real(-0.999)) return Rot<3>{0, 0, 0, 1} * turnFromX(Vec<3>(-d));  // half a turn, then a small one
  return Rot<3>{1 + d[0], 0, -d[2], d[1]}.normalized();
}

// The rotation from the axis that the shape names, x by default.
template <int D>
Rot<D> axisTurn(const Place& at, const Json& shape) {
  const std::string axis = shape.contains("axis") ? at.text(shape, "axis") : "x";
  const std::size_t k = std::string("xyz").find(axis);
  if (axis.size() != 1 || k >= D) at.fail("axis is '" + axis + "'; valid: x, y" + (D == 3 ? ", z" : ""));
  return k == 0 ? Rot<D>() : turnFromX(Vec<D>(Vec<D>::Unit(static_cast<int>(k))));
}

// Capsules and segments: an axis name with a half length, or two end points.
template <int D>
Pose<D> readAxis(const Place& at, const Json& shape, Real& halfLength) {
  Pose<D> X_CS;
  if (!shape.contains("points")) {
    halfLength = at.length(shape, "half_length");
    X_CS.q = axisTurn<D>(at, shape);
    return X_CS;
  }
  const std::vector<Vec<D>> ends = at.points<D>(shape);
  if (ends.size() != 2) at.fail("a capsule or segment has two points");
  X_CS.p = Real(0.5) * (ends[0] + ends[1]);
  const Real length = (ends[1] - ends[0]).norm();
  halfLength = length / 2;
  const Vec<D> direction = length > 0 ? Vec<D>((ends[1] - ends[0]) / length) : Vec<D>::Unit(0);
  if (direction != Vec<D>::Unit(0)) X_CS.q = turnFromX(direction);
  return X_CS;
}

template <int D>
std::optional<ShapeKind> curvedNamed(const std::string& type) {
  for (const auto& [kind, unused] : curvedKinds<D>()) {
    if (shapeKindName(kind) == type) return kind;
  }
  return std::nullopt;
}

// Sizes by name, or all in one list, which corpora call radii.
template <int D>
std::vector<Real> curvedSizes(const Place& at, const Json& shape, ShapeKind kind) {
  std::vector<Real> sizes;
  if (shape.contains("radii")) {
    const Vec<D> radii = at.vector<D>(at.field(shape, "radii"), "radii");
    return {radii.data(), radii.data() + D};
  }
  for (const std::string_view name : curvedKind<D>(kind).sizes) {
    const std::string key(name);
    sizes.push_back(at.length(shape, key.c_str()));
  }
  return sizes;
}

template <int D>
CaseShape<D> readShape(const Place& at, const Json& shape, const Pose<D>& X_WC) {
  CaseShape<D> out;
  out.X_WS = X_WC;
  const std::string type = at.text(shape, "type");
  const Real rounding = at.real(at.number(shape, "radius", 0), "radius");
  try {
    if (type == "sphere" || type == "circle") {
      out.shape = Shape<D>::sphere(at.length(shape, "radius"));
    } else if (type == "point") {
      out.shape = Shape<D>::sphere(rounding);
    } else if (type == "box") {
      out.shape = Shape<D>::box(at.vector<D>(at.field(shape, "half_extents"), "half_extents"), rounding);
    } else if (type == "capsule" || type == "segment") {
      Real half = 0;
      const Pose<D> X_CS = readAxis<D>(at, shape, half);
      out.X_WS = X_WC * X_CS;
      if (half == 0) {
        out.shape = Shape<D>::sphere(rounding);
      } else {
        out.shape = rounding > 0 ? Shape<D>::capsule(half, rounding) : Shape<D>::segment(half);
      }
    } else if (type == "polygon" || type == "convex" || type == "triangle") {
      const std::vector<Vec<D>> points = at.points<D>(shape);
      const bool flat = D == 3 && type == "triangle";
      out.shape = Shape<D>::ofCorners(flat ? ShapeKind::triangle : ShapeKind::polytope, points, rounding);
    } else if (type == "half_space") {
      out.shape = Shape<D>::plane();
    } else if (const auto curved = curvedNamed<D>(type)) {
      if (shape.contains("axis")) out.X_WS = X_WC * Pose<D>{Vec<D>::Zero(), axisTurn<D>(at, shape)};
      const Real own = at.real(at.number(shape, "rounding", 0), "rounding");
      out.shape = Shape<D>::curved(*curved, curvedSizes<D>(at, shape, *curved), own);
    } else {
      out.refusal = type;
    }
  } catch (const BadCase&) {
    throw;
  } catch (const UserError& error) {  // without volume, for instance four coplanar points
    out.refusal = type + ": " + error.what();
  }
  return out;
}

CaseQuery queryFromText(const std::string& text) {
  if (text.starts_with("signed_distance")) return CaseQuery::signedDistance;
  if (text.starts_with("contacts")) return CaseQuery::contacts;
  if (text.starts_with("broadphase")) return CaseQuery::broadphase;
  if (text.starts_with("convex_hull")) return CaseQuery::convexHull;
  if (text.starts_with("mass")) return CaseQuery::massProperties;
  if (text.starts_with("time_of_impact")) return CaseQuery::timeOfImpact;
  return CaseQuery::unknown;
}

// B moves from `start` to `end` in one second at constant rates, or has a velocity.
template <int D>
void readMotion(const Place& at, const Json& c, CaseGeometry<D>& out) {
  const Json& pose = at.field(c, "poseB");
  if (!pose.contains("start")) {
    out.X_WBodyB = readPose<D>(at, pose);
    out.motionB.v = at.vector<D>(at.field(c, "velocityB"), "velocityB");
    out.duration = at.length(c, "tmax");
    if (!(out.duration > 0)) at.fail("field 'tmax' holds a number that is not above 0");
    return;
  }
  const Json& end = at.field(pose, "end");
  out.X_WBodyB = readPose<D>(at, pose.at("start"));
  out.duration = 1;
  const Pose<D> last = readPose<D>(at, end);
  out.motionB.v = last.p - out.X_WBodyB.p;
  out.motionB.w = turnOf(last.q * out.X_WBodyB.q.inverse());
}

bool isPair(CaseQuery query) { return query == CaseQuery::signedDistance || query == CaseQuery::contacts; }

template <int D>
std::array<double, 3> readTriple(const Place& at, const Json& value, const char* name) {
  if (!value.is_array() || value.size() != D) at.fail(std::string("field '") + name + "' has the wrong length");
  std::array<double, 3> out{};
  for (std::size_t d = 0; d < D; ++d) out[d] = at.number(value[d], name);
  return out;
}

template <int D>
CaseExpected readExpected(const Place& at, const Json& c, CaseQuery query) {
  CaseExpected out;
  if (!c.contains("expected")) return out;
  const Json& e = c.at("expected");
  if (!e.is_object()) at.fail("field 'expected' holds " + e.dump() + "; valid: an object, or no such field");
  if (isPair(query)) {
    out.distance = at.number(e, "signed_distance", kUnknown);
    out.tolerance = at.number(e, "tolerance_of_this_value", 0);
  } else if (query == CaseQuery::timeOfImpact) {
    const bool misses = e.contains("min_gap_over_sweep") || (e.contains("toi") && e.at("toi").is_null());
    out.impact = misses ? std::numeric_limits<double>::infinity() : at.number(e, "toi", kUnknown);
  } else if (query == CaseQuery::convexHull) {
    out.degenerate = e.contains("degenerate") && e.at("degenerate") == true;
    if (e.contains("hull_vertices")) {
      for (const Json& p : e.at("hull_vertices")) out.hullVertices.push_back(readTriple<D>(at, p, "hull_vertices"));
    }
    out.measure = at.number(e, "measure", kUnknown);
  } else if (query == CaseQuery::massProperties) {
    out.measure = at.number(e, D == 2 ? "area" : "volume", kUnknown);
    if (e.contains("centroid")) out.center = readTriple<D>(at, e.at("centroid"), "centroid");
    if (e.contains("inertia_about_centroid")) {
      const Json& inertia = e.at("inertia_about_centroid");
      for (const Json& row : inertia.flatten()) out.inertia.push_back(at.number(row, "inertia_about_centroid"));
      if (out.inertia.size() != (D == 2 ? 1u : 9u)) at.fail("inertia_about_centroid: one number in 2D, 3x3 in 3D");
    }
  }
  return out;
}

CaseFinding readFinding(const Place& at, const Json& found, CaseQuery query) {
  const std::string stage = at.text(found, "stage");
  CaseFinding out;
  out.stage = query == CaseQuery::contacts     ? StageKind::contacts
              : query == CaseQuery::broadphase ? StageKind::broadphase
                                               : StageKind::pairQuery;
  if (!(isPair(query) || query == CaseQuery::broadphase) || stage != stageName(out.stage)) {
    at.fail("field 'stage' holds '" + stage + "', which does not answer this query");
  }
  out.precision = at.text(found, "precision");
  if (out.precision != "f64" && out.precision != "f32") {
    at.fail("field 'precision' holds '" + out.precision + "'; valid: f64, f32");
  }
  out.method = at.text(found, "method");
  out.failure = at.text(found, "failure");
  out.error = at.number(found, "error", kUnknown);
  out.seed = at.field(found, "seed").get<std::uint64_t>();
  out.number = static_cast<int>(at.whole(found, "number", std::numeric_limits<int>::max()));
  return out;
}

// `lpc verify` draws 121 and 6; the check tests every pair of slots in every step.
constexpr int kMostSlots = 2000, kMostCaseSteps = 100;

// State of a slot while a script is read: in use, and added or moved in this step.
struct SlotRead {
  bool used = false, added = false, moved = false;
};

// A change that a world could report. A slot is added when free, and removed or moved when in use. In one step it is
// removed, added and moved at most once each, in this order (see ProxyChanges).
template <int D>
BoxChange<D> readChange(const Place& at, const Json& change, std::vector<SlotRead>& slots) {
  BoxChange<D> out;
  using What = typename BoxChange<D>::What;
  const char* name = "added";
  if (change.contains("removed")) out.what = What::removed, name = "removed";
  if (change.contains("moved")) out.what = What::moved, name = "moved";
  out.slot = static_cast<ProxyId>(at.whole(change, name, static_cast<double>(slots.size()) - 1));
  SlotRead& slot = slots[static_cast<std::size_t>(out.slot)];
  const std::string which = "slot " + std::to_string(out.slot);
  if (slot.used == (out.what == What::added)) {
    at.fail(which + " is " + name + " but " + (slot.used ? "in use" : "free"));
  }
  if (slot.moved || (out.what == What::removed && slot.added)) {
    at.fail(which + " is " + name + " after it was " + (slot.moved ? "moved" : "added") +
            " in the same step; valid: removed, added, moved, each at most once and in this order");
  }
  slot.added |= out.what == What::added, slot.moved |= out.what == What::moved;
  slot.used = out.what != What::removed;
  if (out.what == What::removed) return out;
  out.box = {at.vector<D>(at.field(change, "lo"), "lo"), at.vector<D>(at.field(change, "hi"), "hi")};
  if (!(out.box.lo.array() <= out.box.hi.array()).all()) at.fail(which + ": 'lo' is above 'hi'");
  if (out.what == What::moved) return out;
  constexpr double kMost = std::numeric_limits<std::uint32_t>::max();
  out.body = static_cast<std::int32_t>(at.whole(change, "body", std::numeric_limits<std::int32_t>::max()));
  out.active = at.field(change, "active") == true;
  out.category = static_cast<std::uint32_t>(at.whole(change, "category", kMost));
  out.mask = static_cast<std::uint32_t>(at.whole(change, "mask", kMost));
  return out;
}

template <int D>
BoxScript<D> readScript(const Place& at, const Json& c) {
  BoxScript<D> out{.family = "", .slots = static_cast<int>(at.whole(c, "slots", kMostSlots, 1)), .steps = {}};
  std::vector<SlotRead> slots(static_cast<std::size_t>(out.slots));
  const Json& steps = at.field(c, "steps");
  if (steps.size() > kMostCaseSteps) {
    at.fail("field 'steps' has " + std::to_string(steps.size()) + "; valid: at most " + std::to_string(kMostCaseSteps));
  }
  for (const Json& step : steps) {
    std::vector<BoxChange<D>>& changes = out.steps.emplace_back();
    for (SlotRead& slot : slots) slot = {.used = slot.used};
    for (const Json& change : step) changes.push_back(readChange<D>(at, change, slots));
  }
  return out;
}

template <int D>
CaseGeometry<D> readGeometry(const Place& at, const Json& c, CaseQuery query) {
  CaseGeometry<D> out;
  if (query == CaseQuery::convexHull) {
    out.points = at.points<D>(c);
  } else if (query == CaseQuery::broadphase) {
    out.script = readScript<D>(at, c);
  } else if (isPair(query) || query == CaseQuery::timeOfImpact || query == CaseQuery::massProperties) {
    const Pose<D> X_WA = readPose<D>(at, at.field(c, "poseA"));
    out.a = readShape<D>(at, at.field(c, "shapeA"), X_WA);
    if (isPair(query)) {
      const Pose<D> X_WB = readPose<D>(at, at.field(c, "poseB"));
      out.b = readShape<D>(at, at.field(c, "shapeB"), X_WB);
      if (c.contains("poseB_nudged")) out.X_WBNudged = readPose<D>(at, c.at("poseB_nudged"));
    } else if (query == CaseQuery::timeOfImpact) {
      readMotion<D>(at, c, out);
      out.b = readShape<D>(at, at.field(c, "shapeB"), out.X_WBodyB);
    }
  }
  return out;
}

void readCase(const Json& c, Case& read) {
  Place at;
  read.id = at.text(c, "id");
  read.source = c.contains("source") ? at.text(c, "source") : "";
  read.queryText = at.text(c, "query");
  read.query = queryFromText(read.queryText);
  // "mass properties, density 1"
  const std::size_t density = read.queryText.find("density ");
  if (density != std::string::npos) read.density = std::strtod(read.queryText.c_str() + density + 8, nullptr);
  if (c.contains("found")) read.finding = readFinding(at, c.at("found"), read.query);
  at.bits = read.finding && read.finding->precision == (sizeof(Real) == 8 ? "f64" : "f32");
  const double dimension = at.number(at.field(c, "dim"), "dim");
  if (dimension == 2) {
    read.geometry = readGeometry<2>(at, c, read.query);
    read.expected = readExpected<2>(at, c, read.query);
  } else if (dimension == 3) {
    read.geometry = readGeometry<3>(at, c, read.query);
    read.expected = readExpected<3>(at, c, read.query);
  } else {
    at.fail("field 'dim' holds " + numberText(dimension) + "; valid: 2, 3");
  }
}

}  // namespace

template <int D>
HardPair<D> CaseGeometry<D>::pair() const {
  HardPair<D> out{.a = *a.shape, .b = *b.shape, .X_WA = a.X_WS, .X_WB = b.X_WS, .X_WBNudged = X_WBNudged};
  out.X_AB = a.X_WS.inverse() * b.X_WS;
  return out;
}
template HardPair<2> CaseGeometry<2>::pair() const;
template HardPair<3> CaseGeometry<3>::pair() const;

std::vector<Case> readCases(const std::string& path, BrokenCases broken) {
  errno = 0;
  std::ifstream in(path, std::ios::binary);
  std::ostringstream all;
  if (in) all << in.rdbuf();  // of a folder: nothing, and errno says so
  const std::string text = all.str();
  if (text.empty())
    throw UserError(path + (errno ? ": cannot be read: " + std::string(std::strerror(errno)) : ": is empty"));
  return parseCases(text, path, broken);
}

std::vector<Case> parseCases(const std::string& text, const std::string& path, BrokenCases broken) {
  Json file;
  try {
    file = Json::parse(text, [&](int depth, Json::parse_event_t, const Json&) {
      if (depth > kMostNested) throw UserError(path + ": nested more than " + std::to_string(kMostNested) + " deep");
      return true;
    });
  } catch (const Json::exception& error) {
    throw UserError(path + ": " + error.what());
  }
  if (!file.is_object() || !file.contains("cases") || !file.at("cases").is_array()) {
    throw UserError(path + ": there is no list 'cases'");
  }
  if (file.at("cases").empty()) throw UserError(path + ": the list 'cases' is empty");
  if (file.contains("count") && file.at("count") != file.at("cases").size()) {
    throw UserError(path + ": field 'count' holds " + file.at("count").dump() + ", and the list 'cases' has " +
                    std::to_string(file.at("cases").size()));
  }
  std::vector<Case> out;
  for (const Json& c : file.at("cases")) {
    Case read;
    const auto fail = [&](const std::string& what, bool keep) {
      if (!keep) throw UserError(path + ": case '" + read.id + "': " + what);
      read.mistake = what;
    };
    read.id = "number " + std::to_string(out.size());
    try {
      readCase(c, read);
    } catch (const BadCase& error) {
      fail(error.what(), broken == BrokenCases::kept || error.beyond);
    } catch (const Json::exception& error) {
      fail(error.what(), broken == BrokenCases::kept);
    }
    out.push_back(std::move(read));
  }
  return out;
}

}}  // namespace lpc::LPC_PRECISION
