// SPDX-License-Identifier: Zlib
// Debug drawing: a world, or any simulation, as points, lines, shapes and text, in metres. Films, the sandbox window
// and a user's own program each implement `DebugDraw`. Drawing does not affect a step, and costs nothing when unused.
#pragma once

#include <algorithm>
#include <cmath>
#include <string_view>

#include "framework/world/simulation.h"

namespace lpc { inline namespace LPC_PRECISION {

struct DrawColour {
  unsigned char red = 0, green = 0, blue = 0, alpha = 255;
  friend bool operator==(const DrawColour&, const DrawColour&) = default;
};
/// Makes a colour lighter or darker.
inline DrawColour operator*(const DrawColour& c, double light) {
  const auto shaded = [&](unsigned char x) {
    return static_cast<unsigned char>(std::clamp(std::lround(x * light), 0L, 255L));
  };
  return {shaded(c.red), shaded(c.green), shaded(c.blue), c.alpha};
}

/// How a convex part of a body is drawn.
struct Look {
  DrawColour fill, edge;
  bool moves = true;     // its body is not static; in 2D it is drawn in front of static ones
  bool outline = false;  // edges only
  friend bool operator==(const Look&, const Look&) = default;
};

template <int D>
class DebugDraw {
 public:
  virtual ~DebugDraw() = default;
  /// A dot of this diameter in pixels.
  virtual void point(const Vec<D>& p, double pixels, const DrawColour& colour) = 0;
  virtual void line(const Vec<D>& a, const Vec<D>& b, const DrawColour& colour) = 0;
  /// A convex shape at X_WS; a plane is unbounded.
  virtual void shape(const ShapeView<D>& shape, const Pose<D>& X_WS, const Look& look) = 0;
  /// One line of text with its left end at p.
  virtual void text(const Vec<D>& p, std::string_view text, const DrawColour& colour) = 0;
};

}}  // namespace lpc::LPC_PRECISION
