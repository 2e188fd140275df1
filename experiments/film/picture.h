// SPDX-License-Identifier: Zlib
// A drawing independent of its file format: coloured convex patches in pixels, x to the right and y down.
#pragma once

#include <cstdio>
#include <string>
#include <vector>

#include "framework/draw/debug_draw.h"

namespace lpc { inline namespace LPC_PRECISION {

/// As #rrggbb, or #rrggbbaa if transparent.
inline std::string colourText(const DrawColour& c) {
  char text[10];
  const int end = std::snprintf(text, sizeof text, "#%02x%02x%02x", c.red, c.green, c.blue);
  if (c.alpha < 255) std::snprintf(text + end, sizeof text - static_cast<std::size_t>(end), "%02x", c.alpha);
  return text;
}

struct Patch {
  std::vector<Vec<2>> corners;  // convex, in order; two corners are a line
  DrawColour fill, edge;
};

/// The part of a convex polygon where inward . p >= least.
std::vector<Vec<2>> cutPolygon(const std::vector<Vec<2>>& corners, const Vec<2>& inward, double least);

struct Label {
  Vec<2> at;  // left end of its base line
  std::string text;
  DrawColour colour = {};
};

struct Picture {
  double width = 0, height = 0;
  std::vector<Patch> patches;  // later ones cover earlier ones
  std::vector<Label> labels;

  /// Adds `other`, clipped to its own frame: a floor is unbounded and would cover the picture beside it.
  void add(const Picture& other, const Vec<2>& offset);
};

}}  // namespace lpc::LPC_PRECISION
