// SPDX-License-Identifier: Zlib
#pragma once

#include <iosfwd>

#include "framework/world/simulation.h"

namespace lpc { inline namespace LPC_PRECISION {

enum class TrajectoryFormat { asCsv, asJson };

/// Writes poses and velocities over time as text for other programs. A row is one body in one frame, with the columns
///
/// - 2D: step, time, body, generation, x, y, angle, vx, vy, omega, awake
/// - 3D: step, time, body, generation, x, y, z, qw, qx, qy, qz, vx, vy, vz, wx, wy, wz, awake
///
/// Position (m) and velocity (m/s) are of the centre of mass; the angle is in (-pi, pi]; `body` is the slot. Numbers
/// have the fewest digits that read back as the same bits. A number that is not finite is `nan` or `inf` in CSV and
/// null in JSON. JSON is one object with "dimension", "columns" and "rows".
template <int D>
class TrajectoryWriter {
 public:
  /// Writes the header. The stream must outlive the writer.
  TrajectoryWriter(std::ostream& out, TrajectoryFormat format);
  /// Appends a row for each body in the world.
  void frame(const Simulation<D>& world);
  void finish();  // ends the JSON text; after the last frame

 private:
  std::ostream& m_out;
  TrajectoryFormat m_format;
  bool m_first = true;
};

}}  // namespace lpc::LPC_PRECISION
