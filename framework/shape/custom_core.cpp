// SPDX-License-Identifier: Zlib
// Checks that a plugin's convex core has the properties on which every algorithm relies.
#include <vector>

#include "framework/shape/curved_core.h"
#include "framework/shape/shape_tolerances.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

constexpr std::size_t kMostFaceCorners = 64;  // most corners that contact generators clip

// Integer vectors with components from -3 to 3, normalised: 48 in 2D, 342 in 3D.
template <int D>
std::vector<Vec<D>> directions() {
  constexpr int kReach = 3;
  std::vector<Vec<D>> out;
  Vec<D> d = Vec<D>::Constant(-kReach);
  for (int k = 0; k < D;) {
    if (d.squaredNorm() > 0) out.push_back(d.normalized());
    for (k = 0; k < D && ++d[k] > kReach; ++k) d[k] = -kReach;
  }
  return out;
}

template <int D>
std::string listed(const Vec<D>& v) {
  std::string out;
  for (int k = 0; k < D; ++k) out += (k ? ", " : "(") + std::to_string(v[k]);
  return out + ")";
}

}  // namespace

template <int D>
void requireConvexCore(const CurvedCore<D>& core, const std::string& subject) {
  const auto refuse = [&](const std::string& what) { throw UserError(subject + ": " + what); };
  const Vec<D> half = core.half();
  if (!half.allFinite() || !(half.minCoeff() > 0)) {
    refuse("its half extents are " + listed<D>(half) + "; valid: finite and above zero");
  }
  const Real slack = kSupportRounding * half.norm();
  const std::vector<Vec<D>> along = directions<D>();
  std::vector<Vec<D>> farthest, corners;
  for (const Vec<D>& d : along) {
    const Vec<D> p = core.support(d);
    if (!p.allFinite()) refuse("its support point along " + listed<D>(d) + " is not finite");
    if (((p.cwiseAbs() - half).array() > slack).any()) {
      refuse("its support point along " + listed<D>(d) + " is " + listed<D>(p) + ", outside its half extents " +
             listed<D>(half));
    }
    IndexedArray<long double, D> wide;
    for (int k = 0; k < D; ++k) wide[k] = d[k];
    const auto q = core.support(wide);
    long double reach = 0;
    for (std::size_t k = 0; k < D; ++k) reach += q[k] * wide[k];
    if (!(std::abs(reach - static_cast<long double>(p.dot(d))) <= static_cast<long double>(slack))) {
      refuse("its two support functions differ along " + listed<D>(d));
    }
    core.supportFace(d, corners);
    if (corners.empty() || corners.size() > kMostFaceCorners) {
      refuse("its support face along " + listed<D>(d) + " has " + std::to_string(corners.size()) +
             " corners; valid: 1 to " + std::to_string(kMostFaceCorners));
    }
    for (const Vec<D>& c : corners) {
      if (c.allFinite() && ((c.cwiseAbs() - half).array() <= slack).all() && c.dot(d) <= p.dot(d) + slack) continue;
      refuse("a corner of its support face along " + listed<D>(d) + " is " + listed<D>(c) + ", outside the core");
    }
    farthest.push_back(p);
  }
  for (std::size_t i = 0; i < along.size(); ++i) {
    for (std::size_t j = 0; j < along.size(); ++j) {
      if (farthest[j].dot(along[i]) <= farthest[i].dot(along[i]) + slack) continue;
      refuse("it is not convex: its support point along " + listed<D>(along[j]) + " lies farther along " +
             listed<D>(along[i]) + " than its support point there");
    }
  }
  for (int k = 0; k < D; ++k) {
    const Vec<D> axis = Vec<D>::Unit(k), back = -axis;
    const Real reach = std::max(core.support(axis)[k], -core.support(back)[k]);
    if (reach < half[k] - slack) {
      refuse("its half extents are " + listed<D>(half) + ", and it reaches " + std::to_string(reach) + " along axis " +
             std::to_string(k) + "; valid: the tightest box around its own origin");
    }
  }
  if (!core.support(Vec<D>::Zero().eval()).allFinite())
    refuse("its support point for the zero direction is not finite");
  const MassProperties<D> m = core.massProperties(1);
  if (!(m.mass > 0) || !std::isfinite(m.mass) || !m.center.allFinite() || !m.inertia.allFinite()) {
    refuse("its mass is " + std::to_string(m.mass) + "; valid: finite and above zero, about a finite centre");
  }
}

template void requireConvexCore(const CurvedCore<2>&, const std::string&);
template void requireConvexCore(const CurvedCore<3>&, const std::string&);

}}  // namespace lpc::LPC_PRECISION
