// SPDX-License-Identifier: Zlib
// Limits of stability: tilted boxes, overhangs, arches, cards. Each limit is bisected.
#include <array>

#include "tests/known_answers/known_answer.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace stability_test { namespace {

constexpr Real kDt = Real(1) / 60;
const char* const kTwo[] = {"split_solver", "soft_step"};
const std::string kSwept = "split_solver{velocity=catto{iterations=200}}",
                  kNewton = "split_solver{velocity=proximal_newton}";

// A limit between a value at which `holds` is true and one at which it is not, to within `width`.
template <class Holds>
double limit(double yes, double no, double width, const Holds& holds) {
  while (std::abs(no - yes) > width) {
    const double middle = (yes + no) / 2;
    (holds(middle) ? yes : no) = middle;
  }
  return (yes + no) / 2;
}

void setFriction(BodyDef<2>& def, double mu) {
  for (ShapeDef<2>& s : def.shapes) s.friction = Real(mu);
}
BodyDef<2> floorOf(double mu) {
  BodyDef<2> ground = body<2>(Shape<2>::box({50, 1}), {0, -1}, BodyType::fixed);
  setFriction(ground, mu);
  return ground;
}

// A box of width 0.4 and height 1 is tilted on its edge by phi and released. It falls back if and only if phi < atan(w
// / h). From upright, m g (hypot(w, h) - h) / 2 lifts it to that angle: with less rotational energy about its edge it
// also falls back.
template <int D>
void releases() {
  const double w = 0.4, h = 1, reach = std::hypot(w, h) / 2, own = std::atan(w / h);
  EXPECT_NEAR(reach - h / 2, 0.038516480713450374, 1e-15);
  Vec<D> half = Vec<D>::Constant(Real(w / 2));
  half[1] = Real(h / 2);
  for (const char* solver : kTwo) {
    const auto fallsBack = [&](double phi, double spin) {
      World<D> world = worldOf<D>(solver);
      Vec<D> wide = Vec<D>::Constant(50);
      wide[1] = 1;
      BodyDef<D> ground = body<D>(Shape<D>::box(wide), at<D>(0, -1), BodyType::fixed);
      // The right lower edge is at the origin; the centre is left of it and above.
      BodyDef<D> box = body<D>(Shape<D>::box(half), at<D>(-reach * std::sin(own - phi), reach * std::cos(own - phi)));
      const Ang<D> axis = Ang<D>::Unit(D == 2 ? 0 : 2);
      box.X_WB.q = integrateRotation(Rot<D>{}, Ang<D>(Real(-phi) * axis));
      box.angularVelocity = Real(-spin) * axis;
      box.velocity = cross(box.angularVelocity, box.X_WB.p);
      ground.shapes[0].friction = box.shapes[0].friction = 1;
      world.add(ground);
      const BodyHandle b = world.add(box);
      for (int i = 0; i < 360; ++i) world.step(kDt);
      return double(world.pose(b).q.matrix()(1, 1)) > 0.8;
    };
    known(in<D>("angle, degrees"), solver, own / kDegree,
          limit(20, 24, 0.01, [&](double degrees) { return fallsBack(degrees * kDegree, 0); }));
    // Upright, with the energy of `rise` metres: I w^2 / 2 = m g rise, I / m = reach^2 4 / 3.
    known(in<D>("energy over m g, m"), solver, reach - h / 2, limit(0.02, 0.06, 1e-5, [&](double rise) {
            return fallsBack(0, std::sqrt(2 * kG * rise / (reach * reach * 4 / 3)));
          }));
  }
}
TEST_F(KnownAnswer, topple_release) { releases<2>(), releases<3>(); }

