// SPDX-License-Identifier: Zlib
// The registry against the documents, and against the needs of reports.
#include "framework/stage/registry.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>

#include "tests/expect_caught.h"

namespace lpc { inline namespace LPC_PRECISION { namespace {

std::string read(const std::string& path) {
  std::ifstream in(std::string(LPC_SOURCE_DIR) + "/" + path);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(RegistryRules, EveryStageHasACompetitorInBothDimensions) {
  for (int d : {2, 3}) {
    for (int k = 0; k < kStageKinds; ++k) {
      const auto stage = static_cast<StageKind>(k);
      if (!isOurs(stageInfo(stage))) continue;
      EXPECT_FALSE(Registry::instance().list(stage, d).empty()) << stageName(stage) << " in " << d << "D";
    }
  }
}

// "| stage | a, b, c |" rows between the marks in docs/architecture.md. A new algorithm may be missing from the page
// until it is accepted (.ci/run is strict); the page may not name an unknown algorithm.
TEST(RegistryRules, TheArchitecturePageNamesOnlyWhatIsRegistered) {
  const std::string page = read("docs/architecture.md");
  const std::size_t begin = page.find("<!-- registry -->"), end = page.find("<!-- end -->");
  ASSERT_NE(begin, std::string::npos);
  const std::string table = page.substr(begin, end - begin);
  const std::regex row("\\| ([a-z_]+) \\| ([a-z0-9_, ]+) \\|");
  int named = 0;
  for (auto it = std::sregex_iterator(table.begin(), table.end(), row); it != std::sregex_iterator(); ++it) {
    if ((*it)[1] == "stage") continue;
    const StageInfo* stage = stageByName((*it)[1].str());
    ASSERT_TRUE(stage) << "no stage is called " << (*it)[1];
    std::istringstream names((*it)[2].str());
    for (std::string name; std::getline(names >> std::ws, name, ','); ++named) {
      const auto& all = Registry::instance().all();
      EXPECT_TRUE(all.contains({stage->kind, 2, name}) || all.contains({stage->kind, 3, name}))
          << "no " << stage->name << " is called " << name << "; mend the page: lpc list --into docs/architecture.md";
    }
  }
  EXPECT_GT(named, 20);
}

// | `stage` `name` | source | departs in | why | `setting` | in docs/sources.md.
TEST(RegistryRules, TheSourcesPageMatchesTheRegistry) {
  const std::string page = read("docs/sources.md");
  const std::regex row("\n\\| `([a-z_]+)` `([a-z_]+)` \\| ([^|]+) \\| ([^|]*) \\| [^|]* \\| ?`?([^|`]*)`? \\|");
  int methods = 0, same = 0;
  for (auto it = std::sregex_iterator(page.begin(), page.end(), row); it != std::sregex_iterator(); ++it, ++methods) {
    const std::string name = (*it)[2], source = (*it)[3], departs = (*it)[4], setting = (*it)[5];
    SCOPED_TRACE(name);
    const StageInfo* stage = stageByName((*it)[1].str());
    ASSERT_TRUE(stage);
    const auto found = Registry::instance().all().find({stage->kind, 2, name});
    ASSERT_NE(found, Registry::instance().all().end());
    const Registered& r = found->second;
    std::string plain = source;
    std::transform(plain.begin(), plain.end(), plain.begin(), [](unsigned char c) { return std::tolower(c); });
    EXPECT_TRUE(plain.find(r.info.paper) != plain.npos || source.starts_with("none")) << r.info.paper;
    if (setting.empty()) continue;
    const Spec spec = Spec::parse(setting);
    EXPECT_EQ(spec.name, name);
    EXPECT_NO_THROW(r.create(spec));
    if (departs != "nothing") continue;
    EXPECT_EQ(r.canonical(spec).text(), r.canonical(Spec::parse(name)).text()) << "the default departs";
    ++same;
  }
  EXPECT_GT(methods, 15);
  EXPECT_GT(same, 0);
}

TEST(RegistryRules, EveryAlgorithmDescribesItself) {
  const std::string papers = read("docs/references.bib");
  const std::regex name("[a-z][a-z0-9_]*");
  for (const auto& [key, r] : Registry::instance().all()) {
    SCOPED_TRACE(r.info.name);
    EXPECT_TRUE(std::regex_match(r.info.name, name));
    EXPECT_FALSE(r.info.summary.empty());
    EXPECT_FALSE(r.info.complexity.empty());
    EXPECT_EQ(r.info.summary.find('\n'), std::string::npos);
    if (!r.info.paper.empty()) {
      EXPECT_NE(papers.find("{" + r.info.paper + ","), std::string::npos)
          << "docs/references.bib lacks " << r.info.paper;
    }
    for (const FailureMode& f : r.info.failures) EXPECT_FALSE(f.when.empty() || f.symptom.empty() || f.test.empty());
    for (const ParamInfo& p : r.params) EXPECT_FALSE(p.meaning.empty() || p.unit.empty()) << p.name;
    const bool rubs = r.stage == StageKind::solver || r.stage == StageKind::velocity;
    EXPECT_EQ(r.info.friction != FrictionLaw::unstated, rubs) << "solvers and velocity resolvers have a friction law";
    for (const FrictionChoice& other : r.info.otherFriction) {
      const auto p = std::find_if(r.params.begin(), r.params.end(),
                                  [&](const ParamInfo& param) { return param.name == other.parameter; });
      ASSERT_NE(p, r.params.end()) << other.parameter;
      EXPECT_NE(std::find(p->choices.begin(), p->choices.end(), other.choice), p->choices.end()) << other.choice;
      EXPECT_NE(p->defaultText, other.choice) << "the default's law is `friction`";
      EXPECT_NE(other.law, r.info.friction) << other.choice << " changes nothing";
    }
    if (r.info.role != AlgorithmRole::competitor) continue;
    const std::string folder = "algorithms/" + std::string(stageName(r.stage)) + "/" + r.info.name + ".cpp";
    EXPECT_TRUE(r.file.ends_with(folder)) << r.file << " should be " << folder;
  }
}

/// A method that solves contacts has a parameter of effort, or one in its parts, or a reason for having none.
bool saysItsEffort(const Registered& r) {
  if (r.stage != StageKind::solver && r.stage != StageKind::velocity && r.stage != StageKind::position) return true;
  const bool ofParts = std::any_of(r.params.begin(), r.params.end(), [](const ParamInfo& p) { return p.stage; });
  return (firstOf(ParamRole::effort, r.params) || ofParts) == r.info.noEffort.empty();
}

TEST(RegistryRules, EveryMethodSaysItsEffort) {
  int with = 0, without = 0;
  for (const auto& [key, r] : Registry::instance().all()) {
    EXPECT_TRUE(saysItsEffort(r)) << stageName(r.stage) << ' ' << r.info.name;
    (r.info.noEffort.empty() ? with : without) += r.stage == StageKind::velocity;
  }
  EXPECT_GT(with, 2 * without);
  EXPECT_GT(without, 0);
  // Planted bugs: a method that iterates without declaring it, and one that declares that it does not.
  for (Registered r : {Registry::instance().find(StageKind::velocity, 2, "catto"),
                       Registry::instance().find(StageKind::solver, 3, "xpbd")}) {
    for (ParamInfo& p : r.params) p.role = ParamRole::manner;
    test::expectCaught("registry: " + r.info.name + " says nothing of its effort", saysItsEffort(r));
    r.info.noEffort = "solves directly";
    EXPECT_TRUE(saysItsEffort(r));
  }
  Registered both = Registry::instance().find(StageKind::velocity, 2, "catto");
  both.info.noEffort = "solves directly";
  test::expectCaught("registry: effort beside a reason for none", saysItsEffort(both));
}

TEST(RegistryRules, ParametersWithRolesAreSettableNumbers) {
  for (const auto& [key, r] : Registry::instance().all()) {
    for (const ParamInfo& p : r.params) {
      EXPECT_NE(p.name, "effort") << r.info.name << ": what stars of sweeps call the first of this role";
      if (p.role == ParamRole::manner) continue;
      EXPECT_TRUE(p.range) << r.info.name << ' ' << p.name;
    }
    Spec spec{r.info.name, {}};
    const EffortPlace place = effortIn(r.stage, r.dimension, spec);
    ASSERT_TRUE(place.method);
    if (place.parameter) place.method->set(place.parameter->name, Spec{"7", {}});
    EXPECT_NO_THROW(r.create(spec)) << spec.text();
  }
  Spec solver = Spec::parse("split_solver{position=linear}");
  const EffortPlace place = effortIn(StageKind::solver, 2, solver);
  ASSERT_TRUE(place.parameter);
  place.method->set(place.parameter->name, Spec{"7", {}});
  EXPECT_EQ(solver.text(), "split_solver{position=linear,velocity=catto{iterations=7}}");
  solver = Spec::parse("split_solver{velocity=direct_lcp,position=linear}");
  EXPECT_FALSE(effortIn(StageKind::solver, 2, solver).parameter) << "iterations of its position resolver are not its";
}

// The friction law of a spec is that of its choices. Each choice of a parameter `friction` is a different law. Every
// law has a method.
TEST(RegistryRules, EveryFrictionLawHasAMethod) {
  std::set<std::string_view> used;
  for (const auto& [key, r] : Registry::instance().all()) {
    used.insert(frictionLawName(frictionLaw(r.info, Spec{r.info.name, {}})));
    for (const ParamInfo& p : r.params) {
      for (const std::string& choice : p.choices) {
        Spec spec{r.info.name, {}};
        spec.set(p.name, Spec{choice, {}});
        const FrictionLaw law = frictionLaw(r.info, spec);
        used.insert(frictionLawName(law));
        if (p.name == "friction" && !p.stage) {
          EXPECT_EQ(law == r.info.friction, choice == p.defaultText) << r.info.name << ' ' << choice;
        }
      }
    }
  }
  for (int i = 0; i <= static_cast<int>(FrictionLaw::ofItsParts); ++i) {
    const std::string_view law = frictionLawName(static_cast<FrictionLaw>(i));
    EXPECT_TRUE(used.contains(law)) << law << " is the law of no method";
  }
}

// The text of all tests, with line breaks and indents reduced to single blanks.
std::string testSources() {
  std::string all;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(LPC_SOURCE_DIR "/tests")) {
    const auto kind = entry.path().extension();
    if (kind != ".cpp" && kind != ".h") continue;
    std::ifstream in(entry.path());
    for (std::string word; in >> word;) all += word + ' ';
  }
  return all;
}

/// Is this the name of a test, or of a property in a list that a test runs?
bool namesATest(const std::string& name, const std::string& sources) {
  const std::size_t dot = name.find('.');
  const std::string test =
      "(" + name.substr(0, dot) + ", " + (dot == std::string::npos ? "" : name.substr(dot + 1)) + ")";
  const auto stands = [&](const std::string& text) { return sources.find(text) != std::string::npos; };
  return stands("TEST" + test) || stands("TEST_F" + test) || stands("TEST_P" + test) || stands('"' + name + '"');
}

TEST(RegistryRules, EveryDeclaredFailureNamesATest) {
  const std::string sources = testSources();
  for (const auto& [key, r] : Registry::instance().all()) {
    for (const FailureMode& f : r.info.failures) {
      EXPECT_TRUE(namesATest(f.test, sources)) << r.info.name << " names '" << f.test << "', which is no test";
    }
  }
  EXPECT_TRUE(namesATest("RegistryRules.CanonicalTextIsAFixedPoint", sources));
  EXPECT_FALSE(namesATest(std::string("RegistryRules.No") + "SuchTest", sources));
}

TEST(RegistryRules, ThePropertiesPageNamesTestsThatExist) {
  const std::string page = read("docs/properties.md"), sources = testSources();
  const std::regex name("`([A-Z][A-Za-z0-9]*\\.[A-Za-z0-9_]+)`");
  int named = 0;
  for (auto it = std::sregex_iterator(page.begin(), page.end(), name); it != std::sregex_iterator(); ++it, ++named) {
    EXPECT_TRUE((*it)[1] == "Suite.Name" || namesATest((*it)[1], sources)) << (*it)[1];
  }
  EXPECT_GT(named, 20);
}

TEST(RegistryRules, CanonicalTextIsAFixedPoint) {
  for (const auto& [key, r] : Registry::instance().all()) {
    const Spec full = r.canonical(Spec{r.info.name, {}});
    EXPECT_EQ(r.canonical(full), full) << full.text();
    EXPECT_EQ(Spec::parse(full.text()), full);
    EXPECT_NE(r.create(full), nullptr);
  }
}

}  // namespace
}}  // namespace lpc::LPC_PRECISION
