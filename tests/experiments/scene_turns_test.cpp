// SPDX-License-Identifier: Zlib
// Blocks with zero iterations, and the count of iterations of the others.
#include "framework/problem/joint.h"
#include "tests/experiments/scene_text.h"

namespace lpc { inline namespace LPC_PRECISION { namespace scene_turns_test { namespace {

using namespace test;

// A joint kind of one dimension.
template <int D>
struct Screw : JointKind<D> {
  struct Params {
    Real pitch = 1;
    void visit(ParamVisitor& v) { v.real("pitch", pitch, 0, 1, "m", "of a turn"); }
  };
  explicit Screw(const Params&) {}
  static AlgorithmInfo info() {
    return {.name = "screw", .summary = "only here", .paper = "none", .complexity = "none"};
  }
  void rows(const JointRecord<D>&, const Pose<D>&, const Pose<D>&, JointRows<D>&) const override {}
};

// A block with zero iterations is parsed but not evaluated: unknown bodies and invalid numbers or sizes in it do not
// matter.
TEST(SceneMistakes, BlocksWithoutIterationsAreOnlyParsed) {
  const std::string joints = "needs = [\"joints\"]\n", none = "repeat = { i = 0, j = \"i + 1\" }\n";
  const auto event = [](const std::string& rest) { return kNamed + "[[event]]\n" + rest; };
  refused({
      {"[[body]]\nrepeat = 0\npositoin = [1, 2]\n" + kBall, {"t.toml:6: ", "unknown key 'positoin'", "position"}},
      {"[[body]]\nwhen = 0\npositoin = [1, 2]\n" + kBall, {"t.toml:6: ", "unknown key 'positoin'"}},
      {"[[body]]\nevery = 1\nuntil = 0\npositoin = [1, 2]\n" + kBall, {"t.toml:7: ", "unknown key 'positoin'"}},
      {"[[body]]\nrepeat = 0\n", {"t.toml:4: ", "'shapes'"}},
      {"[[body]]\nrepeat = 0\nshapes = [\n{ kind = \"crcle\", radius = 1 }]\n", {"t.toml:7: ", "'crcle'", "circle"}},
      {"[[body]]\nrepeat = 0\nshapes = [\n{ kind = \"circle\", radus = 1 }]\n", {"t.toml:7: ", "'radius' is missing"}},
      {"[[body]]\nrepeat = 0\nshapes = [\n{ kind = \"circle\", radius = nan }]\n", {"t.toml:7: ", "nan", "finite"}},
      {"[[body]]\n" + none + "position = [\"i + j + nobody\", 0]\n" + kBall, {"t.toml:6: ", "nobody"}},
      {"[[body]]\n" + none + "position = [\"i +\", 0]\n" + kBall, {"t.toml:6: ", "'i +'"}},
      {"[[body]]\n" + none + "when = \"i = j\"\n" + kBall, {"t.toml:6: ", "'=='"}},
      {"[[body]]\n" + none + "let = { a = \"n\" }\n" + kBall, {"t.toml:6: ", "'n'"}},
      {"[[body]]\nrepeat = { i = 0, j = \"k +\" }\n" + kBall, {"t.toml:5: ", "'k +'"}},
      {"[[body]]\nshapes = [{ kind = \"compound\", parts = [\n{ kind = \"circle\", radius = 1 },\n{ repeat = 0, kind = "
       "\"crcle\" }] }]\n",
       {"t.toml:7: ", "'crcle'"}},
      {"[[body]]\nshapes = [{ kind = \"compound\", parts = [\n{ kind = \"circle\", radius = 1 },\n{ repeat = 0, kind = "
       "\"circle\", radius = 1, radus = 2 }] }]\n",
       {"t.toml:7: ", "'radus'"}},
      {event("do = \"push\"\nstep = 1\nuntil = 1\nbody = \"a\"\nimpuls = 3\n"), {"t.toml:7: ", "impulse"}},
      {event("do = \"push\"\nstep = 1\nrepeat = 0\nbody = \"a\"\nimpulse = [1, 0]\nspeed = 3\n"),
       {"'speed'", "impulse"}},
      {event("do = \"push\"\nstep = 1\nrepeat = 0\nbody = \"b\"\nimpulse = [1, 0]\n"), {"t.toml:11: ", "'b'", "a"}},
      {event("do = \"add\"\nstep = 1\nrepeat = 0\nbody = \"b\"\n" + kBall), {"t.toml:11: ", "'body'"}},
      {joints + kNamed + "[[joint]]\nrepeat = 0\na = \"world\"\nb = \"a\"\nkind = \"pivt\"\nanchor = [0, 0]\n",
       {"t.toml:8: ", "'pivt'", "pivot"}},
      {joints + kNamed + kPivot + "repeat = 0\nparameters = { speed = \"k\" }\n", {"t.toml:8: ", "'speed'"}},
      {joints + kNamed + kPivot + "repeat = 0\nbreak_force = \"k +\"\n", {"t.toml:14: ", "'k +'"}},
      {kNamed + "[[force]]\nrepeat = 0\na = \"world\"\nb = \"a[k +]\"\nkind = \"spring\"\n", {"t.toml:10: ", "'k +'"}},
      {kNamed + "[[force]]\nrepeat = 0\nkind = \"drg\"\n", {"t.toml:7: ", "'drg'", "drag"}},
      {kNamed + "[[force]]\nrepeat = 0\nkind = \"drag\"\nlinear = 1\n", {"t.toml:", "'linear'"}},
  });
  const std::string sound = R"toml(needs = ["joints", "rotation"]
[parameters]
n = { default = 0, min = 0, max = 9, meaning = "m" }
[[body]]
name = "link"
repeat = { i = "n", j = "n / i" }
let = { size = "1 / n" }
position = ["1 / n", "i + j + rand(0, 1)"]
angle = "1e9 * i"
velocity = ["sin(1e9)", 0]
remove = "-5 - i"
shapes = [
  { kind = "box", half = ["size - 1", "-1", "n"] },
  { kind = "polytope", points = [["n", 0], ["n", 0], ["n", "n"]], depth = 1 },
  { kind = "compound", overlap = "refused", parts = [{ kind = "circle", radius = "1 / n", repeat = 4 }] },
]
[[joint]]
repeat = { i = "n" }
kind = "hinge"
a = "link[i]"
b = "link[i + 1]"
anchor = [0, 0]
axis = ["n", "n", "n"]
parameters = { lower = "1 / n", upper = "-1", motor_speed = "n" }
break_force = "n - 1"
[[force]]
when = "n > 0"
kind = "spring"
a = "link[n - 1]"
b = "link"
parameters = { stiffness = "-n" }
until = "n - 1"
[[event]]
do = "remove"
repeat = "n"
step = 3
body = "link[k]"
[[event]]
do = "force"
repeat = "n"
step = 3
body = "link[k]"
force = ["1 / n", 0]
[[event]]
do = "set"
repeat = "n"
step = 3
body = "link[k]"
velocity = ["1 / n", 0]
[[event]]
do = "joint"
repeat = "n"
step = 3
kind = "weld"
a = "link[k]"
b = "link[k + 1]"
anchor = [0, 0]
[[event]]
do = "add"
repeat = "n"
step = 3
name = "late"
shapes = [{ kind = "circle", radius = "n - 1" }]
[[body]]
when = "dimension == 3"
shapes = [
  { kind = "cylinder", half_length = 1, radius = 1 },
  { kind = "ellipsoid", half_x = 1, half_y = 1, half_z = 1 },
  { kind = "compound", parts = [{ kind = "cylinder", half_length = 1, radius = 1 }] },
]
[[body]]
when = "dimension == 2"
shapes = [{ kind = "segment", half_length = 1 }, { kind = "ellipsoid", half_x = 1, half_y = 1 }]
[[joint]]
when = 0
kind = "screw"
a = "world"
b = "link"
anchor = [0, 0]
parameters = { pitch = "1 / n" }
)toml";
  static const Registrar<JointKind, Screw, 3> registrar(__FILE__);
  EXPECT_EQ(messageOf<2>(sound), "no error");
  EXPECT_EQ(messageOf<3>(sound), "no error");
  // It draws no random numbers and creates nothing.
  const auto drawn = [&](const std::string& before) {
    return SceneFile::parse(kHead + before + placed("rand(0, 1)"), "t.toml").build<2>({}, 1);
  };
  const auto with = drawn("[[body]]\nname = \"x\"\nrepeat = 0\nposition = [\"rand(0, 1)\", 0]\n" + kBall),
             without = drawn("");
  ASSERT_EQ(with.spawns.size(), 1u);
  EXPECT_EQ(with.spawns[0].body.X_WB.p, without.spawns[0].body.X_WB.p);
}

// Exactly the allowed number of iterations, in any number of loops; only innermost iterations count.
TEST(SceneMistakes, TheLimitOfIterationsIsExact) {
  const auto scene = [](const std::string& rest) { return "[[body]]\nwhen = 0\n" + rest + kBall + kNamed; };
  for (const std::string repeat : {"{ i = 1000, j = 1000 }", "{ i = 1000, j = 1000, n = 1 }"}) {
    EXPECT_EQ(messageOf<2>(scene("repeat = " + repeat + "\n")), "no error") << repeat;
  }
  refused<2>({{scene("repeat = { i = 1000, j = 1000 }\n" + kBall + "[[body]]\nwhen = 0\nrepeat = 1\n"),
               {"t.toml:10: more than 1000000 turns of loops"}}});
}

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::scene_turns_test
