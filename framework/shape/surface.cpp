// SPDX-License-Identifier: Zlib
#include "framework/shape/surface.h"

#include <algorithm>
#include <string>
#include <type_traits>

#include "framework/shape/shape_tolerances.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

template <int D>
const char* kPartName = D == 2 ? "segment" : "triangle";

template <int D>
void checkCorners(IndexedSpan<const Vec<D>> points, std::span<const std::array<int, D>> parts,
                  const std::string& subject) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!points[i].allFinite()) throw UserError(subject + ": point " + std::to_string(i) + " is not finite");
  }
  if (parts.empty()) throw UserError(subject + ": no " + kPartName<D> + "s; valid: one or more");
  if (parts.size() > kMostTriangles) {
    throw UserError(subject + ": it has " + std::to_string(parts.size()) + " " + kPartName<D> + "s; valid: up to " +
                    std::to_string(kMostTriangles));
  }
  for (std::size_t i = 0; i < parts.size(); ++i) {
    for (const int v : parts[i]) {
      if (v >= 0 && static_cast<std::size_t>(v) < points.size()) continue;
      throw UserError(subject + ", " + kPartName<D> + " " + std::to_string(i) + ": unknown point " + std::to_string(v) +
                      "; valid: 0 to " + std::to_string(std::int64_t(points.size()) - 1));
    }
  }
}

// Places a part at its own middle, so that sizes and roundings near it are its own, not those of the whole surface.
PlacedView<3> placeTriangle(const std::array<Vec<3>, 3>& p, const std::string& subject,
                            std::vector<std::shared_ptr<const Polytope<3>>>& hulls) {
  flatTriangle(p, subject);  // checks that the corners are distinct at their position in the surface
  const Eigen::Vector3d middle = (p[0].cast<double>() + p[1].cast<double>() + p[2].cast<double>()) / 3;
  PlacedView<3> part;
  part.X_SP.p = middle.cast<Real>();
  std::array<Vec<3>, 3> around;
  for (std::size_t k = 0; k < 3; ++k) around[k] = (p[k].cast<double>() - part.X_SP.p.cast<double>()).cast<Real>();
  hulls.push_back(flatTriangle(around, subject));
  part.view.kind = ShapeKind::triangle, part.view.hull = hulls.back().get();
  for (const Vec<3>& v : around) part.view.half = part.view.half.cwiseMax(v.cwiseAbs()).eval();
  return part;
}

PlacedView<2> placeSegment(const std::array<Vec<2>, 2>& p, const std::string& subject) {
  const Eigen::Vector2d along = p[1].cast<double>() - p[0].cast<double>();
  const double length = along.norm(), largest = std::max(p[0].cwiseAbs().maxCoeff(), p[1].cwiseAbs().maxCoeff());
  if (!(length > kHullRounding * largest && length > 1 / kLargestExtent && length < 2 * kLargestExtent)) {
    throw UserError(subject + ": it is " + std::to_string(length) +
                    " m long; valid: two ends that differ by more than rounding, at a finite distance");
  }
  PlacedView<2> part;
  part.view.kind = ShapeKind::segment, part.view.half[0] = static_cast<Real>(length / 2);
  part.X_SP.p = ((p[0].cast<double>() + p[1].cast<double>()) / 2).cast<Real>();
  part.X_SP.q = {static_cast<Real>(along[0] / length), static_cast<Real>(along[1] / length)};
  return part;
}

}  // namespace

template <int D>
Surface<D>::Surface(IndexedSpan<const Vec<D>> points, std::span<const std::array<int, D>> parts, std::string_view name)
    : m_points(points.begin(), points.end()),
      m_corners(parts.begin(), parts.end()),
      m_parts([&] {
        const std::string subject(name);
        checkCorners<D>(points, parts, subject);
        std::vector<PlacedView<D>> placed;
        placed.reserve(parts.size());
        for (std::size_t i = 0; i < parts.size(); ++i) {
          IndexedArray<Vec<D>, D> p;
          for (std::size_t k = 0; k < D; ++k) p[k] = points[parts[i][k]];
          const std::string which = subject + ", " + kPartName<D> + " " + std::to_string(i);
          if constexpr (D == 3) {
            placed.push_back(placeTriangle(p, which, m_hulls));
          } else {
            placed.push_back(placeSegment(p, which));
          }
        }
        return placed;
      }()),
      m_tree(boxesOf(m_parts)) {
  for (const PlacedView<D>& part : m_parts) {
    if constexpr (D == 3) {
      m_normals.push_back(part.view.hull->faces[0].normal);
    } else {
      m_normals.push_back(part.X_SP.q * Vec<2>(0, -1));
    }
    m_box = m_box.merged(boundingBox(part.view, part.X_SP));
    m_reach = std::max(m_reach, part.X_SP.p.norm() + boundingRadius(part.view));
  }
  findNeighbours(name);
}

template <int D>
std::vector<Aabb<D>> Surface<D>::boxesOf(std::span<const PlacedView<D>> parts) {
  std::vector<Aabb<D>> boxes;
  boxes.reserve(parts.size());
  for (const PlacedView<D>& part : parts) boxes.push_back(boundingBox(part.view, part.X_SP));
  return boxes;
}

