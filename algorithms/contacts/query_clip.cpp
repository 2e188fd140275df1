// SPDX-License-Identifier: Zlib
#include "algorithms/contacts/clip/query_clipper.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using namespace contacts;

template <int D>
class QueryClip final : public ContactGenerator<D> {
 public:
  struct Params {
    Spec query{"gjk_epa", {}};
    Real bias = kBias;
    Reduction reduction = Reduction::spread;
    void visit(ParamVisitor& v) {
      v.stage("query", query, StageKind::pairQuery, "pair query that gives distance, normal and closest points");
      v.real("bias", bias, 0, kLinearSlop, "m",
             "depths within this bias count as equal; so do corners within it beside a face");
      visitReduction(v, reduction);
    }
  };
  explicit QueryClip(const Params& params) : m_clipper(params.query, params.bias, params.reduction) {}

  static AlgorithmInfo info() {
    AlgorithmInfo out = {.name = "query_clip",
                         .summary = "contact normal from any pair query, then clips the two faces that meet along it",
                         .paper = "gregorius2015",
                         .complexity = "one pair query, f + c^2 for faces with c corners",
                         .failures = {{"a body more than halfway through a thin one",
                                       "the shortest way out is on the far side, so the body is pushed through",
                                       "Contacts.DeepBodiesGoBackWhereTheyCameFrom"}}};
    if constexpr (D == 3) declareNarrowRules(out.failures);
    return out;
  }

  bool supports(ShapeKind a, ShapeKind b) const override { return m_clipper.supports(a, b); }
  bool remembers() const override { return m_clipper.remembers(); }
  void generate(const ContactInput<D>& in, std::vector<Manifold<D>>& fresh, WorkDone& work) override {
    m_clipper.generate(in, fresh, work);
  }

 private:
  QueryClipper<D> m_clipper;
};

}  // namespace

LPC_REGISTER(ContactGenerator, QueryClip, 2, 3);

}}  // namespace lpc::LPC_PRECISION
