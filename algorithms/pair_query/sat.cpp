// SPDX-License-Identifier: Zlib
#include "algorithms/pair_query/lanes/pair_lanes.h"
#include "algorithms/pair_query/sat/sat_answers.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using namespace pair_query;

// All separating axes: face normals, and in 3D the common normals of two edges, which the 2009 engine got wrong. For
// cores that are apart the directions between the nearest vertices and edges are tested too, so that the answer is the
// signed distance in both regimes instead of the lower bound of the axes alone.
template <int D>
class Sat final : public PairQuery<D> {
 public:
  struct Params {
    LaneUse lanes = LaneUse::automatic;
    void visit(ParamVisitor& v) { visitLanes(v, lanes); }
  };
  explicit Sat(const Params& params) : m_lanes(params.lanes) {}

  static AlgorithmInfo info() {
    return {
        .name = "sat",
        .summary = "separating axes: face normals, edge-edge normals, and nearest vertices when apart; no curved cores",
        .paper = "gottschalk1996",
        .complexity =
            "boxes O(1); polytopes faces + edges, and for the few that may prove more than the best the vertices"};
  }

  bool supports(ShapeKind a, ShapeKind b) const override {
    if (coreClass(a) == CoreClass::curved || coreClass(b) == CoreClass::curved) return false;
    return !hasPlane(a, b) || supportsPlane(a, b);
  }

  bool remembers() const override { return D == 3; }

  bool traces(ShapeKind a, ShapeKind b) const override { return supports(a, b); }
  void trace(const PairView<D>& pair, PairTrace<D>& out) override { traceSat(pair, out); }

  void query(std::span<const PairView<D>> pairs, QueryNeed need, std::span<PairAnswer<D>> answers,
             std::span<PairMemory> memory, WorkDone& work) override {
    work[WorkCount::pairQueries] += pairs.size();
    if (pairs.empty()) return;
    const bool boxes = pairs[0].a.core() == CoreClass::box && pairs[0].b.core() == CoreClass::box;
    if (!boxes) return oneByOne(pairs, need, answers, memory, work);
    forMostInLanes<D>(
        m_lanes, pairs, answers,
        [&](std::span<const PairView<3>> some, std::span<PairAnswer<3>> out) {
          return boxesInLanes(some, need, out, work);
        },
        [&](std::span<const PairView<D>> some, std::span<PairAnswer<D>> out) {
          oneByOne(some, need, out, {}, work);  // nothing is remembered of boxes
        });
  }

 private:
  void oneByOne(std::span<const PairView<D>> pairs, QueryNeed need, std::span<PairAnswer<D>> answers,
                std::span<PairMemory> memory, WorkDone& work) {
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      m_axes.answer(pairs[i], need, memory.empty() ? nullptr : &memory[i], answers[i], work);
    }
  }

  LaneUse m_lanes;
  SatAnswers<D, NoWatch> m_axes;
};

}  // namespace

LPC_REGISTER(PairQuery, Sat, 2, 3);

}}  // namespace lpc::LPC_PRECISION
