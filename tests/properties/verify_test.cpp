// SPDX-License-Identifier: Zlib
// The inputs and verdicts of `lpc verify`: right methods are right, planted bugs are found and named.
#include "oracles/verify/verify.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <fstream>
#include <map>
#include <set>

#include "oracles/corpus/cases.h"
#include "oracles/verify/regime.h"
#include "oracles/witnesses/witness.h"
#include "tests/check_property.h"
#include "tests/planted_bugs/broadphase.h"
#include "tests/planted_bugs/contact_bugs.h"
#include "tests/planted_bugs/pair_query_bugs.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace verify_test { namespace {

// All pairs of kinds up to `last`.
std::vector<std::pair<ShapeKind, ShapeKind>> kindPairs(int dimension,
                                                       ShapeKind last = static_cast<ShapeKind>(kShapeKinds - 1)) {
  std::vector<std::pair<ShapeKind, ShapeKind>> out;
  for (int a = 0; a <= static_cast<int>(last); ++a) {
    for (int b = a; b <= static_cast<int>(last); ++b) {
      const auto kindA = static_cast<ShapeKind>(a), kindB = static_cast<ShapeKind>(b);
      if (!kindExists(kindA, dimension) || !kindExists(kindB, dimension)) continue;
      if (coreClass(kindA) == CoreClass::plane && coreClass(kindB) == CoreClass::plane) continue;  // never meet
      out.emplace_back(kindA, kindB);
    }
  }
  return out;
}

// Every competitor of the stage on all pairs of kinds.
Verified verifyOurs(StageKind stage, int dimension, int count) {
  VerifyTask task{.stage = stage, .dimension = dimension, .range = {.seed = 2, .first = 0, .count = count}};
  for (const Registered* r : Registry::instance().list(stage, dimension)) {
    if (r->info.role == AlgorithmRole::competitor) task.methods.push_back(r->info.name);
  }
  Verified sum;
  for (const auto& [a, b] : kindPairs(dimension)) {
    task.kindA = a, task.kindB = b;
    sum.add(verify(task));
    if (stage == StageKind::broadphase) break;
  }
  return sum;
}

template <class StageOf>
Candidate<StageOf> planted(std::function<std::unique_ptr<StageOf>()> create, AlgorithmInfo info = {}) {
  return {"planted", std::move(info), std::move(create)};
}
template <class StageOf, class Bug>
Candidate<StageOf> planted() {
  return planted<StageOf>([] { return std::make_unique<Bug>(); });
}

LedgerEntry total(const Verified& verified, const std::string& axis = "all", const std::string& value = "") {
  LedgerEntry sum;
  for (const auto& [key, entry] : verified.ledger) {
    if (key.axis == axis && key.value == value) sum.add(entry);
  }
  return sum;
}
std::set<std::string> failures(const Verified& verified) {
  std::set<std::string> out;
  for (const auto& [name, c] : verified.found) out.insert(c.failure);
  return out;
}

template <int D>
Verified verifyQuery(const Candidate<PairQuery<D>>& method, int count, std::uint64_t seed = 3) {
  Verified out;
  for (const auto& [a, b] : kindPairs(D, ShapeKind::polytope)) {  // planted methods support no other kinds
    verifyPairQueries<D>(a, b, {.seed = seed, .first = 0, .count = count}, {&method, 1}, out);
  }
  return out;
}

// --- inputs ----------------------------------------------------------------------------------------------------------

