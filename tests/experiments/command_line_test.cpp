// SPDX-License-Identifier: Zlib
// The `lpc` program as its user sees it.
#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>

#include "experiments/parse/toml_reader.h"
#include "framework/stage/plugin.h"
#include "framework/stage/registry.h"
#include "tests/experiments/workspace.h"

namespace lpc { inline namespace LPC_PRECISION { namespace command_line_test { namespace {

using test::Outcome;
using test::Workspace;

TEST(CommandLine, helpHasAnExample) {
  Workspace w;
  EXPECT_NE(w.lpc("--help").text.find("Examples:"), std::string::npos);
  for (const std::string told : {"--help", "run --help", "--version"}) {
    const Outcome out = w.shell("(" LPC_BINARY_DIR "/bin/lpc " + told + " >/dev/full)");
    EXPECT_EQ(out.code, 2) << told << out.text;
    EXPECT_TRUE(out.text.starts_with("lpc: standard output cannot be written")) << told << out.text;
  }
  for (const char* command : {"list", "run", "sweep", "report", "merge", "import-benchmark", "replay", "needs",
                              "record", "break", "corpus"}) {
    const Outcome help = w.lpc(std::string(command) + " --help");
    EXPECT_EQ(help.code, 0) << command;
    EXPECT_NE(help.text.find("Example: lpc " + std::string(command)), std::string::npos) << help.text;
  }
}

// A command writes the page of names: every competitor once, and the rest of the page unchanged.
TEST(CommandLine, writesTheNamesIntoAPage) {
  Workspace w;
  const std::string page = w.write("page.md", "above\n<!-- registry -->\n| cache | of_old |\n<!-- end -->\nbelow\n");
  const Outcome out = w.lpc("list --into page.md");
  EXPECT_EQ(out.code, 0) << out.text;
  const std::string text = readFile(page);
  EXPECT_TRUE(text.starts_with("above\n<!-- registry -->\n| stage | names |\n| --- | --- |\n| broadphase | bsp, "));
  EXPECT_TRUE(text.ends_with("|\n<!-- end -->\nbelow\n")) << text;
  EXPECT_NE(text.find("\n| cache | by_distance, by_feature, none, recycling |\n"), std::string::npos) << text;
  EXPECT_EQ(text.find("libccd"), std::string::npos) << "a witness competes with nobody";
  w.lpc("list --into page.md");
  EXPECT_EQ(readFile(page), text);
}

TEST(CommandLine, listsOneStageAlone) {
  Workspace w;
  const Outcome out = w.lpc("list --stage joint");
  EXPECT_EQ(out.code, 0) << out.text;
  EXPECT_TRUE(out.text.starts_with("joint\n")) << out.text;
  EXPECT_NE(out.text.find("motor_torque=0 N m"), std::string::npos) << out.text;
  EXPECT_EQ(out.text.find("velocity\n"), std::string::npos) << out.text;
}

// Every failure that a method declares is listed, with all tests that show it and the dimension where it is limited to
// one.
TEST(CommandLine, listsDeclaredFailures) {
  Workspace w;
  const std::string text = w.lpc("list --name catto").text;
  const auto all = nlohmann::json::parse(w.lpc("list --name catto --json").text);
  std::set<std::string> failures;
  for (const auto& f : all["algorithms"][0]["failures"]) {
    const std::string when = f["when"], symptom = f["symptom"], test = f["test"];
    const std::string where = f["dimensions"].size() == 2 ? "" : " in " + f["dimensions"][0].dump() + "D";
    const std::string told = "      declared failure" + where + ": " + when + "\n          " + symptom + " (shown by ";
    const std::size_t at = text.find(told);
    ASSERT_NE(at, text.npos) << told << text;
    const std::size_t tests = at + told.size();
    EXPECT_NE(text.substr(tests, text.find('\n', tests) - tests).find(test), std::string::npos) << test << text;
    failures.insert(told);
  }
  EXPECT_GE(failures.size(), 4u);
  const std::string word = "declared failure";
  std::size_t lines = 0;
  for (std::size_t at = text.find(word); at != text.npos; at = text.find(word, at + 1)) ++lines;
  EXPECT_EQ(lines, failures.size()) << text;
  EXPECT_EQ(w.lpc("list --name sat").text.find(word), std::string::npos) << "it declares none";
}

// Names fit on a screen; parameters are shown on request, for one method or for all.
TEST(CommandLine, listsNamesAndDetailsOnRequest) {
  Workspace w;
  const Outcome brief = w.lpc("list"), all = w.lpc("list --all");
  const auto lines = [](const Outcome& out) { return std::count(out.text.begin(), out.text.end(), '\n'); };
  EXPECT_LE(lines(brief), 64) << brief.text;
  EXPECT_GT(lines(all), 200);
  for (const char* name : {"catto", "pyramid", "quick", "cylinder", "ms_per_step_median", "seconds"}) {
    EXPECT_NE(brief.text.find(name), std::string::npos) << name;
  }
  EXPECT_EQ(brief.text.find("warm_factor"), std::string::npos) << brief.text;
  for (const char* text : {"catto", "warm_factor=1", "base="}) EXPECT_NE(all.text.find(text), std::string::npos);

  const Outcome named = w.lpc("list --name naive");
  EXPECT_TRUE(named.text.starts_with("broadphase\n  naive ")) << named.text;
  EXPECT_NE(named.text.find("\nvelocity\n  naive "), std::string::npos) << named.text;
  EXPECT_EQ(named.text.find("catto"), std::string::npos) << named.text;
  const Outcome scene = w.lpc("list --name pyramid");
  EXPECT_TRUE(scene.text.starts_with("scenes\n  pyramid ")) << scene.text;
  EXPECT_NE(scene.text.find("base="), std::string::npos) << scene.text;
  const auto json = nlohmann::json::parse(w.lpc("list --name pyramid --json").text);
  EXPECT_EQ(json["scenes"].size(), 1u);
  EXPECT_TRUE(json["algorithms"].empty());
}

// Each number has its unit and is listed with others of its kind.
TEST(CommandLine, runPrintsUnitsByKind) {
  Workspace w;
  const Outcome out = w.lpc("run vertical_stack --param n=3 --steps 40 --plot");
  EXPECT_EQ(out.code, 0) << out.text;
  const auto at = [&](const std::string& text) { return out.text.find(text); };
  EXPECT_LT(at("\ncost\n"), at("  ms_per_step_median"));
  EXPECT_LT(at("  ms_per_step_median"), at("\nerror\n"));
  EXPECT_LT(at("\nerror\n"), at("\n  max_penetration "));
  EXPECT_LT(at("\n  max_penetration "), at("\ndetail\n"));
  EXPECT_LT(at("\ndetail\n"), at("\n  max_speed "));
  EXPECT_NE(out.text.npos, at("\n  max_speed "));
  EXPECT_NE(at("\n  gravity" + std::string(26 - 7, ' ') + " 10 m/s^2\n"), out.text.npos) << out.text;
  EXPECT_NE(at("\nkinetic "), out.text.npos) << "a line for each series";
  EXPECT_LT(at("\ntimeline: "), at("\nkinetic "));
  EXPECT_NE(at("█"), out.text.npos);

  const Outcome one = w.lpc("run bouncing_ball --steps 100 --plot height");
  EXPECT_NE(one.text.find("height m\n"), std::string::npos) << one.text;
  EXPECT_NE(one.text.find("100  step\n"), std::string::npos) << one.text;
  EXPECT_EQ(one.text.find("\nkinetic "), std::string::npos) << one.text;
}

// After a second of free fall the fastest body, the ball, has 9.81 m/s.
TEST(CommandLine, drawsARunAsAPicture) {
  const Workspace w;
  w.write("fall.toml",
          "name = \"f\"\nsummary = \"s\"\ndimensions = [2]\nsteps = 100\n[[body]]\nposition = [0, 9]\n"
          "shapes = [{ kind = \"circle\", radius = 0.5 }]\n");
  const Outcome ran = w.lpc("run fall.toml --dt 0.01 --plot fall.svg");
  ASSERT_EQ(ran.code, 0) << ran.text;
  EXPECT_TRUE(ran.text.ends_with("\nplot      fall.svg\n")) << ran.text;
  const std::string svg = readFile(w.path("fall.svg"));
  for (const char* label : {">energy (J)<", ">largest penetration (m)<", ">speed of the fastest body (m/s)<", ">9.81<",
                            ">1 s<", ">fall.toml, the default pipeline<"}) {
    EXPECT_NE(svg.find(label), svg.npos) << label;
  }
  EXPECT_EQ(svg.find("nan"), svg.npos);
  EXPECT_EQ(w.lpc("run fall.toml --plot no/fall.svg").code, 2);
}

// A spring that oscillates within a step: the axis ends at the series' extremes, and a column loses neither a peak nor
// a dip.
TEST(CommandLine, plotsPeaksAndDips) {
  Workspace w;
  w.write("swing.toml",
          "name = \"swing\"\nsummary = \"s\"\ndimensions = [2]\ndt = 0.01\nsteps = 900\ngravity = [0, 0, 0]\n"
          "[[body]]\nname = \"a\"\nposition = [0, 1]\nshapes = [{ kind = \"box\", half = [0.5, 0.5] }]\n"
          "[[force]]\nkind = \"spring\"\nb = \"a\"\nparameters = { stiffness = 39000 }\n");
  const Outcome out = w.lpc("run swing.toml --plot height");
  ASSERT_EQ(out.code, 0) << out.text;
  const std::size_t from = out.text.find("\nheight m\n");
  ASSERT_NE(from, out.text.npos) << out.text;
  std::istringstream plot(out.text.substr(from + 1));
  std::vector<std::string> lines;
  for (std::string line; std::getline(plot, line);) lines.push_back(line);
  ASSERT_GE(lines.size(), 13u);
  const double top = std::stod(lines[1]), bottom = std::stod(lines[12]);
  EXPECT_GT(top, 0.9);
  EXPECT_LT(bottom, -0.9) << out.text;
  EXPECT_NE(lines[6].find("░"), std::string::npos) << "some steps of a column are lower: " << out.text;
  EXPECT_NE(lines[12].find("█"), std::string::npos) << out.text;
  EXPECT_NE(w.lpc("run swing.toml --plot bodies").text.find("\nbodies\n"), std::string::npos) << "no blank for no unit";
}

struct Timeline {
  std::vector<std::string> rows;                // rows of the chart, from the top
  std::map<std::string, double> share, median;  // share (%) and median (ms) of each phase; "step": total
  std::string text;
};

Timeline timelineOf(const Workspace& w, const std::string& arguments) {
  Timeline out;
  const Outcome ran = w.lpc(arguments + " --plot timeline");
  EXPECT_EQ(ran.code, 0) << ran.text;
  out.text = ran.text.substr(std::min(ran.text.find("\ntimeline: "), ran.text.size()));
  std::istringstream lines(out.text);
  std::string line;
  std::getline(lines, line), std::getline(lines, line);
  for (int row = 0; row < 16 && std::getline(lines, line); ++row) out.rows.push_back(line.substr(line.find('|') + 1));
  static const std::regex phase(" +(?:[a-z.] )? +([a-zA-Z]+) +([0-9.]+) % +([0-9.e+-]+) .*");
  for (std::smatch m; std::getline(lines, line);) {
    if (std::regex_match(line, m, phase)) out.share[m[1]] = std::stod(m[2]), out.median[m[1]] = std::stod(m[3]);
  }
  return out;
}

// Phases are stacked in order from the bottom without gaps, and the highest column fills the chart.
bool isStacked(const Timeline& t) {
  const std::string order = "pcfvm. ";
  std::size_t filled = 0, columns = t.rows.empty() ? 0 : t.rows[0].size();
  for (std::size_t k = 0; k < columns; ++k) {
    for (std::size_t row = 0; row < t.rows.size(); ++row) {
      if (t.rows[row].size() != columns || order.find(t.rows[row][k]) == order.npos) return false;
      if (row > 0 && order.find(t.rows[row - 1][k]) < order.find(t.rows[row][k])) return false;
    }
    filled += t.rows[0][k] != ' ';
  }
  return filled > 0;
}

// Figures 7.1 and 7.2 of the 2009 report. Planted: a broadphase that sleeps for two milliseconds in each step.
TEST(CommandLine, drawsTheTimeline) {
  Workspace w;
  const Timeline slow = timelineOf(w, "--plugin " LPC_BINARY_DIR
                                      "/lib/liblpc_planted.so run vertical_stack --dimension 2 "
                                      "--param n=3 --steps 200 --pipeline broadphase=planted_slow");
  EXPECT_GE(slow.median.at("findPairs"), 2) << slow.text;
  EXPECT_TRUE(isStacked(slow)) << slow.text;
  EXPECT_EQ(slow.rows[0].size(), 90u) << slow.text;
  EXPECT_NE(slow.text.find("each column is the median of 3 steps\n"), std::string::npos) << slow.text;
  EXPECT_NE(slow.text.find(" 200  step\n"), std::string::npos) << slow.text;
  EXPECT_NE(slow.text.find(" bodies |"), std::string::npos) << slow.text;
  EXPECT_EQ(slow.text.find("\nkinetic "), std::string::npos) << "no series beside it";

  for (const char* solver : {"split_solver", "soft_step", "tgs_ngs", "avbd"}) {
    const Timeline t =
        timelineOf(w, std::string("run vertical_stack --param n=6 --steps 80 --pipeline solver=") + solver);
    EXPECT_TRUE(isStacked(t)) << t.text;
    ASSERT_EQ(t.share.size(), 7u) << t.text;
    double sum = 0;
    for (const auto& [phase, share] : t.share) sum += phase == "step" ? 0 : share;
    EXPECT_NEAR(sum, 100, 0.31) << "six that are rounded: " << t.text;
    EXPECT_EQ(t.share.at("step"), 100) << t.text;
    for (const char* phase : {"findPairs", "findContacts", "resolveVelocities"}) {
      EXPECT_GT(t.median.at(phase), 0) << phase << t.text;
    }
    EXPECT_EQ(t.rows[0].size(), 80u) << "a column for each step: " << t.text;
  }
  // The chart shows sleeping bodies: the box at the end.
  w.write("rest.toml",
          "name = \"rest\"\nsummary = \"s\"\ndimensions = [2]\nsteps = 200\ngravity = [0, -10, 0]\n"
          "needs = [\"cache\", \"friction\", \"rotation\", \"sleeping\"]\n"
          "[[body]]\ntype = \"fixed\"\nposition = [0, -1]\nshapes = [{ kind = \"box\", half = [5, 1] }]\n"
          "[[body]]\nposition = [0, 0.5]\nshapes = [{ kind = \"box\", half = [0.5, 0.5] }]\n");
  const Timeline rest = timelineOf(w, "run rest.toml --pipeline sleep=split_average");
  EXPECT_NE(rest.text.find("  0 .. 1\n"), std::string::npos) << rest.text;
  EXPECT_TRUE(w.lpc("run rest.toml --steps 0 --plot timeline").text.ends_with("\ntimeline: this run has no steps\n"));
}

// User mistakes: exit code 2 and one line that names the mistake and what is valid.
TEST(CommandLine, mistakesAreOneLineAndExitWithTwo) {
  Workspace w;
  const std::pair<const char*, std::vector<const char*>> cases[] = {
      {"", {"subcommand"}},
      {"dance", {"dance"}},
      {"run", {"scene"}},
      {"run pyramid --param base=x", {"base=x"}},
      {"run pyramid --param height=3", {"'height'", "base"}},
      {"run pyramid --param base=0", {"'base'", "200"}},
      {"run pyramid --dimension 4", {"4", "2, 3"}},
      {"run pyramid --pipeline velocity=catto{iterations=4}", {"solver=split_solver{velocity=catto{iterations=4}}"}},
      {"run pyramid --pipeline solver=catto", {"unknown solver 'catto'", "solver=split_solver{velocity=catto}"}},
      {"run pyramid --pipeline \"cache=none engine=box2d\"", {"replaces all stages", "engine=box2d"}},
      {"run pyramid --pipeline joint=hinge", {"joint is not part of a pipeline", "scenes"}},
      {"run pyramid --dimension 2 --pipeline contacts=query_clip{query=gjk}", {"in 2D", "did you mean 'gjk_epa'?"}},
      {"run pyramid --plot hieght", {"'hieght'", "did you mean 'height'?"}},
      {"run pyramid --plot timelnie", {"'timelnie'", "did you mean 'timeline'?"}},
      {"run pyramid --pipeline engine=box2d --memory", {"--memory", "an engine"}},
      {"run piramid", {"did you mean 'pyramid'?"}},
      {"run pyramid --param bsae=3", {"did you mean 'base'?"}},
      {"lsit", {"did you mean 'list'?"}},
      {"list --name cato", {"did you mean 'catto'?"}},
      {"run pyramid --dt 1e-400", {"'1e-400'", "valid: ", "2.3e-308"}},
      {"run pyramid --dimension 3000000000", {"'3000000000'", "valid: -2147483648 to 2147483647"}},
      {"run pyramid --steps 9223372036854775808", {"valid: -9223372036854775808 to 9223372036854775807"}},
      {"run pyramid --precision f16", {"f16", "f32"}},
      {"run pyramid --pipeline brodphase=naive", {"'brodphase'", "broadphase"}},
      {"run pyramid --pipeline broadphase=niave", {"'niave'", "naive"}},
      {"run pyramid --pipeline broadphase=sort_and_sweep{axis=9}", {"'axis'", "9"}},
      {"sweep nowhere", {"'nowhere'", "quick", "standard"}},
      {"sweep broadphase_crossover --only nobody", {"nobody"}},
      {"sweep quick_resolvers --precision f16", {"f16", "f64, f32"}},
      {"list --into nowhere.md", {"nowhere.md"}},
      {"list --stage bucket", {"'bucket'", "velocity", "joint"}},
      {"list --into /dev/null", {"/dev/null", "<!-- registry -->"}},
      {"verify --stage solver", {"'solver'", "pair_query, contacts, broadphase"}},
      {"verify --dimension 4", {"4", "2, 3"}},
      {"verify --role judge", {"'judge'", "witness"}},
      {"verify --methods gjk_epa{iterations=many}", {"iterations", "many"}},
      {"verify --dimension 2 --stage contacts --role witness", {"no method has this role"}},
      {"verify --cases nowhere.json --pairs 5", {"--cases", "excludes", "--pairs"}},
      {"list --into nowhere.md --stage velocity", {"--into", "excludes", "--stage"}},
      {"list --into nowhere.md --name catto", {"--into", "excludes", "--name"}},
      {"run pyramid --json --plot height", {"--json", "excludes", "--plot"}},
      {"replay nowhere.rec --tolerance 1", {"--tolerance requires --beside"}},
  };
  for (const auto& [arguments, parts] : cases) {
    const Outcome out = w.lpc(arguments);
    EXPECT_EQ(out.code, 2) << arguments << "\n" << out.text;
    EXPECT_EQ(std::count(out.text.begin(), out.text.end(), '\n'), 1) << arguments << "\n" << out.text;
    for (const char* part : parts) EXPECT_NE(out.text.find(part), std::string::npos) << arguments << "\n" << out.text;
  }
}

// Every numeric option of every subcommand, as listed in the help, rejects what is not a number.
TEST(CommandLine, numbersAreNumbers) {
  Workspace w;
  ASSERT_EQ(w.lpc("run pyramid --param base=2 --steps 1 --record a.rec").code, 0);
  const std::map<std::string, std::string> rest = {{"run", "pyramid"},
                                                   {"replay", "a.rec --beside a.rec"},
                                                   {"record", "pyramid --param base=2 --problems p.json"},
                                                   {"needs", "slope --store n.db"},
                                                   {"break", "slope --parameter friction --pipeline cache=none"},
                                                   {"sandbox", "pyramid --input nowhere.txt"},
                                                   {"sweep", "broadphase_crossover --store s.db --dry-run"},
                                                   {"verify", "--store v.db"},
                                                   {"corpus", "--export c"}};
  const std::regex subcommand("\n  ([a-z][a-z-]*) "), number("\n +(?:-[a-z],)?(--[a-z]+) (?:INT|UINT|FLOAT)");
  std::size_t tried = 0;
  const auto refused = [&](const std::string& arguments, const std::string& option, const std::string& given) {
    const Outcome out = w.lpc(arguments + " " + option + " " + given);
    EXPECT_EQ(out.code, 2) << arguments << " " << option << " " << given << "\n" << out.text;
    EXPECT_EQ(std::count(out.text.begin(), out.text.end(), '\n'), 1) << out.text;
    ++tried;
  };
  const std::string main = w.lpc("--help").text, subcommands = main.substr(main.find("\nSubcommands:"));
  std::size_t listed = 0;
  for (std::sregex_iterator c(subcommands.begin(), subcommands.end(), subcommand), end; c != end; ++c, ++listed) {
    const std::string command = (*c)[1], help = w.lpc(command + " --help").text;
    for (std::sregex_iterator o(help.begin(), help.end(), number); o != end; ++o) {
      ASSERT_TRUE(rest.count(command)) << "what must stand beside " << (*o)[1] << " of " << command << "?";
      for (const char* given : {"nan", "-1"}) {
        refused(command + " " + rest.at(command), (*o)[1], given);
      }
    }
  }
  EXPECT_GE(listed, 9u) << main;
  for (const char* given : {"nan", "-1", "''", "9223372036854775808", "0:nan", "3:"}) {  // a list of ranges
    refused("record " + rest.at("record"), "--steps", given);
  }
  for (const char* option : {"--steps", "--dt", "--dimension", "--seed"}) {  // one of each type
    if (std::string(option) != "--dt") refused("run pyramid", option, "9223372036854775808");
    for (const char* given : {"''", "' 5'", "'5 '", "5x", "0x10", "1e999", "inf", "-inf", "+5", "true"}) {
      refused("run pyramid", option, given);
    }
    if (std::string(option) != "--dt") refused("run pyramid", option, "1e3");
  }
  for (const char* given : {"nan", "inf", "1e999"}) {
    refused("sweep broadphase_crossover --store s.db", "--set", std::string("n=") + given);
  }
  for (const char* given : {"nan", "inf", "0x10", "' 5'", "5x", "''", "+5", "1e999"}) {
    refused("run pyramid", "--param", std::string("base=") + given);
    refused("needs pyramid --store n.db", "--param", std::string("base=") + given);
  }
  EXPECT_GE(tried, 97u);
  refused("needs slope --store n.db", "--perturb", "0.2");  // like the scene's parameter
  const std::filesystem::directory_iterator all(w.path(""));
  EXPECT_EQ(std::distance(begin(all), end(all)), 1) << "something was made";
  const auto ten = nlohmann::json::parse(w.lpc("run slope --json --steps 010").text);  // not octal
  EXPECT_EQ(ten["series"]["kinetic"].size(), 10u);
}

// Numbers in a pipeline, for every parameter of every method.
TEST(CommandLine, numbersOfMethodsAreNumbers) {
  std::size_t tried = 0;
  for (const auto& [key, entry] : Registry::instance().all()) {
    for (const ParamInfo& p : entry.params) {
      if (p.type != "real" && p.type != "integer") continue;
      for (const char* given : {"nan", "inf", "-inf", "1e999", "", "0x10", " 5", "5x", "+5", "5{x=1}"}) {
        Spec spec{entry.info.name, {}};
        spec.set(p.name, {given, {}});
        EXPECT_THROW(entry.create(spec), UserError) << entry.info.name << " " << p.name << "=" << given;
        ++tried;
      }
      ASSERT_TRUE(p.range) << entry.info.name << " " << p.name;
      EXPECT_TRUE(std::isfinite(p.range->lo) && std::isfinite(p.range->hi)) << entry.info.name << " " << p.name;
    }
  }
  EXPECT_GT(tried, 300u);
}

TEST(CommandLine, listsEverything) {
  Workspace w;
  const Outcome out = w.lpc("list --json");
  ASSERT_EQ(out.code, 0);
  const auto all = nlohmann::json::parse(out.text);
  bool found = false, ofSpaceAlone = false;
  for (const auto& a : all["algorithms"]) {
    for (const auto& p : a["params"]) ofSpaceAlone = ofSpaceAlone || (a["name"] == "gjk_epa" && p["name"] == "support");
    if (a["name"] != "sort_and_sweep") continue;
    found = true;
    EXPECT_EQ(a["dimensions"], (nlohmann::json{2, 3}));
    EXPECT_EQ(a["params"][0]["name"], "axis");
  }
  EXPECT_TRUE(found);
  EXPECT_TRUE(ofSpaceAlone) << "a parameter that a method of both dimensions has in 3D alone";
  EXPECT_GE(all["scenes"].size(), 15u);
  EXPECT_GE(all["sweeps"].size(), 9u);
  ASSERT_EQ(all["shapes"].size(), 10u);
  EXPECT_EQ(all["shapes"][5]["sizes"], (nlohmann::json{"half_length", "radius"}));
}

// A failure that a method has in 3D only is listed as such.
TEST(CommandLine, listsTheDimensionsOfAFailure) {
  Workspace w;
  const auto all = nlohmann::json::parse(w.lpc("list --json").text);
  for (const auto& [key, entry] : Registry::instance().all()) {
    for (const auto& a : all["algorithms"]) {
      if (a["stage"] != std::string(stageName(entry.stage)) || a["name"] != entry.info.name) continue;
      std::multiset<std::string> said, mine;
      for (const auto& f : a["failures"]) {
        const auto& where = f["dimensions"];
        if (std::count(where.begin(), where.end(), entry.dimension) > 0) said.insert(f["test"].get<std::string>());
      }
      for (const FailureMode& f : entry.info.failures) mine.insert(f.test);
      EXPECT_EQ(said, mine) << entry.info.name << ' ' << entry.dimension << 'D';
    }
  }
}

TEST(CommandLine, refusesAPluginOfAnotherBuild) {
  Workspace w;
  const std::string good = LPC_ABI_TEXT;
  w.write("none.so", "nothing of that kind");
  EXPECT_NE(w.lpc("--plugin none.so list").text.find("lpc_abi"), std::string::npos);
  std::string other = good;
  other.replace(other.find("f64"), 3, "f32");
  w.write("other.so", std::string("\x7f"
                                  "ELF") +
                          '\0' + other + '\0');
  const Outcome out = w.lpc("--plugin other.so list");
  EXPECT_EQ(out.code, 2);
  EXPECT_NE(out.text.find("f32"), std::string::npos) << out.text;
  EXPECT_NE(out.text.find("f64"), std::string::npos) << out.text;
}

// Code of a plugin may throw what is no exception, abort, exit or loop, when it is loaded and in constructors. The
// program says so in one line, or records the failure of the trial.
TEST(CommandLine, survivesAPluginThatFails) {
  Workspace w;
  const std::string plugin = std::string("--plugin ") + LPC_BINARY_DIR + "/lib/liblpc_planted.so ";
  const auto expectOneLine = [](const Outcome& out, const std::string& part) {
    EXPECT_EQ(out.code, 2) << out.text;
    EXPECT_EQ(std::count(out.text.begin(), out.text.end(), '\n'), 1) << out.text;
    EXPECT_NE(out.text.find(part), std::string::npos) << out.text;
  };
  for (const auto& [how, says] : {std::pair("throws", "it throws an object that is no std::exception"),
                                  {"exits", "it exits with code 0"},
                                  {"twice", "two algorithms are registered as broadphase planted_rude (2D)"}}) {
    ::setenv("LPC_PLANTED_LOAD", how, 1);
    const Outcome out = w.lpc(plugin + "list");
    ::unsetenv("LPC_PLANTED_LOAD");
    expectOneLine(out, says);
  }
  for (const auto& [bug, says] : {std::pair(1, "it throws an object that is no std::exception"),
                                  {2, "it dies of signal 6"},
                                  {3, "it exits with code 0"}}) {
    const std::string rude = "\"broadphase=planted_rude{bug=" + std::to_string(bug) + "}\"";
    expectOneLine(w.lpc(plugin + "run vertical_stack --dimension 2 --steps 2 --pipeline " + rude),
                  std::string("broadphase planted_rude cannot be created: ") + says);
  }
  expectOneLine(w.lpc(plugin + "verify --stage broadphase --dimension 2 --pairs 1 --methods \"planted_rude{bug=2}\""),
                "broadphase planted_rude cannot be created: it dies of signal 6");
}

TEST(CommandLine, versionIsTheProjects) {
  Workspace w;
  std::ifstream in(LPC_SOURCE_DIR "/CMakeLists.txt");
  const std::string cmake{std::istreambuf_iterator<char>(in), {}};
  EXPECT_NE(cmake.find("project(lpc VERSION " LPC_VERSION_TEXT " "), std::string::npos);
  EXPECT_NE(w.lpc("--version").text.find(LPC_VERSION_TEXT), std::string::npos);
}

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::command_line_test
