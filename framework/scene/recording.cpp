// SPDX-License-Identifier: Zlib
#include "framework/scene/recording.h"

#include <cmath>
#include <cstring>
#include <istream>
#include <ostream>

#include "framework/math/user_numbers.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

constexpr char kRecordingMagic[] = "LPCREC2", kFirstFormat[] = "LPCREC1";

template <class T>
void put(std::ostream& out, T value) {
  out.write(reinterpret_cast<const char*>(&value), sizeof value);
}
template <class T>
bool get(std::istream& in, T& value) {
  in.read(reinterpret_cast<char*>(&value), sizeof value);
  return static_cast<std::size_t>(in.gcount()) == sizeof value;
}

void putReal(std::ostream& out, Real x) { put(out, static_cast<double>(x)); }
bool getReal(std::istream& in, Real& x) {
  double d = 0;
  const bool ok = get(in, d);
  x = static_cast<Real>(d);
  return ok;
}
template <class V>
void putVec(std::ostream& out, const V& v) {
  for (int i = 0; i < v.size(); ++i) putReal(out, v[i]);
}
template <class V>
bool getVec(std::istream& in, V& v) {
  bool ok = true;
  for (int i = 0; i < v.size(); ++i) ok = ok && getReal(in, v[i]);
  return ok;
}
void putRot(std::ostream& out, const Rot<2>& q) { putReal(out, q.c), putReal(out, q.s); }
void putRot(std::ostream& out, const Rot<3>& q) {
  putReal(out, q.w), putReal(out, q.x), putReal(out, q.y), putReal(out, q.z);
}
bool getRot(std::istream& in, Rot<2>& q) { return getReal(in, q.c) && getReal(in, q.s); }
bool getRot(std::istream& in, Rot<3>& q) {
  return getReal(in, q.w) && getReal(in, q.x) && getReal(in, q.y) && getReal(in, q.z);
}

// How far a stored rotation may be from unit length: the rounding of f32, whichever precision reads it.
constexpr Real kWrittenUnit = Real(1e-5);

Real lengthOf(const Rot<2>& q) { return std::sqrt(q.c * q.c + q.s * q.s); }
Real lengthOf(const Rot<3>& q) { return std::sqrt(q.w * q.w + q.imag().squaredNorm()); }

// Throws for unsound data, with the number of the frame, from 1.
struct Reading {
  std::istream& in;
  std::size_t frame;

  void require(bool sound, const char* otherwise) const {
    if (sound) return;
    throw UserError("the recording is damaged (frame " + std::to_string(frame) + ": " + otherwise + ")");
  }
};

template <int D>
bool getNewBody(const Reading& reading, typename Recording<D>::NewBody& a) {
  std::istream& in = reading.in;
  std::uint32_t parts = 0;
  if (!get(in, a.slot) || !get(in, a.generation) || !get(in, a.type) || !get(in, parts)) return false;
  reading.require(a.slot >= 0, "a body with an invalid slot");
  reading.require(a.type <= BodyType::dynamic, "a body of unknown type");
  for (std::uint32_t i = 0; i < parts; ++i) {
    auto& p = a.parts.emplace_back();
    std::uint32_t vertices = 0;
    if (!get(in, p.kind) || !getReal(in, p.radius) || !getVec(in, p.half) || !getVec(in, p.X_CS.p) ||
        !getRot(in, p.X_CS.q) || !get(in, vertices)) {
      return false;
    }
    reading.require(static_cast<int>(p.kind) < kShapeKinds && (p.kind == ShapeKind::custom || kindExists(p.kind, D)),
                    "a shape of unknown kind");
    const bool turned = std::abs(lengthOf(p.X_CS.q) - 1) < kWrittenUnit;
    reading.require(p.X_CS.p.allFinite() && turned, "a shape's pose is invalid");
    if (!isUnit(p.X_CS.q)) p.X_CS.q = p.X_CS.q.normalized();
    for (std::uint32_t k = 0; k < vertices; ++k) {
      if (!getVec(in, p.vertices.emplace_back(Vec<D>::Zero()))) return false;
    }
  }
  return true;
}

template <int D>
bool getFrame(const Reading& reading, bool hasLinks, typename Recording<D>::Frame& f) {
  std::istream& in = reading.in;
  std::uint32_t newBodies = 0, bodies = 0;
  if (!get(in, f.step) || !get(in, f.time) || !get(in, newBodies) || !get(in, bodies)) return false;
  reading.require(f.step >= 0 && std::isfinite(f.time), "a frame with an invalid step or time");
  for (std::uint32_t i = 0; i < newBodies; ++i) {
    if (!getNewBody<D>(reading, f.newBodies.emplace_back())) return false;
  }
  for (std::uint32_t i = 0; i < bodies; ++i) {
    auto& b = f.bodies.emplace_back();
    if (!get(in, b.slot) || !get(in, b.generation) || !get(in, b.awake) || !getVec(in, b.X_WC.p) ||
        !getRot(in, b.X_WC.q)) {
      return false;
    }
    reading.require(b.slot >= 0, "a body with an invalid slot");
    reading.require(b.awake <= 1, "a body's flag is neither 0 nor 1");
  }
  std::uint32_t links = 0;
  if (hasLinks && !get(in, links)) return false;
  for (std::uint32_t i = 0; i < links; ++i) {
    auto& link = f.links.emplace_back();
    std::uint8_t force = 0;
    if (!get(in, force) || !getVec(in, link.from) || !getVec(in, link.a) || !getVec(in, link.b) ||
        !getVec(in, link.to)) {
      return false;
    }
    reading.require(force <= 1, "a link's flag is neither 0 nor 1");
    reading.require(link.from.allFinite() && link.a.allFinite() && link.b.allFinite() && link.to.allFinite(),
                    "a link's position is not finite");
    link.force = force == 1;
  }
  return true;
}

