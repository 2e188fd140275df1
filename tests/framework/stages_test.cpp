// SPDX-License-Identifier: Zlib
// What the framework does around the stages: proxies and default queries, single pairs, islands, forces.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "framework/force.h"
#include "framework/stage_broadphase.h"
#include "framework/stage_narrowphase.h"
#include "framework/stage_sleep.h"
#include "tests/check_property.h"
#include "tests/generators.h"

namespace lpc::inline LPC_PRECISION::test {
namespace {

// --- broadphase
// -------------------------------------------------------------------------------------------------------

template <int D>
class DefaultQueries final : public Broadphase<D> {
 public:
  void findPairs(const Proxies<D>&, std::vector<ProxyPair>&, Work&) override {}
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

// The sweep of a box is what the box does at sampled times.
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

// --- pairs
// ------------------------------------------------------------------------------------------------------------

// Spheres against spheres and capsules by hand: supports (sphere, capsule) in this order only.
template <int D>
class SphereCapsule final : public PairQuery<D> {
 public:
  bool supports(ShapeKind a, ShapeKind b) const override { return a == ShapeKind::sphere && b <= ShapeKind::capsule; }
  void query(const PairBatch<D>& batch, Need, PairAnswers<D>& answers, std::span<PairMemory>, Work&) override {
    for (int i = 0; i < batch.count; ++i) {
      const PairView<D> v = batch.pair(i);
      // The rotation of the batch is the pose's, row by row.
      for (int row = 0; row < D; ++row) {
        for (int column = 0; column < D; ++column) {
          const auto k = static_cast<std::size_t>(row * D + column);
          EXPECT_EQ(batch.r[k][static_cast<std::size_t>(i)], v.X_AB.q.matrix()(row, column));
        }
      }
      const Vec<D> axis = v.X_AB.q * Vec<D>(Vec<D>::Unit(0));
      const Vec<D> nearest = v.X_AB.p + std::clamp(-axis.dot(v.X_AB.p), -v.b.half[0], v.b.half[0]) * axis;
      PairAnswer<D> a;
      a.status = QueryStatus::converged;
      a.normal = nearest / nearest.norm();
      a.distance = nearest.norm() - v.a.radius - v.b.radius;
      a.pA = v.a.radius * a.normal, a.pB = a.pA + a.distance * a.normal;
      answers.set(i, a);
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

TEST(PairBatch, GivesBackWhatWasAdded) {
  auto batch = std::make_unique<PairBatch<3>>();
  PlainDraw draw(1);
  std::vector<Shape<3>> a, b;
  std::vector<Pose<3>> X;
  for (int round = 0; round < 2; ++round) {
    batch->clear(ShapeKind::box, ShapeKind::polytope);
    a.clear(), b.clear(), X.clear();
    for (int i = 0; i < 20; ++i) {
      a.push_back(drawSketch<3>(draw, ShapeKind::box).build(1));
      b.push_back(drawSketch<3>(draw, ShapeKind::polytope).build(1));
      X.push_back(drawPose<3>(draw, 3));
      batch->add(a.back().view(), b.back().view(), X.back());
    }
    for (int i = 0; i < 20; ++i) {
      const auto n = static_cast<std::size_t>(i);
      const PairView<3> v = batch->pair(i);
      EXPECT_EQ(v.a.half, a[n].view().half);
      EXPECT_EQ(v.b.hull, b[n].view().hull);
      EXPECT_EQ(v.b.radius, b[n].view().radius);
      EXPECT_EQ(v.X_AB.p, X[n].p);
      EXPECT_EQ(v.X_AB.q.w, X[n].q.w);
    }
  }
}

// --- islands
// ----------------------------------------------------------------------------------------------------------

TEST(Islands, AnyGraph) {
  check(
      "equal to walking from body to body",
      [] {
        RapidCheckDraw draw;
        const int n = 1 + draw.below(12);
        Bodies<2> bodies;
        for (int i = 0; i < n; ++i) {
          bodies.pose.emplace_back();
          bodies.used.push_back(draw.below(8) != 1);
          bodies.type.push_back(
              draw.pick({BodyType::dynamic, BodyType::dynamic, BodyType::fixed, BodyType::kinematic}));
        }
        std::vector<Manifold<2>> manifolds;
        std::vector<PivotJoint<2>> joints(1);  // a free one
        std::vector<std::pair<int, int>> links;
        for (int k = draw.below(15); k > 0; --k) {
          const int a = draw.below(n), b = draw.below(n);
          if (a == b) continue;
          const int kind = draw.below(3);
          if (kind == 0) {
            joints.emplace_back();
            joints.back().bodyA = a, joints.back().bodyB = b;
          } else {
            manifolds.emplace_back();
            manifolds.back().bodyA = std::min(a, b), manifolds.back().bodyB = std::max(a, b);
            manifolds.back().ignored = kind == 2;
          }
          if (kind != 2) links.emplace_back(a, b);
        }
        const auto in = [&](int i) {
          return bodies.used[static_cast<std::size_t>(i)] &&
                 bodies.type[static_cast<std::size_t>(i)] == BodyType::dynamic;
        };
        std::vector<std::int32_t> expected(static_cast<std::size_t>(n), -1);
        std::int32_t next = 0;
        for (int i = 0; i < n; ++i) {
          if (!in(i) || expected[static_cast<std::size_t>(i)] >= 0) continue;
          expected[static_cast<std::size_t>(i)] = next;
          for (int round = 0; round < n; ++round) {
            for (const auto& [a, b] : links) {
              for (const auto& [from, to] : {std::pair(a, b), std::pair(b, a)}) {
                if (in(from) && in(to) && expected[static_cast<std::size_t>(from)] == next) {
                  expected[static_cast<std::size_t>(to)] = next;
                }
              }
            }
          }
          ++next;
        }
        RC_ASSERT(islands<2>(bodies, manifolds, joints) == expected);
      },
      500);
}

// --- forces
// -----------------------------------------------------------------------------------------------------------

template <int D>
struct TwoBodies {
  Bodies<D> bodies;
  std::vector<Wrench<D>> out;
  TwoBodies() : out(2) {
    bodies.pose.resize(2), bodies.motion.resize(2), bodies.generation = {1, 1}, bodies.used = {1, 1};
    bodies.type = {BodyType::dynamic, BodyType::dynamic};
  }
  void apply(const ForceGenerator<D>& f) { f.apply({bodies, bodies.pose, bodies.motion}, 0, out); }
};

template <int D>
void spring() {
  check("a spring pulls both with one force on one line", [] {
    RapidCheckDraw draw;
    TwoBodies<D> s;
    Spring<D> spring;
    spring.bodyA = {0, 1}, spring.bodyB = {1, 1};
    spring.localA = drawVector<D>(draw), spring.localB = drawVector<D>(draw);
    spring.stiffness = 10, spring.damping = 2, spring.restLength = draw.real(0, 2);
    for (std::size_t i = 0; i < 2; ++i) {
      s.bodies.pose[i] = drawPose<D>(draw, 3);
      s.bodies.motion[i].v = drawVector<D>(draw), s.bodies.motion[i].w.setConstant(draw.signedUnit());
    }
    s.apply(spring);
    RC_ASSERT((s.out[0].force + s.out[1].force).norm() == 0);
    // No torque about the origin in all: both forces act along the same line.
    const Ang<D> total = s.out[0].torque + cross(s.bodies.pose[0].p, s.out[0].force) + s.out[1].torque +
                         cross(s.bodies.pose[1].p, s.out[1].force);
    RC_ASSERT(total.norm() <= 1000 * kEps * (1 + s.out[0].force.norm()));
  });
  TwoBodies<D> s;
  s.bodies.pose[1].p[0] = 3;
  s.bodies.motion[1].v[0] = 2;
  Spring<D> spring;
  spring.bodyA = {0, 1}, spring.bodyB = {1, 1};
  spring.stiffness = 10, spring.restLength = 1, spring.damping = 5;
  s.apply(spring);
  EXPECT_EQ(s.out[0].force[0], 30) << "stretched by 2, and getting longer";
  s.out.assign(2, {});
  spring.bodyA = {};
  spring.localA[0] = 5;  // now a point of the world
  s.apply(spring);
  EXPECT_EQ(s.out[1].force[0], 10 + -5 * 2);
  s.out.assign(2, {});
  spring.bodyB = {1, 2};  // another tenant of that slot
  s.apply(spring);
  EXPECT_EQ(s.out[1].force.norm(), 0);
}
TEST(Force, Spring) { spring<2>(), spring<3>(); }

TEST(Force, Drag) {
  TwoBodies<3> s;
  s.bodies.type[1] = BodyType::kinematic;
  s.bodies.motion[0].v = Vec<3>(3, 0, 4), s.bodies.motion[0].w = Ang<3>(0, 2, 0);
  s.bodies.motion[1].v = Vec<3>(1, 1, 1);
  Drag<3> drag;
  drag.linear = 1, drag.quadratic = Real(0.5);
  s.apply(drag);
  EXPECT_EQ(s.out[0].force, Vec<3>(Vec<3>(3, 0, 4) * Real(-3.5)));
  EXPECT_EQ(s.out[0].torque, Ang<3>(0, -4, 0));
  EXPECT_EQ(s.out[1].force.norm(), 0);
}

}  // namespace
}  // namespace lpc::inline LPC_PRECISION::test
