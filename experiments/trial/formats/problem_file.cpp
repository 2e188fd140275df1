// SPDX-License-Identifier: Zlib
#include "experiments/trial/formats/problem_file.h"

#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <ostream>

#include "experiments/parse/toml_reader.h"
#include "experiments/trial/formats/body_type_name.h"
#include "experiments/trial/formats/fclib_file.h"
#include "framework/math/names.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using nlohmann::json;

constexpr const char* kFormat = "lpc problems";
constexpr int kVersion = 1;
constexpr const char* kTypes[] = {bodyTypeName(BodyType::fixed), bodyTypeName(BodyType::kinematic),
                                  bodyTypeName(BodyType::dynamic), "sleeping"};
constexpr const char* kLaws[] = {"rigid", "spring", "motor"};
constexpr const char* kBlocks[] = {"equality", "box"};

template <class Column>
json listOf(const Column& column) {
  json out = json::array();
  for (Eigen::Index i = 0; i < column.size(); ++i) out.push_back(column.data()[i]);
  return out;
}
json limit(Real x) { return std::isinf(x) ? json(nullptr) : json(x); }

template <int D>
json rowJson(const ConstraintRow<D>& row) {
  return {{"direction", listOf(row.d)},
          {"arm_a", listOf(row.armA)},
          {"arm_b", listOf(row.armB)},
          {"error", row.error},
          {"law", kLaws[static_cast<std::size_t>(row.law)]},
          {"block", kBlocks[row.block == RowBlock::equality ? 0 : 1]},
          {"speed", row.speed},
          {"stiffness", row.stiffness},
          {"damping", row.damping},
          {"lo", limit(row.lo)},
          {"hi", limit(row.hi)},
          {"angular", row.angular}};
}

json matrixJson(const GivenProblem& given) {
  json entries = json::array();
  for (std::int32_t j = 0; j < given.size(); ++j) {
    given.eachOf(j, [&](std::int32_t i, double w) {
      if (i >= j) entries.push_back({i, j, w});
    });
  }
  return {{"friction", given.friction}, {"velocity", given.velocity}, {"impulse", given.impulse}, {"entries", entries}};
}

template <int D>
json problemJson(const StoredProblem<D>& stored) {
  const FrozenProblem<D>& p = stored.problem;
  if (p.given) return {{"scene", stored.scene}, {"step", stored.step}, {"matrix", matrixJson(*p.given)}};
  json bodies = json::array(), contacts = json::array(), joints = json::array();
  for (std::size_t i = 0; i < p.bodies.pose.size(); ++i) {
    const bool asleep = p.bodies.type[i] == BodyType::dynamic && !p.bodies.awake[i];
    bodies.push_back({{"type", kTypes[asleep ? 3 : static_cast<std::size_t>(p.bodies.type[i])]},
                      {"position", listOf(p.bodies.pose[i].p)},
                      {"inverse_mass", p.bodies.invMass[i]},
                      {"inverse_inertia", listOf(p.bodies.invInertia[i])},
                      {"velocity", listOf(p.bodies.motion[i].v)},
                      {"angular_velocity", listOf(p.bodies.motion[i].w)}});
    if (p.arrival.empty()) continue;
    bodies.back()["arrival_velocity"] = listOf(p.arrival[i].v);
    bodies.back()["arrival_angular_velocity"] = listOf(p.arrival[i].w);
  }
  for (const Manifold<D>& m : p.manifolds) {
    json points = json::array();
    for (int k = 0; k < m.count; ++k) {
      const ContactPoint<D>& c = m.points[static_cast<std::size_t>(k)];
      points.push_back({{"anchor_a", listOf(c.localA)},
                        {"anchor_b", listOf(c.localB)},
                        {"separation", c.separation},
                        {"bias", c.separation > 0 ? Real(0) : p.position.bias(c.separation, p.dt)},
                        {"impulse", c.impulse}});
    }
    contacts.push_back({{"a", m.bodyA},
                        {"b", m.bodyB},
                        {"normal", listOf(m.normal)},
                        {"friction", m.friction},
                        {"restitution", m.restitution},
                        {"points", points}});
  }
  JointRows<D> rows;
  for (const JointRecord<D>& j : p.joints) {
    json list = json::array();
    jointRows(j, p.bodies, rows);
    for (int i = 0; i < rows.count; ++i) list.push_back(rowJson(rows.row[static_cast<std::size_t>(i)]));
    joints.push_back({{"a", j.bodyA}, {"b", j.bodyB}, {"impulse", j.impulse}, {"rows", list}});
  }
  return {{"scene", stored.scene},
          {"step", stored.step},
          {"dt", p.dt},
          {"last_dt", p.lastDt},
          {"gravity", listOf(p.gravity)},
          {"restitution_threshold", p.restitutionThreshold},
          {"joint_rate", p.position.rate},
          {"friction", p.model.friction},
          {"rotation", p.model.rotation},
          {"restitution", p.model.restitution},
          {"bodies", bodies},
          {"contacts", contacts},
          {"order", p.order},
          {"colours", p.colours},
          {"joints", joints}};
}

