// SPDX-License-Identifier: Zlib
// Triangles of a simple polygon by ear clipping (Meisters 1975). An ear is a corner that turns outwards and whose
// closed triangle contains no other corner, so no triangle is without area where corners lie on a line.
#include <algorithm>
#include <cmath>
#include <limits>

#include "experiments/trial/formats/mesh_formats.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using FaceCorner = std::array<double, 2>;  // each coordinate is a float

/// Corners closer to a cut than this fraction (1) of the largest coordinate are on the cut, as long as another cut
/// remains. Larger: more cuts are tried. Smaller: corners on a line, rounded to 32 bits, give slivers.
constexpr double kOnCut = 64 * double(std::numeric_limits<float>::epsilon());

// The sign of a sum of six numbers, exactly (Shewchuk 1997, grow expansion).
int signOfSum(const std::array<double, 6>& terms) {
  std::array<double, 6> sum{};
  std::size_t n = 0;
  for (double q : terms) {
    for (std::size_t i = 0; i < n; ++i) {
      const double a = q, b = sum[i];
      q = a + b;
      const double ofB = q - a;
      sum[i] = (a - (q - ofB)) + (b - ofB);
    }
    sum[n++] = q;
  }
  while (n > 1 && sum[n - 1] == 0) --n;
  return (sum[n - 1] > 0) - (sum[n - 1] < 0);
}

/// 1 if a, b, c turn left, -1 if right, 0 on a line. Exact: a product of two floats fits into a double.
int turn(const FaceCorner& a, const FaceCorner& b, const FaceCorner& c) {
  constexpr double kRounding = 4 * std::numeric_limits<double>::epsilon();
  const double left = (b[0] - a[0]) * (c[1] - a[1]), right = (b[1] - a[1]) * (c[0] - a[0]);
  if (std::abs(left - right) > kRounding * (std::abs(left) + std::abs(right))) return left > right ? 1 : -1;
  return signOfSum({b[0] * c[1], -b[0] * a[1], -a[0] * c[1], -b[1] * c[0], b[1] * a[0], a[1] * c[0]});
}

// Along x, y or z; which one is left out keeps the winding of the axis.
FaceCorner alongAxis(const MeshCorner& p, std::size_t axis) {
  return {double(p[(axis + 1) % 3]), double(p[(axis + 2) % 3])};
}

bool onOneLine(std::span<const MeshCorner> corners, const std::vector<int>& ring) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto at = [&](int i) { return alongAxis(corners[static_cast<std::size_t>(i)], axis); };
    for (const int i : ring) {
      if (turn(at(ring[0]), at(ring[1]), at(i)) != 0) return false;
    }
  }
  return true;
}

// The axis along which the face has the largest area.
std::size_t bestAxis(std::span<const MeshCorner> corners) {
  std::array<double, 3> area{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const FaceCorner o = alongAxis(corners[0], axis);
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const FaceCorner a = alongAxis(corners[i], axis), b = alongAxis(corners[(i + 1) % corners.size()], axis);
      area[axis] += (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0]);
    }
    area[axis] = std::abs(area[axis]);
  }
  return static_cast<std::size_t>(std::max_element(area.begin(), area.end()) - area.begin());
}

bool boxesMeet(const FaceCorner& a, const FaceCorner& b, const FaceCorner& c, const FaceCorner& d) {
  for (std::size_t k = 0; k < 2; ++k) {
    if (std::max(a[k], b[k]) < std::min(c[k], d[k]) || std::max(c[k], d[k]) < std::min(a[k], b[k])) return false;
  }
  return true;
}

class FacePolygon {
 public:
  FacePolygon(std::vector<FaceCorner> at, double rounding) : m_at(std::move(at)), m_rounding(rounding) {
    const std::size_t n = m_at.size();
    const auto least = static_cast<std::size_t>(std::min_element(m_at.begin(), m_at.end()) - m_at.begin());
    m_winding = turn(m_at[(least + n - 1) % n], m_at[least], m_at[(least + 1) % n]);
  }

