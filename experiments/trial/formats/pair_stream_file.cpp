// SPDX-License-Identifier: Zlib
// A line of JSON, then the entries as bytes (a million as text would be 150 MB and take seconds to read), then a
// checksum of everything before it.
#include <xxhash.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <ostream>

#include "experiments/parse/toml_reader.h"
#include "experiments/trial/formats/pair_stream.h"
#include "experiments/trial/formats/written_rotation.h"
#include "framework/shape/curved_core.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using nlohmann::json;

constexpr const char* kPairsFormat = "lpc pairs";
constexpr int kPairsVersion = 1;
constexpr std::size_t kPairFields = 10;  // a shape and four numbers of its part, twice

template <int D>
constexpr std::size_t kRotationNumbers = D == 2 ? 2 : 4;
template <int D>
constexpr std::size_t kPairPoseBytes = sizeof(std::uint32_t) + sizeof(double) * (D + kRotationNumbers<D>);

using RotationNumbers = std::array<double, 4>;
RotationNumbers numbersOf(const Rot<2>& q) { return {double(q.c), double(q.s), 0, 0}; }
RotationNumbers numbersOf(const Rot<3>& q) { return {double(q.w), double(q.x), double(q.y), double(q.z)}; }
void setNumbers(Rot<2>& q, const RotationNumbers& n) { q.c = Real(n[0]), q.s = Real(n[1]); }
void setNumbers(Rot<3>& q, const RotationNumbers& n) {
  q.w = Real(n[0]), q.x = Real(n[1]), q.y = Real(n[2]), q.z = Real(n[3]);
}

template <class T>
void appendBytes(std::string& bytes, T x) {
  bytes.append(reinterpret_cast<const char*>(&x), sizeof x);
}

template <class Numbers>
json numberList(const Numbers& numbers) {
  json out = json::array();
  for (const Real x : numbers) out.push_back(static_cast<double>(x));
  return out;
}

template <int D>
json sizesJson(const ShapeView<D>& v) {
  switch (v.core()) {
    case CoreClass::segment:
      return json::array({static_cast<double>(v.half[0])});
    case CoreClass::box:
      return numberList(v.half);
    case CoreClass::curved:
      return numberList(v.curved->sizes());
    case CoreClass::point:
    case CoreClass::plane:
    case CoreClass::hull:
      break;
  }
  return json::array();
}

template <int D>
json pairShapeJson(const ShapeView<D>& v) {
  json out = {{"kind", std::string(shapeKindName(v.kind))}, {"rounding", static_cast<double>(v.radius)}};
  if (!v.hull) {
    out["sizes"] = sizesJson(v);
    return out;
  }
  json& points = out["points"] = json::array();
  for (const Vec<D>& p : v.hull->vertices) points.push_back(numberList(p));
  return out;
}

/// Reads the header; errors name the position.
struct PairHeader {
  const std::string& path;

  [[noreturn]] void fail(const std::string& where, const std::string& valid) const {
    throw UserError(path + ": " + where + " is wrong; valid: " + valid);
  }
  const json& field(const json& object, const char* key, const std::string& where) const {
    if (!object.is_object() || !object.contains(key)) throw UserError(path + ": " + where + " lacks '" + key + "'");
    return object[key];
  }
  const json& list(const json& value, const std::string& where, std::size_t size = 0) const {
    const bool right = value.is_array() && (size == 0 || value.size() == size);
    if (!right) fail(where, "a list" + (size ? " of " + std::to_string(size) : ""));
    return value;
  }
  double number(const json& value, const std::string& where) const {
    const double x = value.is_number() ? value.get<double>() : std::numeric_limits<double>::quiet_NaN();
    if (!std::isfinite(x)) fail(where, "a finite number");
    return x;
  }
  double amount(const json& value, const std::string& where) const {
    const double x = number(value, where);
    if (x < 0) fail(where, "0 or more");
    return x;
  }
  std::int64_t integer(const json& value, const std::string& where, std::int64_t lo, std::int64_t hi) const {
    const bool whole = value.is_number_integer() && value >= lo && value <= hi;
    if (!whole && lo == hi) fail(where, std::to_string(lo));
    if (!whole) fail(where, "a whole number from " + std::to_string(lo) + " to " + std::to_string(hi));
    return value.get<std::int64_t>();
  }
  std::string text(const json& value, const std::string& where) const {
    if (!value.is_string()) fail(where, "a text");
    return value.get<std::string>();
  }
  std::vector<Real> numbers(const json& value, const std::string& where, std::size_t size = 0) const {
    std::vector<Real> out;
    for (const json& x : list(value, where, size)) out.push_back(static_cast<Real>(number(x, where)));
    return out;
  }
};

template <int D>
Vec<D> columnOf(const std::vector<Real>& numbers) {
  return Eigen::Map<const Vec<D>>(numbers.data());
}

