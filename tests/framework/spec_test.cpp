// SPDX-License-Identifier: Zlib
// Texts that name algorithms, read and written, and the registry that finds them.
#include "framework/stage/spec.h"

#include <gtest/gtest.h>

#include "framework/stage/registry.h"
#include "framework/stage/stage_sleep.h"
#include "tests/check_property.h"
#include "tests/draw.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace spec_test { namespace {

template <class F>
std::string errorOf(F&& f) {
  try {
    f();
  } catch (const UserError& e) {
    return e.what();
  }
  return "no error";
}

// A word that can be a name or value.
std::string drawWord() {
  static constexpr std::string_view kLetters = "ab_.+-019";
  std::string word;
  const int n = growingNumber(1, 6);
  for (int i = 0; i < n; ++i) word += kLetters[static_cast<std::size_t>(growingNumber(0, 9))];
  return word;
}
Spec drawSpec(int depth) {
  Spec s{drawWord(), {}};
  for (int n = depth > 0 ? growingNumber(0, 4) : 0; n > 0; --n) s.set(drawWord(), drawSpec(depth - 1));
  return s;
}

template <class Print>
void bothWays(Print print) {
  const Spec s = drawSpec(3);
  RC_ASSERT(Spec::parse(print(s)) == s);
  Pipeline p;
  p[StageKind::solver] = s;
  RC_ASSERT(Pipeline::parse(p.text()) == p);
}
TEST(Spec, TextsRoundTrip) {
  check(
      "text and back", [] { bothWays([](const Spec& s) { return s.text(); }); }, 300);
  expectFalsified("a printer that forgets what is nested", [] {
    bothWays([](const Spec& s) {
      Spec shallow = s;
      for (auto& [key, value] : shallow.fields) value.fields.clear();
      return shallow.text();
    });
  });
}

TEST(Spec, Parses) {
  const Spec s = Spec::parse(" split_solver { velocity = catto{iterations=20} , position=split_impulse } ");
  EXPECT_EQ(s.name, "split_solver");
  ASSERT_TRUE(s.find("velocity"));
  EXPECT_EQ(s.find("velocity")->find("iterations")->name, "20");
  EXPECT_EQ(s.text(), "split_solver{velocity=catto{iterations=20},position=split_impulse}");
  EXPECT_EQ(Spec::parse("naive{}").text(), "naive");
  EXPECT_EQ(s.find("nothing"), nullptr);
}

TEST(Spec, SaysWhatIsWrongAndWhere) {
  const std::pair<const char*, const char*> cases[] = {
      {"", "character 1: a name or value is missing"},           {"a{b=1", "character 6: ',' or '}' is missing"},
      {"a{b}", "character 4: '=' is missing after 'b'"},         {"a{b=1,b=2}", "parameter 'b' is given twice"},
      {"a{b=}", "character 5: a name or value is missing"},      {"a b", "character 3: unexpected text after the end"},
      {"a{b=1}}", "character 7: unexpected text after the end"}, {"a{;}", "character 3: a parameter name is missing"}};
  for (const auto& [text, message] : cases) {
    const std::string error = errorOf([text = text] { Spec::parse(text); });
    EXPECT_NE(error.find(message), std::string::npos) << text << ": " << error;
    EXPECT_NE(error.find("'" + std::string(text) + "'"), std::string::npos) << "the text is quoted";
  }
}

TEST(Pipeline, Parses) {
  const Pipeline p = Pipeline::parse("broadphase=naive solver=soft_step{substeps=4}");
  EXPECT_EQ(p[StageKind::broadphase].name, "naive");
  EXPECT_EQ(p[StageKind::solver].find("substeps")->name, "4");
  EXPECT_EQ(p[StageKind::sleep].name, "none") << "left out: the default";
  EXPECT_EQ(Pipeline::parse(""), Pipeline{});
  EXPECT_EQ(Pipeline::parse(Pipeline{}.text()), Pipeline{});
  EXPECT_NE(errorOf([] { Pipeline::parse("broadfase=naive"); })
                .find("unknown stage 'broadfase'; did you mean 'broadphase'? valid: broadphase, contacts, cache, "
                      "continuous, solver, sleep"),
            std::string::npos);
  EXPECT_NE(errorOf([] { Pipeline::parse("sleep=none sleep=none"); }).find("stage 'sleep' is given twice"),
            std::string::npos);
  EXPECT_NE(errorOf([] { Pipeline::parse("sleep none"); }).find("'=' is missing after 'sleep'"), std::string::npos);
}

