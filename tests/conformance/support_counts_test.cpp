// SPDX-License-Identifier: Zlib
// All support points of a query are counted, as checked by cores with their own counter. A looser tolerance needs no
// more of them.
#include <gtest/gtest.h>

#include "framework/shape/support_gap.h"
#include "framework/shape/support_map.h"
#include "framework/stage/stage_narrowphase.h"
#include "tests/draw.h"
#include "tests/expect_caught.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace support_counts_test {

std::uint64_t g_calls = 0;

template <int D>
class CountingCore final : public CurvedCore<D> {
 public:
  explicit CountingCore(const CurvedCore<D>& core) : m_core(core) {}
  std::span<const Real> sizes() const override { return m_core.sizes(); }
  Vec<D> half() const override { return m_core.half(); }
  Vec<D> support(const Vec<D>& d) const override { return ++g_calls, m_core.support(d); }
  std::array<long double, static_cast<std::size_t>(D)> support(
      const std::array<long double, static_cast<std::size_t>(D)>& d) const override {
    return ++g_calls, m_core.support(d);
  }
  void supportFace(const Vec<D>& d, std::vector<Vec<D>>& corners) const override {
    ++g_calls, m_core.supportFace(d, corners);
  }
  MassProperties<D> massProperties(Real density) const override { return m_core.massProperties(density); }

 private:
  const CurvedCore<D>& m_core;
};

// Pairs of these kinds, half of them within reach of each other. `views` have cores that count.
template <int D>
struct Pairs {
  std::vector<Shape<D>> shapes;
  std::vector<std::unique_ptr<CountingCore<D>>> cores;
  std::vector<PairView<D>> views;
};

template <int D>
Pairs<D> drawPairs(ShapeKind a, ShapeKind b, int count) {
  PlainDraw draw(23);
  Pairs<D> out;
  out.shapes.reserve(static_cast<std::size_t>(2 * count));
  for (int i = 0; i < count; ++i) {
    PairView<D> view;
    Real size = 0;
    for (const auto& [kind, shape] : {std::pair(a, &view.a), std::pair(b, &view.b)}) {
      out.shapes.push_back(drawSketch<D>(draw, kind).build(1));
      *shape = out.shapes.back().view(), size += sizeOf(out.shapes.back());
      if (!shape->curved) continue;
      out.cores.push_back(std::make_unique<CountingCore<D>>(*shape->curved));
      shape->curved = out.cores.back().get();
    }
    view.X_AB = {draw.real(0, 1) * size * drawDirection<D>(draw), drawRotation<D>(draw)};
    out.views.push_back(view);
  }
  return out;
}

struct Asked {
  std::uint64_t counted = 0, calls = 0;  // a tested axis counts as a support point of each core
};

template <int D>
Asked ask(PairQuery<D>& method, const Pairs<D>& pairs, QueryNeed need) {
  std::vector<PairAnswer<D>> answers(pairs.views.size());
  WorkDone work;
  g_calls = 0;
  method.query(pairs.views, need, answers, {}, work);
  return {work[WorkCount::supportCalls] + 2 * work[WorkCount::axisTests], g_calls};
}

constexpr QueryNeed kNeeds[] = {QueryNeed::boolean, QueryNeed::distance, QueryNeed::closestPoints};

// Planted bug: one support point of A is not counted.
template <int D>
class InSecret final : public PairQuery<D> {
 public:
  explicit InSecret(PairQuery<D>& right) : m_right(right) {}
  bool supports(ShapeKind a, ShapeKind b) const override { return m_right.supports(a, b); }
  void query(std::span<const PairView<D>> pairs, QueryNeed need, std::span<PairAnswer<D>> answers,
             std::span<PairMemory> memory, WorkDone& work) override {
    m_right.query(pairs, need, answers, memory, work);
    coreSupport(pairs[0].a, answers[0].normal);
  }

 private:
  PairQuery<D>& m_right;
};

