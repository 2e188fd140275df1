// SPDX-License-Identifier: Zlib
// The largest error of every competing pair query, by pair of kinds, must match the bound in accuracy.txt beside this
// file. A larger error fails. So does an error ten times smaller than documented.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <sstream>
#include <tuple>

#include "oracles/verify/verify.h"
#include "tests/expect_caught.h"
#include "tests/planted_bugs/pair_query_bugs.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace accuracy_test { namespace accuracy_test {

constexpr std::uint64_t kSeed = 2027;
const std::string kPrecision = sizeof(Real) == 8 ? "f64" : "f32";

struct Row {
  int dimension;
  std::string method, kindA, kindB;
  auto operator<=>(const Row&) const = default;
  std::string text() const { return std::to_string(dimension) + ' ' + method + ' ' + kindA + ' ' + kindB; }
};
using Table = std::map<Row, double>;  // largest error / s

/// Measured errors, and faults that hold whatever is documented.
struct Measured {
  Table errors;
  std::vector<std::string> faults = {};
};

// Two rows per decade, with a margin of a tenth, so that no error lies on the edge of its row.
double documentedFor(double error) {
  if (!(error > 0)) return 0;
  for (int decade = -20;; ++decade) {
    for (const char* digit : {"1e", "3e"}) {  // as the table is parsed
      const double bound = std::strtod((digit + std::to_string(decade)).c_str(), nullptr);
      if (bound >= 1.1 * error) return bound;
    }
  }
}

/// The rows of both files, by precision.
std::map<std::string, Table> tables() {
  std::map<std::string, Table> out;
  for (const char* name : {"accuracy.txt", "accuracy_approximate.txt"}) {
    std::ifstream in(std::string(LPC_SOURCE_DIR "/tests/conformance/") + name);
    EXPECT_TRUE(in) << "there is no " << name;
    for (std::string line; std::getline(in, line);) {
      if (line.empty() || line[0] == '#') continue;
      std::istringstream words(line);
      std::string precision;
      Row row;
      double bound = -1;
      words >> precision >> row.dimension >> row.method >> row.kindA >> row.kindB >> bound;
      EXPECT_TRUE(words && bound >= 0 && out[precision].emplace(row, bound).second) << "not a row: " << line;
    }
  }
  return out;
}
const Table& table() {
  static const Table rows = tables()[kPrecision];
  return rows;
}

bool isCurved(ShapeKind kind) { return coreClass(kind) == CoreClass::curved; }

// Required of an exact method: 1e-12 (f32: 1e-5), or ten times the referee's width if that is larger, as on some deep
// curved pairs. Such pairs do not count for the largest error. An approximate method must only give the right side.
template <int D>
void measure(const Candidate<PairQuery<D>>& m, ShapeKind a, ShapeKind b, const std::vector<HardPair<D>>& pairs,
             const std::vector<PairTruth<D>>& truths, Measured& out) {
  const auto method = m.create();
  if (!method->supports(a, b)) return;
  const Row row{D, m.name, std::string(shapeKindName(a)), std::string(shapeKindName(b))};
  double& largest = out.errors[row];
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const HardPair<D>& p = pairs[i];
    const PairTruth<D>& truth = truths[i];
    const double width = truth.answer.interval().width() / truth.s;
    const bool narrow = 10 * width <= pairTolerance();
    const PairAnswer<D> answer = queryPair(*method, p.a.view(), p.b.view(), p.X_AB);
    const Verdict v = judge<D>({p.a.view(), p.b.view(), p.X_AB}, truth, answer, AlgorithmRole::competitor,
                               Ending::answered, std::max(pairTolerance(), 10.000001 * width));
    if (v.error && narrow) largest = std::max(largest, *v.error);
    const bool sideAlone = m.info.guarantee == Guarantee::approximate;
    const bool right = v.end == Tally::agree || v.end == Tally::tie || v.end == Tally::undecided ||
                       (sideAlone && v.error && !v.wrongSide);
    if (right) continue;
    std::ostringstream text;
    text << row.text() << ": pair " << i << " (" << p.family << "): " << v.failure << ", error "
         << v.error.value_or(-1);
    out.faults.push_back(text.str());
  }
}