/// A value of the file and its position, for messages.
class Place {
 public:
  Place(const json& value, std::string where) : m_value(value), m_where(std::move(where)) {}

  [[noreturn]] void fail(const std::string& valid) const {
    throw UserError(m_where + " is " + shortened() + "; valid: " + valid);
  }
  Place at(const char* key) const {
    if (!m_value.is_object()) fail("an object with '" + std::string(key) + "'");
    const auto it = m_value.find(key);
    if (it == m_value.end()) throw UserError(m_where + " lacks '" + key + "'");
    return {*it, m_where + ", " + key};
  }
  const std::string& where() const { return m_where; }
  bool has(const char* key) const { return m_value.is_object() && m_value.contains(key); }
  std::size_t size() const {
    if (!m_value.is_array()) fail("a list");
    return m_value.size();
  }
  Place at(std::size_t i) const { return {m_value.at(i), m_where + " " + std::to_string(i)}; }

  double wide() const {
    const double x = m_value.is_number() ? m_value.get<double>() : std::numeric_limits<double>::quiet_NaN();
    if (!std::isfinite(x)) fail("a finite number");
    return x;
  }
  Real number() const {
    const auto x = static_cast<Real>(wide());
    if (!std::isfinite(x)) fail("a finite number");
    return x;
  }
  Real least(Real lo) const {
    const Real x = number();
    if (x < lo) fail("a number, " + std::to_string(lo) + " or more");
    return x;
  }
  Real limit(Real none) const { return m_value.is_null() ? none : number(); }
  bool flag() const {
    if (!m_value.is_boolean()) fail("true or false");
    return m_value.get<bool>();
  }
  long integer(long lo, long hi) const {
    const bool whole = m_value.is_number_integer() && m_value >= lo && m_value <= hi;
    if (!whole) fail("a whole number from " + std::to_string(lo) + " to " + std::to_string(hi));
    return m_value.get<long>();
  }
  std::string text() const {
    if (!m_value.is_string()) fail("a text");
    return m_value.get<std::string>();
  }
  template <std::size_t N>
  std::size_t choice(const char* const (&names)[N]) const {
    const std::string given = m_value.is_string() ? m_value.get<std::string>() : "";
    std::string valid;
    for (std::size_t i = 0; i < N; ++i) {
      if (given == names[i]) return i;
      valid += (i ? ", " : "") + std::string(names[i]);
    }
    fail(valid);
  }
  template <class Column>
  void column(Column& out) const {
    const auto n = static_cast<std::size_t>(out.size());
    if (size() != n) fail(std::to_string(n) + (n == 1 ? " number in a list" : " numbers in a list"));
    for (std::size_t i = 0; i < n; ++i) out.data()[i] = at(i).number();
  }

 private:
  std::string shortened() const {
    if (m_value.is_array()) return "a list of " + std::to_string(m_value.size());
    if (m_value.is_object()) return "an object";
    const std::string text = m_value.dump(-1, ' ', false, json::error_handler_t::replace);
    return text.size() > 40 ? text.substr(0, 40) + "..." : text;
  }

  const json& m_value;
  std::string m_where;
};

// A permutation: `count` numbers, none twice.
std::vector<int> readOrder(const Place& list, std::size_t count) {
  std::vector<int> out;
  std::vector<bool> seen(count, false);
  for (std::size_t i = 0; i < list.size(); ++i) {
    out.push_back(static_cast<int>(list.at(i).integer(0, static_cast<long>(count) - 1)));
    if (seen[static_cast<std::size_t>(out.back())]) list.at(i).fail("each contact once");
    seen[static_cast<std::size_t>(out.back())] = true;
  }
  return out;
}

