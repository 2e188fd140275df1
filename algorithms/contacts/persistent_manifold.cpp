// SPDX-License-Identifier: Zlib
#include "algorithms/contacts/patch/query_batches.h"
#include "algorithms/contacts/patch/reduction.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using namespace contacts;

// One new point per step, from any pair query; points of earlier steps are kept while their two anchors stay together.
// They are stored only in the world's manifolds.
//
// A kept point is never deeper than the shapes: its anchors lie in them, and along the normal of least depth no two of
// their points overlap more. Balls keep no points: they touch in one place, and roll.
template <int D>
class PersistentManifold final : public ContactGenerator<D> {
 public:
  struct Params {
    Spec query{"gjk_epa", {}};
    Real breaking = kContactMargin;
    Reduction reduction = Reduction::area;  // `spread` may leave three of five corners
    void visit(ParamVisitor& v) {
      v.stage("query", query, StageKind::pairQuery, "finds the one point of a step");
      v.real("breaking", breaking, 0, 1000, "m",
             "how far a point's anchors may slide apart, and how near to an old point a new one takes its place");
      visitReduction(v, reduction);
    }
  };
  explicit PersistentManifold(const Params& params) : m_params(params), m_batches(params.query) {}

  static AlgorithmInfo info() {
    AlgorithmInfo out = {
        .name = "persistent_manifold",
        .summary = "the witnesses of the pair query, and those of earlier steps that have not come apart",
        .paper = "bullet",
        .complexity = "one pair query, points squared",
        .failures = {{"a body that is more than half through a thin one",
                      "the shortest way out is the far side: it is pushed through",
                      "Contacts.DeepBodiesGoBackWhereTheyCameFrom"},
                     {"the first step of a face on a face", "one point: a box that falls flat tips before it rests",
                      "Contacts.FaceContactsSpanThePatch"},
                     {"the first step of two edges along each other", "one point instead of two",
                      "Contacts.ParallelEdgesTouchInTwoPoints"},
                     {"a face that slides over `breaking` in a step", "all points but that of the step are gone",
                      "Contacts.FastFacesSpanThePatch"}}};
    if constexpr (D == 3) declareNarrowRules(out.failures);
    return out;
  }

  bool supports(ShapeKind a, ShapeKind b) const override { return m_batches.supports(a, b); }
  bool remembers() const override { return m_batches.remembers(); }

  void generate(const ContactInput<D>& in, std::vector<Manifold<D>>& fresh, WorkDone& work) override {
    m_batches.run(in, kBias, work, [&](const PlacedPair<D>& placed, const PairAnswer<D>& answer) {
      PatchPoint<D> point = witnessPoint(placed, answer);
      addPatch<D>(in, placed, answer.normal, {&point, 1}, fresh);
      Manifold<D>& m = fresh.back();
      m.points[0].feature = 0;
      const auto old = std::partition_point(in.old.begin(), in.old.end(),
                                            [&](const Manifold<D>& other) { return other.key() < m.key(); });
      if (old == in.old.end() || old->key() != m.key()) return;
      const bool ball = placed.view1().core() == CoreClass::point || placed.view2().core() == CoreClass::point;
      if (!ball) merge(in, placed, *old, m);
    });
  }

 private:
  // Feature numbers count the points of a pair in order of age, so that among equally good points the older ones are
  // kept. No number of the last step is reused; impulses would otherwise move to another point.
  void merge(const ContactInput<D>& in, const PlacedPair<D>& placed, const Manifold<D>& old, Manifold<D>& m) {
    const Real breaking = std::min(
        m_params.breaking, kBreakingPart * std::min(boundingRadius(placed.view1()), boundingRadius(placed.view2())));
    const std::span<const ContactPoint<D>> known(old.points.data(), old.points.data() + old.count);
    ContactPoint<D>& found = m.points[0];
    const std::size_t same = nearest(known, found, breaking);
    found.feature = same < known.size() ? known[same].feature : freshNumber(known);
    m_points.assign(1, found);
    const Pose<D>&X_WA = in.pose[m.bodyA], &X_WB = in.pose[m.bodyB];
    // Computed as a generator would: far from the origin the sum of a position and an arm loses digits.
    const auto gapOf = [&](const ContactPoint<D>& p) -> Vec<D> {
      return (X_WB.p - X_WA.p) + (X_WB.q * p.localB - X_WA.q * p.localA);
    };
    for (std::size_t i = 0; i < known.size(); ++i) {
      const Vec<D> gap = gapOf(known[i]);
      const Real separation = gap.dot(m.normal);
      const bool stays = separation <= in.margin && (gap - separation * m.normal).norm() <= breaking;
      if (i == same || !stays) continue;
      m_points.emplace_back();
      ContactPoint<D>& p = m_points.back();
      p.localA = known[i].localA, p.localB = known[i].localB, p.separation = separation, p.feature = known[i].feature;
    }
    // Whatever wrote the old points, their numbers are sorted and distinct.
    std::sort(m_points.begin(), m_points.end(), [](const auto& p, const auto& q) { return p.feature < q.feature; });
    const auto alike = [](const auto& p, const auto& q) { return p.feature == q.feature; };
    m_points.erase(std::unique(m_points.begin(), m_points.end(), alike), m_points.end());
    m_patch.clear();
    for (const ContactPoint<D>& p : m_points) {
      const Vec<D> onA = X_WA.q * p.localA;
      m_patch.push_back({onA, onA + gapOf(p), p.separation, p.feature});
    }
    reducePatch(m_params.reduction, m.normal, placed.tolerance, m_patch);
    m.count = 0;
    for (const ContactPoint<D>& p : m_points) {
      const auto isIt = [&](const PatchPoint<D>& kept) { return kept.feature == p.feature; };
      if (std::any_of(m_patch.begin(), m_patch.end(), isIt)) m.points[m.count++] = p;
    }
  }

  // The old point that has stayed nearest on A or on B: a sliding corner keeps its place on its own body only. Returns
  // the number of old points if none is near.
  static std::size_t nearest(std::span<const ContactPoint<D>> known, const ContactPoint<D>& p, Real breaking) {
    std::size_t best = known.size();
    Real least = std::numeric_limits<Real>::infinity();
    for (std::size_t i = 0; i < known.size(); ++i) {
      const Real apart = std::min((known[i].localA - p.localA).norm(), (known[i].localB - p.localB).norm());
      if (apart <= breaking && apart < least) least = apart, best = i;
    }
    return best;
  }

  static std::uint64_t freshNumber(std::span<const ContactPoint<D>> known) {
    std::uint64_t number = 0;
    for (const ContactPoint<D>& p : known) number = std::max(number, p.feature);
    const auto taken = [&](const ContactPoint<D>& p) { return p.feature == number; };
    do {
      ++number;  // 0 follows the last number
    } while (std::any_of(known.begin(), known.end(), taken));
    return number;
  }

  Params m_params;
  QueryBatches<D> m_batches;
  std::vector<ContactPoint<D>> m_points;
  std::vector<PatchPoint<D>> m_patch;
};

}  // namespace

LPC_REGISTER(ContactGenerator, PersistentManifold, 2, 3);

}}  // namespace lpc::LPC_PRECISION
