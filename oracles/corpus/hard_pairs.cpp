// SPDX-License-Identifier: Zlib
#include "oracles/corpus/hard_pairs.h"

#include <algorithm>
#include <array>
#include <limits>

#include "framework/math/check.h"
#include "framework/math/random.h"
#include "framework/shape/curved_core.h"
#include "framework/shape/support_map.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

template <int D>
class Drawer;

/// A family of pairs: its kinds of shapes, its placement of B relative to A, and its distance from a plane. `random` is
/// the first.
template <int D>
struct PairFamily {
  std::string_view name;
  /// Sets X_AB. n: a direction, often along matching features; size: the sum of both radii; smaller: the smaller radius
  /// (m).
  void (Drawer<D>::*layOut)(HardPair<D>&, const Vec<D>& n, Real size, Real smaller);
  /// The gap between a shape of this size and a plane, as the family has between two shapes (m).
  Real (Drawer<D>::*gap)(Real size);
  bool tilted = false;    // on a plane: oriented as a body lies on the floor, not at random
  bool level = false;     // both shapes are between the same two planes
  bool equal = false;     // equal sizes, and sometimes equal shapes
  bool unlike = false;    // one is up to 10,000 times as large as the other
  bool thin = false;      // one, sometimes both, a ten-thousandth as thick as long
  bool roundedB = false;  // B is rounded
  bool nasty = false;     // hulls on which algorithms have failed; needs a polytope
  bool far = false;       // up to 1e7 sizes from the world's origin
};

constexpr double kQuarterTurn = 1.57079632679489661923;

Rot<2> turn(const Ang<2>& v) { return Rot<2>::angle(v[0]); }
Rot<3> turn(const Ang<3>& v) { return Rot<3>::vector(v); }

template <int D>
class Drawer {  // no expression draws twice: the compiler would choose the order
 public:
  explicit Drawer(std::uint64_t seed) : m_random(seed) {}

  HardPair<D> draw(ShapeKind kindA, ShapeKind kindB);

  // --- gaps to a plane -----------------------------------------------------------------------------------------------
  Real gapOfRounding(Real size) {
    return size * std::numeric_limits<Real>::epsilon() * pick({0, 1, -1, 2, -2, 3, -3, 4, -4});
  }
  Real tinyGap(Real size) { return size * pick({1e-4, -1e-4, 1e-6, -1e-6, 1e-8, -1e-8, 1e-9, -1e-9, 1e-12, -1e-12}); }
  Real wholeDepth(Real size) { return -size * pick({1, 0.5, 0}); }
  Real anyGap(Real size) { return size * uniform(-1.5, 1.5); }

