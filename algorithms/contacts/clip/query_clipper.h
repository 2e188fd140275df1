// SPDX-License-Identifier: Zlib
#pragma once

#include "algorithms/contacts/clip/query_clip2.h"
#include "algorithms/contacts/clip/query_clip3.h"
#include "algorithms/contacts/patch/plane_patch.h"
#include "algorithms/contacts/patch/query_batches.h"

namespace lpc { inline namespace LPC_PRECISION { namespace contacts {

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

/// Contacts from any pair query: the query gives the direction, and clipping the faces that meet there gives the
/// points.
template <int D>
class QueryClipper {
 public:
  QueryClipper(const Spec& query, Real bias, Reduction reduction)
      : m_batches(query), m_bias(bias), m_reduction(reduction) {}

  bool supports(ShapeKind a, ShapeKind b) const { return m_batches.supports(a, b); }
  bool remembers() const { return m_batches.remembers(); }

  void generate(const ContactInput<D>& in, std::vector<Manifold<D>>& fresh, WorkDone& work) {
    m_batches.run(in, m_bias, work, [&](const PlacedPair<D>& placed, const PairAnswer<D>& answer) {
      if (hasPlane(placed)) {
        const Vec<D> down = planePatch(placed, m_reduction, m_plane, work);
        return addPatch<D>(in, placed, down, m_plane.points, fresh);
      }
      const Vec<D> n = answer.normal;
      const PatchPoint<D> witness = witnessPoint(placed, answer);
      addPatch<D>(in, placed, n, clipAlong(placed, n, witness, m_reduction, m_scratch, work), fresh);
    });
  }

 private:
  QueryBatches<D> m_batches;
  Real m_bias;
  Reduction m_reduction;
  typename QueryScratch<D>::type m_scratch;
  PlaneScratch<D> m_plane;
};

}}}  // namespace lpc::LPC_PRECISION::contacts
