// SPDX-License-Identifier: Zlib
#include "experiments/film/picture.h"

namespace lpc { inline namespace LPC_PRECISION {

// Sutherland-Hodgman clipping.
std::vector<Vec<2>> cutPolygon(const std::vector<Vec<2>>& corners, const Vec<2>& inward, double least) {
  std::vector<Vec<2>> out;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec<2>&a = corners[i], &b = corners[(i + 1) % corners.size()];
    const double in = inward.dot(a) - least, next = inward.dot(b) - least;
    if (in >= 0) out.push_back(a);
    if ((in < 0 && next > 0) || (in > 0 && next < 0)) out.push_back(a + in / (in - next) * (b - a));
  }
  return out;
}

void Picture::add(const Picture& other, const Vec<2>& offset) {
  for (const Patch& p : other.patches) {
    Patch seen = p;
    for (const auto& [axis, most] : {std::pair(0, other.width), std::pair(1, other.height)}) {
      const Vec<2> inward = Vec<2>::Unit(axis);
      seen.corners = cutPolygon(cutPolygon(seen.corners, inward, 0), -inward, -most);
    }
    if (seen.corners.empty()) continue;
    for (Vec<2>& c : seen.corners) c += offset;
    patches.push_back(std::move(seen));
  }
  for (const Label& l : other.labels) labels.push_back({l.at + offset, l.text, l.colour});
}

}}  // namespace lpc::LPC_PRECISION