// N equal blocks of length L over the edge of a table, one per row: the top one overhangs by at most L/2 sum 1/k.
TEST_F(KnownAnswer, harmonic_overhang) {
  for (const auto& [name, solvers] : andOthers({{kTwo[0], {kTwo[0]}}, {kTwo[1], {kTwo[1]}}, {kSwept, {kSwept}}})) {
    const std::string& solver = solvers[0];
    for (int n : {1, 2, 3, 4, 10, 31}) {
      const bool tall = n == 31;  // with ten sweeps it falls even at a fifth of the limit
      if (tall != (solver == kSwept)) continue;
      double expected = 0;
      for (int k = 1; k <= n; ++k) expected += 0.5 / k;
      const auto stands = [&](double overhang) {
        World<2> world = worldOf<2>(solver);
        BodyDef<2> table = body<2>(Shape<2>::box({5, 1}), {-5, -1}, BodyType::fixed);
        setFriction(table, 1);
        world.add(table);
        double right = 0, top = 0;
        for (int row = 0; row < n; ++row) {  // bottom first: row 0 is block n, counted from the top
          right += 0.5 / (n - row) * overhang / expected;
          BodyDef<2> block = body<2>(Shape<2>::box({Real(0.5), Real(0.1)}), at<2>(right - 0.5, 0.1 + 0.2 * row));
          setFriction(block, 1);
          top = right;
          world.add(block);
        }
        for (int i = 0; i < 300; ++i) world.step(kDt);
        const Pose<2> last = world.pose(world.handle(n));
        return double(last.p[1]) > 0.2 * n - 0.2 && std::abs(double(last.p[0]) + 0.5 - top) < 0.3;
      };
      known("N = " + std::to_string(n), name, expected,
            limit((tall ? 0.4 : 0.5) * expected, 1.05 * expected, tall ? 2e-2 : 2e-3, stands));
    }
  }
}

// Two cards lean on each other at alpha from the vertical: mu at the floor must be at least tan(alpha) / 2. A round
// foot touches below its middle, where friction has an arm: sin(alpha) / 2 (cos(alpha) + r / L).
double leastFriction(double alpha, double round) { return std::sin(alpha) / 2 / (std::cos(alpha) + round); }

TEST_F(KnownAnswer, card_house) {
  EXPECT_NEAR(leastFriction(10 * kDegree, 0), 0.08816349035423249, 1e-15);
  EXPECT_NEAR(leastFriction(20 * kDegree, 0), 0.18198511713310117, 1e-15);
  EXPECT_NEAR(leastFriction(30 * kDegree, 0), 0.28867513459481287, 1e-15);
  const double half = 0.5, radius = 0.02;
  for (const auto& [name, solvers] : allMethods()) {
    const std::string& solver = solvers[0];
    for (int degrees : {10, 20, 30}) {
      const double alpha = degrees * kDegree, expected = leastFriction(alpha, radius / (2 * half));
      const auto stands = [&](double mu) {
        World<2> world = worldOf<2>(solver);
        world.add(floorOf(mu * mu));  // cards have mu = 1; a pair has the geometric mean
        std::array<BodyHandle, 2> cards;
        for (int i = 0; i < 2; ++i) {
          const double side = i == 0 ? -1 : 1;
          BodyDef<2> card = body<2>(Shape<2>::capsule(Real(half), Real(radius)),
                                    at<2>(side * (radius + half * std::sin(alpha)), radius + half * std::cos(alpha)));
          card.X_WB.q = Rot<2>::angle(side * (kPi / 2 + alpha));
          setFriction(card, 1);
          cards[static_cast<std::size_t>(i)] = world.add(card);
        }
        const double from = double(world.pose(cards[0]).p[1]);
        for (int i = 0; i < 300; ++i) world.step(kDt);
        return double(world.pose(cards[0]).p[1]) > from - 0.03;
      };
      known("alpha = " + std::to_string(degrees) + ": mu", name, expected,
            limit(1.5 * expected, 0.5 * expected, 1e-4, stands));
    }
  }
}

