// SPDX-License-Identifier: Zlib
// Mistakes that a scene reader could accept silently, hang on or crash on: nesting, huge loops, ambiguous expressions,
// blocks that are never read, numbers beyond the arithmetic's range.
#include <gtest/gtest.h>

#include "experiments/parse/expression.h"
#include "tests/experiments/scene_text.h"
#include "tests/experiments/workspace.h"

namespace lpc { inline namespace LPC_PRECISION { namespace scene_mistakes_test { namespace {

using namespace test;

std::string times(int n, const std::string& text) {
  std::string out;
  for (int i = 0; i < n; ++i) out += text;
  return out;
}
std::string nested(int n, const std::string& open, const std::string& inside, const std::string& close) {
  return times(n, open) + inside + times(n, close);
}

TEST(SceneMistakes, DeepNestingIsRefused) {
  const int n = 100000;
  const std::string deep = nested(30000, "a{b=", "a", "}");
  refused({
      {"gravity = " + nested(n, "[", "", "]") + "\n", {"t.toml:4: nested more than 64 deep"}},
      {"gravity = " + nested(n, "{a=", "1", "}") + "\n", {"t.toml:4: nested more than 64 deep"}},
      {times(n, "a.") + "a = 1\n", {"t.toml:4: nested more than 64 deep"}},
      {"x = \"'\"\n\"a\" " + times(n, ". 'a'") + " = 1\n", {"t.toml:5: nested more than 64 deep"}},
      {"[" + times(n, "a.") + "a]\n", {"t.toml:4: nested more than 64 deep"}},
      {"g = { " + times(n, "a.") + "a = 1 }\n", {"t.toml:4: nested more than 64 deep"}},
      {"g = [\n" + times(70, "{ a = 1, b.c = [") + "\n", {"t.toml:5: nested more than 64 deep"}},
      {placed(nested(n, "(", "1", ")")), {"t.toml:5: ", "parentheses nested more than 64 deep"}},
      {placed(nested(65, "abs(", "1", ")")), {"t.toml:5: ", "parentheses nested more than 64 deep"}},
      {placed(times(n, "-") + "1"), {"t.toml:5: "}},
      {placed(times(4000, "1?") + "1" + times(3999, ":1")), {"t.toml:5: "}},
      {"[parameters]\njoint = { default = \"" + deep + "\", meaning = \"m\" }\n",
       {"t.toml:5: ", "nested more than 64"}},
      {"needs = [\"joints\"]\n[parameters]\njoint = { default = \"pivot\", meaning = \"m\" }\n" + kNamed +
           "[[joint]]\nkind = \"" + deep + "\"\na = \"world\"\nb = \"a\"\nanchor = [0, 0]\n",
       {"t.toml:", "nested more than 64"}},
  });
  // Ordinary scenes are not nested deeply, whatever their strings and comments hold.
  const std::string dots = times(99, "."), open = times(99, "[");
  EXPECT_EQ(
      messageOf<2>("# " + dots + open + "\ngravity = [0.5, -9.81, 0.25]  # '" + open + "\n[limits]\ndrift = 1.5\n" +
                   "[[body]]\nname = \"\"\"" + dots + "\\\"\"\"\"\"\nposition = [\"" + nested(64, "(", "1 + 0.5", ")") +
                   "\", 0.5]\n" + kBall + "[parameters]\na = { default = 0, min = 0, max = 1, meaning = '''" + open +
                   "'''' }\nb = { default = 0, min = 0, max = 1, meaning = '" + open + "' }\n"),
      "no error");
  EXPECT_EQ(messageOf<2>(placed(times(4000, "1?1:") + "1")), "no error");
  EXPECT_EQ(messageOf<2>(placed(times(4000, "1+") + "1")), "no error");
}

TEST(SceneMistakes, DeepNestingEndsProgramsInOneLine) {
  Workspace w;
  const std::string deep = nested(30000, "a{b=", "a", "}"), lists = nested(100000, "[", "", "]");
  const std::string start = "{\"cases\": [{\"id\": \"c\", \"query\": \"signed_distance\", \"dim\": ";
  w.write("good.toml", kHead + "steps = 1\n" + kNamed);
  w.write("keys.toml", kHead + times(100000, "a.") + "a = 1\n");
  w.write("sweep.toml",
          "summary = \"s\"\nkind = \"boxes\"\n[axes]\ndimension = 2\nn = 8\ndistribution = \"uniform\"\n" +
              ("broadphase = \"" + deep + "\"\n"));
  w.write("list.json", "{\"cases\": " + lists + "}");
  w.write("id.json", "{\"cases\": [{\"id\": " + lists + "}]}");
  w.write("dim.json", start + nested(100000, "{\"a\":", "1", "}") + "}]}");
  w.write("torn.json", start + times(100000, "["));
  for (const std::string command :
       {"run keys.toml", "sweep keys.toml --store s.db", "sweep sweep.toml --store s.db", "verify --cases list.json",
        "verify --cases id.json", "verify --cases dim.json", "verify --cases torn.json",
        "run good.toml --pipeline \"solver=$(printf 'a{b=%.0s' $(seq 30000))\"", "verify --cases keys.toml"}) {
    const Outcome out = w.lpc(command);
    EXPECT_EQ(out.code, 2) << command << "\n" << out.text.substr(0, 2000);
    EXPECT_EQ(std::count(out.text.begin(), out.text.end(), '\n'), 1) << command;
    EXPECT_LT(out.text.size(), 2000u) << command;
    EXPECT_TRUE(out.text.find("nested more than 64 deep") != out.text.npos || command.ends_with("cases keys.toml"))
        << out.text;
  }
}

// Limits over all blocks together; the message names the block that exceeds them.
TEST(SceneMistakes, UnboundedScenesAreRefused) {
  const std::string million = "repeat = { i = 1000000, j = 1000000 }\n", many = "more than 1000000 ";
  const std::string spring = "[[force]]\na = \"world\"\nb = \"a\"\nkind = \"spring\"\n";
  const std::string push = "[[event]]\ndo = \"push\"\nbody = \"a\"\nimpulse = [1, 0]\nstep = 0\n";
  const std::string joints = "needs = [\"joints\"]\n";
  refused({
      {"[[body]]\n" + million + kBall, {"t.toml:5: " + many + "turns of loops in all blocks together"}},
      {"[[body]]\nwhen = 0\n" + million + kBall, {"t.toml:6: " + many + "turns of loops"}},
      {"[[body]]\nrepeat = { i = 1000000, j = 1000000, n = 0 }\n" + kBall, {"t.toml:5: " + many + "turns of loops"}},
      {"[[body]]\nwhen = 0\nrepeat = 600000\n" + kBall + "[[body]]\nrepeat = 600000\n" + kBall,
       {"t.toml:9: " + many + "turns of loops"}},
      {kNamed + spring + "when = 0\nrepeat = { i = 10000, j = 10000 }\n", {"t.toml:12: " + many + "turns of loops"}},
      {joints + kNamed + kPivot + "when = 0\nrepeat = { i = 10000, j = 10000 }\n",
       {"t.toml:14: " + many + "turns of loops"}},
      {kNamed + push + "until = 1e9\n", {"t.toml:7: " + many + "turns"}},
      {kNamed + push + "when = 0\nuntil = 100000\nrepeat = 1000\n", {"t.toml:14: " + many + "turns"}},
      {"[[body]]\nfrom = 5\nevery = 1\nuntil = 100000\nwhen = 0\nrepeat = 1000\n" + kBall,
       {"t.toml:9: " + many + "turns"}},
  });
  refused<2>({
      // building up to the limit takes a second
      {"[[body]]\nrepeat = 100000\nshapes = [" + times(200, "{ kind = \"circle\", radius = 1 },") + "]\n",
       {"t.toml:6: " + many + "shapes"}},
      {"[[body]]\nrepeat = 100000\nshapes = [\n{ kind = \"compound\", parts = [\n{ repeat = 10000, kind = \"circle\", "
       "radius = 1 }] }]\n",
       {"t.toml:8: " + many + "shapes"}},
      {"[[body]]\nrepeat = 1000\nshapes = [{ kind = \"polytope\", depth = 1, points = [" +
           times(1000, "[0, 0], [1, 0], [0, 1],") + "] }]\n",
       {"t.toml:6: " + many + "points"}},
  });
}

// A comma, an assignment and a second comparison have a meaning in the parser that a scene's author does not expect.
TEST(SceneMistakes, ExpressionsThatMeanSomethingElse) {
  const std::string head = "[parameters]\nn = { default = 3, min = 0, max = 9, meaning = \"m\" }\n";  // 4 and 5
  const auto when = [&](const std::string& text) {
    return head + "[[body]]\nrepeat = { i = 3 }\nwhen = '''" + text + "'''\n" + kBall;
  };
  const std::vector<BadScene> cases = {
      {"i=1", {"'=='"}},
      {"n=5", {"'n=5'", "'=='"}},
      {"n = n", {"'=='"}},
      {"n += 1", {"'=='"}},
      {"n => 1", {"'=='"}},
      {"i == 1 ? n = 2 : 3", {"'=='"}},
      {"0,5", {"comma", "point"}},
      {"1,000", {"comma", "point"}},
      {"max((1, 2), 3)", {"comma", "point"}},
      {"(0,5)", {"comma", "point"}},
      {"0 < n < 2", {"two chained comparisons", "&&"}},
      {"1 == 1 == 1", {"two chained comparisons"}},
      {"max(n, 1) < 2 < 3", {"two chained comparisons"}},
      {"n <> 3", {"two chained comparisons"}},
      {"sin(1e20)", {"finite", "100000 rad"}},
      {"cos(100001)", {"finite", "100000 rad"}},
      {"1e400", {"1e400"}},
      {"1e308 * 10", {"finite"}},
      {"", {"empty"}},
      {"  ", {"empty"}},
      {"1 2", {}},
      {"(1)(2)", {}},
      {"2n", {}},
      {"2(3)", {}},
      {"--5", {}},
      {"1 +", {}},
      {"n!", {}},
      {"!n", {}},
      {"5 % 3", {}},
      {"1; 2", {}},
      {"n & 1", {}},
      {"n && ", {}},
      {"0x10", {}},
      {"1_000", {}},
      {"1.2.3", {}},
      {"1e", {}},
      {"N", {"n"}},
      {"\"n\"", {}},
      {"1 ? 2", {}},
      {"1 : 2", {}},
      {"n++", {}},
      {"max(1)", {}},
      {"max(1, 2, 3)", {}},
      {"sin 1", {}},
      {"inf", {}},
      {"true", {}},
      {"()", {}},
      {")(", {}},
      {"max(0, sqrt(-1))", {"finite"}},
      {"max(sqrt(n - 9), 0)", {"finite"}},
      {"min(1, sin(200000))", {"finite", "100000 rad"}},
      {"max(0, 0 / (n - 3))", {"finite"}},
      {"max(0, mod(1, 0))", {"finite"}},
      {"min(0, mod(1, n - 3))", {"finite"}},
      {"sin(200000) > 0 ? 1 : 2", {"finite", "100000 rad"}},
      {"cos(n * 200000) > 0 ? 1 : 2", {"finite", "100000 rad"}},
      {"sqrt(-1) && 1", {"finite"}},
      {"abs(sqrt(-n)) < 1", {"finite"}},
      {"floor(sqrt(-1)) == 1", {"finite"}},
      {"max(0, harmonic(-1))", {"finite"}},
      {"harmonic(n + 0.5)", {"finite"}},
      {"harmonic(1e300)", {"finite"}},
  };
  for (const BadScene& c : cases) {
    Parts parts = c.parts;
    parts.push_back("t.toml:8: ");
    refused({{when(c.text), parts}});
  }
  // A NUL character would end the text early.
  refused({{placed("1 \\u0000 +* 2"), {"t.toml:5: '1 \\x00 +* 2'", "control character"}}});
  // What valid expressions mean.
  Expressions e(1);
  e.setGlobal("n", 3);
  const std::vector<std::pair<std::string, double>> right = {
      {"n == 3", 1},
      {"n >= 3 && n != 2", 1},
      {"1 < n && n < 2", 0},
      {"n < 2 ? n > 1 : n > 2", 1},
      {"max(n > 2, n < 2)", 1},
      {"(n > 2) == (n < 4)", 1},
      {"n <= 2 || n == 3", 1},
      {"max( min(1, 2) , 3 )", 3},
      {"max(1, .5)", 1},
      {"5. + 1e2", 105},
      {"-2^2", -4},
      {"2^-1", 0.5},
      {"+n", 3},
      {"1 +\n\t2", 3},
      {"1 ? 2 : 3 ? 4 : 5", 2},
      {"n > 0 ? 1 / n : 0", 1.0 / 3},
      {"n < 0 ? sqrt(n) : sqrt(-n + 4)", 1},
      {"n > 0 ? 1 : sqrt(-1)", 1},
      {"1 > 0 ? max(1, 2) : max(0, sqrt(-1))", 2},
      {"n < 0 ? mod(1, 0) : n == 3 ? 7 : sin(200000)", 7},
  };
  for (const auto& [text, value] : right) EXPECT_EQ(e.evaluate(text), value) << text;
  for (int i = 0; i < 2; ++i) EXPECT_THROW(e.evaluate("max(0, sqrt(-1))"), UserError) << "forgotten at the second";
  EXPECT_THROW(e.evaluate("n = 5"), UserError);
  EXPECT_EQ(e.evaluate("n"), 3) << "a refused assignment has changed it";
}

TEST(SceneMistakes, ReservedNamesAreRefused) {
  const auto parameter = [](const std::string& name) {
    return "[parameters]\n" + name + " = { default = 3, min = 0, max = 9, meaning = \"m\" }\n";
  };
  std::vector<BadScene> cases;
  for (const std::string name : {"k", "step", "part", "dimension"}) {
    cases.push_back({parameter(name), {"t.toml:5: ", "'" + name + "'", "dimension, k, part, step"}});
  }
  for (const std::string name : {"max", "pi", "rand"})
    cases.push_back({parameter(name), {"t.toml:5: ", "'" + name + "'"}});
  for (const std::string name : {"a-b", "1x", "\"\"", "\"a b\""}) {
    cases.push_back({parameter(name), {"t.toml:5: ", "letters, digits"}});
  }
  for (const std::string name : {"k", "step", "part", "dimension", "max", "pi"}) {
    cases.push_back({"[[body]]\nrepeat = { " + name + " = 3 }\n" + kBall, {"t.toml:5: ", "'" + name + "'", "already"}});
    cases.push_back({"[[body]]\nlet = { " + name + " = 3 }\n" + kBall, {"t.toml:5: ", "'" + name + "'", "already"}});
  }
  cases.push_back({"[[body]]\nrepeat = { i = \"i\" }\n" + kBall, {"t.toml:5: ", "'i'"}});
  cases.push_back({"[[body]]\nrepeat = { i = \"j\", j = 3 }\n" + kBall, {"t.toml:5: ", "'j'"}});
  cases.push_back({"[[body]]\nrepeat = { i = 3 }\nlet = { i = \"5\" }\n" + kBall, {"t.toml:6: ", "'i'", "already"}});
  cases.push_back({"[[body]]\nrepeat = { i = 0 }\nlet = { i = \"5\" }\n" + kBall, {"t.toml:6: ", "'i'", "already"}});
  for (const std::string name : {"world", "a[0]", "["}) {
    cases.push_back({"[[body]]\nname = \"" + name + "\"\n" + kBall, {"t.toml:5: ", "'" + name + "'", "'world'"}});
    cases.push_back({"[[event]]\ndo = \"add\"\nstep = 1\nname = \"" + name + "\"\n" + kBall,
                     {"t.toml:7: ", "'" + name + "'", "'world'"}});
  }
  cases.push_back({"[[body]]\nlet = { a-b = 3 }\n" + kBall, {"t.toml:5: ", "'a-b'", "letters, digits"}});
  refused(cases);
}

// In the scene's own table each name may use the names above it, so a cycle is an unknown name.
TEST(SceneMistakes, NamesOfTheTableLet) {
  const std::string n = "[parameters]\nn = { default = 3, min = 0, max = 9, meaning = \"m\" }\n";
  std::vector<BadScene> cases = {
      {"[let]\na = \"b\"\nb = \"a\"\n", {"t.toml:5: ", "'b'"}},
      {"[let]\na = \"a + 1\"\n", {"t.toml:5: ", "'a + 1'"}},
      {"[let]\na = 1\nb = \"2 * aa\"\n", {"t.toml:6: ", "'2 * aa'", "Valid names: a dimension"}},
      {"[let]\na = \"k\"\n", {"t.toml:5: ", "'k'"}},
      {"[let]\na = \"1 / 0\"\n", {"t.toml:5: ", "finite"}},
      {"[let]\na = true\n", {"t.toml:5: ", "valid: a number"}},
      {"let = 3\n", {"t.toml:4: ", "'let'"}},
      {n + "[let]\nn = 4\n", {"t.toml:7: ", "'n'", "already"}},
      {"[let]\na-b = 4\n", {"t.toml:5: ", "'a-b'", "letters, digits"}},
      {"[let]\ni = 4\n[[body]]\nrepeat = { i = 2 }\n" + kBall, {"t.toml:7: ", "'i'", "already"}},
      {"[let]\ni = 4\n[[body]]\nlet = { i = 2 }\n" + kBall, {"t.toml:7: ", "'i'", "already"}},
      {"[[body]]\nlet = { a = 2 }\n" + kBall + "[let]\nb = \"a\"\n", {"t.toml:8: ", "'a'"}},
  };
  for (const std::string name : {"k", "step", "part", "dimension", "max", "pi", "perturb"}) {
    cases.push_back({"[let]\n" + name + " = 3\n", {"t.toml:5: ", "'" + name + "'", "already"}});
  }
  std::string many = "[let]\n";
  for (int i = 0; i < 101; ++i) many += "l" + std::to_string(i) + " = 1\n";
  cases.push_back({many, {"t.toml:105: more than 100 parameters, indices and 'let's together"}});
  refused(cases);
}

// Each expression is compiled with all names.
TEST(SceneMistakes, TooManyNamesAreRefused) {
  const auto parameters = [](int n) {
    std::string out = "[parameters]\n";
    for (int i = 0; i < n; ++i) {
      out += "p" + std::to_string(i) + " = { default = 3, min = 0, max = 9, meaning = \"m\" }\n";
    }
    return out;
  };
  const auto lets = [](int n) {
    std::string out = "[[body]]\nrepeat = { i = 1, j = 2 }\nlet = { ";
    for (int i = 0; i < n; ++i) out += (i ? ", l" : "l") + std::to_string(i) + " = \"i + 1\"";
    return out + " }\n" + kBall;
  };
  const std::string many = "more than 100 parameters, indices and 'let's together";
  EXPECT_EQ(messageOf<2>(parameters(100)), "no error");
  EXPECT_EQ(messageOf<2>(lets(98) + lets(98)), "no error");
  EXPECT_EQ(messageOf<2>(parameters(50) + lets(48)), "no error");
  refused({{parameters(101), {"t.toml:105: " + many}},
           {lets(99), {"t.toml:6: " + many}},
           {parameters(50) + lets(49), {"t.toml:57: " + many}},
           {lets(4000), {"t.toml:6: " + many}}});
}

// Finite numbers that no world can process.
TEST(SceneMistakes, NumbersBeyondTheArithmetic) {
  const std::string joints = "needs = [\"joints\"]\n", plane = "shapes = [{ kind = \"plane\" }]\n";
  const auto shape = [](const std::string& fields) { return "[[body]]\nshapes = [{ kind = " + fields + " }]\n"; };
  const std::string fixed = "type = \"fixed\"\n";
  const auto force = [](const std::string& kind, const std::string& keys) {
    return "[[force]]\nkind = \"" + kind + "\"\n" + keys;
  };
  refused({
      {"[[body]]\nangle = 1e308\n" + kBall, {"t.toml:5: ", "'angle' is 1e+308", "-1e+05 to 1e+05 rad"}},
      {"[[body]]\nangle = [0, 0, -1e6]\n" + kBall, {"t.toml:5: ", "'angle' is -1e+06", "-1e+05 to 1e+05 rad"}},
      {shape("\"circle\", radius = 1, angle = \"1e300\""), {"t.toml:5: ", "'angle' is 1e+300", "1e+05 rad"}},
      {kNamed + "[[event]]\ndo = \"set\"\nstep = 1\nbody = \"a\"\nangle = 1e308\n", {"t.toml:11: ", "'angle'", "rad"}},
      {shape("\"circle\", radius = 1, offset = [1e300, 0]"), {"t.toml:4: ", "inertia is too large"}},
      {shape("\"circle\", radius = 1e200, density = 1e-300"), {"t.toml:4: ", "is too large"}},
      {"[[body]]\n" + fixed + "shapes = [{ kind = \"box\", half = [1e300, 1e300, 1e300] }]\n",
       {"t.toml:4: ", "inf kg"}},
      {"[[body]]\ntype = \"kinematic\"\n" + plane, {"t.toml:4: ", "plane", "fixed"}},
      {"[[body]]\nshapes = [{ kind = \"plane\" }, { kind = \"circle\", radius = 1 }]\n",
       {"t.toml:4: ", "plane", "fixed"}},
      {"[[body]]\nfrom = 10\nremove = 5\n" + kBall, {"t.toml:6: ", "'remove' is 5", "step 10"}},
      {"[[body]]\nfrom = 10\nevery = 5\nuntil = 30\nremove = 24\n" + kBall,
       {"t.toml:8: ", "'remove' is 24", "step 25"}},
      {joints + kNamed + "[[joint]]\nkind = \"pivot\"\na = \"a\"\nb = \"a\"\nanchor = [0, 0]\n",
       {"t.toml:8: ", "a joint between a body and itself"}},
      {joints + kNamed +
           "[[event]]\ndo = \"joint\"\nstep = 1\nkind = \"pivot\"\na = \"a\"\nb = \"a\"\nanchor = [0, 0]\n",
       {"t.toml:8: ", "a joint between a body and itself"}},
      {kNamed + force("spring", "a = \"a\"\nb = \"a\"\n"), {"t.toml:7: ", "'spring' acts between a body and itself"}},
      {kNamed + "[[body]]\nname = \"wall\"\n" + fixed + kBall + force("spring", "a = \"world\"\nb = \"wall\"\n"),
       {"t.toml:11: ", "'spring' acts on bodies that cannot move; valid: at least one dynamic body"}},
      {kNamed + force("spring", "a = \"a\"\n"), {"t.toml:7: ", "'spring' needs a body to act on", "valid: b"}},
      {kNamed + force("spring", "b = \"c\"\n"), {"t.toml:9: ", "unknown body 'c'"}},
      {kNamed + force("drag", "a = \"a\"\n"), {"t.toml:7: ", "'drag' takes no body a"}},
      {kNamed + force("drag", "anchor_b = [1, 0]\nb = \"a\"\n"), {"t.toml:7: ", "'drag' takes no anchors"}},
      {kNamed + force("attraction", "anchor_b = [1, 0]\na = \"a\"\n"), {"t.toml:7: ", "centres of mass"}},
      {kNamed + force("spring", "b = \"a\"\nparameters = { rest_length = 1 }\n"),
       {"t.toml:7: ", "ends of the spring coincide", "rest_length=0"}},
      {kNamed + force("torque", "a = \"a\"\n"), {"t.toml:7: ", "has a body a but no body b"}},
      {kNamed + force("drag", "from = 5\nuntil = 5\n"), {"t.toml:10: ", "'until' is 5", "a later one"}},
      {"[[body]]\nname = \"b\"\nremove = 3\n" + kBall + force("drag", "b = \"b\"\nfrom = 4\n"),
       {"t.toml:8: ", "'b' does not exist", "removed at 3"}},
      {kNamed + "[[spring]]\nb = \"a\"\nstiffness = 1\n",
       {"t.toml:7: ", "unknown block [[spring]]", "[[force]] with kind"}},
      {kNamed + kPivot, {"t.toml:7: ", "a joint", "'needs' with \"joints\""}},
      {kNamed + "[[event]]\ndo = \"joint\"\nstep = 1\nkind = \"pivot\"\na = \"world\"\nb = \"a\"\nanchor = [0, 0]\n",
       {"t.toml:7: ", "a joint", "'needs' with \"joints\""}},
      {kNamed + "[[joint]]\nrepeat = 0\n", {"t.toml:7: ", "'needs' with \"joints\""}},
  });
  const std::string hinge =
      joints + kNamed + "[[joint]]\nkind = \"hinge\"\na = \"world\"\nb = \"a\"\nanchor = [0, 0]\n";
  EXPECT_NE(messageOf<3>(hinge + "axis = [1e308, 1e308, 0]\n").find("t.toml:13: 'axis' is too long"),
            std::string::npos);
  EXPECT_EQ(messageOf<2>("[[body]]\nfrom = 10\nevery = 5\nuntil = 30\nremove = \"step\"\n" + kBall), "no error");
  for (const double angle : {-1e5, 1e5, 3.0}) {
    EXPECT_EQ(messageOf<3>("[[body]]\nangle = " + std::to_string(angle) + "\n" + kBall), "no error");
  }
  // Numbers that f64 holds but f32 does not: planning uses f64, and the worker rejects them.
  Workspace w;
  w.write("far.toml", kHead + "steps = 1\n[[body]]\nposition = [\"1e39\", 0]\n" + kBall);
  w.write("turned.toml", kHead + "steps = 1\n[[body]]\nangle = 1e308\n" + kBall);
  EXPECT_EQ(w.lpc("run far.toml").code, 0);
  EXPECT_EQ(w.lpc("run turned.toml").code, 2);
  if (!test::kSingle) GTEST_SKIP() << "this build has no f32";
  const Outcome out = w.lpc("run far.toml --precision f32");
  EXPECT_EQ(out.code, 2) << out.text;
  EXPECT_EQ(out.text, "lpc: far.toml:6: 1e+39 is too large for this precision; valid: up to 3.4028234663852886e+38\n");
}

// Whatever text a message quotes, it stays one line that a terminal and a table can show.
TEST(SceneMistakes, MessagesAreOneLineWhateverTheyQuote) {
  Workspace w;
  w.write("good.toml", kHead + "steps = 1\n" + kNamed);
  w.write("control.toml", kHead + "[[body]]\nshapes = [{ kind = \"a\\u0000b\\n\\u001b[31mc\\u009bd\", radius = 1 }]\n");
  w.write("key.toml", kHead + "\"a\\nb\" = 1\n");
  w.write("expression.toml", kHead + placed("1 \\n\\u0000 +* 2"));
  const std::string rest = "\"\ndimensions = [2]\nsteps = 1\n" + kNamed;
  w.write("name.toml", "summary = \"s\"\nname = \"t\\u001b[31m" + rest);
  w.write("summary.toml", "name = \"t\"\nsummary = \"s\\n\\u009bt" + rest);
  w.write("lo\nng.toml", kHead + "[[body]]\nrepeat = 0\nshapes = [\n{ kind = \"circle\", radius = \"nobody\" }]\n");
  w.write("long.toml", kHead + "[[body]]\ntype = \"" + std::string(10000000, 'x') + "\"\n" + kBall);
  w.write("bytes.toml", kHead + "x = \"\xff\xfe\"\n");
  w.write("id.json", "{\"cases\": [{\"id\": \"a\\nb" + std::string(10000000, 'x') + "\", \"query\": 3}]}");
  for (const std::string command :
       {"run control.toml", "run name.toml", "run summary.toml", "run \"$(printf 'lo\\nng.toml')\"", "run key.toml",
        "run expression.toml", "run long.toml", "run bytes.toml", "verify --cases id.json",
        "run good.toml --pipeline \"$(printf 'sol\\nver=\\377')\"",
        "run good.toml --param \"$(printf 'a\\033[31m\\nb=3')\"", "run \"$(printf 'no\\nbody\\377')\"",
        "\"$(printf 'no\\nbody\\377')\"", "run good.toml \"$(printf -- '--no\\nbody\\377')\""}) {
    const Outcome out = w.lpc(command);
    EXPECT_EQ(out.code, 2) << command << "\n" << out.text.substr(0, 2000);
    EXPECT_TRUE(out.text.starts_with("lpc: ")) << out.text;
    EXPECT_LT(out.text.size(), 2000u) << command;
    for (std::size_t i = 0; i < out.text.size(); ++i) {
      const auto c = static_cast<unsigned char>(out.text[i]);
      EXPECT_TRUE(c >= 0x20 ? c < 0x7f : (c == '\n' && i + 1 == out.text.size())) << command << " " << int(c);
    }
  }
  EXPECT_EQ(w.lpc("run name.toml").text, "lpc: name.toml:2: 'name' is 't\\x1b[31m'; valid: one line of text\n");
  EXPECT_EQ(w.lpc("run summary.toml").text,
            "lpc: summary.toml:2: 'summary' is 's\\n\\xc2\\x9bt'; valid: one line of text\n");
  EXPECT_NE(w.lpc("run \"$(printf 'lo\\nng.toml')\"").text.find("ng.toml:7: 'nobody'"), std::string::npos);
  EXPECT_NE(w.lpc("run control.toml").text.find("'a\\x00b\\n\\x1b[31mc\\xc2\\x9bd'; valid: sphere"), std::string::npos)
      << w.lpc("run control.toml").text;
}

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::scene_mistakes_test