template <int D>
Motion<D> readMotion(const Place& body, const char* linear, const char* angular) {
  Motion<D> out;
  body.at(linear).column(out.v), body.at(angular).column(out.w);
  return out;
}

template <int D>
void readBody(const Place& body, FrozenProblem<D>& out) {
  const std::size_t type = body.at("type").choice(kTypes);
  Vec<D> position;
  Inertia<D> inverse;
  body.at("position").column(position), body.at("inverse_inertia").column(inverse);
  const Real invMass = body.at("inverse_mass").least(0);
  if (type != 2 && (invMass > 0 || !inverse.isZero(0)))
    body.at("inverse_mass").fail("0 for mass and inertia of a body that is not dynamic");
  if (!inverse.isApprox(inverse.transpose(), Real(1e-4)) && !inverse.isZero(0)) {
    body.at("inverse_inertia").fail("a symmetric matrix");
  }
  out.addBody(type == 3 ? BodyType::dynamic : static_cast<BodyType>(type), type != 3, position, invMass, inverse,
              readMotion<D>(body, "velocity", "angular_velocity"));
  if (!body.has("arrival_velocity")) return;
  out.arrival.push_back(readMotion<D>(body, "arrival_velocity", "arrival_angular_velocity"));
}

template <int D>
void readContact(const Place& contact, FrozenProblem<D>& out) {
  const long bodies = out.bodies.size();
  Manifold<D>& m = out.manifolds.emplace_back();
  m.bodyA = static_cast<std::int32_t>(contact.at("a").integer(0, bodies - 1));
  m.bodyB = static_cast<std::int32_t>(contact.at("b").integer(0, bodies - 1));
  if (m.bodyA == m.bodyB) contact.at("b").fail("another body than a");
  contact.at("normal").column(m.normal);
  if (std::abs(double(m.normal.norm()) - 1) > 1e-4) contact.at("normal").fail("a vector of length 1");
  m.friction = contact.at("friction").least(0), m.restitution = contact.at("restitution").least(0);
  const Place points = contact.at("points");
  if (points.size() < 1 || points.size() > kManifoldPoints<D>) {
    points.fail("1 to " + std::to_string(kManifoldPoints<D>) + " points");
  }
  m.count = static_cast<std::int32_t>(points.size());
  for (std::size_t k = 0; k < points.size(); ++k) {
    ContactPoint<D>& c = m.points[k];
    const Place point = points.at(k);
    point.at("anchor_a").column(c.localA), point.at("anchor_b").column(c.localB);
    c.separation = point.at("separation").number();
    if (c.separation <= 0) out.position.add(c.separation, point.at("bias").least(0));
    Vec<D> impulse;
    point.at("impulse").column(impulse);
    for (int i = 0; i < D; ++i) c.impulse[static_cast<std::size_t>(i)] = impulse[i];
  }
}

template <int D>
void readJoint(const Place& joint, FrozenProblem<D>& out) {
  const long bodies = out.bodies.size();
  const auto a = static_cast<std::int32_t>(joint.at("a").integer(-1, bodies - 1));
  const auto b = static_cast<std::int32_t>(joint.at("b").integer(0, bodies - 1));
  if (a == b) joint.at("b").fail("another body than a");
  const Place list = joint.at("rows");
  if (list.size() > kJointRows) list.fail("at most " + std::to_string(kJointRows) + " rows");
  JointRows<D> rows;
  for (std::size_t i = 0; i < list.size(); ++i) {
    const Place from = list.at(i);
    ConstraintRow<D>& row = rows.absent();
    row.lo = from.at("lo").limit(-ConstraintRow<D>::kNoLimit), row.hi = from.at("hi").limit(ConstraintRow<D>::kNoLimit);
    if (row.lo > row.hi) from.at("hi").fail("lo or more");
    from.at("direction").column(row.d), from.at("arm_a").column(row.armA), from.at("arm_b").column(row.armB);
    row.error = from.at("error").number(), row.speed = from.at("speed").number();
    row.stiffness = from.at("stiffness").least(0), row.damping = from.at("damping").least(0);
    row.law = static_cast<RowLaw>(from.at("law").choice(kLaws));
    row.block = from.at("block").choice(kBlocks) == 0 ? RowBlock::equality : RowBlock::box;
    row.angular = from.at("angular").flag();
    const bool first = i == 0 || rows.row[i - 1].block == RowBlock::equality;
    if (row.block == RowBlock::equality && !first) from.at("block").fail("box: equality rows come first");
  }
  RealMatrix<kJointRows, 1> impulse;
  joint.at("impulse").column(impulse);
  IndexedArray<Real, kJointRows> copy{};
  std::copy(impulse.data(), impulse.data() + kJointRows, copy.begin());
  out.addJoint(a, b, rows, copy);
}

