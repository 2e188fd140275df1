// SPDX-License-Identifier: Zlib
// Drawing for whoever looks: a world, or any simulation, as points, lines, shapes and words, in metres. Films, the
// window of the sandbox and a user's own program each are a `DebugDraw`. A step knows nothing of it: what nobody looks
// at costs nothing.
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
/// Lighter or darker.
inline DrawColour operator*(const DrawColour& c, double light) {
  const auto lit = [&](unsigned char x) {
    return static_cast<unsigned char>(std::clamp(std::lround(x * light), 0L, 255L));
  };
  return {lit(c.red), lit(c.green), lit(c.blue), c.alpha};
}

/// How a convex part of a body looks.
struct Look {
  DrawColour fill, edge;
  bool moves = true;     // its body is not fixed: in the plane it is seen in front of those that are
  bool outline = false;  // its edges alone
  friend bool operator==(const Look&, const Look&) = default;
};

template <int D>
class DebugDraw {
 public:
  virtual ~DebugDraw() = default;
  /// A dot of so many pixels across.
  virtual void point(const Vec<D>& p, double pixels, const DrawColour& colour) = 0;
  virtual void line(const Vec<D>& a, const Vec<D>& b, const DrawColour& colour) = 0;
  /// A convex shape at X_WS; a plane has no end.
  virtual void shape(const ShapeView<D>& shape, const Pose<D>& X_WS, const Look& look) = 0;
  /// One line, whose left end is at p.
  virtual void text(const Vec<D>& p, std::string_view text, const DrawColour& colour) = 0;
};

}}  // namespace lpc::LPC_PRECISION
