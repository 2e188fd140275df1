// SPDX-License-Identifier: Zlib
#include "framework/stage/profiler.h"

#include <algorithm>
#include <cstring>
#include <ostream>

namespace lpc { inline namespace LPC_PRECISION {

void Profiler::countMemory(MemoryUse (*counter)()) {
  m_counter = counter;
  m_attributed = {};
  m_frame.times.reserve(32);  // so that no stage is charged for the entry of its own name
}

void Profiler::beginFrame(long step) {
  m_unattributedBefore = unattributed();
  m_frame.step = step;
  m_frame.seconds = 0;
  for (Time& t : m_frame.times) t.seconds = 0, t.memory = {};  // names stay: no allocation after the first steps
  m_frame.work = WorkDone{};
  m_frame.lostTime = 0;
}

void Profiler::endFrame(double seconds) {
  m_frame.seconds = seconds;
  m_frame.elsewhere = unattributed() - m_unattributedBefore;
  if (m_keep) m_frames.push_back(m_frame);
}

Profiler::Time& Profiler::add(const char* name, double seconds) {
  for (Time& t : m_frame.times) {
    if (t.name == name || std::strcmp(t.name, name) == 0) {
      t.seconds += seconds;
      return t;
    }
  }
  return m_frame.times.emplace_back(Time{name, seconds, {}});
}

void Profiler::attribute(Time& time, const MemoryUse& unattributedBefore) {
  const MemoryUse own = unattributed() - unattributedBefore;
  time.memory += own, m_attributed += own;
}

void Profiler::writeCsv(std::ostream& out) const {
  std::vector<const char*> names;  // a phase may first appear late: the columns are the union over all frames
  for (const Frame& f : m_frames) {
    for (const Time& t : f.times) {
      const auto same = [&](const char* n) { return std::strcmp(n, t.name) == 0; };
      if (std::none_of(names.begin(), names.end(), same)) names.push_back(t.name);
    }
  }
  out << "# step: number of the step, from 0\n"
         "# seconds: wall time of the whole step, s\n"
         "# seconds_NAME: wall time of a stage, or of a phase inside a stage (stage.phase), s\n"
         "# bodies, awake, pairs, manifolds, points: counts after the step; awake counts dynamic bodies\n";
  if (m_counter) {
    out << "# allocations_NAME, allocated_NAME, held_NAME: allocations in the step, their bytes, and the bytes "
           "bytes\n"
           "# minus the freed ones; without nested stages and phases; elsewhere: outside all stages\n";
  }
  out << "# other columns: counts of work in the step\n"
         "step,seconds";
  for (const char* n : names) out << ",seconds_" << n;
  out << ",bodies,awake,pairs,manifolds,points";
  if (m_counter) {
    for (const char* n : names) out << ",allocations_" << n << ",allocated_" << n << ",held_" << n;
    out << ",allocations_elsewhere,allocated_elsewhere,held_elsewhere";
  }
  for (std::string_view n : kCountNames) out << ',' << n;
  out << '\n';
  for (const Frame& f : m_frames) {
    out << f.step << ',' << f.seconds;
    const auto of = [&](const char* name) {
      for (const Time& t : f.times) {
        if (std::strcmp(name, t.name) == 0) return t;
      }
      return Time{name, 0, {}};
    };
    const auto put = [&](const MemoryUse& m) { out << ',' << m.allocations << ',' << m.allocated << ',' << m.held; };
    for (const char* n : names) out << ',' << of(n).seconds;
    out << ',' << f.bodies << ',' << f.awake << ',' << f.pairs << ',' << f.manifolds << ',' << f.points;
    if (m_counter) {
      for (const char* n : names) put(of(n).memory);
      put(f.elsewhere);
    }
    for (std::uint64_t c : f.work.counts) out << ',' << c;
    out << '\n';
  }
}

}}  // namespace lpc::LPC_PRECISION
