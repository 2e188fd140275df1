// SPDX-License-Identifier: Zlib
#include "algorithms/contacts/patch/query_batches.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using namespace contacts;

// One contact point, the deepest. The baseline that shows why manifolds have several points.
template <int D>
class DeepestPoint final : public ContactGenerator<D> {
 public:
  struct Params {
    Spec query{"gjk_epa", {}};
    void visit(ParamVisitor& v) { v.stage("query", query, StageKind::pairQuery, "finds the witnesses"); }
  };
  explicit DeepestPoint(const Params& params) : m_batches(params.query) {}

  static AlgorithmInfo info() {
    return {.name = "deepest_point",
            .summary = "one contact per pair: the witnesses of the pair query",
            .paper = "vandenbergen2001",
            .complexity = "one pair query",
            .failures = {{"a body that is more than half through a thin one",
                          "the shortest way out is the far side: it is pushed through",
                          "Contacts.DeepBodiesGoBackWhereTheyCameFrom"},
                         {"a face that rests on a face", "one point cannot carry it: a box on a plane rocks for ever",
                          "Contacts.FaceContactsSpanThePatch"},
                         {"a face that rocks on a face", "the one point runs from corner to corner",
                          "Contacts.RockingFacesSpanThePatch"},
                         {"a face that slides on a face", "it drags on one point and turns about it",
                          "Contacts.FastFacesSpanThePatch"},
                         {"two edges that lie along each other", "one point instead of two",
                          "Contacts.ParallelEdgesTouchInTwoPoints"}}};
  }

  bool supports(ShapeKind a, ShapeKind b) const override { return m_batches.supports(a, b); }
  bool remembers() const override { return m_batches.remembers(); }

  void generate(const ContactInput<D>& in, std::vector<Manifold<D>>& fresh, WorkDone& work) override {
    m_batches.run(in, kBias, work, [&](const PlacedPair<D>& placed, const PairAnswer<D>& answer) {
      PatchPoint<D> point = witnessPoint(placed, answer);
      addPatch<D>(in, placed, answer.normal, {&point, 1}, fresh);
    });
  }

 private:
  QueryBatches<D> m_batches;
};

}  // namespace

LPC_REGISTER(ContactGenerator, DeepestPoint, 2, 3);

}}  // namespace lpc::LPC_PRECISION
