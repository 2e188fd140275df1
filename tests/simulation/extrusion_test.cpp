// SPDX-License-Identifier: Zlib
// A planar scene and its extrusion to prisms move alike under every solver. A prism face has four contact points where
// its base has two, so impulses are distributed differently and per-contact effects count twice. Iterative methods get
// enough iterations to converge. Methods that sweep once per sub-step, or have soft contacts, have a wider bound.
#include <gtest/gtest.h>

#include <cstdlib>
#include <limits>
#include <map>

#include "tests/every_solver.h"
#include "tests/expect_caught.h"
#include "tests/small_worlds.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace extrusion_test { namespace {

constexpr Real kDt = Real(1) / 60;
constexpr Real kHalfDepth = 1;  // m: twice as deep as wide
constexpr int kSteps = 60, kSweeps = 50;

// Boxes in the plane, or prisms of the same mass, 2 m deep, on a ground 8 m deep.
template <int D>
struct Prisms {
  World<D> world;
  std::vector<BodyHandle> boxes;
  bool spoiled;  // a fiftieth of each mass sits at the ends of its box: wrong inertia

  explicit Prisms(const Spec& solver, bool spoil = false) : world(pipelineOf(solver)), spoiled(spoil) {}

  static Pipeline pipelineOf(const Spec& solver) {
    Pipeline p;
    p[StageKind::solver] = solver;
    return p;
  }
  BodyDef<D> prism(double halfWidth, double halfHeight, double x, double y, double angle, double friction,
                   Real halfDepth) const {
    Vec<D> half = Vec<D>::Constant(halfDepth);
    half[0] = Real(halfWidth), half[1] = Real(halfHeight);
    BodyDef<D> def = body<D>(Shape<D>::box(half), at<D>(x, y));
    if constexpr (D == 2) {
      def.X_WB.q = Rot<2>::angle(Real(angle));
    } else {
      def.X_WB.q = Rot<3>::vector({0, 0, Real(angle)});
      def.shapes[0].density = 1 / (2 * halfDepth);
    }
    def.shapes[0].friction = Real(friction);
    return def;
  }
  BodyHandle ground(double halfWidth, double x, double y, double angle = 0, double friction = 0.5) {
    BodyDef<D> def = prism(halfWidth, 1, x, y, angle, friction, 4 * kHalfDepth);
    def.type = BodyType::fixed;
    return world.add(def);
  }
  BodyHandle box(double halfWidth, double halfHeight, double x, double y, double angle = 0) {
    BodyDef<D> def = prism(halfWidth, halfHeight, x, y, angle, 0.5, kHalfDepth);
    if (spoiled) spoil(def, halfWidth, halfHeight);
    boxes.push_back(world.add(def));
    return boxes.back();
  }
  static void spoil(BodyDef<D>& def, double halfWidth, double halfHeight) {
    const Real radius = Real(0.01), volume = D == 3 ? Real(4.0 / 3 * 3.14159265) * radius * radius * radius : 0;
    for (int side : {-1, 1}) {
      ShapeDef<D> ball{.shape = Shape<D>::sphere(radius)};
      ball.X_BS.p = at<D>(side * halfWidth, 0);
      ball.density = Real(0.04 * halfWidth * halfHeight) / volume, ball.mask = 0;
      def.shapes.push_back(ball);
    }
    def.shapes[0].density *= Real(0.98);
  }
};

template <int D>
void stack(Prisms<D>& s) {
  s.ground(20, 0, -1);
  for (int i = 0; i < 4; ++i) s.box(0.5, 0.25, 0.05 * (i % 2), 0.25 + 0.501 * i);
}
template <int D>
void slope(Prisms<D>& s) {  // 30 degrees, mu 0.3
  const double angle = 0.5235987755982988, mu = 0.3;
  s.ground(20, -std::sin(angle), -std::cos(angle), -angle, mu * mu / 0.5);
  s.box(0.5, 0.25, 0.25 * std::sin(angle), 0.25 * std::cos(angle), -angle);
}
template <int D>
void edge(Prisms<D>& s) {  // its centre of mass is past the table's edge
  s.ground(2, -2, -1);
  s.box(0.5, 0.25, 0.1, 0.25);
}
template <int D>
void hinges(Prisms<D>& s) {  // two in a row, released in a level position
  const BodyHandle post = s.ground(0.1, 0, 5), first = s.box(0.3, 0.1, 0.3, 3), second = s.box(0.3, 0.1, 0.9, 3);
  s.world.add(JointDef<D>{.kind = "hinge", .bodyA = post, .bodyB = first, .X_WJ = {at<D>(0, 3), {}}});
  s.world.add(JointDef<D>{.kind = "hinge", .bodyA = first, .bodyB = second, .X_WJ = {at<D>(0.6, 3), {}}});
}

struct Scene {
  const char* name;
  void (*flat)(Prisms<2>&);
  void (*deep)(Prisms<3>&);
  double swept, giving;  // largest allowed distance between prism and base, m
};
// Worst of the iterative methods, scene by scene: jacobi; admm, to rounding; catto with symmetric sweeps; avbd with
// penalties that use the mean over D directions. Worst of the others: tgs_ngs, xpbd and xpbd; their hinges agree to
// rounding.
const Scene kScenes[] = {{"stack", stack<2>, stack<3>, 2e-3, 8e-3},
                         {"slope", slope<2>, slope<3>, 1e-10, 8e-4},
                         {"edge", edge<2>, edge<3>, 4e-4, 5e-2},
                         {"hinges", hinges<2>, hinges<3>, 8e-6, 1e-12}};

