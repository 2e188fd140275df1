// SPDX-License-Identifier: Zlib
#include "experiments/runner/breaking.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <set>

#include "experiments/runner/metric_name.h"
#include "experiments/runner/sweep_file.h"
#include "experiments/trial/measure/metric.h"
#include "framework/math/names.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

constexpr double kWidest = 2;  // step of a grid: with wider steps a method may fail between two values and hold at both
constexpr double kSure = 1.959964;  // standard deviations of 95 %
constexpr double kHalf = 0.5;       // of the seeds
constexpr long kMostSeeds = 1000;
constexpr double kNarrowest = 1.001;
constexpr double kMostValues = 100;  // of a grid
constexpr int kMostMoves = 8;        // further values tried where all seeds disagree with the few
constexpr int kMostEdges = 6;        // values tried with all seeds
// These are not parameters to search: another value asks another question.
constexpr std::array kNoParameters = {"dimension", "model", "precision", "scene", "script", "seed"};

// Five digits, so that a label shows the value that was run.
double tidy(double value) {
  const double unit = std::pow(10.0, std::floor(std::log10(value)) - 4);
  return std::stod(asText(std::round(value / unit) * unit));
}

bool isNarrow(const BreakQuestion& q, bool whole, double a, double b) { return whole ? b - a <= 1 : b / a <= q.ratio; }

double between(bool whole, double a, double b) { return whole ? a + std::floor((b - a) / 2) : tidy(std::sqrt(a * b)); }

}  // namespace

MetricLimit::MetricLimit(const std::string& given) : text(given) {
  const std::size_t at = std::min(given.find_first_of("<>"), given.size());
  metric = given.substr(0, at);
  const char *begin = given.data() + std::min(at + 1, given.size()), *end = given.data() + given.size();
  const auto [read, error] = std::from_chars(begin, end, bound);
  if (at == given.size() || error != std::errc() || read != end || !std::isfinite(bound)) {
    throw UserError("'limit' is '" + given + "'; valid: METRIC<NUMBER or METRIC>NUMBER, such as joint_error_max<0.01");
  }
  below = given[at] == '<';
  std::vector<std::string> valid;
  for (const DescribedMetric& m : describeMetrics()) {
    if (m.what != "metric" || m.kind != "world" || m.info.need == TrialNeed::timing) continue;
    if (isMetric(m.info, metric)) return;
    for (const std::string& name : namesOf(m.info)) valid.push_back(name);
  }
  throw UserError("'limit' names the metric '" + metric + "'" + validNames(valid, metric));
}

void BreakQuestion::fail(const std::string& what) const { throw UserError((place.empty() ? "" : place + ": ") + what); }

void BreakQuestion::checkParameter() const {
  if (parameter.empty()) fail("a breaking point needs the name of a parameter");
  if (std::find(kNoParameters.begin(), kNoParameters.end(), parameter) == kNoParameters.end()) return;
  fail("'" + parameter + "' cannot be searched; valid: a parameter of the scene, dt, steps, or $NAME in a pipeline");
}

void BreakQuestion::check() const {
  checkParameter();
  if (!(from > 0) || !(to > from)) {
    fail("'from' is " + asText(from) + " and 'to' " + asText(to) + "; valid: numbers above 0, 'to' the larger one");
  }
  if (!(truth == 0 || (truth >= from && truth <= to))) {
    fail("'truth' is " + asText(truth) + "; valid: from " + asText(from) + " to " + asText(to));
  }
  if (seeds < 1 || seeds > kMostSeeds) fail("'seeds' is " + std::to_string(seeds) + "; valid: 1 to 1000");
  if (!(step >= kNarrowest && step <= kWidest)) fail("'grid' is " + asText(step) + "; valid: 1.001 to 2");
  if (!(ratio >= kNarrowest && ratio <= kWidest)) fail("'ratio' is " + asText(ratio) + "; valid: 1.001 to 2");
  if (std::log(to / from) > kMostValues * std::log(step)) {
    fail("a 'grid' of " + asText(step) + " has more than " + asText(kMostValues) + " values; valid: a larger one");
  }
  if (!(perturb >= 0 && perturb <= kMostPerturbed)) {
    fail("'perturb' is " + asText(perturb) + "; valid: 0 to " + asText(kMostPerturbed) + " (m and rad)");
  }
}

