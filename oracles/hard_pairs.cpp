// SPDX-License-Identifier: Zlib
#include "oracles/hard_pairs.h"

#include <array>
#include <limits>

#include "framework/check.h"
#include "framework/curved_core.h"
#include "framework/random.h"
#include "framework/support_map.h"

namespace lpc::inline LPC_PRECISION {
namespace {

enum Family {
  anywhere,
  kissingFaces,
  nearParallel,
  sharedPlanes,
  ties,
  sizeRatio,
  slivers,
  farFromOrigin,
  coreContact,
  curvedOnEdge,
  belowTolerance,
  nastyHulls,
  kFamilyCount
};
constexpr std::array<std::string_view, kFamilyCount> kNames = {
    "random",          "kissing_faces", "near_parallel",  "shared_planes",   "ties",       "size_ratio", "slivers",
    "far_from_origin", "core_contact",  "curved_on_edge", "below_tolerance", "nasty_hulls"};

constexpr double kQuarterTurn = 1.57079632679489661923;

Rot<2> turn(const Ang<2>& v) { return Rot<2>::angle(v[0]); }
Rot<3> turn(const Ang<3>& v) { return Rot<3>::vector(v); }

template <int D>
class Drawer {  // no expression draws twice: the order would be the compiler's
 public:
  explicit Drawer(std::uint64_t seed) : m_random(seed) {}

  HardPair<D> draw(ShapeKind kindA, ShapeKind kindB) {
    const bool polytope = kindA == ShapeKind::polytope || kindB == ShapeKind::polytope;
    const auto drawn = static_cast<int>(1 + m_random.below(16));
    m_family = drawn < kFamilyCount ? static_cast<Family>(drawn) : anywhere;
    if (m_family == nastyHulls && !polytope) m_family = belowTolerance;
    m_scale = number({1e-3, 1, 1e3});
    m_height = length();
    const bool largeA = coin();
    const double ratio = m_family == sizeRatio ? number({1e2, 1e3, 1e4}) : 1;
    std::vector<Vec<D>> pointsA, pointsB;
    HardPair<D> pair{.a = shape(kindA, largeA ? ratio : 1, true, pointsA),
                     .b = shape(kindB, largeA ? 1 : ratio, false, pointsB),
                     .family = kNames[m_family],
                     .scale = m_scale};
    if (m_family == ties && kindA == kindB && coin()) pair.b = pair.a, pointsB = pointsA;
    pair.pointsA = std::move(pointsA), pair.pointsB = std::move(pointsB);
    const bool plane = coreClass(kindA) == CoreClass::plane || coreClass(kindB) == CoreClass::plane;
    plane ? layOnPlane(pair) : layOut(pair);
    place(pair);
    return pair;
  }

 private:
  bool coin() { return m_random.below(2) == 1; }
  double number(std::initializer_list<double> values) { return values.begin()[m_random.below(values.size())]; }
  Real pick(std::initializer_list<double> values) { return static_cast<Real>(number(values)); }
  Real uniform(double lo, double hi) { return static_cast<Real>(m_random.uniform(lo, hi)); }
  int axis() { return static_cast<int>(m_random.below(D)); }
  Vec<D> direction() {
    Vec<D> v;
    do {
      for (int k = 0; k < D; ++k) v[k] = uniform(-1, 1);
    } while (!(v.norm() > Real(0.01) && v.norm() <= 1));
    return v.normalized();
  }
  // Often one along which features of equal rank meet.
  Vec<D> telling() {
    const auto k = m_random.below(4);
    if (k == 0) return Vec<D>::Unit(axis());
    return k == 1 ? Vec<D>(Vec<D>::Ones().normalized()) : direction();
  }
  Rot<D> anyRotation() {
    Ang<D> v;
    for (int k = 0; k < kAngDim<D>; ++k) v[k] = uniform(-3, 3);
    return turn(v);
  }
  Real length() { return static_cast<Real>(m_scale) * uniform(0.1, 1); }
  Vec<D> half() {
    Vec<D> h;
    for (int k = 0; k < D; ++k) h[k] = length();
    if (m_family == ties && coin()) h.setConstant(Real(h[0]));
    if (m_family == sharedPlanes) h[D - 1] = m_height;
    return h;
  }

