// SPDX-License-Identifier: Zlib
#include <cstring>

#include "algorithms/pair_query/curved_polish.h"
#include "algorithms/pair_query/epa3.h"
#include "algorithms/pair_query/gjk_simplex3.h"
#include "algorithms/pair_query/local_features.h"
#include "algorithms/pair_query/plane_pair.h"

namespace lpc::inline LPC_PRECISION {
namespace {

using namespace pair_query;

// Distance of the cores by GJK (Gilbert, Johnson, Keerthi 1988), depth by EPA (van den Bergen 2001), radii by
// subtraction. Both only propose directions: what is reported is the bound that the best of them proves (core_pair.h),
// and the gap to the length of GJK's vector is what decides whether that is the end. Where GJK cannot close the gap
// because its vector is made of rounding, EPA goes on from its simplex, whichever side of the surface the origin is on.
template <int D>
class GjkEpa final : public PairQuery<D> {
 public:
  struct Params {
    int iterations = 64;
    int faces = 1024;
    Real tolerance = 0;
    void visit(ParamVisitor& v) {
      v.integer("iterations", iterations, 1, 10000, "support points of GJK");
      v.integer("faces", faces, 8, 100000, "faces that EPA may make");
      v.real("tolerance", tolerance, 0, Real(0.1), "1",
             "gap of the distance that is left, against the largest coordinate; eight roundings at least");
    }
  };
  explicit GjkEpa(const Params& params) : m_params(params) {}

  static AlgorithmInfo info() {
    return {.name = "gjk_epa",
            .summary = "GJK for the distance and EPA for the depth of the cores",
            .paper = "gilbert1988",
            .complexity = "about 4 to 12 support points apart, 10 to 40 when penetrating"};
  }

  bool supports(ShapeKind a, ShapeKind b) const override { return !hasPlane(a, b) || supportsPlane(a, b); }

  void query(const PairBatch<D>& batch, QueryNeed need, PairAnswers<D>& answers, std::span<PairMemory> memory,
             WorkDone& work) override {
    work[WorkCount::pairQueries] += static_cast<std::uint64_t>(batch.count);
    for (int i = 0; i < batch.count; ++i) {
      const CorePair<D> pair(batch, i);
      if (hasPlane(batch.kindA, batch.kindB)) {
        answers.set(i, m_plane.answer(pair, work));
        continue;
      }
      PairMemory* remembered = memory.empty() ? nullptr : &memory[static_cast<std::size_t>(i)];
      BestAxis<D> best;
      const QueryStatus status = search(pair, need, remembered, best, work);
      if (remembered) remember(best.n, *remembered);
      if ((pair.a.curved || pair.b.curved) && need == QueryNeed::witnesses) m_polish.settle(pair, best, work);
      answers.set(i, answerFrom<D>(pair, best, status, need, m_touching));
    }
  }

 private:
  // A direction is enough of a memory: the first support along it is a vertex of the last answer's feature, and the
  // bound there often ends a boolean query at once.
  static Vec<D> firstDirection(const CorePair<D>& pair, const PairMemory* memory) {
    Vec<D> n = Vec<D>::Zero();
    if (memory) {
      static_assert(sizeof(Real) * 3 <= sizeof(PairMemory));
      std::array<Real, D> stored{};
      std::memcpy(stored.data(), memory->bytes.data(), sizeof(stored));
      for (int k = 0; k < D; ++k) n[k] = stored[static_cast<std::size_t>(k)];
      if (makeUnit<D>(n)) return n;
    }
    n = pair.p;
    if (!makeUnit<D>(n)) n = Vec<D>::Unit(0);
    return n;
  }
  static void remember(const Vec<D>& n, PairMemory& memory) {
    std::array<Real, D> stored{};
    for (int k = 0; k < D; ++k) stored[static_cast<std::size_t>(k)] = n[k];
    std::memcpy(memory.bytes.data(), stored.data(), sizeof(stored));
  }

