// SPDX-License-Identifier: Zlib
// Compares meshes with support functions and masses, which share no code with them.
#include "experiments/sandbox/shape_mesh.h"

#include <gtest/gtest.h>

#include <cmath>

#include "framework/shape/mass.h"
#include "framework/shape/support_map.h"
#include "tests/check_property.h"
#include "tests/draw.h"
#include "tests/planted_bugs/view_bugs.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace shape_mesh_test { namespace {

constexpr Real kFloat = Real(1e-5);  // relative to the size: meshes use floats

template <int D>
Shape<D> drawAnyShape(Draw& draw) {
  const ShapeKind kind =
      D == 2 ? draw.pick({ShapeKind::sphere, ShapeKind::box, ShapeKind::capsule, ShapeKind::polytope,
                          ShapeKind::segment, ShapeKind::ellipsoid})
             : draw.pick({ShapeKind::sphere, ShapeKind::box, ShapeKind::capsule, ShapeKind::polytope,
                          ShapeKind::cylinder, ShapeKind::cone, ShapeKind::ellipsoid, ShapeKind::triangle});
  const Sketch<D> sketch = drawSketch<D>(draw, kind);
  return sketch.build(drawScale(draw));
}

Real volume(const ShapeMesh<2>& mesh, std::size_t i) {
  const auto &a = mesh.corners[mesh.triangles[i]], &b = mesh.corners[mesh.triangles[i + 1]],
             &c = mesh.corners[mesh.triangles[i + 2]];
  return Real((b - a)[0] * (c - a)[1] - (b - a)[1] * (c - a)[0]) / 2;
}
Real volume(const ShapeMesh<3>& mesh, std::size_t i) {
  const Vec<3> a = mesh.corners[mesh.triangles[i]].cast<Real>(), b = mesh.corners[mesh.triangles[i + 1]].cast<Real>(),
               c = mesh.corners[mesh.triangles[i + 2]].cast<Real>();
  return a.dot(b.cross(c)) / 6;
}

template <int D>
void isTheShape(auto damage) {
  RapidCheckDraw draw;
  const Shape<D> shape = drawAnyShape<D>(draw);
  const ShapeView<D>& view = shape.view();
  ShapeMesh<D> mesh;
  meshOf(view, draw.pick({48, 64}), mesh);
  damage(mesh);
  const Real size = sizeOf(shape);
  // No corner lies outside, and in every direction one reaches as far as the shape.
  for (int k = 0; k < 20; ++k) {
    const Vec<D> d = drawDirection<D>(draw);
    const Eigen::Matrix<float, D, 1> along = d.template cast<float>();
    Real most = -1e30;
    for (const auto& p : mesh.corners) most = std::max<Real>(most, p.dot(along));
    for (const auto& p : mesh.ends) RC_ASSERT(p.dot(along) <= supportValue(view, d) + kFloat * size);
    RC_ASSERT(most <= supportValue(view, d) + kFloat * size);
    RC_ASSERT(most >= supportValue(view, d) - Real(0.01) * size);
  }
  Real all = 0;
  for (std::size_t i = 0; i < mesh.triangles.size(); i += 3) {
    const Real part = volume(mesh, i);
    all += part;
    if (D == 2) RC_ASSERT(part >= -kFloat * size * size);
  }
  if constexpr (D == 3) {
    RC_ASSERT(mesh.normals.size() == mesh.corners.size());
    for (std::size_t i = 0; i < mesh.triangles.size(); i += 3) {
      const auto &a = mesh.corners[mesh.triangles[i]], &b = mesh.corners[mesh.triangles[i + 1]],
                 &c = mesh.corners[mesh.triangles[i + 2]];
      const Eigen::Vector3f out = (b - a).cross(c - a);
      const Eigen::Vector3f normals =
          mesh.normals[mesh.triangles[i]] + mesh.normals[mesh.triangles[i + 1]] + mesh.normals[mesh.triangles[i + 2]];
      RC_ASSERT(out.dot(normals) >= -1e-4f * static_cast<float>(size * size));
    }
  }
  // Triangles close the mesh. Mass properties ignore the rounding of shapes with flat sides, and a mesh has whole balls
  // at the corners of a rounded hull.
  const bool solid = view.kind != ShapeKind::segment && view.kind != ShapeKind::triangle;
  const Real truly = solid ? massProperties(view, Real(1)).mass : 0, rough = kFloat * std::pow(size, Real(D));
  RC_ASSERT(all >= Real(0.98) * truly - rough);
  const bool rounded = view.radius > 0 && view.core() != CoreClass::point && view.core() != CoreClass::segment;
  if (!rounded) RC_ASSERT(all <= truly + rough);
}

template <int D>
void meshes() {
  check(
      "meshes", [] { isTheShape<D>([](ShapeMesh<D>&) {}); }, 300);
  for (const MeshTwin& twin : kMeshTwins) {
    expectFalsified(twin.name, [&] { isTheShape<D>([&](ShapeMesh<D>& mesh) { twin.damage(mesh); }); });
  }
}
TEST(ShapeMesh, IsTheShape2) { meshes<2>(); }
TEST(ShapeMesh, IsTheShape3) { meshes<3>(); }

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::shape_mesh_test