struct Header {
  std::int32_t dimension = 0;
  bool first = false;  // the first format
  std::string title;
};

Header readHeader(std::istream& in) {
  char magic[sizeof kRecordingMagic] = {};
  Header out;
  in.read(magic, sizeof magic);
  out.first = std::memcmp(magic, kFirstFormat, sizeof magic) == 0;
  if (!out.first && std::memcmp(magic, kRecordingMagic, sizeof magic) != 0)
    throw UserError("this is not a recording of a world");
  if (!get(in, out.dimension)) throw UserError("the recording ends early");
  if (out.first) return out;
  std::uint32_t length = 0;
  if (!get(in, length)) throw UserError("the recording ends early");
  for (std::uint32_t i = 0; i < length; ++i) {
    char c = 0;
    if (!get(in, c)) throw UserError("the recording ends early");
    if (c < ' ' || c > '~') throw UserError("the recording is damaged (a title that is not printable)");
    out.title += c;
  }
  return out;
}

}  // namespace

template <int D>
Recorder<D>::Recorder(std::ostream& out, const std::string& title) : m_out(out) {
  m_out.write(kRecordingMagic, sizeof kRecordingMagic);
  put(m_out, static_cast<std::int32_t>(D));
  put(m_out, static_cast<std::uint32_t>(title.size()));
  m_out.write(title.data(), static_cast<std::streamsize>(title.size()));
}

template <int D>
void Recorder<D>::frame(const Simulation<D>& world) {
  const Bodies<D>& b = world.bodies();
  m_known.resize(b.pose.size(), 0);
  std::vector<std::size_t> newBodies;
  for (std::size_t i = 0; i < b.pose.size(); ++i) {
    if (b.used[i] && m_known[i] != std::uint64_t(b.generation[i]) + 1) newBodies.push_back(i);
  }
  put(m_out, static_cast<std::int64_t>(world.stepCount()));
  put(m_out, static_cast<double>(world.time()));
  put(m_out, static_cast<std::uint32_t>(newBodies.size()));
  put(m_out, static_cast<std::uint32_t>(world.bodyCount()));
  for (std::size_t i : newBodies) {
    m_known[i] = std::uint64_t(b.generation[i]) + 1;
    std::vector<std::pair<ShapeView<D>, Pose<D>>> parts;  // convex parts
    for (const ShapeRecord<D>& s : world.shapes()) {
      if (s.body != static_cast<std::int32_t>(i)) continue;
      forParts(s.shape, s.X_CS, [&](const auto& part, const Pose<D>& X_CP) { parts.emplace_back(part, X_CP); });
    }
    put(m_out, static_cast<std::int32_t>(i)), put(m_out, b.generation[i]), put(m_out, b.type[i]);
    put(m_out, static_cast<std::uint32_t>(parts.size()));
    for (const auto& [v, X_CP] : parts) {
      put(m_out, v.kind), putReal(m_out, v.radius), putVec(m_out, v.half), putVec(m_out, X_CP.p);
      putRot(m_out, X_CP.q);
      put(m_out, static_cast<std::uint32_t>(v.hull ? v.hull->vertices.size() : 0));
      if (v.hull) {
        for (const Vec<D>& p : v.hull->vertices) putVec(m_out, p);
      }
    }
  }
  for (std::size_t i = 0; i < b.pose.size(); ++i) {
    if (!b.used[i]) continue;
    put(m_out, static_cast<std::int32_t>(i)), put(m_out, b.generation[i]), put(m_out, b.awake[i]);
    putVec(m_out, b.pose[i].p), putRot(m_out, b.pose[i].q);
  }
  const std::vector<Link<D>> links = linksOf(world);
  put(m_out, static_cast<std::uint32_t>(links.size()));
  for (const Link<D>& link : links) {
    put(m_out, static_cast<std::uint8_t>(link.force));
    putVec(m_out, link.from), putVec(m_out, link.a), putVec(m_out, link.b), putVec(m_out, link.to);
  }
}

int recordingDimension(std::istream& in) {
  const auto begin = in.tellg();
  const std::int32_t dimension = readHeader(in).dimension;
  in.seekg(begin);
  return dimension;
}

template <int D>
Recording<D> Recording<D>::read(std::istream& in) {
  const auto [dimension, first, title] = readHeader(in);
  if (dimension != D) {
    throw UserError("the recording is " + std::to_string(dimension) + "D; asked: " + std::to_string(D) + "D");
  }
  Recording r;
  r.title = title;
  while (in.peek() != std::istream::traits_type::eof()) {
    Frame f;
    r.torn = !getFrame<D>({in, r.frames.size() + 1}, !first, f);
    if (r.torn) break;
    r.frames.push_back(std::move(f));
  }
  return r;
}

template struct Recording<2>;
template struct Recording<3>;
template class Recorder<2>;
template class Recorder<3>;

}}  // namespace lpc::LPC_PRECISION