  QueryStatus search(const CorePair<D>& pair, QueryNeed need, const PairMemory* memory, BestAxis<D>& best,
                     WorkDone& work) {
    const bool curved = pair.a.curved || pair.b.curved;
    const Real tolerance =
        std::max(m_params.tolerance, kBoundRounding) * pair.scale * (curved ? kCurvedTolerance : Real(1));
    const auto support = [&](const Vec<D>& n) {
      work[WorkCount::supportCalls] += 2;
      const Vec<D> w = pair.support(n);
      best.take(n, n.dot(w));
      return w;
    };
    Simplex<D> simplex;
    simplex.push(support(firstDirection(pair, memory)));
    NearestFeature<D> nearest;
    nearest.offer(simplex[0], {&simplex[0]});
    bool inside = false, capped = true;
    for (int i = 0; i < m_params.iterations; ++i) {
      const Real length = std::sqrt(nearest.length2);
      if (need == QueryNeed::boolean && (best.bound > pair.radii() || length < pair.radii())) {
        if (length < pair.radii()) best.bound = length;  // surely less than the radii: only the sign counts
        return QueryStatus::converged;
      }
      // Three ends, any of which alone can be missed by rounding: the gap is closed, no new point, no descent. The
      // length shows only the square of a direction's lean: a bound that gets better is a descent, too.
      Vec<D> n;
      if (length - best.bound <= tolerance || !featureDirection(nearest, n)) capped = false;
      if (!capped) break;
      const Real before = best.bound;
      const Vec<D> w = support(n);
      if (length - best.bound <= tolerance || nearest.feature.contains(w)) {
        capped = false;
        break;
      }
      simplex = nearest.feature;
      simplex.push(w);
      NearestFeature<D> next;
      inside = nearestOfSimplex(simplex, next);
      if (inside || (!(next.length2 < nearest.length2) && !(best.bound > before))) {
        capped = false;
        break;
      }
      nearest = next;
    }
    if (!inside && std::sqrt(nearest.length2) - best.bound <= tolerance) return QueryStatus::converged;
    if (inside && need == QueryNeed::boolean) return QueryStatus::converged;
    if (capped) return QueryStatus::iterationLimit;
    const EpaLimits limits{m_params.faces, tolerance};
    const QueryStatus status = m_epa.run(pair, simplex, limits, best, work);
    if (curved) m_polish.improve(pair, best, work);
    // Near contact rounding says on which side GJK's origin is: the bound knows better.
    const bool overlaps = best.bound < -tolerance || (inside && best.bound <= tolerance);
    // A needle of a face: the edges themselves, which are not rounded sums, give its normal.
    if (overlaps && m_epa.doubt() > kLeaning * tolerance) m_local.improve(pair, best.n, m_epa.doubt(), best, work);
    if constexpr (D == 3) {
      if (overlaps && best.bound > -kShallow * pair.scale) m_local.improveAcrossEdges(pair, best, work);
    }
    const Real length = std::sqrt(nearest.length2);
    const auto isShort = [&] { return !overlaps && length - best.bound > tolerance; };
    if (isShort()) m_local.improve(pair, best.n, length - best.bound, best, work);
    // The best direction may be an early one, and the last, which rounding spoilt, the nearer one.
    if (Vec<D> last; isShort() && featureDirection(nearest, last)) {
      m_local.improve(pair, last, length - pair.bound(last), best, work);
    }
    // A bound that is short by a part of the length means a direction that is off by the root of twice that part: where
    // the length is near rounding, the vertices to try lie far from the plane reached.
    if (isShort())
      m_local.improve(pair, best.n, std::sqrt(2 * (length - best.bound) / length) * pair.scale, best, work);
    return status;
  }

  Params m_params;
  Epa<D> m_epa;
  LocalFeatures<D> m_local;
  PlanePair<D> m_plane;
  CurvedPolish<D> m_polish;
  TouchingPoint m_touching;
};

}  // namespace

LPC_REGISTER(PairQuery, GjkEpa, 2, 3);

}  // namespace lpc::inline LPC_PRECISION