  Shape<D> shape(ShapeKind kind, double ratio, bool first, std::vector<Vec<D>>& points) {
    const Real large = static_cast<Real>(ratio);
    const int thinAxis = axis();
    const Real thin = m_family == slivers && (first || coin()) ? Real(1e-4) : Real(1);
    bool rounded = m_random.below(4) == 0 && m_family != sharedPlanes;
    if (m_family == curvedOnEdge && !first) rounded = true;
    const Real rounding = rounded ? thin * large * length() / 4 : Real(0);
    switch (coreClass(kind)) {
      case CoreClass::point:
        return Shape<D>::sphere(large * (m_family == sharedPlanes ? m_height : length()));
      case CoreClass::segment: {
        if (kind == ShapeKind::segment) return Shape<D>::segment(large * length());
        const Real radius = m_family == sharedPlanes ? m_height : length() / 2;
        return Shape<D>::capsule(large * length(), thin * large * radius);
      }
      case CoreClass::box: {
        Vec<D> h = large * half();
        if (large > 1 && coin()) h[axis()] = length();  // a slab
        h[thinAxis] *= thin;
        return Shape<D>::box(h, rounding);
      }
      case CoreClass::curved: {
        std::vector<Real> sizes;
        for (std::size_t i = 0; i < curvedKind<D>(kind).sizes.size(); ++i) sizes.push_back(large * length());
        if (m_family == ties && coin()) sizes.assign(sizes.size(), Real(sizes[0]));
        if (m_family == sharedPlanes) sizes[0] = m_height;
        sizes[static_cast<std::size_t>(thinAxis) % sizes.size()] *= thin;
        return Shape<D>::curved(kind, sizes, rounding);
      }
      case CoreClass::plane:
        return Shape<D>::plane();
      case CoreClass::hull:
        break;
    }
    points = m_family == sharedPlanes ? prism() : m_family == nastyHulls ? nasty() : cloud();
    for (Vec<D>& p : points) p *= large, p[thinAxis] *= thin;
    return Shape<D>::polytope(std::span<const Vec<D>>(points), rounding);
  }

  // A simplex, so that there is a volume, and up to twelve more points.
  std::vector<Vec<D>> cloud() {
    const Vec<D> h = half();
    std::vector<Vec<D>> points(1, -h);
    for (int k = 0; k < D; ++k) {
      points.push_back(-h);
      points.back()[k] = 2 * h[k];
    }
    for (std::uint64_t n = m_random.below(13); n > 0; --n) points.push_back(h.cwiseProduct(direction()) * Real(1.5));
    return points;
  }

  // Between two planes that both shapes share.
  std::vector<Vec<D>> prism() {
    std::vector<Vec<D>> points = cloud();
    const std::size_t base = points.size();
    for (std::size_t i = 0; i < base; ++i) {
      points.push_back(points[i]);
      points[i][D - 1] = -m_height, points.back()[D - 1] = m_height;
    }
    return points;
  }

  // What hulls and their users were seen to stumble over.
  std::vector<Vec<D>> nasty() {
    std::vector<Vec<D>> points = cloud();
    const Vec<D> h = half();
    switch (m_random.below(4)) {
      case 0:  // points twice, almost twice, and in the middle of edges and faces
        for (std::size_t i = 0, n = points.size(); i < n; ++i) {
          points.push_back(points[i] * (1 + pick({0, 1e-15, 1e-12, 1e-9})));
          points.push_back((points[i] + points[(i + 1) % n]) / 2);
        }
        break;
      case 1:  // forty corners on one sphere
        points.clear();
        for (int i = 0; i < 40; ++i) points.push_back(h[0] * direction());
        break;
      case 2:  // corners that differ by a millionth of the size
        for (std::size_t i = 0, n = points.size(); i < n; ++i)
          points.push_back(points[i] + Real(1e-6) * h[0] * direction());
        break;
      default: {  // small, and far from its own frame's origin
        const Real far = static_cast<Real>(m_scale) * pick({1e2, 1e3});
        const Vec<D> away = far * direction();
        for (Vec<D>& p : points) p += away;
        break;
      }
    }
    return points;
  }

