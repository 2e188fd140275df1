// SPDX-License-Identifier: Zlib
#include <memory>

#include "framework/stage/registry.h"
#include "framework/stage/stage_narrowphase.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

// Dispatches as engines do: for each pair of kinds the fastest measured method that is exact on it
// (docs/pair_queries.md). That is a closed form if there is one, SAT for boxes and in 2D for all shapes with edges, and
// one general method for the rest.
template <int D>
class ByKind final : public PairQuery<D> {
 public:
  struct Params {
    void visit(ParamVisitor&) {}
  };
  explicit ByKind(const Params&) {}

  static AlgorithmInfo info() {
    return {.name = "by_kind",
            .summary = "closed_form where it has a formula, sat for boxes and in 2D for polygons, gjk_epa for the rest",
            .paper = "ericson2004",
            .complexity = "as the method that is asked"};
  }

  bool supports(ShapeKind a, ShapeKind b) const override {
    return m_formulas->supports(a, b) || m_rest->supports(a, b);
  }

  bool traces(ShapeKind a, ShapeKind b) const override { return chosen(a, b).traces(a, b); }
  void trace(const PairView<D>& pair, PairTrace<D>& out) override { chosen(pair.a.kind, pair.b.kind).trace(pair, out); }

  // A pair keeps its kinds, and with them its method, so no method reads what another has written. In 2D only curved
  // pairs would be remembered.
  bool remembers() const override { return D == 3; }

  void query(std::span<const PairView<D>> pairs, QueryNeed need, std::span<PairAnswer<D>> answers,
             std::span<PairMemory> memory, WorkDone& work) override {
    if (!pairs.empty()) chosen(pairs[0].a.kind, pairs[0].b.kind).query(pairs, need, answers, memory, work);
  }

 private:
  PairQuery<D>& chosen(ShapeKind a, ShapeKind b) const {
    if (m_formulas->supports(a, b)) return *m_formulas;
    const bool boxes = coreClass(a) == CoreClass::box && coreClass(b) == CoreClass::box;
    if (boxes || (D == 2 && m_axes->supports(a, b))) return *m_axes;
    return *m_rest;
  }

  std::unique_ptr<PairQuery<D>> m_formulas = createStage<PairQuery<D>>(Spec{"closed_form", {}}),
                                m_axes = createStage<PairQuery<D>>(Spec{"sat", {}}),
                                m_rest = createStage<PairQuery<D>>(Spec{"gjk_epa", {}});
};

}  // namespace

LPC_REGISTER(PairQuery, ByKind, 2, 3);

}}  // namespace lpc::LPC_PRECISION
