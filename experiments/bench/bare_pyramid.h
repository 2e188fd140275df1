// SPDX-License-Identifier: Zlib
// The scene `pyramid` of base 20 through an engine's own API, as its users call it: the baseline for `engine=` on the
// same scene. It contains nothing of LPC.
#pragma once

#include <array>
#include <memory>
#include <vector>

namespace bare {

inline constexpr int kBase = 20;           // boxes in the lowest row: 210 in all
inline constexpr double kStep = 1.0 / 60;  // s
inline constexpr double kGravity = 10;     // m/s^2, downwards

struct Settings {
  int iterations = 10;    // sweeps over velocities
  double friction = 0.6;  // of each pair
  double slop = 0.005;    // m, penetration that contacts keep, if the engine has such a setting
  double moment = 0;      // kg m^2, a box's inertia; 0: computed by the engine
};

/// Position (2D: z = 0) and rotation (a quaternion w x y z; 2D: cosine and sine of the angle), as the engine reports
/// them.
using Placed = std::array<double, 7>;

class Pyramid {
 public:
  virtual ~Pyramid() = default;
  virtual void step() = 0;
  virtual std::vector<Placed> boxes() const = 0;  // row by row from below, each from left to right
};

std::unique_ptr<Pyramid> bulletPyramid(const Settings& settings);
std::unique_ptr<Pyramid> box2dPyramid(const Settings& settings);
std::unique_ptr<Pyramid> chipmunkPyramid(const Settings& settings);

}  // namespace bare