  // Puts B so that its lowest point along n lies `gap` above A's highest one: the distance is gap when gap >= 0.
  void touch(HardPair<D>& pair, const Vec<D>& n, Real gap) {
    const ShapeView<D>&a = pair.a.view(), &b = pair.b.view();
    const Vec<D> top = coreSupport(a, n) + a.radius * n;
    const Vec<D> bottom = pair.X_AB.q * coreSupport(b, Vec<D>(pair.X_AB.q.inverse() * Vec<D>(-n))) - b.radius * n;
    pair.X_AB.p = top - bottom + gap * n;
  }
  // The same along a coordinate axis, and B anywhere across it: face on face, not corner on corner.
  void lay(HardPair<D>& pair, Real gap, Real aside) {
    const int k = axis();
    touch(pair, Vec<D>::Unit(k), gap);
    for (int j = 0; j < D; ++j) {
      if (j != k) pair.X_AB.p[j] = aside * uniform(-0.5, 0.5);
    }
  }
  void scatter(HardPair<D>& pair, Real size, Real smaller) {
    pair.X_AB.q = anyRotation();
    const Vec<D> n = direction();
    if (coin()) {
      touch(pair, n, smaller * uniform(-0.5, 0.3));
    } else {
      pair.X_AB.p = size * uniform(0, 1.2) * n;
    }
  }

  // The gap between a shape of this size and a plane, as the family has it between two shapes.
  Real gapOf(Real size) {
    switch (m_family) {
      case kissingFaces:
      case sharedPlanes:
        return size * std::numeric_limits<Real>::epsilon() * pick({0, 1, -1, 2, -2, 3, -3, 4, -4});
      case belowTolerance:
      case curvedOnEdge:
        return size * pick({1e-4, -1e-4, 1e-6, -1e-6, 1e-8, -1e-8, 1e-9, -1e-9, 1e-12, -1e-12});
      case coreContact:
        return -size * pick({1, 0.5, 0});
      default:
        return size * uniform(-1.5, 1.5);
    }
  }
  // As a thing lies on the floor, tilted as `nearParallel` and `ties` are, or anyhow.
  void layOnPlane(HardPair<D>& pair) {
    const bool planeA = pair.a.view().core() == CoreClass::plane;
    const ShapeView<D>& body = (planeA ? pair.b : pair.a).view();
    const Real size = boundingRadius(body), gap = gapOf(size);
    Pose<D> X_PB;  // the body in the plane's frame
    Ang<D> v;
    const double angle = number({0, 1e-15, 1e-12, 1e-9, 1e-6, 1e-3}), quarter = kQuarterTurn * number({0, 0.5, 1, 2});
    for (int k = 0; k < kAngDim<D>; ++k) v[k] = static_cast<Real>(angle * number({1, 0, -1}));
    v[kAngDim<D> - 1] += static_cast<Real>(quarter);  // about z: from lying to standing
    const bool tilted =
        m_family == nearParallel || m_family == ties || m_family == kissingFaces || m_family == sharedPlanes;
    X_PB.q = tilted ? turn(v) : anyRotation();
    for (int k = 0; k < D; ++k) X_PB.p[k] = size * uniform(-1, 1);
    const Vec<D> down = X_PB.q.inverse() * Vec<D>(-Vec<D>::Unit(1));
    X_PB.p[1] = gap + coreSupport(body, down).dot(down) + body.radius;
    pair.X_AB = planeA ? X_PB : X_PB.inverse();
  }

