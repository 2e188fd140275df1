// SPDX-License-Identifier: Zlib
// Trials of pairs: ground truth and error are the same in trials and in ledgers.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>

#include "experiments/runner/code_identity.h"
#include "experiments/runner/trial_plan.h"
#include "experiments/trial/trial.h"
#include "oracles/verify/verify.h"
#include "tests/expect_caught.h"

namespace lpc { inline namespace LPC_PRECISION { namespace pairs_trial_test { namespace {

// Wrong by a fraction of the size, sometimes with a wrong normal, and sometimes without an answer.
template <int D>
class Careless final : public PairQuery<D> {
 public:
  using Params = NoParams;
  static inline std::vector<double> errors;  // of the last queries, as `lpc verify` reports them
  static inline int refused = 0, wrong = 0, wrongSides = 0;
  static inline bool retelling = false;

  Careless() = default;
  explicit Careless(const Params&) {}
  static AlgorithmInfo info() { return {.name = "planted_careless", .summary = "", .paper = "", .complexity = "1"}; }
  bool supports(ShapeKind a, ShapeKind b) const override { return a == ShapeKind::capsule && b == ShapeKind::box; }

  void query(std::span<const PairView<D>> pairs, QueryNeed, std::span<PairAnswer<D>> answers, std::span<PairMemory>,
             WorkDone&) override {
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const PairView<D>& pair = pairs[i];
      PairAnswer<D> answer;
      answer.status = number(pair) % 5 == 0 ? QueryStatus::refused : QueryStatus::converged;
      answer.distance = pair.X_AB.p.norm() - Real(0.5);
      answer.normal = Vec<D>::Unit(number(pair) % D);
      answers[i] = answer;
      if (!retelling) tell(pair);
    }
  }