template <int D>
std::vector<Candidate<PairQuery<D>>> competitors() {
  std::vector<Candidate<PairQuery<D>>> out;
  for (const Registered* r : Registry::instance().list(StageKind::pairQuery, D)) {
    if (r->info.role != AlgorithmRole::competitor) continue;
    out.push_back({r->info.name, r->info, [r] { return createStage<PairQuery<D>>(Spec{r->info.name, {}}); }});
  }
  return out;
}

template <int D>
void measure(ShapeKind a, ShapeKind b, const std::vector<Candidate<PairQuery<D>>>& methods, Measured& out) {
  // On curved pairs the referee takes a hundred times as long.
  const int count = isCurved(a) || isCurved(b) ? 60 : 400;
  std::vector<HardPair<D>> pairs;
  std::vector<PairTruth<D>> truths;
  for (int i = 0; i < count; ++i) {
    pairs.push_back(hardPair<D>(a, b, kSeed, i));
    truths.push_back(pairTruth<D>({pairs.back().a.view(), pairs.back().b.view(), pairs.back().X_AB}));
  }
  for (const auto& m : methods) measure(m, a, b, pairs, truths, out);
}

template <int D>
Measured measureAll(const std::vector<Candidate<PairQuery<D>>>& methods) {
  Measured out;
  for (int a = 0; a < kShapeKinds; ++a) {
    for (int b = a; b < kShapeKinds; ++b) {
      const auto kindA = static_cast<ShapeKind>(a), kindB = static_cast<ShapeKind>(b);
      if (!kindExists(kindA, D) || !kindExists(kindB, D)) continue;
      if (coreClass(kindA) == CoreClass::plane && coreClass(kindB) == CoreClass::plane) continue;  // never meet
      measure<D>(kindA, kindB, methods, out);
    }
  }
  return out;
}

std::string number(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.0e", x);
  return x > 0 ? text : "0";
}

/// Faults of the table. A method or kind without any row is new: its lines are printed, ready to be added to the table.
std::vector<std::string> faults(const Table& rows, const Table& measured, int dimension) {
  const auto known = [&](const auto& is) {
    return std::any_of(rows.begin(), rows.end(),
                       [&](const auto& r) { return r.first.dimension == dimension && is(r.first); });
  };
  const auto kindKnown = [&](const std::string& kind) {
    return known([&](const Row& r) { return r.kindA == kind || r.kindB == kind; });
  };
  std::vector<std::string> out;
  for (const auto& [row, error] : measured) {
    const auto documented = rows.find(row);
    const std::string line = kPrecision + ' ' + row.text() + ' ' + number(documentedFor(error));
    if (documented == rows.end()) {
      const bool method = known([&, &name = row.method](const Row& r) { return r.method == name; });
      const bool isNew = !method || !kindKnown(row.kindA) || !kindKnown(row.kindB);
      isNew ? static_cast<void>(std::printf("accuracy.txt has no row yet: %s\n", line.c_str()))
            : out.push_back("the table lacks: " + line);
    } else if (!(error <= documented->second)) {
      out.push_back(row.text() + ": error " + std::to_string(error / documented->second) + " times the documented " +
                    number(documented->second) + "; now: " + line);
    } else if (error < documented->second / 10) {
      out.push_back(row.text() + ": more than ten times better than the documented " + number(documented->second) +
                    "; now: " + line);
    }
  }
  for (const auto& [row, bound] : rows) {
    if (row.dimension == dimension && !measured.contains(row)) out.push_back("nobody is that: " + row.text());
  }
  return out;
}

template <int D>
const Measured& ours() {
  static const Measured all = measureAll<D>(competitors<D>());
  return all;
}

std::string lines(const std::vector<std::string>& all) {
  std::string out;
  for (const std::string& line : all) out += line + '\n';
  return out;
}

template <int D>
void isAsDocumented() {
  EXPECT_EQ(lines(ours<D>().faults), "");
  EXPECT_EQ(lines(faults(table(), ours<D>().errors, D)), "");
}
TEST(Accuracy, IsAsDocumentedFromBothSides2) { isAsDocumented<2>(); }
TEST(Accuracy, IsAsDocumentedFromBothSides3) { isAsDocumented<3>(); }