template <int D>
Shape<D> readPairShape(const PairHeader& header, const json& from, const std::string& where) {
  try {
    const ShapeKind kind = shapeKindFromName(header.text(header.field(from, "kind", where), where));
    if (!kindExists(kind, D)) header.fail(where, "a kind of this dimension");
    const auto rounding = static_cast<Real>(header.amount(header.field(from, "rounding", where), where));
    const auto sizes = [&](std::size_t n) { return header.numbers(header.field(from, "sizes", where), where, n); };
    switch (coreClass(kind)) {
      case CoreClass::point:
        return Shape<D>::sphere(rounding);
      case CoreClass::segment:
        if (kind == ShapeKind::segment) return Shape<D>::segment(sizes(1)[0]);
        return Shape<D>::capsule(sizes(1)[0], rounding);
      case CoreClass::box:
        return Shape<D>::box(columnOf<D>(sizes(D)), rounding);
      case CoreClass::curved:
        return Shape<D>::curved(kind, sizes(0), rounding);
      case CoreClass::plane:
        return Shape<D>::plane();
      case CoreClass::hull:
        break;
    }
    std::vector<Vec<D>> points;
    for (const json& p : header.list(header.field(from, "points", where), where)) {
      points.push_back(columnOf<D>(header.numbers(p, where, D)));
    }
    return Shape<D>::ofCorners(kind, points, rounding);
  } catch (const UserError& e) {  // of a factory, which does not know the position
    const std::string what = e.what();
    if (what.starts_with(header.path + ": " + where)) throw;
    throw UserError(header.path + ": " + where + ": " + what);
  }
}

template <int D>
typename PairStream<D>::Pair readPair(const PairHeader& header, const json& from, const std::string& where,
                                      const std::vector<Shape<D>>& shapes) {
  header.list(from, where, kPairFields);
  constexpr std::int64_t kMost = std::numeric_limits<std::int32_t>::max();
  const auto at = [&](std::size_t i, std::int64_t hi) { return header.integer(from[i], where, 0, hi); };
  const auto shape = [&](std::size_t i) {
    return static_cast<std::uint32_t>(at(i, static_cast<std::int64_t>(shapes.size()) - 1));
  };
  const auto part = [&](std::size_t i) {
    return PartOfBody{static_cast<std::int32_t>(at(i, kMost)),
                      static_cast<std::uint32_t>(at(i + 1, std::numeric_limits<std::uint32_t>::max())),
                      static_cast<std::int32_t>(at(i + 2, kMost)), static_cast<std::int32_t>(at(i + 3, kMost))};
  };
  const typename PairStream<D>::Pair out{part(1), part(6), shape(0), shape(5)};
  const ShapeKind a = shapes[out.shapeA].kind(), b = shapes[out.shapeB].kind();
  if (a > b)
    header.fail(where, "as first shape the kind that comes first in the list sphere, capsule, segment, box, ...");
  if (a == ShapeKind::plane && b == ShapeKind::plane) header.fail(where, "one plane at most");
  return out;
}

template <int D>
typename PairStream<D>::PairPose readPairPose(const PairHeader& header, const char* bytes, std::size_t pairs) {
  typename PairStream<D>::PairPose out;
  std::array<double, D + kRotationNumbers<D>> x;
  std::memcpy(&out.pair, bytes, sizeof out.pair);
  std::memcpy(x.data(), bytes + sizeof out.pair, sizeof x);
  if (out.pair >= pairs) header.fail("the number of a pair in a step", "0 to " + std::to_string(pairs - 1));
  RotationNumbers q{};
  for (std::size_t i = 0; i < kRotationNumbers<D>; ++i) q[i] = x[D + i];
  setNumbers(out.X_AB.q, q);
  for (int i = 0; i < D; ++i) out.X_AB.p[i] = static_cast<Real>(x[static_cast<std::size_t>(i)]);
  if (!out.X_AB.p.allFinite() || !takeWritten<D>(out.X_AB.q)) {
    header.fail("a pose", "a finite position, a rotation of length 1");
  }
  return out;
}