 private:
  static int number(const PairView<D>& pair) { return static_cast<int>(std::abs(pair.X_AB.p[0]) * 1000); }
  void tell(const PairView<D>& pair) {
    HardPair<D> same{.a = Shape<D>::capsule(pair.a.half[0], pair.a.radius), .b = Shape<D>::box(pair.b.half)};
    same.X_AB = pair.X_AB;
    retelling = true;
    const Verdict verdict = verifyPair<D>(
        same, Candidate<PairQuery<D>>{"planted_careless", info(), [] { return std::make_unique<Careless>(); }});
    retelling = false;
    if (verdict.error) errors.push_back(*verdict.error);
    refused += verdict.end == Tally::refused, wrong += verdict.end == Tally::wrong, wrongSides += verdict.wrongSide;
  }
};

PairsRequest drawn(int dimension, const char* kindA, const char* kindB, int n, const std::string& method,
                   bool timed = false) {
  PairsRequest out;
  out.dimension = dimension, out.kindA = kindA, out.kindB = kindB, out.n = n, out.seed = 3;
  out.pairQuery = method, out.timed = timed;
  return out;
}

template <int D>
void sameError() {
  static const Registrar<PairQuery, Careless, D> planted(__FILE__);
  Careless<D>::errors.clear();
  const TrialResult r = runTrial({.trial = drawn(D, "capsule", "box", 240, "planted_careless")});
  const std::vector<double>& told = Careless<D>::errors;
  ASSERT_GT(told.size(), 100u);
  EXPECT_EQ(r.metrics.at("asked"), 240);
  EXPECT_EQ(r.metrics.at("refused"), 240 - static_cast<double>(told.size()));
  EXPECT_EQ(r.metrics.at("max_error"), *std::max_element(told.begin(), told.end()));
  EXPECT_EQ(r.metrics.at("median_error"), quantile(told, 0.5));
  EXPECT_EQ(r.metrics.at("refused"), Careless<D>::refused);
  EXPECT_EQ(r.metrics.at("wrong_boolean"), Careless<D>::wrongSides);
  EXPECT_EQ(r.metrics.at("wrong"), Careless<D>::wrong);
  EXPECT_GT(Careless<D>::wrong, Careless<D>::wrongSides) << "wrong by the distance alone counts";
  EXPECT_GT(Careless<D>::wrongSides, 0);
  EXPECT_EQ(r.outcome, "wrong");
}
TEST(PairsTrial, AnErrorIsThatOfTheLedger) { sameError<2>(), sameError<3>(); }

// LPC's methods are also queried one by one, as libraries are. What a method does not claim is not judged.
TEST(PairsTrial, SinglesAreTimedAndGapsThatAreNotClaimedAreCounted) {
  const auto asked = [](const char* method, bool timed) {
    return runTrial({.trial = drawn(3, "box", "box", 100, method, timed)}).metrics;
  };
  const auto exact = asked("sat", true), rough = asked("mpr", false);
  EXPECT_GT(exact.at("ns_single"), 0);
  EXPECT_GT(exact.at("ns_per_query"), 0);
  EXPECT_EQ(exact.at("side_alone"), 0);
  EXPECT_EQ(rough.count("ns_single"), 0u);
  EXPECT_GT(rough.at("side_alone"), 10);
  EXPECT_LT(rough.at("side_alone"), 100);
}

// Counts three axes per pair; the planted bug counts those of a batch.
template <bool ofBatch>
class Counting final : public PairQuery<2> {
 public:
  using Params = NoParams;
  explicit Counting(const Params&) {}
  static AlgorithmInfo info() {
    return {.name = ofBatch ? "planted_batch" : "planted_three", .summary = "", .paper = "", .complexity = "1"};
  }
  bool supports(ShapeKind, ShapeKind) const override { return true; }
  void query(std::span<const PairView<2>> pairs, QueryNeed, std::span<PairAnswer<2>>, std::span<PairMemory>,
             WorkDone& work) override {
    work[WorkCount::axisTests] += 3 * (ofBatch ? 1 : pairs.size());
  }
};
template <int D>
using CountsPairs = Counting<false>;
template <int D>
using CountsBatches = Counting<true>;

// Work is reported per query, whether the query is repeated for timing or not; a witness reports none.
TEST(PairsTrial, WorkIsThatOfOneQuery) {
  static const Registrar<PairQuery, CountsPairs, 2> three(__FILE__);
  static const Registrar<PairQuery, CountsBatches, 2> batch(__FILE__);
  const auto ran = [](const std::string& method, bool timed) {
    PairsRequest asked = drawn(2, "polytope", "polytope", 32, method, timed);
    asked.vertices = 16, asked.drawing = "apart";
    return runTrial({.trial = asked}).metrics;
  };
  EXPECT_EQ(ran("planted_three", false).at("axis_tests"), 3);
  EXPECT_EQ(ran("planted_three", true).at("axis_tests"), 3);
  EXPECT_EQ(ran("sat", true).at("axis_tests"), ran("sat", false).at("axis_tests"));
  EXPECT_GE(ran("gjk_epa", false).at("support_calls"), 2);
  EXPECT_EQ(ran("gjk_epa", false).at("polytope_faces"), 0) << "apart there is no depth to search";
  EXPECT_TRUE(std::isnan(ran("chipmunk", false).at("support_calls")));
  test::expectCaught("work counted once for a batch", ran("planted_batch", false).at("axis_tests") == 3);
}

// Counts the queries of a pair in its memory; without memory it starts again.
template <int D>
class Remembering final : public PairQuery<D> {
 public:
  using Params = NoParams;
  explicit Remembering(const Params&) {}
  static AlgorithmInfo info() { return {.name = "planted_remembering", .summary = "", .paper = "", .complexity = "1"}; }
  bool supports(ShapeKind, ShapeKind) const override { return true; }
  bool remembers() const override { return true; }
  void query(std::span<const PairView<D>> pairs, QueryNeed, std::span<PairAnswer<D>>, std::span<PairMemory> memory,
             WorkDone& work) override {
    work[WorkCount::axisTests] += pairs.size();
    for (const PairView<D>& p : pairs) {  // counts pairs of other kinds than the first
      work[WorkCount::polytopeFaces] += p.a.kind != pairs[0].a.kind || p.b.kind != pairs[0].b.kind;
    }
    for (PairMemory& m : memory)
      work[WorkCount::supportCalls] +=
          static_cast<std::uint64_t>(m.bytes[0] = std::byte(std::to_integer<int>(m.bytes[0]) + 1));
  }
};

TrialResult asked(const std::string& method, const std::string& stream, bool timed = false,
                  const std::string& scene = "vertical_stack", long from = 60) {
  Planner planner;
  const PlannedTrial t = planner.pairs({{"dimension", 2},
                                        {"scene", scene},
                                        {"n", scene == "mixed_pile" ? 24 : 3},
                                        {"from", from},
                                        {"steps", 4},
                                        {"timed", timed},
                                        {"pair_query", method},
                                        {"stream", stream}});
  return runTrial(t.request);
}

// Three boxes on the ground and on each other make contact in each of four steps: the first time, the second, and so
// on.
TEST(PairsTrial, AStreamIsQueriedInOrderWithItsMemory) {
  static const Registrar<PairQuery, Remembering, 2> planted(__FILE__);
  const auto warm = asked("planted_remembering", "warm").metrics;
  EXPECT_EQ(warm.at("asked"), 12);
  EXPECT_EQ(warm.at("axis_tests"), 1);
  EXPECT_EQ(warm.at("support_calls"), (1 + 2 + 3 + 4) / 4.0);
  EXPECT_EQ(asked("planted_remembering", "warm", true).metrics.at("support_calls"), 2.5)
      << "each time that it is timed it begins with nothing";
  test::expectCaught("a stream without memory",
                     asked("planted_remembering", "cold").metrics.at("support_calls") == 2.5);
  EXPECT_EQ(asked("planted_remembering", "drawn").metrics.at("asked"), 12);
  for (const char* stream : {"cold", "drawn"}) {  // of balls, capsules and boxes: one pair of kinds at a time
    const auto mixed = asked("planted_remembering", stream, false, "mixed_pile", 60).metrics;
    EXPECT_GT(mixed.at("asked"), 3) << stream;
    EXPECT_EQ(mixed.at("polytope_faces"), 0) << stream;
  }
  EXPECT_EQ(asked("sat", "cold").outcome, "ok");
  EXPECT_NE(asked("sat", "cold").hash, asked("sat", "drawn").hash);
  EXPECT_EQ(asked("sat", "warm").reason, "the method caches nothing between queries");
  EXPECT_EQ(asked("closed_form", "cold").reason, "box against box");
}

TEST(PairsTrial, AStreamsKeyHasTheSceneAndTheWorldThatMakesIt) {
  Planner planner;
  const nlohmann::json cell = {
      {"dimension", 2}, {"scene", "vertical_stack"}, {"pair_query", "sat"}, {"stream", "cold"}};
  const auto with = [&](const char* axis, const nlohmann::json& value) {
    nlohmann::json other = cell;
    other[axis] = value;
    return planner.pairs(other);
  };
  const PlannedTrial plain = planner.pairs(cell);
  EXPECT_EQ(with("n", 15).key, plain.key) << "the scene's own number";
  for (const char* axis : {"n", "from", "steps"}) EXPECT_NE(with(axis, 7).key, plain.key) << axis;
  EXPECT_NE(with("stream", "drawn").key, plain.key);
  EXPECT_NE(with("scene", "pyramid").key, plain.key);
  EXPECT_TRUE(plain.canonical.at("code").contains("pair_query/sat"));
  EXPECT_TRUE(plain.canonical.at("code").contains("solver/split_solver")) << plain.canonical.at("code");
  EXPECT_THROW(with("stream", "hot"), UserError);
  EXPECT_THROW(with("vertices", 8), UserError);
}

TEST(PairsTrial, TheRefereesCodeIsPartOfTheKeyOfPairsAlone) {
  Planner planner;
  const nlohmann::json pairs =
      planner
          .pairs({{"dimension", 3}, {"kind_a", "box"}, {"kind_b", "box"}, {"pair_query", "sat"}, {"precision", "f64"}})
          .canonical;
  const nlohmann::json boxes =
      planner.boxes({{"dimension", 3}, {"n", 8}, {"distribution", "uniform"}, {"broadphase", "naive"}}).canonical;
  EXPECT_EQ(pairs.at("code").at("oracles"), oraclesHash());
  EXPECT_FALSE(boxes.at("code").contains("oracles"));
}

// The referee's code is in the key of every trial of pairs; a changed or new adapter is not.
TEST(PairsTrial, TheRefereesCodeIncludesNoAdapter) {
  const auto hash = [](std::string_view referee, std::string_view adapter) {
    return judgesHash(
        std::array<SourceHash, 2>{{{"oracles/referee/referee.h", referee}, {"oracles/witnesses/fcl.cpp", adapter}}});
  };
  EXPECT_EQ(hash("same", "before"), hash("same", "after"));
  EXPECT_EQ(hash("same", "before"), judgesHash(std::array<SourceHash, 1>{{{"oracles/referee/referee.h", "same"}}}));
  EXPECT_NE(hash("before", "same"), hash("after", "same"));
}

// Right on circles, except that each answer with a number below `share` of 20 is spoilt.
template <int D>
class Spoilt final : public PairQuery<D> {
 public:
  struct Params {
    int share = 0, how = 0;
    void visit(ParamVisitor& v) {
      v.integer("share", share, 0, 20, "of 20 answers");
      v.integer("how", how, 0, 5, "0 NaN, 1 infinity, 2 NaN normal, 3 long normal, 4 failed, 5 refused");
    }
  };
  explicit Spoilt(const Params& params) : m_params(params) {}
  static AlgorithmInfo info() { return {.name = "planted_spoilt", .summary = "", .paper = "", .complexity = "1"}; }
  bool supports(ShapeKind a, ShapeKind b) const override { return a == ShapeKind::sphere && b == ShapeKind::sphere; }