template <>
void Surface<2>::findNeighbours(std::string_view) {
  const auto n = static_cast<std::int32_t>(m_parts.size());
  const bool closed = m_corners.back()[1] == m_corners[0][0];
  for (std::int32_t i = 0; i < n; ++i) {
    m_neighbours.push_back({i > 0 ? i - 1 : closed ? n - 1 : -1, i + 1 < n ? i + 1 : closed ? 0 : -1});
  }
}

template <>
void Surface<3>::findNeighbours(std::string_view subject) {
  struct Side {
    int low, high;  // point indices
    std::int32_t part;
    int number;
    bool rising;  // goes from low to high
    bool operator<(const Side& o) const {
      return std::tie(low, high, part, number) < std::tie(o.low, o.high, o.part, o.number);
    }
  };
  std::vector<Side> sides;
  sides.reserve(3 * m_corners.size());
  for (std::size_t i = 0; i < m_corners.size(); ++i) {
    const int* const corner = m_corners[i].data();
    for (int k = 0; k < 3; ++k) {
      const int a = corner[k], b = corner[(k + 1) % 3];
      sides.push_back({std::min(a, b), std::max(a, b), static_cast<std::int32_t>(i), k, a < b});
    }
  }
  std::sort(sides.begin(), sides.end());
  m_neighbours.assign(m_corners.size(), {-1, -1, -1});
  for (std::size_t i = 0, next = 0; i < sides.size(); i = next) {
    while (next < sides.size() && sides[next].low == sides[i].low && sides[next].high == sides[i].high) ++next;
    if (next == i + 1) continue;
    const std::string edge = std::string(subject) + ", the edge of points " + std::to_string(sides[i].low) + " and " +
                             std::to_string(sides[i].high) + ": ";
    if (next > i + 2) {
      throw UserError(edge + "belongs to " + std::to_string(next - i) + " triangles; valid: one or two");
    }
    const Side &a = sides[i], &b = sides[i + 1];
    if (a.rising == b.rising) {
      throw UserError(edge + "triangles " + std::to_string(a.part) + " and " + std::to_string(b.part) +
                      " are wound oppositely; valid: both counter-clockwise seen from outside");
    }
    m_neighbours[a.part][a.number] = b.part;
    m_neighbours[b.part][b.number] = a.part;
  }
}

template <int D>
typename Surface<D>::Border Surface<D>::border(std::int32_t part, int number) const {
  const PlacedView<D>& p = m_parts[part];
  Border out;
  out.neighbour = m_neighbours[part][number];
  if constexpr (D == 3) {
    out.outward = p.view.hull->faces[2 + number].normal;
    out.at = p.X_SP.p + p.view.hull->vertices[number];
  } else {
    out.outward = p.X_SP.q * Vec<2>(number ? 1 : -1, 0);
    out.at = p.X_SP.p + p.view.half[0] * out.outward;
  }
  return out;
}

template <int D>
Shape<D> Shape<D>::mesh(std::span<const Vec<D>> points, std::span<const std::array<int, 3>> triangles) {
  if constexpr (D == 2) {
    throw UserError("mesh: 3D only; valid in 2D: chain");
  } else {
    Shape s;
    s.m_surface = std::make_shared<const Surface<3>>(points, triangles, "mesh");
    return std::move(s).measured();
  }
}

template <int D>
Shape<D> Shape<D>::chain(std::span<const Vec<D>> points, bool closed) {
  if constexpr (D == 3) {
    throw UserError("chain: 2D only; valid in 3D: mesh");
  } else {
    if (points.size() < (closed ? 3u : 2u)) {
      throw UserError("chain: " + std::to_string(points.size()) +
                      " points given; valid: two or more, for a closed chain three or more");
    }
    const int n = static_cast<int>(std::min(points.size(), kMostTriangles + 2));
    std::vector<std::array<int, 2>> segments;
    for (int i = 0; i + 1 < n; ++i) segments.push_back({i, i + 1});
    if (closed) segments.push_back({n - 1, 0});
    Shape s;
    s.m_surface = std::make_shared<const Surface<2>>(points, segments, "chain");
    return std::move(s).measured();
  }
}

template <int D>
std::span<const PlacedView<D>> Shape<D>::surfaceParts() const {
  return m_surface ? m_surface->parts() : std::span<const PlacedView<D>>();
}

template class Surface<2>;
template class Surface<3>;
template Shape<2> Shape<2>::mesh(std::span<const Vec<2>>, std::span<const std::array<int, 3>>);
template Shape<3> Shape<3>::mesh(std::span<const Vec<3>>, std::span<const std::array<int, 3>>);
template Shape<2> Shape<2>::chain(std::span<const Vec<2>>, bool);
template Shape<3> Shape<3>::chain(std::span<const Vec<3>>, bool);
template std::span<const PlacedView<2>> Shape<2>::surfaceParts() const;
template std::span<const PlacedView<3>> Shape<3>::surfaceParts() const;

}}  // namespace lpc::LPC_PRECISION
