// SPDX-License-Identifier: Zlib
// One list of fields serves writing and reading. Fields are written singly, never as whole structs: the bytes of a save
// depend only on the state, and padding bytes are not state.
#define XXH_INLINE_ALL  // no link to the library for one hash
#include <xxhash.h>

#include <cstring>
#include <istream>
#include <ostream>
#include <sstream>
#include <type_traits>

#include "framework/shape/curved_core.h"
#include "framework/shape/surface.h"
#include "framework/world/saved_state.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

constexpr char kMagic[] = "LPCWORLD10";  // increase the number when the format changes

/// Precedes the world, so that damage is reported before the world is read.
struct Header {
  std::array<char, sizeof kMagic> magic = std::to_array(kMagic);
  std::int32_t dimension = 0, realBytes = 0;
  std::uint64_t size = 0, checksum = 0;  // of the bytes that follow: count, XXH64
};

class Archive {
 public:
  explicit Archive(std::ostream& out) : m_out(&out) {}
  explicit Archive(std::istream& in) : m_in(&in) {}
  bool reading() const { return m_in != nullptr; }

  template <class... T>
  void operator()(T&... values) {
    (value(values), ...);
  }

 private:
  template <class T>
  void value(T& x) {
    if constexpr (std::is_same_v<T, bool>) {
      auto byte = static_cast<std::uint8_t>(x);  // a bool must not be read from any other byte
      bytes(&byte, sizeof byte);
      if (byte > 1) throw UserError("load: the saved world is damaged (a flag is neither 0 nor 1)");
      x = byte != 0;
    } else if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>) {
      bytes(&x, sizeof x);
    } else if constexpr (requires { x.derived(); }) {  // an Eigen matrix
      bytes(x.data(), sizeof(Real) * static_cast<std::size_t>(x.size()));
    } else if constexpr (requires { x.push_back({}); }) {  // a vector or a text
      std::uint64_t n = x.size();
      bytes(&n, sizeof n);
      if (reading()) x.clear();
      for (std::uint64_t i = 0; i < n; ++i) {  // grows while reading, so that a damaged length hits the end of the file
        if (reading()) x.push_back({});
        value(x[i]);
      }
    } else if constexpr (requires { x.has_value(); }) {
      bool there = x.has_value();
      value(there);
      if (reading() && there) x.emplace();
      if (there) value(*x);
    } else if constexpr (requires { std::tuple_size<T>::value; }) {  // an array
      for (auto& e : x) value(e);
    } else {
      fields(*this, x);
    }
  }
  void bytes(void* data, std::size_t size) {
    if (m_out) {
      m_out->write(static_cast<const char*>(data), static_cast<std::streamsize>(size));
    } else {
      m_in->read(static_cast<char*>(data), static_cast<std::streamsize>(size));
      if (static_cast<std::size_t>(m_in->gcount()) != size) throw UserError("load: the saved world ends early");
    }
  }

  std::ostream* m_out = nullptr;
  std::istream* m_in = nullptr;
};

void fields(Archive& a, Header& h) { a(h.magic, h.dimension, h.realBytes, h.size, h.checksum); }

// Reads in pieces, so that a damaged length hits the end of the file, not the memory limit.
std::string readBytes(std::istream& in, std::uint64_t size) {
  constexpr std::uint64_t kPiece = 1 << 20;
  std::string bytes;
  while (bytes.size() < size) {
    const std::size_t had = bytes.size(), wanted = std::min(kPiece, size - had);
    bytes.resize(had + wanted);
    in.read(bytes.data() + had, static_cast<std::streamsize>(wanted));
    if (static_cast<std::size_t>(in.gcount()) != wanted) throw UserError("load: the saved world ends early");
  }
  return bytes;
}

void fields(Archive& a, Rot<2>& q) { a(q.c, q.s); }
void fields(Archive& a, Rot<3>& q) { a(q.w, q.x, q.y, q.z); }
template <int D>
void fields(Archive& a, Pose<D>& x) {
  a(x.p, x.q);
}
template <int D>
void fields(Archive& a, Motion<D>& m) {
  a(m.v, m.w);
}
template <int D>
void fields(Archive& a, Wrench<D>& w) {
  a(w.force, w.torque);
}
template <int D>
void fields(Archive& a, MassProperties<D>& m) {
  a(m.mass, m.center, m.inertia);
}
void fields(Archive& a, SleepEvent& e) { a(e.kind, e.body, e.other, e.speed); }
template <int D>
void fields(Archive& a, ContactPoint<D>& c) {
  a(c.localA, c.localB, c.separation, c.feature, c.impulse, c.memory, c.load);
}
template <int D>
void fields(Archive& a, Manifold<D>& m) {
  a(m.bodyA, m.bodyB, m.shapeA, m.shapeB, m.partA, m.partB, m.count, m.normal, m.friction, m.restitution, m.begun,
    m.ignored, m.points, m.X_AB, m.normalA);
}
// The checksum is right: this program lacks the kind, the save is not damaged.
template <class Kind>
std::unique_ptr<Kind> createSaved(const std::string& text) {
  const Spec spec = Spec::parse(text);
  const auto& all = Registry::instance().all();
  if (!all.contains({Kind::kStage, Kind::kDimension, spec.name})) {
    throw UserError("load: the saved world has the " + std::string(stageName(Kind::kStage)) + " '" + spec.name +
                    "', which is not registered in " + std::to_string(Kind::kDimension) +
                    "D; valid: load the plugin that defines it");
  }
  return createStage<Kind>(spec);
}