  // --- layouts -------------------------------------------------------------------------------------------------------
  void faceOnFace(HardPair<D>& pair, const Vec<D>&, Real size, Real smaller) {
    lay(pair, gapOfRounding(size), smaller);
  }
  void almostParallel(HardPair<D>& pair, const Vec<D>&, Real, Real smaller) {
    const double angle = number({0, 1e-15, 1e-12, 1e-9, 1e-6, 1e-3});
    Ang<D> v;
    for (int k = 0; k < kAngDim<D>; ++k) v[k] = static_cast<Real>(angle * number({1, 0, -1}));
    pair.X_AB.q = turn(v);
    lay(pair, smaller * uniform(-0.3, 0.2), smaller);
  }
  void besideEachOther(HardPair<D>& pair, const Vec<D>&, Real size, Real) {
    for (int k = 0; k < D - 1; ++k) pair.X_AB.p[k] = coin() ? uniform(-1, 1) * size / 2 : Real(0);
  }
  void byQuarters(HardPair<D>& pair, const Vec<D>& n, Real, Real smaller) {
    if (coin()) {
      Ang<D> v = Ang<D>::Zero();
      v[static_cast<int>(m_random.below(kAngDim<D>))] = static_cast<Real>(kQuarterTurn * number({0, 0.5, 1}));
      pair.X_AB.q = turn(v);
    }
    if (coin()) touch(pair, n, -smaller * pick({0, 0.1, 0.5}));
  }
  void aroundTouching(HardPair<D>& pair, const Vec<D>& n, Real size, Real smaller) {
    if (coin()) {
      lay(pair, smaller * uniform(-0.5, 0.5), size);
      return;
    }
    pair.X_AB.q = anyRotation();
    touch(pair, n, smaller * uniform(-0.5, 0.5));
  }
  void throughEachOther(HardPair<D>& pair, const Vec<D>& n, Real, Real smaller) {
    pair.X_AB.q = anyRotation();
    if (coin()) {  // an inner point of A coincides with one of B
      const Vec<D> a = uniform(0, 1) * coreSupport(pair.a.view(), n);
      const Vec<D> far = coreSupport(pair.b.view(), telling());
      const Vec<D> b = uniform(0, 1) * far;
      pair.X_AB.p = a - pair.X_AB.q * b;
    } else {
      const Real most = smaller * pick({0.1, 1e-4, 1e-5});
      touch(pair, n, most * uniform(-1, 1));
    }
  }
  void originOnCore(HardPair<D>& pair, const Vec<D>& n, Real, Real) {
    if (coin()) pair.X_AB.q = anyRotation();
    pair.X_AB.p = pick({0, 0.5, 1}) * coreSupport(pair.a.view(), n);
  }
  void barelyTouching(HardPair<D>& pair, const Vec<D>& n, Real, Real smaller) {
    pair.X_AB.q = anyRotation();
    touch(pair, n, smaller * pick({0, 1e-8, -1e-8, 1e-4, -1e-4}));
  }
  void withinTolerances(HardPair<D>& pair, const Vec<D>& n, Real size, Real) {
    if (coin()) pair.X_AB.q = anyRotation();
    touch(pair, n, size * pick({1e-6, -1e-6, 1e-7, -1e-7, 1e-8, -1e-8, 1e-9, -1e-9, 1e-12, -1e-12}));
  }
  void anyhow(HardPair<D>& pair, const Vec<D>&, Real size, Real smaller) { scatter(pair, size, smaller); }

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
  // Often a direction along which features of equal rank meet.
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
    if (m_family->equal && coin()) h.setConstant(Real(h[0]));
    if (m_family->level) h[D - 1] = m_height;
    return h;
  }

  Shape<D> shape(ShapeKind kind, double ratio, bool first, std::vector<Vec<D>>& points) {
    const Real large = static_cast<Real>(ratio);
    const int thinAxis = axis();
    const Real thin = m_family->thin && (first || coin()) ? Real(1e-4) : Real(1);
    bool rounded = m_random.below(4) == 0 && !m_family->level;
    if (m_family->roundedB && !first) rounded = true;
    const Real rounding = rounded ? thin * large * length() / 4 : Real(0);
    switch (coreClass(kind)) {
      case CoreClass::point:
        return Shape<D>::sphere(large * (m_family->level ? m_height : length()));
      case CoreClass::segment: {
        if (kind == ShapeKind::segment) return Shape<D>::segment(large * length());
        const Real radius = m_family->level ? m_height : length() / 2;
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
        if (m_family->equal && coin()) sizes.assign(sizes.size(), Real(sizes[0]));
        if (m_family->level) sizes[0] = m_height;
        sizes[static_cast<std::size_t>(thinAxis) % sizes.size()] *= thin;
        return Shape<D>::curved(kind, sizes, rounding);
      }
      case CoreClass::plane:
        return Shape<D>::plane();
      case CoreClass::hull:
        break;
    }
    const bool flat = kind == ShapeKind::triangle;
    points = flat ? corners() : m_family->level ? prism() : m_family->nasty ? nasty() : cloud();
    for (Vec<D>& p : points) p *= large, p[thinAxis] *= thin;
    return Shape<D>::ofCorners(kind, points, rounding);
  }

  // Corners of a triangle: often in a plane across an axis, with two edges along the other axes.
  std::vector<Vec<D>> corners() {
    const Vec<D> h = half();
    const bool anyhow = coin();
    const int k = axis();
    std::vector<Vec<D>> points;
    for (int i = 0; i < 3; ++i) {
      points.push_back(anyhow ? Vec<D>(h.cwiseProduct(direction())) : Vec<D>(-h));
      if (i > 0 && !anyhow) points.back()[(k + i) % D] = 2 * h[(k + i) % D];
    }
    return points;
  }

  // A simplex, so that there is volume, and up to twelve more points.
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

  // Point sets on which hull algorithms and their users have failed.
  std::vector<Vec<D>> nasty() {
    std::vector<Vec<D>> points = cloud();
    const Vec<D> h = half();
    switch (m_random.below(4)) {
      case 0:  // duplicate and nearly duplicate points, and midpoints of edges and faces
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

  // Places B so that its lowest point along n is `gap` above A's highest: the distance is gap when gap >= 0.
  void touch(HardPair<D>& pair, const Vec<D>& n, Real gap) {
    const ShapeView<D>&a = pair.a.view(), &b = pair.b.view();
    const Vec<D> top = coreSupport(a, n) + a.radius * n;
    const Vec<D> bottom = pair.X_AB.q * coreSupport(b, Vec<D>(pair.X_AB.q.inverse() * Vec<D>(-n))) - b.radius * n;
    pair.X_AB.p = top - bottom + gap * n;
  }
  // The same along a coordinate axis, with B at a random position across it: face on face, not corner on corner.
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

  // Either as a body lies on the floor, slightly tilted or rotated by quarter turns, or at random.
  void layOnPlane(HardPair<D>& pair) {
    const bool planeA = pair.a.view().core() == CoreClass::plane;
    const ShapeView<D>& body = (planeA ? pair.b : pair.a).view();
    const Real size = boundingRadius(body), gap = (this->*m_family->gap)(size);
    Pose<D> X_PB;  // the body in the plane's frame
    Ang<D> v;
    const double angle = number({0, 1e-15, 1e-12, 1e-9, 1e-6, 1e-3}), quarter = kQuarterTurn * number({0, 0.5, 1, 2});
    for (int k = 0; k < kAngDim<D>; ++k) v[k] = static_cast<Real>(angle * number({1, 0, -1}));
    v[kAngDim<D> - 1] += static_cast<Real>(quarter);  // about z: from lying to standing
    X_PB.q = m_family->tilted ? turn(v) : anyRotation();
    for (int k = 0; k < D; ++k) X_PB.p[k] = size * uniform(-1, 1);
    const Vec<D> down = X_PB.q.inverse() * Vec<D>(-Vec<D>::Unit(1));
    X_PB.p[1] = gap + coreSupport(body, down).dot(down) + body.radius;
    pair.X_AB = planeA ? X_PB : X_PB.inverse();
  }

  // Sets X_AB before rounding.
  void layOut(HardPair<D>& pair) {
    const Real ra = boundingRadius(pair.a.view()), rb = boundingRadius(pair.b.view());
    const Vec<D> n = telling();
    (this->*m_family->layOut)(pair, n, ra + rb, std::min(ra, rb));
  }

  // Places the pair in the world: half of the families' pairs stay in A's frame, the others are rotated or moved away.
  void place(HardPair<D>& pair) {
    const auto where = m_random.below(4);
    if (m_family->far) {
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
      pair.X_AB.q = Rot<2>::angle(static_cast<double>(turnOf(pair.X_AB.q)[0]));
    }
  }

  // As in a world: hulls far from their frames are moved to their middles.
  static void centre(HardPair<D>& pair) {
    const auto points = [](const Shape<D>& shape, std::vector<Vec<D>>& of, const Vec<D>& middle) {
      of = shape.view().hull->vertices;
      for (Vec<D>& p : of) p -= middle;
    };
    const ShapePart<D> a = centredPart<D>({pair.a, {}}), b = centredPart<D>({pair.b, {}});
    if (!b.X_SP.p.isZero(0)) {
      points(pair.b, pair.pointsB, b.X_SP.p);
      pair.X_WB = pair.X_WB * b.X_SP, pair.X_AB = pair.X_AB * b.X_SP, pair.b = b.shape;
    }
    if (!a.X_SP.p.isZero(0)) {
      points(pair.a, pair.pointsA, a.X_SP.p);
      pair.X_WA = pair.X_WA * a.X_SP, pair.X_AB.p -= a.X_SP.p, pair.a = a.shape;
    }
  }

  Random m_random;
  const PairFamily<D>* m_family = nullptr;
  double m_scale = 1;
  Real m_height = 0;  // of both shapes of a `level` family
};

template <int D>
constexpr std::array<PairFamily<D>, 12> kPairFamilies = {{
    {.name = "random", .layOut = &Drawer<D>::anyhow, .gap = &Drawer<D>::anyGap},
    {.name = "kissing_faces", .layOut = &Drawer<D>::faceOnFace, .gap = &Drawer<D>::gapOfRounding, .tilted = true},
    {.name = "near_parallel", .layOut = &Drawer<D>::almostParallel, .gap = &Drawer<D>::anyGap, .tilted = true},
    {.name = "shared_planes",
     .layOut = &Drawer<D>::besideEachOther,
     .gap = &Drawer<D>::gapOfRounding,
     .tilted = true,
     .level = true},
    {.name = "ties", .layOut = &Drawer<D>::byQuarters, .gap = &Drawer<D>::anyGap, .tilted = true, .equal = true},
    {.name = "size_ratio", .layOut = &Drawer<D>::aroundTouching, .gap = &Drawer<D>::anyGap, .unlike = true},
    {.name = "slivers", .layOut = &Drawer<D>::throughEachOther, .gap = &Drawer<D>::anyGap, .thin = true},
    {.name = "far_from_origin", .layOut = &Drawer<D>::anyhow, .gap = &Drawer<D>::anyGap, .far = true},
    {.name = "core_contact", .layOut = &Drawer<D>::originOnCore, .gap = &Drawer<D>::wholeDepth},
    {.name = "curved_on_edge", .layOut = &Drawer<D>::barelyTouching, .gap = &Drawer<D>::tinyGap, .roundedB = true},
    {.name = "below_tolerance", .layOut = &Drawer<D>::withinTolerances, .gap = &Drawer<D>::tinyGap},
    {.name = "nasty_hulls", .layOut = &Drawer<D>::anyhow, .gap = &Drawer<D>::anyGap, .nasty = true},
}};

template <int D>
HardPair<D> Drawer<D>::draw(ShapeKind kindA, ShapeKind kindB) {
  const bool polytope = kindA == ShapeKind::polytope || kindB == ShapeKind::polytope;
  const std::size_t drawn = 1 + m_random.below(16);  // a third selects no family and becomes `random`
  m_family = &kPairFamilies<D>[drawn < kPairFamilies<D>.size() ? drawn : 0];
  if (m_family->nasty && !polytope) --m_family;  // the family before it: below_tolerance
  m_scale = number({1e-3, 1, 1e3});
  m_height = length();
  const bool largeA = coin();
  const double ratio = m_family->unlike ? number({1e2, 1e3, 1e4}) : 1;
  std::vector<Vec<D>> pointsA, pointsB;
  HardPair<D> pair{.a = shape(kindA, largeA ? ratio : 1, true, pointsA),
                   .b = shape(kindB, largeA ? 1 : ratio, false, pointsB),
                   .family = m_family->name,
                   .scale = m_scale};
  if (m_family->equal && kindA == kindB && coin()) pair.b = pair.a, pointsB = pointsA;
  pair.pointsA = std::move(pointsA), pair.pointsB = std::move(pointsB);
  const bool plane = coreClass(kindA) == CoreClass::plane || coreClass(kindB) == CoreClass::plane;
  plane ? layOnPlane(pair) : layOut(pair);
  place(pair);
  centre(pair);
  return pair;
}

// The first five kinds are numbered, so that their pairs stay the same; other kinds are hashed by name.
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

std::span<const std::string_view> hardPairFamilies() {
  static const auto names = [] {
    std::array<std::string_view, kPairFamilies<3>.size()> out;
    std::transform(kPairFamilies<3>.begin(), kPairFamilies<3>.end(), out.begin(), [](const auto& f) { return f.name; });
    return out;
  }();
  return names;
}

template <int D>
HardPair<D> hardPair(ShapeKind a, ShapeKind b, std::uint64_t seed, int index) {
  Random stream(seed * 1000003 + numberOf(a, b) * 7919);
  stream = Random(stream.next() + static_cast<std::uint64_t>(index));
  Drawer<D> drawer(stream.next());
  // In single precision a flattened point cloud may be too flat for a hull, and the factory throws: draw again.
  for (int attempt = 0; attempt < 8; ++attempt) {
    try {
      return drawer.draw(a, b);
    } catch (const UserError&) {
    }
  }
  return drawer.draw(a, b);  // not by chance any more: let the exception escape
}

template HardPair<2> hardPair(ShapeKind, ShapeKind, std::uint64_t, int);
template HardPair<3> hardPair(ShapeKind, ShapeKind, std::uint64_t, int);

}}  // namespace lpc::LPC_PRECISION