// A half circle of n equal voussoirs with radial joints: the least thickness over mean radius at which it stands. It is
// 0.1075 for infinitely many joints (Milankovitch). With few voussoirs the line of thrust may leave the arch between
// joints, so thinner arches stand. The exact limit for n is the least t for which some line of thrust stays within all
// joints (thrustFits).
bool thrustFits(int n, double t) {
  // Half the arch, angles from the crown. A horizontal thrust H at height `crown` and the accumulated weights cut the
  // joint at angle a at the radius r = (H crown + moment) / (weight sin a + H cos a). This gives two bounds on H for
  // each joint.
  const double step = kPi / n, inner = 1 - t / 2, outer = 1 + t / 2;
  const double area = std::sin(step) / 2 * (outer * outer - inner * inner);
  const double middle = 2.0 / 3 * std::cos(step / 2) * (std::pow(outer, 3) - std::pow(inner, 3)) /
                        (outer * outer - inner * inner);  // radius of a stone's centroid
  const auto fits = [&](double crown) {
    double low = 0, high = 1e9, weight = 0, moment = 0;
    for (int i = 1; 2 * i <= n; ++i) {
      const double s = std::sin(i * step), c = std::cos(i * step);
      weight += area, moment += area * middle * std::sin((i - 0.5) * step);
      low = std::max(low, (weight * inner * s - moment) / (crown - inner * c));
      const double reach = crown - outer * c, most = weight * outer * s - moment;
      if (reach > 0) high = std::min(high, most / reach);
      if (reach < 0) low = std::max(low, most / reach);
    }
    return low <= high;
  };
  for (int i = 1; i <= 200; ++i) {
    if (fits(inner + t * i / 200)) return true;
  }
  return false;
}

TEST_F(KnownAnswer, couplet_arch) {
  const auto exact = [](int n) { return limit(0.3, 0.01, 1e-6, [&](double t) { return thrustFits(n, t); }); };
  EXPECT_NEAR(exact(720), 0.1075, 2e-4);
  std::vector<std::string> tried = {kTwo[0], kTwo[1], kSwept};
  for (const Methods& methods : andOthers({})) tried.push_back(methods.name);
  for (const std::string& solver : tried) {
    for (int n : {12, 24, 48}) {
      if (solver != kTwo[0] && solver != kTwo[1] && solver != kSwept && solver != kNewton && n != 12) continue;
      const bool close = solver == kSwept || solver == kNewton;
      if (close && n != (solver == kSwept ? 24 : 48)) continue;
      const auto stands = [&](double t) {
        World<2> world = worldOf<2>(solver);
        world.add(floorOf(1));
        const double step = kPi / n;
        std::array<Vec<2>, 4> corners;
        BodyHandle crown;
        for (int i = 0; i < n; ++i) {
          const double middle = (i + 0.5) * step;
          for (std::size_t k = 0; k < 4; ++k) {
            const double angle = (k == 0 || k == 3 ? -0.5 : 0.5) * step, r = k < 2 ? 1 - t / 2 : 1 + t / 2;
            corners[k] = at<2>(10 * (r * std::cos(middle + angle) - std::cos(middle)),
                               10 * (r * std::sin(middle + angle) - std::sin(middle)));
          }
          BodyDef<2> stone = body<2>(Shape<2>::polytope(corners), at<2>(10 * std::cos(middle), 10 * std::sin(middle)));
          setFriction(stone, 1);
          const BodyHandle h = world.add(stone);
          if (i == n / 2) crown = h;
        }
        const double from = double(world.pose(crown).p[1]);
        for (int i = 0; i < 600; ++i) world.step(kDt);
        return double(world.pose(crown).p[1]) > from - 1;
      };
      known("n = " + std::to_string(n) + ": t / R", solver, exact(n),
            limit(close ? 0.15 : 0.3, close ? 0.08 : 0.02, close || n == 48 ? 4e-3 : 2e-3, stands));
    }
  }
}