template <int D>
void everythingIsDrawn() {
  std::map<std::string_view, int> families, regimes;
  std::set<double> scales, offsets;
  int asked = 0, hits = 0, polytopes = 0;
  for (const auto& [a, b] : kindPairs(D)) {
    for (int i = 0; i < 150; ++i) {
      const HardPair<D> pair = hardPair<D>(a, b, 5, i);
      const RefereeAnswer<D> truth = referee<D>(pair.a.view(), {}, pair.b.view(), pair.X_AB);
      ASSERT_EQ(pair.a.kind(), a);
      ASSERT_EQ(pair.b.kind(), b);
      ++asked, ++families[pair.family], ++regimes[regimeOf(pair, truth)];
      const bool curved = coreClass(a) == CoreClass::curved || coreClass(b) == CoreClass::curved;
      ASSERT_TRUE(truth.decided || curved) << shapeKindName(a) << ' ' << shapeKindName(b) << ' ' << i;
      hits += truth.hi < 0, polytopes += a == ShapeKind::polytope || b == ShapeKind::polytope;
      scales.insert(pair.scale), offsets.insert(pair.offset);
    }
  }
  const double n = asked;
  EXPECT_GE(hits, 0.3 * n) << hits << " of " << asked;
  EXPECT_LE(hits, 0.7 * n) << hits << " of " << asked;
  EXPECT_LE(families["random"], 0.5 * n);
  for (const std::string_view family : hardPairFamilies()) {
    EXPECT_GE(families[family], 0.02 * (family == "nasty_hulls" ? polytopes : asked)) << family;
  }
  EXPECT_EQ(families.size(), hardPairFamilies().size());
  for (const std::string_view regime : regimeNames()) {
    if (regime == "undecided") {
      EXPECT_LE(regimes[regime], 0.03 * n);  // rings of minima of curved pairs; no others
    } else {
      EXPECT_GE(regimes[regime], 0.01 * n) << regime;
    }
  }
  EXPECT_EQ(scales, (std::set<double>{1e-3, 1, 1e3}));
  EXPECT_TRUE(offsets.contains(0) && offsets.contains(1e2) && offsets.contains(1e5));
}
TEST(VerifyInputs, EveryFamilyAndRegimeIsDrawn) { everythingIsDrawn<2>(), everythingIsDrawn<3>(); }

TEST(VerifyInputs, PairsDependOnSeedAndNumberOnly) {
  const auto one = hardPair<3>(ShapeKind::box, ShapeKind::polytope, 3, 17);
  const auto other = hardPair<3>(ShapeKind::box, ShapeKind::polytope, 3, 18);
  const auto again = hardPair<3>(ShapeKind::box, ShapeKind::polytope, 3, 17);
  EXPECT_EQ(one.X_AB.p, again.X_AB.p);
  EXPECT_EQ(one.family, again.family);
  EXPECT_NE(one.X_AB.p, other.X_AB.p);
}

// --- our methods -----------------------------------------------------------------------------------------------------

// A right answer along another normal than the referee's is a tie; ties occur.
TEST(Verify, OurMethodsAreRight) {
  for (const StageKind stage : {StageKind::pairQuery, StageKind::contacts, StageKind::broadphase}) {
    for (const int d : {2, 3}) {
      const Verified verified = verifyOurs(stage, d, caseCount(stage == StageKind::pairQuery ? 100 : 40));
      EXPECT_GT(total(verified)[Tally::asked], 0);
      if (stage == StageKind::pairQuery && d == 3) {
        EXPECT_GT(total(verified, "family", "ties")[Tally::tie], 0);
      }
      for (const auto& [key, entry] : verified.ledger) {
        if (key.axis != "all") continue;
        EXPECT_EQ(faultsOfOurs(key, entry), 0) << d << "D " << key.method << "\n" << entry.worst;
      }
    }
  }
}

// The ledgers of blocks add up to that of the whole, for any division; only times differ.
TEST(Verify, LedgersAddUp) {
  VerifyTask task{.kindA = ShapeKind::box, .kindB = ShapeKind::polytope, .range = {}, .methods = {"sat", "gjk_epa"}};
  task.range = {.seed = 4, .first = 0, .count = 60};
  const Verified whole = verify(task);
  Verified sum;
  for (const auto& [first, count] : {std::pair(20, 40), std::pair(0, 20)}) {
    task.range.first = first, task.range.count = count;
    sum.add(verify(task));
  }
  ASSERT_EQ(whole.ledger.size(), sum.ledger.size());
  for (const auto& [key, entry] : whole.ledger) {
    const LedgerEntry& other = sum.ledger.at(key);
    EXPECT_EQ(entry.tallies, other.tallies);
    EXPECT_EQ(entry.histogram, other.histogram);
    EXPECT_EQ(entry.maxError, other.maxError);
    EXPECT_EQ(entry.worst, other.worst);
  }
}

