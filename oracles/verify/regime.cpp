// SPDX-License-Identifier: Zlib
#include "oracles/verify/regime.h"

#include <algorithm>
#include <array>
#include <limits>

#include "framework/shape/support_map.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

template <int D>
Vecd<3> direction3(const Vec<D>& v) {
  Vecd<3> out = Vecd<3>::Zero();
  for (int k = 0; k < D; ++k) out[k] = static_cast<double>(v[k]);
  return out;
}

// Longest and shortest side of the shape's own box (m). Against a plane both are the other shape's.
template <int D>
Vecd<2> sides(const ShapeView<D>& shape, const ShapeView<D>& other) {
  if (shape.core() == CoreClass::plane) return sides(other, other);
  const Aabb<D> box = boundingBox(shape, Pose<D>{});
  const Vec<D> extent = box.hi - box.lo;
  return {static_cast<double>(extent.maxCoeff()), static_cast<double>(extent.minCoeff())};
}

bool isAcross(const Vecd<2>& n, const Vecd<2>& m) { return std::abs(n[0] * m[1] - n[1] * m[0]) < 1e-3; }
bool isAcross(const Vecd<3>& n, const Vecd<3>& m) { return n.cross(m).norm() < 1e-3; }

bool polytopeFacesAlong(const Polytope<2>& hull, const Vecd<2>& n) {
  return std::any_of(hull.normals.begin(), hull.normals.end(), [&](const Vec<2>& m) {
    const Vecd<2> normal = m.cast<double>();
    return normal.dot(n) > 0 && isAcross(normal, n);
  });
}
bool polytopeFacesAlong(const Polytope<3>& hull, const Vecd<3>& n) {
  return std::any_of(hull.faces.begin(), hull.faces.end(), [&](const auto& face) {
    const Vecd<3> normal = face.normal.template cast<double>();
    return normal.dot(n) > 0 && isAcross(normal, n);
  });
}

// True when a face (2D: edge) of the shape's core has the normal n (in the shape's frame).
template <int D>
bool facesAlong(const ShapeView<D>& shape, const Vecd<D>& n) {
  switch (shape.core()) {
    case CoreClass::point:
      return false;
    case CoreClass::segment:
      return D == 2 && isAcross(n, Vecd<D>::Unit(1));
    case CoreClass::box:
      for (int k = 0; k < D; ++k) {
        if (isAcross(n, Vecd<D>::Unit(k))) return true;
      }
      return false;
    case CoreClass::hull:
      return polytopeFacesAlong(*shape.hull, n);
    case CoreClass::curved: {
      std::vector<Vec<D>> corners;
      shape.curved->supportFace(n.template cast<Real>(), corners);
      if (corners.size() <= 2) return D == 2 && corners.size() == 2;
      const Vecd<3> e = direction3<D>(corners[1] - corners[0]), f = direction3<D>(corners[2] - corners[0]);
      return D == 3 && isAcross(Vecd<3>(e.cross(f).normalized()), direction3<D>(n.template cast<Real>()));
    }
    case CoreClass::plane:
      return true;
  }
  return false;
}

// Width along n (m).
template <int D>
double width(const ShapeView<D>& shape, const Vecd<D>& n) {
  if (shape.core() == CoreClass::plane) return std::numeric_limits<double>::infinity();
  const Vec<D> d = n.template cast<Real>();
  return static_cast<double>(supportValue(shape, d)) + static_cast<double>(supportValue(shape, Vec<D>(-d)));
}

// Input of the regimes' conditions.
template <int D>
struct Facts {
  const ShapeView<D>&a, &b;
  Vecd<2> sidesA, sidesB;
  double smaller, larger;  // the smaller and larger of the two longest sides (m)
  Vecd<D> nA, nB;          // the referee's normal, in each shape's frame
  double phi;              // separation (m)
};

template <int D>
bool isThin(const ShapeView<D>& s, const Vecd<2>& side) {
  return s.kind != ShapeKind::segment && side[1] < 1e-3 * side[0];
}

template <int D>
struct Regime {
  std::string_view name;
  bool (*holds)(const Facts<D>&);
};
// The first true condition applies; the last is always true.
template <int D>
constexpr std::array<Regime<D>, 8> kRegimes = {{
    {"huge_ratio", [](const Facts<D>& f) { return f.larger >= 100 * f.smaller; }},
    {"thin", [](const Facts<D>& f) { return isThin(f.a, f.sidesA) || isThin(f.b, f.sidesB); }},
    {"touching", [](const Facts<D>& f) { return std::abs(f.phi) < 1e-6 * f.smaller; }},
    {"parallel_faces", [](const Facts<D>& f) { return facesAlong<D>(f.a, f.nA) && facesAlong<D>(f.b, -f.nB); }},
    {"separated", [](const Facts<D>& f) { return f.phi > 0; }},
    // Along n, A ends at its support value and B begins at A's end + phi: comparing the far ends shows containment.
    {"contained", [](const Facts<D>& f) { return -f.phi >= std::min(width<D>(f.a, f.nA), width<D>(f.b, f.nB)); }},
    {"shallow", [](const Facts<D>& f) { return -f.phi <= 0.1 * f.smaller; }},
    {"deep", [](const Facts<D>&) { return true; }},
}};
constexpr std::string_view kUndecided = "undecided";

}  // namespace

std::span<const std::string_view> regimeNames() {
  static const auto names = [] {
    std::array<std::string_view, kRegimes<3>.size() + 1> out;
    std::transform(kRegimes<3>.begin(), kRegimes<3>.end(), out.begin(), [](const auto& r) { return r.name; });
    out.back() = kUndecided;
    return out;
  }();
  return names;
}

template <int D>
std::string_view regimeOf(const HardPair<D>& pair, const RefereeAnswer<D>& truth) {
  if (!truth.decided) return kUndecided;
  const ShapeView<D>&a = pair.a.view(), &b = pair.b.view();
  const Vecd<2> sidesA = sides(a, b), sidesB = sides(b, a);
  const auto ratio = std::minmax(sidesA[0], sidesB[0]);
  const Vecd<D> n = truth.normal, nB = pair.X_AB.q.matrix().template cast<double>().transpose() * n;
  const Facts<D> facts{a, b, sidesA, sidesB, ratio.first, ratio.second, n, nB, truth.interval().middle()};
  const auto holds = [&](const Regime<D>& r) { return r.holds(facts); };
  return std::find_if(kRegimes<D>.begin(), kRegimes<D>.end(), holds)->name;
}

template std::string_view regimeOf(const HardPair<2>&, const RefereeAnswer<2>&);
template std::string_view regimeOf(const HardPair<3>&, const RefereeAnswer<3>&);

}}  // namespace lpc::LPC_PRECISION