template <int D>
PairStream<D> readStream(const PairHeader& header, const json& top, std::string_view bytes) {
  PairStream<D> out;
  const std::string whole = "the header";
  out.scene = header.text(header.field(top, "scene", whole), "scene");
  out.dt = header.amount(header.field(top, "dt", whole), "dt");
  out.margin = header.amount(header.field(top, "margin", whole), "margin");
  const auto numbered = [](const char* what, std::size_t i) { return std::string(what) + " " + std::to_string(i); };
  for (const json& s : header.list(header.field(top, "shapes", whole), "shapes")) {
    out.shapes.push_back(readPairShape<D>(header, s, numbered("shapes", out.shapes.size())));
  }
  for (const json& p : header.list(header.field(top, "pairs", whole), "pairs")) {
    out.pairs.push_back(readPair<D>(header, p, numbered("pairs", out.pairs.size()), out.shapes));
  }
  const auto most = static_cast<std::int64_t>(bytes.size() / kPairPoseBytes<D>);
  std::int64_t left = most;
  for (const json& s : header.list(header.field(top, "steps", whole), "steps")) {
    const std::string where = numbered("steps", out.steps.size());
    header.list(s, where, 2);
    const std::int64_t first = out.steps.empty() ? 0 : out.steps.back().step + 1;
    const std::int64_t step = header.integer(s[0], where, first, std::numeric_limits<std::int64_t>::max() - 1);
    const std::int64_t pairPoses = header.integer(s[1], where, 0, left);
    out.steps.push_back({static_cast<long>(step), static_cast<std::size_t>(pairPoses)}), left -= pairPoses;
  }
  if (left != 0 || bytes.size() != static_cast<std::size_t>(most) * kPairPoseBytes<D>) {
    header.fail("the number of bytes after the header", "the size of the pairs of its steps");
  }
  const char* at = bytes.data();
  out.pairPoses.reserve(static_cast<std::size_t>(most));
  for (const auto& step : out.steps) {
    for (std::size_t i = 0; i < step.pairPoses; ++i, at += kPairPoseBytes<D>) {
      out.pairPoses.push_back(readPairPose<D>(header, at, out.pairs.size()));
      if (i > 0 && out.pairPoses.back().pair <= out.pairPoses[out.pairPoses.size() - 2].pair) {
        header.fail("the order of the pairs in step " + std::to_string(step.step), "ascending");
      }
    }
  }
  return out;
}

}  // namespace

template <int D>
void writePairs(std::ostream& out, const PairStream<D>& stream) {
  json shapes = json::array(), pairs = json::array(), steps = json::array();
  for (const Shape<D>& s : stream.shapes) shapes.push_back(pairShapeJson(s.view()));
  for (const auto& p : stream.pairs) {
    pairs.push_back({p.shapeA, p.a.body, p.a.generation, p.a.shape, p.a.part, p.shapeB, p.b.body, p.b.generation,
                     p.b.shape, p.b.part});
  }
  for (const auto& s : stream.steps) steps.push_back({s.step, s.pairPoses});
  std::string bytes = "{\"format\": \"" + std::string(kPairsFormat) +
                      "\", \"version\": " + std::to_string(kPairsVersion) + ", \"dimension\": " + std::to_string(D) +
                      ", \"scene\": " + json(stream.scene).dump() + ", \"dt\": " + json(stream.dt).dump() +
                      ", \"margin\": " + json(stream.margin).dump() + ", \"steps\": " + steps.dump() +
                      ", \"shapes\": " + shapes.dump() + ", \"pairs\": " + pairs.dump() + "}\n";
  for (const auto& m : stream.pairPoses) {
    appendBytes(bytes, m.pair);
    for (int i = 0; i < D; ++i) appendBytes(bytes, static_cast<double>(m.X_AB.p[i]));
    const RotationNumbers q = numbersOf(m.X_AB.q);
    for (std::size_t i = 0; i < kRotationNumbers<D>; ++i) appendBytes(bytes, q[i]);
  }
  appendBytes(bytes, std::uint64_t(XXH64(bytes.data(), bytes.size(), 0)));
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}
template void writePairs(std::ostream&, const PairStream<2>&);
template void writePairs(std::ostream&, const PairStream<3>&);

PairStreamFile PairStreamFile::load(const std::string& path) { return parse(readFile(path), path); }

PairStreamFile PairStreamFile::parse(const std::string& bytes, const std::string& path) {
  const std::size_t line = bytes.find('\n');
  const json top = line == bytes.npos
                       ? json()
                       : json::parse(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(line), nullptr, false);
  if (!top.is_object() || top.value("format", json()) != kPairsFormat) {
    throw UserError(path + ": not a file of pairs; valid: a file written by lpc record --pairs");
  }
  const PairHeader header{path};
  header.integer(header.field(top, "version", "the header"), "version", kPairsVersion, kPairsVersion);
  std::uint64_t checksum = 0;
  const std::size_t end = bytes.size() - std::min(bytes.size(), sizeof checksum), begin = line + 1;
  if (end >= begin) std::memcpy(&checksum, bytes.data() + end, sizeof checksum);
  if (end < begin || checksum != XXH64(bytes.data(), end, 0)) {
    throw UserError(path + ": damaged: the checksum does not match; valid: a file as written by lpc record --pairs");
  }
  const std::string_view pairPoses = std::string_view(bytes).substr(begin, end - begin);
  PairStreamFile out;
  out.dimension = static_cast<int>(header.integer(header.field(top, "dimension", "the header"), "dimension", 2, 3));
  if (out.dimension == 2) {
    out.in2 = readStream<2>(header, top, pairPoses);
  } else {
    out.in3 = readStream<3>(header, top, pairPoses);
  }
  return out;
}

}}  // namespace lpc::LPC_PRECISION
