// SPDX-License-Identifier: Zlib
// Velocity problems frozen from a world, written and read: a resolver gives the same bits for the file as in the world.
#include "experiments/trial/formats/problem_file.h"

#include <set>
#include <sstream>

#include "experiments/parse/toml_reader.h"
#include "tests/expect_caught.h"
#include "tests/experiments/refused.h"
#include "tests/small_worlds.h"

namespace lpc { inline namespace LPC_PRECISION { namespace problem_file_test { namespace {

using test::expectParts;
using test::Parts;
using test::refused;
using test::Workspace;

template <int D>
struct Solved {
  std::vector<Motion<D>> motion;
  std::vector<Manifold<D>> manifolds;
  std::vector<JointRecord<D>> joints;
};

/// Freezes its problem, and solves a copy beside the world.
template <int D>
struct Freezer final : VelocityWatcher<D> {
  std::string resolver;
  FrozenProblem<D> frozen;
  Solved<D> solved;

  void see(const VelocityInput<D>& in) override {
    frozen = freeze(in, Vec<D>(-Vec<D>::Unit(1)));
    Bodies<D> bodies = in.bodies;
    solved.manifolds.assign(in.manifolds.begin(), in.manifolds.end());
    solved.joints.assign(in.joints.begin(), in.joints.end());
    WorkDone work;
    createStage<VelocityResolver<D>>(Spec::parse(resolver))
        ->solve({in.dt, in.lastDt, bodies, solved.manifolds, in.order, solved.joints, in.position, in.model,
                 in.restitutionThreshold, work, in.profiler, in.arrival, in.colours});
    std::set<std::int32_t> named;
    for (const int i : in.order) {
      const Manifold<D>& m = in.manifolds[static_cast<std::size_t>(i)];
      named.insert(m.bodyA), named.insert(m.bodyB);
    }
    for (const JointRecord<D>& j : in.joints) named.insert(j.bodyA), named.insert(j.bodyB);
    named.erase(-1), solved.motion.clear();
    for (const std::int32_t i : named) solved.motion.push_back(bodies.motion[static_cast<std::size_t>(i)]);
  }
};

template <int D>
std::vector<Motion<D>> solvedAgain(FrozenProblem<D> problem, const std::string& resolver) {
  WorkDone work;
  Profiler profiler;
  createStage<VelocityResolver<D>>(Spec::parse(resolver))->solve(problem.input(work, profiler));
  return problem.bodies.motion;
}

template <int D>
bool same(const std::vector<Motion<D>>& a, const std::vector<Motion<D>>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const Motion<D>& x, const Motion<D>& y) { return x.v == y.v && x.w == y.w; });
}

template <int D>
std::string written(const FrozenProblem<D>& problem) {
  std::ostringstream out;
  writeProblems<D>(out, {{"heap", 7, problem}});
  return out.str();
}

/// A falling heap with a pendulum, a motor with limits and a soft spring; some contacts bounce.
template <int D>
FrozenProblem<D> heapProblem(Freezer<D>& freezer, const std::string& solver) {
  World<D> world(Pipeline::parse(solver));
  test::addHeap(world, 8, 3);
  const BodyHandle a = world.add(test::body<D>(Shape<D>::sphere(Real(0.3)), test::at<D>(5, 3)));
  const BodyHandle b = world.add(test::body<D>(Shape<D>::sphere(Real(0.3)), test::at<D>(6, 3)));
  JointDef<D> hinge = test::pivot<D>({}, a, test::at<D>(4.5, 3)), rod = test::pivot<D>(a, b, test::at<D>(5, 3));
  hinge.kind = "hinge{motor_speed=2,motor_torque=0.5,lower=-0.2,upper=0.3}";
  rod.kind = "distance{mode=spring,damping=5}", rod.X_WJb = Pose<D>{test::at<D>(6, 3), {}};
  world.add(hinge), world.add(rod);
  world.watch(&freezer);
  for (int i = 0; i < 60; ++i) world.step(Real(1) / 60);
  return freezer.frozen;
}

template <int D>
void sameBits(const std::string& order) {
  for (const Registered* entry : Registry::instance().list(StageKind::velocity, D)) {
    if (entry->info.role != AlgorithmRole::competitor) continue;
    const std::string& resolver = entry->info.name;
    Freezer<D> freezer;
    freezer.resolver = resolver;
    const std::string solver = "solver=split_solver{position=baumgarte,order=" + order + "}";
    const FrozenProblem<D> problem = heapProblem(freezer, solver);
    ASSERT_GT(problem.points(), 5);
    ASSERT_EQ(problem.joints.size(), 3u);
    ASSERT_FALSE(same<D>(freezer.solved.motion, problem.bodies.motion)) << "nothing to solve";
    EXPECT_TRUE(same<D>(solvedAgain(problem, resolver), freezer.solved.motion)) << resolver << ", " << order;
    const ProblemFile file = ProblemFile::parse(written(problem), "p");
    ASSERT_EQ(file.of<D>().size(), 1u);
    EXPECT_EQ(file.of<D>()[0].scene, "heap");
    EXPECT_EQ(file.of<D>()[0].step, 7);
    EXPECT_TRUE(same<D>(solvedAgain(file.of<D>()[0].problem, resolver), freezer.solved.motion)) << resolver;
    EXPECT_EQ(written(file.of<D>()[0].problem), written(problem));
  }
}
TEST(ProblemFile, IsSolvedToTheSameBits2) {
  for (const char* order : {"stored", "bottom_up", "coloured"}) sameBits<2>(order);
}
TEST(ProblemFile, IsSolvedToTheSameBits3) { sameBits<3>("coloured"); }

TEST(ProblemFile, EveryFieldIsNeeded) {
  Freezer<2> freezer;
  freezer.resolver = "catto";
  const FrozenProblem<2> problem = heapProblem(freezer, "solver=split_solver{position=baumgarte}");
  const auto plant = [&](const char* what, const auto& change) {
    FrozenProblem<2> planted = problem;
    change(planted);
    test::expectCaught(std::string("FrozenProblem forgets ") + what,
                       same<2>(solvedAgain(planted, "catto"), freezer.solved.motion));
  };
  plant("last impulses", [](auto& p) {
    for (auto& m : p.manifolds)
      m.points = [points = m.points]() mutable {
        for (auto& c : points) c.impulse.fill(0);
        return points;
      }();
  });
  plant("targets", [](auto& p) { p.position = {}; });
  plant("the order", [](auto& p) { std::reverse(p.order.begin(), p.order.end()); });
  plant("joints", [](auto& p) { p.joints.clear(); });
  plant("the last step's length", [](auto& p) { p.lastDt = 2 * p.dt; });
}

TEST(ProblemFile, RefusesInOneLine) {
  Freezer<2> freezer;
  freezer.resolver = "catto";
  const std::string good = written(heapProblem(freezer, "solver=split_solver"));
  const auto message = [](const std::string& bytes) {
    try {
      ProblemFile::parse(bytes, "p.json");
    } catch (const UserError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_EQ(message(good), "");
  const auto changed = [&](const std::string& from, const std::string& to) {
    std::string out = good;
    const std::size_t at = out.find(from);
    EXPECT_NE(at, out.npos) << from;
    return out.replace(at, from.size(), to);
  };
  const struct {
    std::string bytes;
    Parts parts;
  } cases[] = {
      {"", {"p.json", "not a file of problems"}},
      {"PK\x03\x04", {"p.json", "not a file of problems"}},
      {"{\"cases\": []}", {"p.json", "not a file of problems", "lpc record"}},
      {changed("\"version\": 1", "\"version\": 9"), {"p.json, version is 9", "valid: 1"}},
      {changed("\"dimension\": 2", "\"dimension\": 4"), {"dimension is 4"}},
      {changed("\"dimension\": 2", "\"dimension\": 3"), {"problems 0", "a list of", "valid: 3 numbers"}},
      {changed("\"dt\":", "\"dr\":"), {"problems 0 lacks 'dt'"}},
      {changed("\"dt\":0", "\"dt\":-0"), {"dt is -0.01", "valid: a number above 0"}},
      {changed("\"dt\":0.", "\"dt\":1e999,\"x\":0."), {"p.json"}},
      {changed("\"a\":", "\"a\":1234,\"c\":"), {"a is 1234", "valid: a whole number from 0 to"}},
      {changed("\"normal\":[", "\"normal\":[2,"), {"normal is a list of 3", "valid: 2 numbers"}},
      {changed("\"friction\":", "\"friction\":\"much\",\"f\":"), {"friction is \"much\"", "valid: "}},
      {changed("\"law\":\"", "\"law\":\"x"), {"law is ", "valid: rigid, spring, motor"}},
      {changed("\"order\":[", "\"order\":[0,0,"), {"order 1 is 0", "valid: each contact once"}},
      {changed("\"inverse_mass\":", "\"inverse_mass\":-1,\"m\":"), {"inverse_mass is -1", "valid: "}},
      {good.substr(0, good.find('[')) + "[]}", {"holds no problem"}},
  };
  for (const auto& c : cases) {
    const std::string said = message(c.bytes);
    expectParts(said, c.parts, c.bytes.substr(0, 60));
    EXPECT_EQ(said.find('\n'), said.npos) << said;
  }
  for (std::size_t n = 1; n + 2 < good.size(); n += good.size() / 50) {
    EXPECT_NE(message(good.substr(0, n)), "") << "cut after " << n << " bytes";
  }
}

// Two rows of a contact and an equality: read, written, and with every possible fault.
TEST(ProblemFile, HoldsAMatrix) {
  const std::string good =
      "{\"format\": \"lpc problems\", \"version\": 1, \"dimension\": 2, \"problems\": "
      "[\n{\"matrix\":{\"entries\":[[0,0,2.0],"
      "[2,0,0.5],[1,1,1.0],[2,2,3.0]],\"friction\":[0.4],\"impulse\":[0.0,0.0,0.25],\"velocity\":[-1.0,0.125,0.0]},"
      "\"scene\":\"m\",\"step\":0}\n]}\n";
  const ProblemFile file = ProblemFile::parse(good, "m.json");
  const GivenProblem& given = file.in2.at(0).problem.given.value();
  EXPECT_EQ(given.at(0, 2), 0.5);
  EXPECT_EQ(given.at(2, 0), 0.5);
  EXPECT_EQ(given.at(1, 0), 0);
  EXPECT_EQ(given.at(2, 2), 3);
  EXPECT_EQ(given.impulse, (std::vector<double>{0, 0, 0.25}));
  std::ostringstream again;
  writeProblems<2>(again, file.in2);
  EXPECT_EQ(again.str(), good);
  const struct {
    std::string from, to;
    Parts parts;
  } cases[] = {
      {"[2,0,0.5]", "[0,2,0.5]", {"m.json, problems 0, matrix, entries 1 1 is 2", "valid: a whole number from 0 to 0"}},
      {"[2,0,0.5]", "[3,0,0.5]", {"entries 1 0 is 3", "valid: a whole number from 0 to 2"}},
      {"[2,0,0.5]", "[1,1,0.5]", {"entries 2 is ", "valid: each entry once"}},
      {"[2,0,0.5]", "[2,0]", {"entries 1 is a list of 2", "valid: row, column and number"}},
      {"[0,0,2.0]", "[0,0,-2.0]", {"entries 0 2 is -2", "valid: 0 or more, on the diagonal"}},
      {"[0,0,2.0]", "[0,0,null]", {"entries 0 2 is null", "valid: a finite number"}},
      {"[0.4]", "[-0.4]", {"friction 0 is -0.4"}},
      {"[0.4]", "[0.4,0.4]", {"velocity is a list of 3", "valid: 2 numbers for each contact"}},
      {"0.25]", "0.25,1]", {"impulse is a list of 4", "valid: a list of 3"}},
      {"\"velocity\"", "\"speed\"", {"matrix lacks 'velocity'"}},
      {"[0,0,2.0],", "", {"problems 0, matrix: the entry at 2, 0 is too large", "valid: a matrix without negative"}},
      {"[2,0,0.5]", "[2,0,2.5]", {"the entry at 2, 0 is too large"}},
      {"[2,0,0.5],[1,1,1.0],[2,2,3.0]],\"friction\":[0.4],\"impulse\":[0.0,0.0,0.25],\"velocity\":[-1.0,0.125,0.0]",
       "[1,1,1.0]],\"friction\":[0.4],\"impulse\":[0,0,0],\"velocity\":[-1,0.125,0.5]",
       {"velocity 2 is 0.5", "valid: 0 or more for a row without moving bodies"}},
  };
  for (const auto& c : cases) {
    std::string bad = good;
    bad.replace(bad.find(c.from), c.from.size(), c.to);
    try {
      ProblemFile::parse(bad, "m.json");
      ADD_FAILURE() << c.to;
    } catch (const UserError& e) {
      expectParts(e.what(), c.parts, c.to);
    }
  }
}

TEST(Record, WritesTheProblemsOfSteps) {
  Workspace w;
  const test::Outcome some = w.lpc("record vertical_stack --problems p.json --steps 3,20 --param n=4 --param gap=0");
  ASSERT_EQ(some.code, 0) << some.text;
  const ProblemFile file = ProblemFile::load(w.path("p.json"));
  ASSERT_EQ(file.size(), 2u);
  EXPECT_EQ(file.in2[0].step, 3);
  EXPECT_EQ(file.in2[1].step, 20);
  EXPECT_EQ(file.in2[1].scene, "vertical_stack");
  EXPECT_EQ(file.in2[1].problem.manifolds.size(), 4u);

  const test::Outcome hard =
      w.lpc("record vertical_stack --problems h.json --hardest 2 --until 40 --param n=4 --param gap=0");
  ASSERT_EQ(hard.code, 0) << hard.text;
  EXPECT_EQ(ProblemFile::load(w.path("h.json")).size(), 2u);
}

TEST(Record, RefusesInOneLine) {
  Workspace w;
  w.write("s.toml",
          "name = \"t\"\nsummary = \"s\"\ndimensions = [2]\nsteps = 5\n[[body]]\n"
          "shapes = [{ kind = \"circle\", radius = 1 }]\n");
  const std::string p = " --problems p.json";
  refused(w, "record vertical_stack --steps 3", {"--problems"});
  refused(w, "record vertical_stack" + p, {"valid: either --steps 100,200 or --hardest 3"});
  refused(w, "record vertical_stack --steps 3 --hardest 2" + p, {"--hardest"});
  refused(w, "record vertical_stack --steps -3" + p, {"-3"});
  refused(w, "record vertical_stack --hardest 0" + p, {"0"});
  refused(w, "record no_scene --steps 3" + p, {"no_scene"});
  refused(w, "record s.toml --steps 3" + p, {"no step of 's.toml' has a velocity problem"});
  refused(w, "record s.toml --steps 3 --problems s.toml", {"overwrite the scene s.toml"});
  refused(w, "record vertical_stack --steps 3 --pipeline solver=soft_step" + p,
          {"a solver without a separate velocity stage"});
  refused(w, "record vertical_stack --steps 3 --pipeline engine=box2d" + p,
          {"an engine gives no access to velocity problems"});
  refused(w, "record vertical_stack --steps 3 --problems none/p.json", {"none/p.json: cannot be written"});
}

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::problem_file_test
