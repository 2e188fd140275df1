// SPDX-License-Identifier: Zlib
#include "oracles/error_bars.h"

#include <algorithm>
#include <array>
#include <limits>

namespace lpc::inline LPC_PRECISION {
namespace {

constexpr double kNone = std::numeric_limits<double>::infinity();

// The kinds of 3D in the order of ShapeKind: sphere, capsule, box, polytope.
struct Row {
  std::string_view witness;
  std::array<double, 4> sphere;   // sphere against each
  std::array<double, 3> capsule;  // capsule against capsule, box, polytope
  std::array<double, 2> box;      // box against box, polytope
  double polytope;                // polytope against polytope

  double at(std::size_t a, std::size_t b) const {
    return a == 0 ? sphere[b] : a == 1 ? capsule[b - 1] : a == 2 ? box[b - 2] : polytope;
  }
};

constexpr std::array<Row, 7> kRows = {{
    {"bullet_box_box", {kNone, kNone, kNone, kNone}, {kNone, kNone, kNone}, {3e-3, kNone}, kNone},
    {"bullet_gjk_epa", {1e-15, 1e-15, 2e-13, 2e-14}, {8e-15, 2e-13, 7e-14}, {1e-13, 5e-14}, 7e-14},
    {"fcl_indep", {1e-15, 1e-15, 1e-15, 1e-1}, {2e-1, 2e-1, 1e-1}, {5e-3, 7e-2}, 6e-2},
    {"fcl_libccd", {9e-7, 5e-6, 2e-6, 7e-7}, {6e-6, 4e-6, 3e-6}, {1e-15, 1e-15}, 1e-15},
    {"fcl_libccd_collide", {1e-15, 1e-15, 1e-15, 2e-1}, {2e-1, 2e-1, 2e-1}, {3e-3, 8e-2}, 9e-2},
    {"libccd_gjk", {4e-1, 5e-5, 3e-5, 4e-5}, {5e-2, 7e-5, 3e-5}, {2e-5, 2e-5}, 3e-5},
    {"libccd_mpr", {1e-15, 2e-1, 2e-1, 2e-1}, {2e-1, 2e-1, 2e-1}, {2e-1, 6e-2}, 9e-2},
}};

}  // namespace

double errorBar(std::string_view witness, ShapeKind a, ShapeKind b) {
  if (std::max(a, b) > ShapeKind::polytope) return kNone;  // not measured
  if (a == ShapeKind::segment || b == ShapeKind::segment) return kNone;
  const auto number = [](ShapeKind kind) {  // without the segment
    return static_cast<std::size_t>(kind) - (kind > ShapeKind::segment ? 1 : 0);
  };
  for (const Row& row : kRows) {
    if (row.witness == witness) return row.at(number(std::min(a, b)), number(std::max(a, b)));
  }
  return kNone;
}

}  // namespace lpc::inline LPC_PRECISION