// Result files hold these texts: they must not change when the list of stages is reordered.
TEST(Pipeline, TextsNeverChange) {
  EXPECT_EQ(Pipeline{}.text(),
            "broadphase=sort_and_sweep contacts=sat_clip cache=by_feature continuous=none solver=split_solver "
            "sleep=none");
  EXPECT_NE(errorOf([] { Pipeline::parse("velocity=catto"); }).find("velocity is a part of solver"), std::string::npos)
      << "a part of another stage is no stage of a world";
}

TEST(Pipeline, ReplacesWhatTheTextNames) {
  Pipeline p = Pipeline::parse("solver=soft_step cache=none");
  EXPECT_EQ(p.replace("sleep=split_average solver=split_solver{velocity=naive}"),
            (std::vector<StageKind>{StageKind::sleep, StageKind::solver}));
  EXPECT_EQ(p, Pipeline::parse("cache=none solver=split_solver{velocity=naive} sleep=split_average"));
}

// --- parameters and the registry ------------------------------------------------------------------------------------

enum class Mode { tight, loose };
struct AllKinds {
  int count = 3;
  Real length = Real(0.5);
  bool on = true;
  Mode mode = Mode::loose;
  Spec inner{"none", {}};
  void visit(ParamVisitor& v) {
    v.integer("count", count, 1, 10, "how many");
    v.real("length", length, 0, 2, "m", "how long");
    v.flag("on", on, "whether");
    v.choice("mode", mode, {"tight", "loose"}, "how");
    v.stage("inner", inner, StageKind::sleep, "another algorithm");
  }
};
AllKinds read(const std::string& text) {
  AllKinds p;
  readParams(Spec::parse(text), "thing", [&](ParamVisitor& v) { p.visit(v); });
  return p;
}

TEST(Params, AreRead) {
  const AllKinds p = read("thing{count=7,length=1.5,on=false,mode=tight,inner=split_average{bias=0.9}}");
  EXPECT_EQ(p.count, 7);
  EXPECT_EQ(p.length, Real(1.5));
  EXPECT_FALSE(p.on);
  EXPECT_EQ(p.mode, Mode::tight);
  EXPECT_EQ(p.inner.text(), "split_average{bias=0.9}");
  EXPECT_EQ(read("thing").count, 3);
}

TEST(Params, WrongOnesNameTheValid) {
  const std::pair<const char*, const char*> cases[] = {
      {"thing{counts=7}",
       "'thing' has no parameter 'counts'; did you mean 'count'? valid: count, length, on, mode, inner"},
      {"thing{count=11}", "parameter 'count' of 'thing' is '11'; valid: a whole number from 1 to 10"},
      {"thing{count=2.5}", "a whole number from 1 to 10"},
      {"thing{count=99999999999}", "a whole number from 1 to 10"},
      {"thing{length=-1}", "parameter 'length' of 'thing' is '-1'; valid: a number from 0 to 2"},
      {"thing{length=nan}", "a number from 0 to 2"},
      {"thing{length=1m}", "a number from 0 to 2"},
      {"thing{on=1}", "parameter 'on' of 'thing' is '1'; valid: true, false"},
      {"thing{mode=wide}", "parameter 'mode' of 'thing' is 'wide'; valid: tight, loose"},
      {"thing{mode=tight{x=1}}", "valid: tight, loose"}};
  for (const auto& [text, message] : cases) {
    const std::string error = errorOf([text = text] { read(text); });
    EXPECT_NE(error.find(message), std::string::npos) << text << ": " << error;
  }
}

TEST(Params, AreDescribed) {
  AllKinds p;
  const auto infos = describeParams([&](ParamVisitor& v) { p.visit(v); });
  ASSERT_EQ(infos.size(), 5u);
  ASSERT_TRUE(infos[0].range && infos[1].range);
  EXPECT_EQ(std::pair(infos[0].range->lo, infos[0].range->hi), std::pair(1.0, 10.0));
  EXPECT_EQ(std::pair(infos[1].range->lo, infos[1].range->hi), std::pair(0.0, 2.0));
  EXPECT_FALSE(infos[2].range || infos[3].range || infos[4].range) << "of numbers only";
  EXPECT_EQ(infos[1].unit, "m");
  EXPECT_EQ(infos[1].defaultText, "0.5");
  EXPECT_EQ(infos[3].choices, (std::vector<std::string>{"tight", "loose"}));
  EXPECT_EQ(infos[4].type, "stage:sleep");
}

