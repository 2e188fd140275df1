// SPDX-License-Identifier: Zlib
// What the framework does around the stages: proxies, default queries, single pairs.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "framework/stage/stage_broadphase.h"
#include "framework/stage/stage_narrowphase.h"
#include "tests/check_property.h"
#include "tests/generators.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace stages_test { namespace {

// --- broadphase -----------------------------------------------------------------------------------------------------

template <int D>
class DefaultQueries final : public Broadphase<D> {
 public:
  void findPairs(const Proxies<D>&, std::vector<ProxyPair>&, WorkDone&) override {}
};

template <int D>
Aabb<D> drawBox(Draw& draw) {
  const Vec<D> a = 3 * drawVector<D>(draw);
  Vec<D> size;
  for (int k = 0; k < D; ++k) size[k] = draw.pick({Real(0), draw.real(0, 2)});
  return {a, a + size};
}

TEST(Proxies, PaddingIsFreeAndTouchesNothing) {
  Proxies<3> p;
  p.resize(17);
  EXPECT_EQ(p.size(), 17);
  ASSERT_EQ(p.lo[0].size(), 32u);
  ASSERT_EQ(p.body.size(), 32u);
  p.body[3] = 5, p.active[3] = 1, p.category[3] = p.mask[3] = 1;
  p.setBox(3, {Vec<3>(1, 2, 3), Vec<3>(4, 5, 6)});
  EXPECT_EQ(p.box(3).hi, Vec<3>(4, 5, 6));
  for (ProxyId i = 0; i < 32; ++i) {
    EXPECT_EQ(p.isFree(i), i != 3);
    EXPECT_EQ(p.boxesOverlap(3, i) || p.boxesOverlap(i, i), i == 3) << i;
  }
  p.resize(40);
  EXPECT_EQ(p.box(3).lo, Vec<3>(1, 2, 3)) << "growing keeps what is there";
  p.resize(2);
  p.resize(17);
  EXPECT_TRUE(p.isFree(3)) << "shrinking frees";
  EXPECT_FALSE(p.active[3] || p.boxesOverlap(3, 3));
}

template <int D>
void defaultQueries() {
  const Real inf = std::numeric_limits<Real>::infinity();
  DefaultQueries<D> broadphase;
  Proxies<D> p;
  p.resize(3);
  for (ProxyId i : {0, 2}) {
    p.body[static_cast<std::size_t>(i)] = i;
    p.setBox(i, {Vec<D>::Constant(Real(i)), Vec<D>::Constant(Real(i + 1))});
  }
  std::vector<ProxyId> found;
  broadphase.overlap(p, {Vec<D>::Constant(-inf), Vec<D>::Constant(inf)}, found);
  EXPECT_EQ(found, (std::vector<ProxyId>{0, 2})) << "a free slot is in no box, not even in all of space";
  found.clear();
  broadphase.at(p, Vec<D>(Vec<D>::Ones()), found);
  EXPECT_EQ(found, (std::vector<ProxyId>{0})) << "closed";
  std::vector<RayHit<D>> hits;
  const Vec<D> from = Vec<D>::Constant(Real(3.5)), back = Vec<D>::Constant(Real(-1));
  broadphase.ray(p, from, back, Real(100), false, hits);
  ASSERT_EQ(hits.size(), 2u);
  hits.clear();
  broadphase.ray(p, from, back, Real(100), true, hits);
  ASSERT_EQ(hits.size(), 1u);
  EXPECT_EQ(hits[0].proxy, 2);
  EXPECT_EQ(hits[0].t, Real(0.5));
  hits.clear();
  broadphase.sweep(p, {Vec<D>::Constant(Real(5)), Vec<D>::Constant(Real(5.5))}, Vec<D>::Constant(Real(-4)), hits);
  ASSERT_EQ(hits.size(), 2u);
  EXPECT_EQ(hits[1].t, Real(0.5));
}
TEST(Broadphase, DefaultQueries) { defaultQueries<2>(), defaultQueries<3>(); }

// The sweep of a box agrees with the box at sampled times.
template <int D, class Sweep>
void sweepAgrees(Sweep sweep) {
  RapidCheckDraw draw;
  const Aabb<D> box = drawBox<D>(draw), target = drawBox<D>(draw);
  Vec<D> d = 6 * drawVector<D>(draw);
  if (draw.coin()) d[draw.below(D)] = 0;
  const Real t = sweep(box, d, target);
  const auto at = [&](Real s) { return Aabb<D>{Vec<D>(box.lo + s * d), Vec<D>(box.hi + s * d)}; };
  RC_ASSERT((t == 0) == box.overlaps(target));
  if (t >= 0) RC_ASSERT(at(t).grown(Real(32) * kEps * 10).overlaps(target));
  const Real end = t >= 0 ? t * (1 - 64 * kEps) : Real(1);
  for (int i = 0; i < 50; ++i) {
    if (t != 0) RC_ASSERT(!at(end * Real(i) / 50).grown(Real(-32) * kEps * 10).overlaps(target));
  }
}
template <int D>
void sweeps() {
  const auto sweep = [](const Aabb<D>& box, const Vec<D>& d, const Aabb<D>& target) {
    DefaultQueries<D> broadphase;
    Proxies<D> p;
    p.resize(1);
    p.body[0] = 0;
    p.setBox(0, target);
    std::vector<RayHit<D>> hits;
    broadphase.sweep(p, box, d, hits);
    return hits.empty() ? Real(-1) : hits[0].t;
  };
  check(
      "sweep", [=] { sweepAgrees<D>(sweep); }, 1000);
  expectFalsified("sweep of the box's middle", [] {
    sweepAgrees<D>([](const Aabb<D>& box, const Vec<D>& d, const Aabb<D>& target) {
      return castRay(target, box.center(), d, Real(1));
    });
  });
}
TEST(Broadphase, Sweep) { sweeps<2>(), sweeps<3>(); }