// Largest distance between corresponding bodies (m). Rotation counts as the motion of a point 0.5 m from the centre.
double apart(const Prisms<2>& flat, const Prisms<3>& deep) {
  double most = 0;
  for (std::size_t i = 0; i < flat.boxes.size(); ++i) {
    const Pose<2> p = flat.world.pose(flat.boxes[i]);
    const Pose<3> q = deep.world.pose(deep.boxes[i]);
    Mat<3> turn = Mat<3>::Identity();
    turn.topLeftCorner<2, 2>() = p.q.matrix();
    const double way = (q.p - at<3>(p.p[0], p.p[1])).norm(), turned = (q.q.matrix() - turn).norm() / std::sqrt(2.0);
    if (!std::isfinite(way + turned)) return std::numeric_limits<double>::infinity();
    most = std::max(most, way + turned / 2);
  }
  return most;
}
double mostApart(const Spec& solver, const Scene& scene, bool spoil = false) {
  Prisms<2> flat(solver);
  Prisms<3> deep(solver, spoil);
  scene.flat(flat), scene.deep(deep);
  double most = 0;
  for (int i = 0; i < kSteps; ++i) {
    flat.world.step(kDt), deep.world.step(kDt);
    most = std::max(most, apart(flat, deep));
  }
  return most;
}

// The method and its parts with kSweeps iterations. A method that iterates to a tolerance keeps it, and declares a
// failure where the tolerance is too loose. A limit of moves that contacts share must serve twice as many contacts in
// 3D.
Spec often(StageKind stage, Spec spec) {
  const Registered& method = Registry::instance().find(stage, 3, spec.name);
  const ParamInfo* const effort = firstOf(ParamRole::effort, method.params);
  const bool perContact = effort && effort->type == "real";
  for (const ParamInfo& p : method.params) {
    if (p.role == ParamRole::effort) spec.set(p.name, {std::to_string(kSweeps), {}});
    if (p.role == ParamRole::tolerance && perContact) spec.set(p.name, {"0", {}});
    if (!p.stage || (p.stage->kind != StageKind::velocity && p.stage->kind != StageKind::position)) continue;
    const Spec* given = spec.find(p.name);
    spec.set(p.name, often(p.stage->kind, given ? *given : Spec::parse(p.defaultText)));
  }
  return spec;
}
bool substepsOrGives(const Spec& solver) {
  const auto& params = Registry::instance().find(StageKind::solver, 3, solver.name).params;
  return std::any_of(params.begin(), params.end(),
                     [](const ParamInfo& p) { return p.name == "substeps" || p.name == "hertz"; });
}

// A method that declares disagreement must disagree. Each bound is used by more than a quarter, except bounds at
// rounding level.
TEST(Extrusion, AgreesOrSaysThatItDoesNot) {
  std::map<std::pair<std::string, bool>, double> used;
  for (const std::string& text : everySolver<3>(true)) {
    const bool told = declares<3>(text, "Extrusion.AgreesOrSaysThatItDoesNot");
    const Spec spec = Spec::parse(text);
    const bool gives = substepsOrGives(spec);
    bool agrees = true;
    std::string found;
    for (const Scene& scene : kScenes) {
      const double error = mostApart(gives ? spec : often(StageKind::solver, spec), scene);
      agrees = agrees && error <= (gives ? scene.giving : scene.swept);
      found += std::string(scene.name) + ' ' + std::to_string(error * 1e6) + " um, ";
      double& most = used[{scene.name, gives}];
      if (!told) most = std::max(most, error);
      if (std::getenv("LPC_PRINT_ANSWERS")) std::printf("%s %s %.3g\n", text.c_str(), scene.name, error);
    }
    EXPECT_EQ(agrees, !told) << text << ": " << found;
  }
  // Ablation of the failure that avbd declares.
  for (const Scene& scene : kScenes) {
    const double error = mostApart(often(StageKind::solver, Spec::parse("avbd{tries=3}")), scene);
    EXPECT_LE(error, scene.swept) << scene.name;
    double& most = used[{scene.name, false}];
    most = std::max(most, error);
  }
  for (const Scene& scene : kScenes) {
    for (const bool gives : {false, true}) {
      const double bound = gives ? scene.giving : scene.swept;
      EXPECT_TRUE((bound < 1e-9 || used[{scene.name, gives}] > bound / 4)) << scene.name << gives;
    }
  }
}

// 3 % more inertia than in the plane shows where boxes rotate.
TEST(Extrusion, SeesAnotherInertia) {
  for (const char* text : {"split_solver", "soft_step"}) {
    const Spec spec = Spec::parse(text);
    const Scene& turns = kScenes[3];
    const double bound = substepsOrGives(spec) ? turns.giving : turns.swept;
    expectCaught("Extrusion inertia " + std::string(text),
                 mostApart(substepsOrGives(spec) ? spec : often(StageKind::solver, spec), turns, true) <= bound);
  }
}

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::extrusion_test
