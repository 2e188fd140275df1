// SPDX-License-Identifier: Zlib
#include "experiments/trial/measure/rest.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <vector>

#include "framework/math/tolerances.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

constexpr double kSlop = double(kLinearSlop);

}  // namespace

template <int D>
double smallestBody(const Simulation<D>& world) {
  const Bodies<D>& b = world.bodies();
  std::vector<Aabb<D>> boxes(b.type.size());
  for (const ShapeRecord<D>& s : world.shapes()) {
    if (s.body < 0 || b.type[static_cast<std::size_t>(s.body)] != BodyType::dynamic) continue;
    Aabb<D>& box = boxes[static_cast<std::size_t>(s.body)];
    box = box.merged(boundingBox(s.shape, s.X_CS));
  }
  double least = std::numeric_limits<double>::infinity();
  for (const Aabb<D>& box : boxes) {
    if (box.lo[0] <= box.hi[0]) least = std::min(least, double((box.hi - box.lo).minCoeff()));
  }
  return std::isfinite(least) ? least : 0;
}

double Rest::sagShare() const { return std::max(sag - fall - levels * kSlop, 0.0) / size; }
double Rest::depthShare() const { return std::max(depth - kSlop, 0.0) / size; }
double Rest::sinkingShare() const { return sinking / size; }

double Rest::share() const { return std::fmax(sagShare(), std::fmax(depthShare(), sinkingShare())); }

std::string Rest::reason() const {
  char why[160];
  if (share() == sagShare()) {
    std::snprintf(why, sizeof why, "at the end a body has sagged by %.4g m, %.4g m beyond the slop of its levels",
                  sag - fall, sagShare() * size);
  } else if (share() == depthShare()) {
    std::snprintf(why, sizeof why, "at the end shapes overlap by %.4g m, %.4g m beyond the slop", depth,
                  depthShare() * size);
  } else {
    std::snprintf(why, sizeof why, "at the end a body sinks by %.4g m in a second", sinking);
  }
  char limit[320];
  std::snprintf(limit, sizeof limit, "%s: %.3g %% of the smallest body (%.4g m), over %.3g %%", why, 100 * share(),
                size, 100 * kRestShare);
  return limit;
}

template double smallestBody(const Simulation<2>&);
template double smallestBody(const Simulation<3>&);

}}  // namespace lpc::LPC_PRECISION