TEST(Broadphase, RaysAlongFaces) {
  const Aabb<2> box{Vec<2>(0, 0), Vec<2>(1, 1)};
  EXPECT_EQ(castRay(box, Vec<2>(-1, 1), Vec<2>(1, 0), Real(9)), 1) << "along a face";
  EXPECT_EQ(castRay(box, Vec<2>(-1, 2), Vec<2>(1, 0), Real(9)), -1);
  EXPECT_EQ(castRay(box, Vec<2>(1, 1), Vec<2>(1, 1), Real(9)), 0) << "leaving from a corner";
  EXPECT_EQ(castRay(box, Vec<2>(2, 0), Vec<2>(0, 0), Real(9)), -1);
  EXPECT_EQ(castRay(box, Vec<2>(-2, 0), Vec<2>(1, 0), Real(1)), -1) << "too short";
  EXPECT_EQ(castRay(Aabb<2>{}, Vec<2>(-2, 0), Vec<2>(1, 0), Real(9)), -1) << "the empty box";
}

// --- pairs ----------------------------------------------------------------------------------------------------------

// A hand-written query for spheres against spheres and capsules; supports (sphere, capsule) in this order only.
template <int D>
class SphereCapsule final : public PairQuery<D> {
 public:
  bool supports(ShapeKind a, ShapeKind b) const override { return a == ShapeKind::sphere && b <= ShapeKind::capsule; }
  void query(std::span<const PairView<D>> pairs, QueryNeed, std::span<PairAnswer<D>> answers, std::span<PairMemory>,
             WorkDone&) override {
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const PairView<D>& v = pairs[i];
      const Vec<D> axis = v.X_AB.q * Vec<D>(Vec<D>::Unit(0));
      const Vec<D> nearest = v.X_AB.p + std::clamp(-axis.dot(v.X_AB.p), -v.b.half[0], v.b.half[0]) * axis;
      PairAnswer<D> a;
      a.status = QueryStatus::converged;
      a.normal = nearest / nearest.norm();
      a.distance = nearest.norm() - v.a.radius - v.b.radius;
      a.pA = v.a.radius * a.normal, a.pB = a.pA + a.distance * a.normal;
      answers[i] = a;
    }
  }
};

template <int D, class Ask>
void eitherOrder(Ask ask) {
  RapidCheckDraw draw;
  const Shape<D> a = Shape<D>::sphere(Real(0.5)), b = Shape<D>::capsule(1, Real(0.25));
  Pose<D> X_AB = drawPose<D>(draw, 3);
  X_AB.p[0] += 4;  // apart: the normal is unique
  SphereCapsule<D> method;
  const PairAnswer<D> ab = ask(method, a, b, X_AB), ba = ask(method, b, a, X_AB.inverse());
  const Real tolerance = 64 * kEps * 10;
  RC_ASSERT(ab.status == QueryStatus::converged && ba.status == QueryStatus::converged);
  RC_ASSERT(std::abs(ab.distance - ba.distance) <= tolerance);
  RC_ASSERT((X_AB.q * ba.normal + ab.normal).norm() <= tolerance);
  RC_ASSERT((X_AB * ba.pA - ab.pB).norm() <= tolerance);
  RC_ASSERT((X_AB * ba.pB - ab.pA).norm() <= tolerance);
}
template <int D>
void pairs() {
  check("queryPair in either order", [] {
    eitherOrder<D>([](auto& m, auto& a, auto& b, const Pose<D>& X) { return queryPair(m, a.view(), b.view(), X); });
  });
  expectFalsified("the answer left in the other's frame", [] {
    eitherOrder<D>([](auto& m, auto& a, auto& b, const Pose<D>& X) {
      if (a.kind() <= b.kind()) return queryPair(m, a.view(), b.view(), X);
      auto answer = queryPair(m, b.view(), a.view(), X.inverse());
      answer.normal = -answer.normal;
      std::swap(answer.pA, answer.pB);
      return answer;
    });
  });
  SphereCapsule<D> method;
  const auto box = Shape<D>::box(Vec<D>::Ones());
  EXPECT_EQ(queryPair(method, box.view(), box.view(), Pose<D>{}).status, QueryStatus::refused);
}
TEST(PairQuery, EitherOrder) { pairs<2>(), pairs<3>(); }

TEST(PairQuery, StatusNames) {
  std::set<std::string_view> names;
  for (int i = 0; i < 5; ++i) names.insert(queryStatusName(static_cast<QueryStatus>(i)));
  EXPECT_EQ(names.size(), 5u);
  EXPECT_EQ(queryStatusName(QueryStatus::iterationLimit), "iteration_limit");
}

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::stages_test
