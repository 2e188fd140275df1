// SPDX-License-Identifier: Zlib
// What is drawn, before it is known into what: coloured convex patches in pixels, x to the right and y down.
#pragma once

#include <string>
#include <vector>

#include "framework/space.h"

namespace lpc::inline LPC_PRECISION {

struct Colour {
  unsigned char red = 0, green = 0, blue = 0;
};

struct Patch {
  std::vector<Vec<2>> corners;  // convex, in order; two are a line
  Colour fill, edge;
};

struct Label {
  Vec<2> at;  // left end of its base line
  std::string text;
};

struct Picture {
  double width = 0, height = 0;
  std::vector<Patch> patches;  // later ones cover earlier ones
  std::vector<Label> labels;

  /// What of `other` is beyond its own frame is cut off by whoever draws.
  void add(const Picture& other, const Vec<2>& offset) {
    for (Patch p : other.patches) {
      for (Vec<2>& c : p.corners) c += offset;
      patches.push_back(std::move(p));
    }
    for (const Label& l : other.labels) labels.push_back({l.at + offset, l.text});
  }
};

}  // namespace lpc::inline LPC_PRECISION
