// SPDX-License-Identifier: Zlib
#include <chrono>
#include <cmath>

#include "framework/math/tolerances.h"
#include "framework/math/worse.h"
#include "oracles/verify/regime.h"
#include "oracles/verify/verdict.h"
#include "oracles/verify/verify.h"
#include "oracles/witnesses/witness.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

// An equally good normal that differs from the referee's by more than this is a tie, not rounding.
constexpr double kOtherNormal = sizeof(Real) == 8 ? 1e-6 : 1e-3;

template <int D>
struct Known {
  HardPair<D> pair;
  PairTruth<D> truth = {};
  int vertices = 0;
  Labels labels = {};

  PairView<D> view() const { return {pair.a.view(), pair.b.view(), pair.X_AB}; }
};

std::string plainNumber(double x) {
  std::string text = std::to_string(x);
  text.erase(text.find_last_not_of('0') + 1);
  return text.back() == '.' ? text.substr(0, text.size() - 1) : text;
}

template <int D>
Known<D> knownPair(HardPair<D> pair) {
  Known<D> known{.pair = std::move(pair)};
  known.truth = pairTruth(known.view());
  known.vertices = coreVertexCount<D>(known.pair.a.view()) + coreVertexCount<D>(known.pair.b.view());
  known.labels = {{"family", std::string(known.pair.family)},
                  {"regime", std::string(regimeOf(known.pair, known.truth.answer))},
                  {"scale", plainNumber(known.pair.scale)},
                  {"offset", plainNumber(known.pair.offset)}};
  return known;
}

Tally endOf(Ending ending) {
  switch (ending) {
    case Ending::notFinite:
      return Tally::notFinite;
    case Ending::threw:
      return Tally::threw;
    case Ending::crashed:
      return Tally::crashed;
    case Ending::hung:
      return Tally::hung;
    case Ending::answered:
      break;
  }
  return Tally::agree;
}

// How far the separation along the answer's normal is below the true distance (m), which a correct normal attains.
template <int D>
double shortfall(const PairView<D>& pair, const PairTruth<D>& known, const Vecd<D>& n, AlgorithmRole role,
                 double tolerance) {
  const Interval truth = known.answer.interval();
  if (n.isZero(0)) {
    // A missing normal is allowed only when the boundaries touch, and for witnesses.
    const bool touching = std::abs(truth.middle()) <= tolerance * known.s;
    return touching || role != AlgorithmRole::competitor ? 0 : known.s;
  }
  const double length = std::abs(n.norm() - 1);
  if (role == AlgorithmRole::competitor && length > static_cast<double>(kUnitTolerance)) return length * known.s;
  const Interval along = separationAlong<D>(pair.a, {}, pair.b, pair.X_AB, n);
  return worse(0, truth.lo - along.hi);
}

}  // namespace

template <int D>
Verdict judge(const PairView<D>& pair, const PairTruth<D>& known, const PairAnswer<D>& answer, AlgorithmRole role,
              Ending ending, double tolerance, bool claimsGap) {
  if (ending != Ending::answered) return withoutAnswer(endOf(ending));
  if (answer.status == QueryStatus::refused) return withoutAnswer(Tally::refused);
  const double phi = static_cast<double>(answer.distance);
  const bool finite = std::isfinite(phi) && answer.normal.allFinite();
  if (answer.status == QueryStatus::failed || !finite) return withoutAnswer(Tally::notFinite);
  // The bounds of a curved core are not exact: comparisons must allow ten times their width.
  const bool narrow = 10 * known.answer.interval().width() <= tolerance * known.s;
  if (!known.answer.decided || !narrow) return withoutAnswer(Tally::undecided);

  const Interval truth = known.answer.interval();
  const double allowed = tolerance * known.s;
  Verdict v;
  v.capped = answer.status != QueryStatus::converged;
  v.wrongSide = (phi < 0 && truth.lo > allowed) || (phi >= 0 && truth.hi < -allowed);
  // A witness that is `degenerate` reports the side and no value.
  v.sideAlone =
      (phi >= 0 && !claimsGap) || (role != AlgorithmRole::competitor && answer.status == QueryStatus::degenerate);
  if (!v.sideAlone) {
    const Vecd<D> n = answer.normal.template cast<double>();
    const double value = truth.distanceTo(phi), along = shortfall(pair, known, n, role, tolerance);
    v.value = phi, v.error = std::max(value, along) / known.s;
    if (*v.error > tolerance) {
      v.end = Tally::wrong, v.failure = value > allowed ? "wrong_distance" : "wrong_normal";
    } else if (!n.isZero(0) && (n.normalized() - known.answer.normal).norm() > kOtherNormal) {
      v.end = Tally::tie;
    }
  }
  if (v.wrongSide) v.end = Tally::wrong, v.failure = "wrong_side";
  v.wider = v.end != Tally::wrong && v.error.value_or(0) * known.s > tolerance * known.posed;
  return v;
}

template Verdict judge(const PairView<2>&, const PairTruth<2>&, const PairAnswer<2>&, AlgorithmRole, Ending, double,
                       bool);
