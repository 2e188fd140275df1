// SPDX-License-Identifier: Zlib
#include "experiments/film/picture.h"

namespace lpc::inline LPC_PRECISION {
namespace {

// What of a convex patch lies where x[axis] is at least `bound` (side 1) or at most (side -1): Sutherland and Hodgman.
std::vector<Vec<2>> cut(const std::vector<Vec<2>>& corners, int axis, double bound, int side) {
  std::vector<Vec<2>> out;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec<2>&a = corners[i], &b = corners[(i + 1) % corners.size()];
    const double in = side * (a[axis] - bound), next = side * (b[axis] - bound);
    if (in >= 0) out.push_back(a);
    if ((in < 0 && next > 0) || (in > 0 && next < 0)) out.push_back(a + in / (in - next) * (b - a));
  }
  return out;
}

}  // namespace

void Picture::add(const Picture& other, const Vec<2>& offset) {
  for (const Patch& p : other.patches) {
    Patch seen = p;
    for (const auto& [axis, most] : {std::pair(0, other.width), std::pair(1, other.height)}) {
      seen.corners = cut(cut(seen.corners, axis, 0, 1), axis, most, -1);
    }
    if (seen.corners.empty()) continue;
    for (Vec<2>& c : seen.corners) c += offset;
    patches.push_back(std::move(seen));
  }
  for (const Label& l : other.labels) labels.push_back({l.at + offset, l.text});
}

}  // namespace lpc::inline LPC_PRECISION
