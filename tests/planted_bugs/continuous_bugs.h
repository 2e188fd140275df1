// SPDX-License-Identifier: Zlib
// A method of continuous collision with one planted bug at a time, for pipelines: continuous=planted_continuous.
//
// Include it in one file of a test program.
#pragma once

#include <memory>

#include "framework/stage/stage_continuous.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test {

/// `cast` with one bug.
template <int D>
class PlantedContinuous final : public ContinuousCollision<D> {
 public:
  enum class Bug {
    none,
    late,         // the impact is a twentieth of the step late
    blindToFast,  // ignores pairs of two fast bodies
    stopsAtOnce,  // stops bodies that touch at the start
    stopsAll,     // stops every body near another
    onlyCentres,  // casts the inner balls instead of the shapes
    everyone      // no body is too slow to be cast
  };
  struct Params {
    Bug bug = Bug::none;
    void visit(ParamVisitor& v) {
      v.choice("bug", bug, {"none", "late", "blind_to_fast", "stops_at_once", "stops_all", "only_centres", "everyone"},
               "what is wrong");
    }
  };
  explicit PlantedContinuous(const Params& params)
      : m_bug(params.bug), m_right(createStage<ContinuousCollision<D>>({"cast", {}})) {}
  static AlgorithmInfo info() {
    return {.name = "planted_continuous",
            .summary = "planted bugs",
            .paper = "",
            .complexity = "that of cast",
            .role = AlgorithmRole::witness};
  }

  CcdPhase ccdPhase() const override { return CcdPhase::after; }
  Real threshold() const override { return m_bug == Bug::everyone ? Real(-1) : m_right->threshold(); }
  void timesOfImpact(std::span<const FastPair<D>> pairs, Real duration, std::span<Real> t, WorkDone& work) override {
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      FastPair<D> p = pairs[i];
      const Shape<D> a = Shape<D>::sphere(p.a.inner), b = Shape<D>::sphere(p.b.inner);
      if (m_bug == Bug::onlyCentres && p.pair.b.core() != CoreClass::plane) {
        if (p.fastA) p.pair.a = a.view();
        if (p.fastB) p.pair.b = b.view();
        if (p.pair.a.kind > p.pair.b.kind) {
          std::swap(p.pair.a, p.pair.b), std::swap(p.pair.A, p.pair.B), std::swap(p.a, p.b),
              std::swap(p.fastA, p.fastB);
        }
      }
      m_right->timesOfImpact({&p, 1}, duration, t.subspan(i, 1), work);
      if (m_bug == Bug::late) t[i] += duration / 20;
      if (m_bug == Bug::blindToFast && p.fastA && p.fastB) t[i] = std::numeric_limits<Real>::infinity();
      if (m_bug == Bug::stopsAll) t[i] = 0;
      if (m_bug == Bug::stopsAtOnce) {
        const PairView<D> view = p.pair.at(0);
        if (queryPair(*m_query, view.a, view.b, view.X_AB).distance <= Real(1e-3)) t[i] = 0;
      }
    }
  }

 private:
  Bug m_bug;
  std::unique_ptr<ContinuousCollision<D>> m_right;
  std::unique_ptr<PairQuery<D>> m_query = createStage<PairQuery<D>>({"gjk_epa", {}});
};

LPC_REGISTER(ContinuousCollision, PlantedContinuous, 2, 3);

}}}  // namespace lpc::LPC_PRECISION::test
