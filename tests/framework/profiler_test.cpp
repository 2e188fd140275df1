// SPDX-License-Identifier: Zlib
// Memory by scopes: each scope reports its own use, and the scopes together report all of it.
#include "framework/stage/profiler.h"

#include <gtest/gtest.h>

#include <sstream>

#include "tests/expect_caught.h"

namespace lpc { inline namespace LPC_PRECISION { namespace profiler_test { namespace {

MemoryUse used;  // set by the test instead of an allocator

MemoryUse of(const Profiler::Frame& frame, const std::string& name) {
  for (const Profiler::Time& t : frame.times) {
    if (t.name == name) return t.memory;
  }
  return {};
}

// Planted bug: the use of inner scopes is counted twice.
class TellsTwice {
 public:
  TellsTwice(Profiler& profiler, const char* name) : m_profiler(profiler), m_name(name), m_before(used) {}
  ~TellsTwice() { m_profiler.add(m_name, 0).memory += used - m_before; }
  TellsTwice(const TellsTwice&) = delete;
  TellsTwice& operator=(const TellsTwice&) = delete;

 private:
  Profiler& m_profiler;
  const char* m_name;
  MemoryUse m_before;
};

template <class Scope>
void solve(Profiler& profiler) {
  const Scope solver(profiler, "solver");
  used += {1, 100, 100};
  {
    const Profiler::Scope iterate(profiler, "solver.iterate");
    used += {2, 40, -10};  // frees memory of another scope
    const Profiler::Scope contacts(profiler, "contacts");
    used += {3, 7, 7};
  }
  used += {1, 1, 1};
}

template <class Scope>
void step(Profiler& profiler) {
  used += {1, 5000, 5000};  // between steps
  profiler.beginFrame(0);
  used += {1, 20, 20};
  {
    const Profiler::Scope contacts(profiler, "contacts");
    used += {1, 3, 3};
  }
  solve<Scope>(profiler);
  used += {1, 2, -20};
  profiler.endFrame(0);
}

bool are(const MemoryUse& a, const MemoryUse& b) {
  return a.allocations == b.allocations && a.allocated == b.allocated && a.held == b.held;
}

TEST(ProfilerMemory, ScopesReportTheirOwnUse) {
  Profiler profiler;
  profiler.countMemory([] { return used; });
  profiler.keepFrames(true);
  for (int k = 0; k < 2; ++k) {  // independent of the previous step
    step<Profiler::Scope>(profiler);
    const Profiler::Frame& f = profiler.frame();
    EXPECT_TRUE(are(of(f, "contacts"), {4, 10, 10})) << "twice in a step, once inside of another";
    EXPECT_TRUE(are(of(f, "solver.iterate"), {2, 40, -10}));
    EXPECT_TRUE(are(of(f, "solver"), {2, 101, 101}));
    EXPECT_TRUE(are(f.elsewhere, {2, 22, 0}));
  }
  std::ostringstream csv;
  profiler.writeCsv(csv);
  EXPECT_NE(csv.str().find(",allocations_contacts,allocated_contacts,held_contacts,"), std::string::npos) << csv.str();
  EXPECT_NE(csv.str().find(",4,10,10,2,40,-10,2,101,101,2,22,0,"), std::string::npos) << csv.str();

  step<TellsTwice>(profiler);
  test::expectCaught("tells twice", are(of(profiler.frame(), "solver"), {2, 101, 101}));
}

TEST(ProfilerMemory, IsAbsentWithoutACounter) {
  Profiler profiler;
  profiler.keepFrames(true);
  step<Profiler::Scope>(profiler);
  EXPECT_TRUE(are(of(profiler.frame(), "solver"), {}));
  EXPECT_TRUE(are(profiler.frame().elsewhere, {}));
  std::ostringstream csv;
  profiler.writeCsv(csv);
  EXPECT_EQ(csv.str().find("alloc"), std::string::npos) << csv.str();
}

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::profiler_test