std::vector<double> readNumbers(const Place& list) {
  std::vector<double> out(list.size());
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = list.at(i).wide();
  return out;
}

// For two rows of any J M^-1 J^T: their coupling is at most the geometric mean of their diagonal entries. A row with a
// zero diagonal is therefore zero, and is omitted if it demands nothing.
template <int D>
void checkMatrix(const Place& matrix, const GivenProblem& given) {
  constexpr double kRounding = 1e-6;
  const auto contacts = static_cast<std::int32_t>(given.friction.size());
  for (std::int32_t j = 0; j < given.size(); ++j) {
    given.eachOf(j, [&](std::int32_t i, double w) {
      if (i <= j || w * w <= given.at(i, i) * given.at(j, j) * (1 + kRounding)) return;
      const std::string at = std::to_string(i) + ", " + std::to_string(j);
      throw UserError(
          matrix.where() + ": the entry at " + at +
          " is too large for the diagonal entries of its rows; valid: a matrix without negative eigenvalues");
    });
    const double u = given.velocity[static_cast<std::size_t>(j)];
    const bool equality = j >= D * contacts, normal = !equality && j % D == 0;
    const auto moves = [&](std::int32_t i) { return given.at(i, i) > 0; };
    if (!moves(j) && ((equality && u != 0) || (normal && u < 0))) {
      matrix.at("velocity")
          .at(static_cast<std::size_t>(j))
          .fail("0 or more for a row without moving bodies; 0 for such an equality");
    }
    if (D == 3 && normal && given.friction[static_cast<std::size_t>(j / D)] > 0 && moves(j + 1) != moves(j + 2)) {
      matrix.at("friction").at(static_cast<std::size_t>(j / D)).fail("0 where a tangent row has no moving body");
    }
  }
}

// Entries of the lower triangle, each once.
template <int D>
GivenProblem readMatrix(const Place& matrix) {
  GivenProblem out;
  out.friction = readNumbers(matrix.at("friction")), out.velocity = readNumbers(matrix.at("velocity"));
  out.impulse = readNumbers(matrix.at("impulse"));
  for (std::size_t c = 0; c < out.friction.size(); ++c) matrix.at("friction").at(c).least(0);
  const std::size_t rows = out.velocity.size(), least = D * out.friction.size();
  if (rows < least || rows == 0) {
    matrix.at("velocity").fail(std::to_string(D) + " numbers for each contact, then one for each equality");
  }
  if (out.impulse.size() != rows) matrix.at("impulse").fail("a list of " + std::to_string(rows) + ", as velocity");
  const Place entries = matrix.at("entries");
  std::vector<std::map<std::int32_t, double>> columns(rows);
  for (std::size_t k = 0; k < entries.size(); ++k) {
    const Place entry = entries.at(k);
    if (entry.size() != 3) entry.fail("row, column and number");
    const auto i = static_cast<std::int32_t>(entry.at(0UL).integer(0, static_cast<long>(rows) - 1));
    const auto j = static_cast<std::int32_t>(entry.at(1).integer(0, i));
    const double w = entry.at(2).wide();
    if (i == j && w < 0) entry.at(2).fail("0 or more, on the diagonal");
    if (!columns[static_cast<std::size_t>(j)].emplace(i, w).second) entry.fail("each entry once");
    columns[static_cast<std::size_t>(i)].emplace(j, w);
  }
  for (const auto& column : columns) {
    for (const auto& [i, w] : column) out.row.push_back(i), out.value.push_back(w);
    out.start.push_back(static_cast<std::int32_t>(out.row.size()));
  }
  checkMatrix<D>(matrix, out);
  return out;
}