void fields(Archive& a, PairRecord& r) { a(r.bodyA, r.shapeA, r.bodyB, r.shapeB, r.partA, r.partB, r.memory.bytes); }
template <int D>
void fields(Archive& a, JointRecord<D>& j) {
  a(j.spec, j.generation);  // no spec: a free slot
  if (j.spec.empty()) return;
  if (a.reading()) j.kind = createSaved<JointKind<D>>(j.spec);
  a(j.bodyA, j.bodyB, j.collide, j.broken, j.X_CaJ, j.X_CbJ, j.breakForce, j.breakTorque, j.impulse, j.memory, j.state);
}
template <int D>
void fields(Archive& a, ForceRecord<D>& f) {
  a(f.spec, f.generation);  // no spec: a free slot
  if (f.spec.empty()) return;
  if (a.reading()) f.kind = createSaved<ForceKind<D>>(f.spec);
  a(f.bodyA, f.bodyB, f.localA, f.localB);
}
template <int D>
void fields(Archive& a, Bodies<D>& b) {
  a(b.pose, b.motion, b.mass, b.invInertiaBody, b.center, b.type, b.used, b.awake, b.canSleep, b.pinned, b.sleep,
    b.solver, b.generation, b.userData, b.rotatable, b.gravityScale, b.givenMass);
}
void fields(Archive& a, PhysicsModel& f) {
  a(f.friction, f.rotation, f.restitution, f.cache, f.joints, f.sleeping, f.continuous);
}

void fields(Archive& a, Polytope<2>& p) { a(p.vertices, p.normals); }
void fields(Archive& a, Polytope<3>::Face& f) { a(f.normal, f.offset, f.begin, f.end); }
void fields(Archive& a, Polytope<3>::Edge& e) { a(e.v0, e.v1, e.faceA, e.faceB); }
void fields(Archive& a, Polytope<3>& p) {
  a(p.vertices, p.faces, p.loop, p.edges);
  if (a.reading()) linkVertices(p);
}

// Stores a hull as it is, not as points: a new hull of the points might order its vertices differently.
template <int D>
void convexFields(Archive& a, ShapeKind kind, Shape<D>& shape) {
  ShapeView<D> v;
  if (!a.reading()) v = shape.view();
  v.kind = kind;
  a(v.radius, v.half);
  if (static_cast<int>(v.kind) >= kShapeKinds) {
    throw UserError("load: the saved world is damaged (a shape of unknown kind)");
  }
  switch (v.core()) {
    case CoreClass::point:
      shape = Shape<D>::sphere(v.radius);
      break;
    case CoreClass::segment:
      shape = v.kind == ShapeKind::segment ? Shape<D>::segment(v.half[0]) : Shape<D>::capsule(v.half[0], v.radius);
      break;
    case CoreClass::box:
      shape = Shape<D>::box(v.half, v.radius);
      break;
    case CoreClass::hull: {
      if (v.kind == ShapeKind::triangle) {  // all else follows from its corners
        std::vector<Vec<D>> corners;
        if (!a.reading()) corners = v.hull->vertices;
        a(corners);
        shape = Shape<D>::ofCorners(v.kind, corners, v.radius);
        break;
      }
      Polytope<D> hull = a.reading() ? Polytope<D>{} : *v.hull;
      a(hull);
      if (a.reading()) shape = Shape<D>::polytope(std::make_shared<const Polytope<D>>(std::move(hull)), v.radius);
      break;
    }
    case CoreClass::curved: {
      std::vector<Real> sizes;
      if (!a.reading()) sizes.assign(v.curved->sizes().begin(), v.curved->sizes().end());
      a(sizes);
      if (v.kind == ShapeKind::custom && !curvedKinds<D>().contains(v.kind)) {
        throw UserError("load: the saved world has a shape 'custom', which is not registered in " + std::to_string(D) +
                        "D; valid: load the plugin that defines it");
      }
      shape = Shape<D>::curved(v.kind, sizes, v.radius);
      break;
    }
    case CoreClass::plane:
      shape = Shape<D>::plane();
      break;
  }
}

