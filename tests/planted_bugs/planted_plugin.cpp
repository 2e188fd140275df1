// SPDX-License-Identifier: Zlib
// Broadphases and pair queries with one failure each, and a kind of force, for the tests of the runner: each failure
// must be recorded as a row with its name.
#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <memory>

#include "framework/problem/force.h"
#include "framework/stage/plugin.h"
#include "framework/stage/stage_broadphase.h"
#include "framework/stage/stage_narrowphase.h"

LPC_PLUGIN;

namespace lpc { inline namespace LPC_PRECISION {
namespace {

enum class Bug { hang, crash, allocate, forget, dice, slow, hoard };

template <int D, Bug kBug>
class Planted : public Broadphase<D> {
 public:
  using Params = NoParams;
  explicit Planted(const Params&) {}

  static AlgorithmInfo info() {
    const char* const names[] = {"planted_hang", "planted_crash", "planted_allocate", "planted_forget",
                                 "planted_dice", "planted_slow",  "planted_hoard"};
    return {.name = names[static_cast<int>(kBug)], .summary = "planted bug", .paper = "", .complexity = "n^2"};
  }

  void findPairs(const Proxies<D>& proxies, std::vector<ProxyPair>& out, WorkDone&) override {
    if (kBug == Bug::hang) {
      for (;;) usleep(1000);
    }
    if (kBug == Bug::crash) std::abort();
    if (kBug == Bug::slow) usleep(2000);
    if (kBug == Bug::hoard) m_hoard.push_back(std::make_unique<char[]>(4096));
    if (kBug == Bug::allocate) {
      for (;;) {
        m_hoard.push_back(std::make_unique<char[]>(1 << 22));
        std::memset(m_hoard.back().get(), 1, 1 << 22);
        usleep(2000);
      }
    }
    for (ProxyId a = 0; a < proxies.size(); ++a) {
      for (ProxyId b = a + 1; b < proxies.size(); ++b) {
        if (proxies.boxesOverlap(a, b) && proxies.mayCollide(a, b)) out.push_back({a, b});
      }
    }
    if (kBug == Bug::forget && !out.empty()) out.pop_back();
    // Differs between processes, and so between repeats. Conservative, so that additional pairs are no error.
    if (kBug == Bug::dice && getpid() % 2) out.push_back({0, proxies.size() - 1});
  }

 private:
  std::vector<std::unique_ptr<char[]>> m_hoard;
};

template <int D>
using Hang = Planted<D, Bug::hang>;
template <int D>
using Crash = Planted<D, Bug::crash>;
template <int D>
using Allocate = Planted<D, Bug::allocate>;
template <int D>
using Forget = Planted<D, Bug::forget>;
template <int D>
using Slow = Planted<D, Bug::slow>;
template <int D>
using Hoard = Planted<D, Bug::hoard>;

template <int D>
class Dice : public Planted<D, Bug::dice> {
 public:
  using Planted<D, Bug::dice>::Planted;
  static AlgorithmInfo info() {
    AlgorithmInfo i = Planted<D, Bug::dice>::info();
    i.guarantee = Guarantee::conservative;
    return i;
  }
};

/// Its constructor throws what is no exception, aborts, exits or loops.
template <int D>
class Rude : public Planted<D, Bug::forget> {
 public:
  struct Params {
    int bug = 0;
    void visit(ParamVisitor& v) { v.integer("bug", bug, 0, 4, "0 none, 1 throws, 2 aborts, 3 exits, 4 loops"); }
  };
  explicit Rude(const Params& params) : Planted<D, Bug::forget>({}) {
    if (params.bug == 1) throw 1;
    if (params.bug == 2) std::abort();
    if (params.bug == 3) std::exit(0);
    while (params.bug == 4) usleep(1000);
  }
  static AlgorithmInfo info() {
    return {.name = "planted_rude", .summary = "planted bug", .paper = "", .complexity = "n^2"};
  }
};

/// Fails while the library is loaded, as the environment asks.
struct LoadTime {
  LoadTime() {
    const char* const bug = std::getenv("LPC_PLANTED_LOAD");
    if (!bug) return;
    if (!std::strcmp(bug, "throws")) throw 1;
    if (!std::strcmp(bug, "exits")) std::exit(0);
    if (!std::strcmp(bug, "twice")) Registrar<Broadphase, Rude, 2>{__FILE__};  // LPC_REGISTER does it again
  }
} const loadTime;

/// On circles. One returns half the depth, the other crashes on large concentric circles.
template <int D, bool kCrashes>
class PlantedQuery : public PairQuery<D> {
 public:
  using Params = NoParams;
  explicit PlantedQuery(const Params&) {}

  static AlgorithmInfo info() {
    return {.name = kCrashes ? "planted_abort" : "planted_half",
            .summary = "planted bug",
            .paper = "",
            .complexity = "one square root"};
  }
  bool supports(ShapeKind a, ShapeKind b) const override { return a == ShapeKind::sphere && b == ShapeKind::sphere; }
  void query(std::span<const PairView<D>> pairs, QueryNeed, std::span<PairAnswer<D>> answers, std::span<PairMemory>,
             WorkDone&) override {
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const PairView<D>& pair = pairs[i];
      const Real length = pair.X_AB.p.norm();
      if (kCrashes && length == 0 && pair.a.radius > 800) std::abort();
      PairAnswer<D> answer;
      answer.status = QueryStatus::converged;
      answer.normal = length > 0 ? Vec<D>(pair.X_AB.p / length) : Vec<D>(Vec<D>::Unit(0));
      answer.distance = length - pair.a.radius - pair.b.radius;
      if (!kCrashes && answer.distance < 0) answer.distance /= 2;
      answers[i] = answer;
    }
  }
};
template <int D>
using Half = PlantedQuery<D, false>;
template <int D>
using Aborts = PlantedQuery<D, true>;

/// No bug: scenes find kinds of force in plugins, too.
template <int D>
class Push : public ForceKind<D> {
 public:
  struct Params {
    Real force = 1;
    void visit(ParamVisitor& v) { v.real("force", force, 0, 1000, "N", "along x"); }
  };
  explicit Push(const Params& params) : m_params(params) {}

  static AlgorithmInfo info() {
    return {.name = "planted_push", .summary = "a force along x", .paper = "", .complexity = "1"};
  }
  ForceEnds ends() const override { return {.all = false}; }
  void apply(const ForceRecord<D>& force, const ForceState<D>&, Real, std::span<Wrench<D>> out) const override {
    out[static_cast<std::size_t>(force.bodyB)].force[0] += m_params.force;
  }

 private:
  Params m_params;
};

}  // namespace

LPC_REGISTER(ForceKind, Push, 2);
LPC_REGISTER(PairQuery, Half, 2);
LPC_REGISTER(PairQuery, Aborts, 2);
LPC_REGISTER(Broadphase, Hang, 2);
LPC_REGISTER(Broadphase, Crash, 2);
LPC_REGISTER(Broadphase, Allocate, 2);
LPC_REGISTER(Broadphase, Forget, 2);
LPC_REGISTER(Broadphase, Dice, 2);
LPC_REGISTER(Broadphase, Slow, 2);
LPC_REGISTER(Broadphase, Hoard, 2);
LPC_REGISTER(Broadphase, Rude, 2);

}}  // namespace lpc::LPC_PRECISION