// A rod slides with one end on the floor. For mu > 4/3 there are angles at which no finite force is consistent with
// rigid motion. A step must end with finite impulses and without more energy.
TEST_F(KnownAnswer, painleve_rod) {
  const double half = 0.5, phi = std::atan(2.0);
  for (double mu : {1.0, 1.6}) {
    double most = 0;
    for (const char* solver :
         {"split_solver", "split_solver{velocity=millington}", "split_solver{velocity=naive}", "soft_step"}) {
      World<2> world = worldOf<2>(solver);
      world.add(floorOf(mu));
      BodyDef<2> rod =
          body<2>(Shape<2>::box({Real(half), Real(0.005)}), at<2>(0, half * std::sin(phi) + 0.005 * std::cos(phi)));
      rod.X_WB.q = Rot<2>::angle(kPi - phi);  // the lower end is ahead
      rod.velocity = at<2>(3, 0);
      setFriction(rod, mu);
      const BodyHandle h = world.add(rod);
      const double m = double(world.mass(h)), inertia = m * (4 * half * half + 1e-4) / 12;
      const auto energy = [&] {
        const Motion<2> motion = world.motion(h);
        return m * double(motion.v.squaredNorm()) / 2 + inertia * double(motion.w.squaredNorm()) / 2 +
               m * kG * double(world.pose(h).p[1]);
      };
      const double from = energy();
      for (int i = 0; i < 120; ++i) {
        world.step(kDt);
        most = std::max(most, energy() / from - 1);
        ASSERT_TRUE(std::isfinite(energy())) << solver << " mu=" << mu;
      }
    }
    known("mu = " + std::to_string(mu).substr(0, 3) + ": share of energy gained", "all", 0, most);
  }
}

// The largest speed of settled bodies a kilometre above the origin, where f32 rounds a position to 0.06 mm.
double trembles(World<2>& world, const std::vector<BodyHandle>& bodies) {
  double most = 0;
  for (int i = 0; i < 600; ++i) {
    world.step(kDt);
    for (const BodyHandle& body : bodies) most = i < 450 ? 0 : std::max(most, double(world.motion(body).v.norm()));
  }
  return most;
}
double stackTrembles(int substeps) {
  World<2> world = worldOf<2>("soft_step{substeps=" + std::to_string(substeps) + "}");
  BodyDef<2> ground = floorOf(0.6);
  ground.X_WB.p[1] += 1000;
  world.add(ground);
  std::vector<BodyHandle> boxes;
  for (int i = 0; i < 5; ++i) {
    BodyDef<2> box = body<2>(Shape<2>::box({Real(0.5), Real(0.5)}), at<2>(0, 1000.5 + i));
    setFriction(box, 0.6);
    boxes.push_back(world.add(box));
  }
  return trembles(world, boxes);
}
double chainTrembles(const std::string& solver) {
  World<2> world = worldOf<2>(solver);
  std::vector<BodyHandle> links;
  for (int i = 0; i < 5; ++i) {
    const Shape<2> box = Shape<2>::box({Real(0.2), Real(0.5)});
    links.push_back(world.add(body<2>(box, at<2>(0, 1000 - i), i == 0 ? BodyType::fixed : BodyType::dynamic)));
    if (i == 0) continue;
    world.add(JointDef<2>{.bodyA = links[links.size() - 2], .bodyB = links.back(), .X_WJ = {at<2>(0, 1000.5 - i), {}}});
  }
  return trembles(world, links);
}
// Sub-steps four times as short must not tremble more. If separations of contacts and errors of joints were computed
// from rounded positions, they would tremble several times as much.
TEST(FarFromTheOrigin, ShorterSubstepsTrembleNoMore) { EXPECT_LT(stackTrembles(16), 1.5 * stackTrembles(4) + 1e-9); }
TEST(FarFromTheOrigin, JointsOfShorterSubstepsTrembleNoMore) {
  EXPECT_LT(chainTrembles("xpbd{substeps=16}"), 1.5 * chainTrembles("xpbd{substeps=4}") + 1e-9);
}

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::stability_test