  void requireSimple() const {
    const std::size_t n = m_at.size();
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t k = i + 1; k < n; ++k) {
        if (!meet(i, k)) continue;
        throw UserError("a face whose sides " + std::to_string(i + 1) + " and " + std::to_string(k + 1) +
                        " cross or touch; valid: a simple polygon");
      }
    }
  }

  /// Precondition: simple.
  std::vector<std::array<int, 3>> triangles() const {
    std::vector<std::array<int, 3>> out;
    std::vector<int> ring;
    for (std::size_t i = 0; i < m_at.size(); ++i) ring.push_back(static_cast<int>(i));
    std::size_t start = 1;
    while (ring.size() >= 3) {
      std::size_t ear = findEar(ring, start, m_rounding);
      if (ear == ring.size()) ear = findEar(ring, start, 0);
      LPC_ASSERT(ear < ring.size());  // every simple polygon has two
      const std::size_t n = ring.size();
      out.push_back({ring[(ear + n - 1) % n], ring[ear], ring[(ear + 1) % n]});
      if (n == 3) break;
      ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(ear));
      start = ear % ring.size();
    }
    return out;
  }

 private:
  // Whether two sides have a point in common that is not the corner of both.
  bool meet(std::size_t i, std::size_t k) const {
    const std::size_t n = m_at.size();
    const FaceCorner &a = m_at[i], &b = m_at[(i + 1) % n], &c = m_at[k], &d = m_at[(k + 1) % n];
    if (k == i + 1) return foldsBack(a, b, d);
    if ((k + 1) % n == i) return foldsBack(c, a, b);
    if (!boxesMeet(a, b, c, d)) return false;
    return turn(a, b, c) * turn(a, b, d) <= 0 && turn(c, d, a) * turn(c, d, b) <= 0;
  }
  static bool foldsBack(const FaceCorner& a, const FaceCorner& corner, const FaceCorner& b) {
    if (turn(a, corner, b) != 0) return false;
    const std::size_t k = a[0] != corner[0] ? 0 : 1;
    return a[k] == corner[k] || b[k] == corner[k] || (a[k] > corner[k]) == (b[k] > corner[k]);
  }

  std::size_t findEar(const std::vector<int>& ring, std::size_t start, double rounding) const {
    const std::size_t n = ring.size();
    for (std::size_t i = 0; i < n; ++i) {
      if (isEar(ring, (start + i) % n, rounding)) return (start + i) % n;
    }
    return n;
  }
  bool isEar(const std::vector<int>& ring, std::size_t at, double rounding) const {
    const std::size_t n = ring.size(), before = (at + n - 1) % n, after = (at + 1) % n;
    const FaceCorner &a = point(ring[before]), &b = point(ring[at]), &c = point(ring[after]);
    if (turn(a, b, c) * m_winding <= 0) return false;
    const double length = std::hypot(c[0] - a[0], c[1] - a[1]);
    const double area = std::abs((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
    const double longest =
        std::max({length, std::hypot(b[0] - a[0], b[1] - a[1]), std::hypot(c[0] - b[0], c[1] - b[1])});
    if (area < rounding * longest) return false;
    for (std::size_t i = 0; i < n; ++i) {
      if (i == before || i == at || i == after) continue;
      const FaceCorner& p = point(ring[i]);
      if (distance(p, a, c) < rounding) return false;
      if (turn(a, b, p) * m_winding >= 0 && turn(b, c, p) * m_winding >= 0 && turn(c, a, p) * m_winding >= 0)
        return false;
    }
    return true;
  }
  static double distance(const FaceCorner& p, const FaceCorner& a, const FaceCorner& b) {
    const double x = b[0] - a[0], y = b[1] - a[1], square = x * x + y * y;
    const double along = square > 0 ? ((p[0] - a[0]) * x + (p[1] - a[1]) * y) / square : 0;
    const double share = std::clamp(along, 0.0, 1.0);
    return std::hypot(p[0] - a[0] - share * x, p[1] - a[1] - share * y);
  }
  const FaceCorner& point(int i) const { return m_at[static_cast<std::size_t>(i)]; }

  std::vector<FaceCorner> m_at;
  double m_rounding;  // m
  int m_winding = 0;  // 1: counter-clockwise
};

}  // namespace

std::vector<std::array<int, 3>> trianglesOf(std::span<const MeshCorner> corners) {
  if (corners.size() == 3) return {{0, 1, 2}};
  std::vector<int> ring;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (corners[i] != corners[(i + corners.size() - 1) % corners.size()]) ring.push_back(static_cast<int>(i));
  }
  std::vector<std::array<int, 3>> out;
  if (ring.size() < 3 || onOneLine(corners, ring)) {
    for (int i = 1; i + 1 < static_cast<int>(corners.size()); ++i) out.push_back({0, i, i + 1});
    return out;
  }
  const std::size_t axis = bestAxis(corners);
  std::vector<FaceCorner> flat;
  double largest = 0;
  for (const int i : ring) {
    const MeshCorner& p = corners[static_cast<std::size_t>(i)];
    flat.push_back(alongAxis(p, axis));
    for (const float x : p) largest = std::max(largest, std::abs(double(x)));
  }
  const FacePolygon polygon(std::move(flat), kOnCut * largest);
  polygon.requireSimple();
  for (const std::array<int, 3>& t : polygon.triangles()) {
    out.push_back({ring[static_cast<std::size_t>(t[0])], ring[static_cast<std::size_t>(t[1])],
                   ring[static_cast<std::size_t>(t[2])]});
  }
  return out;
}

}}  // namespace lpc::LPC_PRECISION
