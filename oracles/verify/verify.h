// SPDX-License-Identifier: Zlib
// `lpc verify`: compares pair queries, contact generators and broadphases with the referee on seeded inputs. A method
// is wrong when the referee proves it; methods are not compared with each other. Velocity resolvers are compared with
// each other, and their residuals decide.
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

/// A method with its name in the ledger.
template <class StageOf>
struct Candidate {
  std::string name;
  AlgorithmInfo info;
  std::function<std::unique_ptr<StageOf>()> create;
};

/// The inputs for every method: numbers first .. first + count - 1 of a seed.
struct VerifyRange {
  std::uint64_t seed = 1;
  int first = 0, count = 0;
  /// How a process with these inputs ended: recorded as the verdict; no method is run again.
  std::optional<Tally> ended = {};
};

/// Judges an answer. The error measure, in ledgers and in trials, is the larger of |distance - referee's interval| / s
/// and the shortfall of the separation along the normal. An answer with a side only has no error: a method that reports
/// separation and claims no gap (PairQuery::claimsGap), and a witness's `degenerate`.
template <int D>
Verdict judge(const PairView<D>& pair, const PairTruth<D>& truth, const PairAnswer<D>& answer, AlgorithmRole role,
              Ending ending = Ending::answered, double tolerance = pairTolerance(), bool claimsGap = true);

/// Time (ns) of all these queries, each measured separately with two readings of the clock, as for witnesses.
template <int D>
double timeOneByOne(PairQuery<D>& method, std::span<const PairView<D>> pairs, std::span<PairAnswer<D>> answers);

/// Runs pairs of these kinds (kindA <= kindB; see hardPair) through each method that supports them.
template <int D>
void verifyPairQueries(ShapeKind kindA, ShapeKind kindB, const VerifyRange& range,
                       std::span<const Candidate<PairQuery<D>>> methods, Verified& out);

/// Compares the same pairs with their images. docs/verification.md lists the relations and what violates them. Recorded
/// under the axis `relation`: `agree` when equal to the last bit where the truth is the same (otherwise within
/// tolerance), `tie` within tolerance, `wrong` when violated. Keeps no cases.
template <int D>
void verifyRelations(ShapeKind kindA, ShapeKind kindB, const VerifyRange& range,
                     std::span<const Candidate<PairQuery<D>>> methods, Verified& out);

/// The same pairs as bodies. Requires a manifold if and only if they are within the margin, with one unit normal along
/// which their separation is that of the pair. Points must be on both shapes, the deepest as deep as the pair. Also
/// tests faces on faces, which must keep their features under a small motion (family resting_faces).
template <int D>
void verifyContacts(ShapeKind kindA, ShapeKind kindB, const VerifyRange& range,
                    std::span<const Candidate<ContactGenerator<D>>> methods, Verified& out);

/// Runs one pair through the same checks, as a file of cases has it: the pair query gets X_AB, the generator both world
/// poses. Precondition: the method supports the kinds, kindA <= kindB.
template <int D>
Verdict verifyPair(const HardPair<D>& pair, const Candidate<PairQuery<D>>& method);
template <int D>
Verdict verifyPair(const HardPair<D>& pair, const Candidate<ContactGenerator<D>>& method);

/// Sets of boxes that are added, moved and removed: compares the pairs of every step with a test of every two boxes.
template <int D>
void verifyBroadphases(const VerifyRange& range, std::span<const Candidate<Broadphase<D>>> methods, Verified& out);

/// Runs one set of boxes through the same check, as a file of cases has it.
template <int D>
Verdict verifyScript(const BoxScript<D>& script, const Candidate<Broadphase<D>>& method);

/// Random motions of hard pairs over one second (the same in f32 and f64). A method is `wrong` when it is late, misses
/// an impact, or reports one where the shapes are separated by more than kImpactBand, by brackets of the referee. Keeps
/// no cases: kinds, seed and number define a motion.
template <int D>
void verifyImpacts(ShapeKind kindA, ShapeKind kindB, const VerifyRange& range,
                   std::span<const Candidate<TimeOfImpact<D>>> methods, Verified& out);

/// Runs drawn problems (drawProblem) through resolvers that should converge, and compares velocities with the
/// reference. The reference is the answer of convergedResolvers() with the least residual, whichever methods are
/// verified. Answers with other velocities are a `tie` when their residual is that of a solution, and `wrong` when it
/// is larger. They are `undecided` when neither they nor the reference solve the problem. Keeps no cases: seed and
/// number define a problem.
template <int D>
void verifyVelocities(const VerifyRange& range, std::span<const Candidate<VelocityResolver<D>>> methods, Verified& out);

/// Verdicts of the methods on one problem by the same check; adds the time of each method to `nanoseconds`.
template <int D>
std::vector<Verdict> verifyProblem(const FrozenProblem<D>& problem,
                                   std::span<const Candidate<VelocityResolver<D>>> methods,
                                   std::vector<double>* nanoseconds = nullptr);

/// Our resolvers that should converge, with their parameters. The reference is always chosen among all of them.
inline std::vector<Spec> convergedResolvers(int dimension) {
  std::vector<Spec> out = {Spec::parse("admm{iterations=20000,tolerance=1e-13,proximal=1e-6}"),
                           Spec::parse("proximal_newton{tolerance=1e-13,passes=1000,iterations=100000}")};
  if (dimension == 2) out.push_back(Spec::parse("direct_lcp{cfm=0}"));  // in 3D its friction law is that of facets
  return out;
}

/// One stage by name, with registered methods, as a worker runs it. Broadphases ignore the kinds. Throws UserError for
/// unknown names. A failure that is kept is run again, alone and from its text. When it does not fail again, its name
/// gets `_once`, and its case says "again": false.
struct VerifyTask {
  StageKind stage = StageKind::pairQuery;
  int dimension = 3;
  ShapeKind kindA = ShapeKind::sphere, kindB = ShapeKind::sphere;
  VerifyRange range = {};
  std::vector<std::string> methods = {};  // specs, such as gjk_epa{tolerance=1e-10}
  bool relations = false;                 // for pair queries: run verifyRelations instead
};
Verified verify(const VerifyTask& task);

}}  // namespace lpc::LPC_PRECISION