// On two curved cores, each call of a support point or support face is counted.
template <int D>
void allAreCounted() {
  int asked = 0;
  for (const Registered* r : Registry::instance().list(StageKind::pairQuery, D)) {
    if (r->info.role != AlgorithmRole::competitor) continue;
    std::vector<std::string> specs{r->info.name};
    for (const ParamInfo& p : r->params) {
      if (p.role != ParamRole::tolerance) continue;
      for (const char* value : {"1e-6", "0.1"}) specs.push_back(r->info.name + '{' + p.name + '=' + value + '}');
    }
    for (const std::string& spec : specs) {
      const auto method = createStage<PairQuery<D>>(Spec::parse(spec));
      for (const ShapeKind a : {ShapeKind::cylinder, ShapeKind::ellipsoid, ShapeKind::cone}) {
        for (const ShapeKind b : {ShapeKind::cylinder, ShapeKind::ellipsoid, ShapeKind::cone}) {
          if (!kindExists(a, D) || !kindExists(b, D) || a > b || !method->supports(a, b)) continue;
          const Pairs<D> pairs = drawPairs<D>(a, b, 100);
          for (const QueryNeed need : kNeeds) {
            const Asked seen = ask<D>(*method, pairs, need);
            EXPECT_EQ(seen.counted, seen.calls)
                << spec << ' ' << shapeKindName(a) << ' ' << shapeKindName(b) << ", need " << static_cast<int>(need);
            EXPECT_GT(seen.calls, 0u);
            InSecret<D> secret(*method);
            const Asked hidden = ask<D>(secret, pairs, need);
            EXPECT_NE(hidden.counted, hidden.calls) << "the planted bug was not caught";
          }
          ++asked;
        }
      }
    }
  }
  EXPECT_GE(asked, D == 2 ? 3 : 18);
  recordPlantedBug("counts: a support point in secret", 1, 100);
}
TEST(SupportCounts, AllAreCounted2) { allAreCounted<2>(); }
TEST(SupportCounts, AllAreCounted3) { allAreCounted<3>(); }

constexpr const char* kTolerances[] = {"0", "1e-12", "1e-9", "1e-6", "1e-4", "1e-3", "1e-2", "1e-1"};

template <int D>
std::unique_ptr<PairQuery<D>> made(const std::string& name, const std::string& tolerance) {
  return createStage<PairQuery<D>>(Spec::parse(name + "{tolerance=" + tolerance + "}"));
}

// Planted bug: counts a search for closest points in every band below the tolerance, too, with twenty points of each
// core.
template <int D>
class EveryBand final : public PairQuery<D> {
 public:
  EveryBand(const std::string& name, const std::string& tolerance)
      : m_right(made<D>(name, tolerance)), m_tolerance(std::stod(tolerance)) {}
  bool supports(ShapeKind a, ShapeKind b) const override { return m_right->supports(a, b); }
  void query(std::span<const PairView<D>> pairs, QueryNeed need, std::span<PairAnswer<D>> answers,
             std::span<PairMemory> memory, WorkDone& work) override {
    m_right->query(pairs, need, answers, memory, work);
    for (double band = 1e-14; band < m_tolerance; band *= 4) work[WorkCount::supportCalls] += 40 * pairs.size();
  }

 private:
  std::unique_ptr<PairQuery<D>> m_right;
  double m_tolerance;
};

// From one tolerance to the next looser one, the support points of all pairs grow by at most a fiftieth; at the end
// they are no more than at the start. `text`: their means.
template <int D, class Made>
bool loosenessIsFree(const Pairs<D>& pairs, QueryNeed need, std::string& text, const Made& method) {
  std::vector<std::uint64_t> counts;
  bool free = true;
  for (const char* tolerance : kTolerances) {
    counts.push_back(ask<D>(*method(tolerance), pairs, need).counted);
    text += ' ' + std::to_string(counts.back() / pairs.views.size());
    if (counts.size() > 1) free &= 50 * counts.back() <= 51 * counts[counts.size() - 2];
  }
  return free && counts.back() <= counts.front();
}

template <int D>
void looserAsksNoMore() {
  const std::pair<ShapeKind, ShapeKind> kinds[] = {
      {ShapeKind::ellipsoid, ShapeKind::ellipsoid}, {ShapeKind::polytope, ShapeKind::ellipsoid},
      {ShapeKind::box, ShapeKind::ellipsoid},       {ShapeKind::polytope, ShapeKind::polytope},
      {ShapeKind::cylinder, ShapeKind::cylinder},   {ShapeKind::cylinder, ShapeKind::cone}};
  for (const auto& [a, b] : kinds) {
    if (!kindExists(a, D) || !kindExists(b, D)) continue;
    const Pairs<D> pairs = drawPairs<D>(a, b, 200);
    for (const std::string name : {"gjk_epa", "mpr"}) {
      for (const QueryNeed need : kNeeds) {
        std::string text;
        EXPECT_TRUE(loosenessIsFree<D>(pairs, need, text, [&](const char* t) { return made<D>(name, t); }))
            << name << ' ' << shapeKindName(a) << ' ' << shapeKindName(b) << ", need " << static_cast<int>(need)
            << text;
      }
      std::string text;
      expectCaught("counts: bands below the tolerance, " + name,
                   loosenessIsFree<D>(pairs, QueryNeed::closestPoints, text,
                                      [&](const char* t) { return std::make_unique<EveryBand<D>>(name, t); }));
    }
  }
}
TEST(SupportCounts, LooserTolerancesNeedNoMore2) { looserAsksNoMore<2>(); }
TEST(SupportCounts, LooserTolerancesNeedNoMore3) { looserAsksNoMore<3>(); }

}  // namespace support_counts_test
}}}  // namespace lpc::LPC_PRECISION::test
