// SPDX-License-Identifier: Zlib
#include "oracles/verify/verdict.h"

#include <cmath>
#include <limits>

#include "oracles/corpus/hard_pairs.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

std::string decadeOf(double error) {
  return error > 0 ? std::to_string(static_cast<int>(std::floor(std::log10(error)))) : "zero";
}

LedgerEntry& bookUnder(Ledger& ledger, const LedgerKey& key, AlgorithmRole role, const Verdict& verdict,
                       double nanoseconds) {
  LedgerEntry& entry = ledger[key];
  entry.role = role;
  ++entry[Tally::asked], ++entry[verdict.end];
  if (verdict.wrongSide) ++entry[Tally::wrongSide];
  if (verdict.capped) ++entry[Tally::capped];
  if (verdict.error) ++entry.histogram[decadeOf(*verdict.error)];
  entry.nanoseconds += nanoseconds;
  return entry;
}

}  // namespace

Verdict withoutAnswer(Tally end) {
  Verdict v;
  v.end = end, v.failure = kTallyNames[static_cast<std::size_t>(end)];
  return v;
}

void book(Ledger& ledger, LedgerKey subject, AlgorithmRole role, const Labels& labels, const Verdict& verdict,
          double nanoseconds, const std::function<std::string()>& text) {
  const double error = verdict.error.value_or(0);
  for (const auto& [axis, value] : labels) {
    subject.axis = axis, subject.value = value;
    LedgerEntry& entry = bookUnder(ledger, subject, role, verdict, nanoseconds);
    entry.maxError = std::max(entry.maxError, error);
  }
  subject.axis = "all", subject.value.clear();
  LedgerEntry& entry = bookUnder(ledger, subject, role, verdict, nanoseconds);
  if (error > entry.maxError || (entry.worst.empty() && verdict.end == Tally::wrong)) {
    entry.maxError = std::max(entry.maxError, error);
    entry.worst = text();
  }
}

LedgerKey subjectOf(StageKind stage, int dimension, const std::string& method) {
  LedgerKey key;
  key.stage = stageName(stage), key.precision = sizeof(Real) == 8 ? "f64" : "f32";
  key.dimension = dimension, key.method = method;
  return key;
}

std::string findingText(const LedgerKey& subject, const Verdict& verdict, std::uint64_t seed, int index) {
  const auto orNull = [&](double x) {
    return numberText(verdict.error ? x : std::numeric_limits<double>::quiet_NaN());
  };
  return ", \"found\": {\"stage\": \"" + subject.stage + "\", \"precision\": \"" + subject.precision +
         "\", \"method\": \"" + subject.method + "\", " +
         (verdict.failure.empty() ? std::string(kNoFailure) : "\"failure\": \"" + verdict.failure + '"') +
         ", \"value\": " + orNull(verdict.value) + ", \"error\": " + orNull(verdict.error.value_or(0)) +
         ", \"seed\": " + std::to_string(seed) + ", \"number\": " + std::to_string(index) + "}";
}

std::string inputName(const LedgerKey& subject, std::uint64_t seed, int index) {
  std::string name = subject.stage + "-" + std::to_string(subject.dimension) + "d-" + subject.precision;
  if (!subject.kindA.empty()) name += "-" + subject.kindA + "-" + subject.kindB;
  return name + "-" + std::to_string(seed) + "-" + std::to_string(index);
}

bool owesSideAlone(StageKind stage, const AlgorithmInfo& info) {
  return stage == StageKind::pairQuery && info.guarantee == Guarantee::approximate;
}

long faultsOfOurs(const LedgerKey& key, const LedgerEntry& entry) {
  if (entry.role != AlgorithmRole::competitor) return 0;
  const StageInfo* stage = stageByName(key.stage);
  const auto& all = Registry::instance().all();
  const auto at =
      stage ? all.find({stage->kind, key.dimension, Spec::parse(key.method).name}) : all.end();  // otherwise from a
                                                                                                 // plugin
  if (at == all.end() || !owesSideAlone(stage->kind, at->second.info)) return entry.faults();
  return entry.faults() - entry[Tally::wrong] + entry[Tally::wrongSide];
}

}}  // namespace lpc::LPC_PRECISION
