// SPDX-License-Identifier: Zlib
// Reads two shapes and a pose from the bytes and passes them to every pair query of LPC. Invalid shapes are rejected by
// the shape's own checks. If sizes and positions lie within eight orders of magnitude, the answer is checked; otherwise
// the query must only return.
#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include "framework/shape/curved_core.h"
#include "tests/fuzz/pair_fault.h"
#include "tests/fuzz/target.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

// Returns zeros after the end of the bytes.
class Reader {
 public:
  explicit Reader(std::string_view bytes) : m_bytes(bytes) {}
  unsigned byte() {
    if (m_at == m_bytes.size()) return 0;
    return static_cast<unsigned char>(m_bytes[m_at++]);
  }
  // Uses few bytes, so that two shapes are often equal, parallel or just touching.
  Real number() {
    constexpr std::array<double, 16> kUnit = {0,  1,   0.5, 1e-4, 1e-3, 1e-2,   0.1,  1,
                                              10, 100, 1e3, 1e4,  1e-9, 1e-300, 1e12, 1e300};
    const unsigned head = byte();
    const double unit = kUnit[head & 15];
    const double value = (head & 16 ? byte() / 128.0 : 1) * (head & 32 ? 1 + byte() * 0x1p-52 : 1) * unit;
    m_ordinary = m_ordinary && (value == 0 || (value >= 1e-4 && value <= 1e4));
    return static_cast<Real>(head & 64 ? -value : value);
  }
  Real size() { return std::abs(number()); }
  template <int D>
  Vec<D> vector() {
    Vec<D> v;
    for (int k = 0; k < D; ++k) v[k] = number();
    return v;
  }
  bool ordinary() const { return m_ordinary; }

 private:
  std::string_view m_bytes;
  std::size_t m_at = 0;
  bool m_ordinary = true;
};

Rot<2> rotation(Reader& r, Vec<2>) { return Rot<2>::angle(r.number()); }
Rot<3> rotation(Reader& r, Vec<3>) {
  const Real w = r.number();
  const Vec<3> v = r.vector<3>();
  const Real norm = std::sqrt(w * w + v.squaredNorm());
  if (!(norm > 0) || !std::isfinite(norm)) return {};
  return Rot<3>{w / norm, v[0] / norm, v[1] / norm, v[2] / norm};
}

template <int D>
Shape<D> shape(Reader& r) {
  const auto kind = static_cast<ShapeKind>(r.byte() % kShapeKinds);
  switch (coreClass(kind)) {
    case CoreClass::point:
      return Shape<D>::sphere(r.size());
    case CoreClass::segment: {
      const Real half = r.size();
      return kind == ShapeKind::segment ? Shape<D>::segment(half) : Shape<D>::capsule(half, r.size());
    }
    case CoreClass::box: {
      Vec<D> half;
      for (int k = 0; k < D; ++k) half[k] = r.size();
      return Shape<D>::box(half, r.size());
    }
    case CoreClass::hull: {
      std::vector<Vec<D>> points(kind == ShapeKind::triangle ? 3 : D + 1 + r.byte() % 8);
      for (Vec<D>& p : points) p = r.vector<D>();
      return Shape<D>::ofCorners(kind, points, r.size());
    }
    case CoreClass::curved: {
      std::vector<Real> sizes(curvedKind<D>(kind).sizes.size());
      for (Real& s : sizes) s = r.size();
      return Shape<D>::curved(kind, sizes, r.size());
    }
    case CoreClass::plane:
      break;
  }
  return Shape<D>::plane();
}

template <int D>
const std::vector<std::unique_ptr<PairQuery<D>>>& competitors() {
  static const auto all = [] {
    std::vector<std::unique_ptr<PairQuery<D>>> out;
    for (const Registered* method : Registry::instance().list(StageKind::pairQuery, D)) {
      if (method->info.role != AlgorithmRole::competitor) continue;
      out.push_back(createStage<PairQuery<D>>(Spec{method->info.name, {}}));
    }
    return out;
  }();
  return all;
}

template <int D>
void ask(Reader& r) {
  const Shape<D> a = shape<D>(r), b = shape<D>(r);
  if (a.isPlane() && b.isPlane()) return;
  Pose<D> X_AB;
  X_AB.q = rotation(r, Vec<D>{});
  X_AB.p = r.vector<D>();
  for (const auto& method : competitors<D>()) {
    const PairAnswer<D> answer = queryPair(*method, a.view(), b.view(), X_AB);
    if (answer.status == QueryStatus::refused || !r.ordinary()) continue;
    const char* fault = faultOf<D>(a.view(), b.view(), X_AB, answer);
    demand(!fault, fault);
  }
}

}  // namespace

void fuzz(std::string_view bytes) {
  Reader r(bytes);
  try {
    r.byte() % 2 ? ask<3>(r) : ask<2>(r);
  } catch (const UserError&) {
  }
}

}}  // namespace lpc::LPC_PRECISION