// A generator's inputs do not depend on the division either, including the small motions of resting faces.
template <int D>
class Recorder final : public ContactGenerator<D> {
 public:
  static inline std::vector<double> asked;
  bool supports(ShapeKind, ShapeKind) const override { return true; }
  void generate(const ContactInput<D>& input, std::vector<Manifold<D>>&, WorkDone&) override {
    for (const ConvexPair<D>& pair : input.pairs) {
      asked.push_back(input.pose[static_cast<std::size_t>(pair.shapes.b)].p[0]);
    }
  }
};
TEST(Verify, ContactInputsDoNotDependOnBlocks) {
  const auto recorder = planted<ContactGenerator<3>, Recorder<3>>();
  const auto ask = [&](std::vector<std::pair<int, int>> parts) {
    Verified ignored;
    Recorder<3>::asked.clear();
    for (const auto& [first, count] : parts) {
      verifyContacts<3>(ShapeKind::box, ShapeKind::box, {.seed = 4, .first = first, .count = count}, {&recorder, 1},
                        ignored);
    }
    std::sort(Recorder<3>::asked.begin(), Recorder<3>::asked.end());
    return Recorder<3>::asked;
  };
  EXPECT_EQ(ask({{0, 40}}), ask({{24, 16}, {0, 24}}));
}

// --- planted pair queries --------------------------------------------------------------------------------------------

template <template <int> class Bug>
void isFound(const std::string& failure) {
  const Verified verified = verifyQuery<3>(planted<PairQuery<3>, Bug<3>>(), 40);
  EXPECT_GT(total(verified)[Tally::wrong], 0) << failure;
  EXPECT_TRUE(failures(verified).contains(failure)) << failure;
}
TEST(Verify, WrongPairQueriesAreFound) {
  isFound<wrong_queries::FlippedNormal>("wrong_normal");
  isFound<wrong_queries::NoEdgeAxes>("wrong_distance");
  isFound<wrong_queries::CentreRayDepth>("wrong_distance");
  isFound<wrong_queries::AbsoluteTolerance>("wrong_distance");
  isFound<wrong_queries::ForgetsRounding>("wrong_side");
}

// Planted bug: four ways of ending without an answer, in turn.
template <int D>
class Fails final : public PairQuery<D> {
 public:
  bool supports(ShapeKind, ShapeKind) const override { return true; }
  void query(std::span<const PairView<D>> pairs, QueryNeed, std::span<PairAnswer<D>> answers, std::span<PairMemory>,
             WorkDone&) override {
    for (std::size_t at = 0; at < pairs.size(); ++at) {
      const int i = m_asked++;  // also when pairs come one by one
      PairAnswer<D> answer;
      answer.status = i % 4 == 0 ? QueryStatus::refused : i % 4 == 1 ? QueryStatus::failed : QueryStatus::converged;
      if (i % 4 == 2) answer.distance = std::numeric_limits<Real>::quiet_NaN();
      if (i % 4 == 3) answer.normal = Vec<D>::Constant(std::numeric_limits<Real>::infinity());
      answers[at] = answer;
    }
  }

 private:
  int m_asked = 0;
};
TEST(Verify, MissingAnswersAreRecorded) {
  const Verified verified = verifyQuery<2>(planted<PairQuery<2>, Fails<2>>(), 40);
  const LedgerEntry all = total(verified);
  EXPECT_EQ(all[Tally::refused], all[Tally::asked] / 4);
  EXPECT_EQ(all[Tally::notFinite], all[Tally::asked] / 4 * 3);
  EXPECT_EQ(all.faults(), all[Tally::asked]);
  EXPECT_EQ(failures(verified), (std::set<std::string>{"not_finite", "refused"}));
}

class Troubled final : public Witness<3> {
 public:
  bool supports(ShapeKind, ShapeKind) const override { return true; }
  std::span<const Ending> endings() const override { return m_endings; }
  std::int64_t nanoseconds() const override { return 1000 * static_cast<std::int64_t>(m_endings.size()); }
  void query(std::span<const PairView<3>> pairs, QueryNeed, std::span<PairAnswer<3>> answers, std::span<PairMemory>,
             WorkDone&) override {
    m_endings.clear();
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      PairAnswer<3> answer;
      answer.status = QueryStatus::failed;
      answers[i] = answer;
      m_endings.push_back(std::array{Ending::threw, Ending::crashed, Ending::hung, Ending::notFinite}[i % 4]);
    }
  }

 private:
  std::vector<Ending> m_endings;
};
TEST(Verify, EndingsOfWitnessesAreRecorded) {
  AlgorithmInfo info;
  info.role = AlgorithmRole::witness;
  const auto method = planted<PairQuery<3>>([] { return std::make_unique<Troubled>(); }, info);
  Verified verified;
  verifyPairQueries<3>(ShapeKind::box, ShapeKind::box, {.seed = 1, .first = 0, .count = 40}, {&method, 1}, verified);
  const LedgerEntry all = total(verified);
  for (const Tally t : {Tally::threw, Tally::crashed, Tally::hung, Tally::notFinite}) EXPECT_EQ(all[t], 10);
  EXPECT_EQ(all.role, AlgorithmRole::witness);
  EXPECT_NEAR(all.nanoseconds, 40000, 1e-6);
}