/// Exact, but for an error relative to the size of A.
template <int D>
class OffByMore final : public wrong_queries::SpoiledQuery<D> {
  void spoil(const PairView<D>& pair, PairAnswer<D>& answer, PairMemory*) override {
    answer.distance += static_cast<Real>(1000 * pairTolerance()) * (pair.a.half.norm() + pair.a.radius);
  }
};

template <int D>
void bugsAreCaught() {
  const std::string in = " in " + std::to_string(D) + "D";
  AlgorithmInfo info = {};
  for (const Guarantee guarantee : {Guarantee::exact, Guarantee::approximate}) {
    info.guarantee = guarantee;
    const Candidate<PairQuery<D>> twin{"sat", info, [] { return std::make_unique<OffByMore<D>>(); }};
    Measured off;
    measure<D>(ShapeKind::box, ShapeKind::box, {twin}, off);
    const Row row = off.errors.begin()->first;
    expectCaught("accuracy: off by a thousand tolerances" + in,
                 faults({{row, table().at(row)}}, off.errors, D).empty());
    if (guarantee == Guarantee::exact) expectCaught("accuracy: owes 1e-12" + in, off.faults.empty());
  }
  Measured right;
  measure<D>(ShapeKind::box, ShapeKind::box, competitors<D>(), right);
  Table rows;
  for (const auto& [row, error] : right.errors) {
    if (table().contains(row)) rows[row] = table().at(row);  // otherwise the method is new
  }
  EXPECT_EQ(lines(faults(rows, right.errors, D)), "");
  for (const auto& [row, bound] : rows) {
    Table loose = rows, stale = rows, without = rows;
    loose[row] *= 100;
    expectCaught("accuracy: documented too loosely" + in, faults(loose, right.errors, D).empty());
    stale[{D, row.method, "box", "cone"}] = 1;
    expectCaught("accuracy: a row of nobody" + in, faults(stale, right.errors, D).empty());
    without[{D, row.method, "box", "sphere"}] = 1;
    without.erase(row);
    Table seen = right.errors;
    seen[{D, row.method, "box", "sphere"}] = 1;
    expectCaught("accuracy: a row forgotten" + in, faults(without, seen, D).empty());
    // A method without any row is new.
    Table unknown = rows;
    unknown.erase(row);
    EXPECT_EQ(lines(faults(unknown, right.errors, D)), "");
  }
}
TEST(Accuracy, PlantedBugsAreCaught) { bugsAreCaught<2>(), bugsAreCaught<3>(); }

// The table of docs/verification.md: for each method the largest of its rows, by class of cores.
TEST(Accuracy, PageShowsTheTable) {
  std::map<std::string, std::map<std::string, double>> largest;  // method, column
  for (const auto& [precision, rows] : tables()) {
    for (const auto& [row, bound] : rows) {
      const bool curved = isCurved(shapeKindFromName(row.kindA)) || isCurved(shapeKindFromName(row.kindB));
      double& most = largest["`" + row.method + "`"][(curved ? "curved " : "others ") + precision];
      most = std::max(most, bound);
    }
  }
  std::string expected;
  for (const auto& [method, columns] : largest) {
    expected += "| " + method;
    for (const char* column : {"others f64", "curved f64", "others f32", "curved f32"}) {
      expected += " | " + (columns.contains(column) ? number(columns.at(column)) : "");
    }
    expected += " |\n";
  }
  std::ifstream in(LPC_SOURCE_DIR "/docs/verification.md");
  std::string shown;
  bool inside = false;
  for (std::string line; std::getline(in, line);) {
    if (line == "<!-- accuracy -->" || line == "<!-- end -->") inside = line == "<!-- accuracy -->";
    if (inside && line.starts_with("| `")) shown += line + '\n';
  }
  EXPECT_EQ(shown, expected);
}

// Prints the table anew; see the comment at the top of accuracy.txt.
template <int D>
void print() {
  for (const auto& [row, error] : ours<D>().errors) {
    std::printf("%s %s %s\n", kPrecision.c_str(), row.text().c_str(), number(documentedFor(error)).c_str());
  }
}
TEST(Accuracy, DISABLED_print) { print<2>(), print<3>(); }

}  // namespace accuracy_test
}}}}  // namespace lpc::LPC_PRECISION::test::accuracy_test