TEST(Registry, FindsByNameAndListsTheValid) {
  const std::string error = errorOf([] { Registry::instance().find(StageKind::sleep, 3, "nap"); });
  EXPECT_NE(error.find("unknown sleep 'nap' in 3D; valid: "), std::string::npos) << error;
  EXPECT_NE(error.find("none"), std::string::npos) << error;
  EXPECT_NE(error.find("split_average"), std::string::npos) << error;
  EXPECT_EQ(createStage<SleepPolicy<2>>(Spec::parse("none")) == nullptr, false);
  // A name of exactly one other stage: the message names that stage. If several stages have it, there is no hint.
  const auto answer = [](StageKind stage, const char* name) {
    return errorOf([&] { Registry::instance().find(stage, 2, name); });
  };
  EXPECT_NE(answer(StageKind::solver, "catto").find("'catto' in 2D; velocity is a part of solver: "),
            std::string::npos);
  EXPECT_NE(answer(StageKind::solver, "catto").find("soft_step, split_solver"), std::string::npos);
  EXPECT_EQ(answer(StageKind::broadphase, "none").find("is a part of"), std::string::npos);
  EXPECT_NE(answer(StageKind::broadphase, "none").find("; valid: "), std::string::npos);
}

TEST(Registry, CanonicalTextSpellsEverythingOut) {
  const auto& entry = Registry::instance().find(StageKind::sleep, 2, "split_average");
  const Spec spelled = entry.canonical(Spec::parse("split_average{bias=0.25}"));
  EXPECT_EQ(spelled.fields.size(), entry.params.size());
  EXPECT_EQ(spelled.find("bias")->name, "0.25");
  EXPECT_EQ(entry.canonical(spelled), spelled);
  // The order of given parameters does not matter, because the text is the key of a result.
  EXPECT_EQ(entry.canonical(Spec::parse("split_average{angular=1,bias=0.5}")),
            entry.canonical(Spec::parse("split_average{bias=0.5,angular=1}")));
  // Nested stages are spelled out as well.
  AllKinds p;
  p.inner = Spec::parse("split_average");
  const Spec nested = canonicalSpec("thing", 2, [&](ParamVisitor& v) { p.visit(v); });
  EXPECT_EQ(nested.find("inner")->fields.size(), entry.params.size());
}

// A recursive parser would run out of stack on deeply nested input.
TEST(Spec, NestingIsLimited) {
  const auto nested = [](int n) {
    std::string text;
    for (int i = 0; i < n; ++i) text += "a{b=";
    return text + "a" + std::string(static_cast<std::size_t>(n), '}');
  };
  EXPECT_EQ(Spec::parse(nested(64)).text(), nested(64));
  for (const int n : {65, 30000, 1000000}) {
    for (const std::string& text : {nested(n), nested(n).substr(0, static_cast<std::size_t>(4 * n))}) {
      try {
        Spec::parse(text);
        ADD_FAILURE() << n << " was taken";
      } catch (const UserError& e) {
        EXPECT_TRUE(std::string(e.what()).ends_with("nested more than 64 deep"));
      }
      EXPECT_THROW(Pipeline::parse("solver=" + text), UserError);
      EXPECT_THROW(engineOf("engine=" + text), UserError);
    }
  }
}

TEST(Registry, EveryAlgorithmDescribesItself) {
  ASSERT_FALSE(Registry::instance().all().empty()) << "registrations were dropped by the linker";
  for (const auto& [key, r] : Registry::instance().all()) {
    EXPECT_FALSE(r.info.summary.empty()) << r.info.name;
    EXPECT_FALSE(r.info.complexity.empty()) << r.info.name;
    EXPECT_NO_THROW(r.create(Spec{r.info.name, {}})) << r.info.name;
    for (const ParamInfo& p : r.params) EXPECT_FALSE(p.meaning.empty()) << r.info.name << ' ' << p.name;
    const Spec spelled = r.canonical(Spec{r.info.name, {}});
    EXPECT_EQ(r.canonical(Spec::parse(spelled.text())), spelled) << r.info.name;
  }
}

template <int D>
class Twin final : public SleepPolicy<D> {
 public:
  using Params = NoParams;
  explicit Twin(const Params&) {}
  static AlgorithmInfo info() { return {.name = "none", .summary = "a second one", .paper = "", .complexity = "1"}; }
  void decide(const SleepInput<D>&, std::span<std::uint8_t>, std::span<std::array<Real, 2>>) override {}
};
TEST(RegistryTest, ADuplicateNameIsRefused) {
  using Second = Registrar<SleepPolicy, Twin, 2>;
  try {
    Second("here");
    ADD_FAILURE();
  } catch (const UserError& e) {
    EXPECT_STREQ(e.what(), "two algorithms are registered as sleep none (2D)");
  }
}

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::spec_test
