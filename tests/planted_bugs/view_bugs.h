// SPDX-License-Identifier: Zlib
// Planted bugs of cameras, meshes and canvases.
#pragma once

#include "experiments/sandbox/shape_mesh.h"
#include "experiments/sandbox/view_camera.h"
#include "framework/draw/debug_draw.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test {

// --- cameras: each hides a method of a correct camera ----------------------------------------------------------------

template <int D>
struct UpIsDown : ViewCamera<D> {
  Vec<2> toPixel(const Vec<D>& p) const {
    Vec<2> at = ViewCamera<D>::toPixel(p);
    at[1] = 2 * this->center()[1] - at[1];
    return at;
  }
};

template <int D>
struct ForgetsItsCorner : ViewCamera<D> {
  Vec<2> toPixel(const Vec<D>& p) const {
    return ViewCamera<D>::toPixel(p) - Vec<2>(Real(this->left()), Real(this->top()));
  }
};

template <int D>
struct PansTheOtherWay : ViewCamera<D> {
  void pan(Real dx, Real dy) { ViewCamera<D>::pan(-dx, dy); }
};

template <int D>
struct ZoomsAboutTheMiddle : ViewCamera<D> {
  void zoom(Real factor, const Vec<2>&) { ViewCamera<D>::zoom(factor, this->center()); }
};

struct OrbitsTheOtherWay : ViewCamera<3> {
  void orbit(Real dx, Real dy) { ViewCamera<3>::orbit(dx, -dy); }
};

// --- meshes ----------------------------------------------------------------------------------------------------------

struct MeshTwin {
  const char* name;
  template <int D>
  void damage(ShapeMesh<D>& mesh) const {
    if (mesh.triangles.empty()) return;
    kind == 0 ? std::swap(mesh.triangles[0], mesh.triangles[1]) : mesh.triangles.resize(mesh.triangles.size() / 6 * 3);
  }
  int kind;
};
inline constexpr MeshTwin kMeshTwins[] = {{"a triangle turned inside out", 0}, {"half of the triangles", 1}};

// --- canvases: drawing through them gives wrong output ---------------------------------------------------------------

template <int D>
class CanvasTwin : public DebugDraw<D> {
 public:
  explicit CanvasTwin(DebugDraw<D>& inner) : m_inner(inner) {}
  void point(const Vec<D>& p, double pixels, const DrawColour& colour) override { m_inner.point(p, pixels, colour); }
  void line(const Vec<D>& a, const Vec<D>& b, const DrawColour& colour) override { m_inner.line(a, b, colour); }
  void shape(const ShapeView<D>& shape, const Pose<D>& X_WS, const Look& look) override {
    m_inner.shape(shape, X_WS, look);
  }
  void text(const Vec<D>& p, std::string_view text, const DrawColour& colour) override {
    m_inner.text(p, text, colour);
  }

 protected:
  DebugDraw<D>& m_inner;
};

template <int D>
class DrawsUpsideDown final : public CanvasTwin<D> {
 public:
  using CanvasTwin<D>::CanvasTwin;
  void shape(const ShapeView<D>& shape, const Pose<D>& X_WS, const Look& look) override {
    Pose<D> X = X_WS;
    X.p[1] = -X.p[1];
    this->m_inner.shape(shape, X, look);
  }
};

template <int D>
class ForgetsWhereShapesAre final : public CanvasTwin<D> {
 public:
  using CanvasTwin<D>::CanvasTwin;
  void shape(const ShapeView<D>& shape, const Pose<D>&, const Look& look) override {
    this->m_inner.shape(shape, {}, look);
  }
};

template <int D>
class DrawsALittleLarger final : public CanvasTwin<D> {
 public:
  using CanvasTwin<D>::CanvasTwin;
  void shape(const ShapeView<D>& shape, const Pose<D>& X_WS, const Look& look) override {
    ShapeView<D> larger = shape;
    larger.radius *= Real(1.1);
    this->m_inner.shape(larger, X_WS, look);
  }
};

template <int D>
class DrawsEdgesAlone final : public CanvasTwin<D> {
 public:
  using CanvasTwin<D>::CanvasTwin;
  void shape(const ShapeView<D>& shape, const Pose<D>& X_WS, const Look& look) override {
    Look bare = look;
    bare.outline = true;
    this->m_inner.shape(shape, X_WS, bare);
  }
};

}}}  // namespace lpc::LPC_PRECISION::test