std::vector<double> BreakQuestion::grid(bool whole) const {
  std::vector<double> out = {from};
  for (int k = 1;; ++k) {
    const double exact = from * std::pow(step, k), x = whole ? std::round(exact) : tidy(exact);
    if (!(x < to)) break;
    if (x > out.back()) out.push_back(x);
  }
  out.push_back(to);
  return out;
}

int BreakQuestion::mostTried() const {
  const double halves = std::max(std::log2(to), std::log2(std::log(step) / std::log(ratio)));
  return static_cast<int>(grid(false).size()) + std::max(0, static_cast<int>(std::ceil(halves))) + kMostMoves;
}

int BreakQuestion::mostTrials() const {
  return static_cast<int>(mostTried() * fewSeeds() + kMostEdges * (seeds - fewSeeds()));
}

long BreakQuestion::fewSeeds() const { return std::min(seeds, kFewestSeeds); }

BreakQuestion readBreak(const toml::table& table, const std::string& file, const std::optional<BreakQuestion>& base) {
  TableReader t(table, file, "'break'");
  BreakQuestion out = base.value_or(BreakQuestion());
  out.place = file + ":" + std::to_string(table.source().begin.line);
  out.name = t.string("question", out.name), out.parameter = t.string("parameter", out.parameter);
  out.from = t.number("from", out.from), out.to = t.number("to", out.to);
  out.seeds = t.integer("seeds", out.seeds);
  out.perturb = t.number("perturb", out.perturb), out.ratio = t.number("ratio", out.ratio);
  out.step = t.number("grid", out.step);
  out.falling = t.flag("falling", out.falling);
  out.truth = t.number("truth", out.truth);
  if (const toml::node* node = t.find("limit")) {
    try {
      out.limit.emplace(t.requireString("limit"));
    } catch (const PlacedError&) {
      throw;
    } catch (const UserError& e) {
      t.fail(*node, e.what());
    }
  }
  t.finish();
  return out;
}

ShareInterval wilson(long failed, long of) {
  if (of == 0) return {0, 1};
  const double n = static_cast<double>(of), p = static_cast<double>(failed) / n, z = kSure * kSure;
  const double middle = (p + z / (2 * n)) / (1 + z / n);
  const double half = kSure * std::sqrt(p * (1 - p) / n + z / (4 * n * n)) / (1 + z / n);
  return {std::max(0.0, middle - half), std::min(1.0, middle + half)};
}

Broken judge(const BreakQuestion& q, std::vector<Rung> rungs) {
  std::sort(rungs.begin(), rungs.end(), [](const Rung& a, const Rung& b) { return a.value < b.value; });
  Broken out;
  out.rungs = rungs;
  if (q.falling) std::reverse(rungs.begin(), rungs.end());
  std::optional<double> sureToHold, sureToFail;
  bool sure = true;
  for (const Rung& r : rungs) {
    const ShareInterval share = wilson(r.failed, r.of);
    sure = sure && share.high < kHalf;
    if (sure) sureToHold = r.value;
    if (!out.fell) {
      (r.holds() ? out.held : out.fell) = r;
    } else if (r.holds()) {
      out.passesBeyond.push_back(r.value);
    }
    if (out.fell && !sureToFail && share.low > kHalf) sureToFail = r.value;
  }
  if (out.held && out.fell && !out.fell->refused) {
    const auto share = [](const Rung& r) { return static_cast<double>(r.failed) / static_cast<double>(r.of); };
    const double a = share(*out.held), b = share(*out.fell);
    out.half = out.held->value * std::pow(out.fell->value / out.held->value, (kHalf - a) / (b - a));
  }
  out.low = q.falling ? sureToFail : sureToHold, out.high = q.falling ? sureToHold : sureToFail;
  return out;
}