// The inputs of a lost worker are recorded with its end; they are not repeated.
TEST(Verify, LostWorkersAreRecorded) {
  VerifyTask task{.kindA = ShapeKind::box, .kindB = ShapeKind::box, .range = {}, .methods = {"sat"}};
  task.range = {.seed = 1, .first = 7, .count = 1, .ended = Tally::crashed};
  const Verified verified = verify(task);
  EXPECT_EQ(total(verified)[Tally::crashed], 1);
  EXPECT_EQ(failures(verified), (std::set<std::string>{"crashed"}));
}

// Every kept failure fails again from its text alone, in the same way and with the same error.
template <class StageOf>
void allFailAgain(const Verified& verified, const Candidate<StageOf>& method) {
  constexpr int D = StageOf::kDimension;
  EXPECT_FALSE(verified.found.empty());
  std::vector<std::string> texts;
  for (const auto& [name, c] : verified.found) texts.push_back(c.text);
  for (const auto& [key, entry] : verified.ledger) {
    if (entry.worst.find("\"failure\": \"none\"") == std::string::npos && !entry.worst.empty())
      texts.push_back(entry.worst);
  }
  for (const std::string& text : texts) {
    const Case c = parseCases("{\"cases\": [" + text + "]}", "kept").at(0);
    const auto& g = std::get<CaseGeometry<D>>(c.geometry);
    Verdict again;
    if constexpr (StageOf::kStage == StageKind::broadphase) {
      again = verifyScript(g.script, method);
    } else {
      again = verifyPair(g.pair(), method);
    }
    EXPECT_EQ(again.failure, c.finding.value().failure) << text;
    EXPECT_EQ(again.error.value_or(-1), std::isnan(c.finding->error) ? -1 : c.finding->error) << text;
    EXPECT_EQ(c.finding->stage, StageOf::kStage);
  }
}

template <class StageOf, class Bug>
void keptOnesFailAgain(Guarantee guarantee = Guarantee::exact) {
  constexpr int D = StageOf::kDimension;
  AlgorithmInfo info;
  info.guarantee = guarantee;
  const auto method = planted<StageOf>([] { return std::make_unique<Bug>(); }, info);
  Verified out;
  if constexpr (StageOf::kStage == StageKind::broadphase) {
    verifyBroadphases<D>({.seed = 1, .first = 0, .count = 40}, {&method, 1}, out);
  } else {
    for (const auto& [a, b] : kindPairs(D, ShapeKind::polytope)) {
      const VerifyRange range{.seed = 3, .first = 0, .count = 24};
      if constexpr (StageOf::kStage == StageKind::contacts) {
        verifyContacts<D>(a, b, range, {&method, 1}, out);
      } else {
        verifyPairQueries<D>(a, b, range, {&method, 1}, out);
      }
    }
  }
  allFailAgain(out, method);
}
template <int D>
void plantedOnesFailAgain() {
  keptOnesFailAgain<PairQuery<D>, wrong_queries::FlippedNormal<D>>();
  keptOnesFailAgain<PairQuery<D>, wrong_queries::CentreRayDepth<D>>();
  keptOnesFailAgain<PairQuery<D>, wrong_queries::ForgetsRounding<D>>();
  keptOnesFailAgain<ContactGenerator<D>, FlippedContactNormal<D>>();
  keptOnesFailAgain<ContactGenerator<D>, DuplicateFeatures<D>>();
  keptOnesFailAgain<ContactGenerator<D>, FeaturesFromPosition<D>>();
  keptOnesFailAgain<Broadphase<D>, OpenBoxes<D>>();
  keptOnesFailAgain<Broadphase<D>, StaleSlot<D>>();
  keptOnesFailAgain<Broadphase<D>, InnerSpheres<D>>(Guarantee::conservative);
}
TEST(Verify, KeptFailuresFailAgain2) { plantedOnesFailAgain<2>(); }
TEST(Verify, KeptFailuresFailAgain3) { plantedOnesFailAgain<3>(); }

