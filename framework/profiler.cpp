// SPDX-License-Identifier: Zlib
#include "framework/profiler.h"

#include <algorithm>
#include <cstring>
#include <ostream>

namespace lpc::inline LPC_PRECISION {

void Profiler::beginFrame(long step) {
  m_frame.step = step;
  m_frame.seconds = 0;
  for (Time& t : m_frame.times) t.seconds = 0;  // the names stay: no allocation after the first steps
  m_frame.work = WorkDone{};
  m_frame.lostTime = 0;
}

void Profiler::endFrame(double seconds) {
  m_frame.seconds = seconds;
  if (m_keep) m_frames.push_back(m_frame);
}

void Profiler::add(const char* name, double seconds) {
  for (Time& t : m_frame.times) {
    if (t.name == name || std::strcmp(t.name, name) == 0) {
      t.seconds += seconds;
      return;
    }
  }
  m_frame.times.push_back({name, seconds});
}

void Profiler::writeCsv(std::ostream& out) const {
  std::vector<const char*> names;  // a phase may appear late: the columns are the union over all frames
  for (const Frame& f : m_frames) {
    for (const Time& t : f.times) {
      const auto same = [&](const char* n) { return std::strcmp(n, t.name) == 0; };
      if (std::none_of(names.begin(), names.end(), same)) names.push_back(t.name);
    }
  }
  out << "# step: number of the step, from 0\n"
         "# seconds: wall time of the whole step, s\n"
         "# seconds_NAME: wall time of a stage, or of a phase inside a stage (stage.phase), s\n"
         "# bodies, awake, pairs, manifolds, points: how many after the step; awake counts dynamic bodies\n"
         "# other columns: work done in the step, a count\n"
         "step,seconds";
  for (const char* n : names) out << ",seconds_" << n;
  out << ",bodies,awake,pairs,manifolds,points";
  for (std::string_view n : kCountNames) out << ',' << n;
  out << '\n';
  for (const Frame& f : m_frames) {
    out << f.step << ',' << f.seconds;
    for (const char* n : names) {
      double seconds = 0;
      for (const Time& t : f.times) {
        if (std::strcmp(n, t.name) == 0) seconds = t.seconds;
      }
      out << ',' << seconds;
    }
    out << ',' << f.bodies << ',' << f.awake << ',' << f.pairs << ',' << f.manifolds << ',' << f.points;
    for (std::uint64_t c : f.work.counts) out << ',' << c;
    out << '\n';
  }
}

}  // namespace lpc::inline LPC_PRECISION
