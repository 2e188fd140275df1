// SPDX-License-Identifier: Zlib
#include "algorithms/contacts/clip/query_clipper.h"
#include "algorithms/contacts/patch/plane_patch.h"
#include "algorithms/contacts/sat/sat_collide2.h"
#include "algorithms/contacts/sat/sat_collide3.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using namespace contacts;

template <int D>
struct ScratchOf;
template <>
struct ScratchOf<2> {
  using type = Scratch2;
};
template <>
struct ScratchOf<3> {
  using type = Scratch3;
};

// The default generator: separating axes give the normal, clipping the facing faces gives the points. A curved core has
// no list of axes, so query_clip makes its contacts, without pair memory: keeping memory would cost all other pairs
// time.
template <int D>
class SatClip final : public ContactGenerator<D> {
 public:
  struct Params {
    Real bias = kBias;
    Reduction reduction = Reduction::spread;
    void visit(ParamVisitor& v) {
      v.real("bias", bias, 0, kLinearSlop, "m",
             "depths within this bias count as equal: faces are preferred to edges, the first body to the second");
      visitReduction(v, reduction);
    }
  };
  explicit SatClip(const Params& params)
      : m_params(params), m_curved(Spec{"by_kind", {}}, params.bias, params.reduction) {}

  static AlgorithmInfo info() {
    AlgorithmInfo out = {
        .name = "sat_clip",
        .summary =
            "separating axis test, then clips the incident face against the reference face; curved cores as "
            "query_clip{query=by_kind}",
        .paper = "gregorius2013",
        .complexity = "f v + e^2 per pair of hulls, 15 axes per pair of boxes",
        .failures = {{"a body more than halfway through a thin one",
                      "the shortest way out is on the far side, so the body is pushed through",
                      "Contacts.DeepBodiesGoBackWhereTheyCameFrom"}}};
    if constexpr (D == 3) declareNarrowRules(out.failures);
    return out;
  }

  bool supports(ShapeKind a, ShapeKind b) const override {
    return isCurved(a, b) ? m_curved.supports(a, b)
                          : coreClass(a) != CoreClass::plane || coreClass(b) != CoreClass::plane;
  }

  void generate(const ContactInput<D>& in, std::vector<Manifold<D>>& fresh, WorkDone& work) override {
    m_curvedPairs.clear();
    for (const ConvexPair<D>& pair : in.pairs) {
      if (isCurved(pair.a.kind, pair.b.kind)) {
        m_curvedPairs.push_back(pair);
        continue;
      }
      ++work[WorkCount::pairQueries];
      const PlacedPair<D> placed = placePair(in, pair, m_params.bias);
      if (hasPlane(placed)) {
        const Vec<D> n = planePatch(placed, m_params.reduction, m_plane, work);
        addPatch<D>(in, placed, n, m_plane.points, fresh);
        continue;
      }
      satCollide(placed, m_scratch, work);
      const auto points = patchPoints(m_scratch, placed.tolerance, m_params.reduction);
      addPatch(in, placed, patchNormal(m_scratch), points, fresh);
    }
    if (m_curvedPairs.empty()) return;
    ContactInput<D> rest = in;
    rest.pairs = m_curvedPairs;
    m_curved.generate(rest, fresh, work);
  }

 private:
  static bool isCurved(ShapeKind a, ShapeKind b) {
    return coreClass(a) == CoreClass::curved || coreClass(b) == CoreClass::curved;
  }

  Params m_params;
  typename ScratchOf<D>::type m_scratch;
  PlaneScratch<D> m_plane;
  QueryClipper<D> m_curved;
  IndexedVector<ConvexPair<D>> m_curvedPairs;
};

}  // namespace

LPC_REGISTER(ContactGenerator, SatClip, 2, 3);

}}  // namespace lpc::LPC_PRECISION
