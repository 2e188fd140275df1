// SPDX-License-Identifier: Zlib
#include <cmath>

#include "oracles/verify/metamorphic.h"
#include "oracles/verify/verify.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

template <int D>
struct Asked {
  RelatedPairs<D> pairs;
  bool sameTruth = false;  // true: of `after` only s is needed
  PairTruth<D> before = {}, after = {};
};

struct ImageAnswer {
  QueryStatus status;
  Real distance;
  Ending ending;

  bool is() const {
    return ending == Ending::answered && status != QueryStatus::refused && status != QueryStatus::failed &&
           std::isfinite(distance);
  }
  Tally without() const {
    if (ending == Ending::threw) return Tally::threw;
    if (ending == Ending::crashed) return Tally::crashed;
    if (ending == Ending::hung) return Tally::hung;
    return ending == Ending::answered && status == QueryStatus::refused ? Tally::refused : Tally::notFinite;
  }
};

template <int D>
std::vector<ImageAnswer> ask(PairQuery<D>& method, const std::vector<PairView<D>>& views) {
  std::vector<PairAnswer<D>> answers(views.size());
  WorkDone work;
  method.query(views, QueryNeed::closestPoints, answers, {}, work);
  const auto* witness = dynamic_cast<const Witness<D>*>(&method);
  std::vector<ImageAnswer> out;
  for (std::size_t i = 0; i < answers.size(); ++i) {
    out.push_back({answers[i].status, answers[i].distance, witness ? witness->endings()[i] : Ending::answered});
  }
  return out;
}

// Compares the two answers; see docs/verification.md.
template <int D>
Verdict compare(const Asked<D>& asked, const ImageAnswer& before, const ImageAnswer& after, AlgorithmRole role,
                double tolerance, bool claimsGap) {
  if (!before.is() && !after.is()) return withoutAnswer(before.without());
  Verdict v;
  if (before.is() != after.is()) {
    v.end = Tally::wrong;
    return v;
  }
  const Interval truth = asked.before.answer.interval(), image = asked.after.answer.interval();
  const double size = asked.before.s + asked.after.s / asked.pairs.factor;
  const auto isKnown = [&](const PairTruth<D>& t) {
    return t.answer.decided && 10 * t.answer.interval().width() <= tolerance * t.s;
  };
  const bool known = isKnown(asked.before) && (asked.sameTruth || isKnown(asked.after));
  const auto hasValue = [&](const ImageAnswer& a) {
    return (a.distance < 0 || claimsGap) && (role == AlgorithmRole::competitor || a.status != QueryStatus::degenerate);
  };
  const bool values = hasValue(before) && hasValue(after);
  const auto isCapped = [&](const ImageAnswer& a) { return hasValue(a) && a.status != QueryStatus::converged; };
  v.capped = isCapped(before) || isCapped(after);
  if (!known && (!values || !asked.sameTruth || v.capped)) {
    v.end = Tally::undecided;
    return v;
  }
  const double phi = static_cast<double>(before.distance);
  const double other = static_cast<double>(after.distance) / asked.pairs.factor;
  if (values) {
    const Interval change = asked.sameTruth ? Interval{} : Interval{image.lo - truth.hi, image.hi - truth.lo};
    v.error = change.distanceTo(other - phi) / size;
    if (*v.error > tolerance) v.end = Tally::wrong;
    if (v.end == Tally::agree && asked.sameTruth && (other < phi || other > phi)) v.end = Tally::tie;
  }
  const bool aside = known && (truth.lo > tolerance * size || truth.hi < -tolerance * size);
  v.wrongSide = aside && (phi < 0) != (other < 0);
  if (v.wrongSide) v.end = Tally::wrong;
  return v;
}

template <int D>
Asked<D> asked(const RelatedPairs<D>& pairs, const PairTruth<D>& ofPair, Relation relation) {
  Asked<D> out{.pairs = pairs, .sameTruth = keepsTruth(relation)};
  out.before = relation == Relation::translation ? pairTruth(pairs.before.view()) : ofPair;  // `before` was snapped to
                                                                                             // the grid
  if (out.sameTruth) {
    const double phi = pairs.factor * out.before.answer.interval().middle();
    const PairView<D> image = pairs.after.view();
    out.after.s = errorScale<D>(image.a, {}, image.b, image.X_AB, phi);
  } else {
    out.after = pairTruth(pairs.after.view());
  }
  return out;
}

}  // namespace

template <int D>
void verifyRelations(ShapeKind kindA, ShapeKind kindB, const VerifyRange& range,
                     std::span<const Candidate<PairQuery<D>>> methods, Verified& out) {
  std::array<std::vector<Asked<D>>, kRelations> all;
  for (int i = 0; i < range.count; ++i) {
    const int index = range.first + i;
    const HardPair<D> pair = hardPair<D>(kindA, kindB, range.seed, index);
    const PairTruth<D> truth = pairTruth<D>({pair.a.view(), pair.b.view(), pair.X_AB});
    for (std::size_t r = 0; r < kRelations; ++r) {
      const auto relation = static_cast<Relation>(r);
      const std::uint64_t choice = range.seed * 1000003 + static_cast<std::uint64_t>(index);
      if (const auto pairs = relatedPairs(relation, pair, choice)) {
        all[r].push_back(asked(*pairs, truth, relation));
      }
    }
  }
  for (const Candidate<PairQuery<D>>& m : methods) {
    const auto method = m.create();
    if (!method->supports(kindA, kindB)) continue;
    const double tolerance = verifyTolerance(dynamic_cast<const Witness<D>*>(method.get()));
    LedgerKey key = subjectOf(StageKind::pairQuery, D, m.name);
    key.kindA = shapeKindName(kindA), key.kindB = shapeKindName(kindB);
    key.axis = kRelationAxis;
    for (std::size_t r = 0; r < kRelations; ++r) {
      if (all[r].empty()) continue;
      std::vector<PairView<D>> views;
      for (const Asked<D>& a : all[r]) views.push_back(a.pairs.before.view()), views.push_back(a.pairs.after.view());
      const std::vector<ImageAnswer> answers = range.ended ? std::vector<ImageAnswer>{} : ask(*method, views);
      key.value = kRelationNames[r];
      LedgerEntry& entry = out.ledger[key];
      entry.role = m.info.role;
      for (std::size_t i = 0; i < all[r].size(); ++i) {
        const Verdict v = range.ended ? withoutAnswer(*range.ended)
                                      : compare(all[r][i], answers[2 * i], answers[2 * i + 1], m.info.role, tolerance,
                                                method->claimsGap(kindA, kindB));
        ++entry[Tally::asked], ++entry[v.end];
        if (v.wrongSide) ++entry[Tally::wrongSide];
        if (v.capped) ++entry[Tally::capped];
        entry.maxError = std::max(entry.maxError, v.error.value_or(0));
      }
    }
  }
}

template void verifyRelations(ShapeKind, ShapeKind, const VerifyRange&, std::span<const Candidate<PairQuery<2>>>,
                              Verified&);
template void verifyRelations(ShapeKind, ShapeKind, const VerifyRange&, std::span<const Candidate<PairQuery<3>>>,
                              Verified&);

}}  // namespace lpc::LPC_PRECISION
