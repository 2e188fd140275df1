// SPDX-License-Identifier: Zlib
// B10: the listener's calls for a pair are begin, persist ..., end, in repetition, whatever happens to the bodies.
#include <gtest/gtest.h>

#include <map>

#include "tests/check_property.h"
#include "tests/draw.h"
#include "tests/small_worlds.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace pair_events_test { namespace {

/// The open pairs of a listener, and its first wrong call.
template <int D>
class Ledger : public ContactListener<D> {
 public:
  explicit Ledger(bool veto) : m_veto(veto) {}

  bool begin(const World<D>&, const Manifold<D>& m) override {
    if (!m_open.emplace(m.key(), 0).second) wrong("begin of a pair that has begun");
    return solve(m);
  }
  bool persist(const World<D>&, const Manifold<D>& m) override {
    if (!m_open.contains(m.key())) wrong("persist of a pair that has not begun");
    return solve(m);
  }
  void end(const World<D>&, const Manifold<D>& m) override {
    if (m_open.erase(m.key()) == 0) wrong("end of a pair that has not begun");
    ++ends;
  }

  std::size_t open() const { return m_open.size(); }
  std::string fault;
  int ends = 0;

 private:
  bool solve(const Manifold<D>& m) const { return !m_veto || m.bodyB % 3 != 0; }
  void wrong(const char* what) {
    if (fault.empty()) fault = what;
  }
  bool m_veto;
  std::map<decltype(Manifold<D>{}.key()), int> m_open;
};

/// Planted bug: misses the end of contacts that a user's change ended.
template <int D>
class DeafBetweenSteps final : public Ledger<D> {
 public:
  using Ledger<D>::Ledger;
  void end(const World<D>& world, const Manifold<D>& m) override {
    if (stepping) Ledger<D>::end(world, m);
  }
  bool stepping = false;
};

template <int D, class Listener>
void eventsAlternate() {
  RapidCheckDraw draw;
  World<D> world;
  addHeap(world, 5, static_cast<std::uint64_t>(draw.below(1000)));
  Listener ledger(draw.coin());
  world.addListener(&ledger);
  for (int i = 0; i < 60; ++i) {
    const auto slot = static_cast<std::size_t>(draw.below(static_cast<int>(world.bodies().pose.size())));
    const bool used = world.bodies().used[slot] && slot > 0;  // the ground stays
    switch (draw.below(12)) {
      case 1:
        if (used) world.remove(world.handle(static_cast<std::int32_t>(slot)));
        break;
      case 2:
        world.add(body<D>(Shape<D>::box(Vec<D>::Constant(Real(0.4))), at<D>(2 * draw.signedUnit(), draw.real(0, 3))));
        break;
      case 3:
        if (used) world.setPose(world.handle(static_cast<std::int32_t>(slot)), {at<D>(draw.signedUnit(), 0.5), {}});
        break;
      default:
        break;
    }
    if constexpr (requires { ledger.stepping; }) ledger.stepping = true;
    world.step(Real(1) / 60);
    if constexpr (requires { ledger.stepping; }) ledger.stepping = false;
    RC_ASSERT(ledger.fault == "");
    RC_ASSERT(ledger.open() == world.manifolds().size());
  }
  for (std::size_t i = 0; i < world.bodies().pose.size(); ++i) {
    if (world.bodies().used[i]) world.remove(world.handle(static_cast<std::int32_t>(i)));
  }
  world.step(Real(1) / 60);
  RC_ASSERT(ledger.fault == "");
  RC_ASSERT(ledger.open() == 0u);
}

template <int D>
void events() {
  check("B10", eventsAlternate<D, Ledger<D>>, 50);
  expectFalsified("B10, deaf between steps", eventsAlternate<D, DeafBetweenSteps<D>>, 50);
}
TEST(PairEvents, Alternate2) { events<2>(); }
TEST(PairEvents, Alternate3) { events<3>(); }

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::pair_events_test
