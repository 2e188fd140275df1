// SPDX-License-Identifier: Zlib
// Kept cases as programs that use only a witness's library: compiled and run, they print the answer that LPC's adapter
// got.
#include "experiments/runner/reproduction.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <set>

#include "experiments/parse/toml_reader.h"
#include "oracles/corpus/cases.h"
#include "oracles/witnesses/witness.h"
#include "tests/expect_caught.h"
#include "tests/experiments/workspace.h"

namespace lpc { inline namespace LPC_PRECISION { namespace reproduction_test { namespace {

using test::Outcome;
using test::Workspace;

struct Tried {
  std::string witness, id;
  bool right;
};

// For each library, every way in which its adapter writes a shape. FCL takes seconds to compile.
const std::vector<Tried> kTried = {
    {"libccd_gjk", "jolt-sphere-near-coincident", false},
    {"libccd_gjk", "libccd-ts-boxcyl7", false},
    {"libccd_gjk", "libccd-25-cubes", false},             // a direction that is NaN: no answer
    {"libccd_gjk", "parry-205-capsule-triangle", false},  // 2D
    {"libccd_mpr", "drake-convex-4", false},
    {"libccd_mpr", "parry-70-capsule-cuboid-0", false},
    {"libccd_mpr{tolerance=0.01}", "mujoco-Ellipsoid", true},
    {"ode", "fcl-395-box-box", false},
    {"ode", "fcl-508-box-box", true},
    {"ode", "parry-70-capsule-cuboid-0", true},
    {"bullet_box_box", "fcl-395-box-box", false},
    {"bullet_gjk_epa", "libccd-25-cubes", false},
    {"bullet_gjk_epa", "drake-21234-cyl-box", true},  // except for its normal
    {"bullet_gjk_epa", "drake-convex-4", true},
    {"fcl_libccd", "fcl-508-box-box", false},
    {"fcl_libccd_collide", "drake-convex-5", false},
    {"fcl_indep", "mujoco-1857-capsule-disk", false},
    {"box2d", "ncollide-181-large-ratio-3", true},
    {"box2d", "box2d-short-edge-0.0002", true},
    {"box2d", "dyn4j-falsePenetration1a", true},
    {"chipmunk", "parry-205-capsule-triangle", true},
    {"chipmunk", "ncollide-181-large-ratio-3", true},
    {"chipmunk", "box2d-short-edge-0.0002", true},
};

struct Asked {
  double answer = 0;  // of LPC's adapter, in the question's unit
  Question question;
};

template <int D>
Asked askedIn(const CaseGeometry<D>& g, const Spec& spec) {
  const auto query = createStage<PairQuery<D>>(spec);
  auto& witness = dynamic_cast<Witness<D>&>(*query);
  PairView<D> view{g.a.shape->view(), g.b.shape->view(), g.pair().X_AB};
  if (view.a.kind > view.b.kind) view = {view.b, view.a, view.X_AB.inverse()};
  const PairAnswer<D> answer = queryPair(witness, view.a, view.b, view.X_AB);
  Asked out{0, witness.question(view).value()};
  out.answer = static_cast<double>(answer.distance) / out.question.unit + out.question.snippet.rounding;
  if (answer.status == QueryStatus::degenerate) {
    out.answer = std::copysign(std::numeric_limits<double>::infinity(), static_cast<double>(answer.distance));
  }
  if (answer.status == QueryStatus::failed) out.answer = std::nan("");
  return out;
}
Asked asked(const Tried& t) {
  for (const Case& c : readCases(keptCases())) {
    if (c.id == t.id) return std::visit([&](const auto& g) { return askedIn(g, Spec::parse(t.witness)); }, c.geometry);
  }
  return {};
}

// Compiles with the command in the program's first line.
Outcome compiledAndRun(const Workspace& w, const std::string& program) {
  w.write("repro.cpp", program);
  const std::size_t at = program.find(": g++ ");
  return w.shell(program.substr(at + 2, program.find('\n') - at - 2));
}
double printed(const Outcome& out) {
  const std::size_t at = out.text.find("answer ");
  EXPECT_NE(at, out.text.npos) << out.text;
  return at == out.text.npos ? 0 : std::strtod(out.text.c_str() + at + 7, nullptr);
}
// Sums of a few numbers by two compilers differ in the last bits.
bool isSame(double a, double b) { return a == b || std::abs(a - b) <= 1e-13 || (std::isnan(a) && std::isnan(b)); }

TEST(Reproduction, ProgramsAnswerAsTheAdaptersDo) {
  Workspace w;
  for (const Tried& t : kTried) {
    SCOPED_TRACE(t.witness + " " + t.id);
    const Reproduction made = reproduce(keptCases(), t.id, t.witness, "repro.cpp");
    const Asked here = asked(t);
    const Outcome out = compiledAndRun(w, made.program);
    EXPECT_EQ(out.code, t.right ? 0 : 1) << out.text << made.program;
    EXPECT_TRUE(isSame(printed(out), here.answer)) << out.text << here.answer << "\n" << made.program;
    EXPECT_NE(made.told.find(t.right ? " is right here: " : " is wrong here: "), std::string::npos) << made.told;
    EXPECT_EQ(here.question.isRight(here.answer), t.right);
    EXPECT_EQ(made.program.find("lpc"), std::string::npos) << "nothing of ours";
  }
}

// Every registered witness is tried above.
TEST(Reproduction, EveryWitnessWritesAProgram) {
  std::set<std::string> tried;
  for (const Tried& t : kTried) tried.insert(Spec::parse(t.witness).name);
  for (const int d : {2, 3}) {
    for (const Registered* r : Registry::instance().list(StageKind::pairQuery, d)) {
      EXPECT_TRUE(r->info.role != AlgorithmRole::witness || tried.contains(r->info.name)) << r->info.name;
    }
  }
}

// Programs that query another function, and a reversed verdict.
TEST(Reproduction, PlantedProgramsAreCaught) {
  Workspace w;
  const Tried t{"libccd_mpr", "drake-convex-4", false};
  const std::string right = reproduce(keptCases(), t.id, t.witness, "").program;
  const double answer = asked(t).answer;
  const auto replaced = [&](const std::string& old, const std::string& with) {
    std::string text = right;
    const std::size_t at = text.find(old);
    EXPECT_NE(at, text.npos) << old;
    return text.replace(at, old.size(), with);
  };
  const Outcome other = compiledAndRun(w, replaced("ccdMPRPenetration(", "ccdGJKPenetration("));
  test::expectCaught("another function of the library", isSame(printed(other), answer));
  const Outcome turned = compiledAndRun(w, replaced("right ? 0 : 1", "right ? 1 : 0"));
  test::expectCaught("an exit code the wrong way round", turned.code == 1);
}

// Answers that give only the side, or nothing: the programs' return values.
TEST(Reproduction, AnAnswerWithoutADistanceIsJudgedByItsSide) {
  constexpr double kApart = std::numeric_limits<double>::infinity();
  Question q{.snippet = {}, .truth = {}, .allowed = 1e-12};
  q.truth.lo = -0.5, q.truth.hi = -0.25;
  EXPECT_FALSE(q.isRight(kApart));
  EXPECT_FALSE(q.isRight(std::nan("")));
  EXPECT_TRUE(q.isRight(-0.5 - 1e-13));
  EXPECT_FALSE(q.isRight(-0.5 - 1e-11));
  EXPECT_FALSE(q.isRight(-0.25 + 1e-11));
  q.truth.lo = -1e-13, q.truth.hi = -1e-13;
  EXPECT_TRUE(q.isRight(kApart));
  EXPECT_TRUE(q.isRight(-kApart)) << "overlapping, and no more";
  q.truth.lo = q.truth.hi = 0.25;
  EXPECT_TRUE(q.isRight(kApart));
  EXPECT_FALSE(q.isRight(-kApart));
}

TEST(Reproduction, TheCommandWritesAFileAndPrintsOneLine) {
  Workspace w;
  const Outcome named = w.lpc("verify --repro libccd-25-cubes --witness bullet_gjk_epa --out cubes.cpp");
  EXPECT_EQ(named.code, 0) << named.text;
  EXPECT_TRUE(named.text.starts_with("bullet_gjk_epa on libccd-25-cubes is wrong here: ")) << named.text;
  EXPECT_EQ(std::count(named.text.begin(), named.text.end(), '\n'), 1) << named.text;
  const std::string program = readFile(w.path("cubes.cpp"));
  EXPECT_TRUE(program.starts_with("// Bullet ")) << program;
  EXPECT_NE(program.find(" cubes.cpp -DBT_USE_DOUBLE_PRECISION "), program.npos) << program;
  const Outcome normal = w.lpc("verify --repro drake-21234-cyl-box --witness bullet_gjk_epa --out normal.cpp");
  EXPECT_TRUE(normal.text.ends_with("; the program returns 0, because it does not check the normal, which is wrong\n"))
      << normal.text;
  // By number, to standard output, from a named file; the witness is right, and the message says so.
  const Outcome numbered = w.lpc("verify --repro 61 --witness ode --cases " + keptCases());
  EXPECT_EQ(numbered.code, 0) << numbered.text;
  EXPECT_NE(numbered.text.find("#include <ode/ode.h>"), std::string::npos) << numbered.text;
  EXPECT_NE(numbered.text.find("ode on libccd-25-cubes is right here: "), std::string::npos) << numbered.text;
}

TEST(Reproduction, MistakesAreOneLineAndNothingIsWritten) {
  Workspace w;
  w.write("cases.json", R"({"cases": [{"id": "a\nb\\", "dim": 3, "query": "signed_distance", "source": "x\\",
      "shapeA": {"type": "half_space"}, "poseA": {"t": [0, 0, 0]}, "shapeB": {"type": "sphere", "radius": 1},
      "poseB": {"t": [0, 3, 0]}, "expected": {"signed_distance": 2}}]})");
  const std::pair<std::string, std::vector<std::string>> wrong[] = {
      {"--repro libccd-25-cube --witness ode", {"'libccd-25-cube'", "did you mean 'libccd-25-cubes'?", "0 to 94"}},
      {"--repro 95 --witness ode", {"'95'", "0 to 94"}},
      {"--repro box2d-728-hull-a --witness libccd_gjk", {"convex_hull", "valid: signed_distance"}},
      {"--repro 61 --witness gjk_epa", {"unknown pair query witness 'gjk_epa' in 3D", "ode"}},
      {"--repro 61 --witness libccd_gjk{tolerance=x}", {"tolerance"}},
      {"--repro drake-convex-3 --witness ode", {"polytope", "does not support"}},
      {"--repro 0 --witness libccd_gjk --cases cases.json", {"does not support", "plane"}},
      {"--repro 61", {"--witness"}},
      {"--witness ode", {"--repro"}},
      {"--repro 61 --witness ode --pairs 400", {"--pairs"}},
      {"--repro 61 --witness ode --csv x.csv", {"--csv"}},
      {"--repro 61 --witness ode --cases nowhere.json", {"nowhere.json"}},
      {"--repro 0 --witness ode --cases cases.json --out cases.json", {"--out", "over"}},
  };
  for (const auto& [arguments, parts] : wrong) {
    const bool hasOut = arguments.find("--out") != arguments.npos || !arguments.starts_with("--repro");
    const Outcome out = w.lpc("verify " + arguments + (hasOut ? "" : " --out o.cpp"));
    EXPECT_EQ(out.code, 2) << arguments << out.text;
    EXPECT_EQ(std::count(out.text.begin(), out.text.end(), '\n'), 1) << out.text;
    for (const std::string& part : parts) EXPECT_NE(out.text.find(part), std::string::npos) << part << ": " << out.text;
  }
  EXPECT_EQ(w.lpc("verify --repro 61 --witness ode --out nowhere/o.cpp").code, 2);
  const std::filesystem::directory_iterator all(w.path(""));
  EXPECT_EQ(std::distance(begin(all), end(all)), 1) << "something was written";
}

// Texts from a file stay within the program's comment.
TEST(Reproduction, TextsOfAFileAreNoCode) {
  Workspace w;
  const std::string file =
      w.write("cases.json", R"({"cases": [{"id": "a\nint x;\\", "dim": 3, "query": "signed_distance",
      "source": "y\\\nint z;", "shapeA": {"type": "sphere", "radius": 1}, "poseA": {"t": [0, 0, 0]},
      "shapeB": {"type": "sphere", "radius": 1}, "poseB": {"t": [0, 3, 0]}, "expected": {"signed_distance": 1}}]})");
  const std::string program = reproduce(file, "0", "ode", "; rm x.cpp").program;
  EXPECT_EQ(program.find("\nint "), program.find("\nint main()")) << program;
  EXPECT_NE(program.find(" repro.cpp "), program.npos) << program;
  const Outcome out = compiledAndRun(w, program);
  EXPECT_EQ(out.code, 0) << out.text << program;
}

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::reproduction_test