  void query(std::span<const PairView<D>> pairs, QueryNeed need, std::span<PairAnswer<D>> answers,
             std::span<PairMemory> memory, WorkDone& work) override {
    constexpr Real kNan = std::numeric_limits<Real>::quiet_NaN(), kInf = std::numeric_limits<Real>::infinity();
    m_right->query(pairs, need, answers, memory, work);
    for (PairAnswer<D>& answer : answers.first(static_cast<std::size_t>(m_params.share))) {
      if (m_params.how <= 1) answer.distance = m_params.how == 0 ? kNan : kInf;
      if (m_params.how == 2) answer.normal[0] = kNan;
      if (m_params.how == 3) answer.normal *= 2;
      if (m_params.how == 4) answer.status = QueryStatus::failed;
      if (m_params.how == 5) answer.status = QueryStatus::refused;
    }
  }

 private:
  Params m_params;
  std::unique_ptr<PairQuery<D>> m_right = createStage<PairQuery<D>>(Spec{"closed_form", {}});
};

template <int D>
void everyAnswerCounts() {
  static const Registrar<PairQuery, Spoilt, D> planted(__FILE__);
  const auto outcome = [](int share, int how) {
    const std::string spec = "planted_spoilt{share=" + std::to_string(share) + ",how=" + std::to_string(how) + "}";
    return runTrial({.trial = drawn(D, "sphere", "sphere", 20, spec)});
  };
  EXPECT_EQ(outcome(0, 0).outcome, "ok");
  for (const int share : {1, 20}) {
    for (int how = 0; how <= 5; ++how) EXPECT_EQ(outcome(share, how).outcome, "wrong") << share << ' ' << how;
  }
  EXPECT_EQ(outcome(20, 0).reason, "0 wrong answers, 20 of 20 without a finite answer");
}
TEST(PairsTrial, AnAnswerThatIsNotFiniteIsWrong) { everyAnswerCounts<2>(), everyAnswerCounts<3>(); }

TEST(PairsTrial, AxesOfAStreamNeedAScene) {
  const nlohmann::json drawn = {{"dimension", 3}, {"kind_a", "box"}, {"kind_b", "box"}, {"pair_query", "sat"}};
  Planner planner;
  EXPECT_EQ(planner.pairs(drawn).unsupported, "");
  for (const char* axis : {"stream", "from", "steps"}) {
    nlohmann::json cell = drawn;
    cell[axis] = 1;
    try {
      planner.pairs(cell);
      ADD_FAILURE() << axis << " was taken";
    } catch (const UserError& e) {
      EXPECT_EQ(std::string(e.what()),
                "axis '" + std::string(axis) + "' needs the axis 'scene', which gives the pairs");
    }
  }
}

// Code in a separate file, such as the SIMD kernels of `sat`, is in the keys of its group; another method's file is
// not.
TEST(PairsTrial, KernelsArePartOfTheKeysOfTheirGroup) {
  const Registered& sat = Registry::instance().find(StageKind::pairQuery, 3, "sat");
  const auto hash = [&](std::string_view path, std::string_view content) {
    return methodHash(sat, std::array<SourceHash, 1>{{{path, content}}});
  };
  for (const char* path : {"algorithms/pair_query/lanes/boxes_lanes.cpp", "algorithms/pair_query/sat/sat_boxes3.h",
                           "algorithms/contacts/tolerances.h", "algorithms/pair_query/sat.cpp"}) {
    EXPECT_NE(hash(path, "before"), hash(path, "after")) << path;
  }
  for (const char* path : {"algorithms/pair_query/mpr.cpp", "algorithms/solver/rows/contact_rows.h"}) {
    EXPECT_EQ(hash(path, "before"), hash(path, "after")) << path;
  }
}

// The version of a foreign library is in the keys of its adapter's trials.
TEST(PairsTrial, ALibrarysVersionIsPartOfTheKeyOfItsWitness) {
  const std::regex foreign("#include <[^>]+/"), version("[A-Za-z0-9]+ [0-9.]+(, [A-Za-z0-9]+ [0-9.]+)*");
  for (const int dimension : {2, 3}) {
    int witnesses = 0;
    for (const Registered* r : Registry::instance().list(StageKind::pairQuery, dimension)) {
      std::ifstream in(r->file);
      const std::string source{std::istreambuf_iterator<char>(in), {}};
      ASSERT_FALSE(source.empty()) << r->file;
      const nlohmann::json code = codeHashes(StageKind::pairQuery, Spec{r->info.name, {}}, dimension);
      EXPECT_TRUE(code.contains("pair_query/" + r->info.name));
      EXPECT_EQ(code.contains("library"), r->info.role == AlgorithmRole::witness && std::regex_search(source, foreign))
          << code;
      if (!code.contains("library")) continue;
      EXPECT_TRUE(std::regex_match(code.at("library").get<std::string>(), version)) << code;
      ++witnesses;
    }
    EXPECT_GE(witnesses, dimension == 3 ? 7 : 5);
  }
}

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::pairs_trial_test
