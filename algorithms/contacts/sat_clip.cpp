// SPDX-License-Identifier: Zlib
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

// The default generator: separating axes give the normal, clipping the facing faces gives the points.
template <int D>
class SatClip final : public ContactGenerator<D> {
 public:
  struct Params {
    Real bias = kBias;
    Reduction reduction = Reduction::spread;
    void visit(ParamVisitor& v) {
      v.real("bias", bias, 0, kLinearSlop, "m",
             "depths that differ by less are alike: faces win over edges, the first body over the second");
      visitReduction(v, reduction);
    }
  };
  explicit SatClip(const Params& params) : m_params(params) {}

  static AlgorithmInfo info() {
    AlgorithmInfo out = {
        .name = "sat_clip",
        .summary = "separating axis test, then clips the incident face against the reference face; no curved cores",
        .paper = "gregorius2013",
        .complexity = "f v + e^2 per pair of hulls, 15 axes per pair of boxes",
        .failures = {{"a body that is more than half through a thin one",
                      "the shortest way out is the far side: it is pushed through",
                      "Contacts.DeepBodiesGoBackWhereTheyCameFrom"}}};
    if constexpr (D == 3) declareNarrowRules(out.failures);
    return out;
  }

  bool supports(ShapeKind a, ShapeKind b) const override {
    const CoreClass first = coreClass(a), second = coreClass(b);
    if (first == CoreClass::curved || second == CoreClass::curved) return false;  // no list of axes
    return first != CoreClass::plane || second != CoreClass::plane;
  }

  void generate(const ContactInput<D>& in, std::vector<Manifold<D>>& fresh, WorkDone& work) override {
    work[WorkCount::pairQueries] += in.pairs.size();
    for (const ConvexPair<D>& pair : in.pairs) {
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
  }

 private:
  Params m_params;
  typename ScratchOf<D>::type m_scratch;
  PlaneScratch<D> m_plane;
};

}  // namespace

LPC_REGISTER(ContactGenerator, SatClip, 2, 3);

}}  // namespace lpc::LPC_PRECISION