template Verdict judge(const PairView<3>&, const PairTruth<3>&, const PairAnswer<3>&, AlgorithmRole, Ending, double,
                       bool);

template <int D>
double timeOneByOne(PairQuery<D>& method, std::span<const PairView<D>> pairs, std::span<PairAnswer<D>> answers) {
  using Clock = std::chrono::steady_clock;  // the clock of a witness's process
  WorkDone work;
  Clock::duration spent{};
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Clock::time_point before = Clock::now();
    method.query(pairs.subspan(i, 1), QueryNeed::closestPoints, answers.subspan(i, 1), {}, work);
    spent += Clock::now() - before;
  }
  return std::chrono::duration<double, std::nano>(spent).count();
}

template double timeOneByOne(PairQuery<2>&, std::span<const PairView<2>>, std::span<PairAnswer<2>>);
template double timeOneByOne(PairQuery<3>&, std::span<const PairView<3>>, std::span<PairAnswer<3>>);

template <int D>
Verdict verifyPair(const HardPair<D>& pair, const Candidate<PairQuery<D>>& method) {
  const auto query = method.create();
  const auto* witness = dynamic_cast<const Witness<D>*>(query.get());
  const PairAnswer<D> answer = queryPair(*query, pair.a.view(), pair.b.view(), pair.X_AB);
  const PairView<D> view{pair.a.view(), pair.b.view(), pair.X_AB};
  const Ending ending = witness ? witness->endings()[0] : Ending::answered;
  return judge(view, pairTruth(view), answer, method.info.role, ending, verifyTolerance(witness),
               query->claimsGap(view.a.kind, view.b.kind));
}

template Verdict verifyPair(const HardPair<2>&, const Candidate<PairQuery<2>>&);
template Verdict verifyPair(const HardPair<3>&, const Candidate<PairQuery<3>>&);

template <int D>
void verifyPairQueries(ShapeKind kindA, ShapeKind kindB, const VerifyRange& range,
                       std::span<const Candidate<PairQuery<D>>> methods, Verified& out) {
  constexpr int kAtOnce = 1024;  // number of ground truths kept in memory
  std::vector<PairView<D>> views;
  std::vector<PairAnswer<D>> answers;
  std::vector<Known<D>> known;
  for (int begin = 0; begin < range.count; begin += kAtOnce) {
    const int count = std::min(range.count - begin, kAtOnce);
    known.clear(), views.clear();
    for (int i = 0; i < count; ++i) {
      known.push_back(knownPair(hardPair<D>(kindA, kindB, range.seed, range.first + begin + i)));
    }
    for (const Known<D>& k : known) views.push_back(k.view());
    for (const Candidate<PairQuery<D>>& m : methods) {
      const auto method = m.create();
      if (!method->supports(kindA, kindB)) continue;
      const auto* witness = dynamic_cast<const Witness<D>*>(method.get());
      const double tolerance = verifyTolerance(witness);
      WorkDone work;
      double spent = 0;
      answers.assign(views.size(), {});
      if (!range.ended) {
        method->query(views, QueryNeed::closestPoints, answers, {}, work);  // for our methods this warms the caches
        spent = witness ? static_cast<double>(witness->nanoseconds()) : timeOneByOne<D>(*method, views, answers);
      }
      LedgerKey subject = subjectOf(StageKind::pairQuery, D, m.name);
      subject.kindA = shapeKindName(kindA), subject.kindB = shapeKindName(kindB);
      for (int i = 0; i < count; ++i) {
        const Known<D>& k = known[static_cast<std::size_t>(i)];
        const PairAnswer<D>& answer = answers[static_cast<std::size_t>(i)];
        const Ending ending =
            witness && !range.ended ? witness->endings()[static_cast<std::size_t>(i)] : Ending::answered;
        const Verdict verdict = range.ended ? withoutAnswer(*range.ended)
                                            : judge(k.view(), k.truth, answer, m.info.role, ending, tolerance,
                                                    method->claimsGap(kindA, kindB));
        const auto text = [&] {
          const int index = range.first + begin + i;
          return caseText<D>(inputName(subject, range.seed, index), StageKind::pairQuery, k.pair,
                             findingText(subject, verdict, range.seed, index) + expectedText(k.truth.answer) +
                                 outlinesText<D>(k.pair));
        };
        Labels labels = k.labels;
        if (verdict.wider) labels.emplace_back(kWiderScale, "frames");
        book(out.ledger, subject, m.info.role, labels, verdict, spent / count, text);
        if (!verdict.failure.empty() && verdict.end != Tally::undecided) {
          out.keep({m.name, verdict.failure, k.vertices, k.truth.s, text()});
        }
      }
    }
  }
}

template void verifyPairQueries(ShapeKind, ShapeKind, const VerifyRange&, std::span<const Candidate<PairQuery<2>>>,
                                Verified&);
template void verifyPairQueries(ShapeKind, ShapeKind, const VerifyRange&, std::span<const Candidate<PairQuery<3>>>,
                                Verified&);

}}  // namespace lpc::LPC_PRECISION