template <int D>
StoredProblem<D> readProblem(const Place& from) {
  StoredProblem<D> out;
  FrozenProblem<D>& p = out.problem;
  out.scene = from.at("scene").text(), out.step = from.at("step").integer(0, std::numeric_limits<long>::max());
  if (from.has("matrix")) {
    p.dt = p.lastDt = Real(1) / 60;  // nothing is scaled by it
    p.given = readMatrix<D>(from.at("matrix"));
    return out;
  }
  p.dt = from.at("dt").number(), p.lastDt = from.at("last_dt").least(0);
  if (!(p.dt > 0)) from.at("dt").fail("a number above 0");
  from.at("gravity").column(p.gravity);
  p.restitutionThreshold = from.at("restitution_threshold").least(0);
  p.position.rate = from.at("joint_rate").least(0);
  p.model.friction = from.at("friction").flag(), p.model.rotation = from.at("rotation").flag();
  p.model.restitution = from.at("restitution").flag();
  const auto each = [&](const char* key, void (*read)(const Place&, FrozenProblem<D>&)) {
    const Place list = from.at(key);
    for (std::size_t i = 0; i < list.size(); ++i) read(list.at(i), p);
  };
  each("bodies", readBody<D>);
  if (!p.arrival.empty() && p.arrival.size() != p.bodies.pose.size()) {
    from.at("bodies").fail("arrival velocities for all bodies or for none");
  }
  each("contacts", readContact<D>), each("joints", readJoint<D>);
  p.order = readOrder(from.at("order"), p.manifolds.size());
  const Place colours = from.at("colours");
  for (std::size_t i = 0; i < colours.size(); ++i) {
    const long least = p.colours.empty() ? 0 : p.colours.back();
    p.colours.push_back(static_cast<int>(colours.at(i).integer(least, static_cast<long>(p.order.size()))));
  }
  const bool whole =
      p.colours.empty() || (p.colours.front() == 0 && p.colours.back() == static_cast<int>(p.order.size()));
  if (!whole) colours.fail("offsets into the order, from 0 to its length");
  return out;
}

template <int D>
std::vector<StoredProblem<D>> readAll(const Place& list) {
  std::vector<StoredProblem<D>> out;
  for (std::size_t i = 0; i < list.size(); ++i) out.push_back(readProblem<D>(list.at(i)));
  return out;
}

}  // namespace

template <int D>
void writeProblems(std::ostream& out, const std::vector<StoredProblem<D>>& problems) {
  out << "{\"format\": " << json(kFormat) << ", \"version\": " << kVersion << ", \"dimension\": " << D
      << ", \"problems\": [";
  for (std::size_t i = 0; i < problems.size(); ++i) out << (i ? ",\n" : "\n") << problemJson(problems[i]).dump();
  out << "\n]}\n";
}
template void writeProblems(std::ostream&, const std::vector<StoredProblem<2>>&);
template void writeProblems(std::ostream&, const std::vector<StoredProblem<3>>&);

ProblemFile ProblemFile::load(const std::string& path) { return parse(readFile(path), path); }

ProblemFile ProblemFile::parse(const std::string& bytes, const std::string& path) {
  if (isHdf5(bytes)) return parse(fclibAsProblems(path), path);
  const json whole = json::parse(bytes, nullptr, false);
  if (whole.is_discarded() || !whole.is_object() || whole.value("format", json()) != kFormat) {
    throw UserError(path + ": not a file of problems; valid: a file written by lpc record");
  }
  const Place top(whole, path);
  const Place version = top.at("version");
  if (version.integer(0, 1000000) != kVersion) version.fail(std::to_string(kVersion));
  ProblemFile out;
  out.dimension = static_cast<int>(top.at("dimension").integer(2, 3));
  if (out.dimension == 2) {
    out.in2 = readAll<2>(top.at("problems"));
  } else {
    out.in3 = readAll<3>(top.at("problems"));
  }
  if (out.size() == 0) throw UserError(path + ": holds no problem; valid: one or more");
  return out;
}

}}  // namespace lpc::LPC_PRECISION