std::vector<WantedRung> nextRungs(const BreakQuestion& q, bool whole, const std::vector<Rung>& known) {
  std::vector<WantedRung> missing;
  for (const double value : q.grid(whole)) {
    if (std::none_of(known.begin(), known.end(), [&](const Rung& r) { return r.value == value; })) {
      missing.push_back({value, q.fewSeeds()});
    }
  }
  if (!missing.empty()) return missing;
  const Broken found = judge(q, known);
  if (found.held && found.fell && static_cast<int>(known.size()) < q.mostTried()) {
    const auto [a, b] = std::minmax(found.held->value, found.fell->value);
    const double next = isNarrow(q, whole, a, b) ? a : between(whole, a, b);
    if (next > a && next < b) return {{next, q.fewSeeds()}};
  }
  auto edges =
      kMostEdges - std::count_if(known.begin(), known.end(), [&](const Rung& r) { return r.of > q.fewSeeds(); });
  const auto more = [&](const Rung& r) {
    const bool has =
        std::any_of(missing.begin(), missing.end(), [&](const WantedRung& w) { return w.value == r.value; });
    if (!has && r.of < q.seeds && !r.refused && edges-- > 0) missing.push_back({r.value, q.seeds});
  };
  for (const std::optional<Rung>& end : {found.held, found.fell}) {
    if (end) more(*end);  // also if nothing fails, or nothing holds
  }
  if (!missing.empty() || !found.fell) return missing;  // they may move the bracket
  for (const Rung& r : found.rungs) {
    if ((!found.low || r.value > *found.low) && (!found.high || r.value < *found.high)) more(r);
  }
  return missing;
}

nlohmann::json axisNumber(double value) {
  if (value == std::floor(value) && std::abs(value) < 1e15) return static_cast<long>(value);
  return value;
}

void addLadder(PlannedSweep& sweep, Ladder ladder) {
  const BreakQuestion& q = ladder.question;
  q.check();
  if (sweep.calibration && q.parameter == sweep.calibration->setting) {
    q.fail("'" + q.parameter + "' is what methods get at equal " + sweep.calibration->equal + "; valid: another name");
  }
  const long setting = sweep.calibration ? 1 : 0;
  for (const double end : {q.from, q.to}) {
    for (const PlannedTrial& t : ladder.plan({end, 1, setting, false})) ladder.keys += t.key;
  }
  if (sweep.calibration) ladder.plan({q.from, 1, sweep.calibration->most, false});
  // `repeat = { i = "n" }` and iterations take integers only.
  if (q.from == std::floor(q.from) && q.to == std::floor(q.to)) {
    try {
      ladder.plan({q.from + 0.5, 1, setting, false});
    } catch (const UserError&) {
      ladder.whole = true;
    }
  }
  ladder.keys += " " + asText(ladder.budget) + " " + q.title() + (q.limit ? q.limit->text : "");
  for (const Ladder& other : sweep.ladders) {
    if (other.keys == ladder.keys) return;
    const BreakQuestion& o = other.question;
    const bool same = o.parameter == q.parameter && o.falling == q.falling && o.seeds == q.seeds &&
                      o.truth == q.truth && (o.limit ? o.limit->text : "") == (q.limit ? q.limit->text : "");
    if (o.title() == q.title() && !same) {
      throw UserError(q.place + ": two questions are called '" + q.title() +
                      "'; valid: a name of its own, question = \"...\"");
    }
  }
  sweep.ladders.push_back(std::move(ladder));
}

}}  // namespace lpc::LPC_PRECISION
