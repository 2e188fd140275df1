// SPDX-License-Identifier: Zlib
#pragma once

#include <chrono>
#include <iosfwd>
#include <string>
#include <string_view>
#include <vector>

#include "framework/space.h"
#include "framework/work.h"

namespace lpc::inline LPC_PRECISION {

/// Times and counts per stage and step. Two clock reads per scope, always on; rows are kept only when asked for.
class Profiler {
 public:
  /// Times a stage or a phase inside one ("solver", "solver.iterate"). Names are string literals: they are kept by
  /// address.
  class Scope {
   public:
    Scope(Profiler& profiler, const char* name) : m_profiler(profiler), m_name(name), m_start(Clock::now()) {}
    ~Scope() { m_profiler.add(m_name, std::chrono::duration<double>(Clock::now() - m_start).count()); }
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;

   private:
    using Clock = std::chrono::steady_clock;
    Profiler& m_profiler;
    const char* m_name;
    Clock::time_point m_start;
  };

  struct Time {
    const char* name;
    double seconds;
  };
  /// One step.
  struct Frame {
    long step = 0;
    double seconds = 0;       // the whole step
    std::vector<Time> times;  // in order of first use
    double lostTime = 0;      // s, that stopped bodies have lost, summed
    int bodies = 0, awake = 0, pairs = 0, manifolds = 0, points = 0;
    WorkDone work;
  };

  void keepFrames(bool keep) { m_keep = keep; }
  void beginFrame(long step);
  void endFrame(double seconds);
  Frame& frame() { return m_frame; }  // the present or last step
  const std::vector<Frame>& frames() const { return m_frames; }
  void add(const char* name, double seconds);

  /// CSV: `#` lines that say what each column is and in which unit, one header line, one line per kept frame.
  void writeCsv(std::ostream& out) const;

 private:
  bool m_keep = false;
  Frame m_frame;
  std::vector<Frame> m_frames;
};

}  // namespace lpc::inline LPC_PRECISION
