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

/// What was allocated and given back.
struct MemoryUse {
  std::int64_t allocations = 0;  // how many
  std::int64_t allocated = 0;    // bytes, given back or not
  std::int64_t held = 0;         // bytes allocated less those given back: below 0 where more is given back

  MemoryUse& operator+=(const MemoryUse& x) {
    allocations += x.allocations, allocated += x.allocated, held += x.held;
    return *this;
  }
  friend MemoryUse operator-(const MemoryUse& a, const MemoryUse& b) {
    return {a.allocations - b.allocations, a.allocated - b.allocated, a.held - b.held};
  }
};

/// Times and counts per stage and step. Two clock reads per scope, always on; rows are kept only when asked for. Memory
/// is counted where the program counts its allocations and says so (`countMemory`).
class Profiler {
 public:
  /// Times a stage or a phase inside one ("solver", "solver.iterate"). Names are string literals: they are kept by
  /// address.
  class Scope {
   public:
    Scope(Profiler& profiler, const char* name)
        : m_profiler(profiler), m_name(name), m_memory(profiler.untold()), m_start(Clock::now()) {}
    ~Scope() {
      const double seconds = std::chrono::duration<double>(Clock::now() - m_start).count();
      Time& time = m_profiler.add(m_name, seconds);
      if (m_profiler.m_counter) m_profiler.tell(time, m_memory);
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
    double seconds;    // with those of the scopes inside
    MemoryUse memory;  // without: what all scopes and `elsewhere` tell is together that of the step
  };
  /// One step.
  struct Frame {
    long step = 0;
    double seconds = 0;       // the whole step
    std::vector<Time> times;  // in order of first use
    MemoryUse elsewhere;      // in the step, outside of every scope
    double lostTime = 0;      // s, that stopped bodies have lost, summed
    int bodies = 0, awake = 0, pairs = 0, manifolds = 0, points = 0;
    WorkDone work;
  };

  void keepFrames(bool keep) { m_keep = keep; }
  /// `counter` tells what this thread has allocated so far, as an `operator new` of the program's own counts it; null:
  /// memory is not counted.
  void countMemory(MemoryUse (*counter)());
  void beginFrame(long step);
  void endFrame(double seconds);
  Frame& frame() { return m_frame; }  // the present or last step
  const std::vector<Frame>& frames() const { return m_frames; }
  /// Of the present step; kept until another name comes.
  Time& add(const char* name, double seconds);

  /// CSV: `#` lines that say what each column is and in which unit, one header line, one line per kept frame.
  void writeCsv(std::ostream& out) const;

 private:
  // What no scope has told yet: the difference of two is what a piece of code used itself, without the scopes in it.
  MemoryUse untold() const { return m_counter ? m_counter() - m_told : MemoryUse{}; }
  void tell(Time& time, const MemoryUse& untoldBefore);

  bool m_keep = false;
  MemoryUse (*m_counter)() = nullptr;
  MemoryUse m_told, m_untoldBefore;
  Frame m_frame;
  std::vector<Frame> m_frames;
};

}}  // namespace lpc::LPC_PRECISION
