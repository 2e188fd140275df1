// SPDX-License-Identifier: Zlib
#include "algorithms/pair_query/gjk/gjk_epa.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using namespace pair_query;

// GJK, then EPA. The search is in gjk_epa.h.
template <int D>
class GjkEpa final : public PairQuery<D> {
 public:
  using Params = GjkEpaParams<D>;
  explicit GjkEpa(const Params& params) : m_params(params), m_search(params) {}

  static AlgorithmInfo info() {
    return {.name = "gjk_epa",
            .summary = "GJK for the distance, EPA for the penetration depth",
            .paper = "gilbert1988",
            .complexity = "about 4 to 12 support points when separated, 10 to 40 when penetrating",
            .failures = {{"simplex=johnson: hulls in single precision",
                          "the closest point is taken from the wrong simplex: off by a few 1/100,000 of the size",
                          "PairQuery.Properties3"},
                         {"simplex=signed_volumes: hulls in single precision",
                          "the closest point is taken from the wrong simplex: off by a few 1/100,000 of the size",
                          "PairQuery.Properties3"},
                         {"deep, nearly coaxial bodies of revolution",
                          "the depth of one pair in 3,000 is too large by up to a ten-millionth of the size",
                          "DeepCurvedPairs.SomeNearlyCoaxialBodiesAreAlmostRight"}}};
  }

  bool supports(ShapeKind a, ShapeKind b) const override { return !hasPlane(a, b) || supportsPlane(a, b); }

  bool remembers() const override { return true; }

  void query(std::span<const PairView<D>> pairs, QueryNeed need, std::span<PairAnswer<D>> answers,
             std::span<PairMemory> memory, WorkDone& work) override {
    work[WorkCount::pairQueries] += pairs.size();
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      answers[i] = m_search.answer(pairs[i], need, memory.empty() ? nullptr : &memory[i], work);
    }
  }

  bool traces(ShapeKind a, ShapeKind b) const override { return supports(a, b); }
  void trace(const PairView<D>& pair, PairTrace<D>& out) override { traceGjkEpa(m_params, pair, out); }

 private:
  Params m_params;
  GjkEpaSearch<D, NoWatch> m_search;
};

}  // namespace

LPC_REGISTER(PairQuery, GjkEpa, 2, 3);

}}  // namespace lpc::LPC_PRECISION