  // X_AB as meant.
  void layOut(HardPair<D>& pair) {
    const Real ra = boundingRadius(pair.a.view()), rb = boundingRadius(pair.b.view());
    const Real size = ra + rb, smaller = std::min(ra, rb);
    const Vec<D> n = telling();
    switch (m_family) {
      case kissingFaces:
        lay(pair, size * std::numeric_limits<Real>::epsilon() * pick({0, 1, -1, 2, -2, 3, -3, 4, -4}), smaller);
        return;
      case nearParallel: {
        const double angle = number({0, 1e-15, 1e-12, 1e-9, 1e-6, 1e-3});
        Ang<D> v;
        for (int k = 0; k < kAngDim<D>; ++k) v[k] = static_cast<Real>(angle * number({1, 0, -1}));
        pair.X_AB.q = turn(v);
        lay(pair, smaller * uniform(-0.3, 0.2), smaller);
        return;
      }
      case sharedPlanes:
        for (int k = 0; k < D - 1; ++k) pair.X_AB.p[k] = coin() ? uniform(-1, 1) * size / 2 : Real(0);
        return;
      case ties:
        if (coin()) {
          Ang<D> v = Ang<D>::Zero();
          v[static_cast<int>(m_random.below(kAngDim<D>))] = static_cast<Real>(kQuarterTurn * number({0, 0.5, 1}));
          pair.X_AB.q = turn(v);
        }
        if (coin()) touch(pair, n, -smaller * pick({0, 0.1, 0.5}));
        return;
      case sizeRatio:
        if (coin()) {
          lay(pair, smaller * uniform(-0.5, 0.5), size);
          return;
        }
        pair.X_AB.q = anyRotation();
        touch(pair, n, smaller * uniform(-0.5, 0.5));
        return;
      case slivers:
        pair.X_AB.q = anyRotation();
        if (coin()) {  // an inner point of A is one of B
          const Vec<D> a = uniform(0, 1) * coreSupport(pair.a.view(), n);
          const Vec<D> b = uniform(0, 1) * coreSupport(pair.b.view(), telling());
          pair.X_AB.p = a - pair.X_AB.q * b;
        } else {
          const Real most = smaller * pick({0.1, 1e-4, 1e-5});
          touch(pair, n, most * uniform(-1, 1));
        }
        return;
      case coreContact:
        if (coin()) pair.X_AB.q = anyRotation();
        pair.X_AB.p = pick({0, 0.5, 1}) * coreSupport(pair.a.view(), n);
        return;
      case curvedOnEdge:
        pair.X_AB.q = anyRotation();
        touch(pair, n, smaller * pick({0, 1e-8, -1e-8, 1e-4, -1e-4}));
        return;
      case belowTolerance:
        if (coin()) pair.X_AB.q = anyRotation();
        touch(pair, n, size * pick({1e-6, -1e-6, 1e-7, -1e-7, 1e-8, -1e-8, 1e-9, -1e-9, 1e-12, -1e-12}));
        return;
      default:
        scatter(pair, size, smaller);
        return;
    }
  }

  // The pair as a whole: half of the families' stand in A's frame as laid out, the others are turned or carried away.
  void place(HardPair<D>& pair) {
    const auto where = m_random.below(4);
    if (m_family == farFromOrigin) {
      pair.offset = number({1e2, 1e3, 1e5, 1e7});
    } else if (where == 3) {
      pair.offset = number({1e2, 1e5});
    }
    if (pair.offset > 0 || where == 2) {
      const Real far = static_cast<Real>(m_scale * pair.offset) + length();
      pair.X_WA.p = far * direction();
      pair.X_WA.q = anyRotation();
      pair.X_WB = pair.X_WA * pair.X_AB;
      pair.X_AB = pair.X_WA.inverse() * pair.X_WB;
    } else {
      pair.X_WB = pair.X_AB;
    }
    if constexpr (D == 2) {
      pair.X_AB.q = Rot<2>::angle(static_cast<double>(pair.X_AB.q.radians()));
    }
  }

  Random m_random;
  Family m_family = anywhere;
  double m_scale = 1;
  Real m_height = 0;  // shared by both shapes of `sharedPlanes`
};

// The five kinds that were there first have numbers, so that their pairs stay what they are; others go by their names.
std::uint64_t numberOf(ShapeKind a, ShapeKind b) {
  constexpr int kFirst = 5;
  if (static_cast<int>(b) < kFirst)
    return static_cast<std::uint64_t>(static_cast<int>(a) * kFirst + static_cast<int>(b));
  std::uint64_t hash = 14695981039346656037u;  // FNV-1a
  for (const std::string_view name : {shapeKindName(a), shapeKindName(b)}) {
    for (const char c : name) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211u;
    hash *= 1099511628211u;
  }
  return hash;
}

}  // namespace

std::span<const std::string_view> hardPairFamilies() { return kNames; }

template <int D>
HardPair<D> hardPair(ShapeKind a, ShapeKind b, std::uint64_t seed, int index) {
  Random stream(seed * 1000003 + numberOf(a, b) * 7919);
  stream = Random(stream.next() + static_cast<std::uint64_t>(index));
  Drawer<D> drawer(stream.next());
  // In single precision a squeezed cloud can be too flat for a hull, which the factory says: another is drawn.
  for (int attempt = 0; attempt < 8; ++attempt) {
    try {
      return drawer.draw(a, b);
    } catch (const UserError&) {
    }
  }
  return drawer.draw(a, b);  // not chance any more: let it be seen
}

template HardPair<2> hardPair(ShapeKind, ShapeKind, std::uint64_t, int);
template HardPair<3> hardPair(ShapeKind, ShapeKind, std::uint64_t, int);

}  // namespace lpc::inline LPC_PRECISION