// Wrong for the first two queries of a pair, in the run and then alone; right from then on.
template <int D>
class Forgetful final : public PairQuery<D> {
 public:
  using Params = NoParams;
  explicit Forgetful(const Params&) {}
  static AlgorithmInfo info() {
    return {.name = "planted_forgetful", .summary = "", .paper = "", .complexity = "", .role = AlgorithmRole::witness};
  }
  bool supports(ShapeKind, ShapeKind) const override { return true; }
  void query(std::span<const PairView<D>> pairs, QueryNeed, std::span<PairAnswer<D>> answers, std::span<PairMemory>,
             WorkDone&) override {
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      PairAnswer<D> answer;
      answer.status = QueryStatus::converged;
      const PairView<D>& pair = pairs[i];
      const Real length = pair.X_AB.p.norm(), truth = length - pair.a.radius - pair.b.radius;
      static std::map<double, int> asked;  // by the distance of the centres
      answer.distance = ++asked[double(length)] <= 2 ? -1 - 2 * std::abs(truth) : truth;
      answer.normal = length > 0 ? Vec<D>(pair.X_AB.p / length) : Vec<D>(Vec<D>::Unit(0));
      answers[i] = answer;
    }
  }
};
TEST(Verify, FailuresThatDoNotRepeatAreMarked) {
  static const Registrar<PairQuery, Forgetful, 2> registrar(__FILE__);
  const Verified verified = verify({.dimension = 2,
                                    .kindA = ShapeKind::sphere,
                                    .kindB = ShapeKind::sphere,
                                    .range = {.seed = 1, .first = 0, .count = 40},
                                    .methods = {"planted_forgetful"}});
  EXPECT_GT(total(verified)[Tally::wrong], 0);
  ASSERT_FALSE(verified.found.empty());
  for (const auto& [name, c] : verified.found) {
    EXPECT_TRUE(c.failure.ends_with("_once")) << c.failure;
    EXPECT_NE(c.text.find("\"again\": false"), std::string::npos) << c.text;
    EXPECT_EQ(parseCases("{\"cases\": [" + c.text + "]}", "kept").at(0).finding->method, "planted_forgetful");
  }
}

// The failing pair with the fewest vertices is kept.
TEST(Verify, TheSimplestFailingPairIsKept) {
  const Verified verified = verifyQuery<3>(planted<PairQuery<3>, wrong_queries::CentreRayDepth<3>>(), 40);
  const FoundCase& kept = verified.found.at({"planted", "wrong_distance"});
  EXPECT_LE(kept.vertices, 4) << kept.text;  // two capsules fail, two spheres cannot
}

template <int D>
std::vector<Real> numbersOf(const Pose<D>& X) {
  std::vector<Real> out(X.p.begin(), X.p.end());
  if constexpr (D == 2) {
    out.insert(out.end(), {X.q.c, X.q.s});
  } else {
    out.insert(out.end(), {X.q.w, X.q.x, X.q.y, X.q.z});
  }
  return out;
}
template <int D>
std::vector<Real> numbersOf(const ShapeView<D>& shape) {
  std::vector<Real> out(shape.half.begin(), shape.half.end());
  out.push_back(shape.radius);
  if (!shape.hull) return out;
  for (const Vec<D>& v : shape.hull->vertices) out.insert(out.end(), v.begin(), v.end());
  if constexpr (D == 3) {
    for (const auto& face : shape.hull->faces) out.insert(out.end(), face.normal.begin(), face.normal.end());
    for (const int vertex : shape.hull->loop) out.push_back(static_cast<Real>(vertex));
  }
  return out;
}

