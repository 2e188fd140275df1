// SPDX-License-Identifier: Zlib
#pragma once

#include <chrono>
#include <cstdint>
#include <iosfwd>
#include <string>
#include <string_view>
#include <vector>

#include "framework/math/space.h"
#include "framework/math/work.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Memory allocated and freed.
struct MemoryUse {
  std::int64_t allocations = 0;  // count
  std::int64_t allocated = 0;    // bytes, freed or not
  std::int64_t held = 0;         // bytes allocated minus bytes freed; negative when more is freed

  MemoryUse& operator+=(const MemoryUse& x) {
    allocations += x.allocations, allocated += x.allocated, held += x.held;
    return *this;
  }
  friend MemoryUse operator-(const MemoryUse& a, const MemoryUse& b) {
    return {a.allocations - b.allocations, a.allocated - b.allocated, a.held - b.held};
  }
};

/// Times and counts per stage and step. It costs two clock reads per scope, and is always on. Frames are kept only on
/// request (keepFrames). Memory is counted when the program provides an allocation counter (countMemory).
class Profiler {
 public:
  /// Times a stage or a phase inside one ("solver", "solver.iterate"). Names are string literals: they are kept by
  /// address.
  class Scope {
   public:
    Scope(Profiler& profiler, const char* name)
        : m_profiler(profiler), m_name(name), m_memory(profiler.unattributed()), m_start(Clock::now()) {}
    ~Scope() {
      const double seconds = std::chrono::duration<double>(Clock::now() - m_start).count();
      Time& time = m_profiler.add(m_name, seconds);
      if (m_profiler.m_counter) m_profiler.attribute(time, m_memory);
    }
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;

   private:
    using Clock = std::chrono::steady_clock;
    Profiler& m_profiler;
    const char* m_name;
    MemoryUse m_memory;
    Clock::time_point m_start;
  };

  struct Time {
    const char* name;
    double seconds;    // including nested scopes
    MemoryUse memory;  // excluding nested scopes: the sum over all scopes, plus `elsewhere`, is that of the step
  };
  /// One step.
  struct Frame {
    long step = 0;
    double seconds = 0;       // the whole step
    std::vector<Time> times;  // in order of first use
    MemoryUse elsewhere;      // in the step, outside of every scope
    double lostTime = 0;      // s, summed over stopped bodies
    int bodies = 0, awake = 0, pairs = 0, manifolds = 0, points = 0;
    WorkDone work;
  };

  void keepFrames(bool keep) { m_keep = keep; }
  /// `counter` returns the memory that this thread has allocated so far, as counted by the program's own `operator
  /// new`; null: memory is not counted.
  void countMemory(MemoryUse (*counter)());
  void beginFrame(long step);
  void endFrame(double seconds);
  Frame& frame() { return m_frame; }  // the current or last step
  const std::vector<Frame>& frames() const { return m_frames; }
  /// Adds to the current step. Names are kept from step to step.
  Time& add(const char* name, double seconds);

  /// CSV: `#` lines with meaning and unit of each column, one header line, one line per kept frame.
  void writeCsv(std::ostream& out) const;

 private:
  // Memory not yet assigned to a scope. The difference of two values is a scope's own use without nested scopes.
  MemoryUse unattributed() const { return m_counter ? m_counter() - m_attributed : MemoryUse{}; }
  void attribute(Time& time, const MemoryUse& unattributedBefore);

  bool m_keep = false;
  MemoryUse (*m_counter)() = nullptr;
  MemoryUse m_attributed, m_unattributedBefore;
  Frame m_frame;
  std::vector<Frame> m_frames;
};

}}  // namespace lpc::LPC_PRECISION
