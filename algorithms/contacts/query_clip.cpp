// SPDX-License-Identifier: Zlib
#include "algorithms/contacts/clip/query_clip2.h"
#include "algorithms/contacts/clip/query_clip3.h"
#include "algorithms/contacts/patch/plane_patch.h"
#include "algorithms/contacts/patch/query_batches.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using namespace contacts;

template <int D>
struct QueryScratch;
template <>
struct QueryScratch<2> {
  using type = QueryClipScratch2;
};
template <>
struct QueryScratch<3> {
  using type = QueryClipScratch3;
};

// Contacts from any pair query: the query gives the direction, and clipping the faces that meet there gives the points.
template <int D>
class QueryClip final : public ContactGenerator<D> {
 public:
  struct Params {
    Spec query{"gjk_epa", {}};
    Real bias = kBias;
    Reduction reduction = Reduction::spread;
    void visit(ParamVisitor& v) {
      v.stage("query", query, StageKind::pairQuery, "gives distance, normal and witnesses");
      v.real("bias", bias, 0, kLinearSlop, "m",
             "depths that differ by less are alike; corners beside a face by less, too");
      visitReduction(v, reduction);
    }
  };
  explicit QueryClip(const Params& params) : m_params(params), m_batches(params.query) {}

  static AlgorithmInfo info() {
    AlgorithmInfo out = {.name = "query_clip",
                         .summary = "any pair query for the normal, then clips the two faces that meet along it",
                         .paper = "gregorius2015",
                         .complexity = "one pair query, f + c^2 for faces with c corners",
                         .failures = {{"a body that is more than half through a thin one",
                                       "the shortest way out is the far side: it is pushed through",
                                       "Contacts.DeepBodiesGoBackWhereTheyCameFrom"}}};
    if constexpr (D == 3) declareNarrowRules(out.failures);
    return out;
  }

  bool supports(ShapeKind a, ShapeKind b) const override { return m_batches.supports(a, b); }
  bool remembers() const override { return m_batches.remembers(); }

  void generate(const ContactInput<D>& in, std::vector<Manifold<D>>& fresh, WorkDone& work) override {
    m_batches.run(in, m_params.bias, work, [&](const PlacedPair<D>& placed, const PairAnswer<D>& answer) {
      if (hasPlane(placed)) {
        const Vec<D> down = planePatch(placed, m_params.reduction, m_plane, work);
        return addPatch<D>(in, placed, down, m_plane.points, fresh);
      }
      const Vec<D> n = answer.normal;
      const PatchPoint<D> witness = witnessPoint(placed, answer);
      addPatch<D>(in, placed, n, clipAlong(placed, n, witness, m_params.reduction, m_scratch, work), fresh);
    });
  }

 private:
  Params m_params;
  QueryBatches<D> m_batches;
  typename QueryScratch<D>::type m_scratch;
  PlaneScratch<D> m_plane;
};

}  // namespace

LPC_REGISTER(ContactGenerator, QueryClip, 2, 3);

}}  // namespace lpc::LPC_PRECISION