// Inputs read back from a file have the same numbers, for any kinds.
template <int D>
void comesBack(StageKind stage) {
  const std::string path = ::testing::TempDir() + "exact_case.json";
  std::vector<HardPair<D>> pairs;
  std::ofstream file(path);
  for (const auto& [a, b] : kindPairs(D)) {
    for (int i = 0; i < 40; ++i) {
      HardPair<D>& pair = pairs.emplace_back(hardPair<D>(a, b, 9, i));
      if (stage == StageKind::contacts) pair.X_WBNudged = pair.X_WA;
      file << (pairs.size() == 1 ? "{\"cases\": [" : ",\n")
           << caseText<D>("a", stage, pair,
                          findingText(subjectOf(stage, D, "sat"), {}, 9, i) + expectedText(RefereeAnswer<D>{}));
    }
  }
  file << "]}", file.close();
  const std::vector<Case> cases = readCases(path);
  ASSERT_EQ(cases.size(), pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const HardPair<D>&pair = pairs[i], back = std::get<CaseGeometry<D>>(cases[i].geometry).pair();
    ASSERT_EQ(numbersOf<D>(back.a.view()), numbersOf<D>(pair.a.view()));
    ASSERT_EQ(numbersOf<D>(back.b.view()), numbersOf<D>(pair.b.view()));
    if (stage == StageKind::pairQuery) {
      ASSERT_EQ(numbersOf<D>(back.X_AB), numbersOf<D>(pair.X_AB));
    } else {
      ASSERT_EQ(numbersOf<D>(back.X_WA), numbersOf<D>(pair.X_WA));
      ASSERT_EQ(numbersOf<D>(back.X_WB), numbersOf<D>(pair.X_WB));
      ASSERT_EQ(numbersOf<D>(back.X_WBNudged.value()), numbersOf<D>(*pair.X_WBNudged));
    }
    ASSERT_EQ(cases[i].finding.value().stage, stage);
    ASSERT_EQ(cases[i].finding->number, static_cast<int>(i) % 40);
  }
}
TEST(Verify, CasesComeBackExactly) {
  for (const StageKind stage : {StageKind::pairQuery, StageKind::contacts}) comesBack<2>(stage), comesBack<3>(stage);
}

// --- planted broadphases and contact generators ----------------------------------------------------------------------

template <template <int> class Bug>
void broadphaseIsFound(Guarantee guarantee = Guarantee::exact) {
  AlgorithmInfo info;
  info.guarantee = guarantee;
  const auto method = planted<Broadphase<2>>([] { return std::make_unique<Bug<2>>(); }, info);
  Verified verified;
  verifyBroadphases<2>({.seed = 1, .first = 0, .count = 40}, {&method, 1}, verified);
  EXPECT_GT(total(verified)[Tally::wrong], 0);
  EXPECT_EQ(total(verified)[Tally::asked], 40);
}
TEST(Verify, WrongBroadphasesAreFound) {
  broadphaseIsFound<OpenBoxes>();
  broadphaseIsFound<ForgetsCenterLine>();
  broadphaseIsFound<StaleSlot>();
  broadphaseIsFound<Duplicates>();
  broadphaseIsFound<WakesTheDead>();
  broadphaseIsFound<InnerSpheres>(Guarantee::conservative);
}

template <template <int> class Bug>
void generatorIsFound(const std::string& family) {
  const auto method = planted<ContactGenerator<3>, Bug<3>>();
  Verified verified;
  verifyContacts<3>(ShapeKind::box, ShapeKind::polytope, {.seed = 1, .first = 0, .count = 80}, {&method, 1}, verified);
  const LedgerEntry entry = family.empty() ? total(verified) : total(verified, "family", family);
  EXPECT_GT(entry[Tally::wrong] + entry[Tally::notFinite], 0);
}
TEST(Verify, WrongContactGeneratorsAreFound) {
  generatorIsFound<PointNowhere>("");
  generatorIsFound<DepthIsNoNumber>("");
  generatorIsFound<FlippedContactNormal>("");
  generatorIsFound<DuplicateFeatures>("");
  generatorIsFound<Unclipped>("");
  generatorIsFound<NoEdgeContacts>("");
  generatorIsFound<OnlyOnePoint>("resting_faces");
  generatorIsFound<FeaturesFromPosition>("resting_faces");
  generatorIsFound<FeaturesFromDepth>("resting_faces");
}

TEST(Verify, WrongDimensionIsAUserError) {
  EXPECT_THROW(verify({.dimension = 4, .range = {}, .methods = {"sat"}}), UserError);
}

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::verify_test