template <int D>
void fields(Archive& a, ShapePart<D>& part) {
  ShapeKind kind = part.shape.kind();
  a(kind);
  convexFields(a, kind, part.shape);
  a(part.X_SP);
}

// Stores a surface as it was given; all else follows.
template <int D>
void surfaceFields(Archive& a, Shape<D>& shape) {
  std::vector<Vec<D>> points;
  std::vector<std::array<int, D>> corners;
  if (!a.reading()) points = shape.surface()->points(), corners = shape.surface()->corners();
  a(points, corners);
  if (!a.reading()) return;
  if constexpr (D == 3) {
    shape = Shape<D>::mesh(points, corners);
  } else {
    shape = Shape<D>::chain(points, corners.size() == points.size());
  }
}

template <int D>
void fields(Archive& a, Shape<D>& shape) {
  constexpr ShapeKind kCompound{255}, kSurface{254};  // stored instead of a kind
  ShapeKind kind = shape.convex() ? shape.kind() : shape.surface() ? kSurface : kCompound;
  a(kind);
  if (kind == kSurface) return surfaceFields(a, shape);
  if (kind != kCompound) return convexFields(a, kind, shape);
  std::vector<ShapePart<D>> parts(shape.parts().begin(), shape.parts().end());
  a(parts);
  if (a.reading()) shape = Shape<D>::compound(parts);
}
template <int D>
void fields(Archive& a, ShapeRecord<D>& s) {
  a(s.body);
  if (s.body >= 0) a(s.shape, s.X_CS, s.index, s.friction, s.restitution, s.category, s.mask, s.userData, s.density);
}
template <int D>
void fields(Archive& a, WorldSettings<D>& s) {
  a(s.gravity, s.restitutionThreshold, s.margin, s.model, s.mixing.friction, s.mixing.restitution, s.sleepingContacts);
}

template <int D>
void fields(Archive& a, SavedState<D>& s) {
  a(s.settings, s.bodies, s.shapes, s.joints, s.manifolds, s.userForces, s.events, s.time, s.lastDt, s.sinceContacts,
    s.steps, s.records, s.forces);
}

Header readHeader(std::istream& in) {
  Header header{};
  header.magic = {};
  Archive outer(in);
  outer(header.magic);
  if (std::memcmp(header.magic.data(), kMagic, sizeof kMagic) != 0) {
    std::string_view found(header.magic.data(), header.magic.size() - 1);
    found = found.substr(0, found.find('\0'));  // older formats have a digit less
    if (!found.starts_with("LPCWORLD")) throw UserError("load: this is not a saved world");
    throw UserError("load: the saved world has the format " + std::string(found) + "; this program reads " + kMagic);
  }
  outer(header.dimension, header.realBytes, header.size, header.checksum);
  return header;
}

}  // namespace

SavedKind savedKind(std::istream& in) {
  const Header header = readHeader(in);
  return {header.dimension, header.realBytes};
}

template <int D>
void writeState(std::ostream& out, SavedState<D> state) {
  std::ostringstream body;
  Archive inner(body);
  inner(state);
  const std::string bytes = std::move(body).str();
  Header header;
  header.dimension = D, header.realBytes = sizeof(Real);
  header.size = bytes.size(), header.checksum = XXH64(bytes.data(), bytes.size(), 0);
  Archive outer(out);
  outer(header);
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

template <int D>
SavedState<D> readState(std::istream& in) {
  const Header header = readHeader(in);
  if (header.dimension != D || header.realBytes != static_cast<std::int32_t>(sizeof(Real))) {
    throw UserError("load: the saved world is " + std::to_string(header.dimension) + "D with " +
                    std::to_string(std::int64_t(8) * header.realBytes) + "-bit numbers; this world is " +
                    std::to_string(D) + "D with " + std::to_string(8 * sizeof(Real)) + "-bit numbers");
  }
  std::istringstream body(readBytes(in, header.size));
  const std::string_view bytes = body.view();
  if (XXH64(bytes.data(), bytes.size(), 0) != header.checksum) {
    throw UserError("load: the saved world is damaged (its checksum does not match)");
  }
  SavedState<D> s;
  try {
    Archive inner(body);
    inner(s);
    if (body.peek() != std::istringstream::traits_type::eof()) throw UserError("data after the end of the world");
  } catch (const UserError& e) {  // also thrown for a shape's size or a joint's parameter
    const std::string_view what = e.what();
    if (what.starts_with("load: ")) throw;
    throw UserError("load: the saved world is damaged (" + std::string(what) + ")");
  }
  return s;
}

template void writeState(std::ostream&, SavedState<2>);
template void writeState(std::ostream&, SavedState<3>);
template SavedState<2> readState(std::istream&);
template SavedState<3> readState(std::istream&);

}}  // namespace lpc::LPC_PRECISION
