// SPDX-License-Identifier: Zlib
// Pictures of a window on an invisible display.
#pragma once

#include "experiments/sandbox/gl_canvas.h"
#include "experiments/sandbox/window.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test {

inline constexpr DrawColour kPaper{247, 247, 245};

/// One frame drawn by `draw`, as seen by the camera.
template <int D>
Window::Picture shown(Window& window, GlCanvas<D>& canvas, const ViewCamera<D>& camera, auto draw) {
  window.beginFrame();
  canvas.begin(camera);
  draw(canvas);
  canvas.end();
  window.endFrame();
  return window.screenshot();
}

inline bool isPaper(const DrawColour& c) { return c == kPaper; }
/// Of any brightness.
inline bool isRed(const DrawColour& c) { return c.red > 60 && c.green < c.red / 4 && c.blue < c.red / 4; }
inline bool isBlue(const DrawColour& c) { return c.blue > 60 && c.green < c.blue / 4 && c.red < c.blue / 4; }

inline int count(const Window::Picture& picture, bool (*is)(const DrawColour&)) {
  int n = 0;
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) n += is(picture.at(x, y));
  }
  return n;
}

}}}  // namespace lpc::LPC_PRECISION::test
