// SPDX-License-Identifier: Zlib
// Maps points of the world to a window. Pixels are the window's: x to the right, y down, from its upper left corner; a
// view may be a part of the window.
#pragma once

#include <array>

#include "framework/math/space.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Shared by both dimensions: the part of the window.
class ViewFrame {
 public:
  /// In pixels.
  void resize(int width, int height, int left = 0, int top = 0);
  int width() const { return m_width; }
  int height() const { return m_height; }
  int left() const { return m_left; }
  int top() const { return m_top; }
  Vec<2> center() const { return {Real(m_left) + Real(m_width) / 2, Real(m_top) + Real(m_height) / 2}; }

 private:
  int m_width = 1280, m_height = 800, m_left = 0, m_top = 0;
};

/// A column-major matrix from the world, relative to the camera's `origin`, to OpenGL's clip space: far from the
/// world's origin floats would lose details near the camera.
using ViewMatrix = std::array<float, 16>;

template <int D>
class ViewCamera;

template <>
class ViewCamera<2> : public ViewFrame {
 public:
  Vec<2> toPixel(const Vec<2>& p) const;
  Vec<2> toWorld(const Vec<2>& pixel) const;
  /// Moves the view with the mouse by (dx, dy) px: the point under the mouse stays under it.
  void pan(Real dx, Real dy);
  /// Magnifies by `factor`; the point under the pixel stays there.
  void zoom(Real factor, const Vec<2>& pixel);
  /// Fits the box into the view, with a border.
  void look(const Vec<2>& lo, const Vec<2>& hi);

  const Vec<2>& origin() const { return m_middle; }
  Real scaleAt(const Vec<2>&) const { return m_scale; }  // px/m
  ViewMatrix matrix() const;

 private:
  Vec<2> m_middle = Vec<2>::Zero();
  Real m_scale = 40;
};

/// Looks at a target from a distance.
template <>
class ViewCamera<3> : public ViewFrame {
 public:
  struct Ray {
    Vec<3> origin, direction;  // a unit vector
  };

  /// NaN for points that are not in front of the viewer.
  Vec<2> toPixel(const Vec<3>& p) const;
  Ray ray(const Vec<2>& pixel) const;
  /// Rotates the view with the mouse, as if it held the front of the scene.
  void orbit(Real dx, Real dy);
  /// As in 2D, for points at the depth of the target.
  void pan(Real dx, Real dy);
  /// As in 2D, for points at the depth of the target.
  void zoom(Real factor, const Vec<2>& pixel);
  /// Fits the box into the view, with a border; keeps the direction of the view.
  void look(const Vec<3>& lo, const Vec<3>& hi);

  const Vec<3>& origin() const { return m_target; }
  Vec<3> eye() const { return m_target + m_distance * towards(); }
  Vec<3> right() const;
  Vec<3> up() const;
  Vec<3> towards() const;               // towards the viewer
  Real scaleAt(const Vec<3>& p) const;  // px/m; for points not in front of the viewer, as at the nearest distance
  // Range of visible distances (m): nearer and farther points are clipped. A depth buffer of 24 bits allows no more.
  Real nearest() const { return m_distance / 100; }
  Real farthest() const { return 500 * m_distance; }
  Real distance() const { return m_distance; }  // from the viewer to the target (m)
  ViewMatrix matrix() const;

 private:
  Real focal() const;                                  // px: size of a metre at a distance of a metre
  Real scale() const { return focal() / m_distance; }  // px/m, at the target

  Vec<3> m_target = Vec<3>::Zero();
  Real m_azimuth = Real(0.5), m_elevation = Real(0.35);  // rad, of the viewer: from z towards x, and up
  Real m_distance = 20;
};

}}  // namespace lpc::LPC_PRECISION
