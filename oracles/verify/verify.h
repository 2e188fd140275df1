// SPDX-License-Identifier: Zlib
// `lpc verify`: pair queries, contact generators and broadphases on seeded inputs before the referee. A method is wrong
// when the referee's proof says so; methods that merely differ from each other are not compared. Velocity resolvers
// are, and what each leaves of the problem decides.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "framework/problem/frozen_problem.h"
#include "framework/stage/stage_broadphase.h"
#include "framework/stage/stage_narrowphase.h"
#include "framework/stage/stage_time_of_impact.h"
#include "oracles/corpus/box_script.h"
#include "oracles/corpus/hard_pairs.h"
#include "oracles/verify/verdict.h"
#include "oracles/witnesses/witness.h"

namespace lpc { inline namespace LPC_PRECISION {

/// A method by the name that the ledger shall show.
template <class StageOf>
struct Candidate {
  std::string name;
  AlgorithmInfo info;
  std::function<std::unique_ptr<StageOf>()> create;
};

/// What every method is asked: the inputs numbered first .. first + count - 1 of a seed.
struct VerifyRange {
  std::uint64_t seed = 1;
  int first = 0, count = 0;
  /// How the process ended that asked this: booked as the verdict, and nobody is asked again.
  std::optional<Tally> ended = {};
};

/// The one measure of an answer's error, in ledgers and in trials: |distance - referee's interval| / s, or what the
/// separation along the normal lacks, whichever is more. A side alone has none: what says that the shapes are apart and
/// claims no gap (PairQuery::claimsGap), and a witness's `degenerate`.
template <int D>
Verdict judge(const PairView<D>& pair, const PairTruth<D>& truth, const PairAnswer<D>& answer, AlgorithmRole role,
              Ending ending = Ending::answered, double tolerance = pairTolerance(), bool claimsGap = true);

/// The time (ns) of all these queries, each by itself and between two readings of the clock: as witnesses are timed.
template <int D>
double timeOneByOne(PairQuery<D>& method, std::span<const PairView<D>> pairs, std::span<PairAnswer<D>> answers);

/// Pairs of these kinds (kindA <= kindB; see hardPair) through each method that supports them.
template <int D>
void verifyPairQueries(ShapeKind kindA, ShapeKind kindB, const VerifyRange& range,
                       std::span<const Candidate<PairQuery<D>>> methods, Verified& out);

/// The same pairs before their images: docs/verification.md says which, and what is a violation. Booked under the axis
/// `relation`: `agree` to the last bit where the truth is the same (else within what is owed), `tie` within what is
/// owed, `wrong` violated. None is kept.
template <int D>
void verifyRelations(ShapeKind kindA, ShapeKind kindB, const VerifyRange& range,
                     std::span<const Candidate<PairQuery<D>>> methods, Verified& out);

/// The same pairs as bodies: a manifold if and only if they are within the margin; one unit normal along which they are
/// as far apart as they are; points on both shapes, the deepest as deep as they. And faces laid on faces, which keep
/// their features under a small motion (family resting_faces).
template <int D>
void verifyContacts(ShapeKind kindA, ShapeKind kindB, const VerifyRange& range,
                    std::span<const Candidate<ContactGenerator<D>>> methods, Verified& out);

/// One pair by the same checks, as a file of cases holds it: the pair query is asked X_AB, the generator both world
/// poses. Precondition: the method supports the kinds, kindA <= kindB.
template <int D>
Verdict verifyPair(const HardPair<D>& pair, const Candidate<PairQuery<D>>& method);
template <int D>
Verdict verifyPair(const HardPair<D>& pair, const Candidate<ContactGenerator<D>>& method);

/// Sets of boxes that come, move and go: the pairs of every step, compared with those of every two boxes.
template <int D>
void verifyBroadphases(const VerifyRange& range, std::span<const Candidate<Broadphase<D>>> methods, Verified& out);

/// One set of boxes by the same check, as a file of cases holds it.
template <int D>
Verdict verifyScript(const BoxScript<D>& script, const Candidate<Broadphase<D>>& method);

/// Motions of hard pairs, drawn for a second (f32 and f64 draw alike): `wrong` is who is late, misses an impact or
/// finds one where the shapes are apart by more than kImpactBand, by brackets of the referee. Nothing is kept: a motion
/// is its kinds, seed and number.
template <int D>
void verifyImpacts(ShapeKind kindA, ShapeKind kindB, const VerifyRange& range,
                   std::span<const Candidate<TimeOfImpact<D>>> methods, Verified& out);

/// Drawn problems (drawProblem) through resolvers that are to converge: velocities before those of the reference, the
/// answer of convergedResolvers() that leaves least, whoever else is asked. Others are a `tie` where they leave as
/// little as a solution may, `wrong` where they leave more, and `undecided` where neither they nor the reference solve
/// the problem. Nothing is kept: a problem is its seed and number.
template <int D>
void verifyVelocities(const VerifyRange& range, std::span<const Candidate<VelocityResolver<D>>> methods, Verified& out);

/// The verdicts of the methods on one problem by the same check; the time of each is added to `nanoseconds`.
template <int D>
std::vector<Verdict> verifyProblem(const FrozenProblem<D>& problem,
                                   std::span<const Candidate<VelocityResolver<D>>> methods,
                                   std::vector<double>* nanoseconds = nullptr);

/// Ours that are to converge, as they are asked: the reference is one of them, and always sought among all.
inline std::vector<Spec> convergedResolvers(int dimension) {
  std::vector<Spec> out = {Spec::parse("admm{iterations=20000,tolerance=1e-13,proximal=1e-6}"),
                           Spec::parse("proximal_newton{tolerance=1e-13,passes=1000,iterations=100000}")};
  if (dimension == 2) out.push_back(Spec::parse("direct_lcp{cfm=0}"));  // in 3D its law is that of facets
  return out;
}

/// One stage by name, on methods of the registry: what a worker does. The kinds are ignored by broadphases. Throws
/// UserError for names that do not exist. A failure that it keeps is asked again, alone and from its text: what does
/// not fail so again is named `_once`, and its case says "again": false.
struct VerifyTask {
  StageKind stage = StageKind::pairQuery;
  int dimension = 3;
  ShapeKind kindA = ShapeKind::sphere, kindB = ShapeKind::sphere;
  VerifyRange range = {};
  std::vector<std::string> methods = {};  // specs, as gjk_epa{tolerance=1e-10}
  bool relations = false;                 // of pair queries: verifyRelations instead
};
Verified verify(const VerifyTask& task);

}}  // namespace lpc::LPC_PRECISION
