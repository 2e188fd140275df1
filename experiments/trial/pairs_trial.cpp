// SPDX-License-Identifier: Zlib
// A pair query alone: every method gets the same pairs, drawn or recorded from a world; measures time per query, and
// the error against the referee.
#include <xxhash.h>

#include <algorithm>
#include <cstdio>

#include "experiments/trial/measure/pairs_metrics.h"
#include "experiments/trial/pair_drawing.h"
#include "experiments/trial/scene/scene_file.h"
#include "experiments/trial/stream_replay.h"
#include "experiments/trial/trial.h"
#include "framework/stage/stage_narrowphase.h"
#include "oracles/verify/verify.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

template <int D>
PairView<D> viewOf(const DrawnPair<D>& pair) {
  return {pair.a.view(), pair.b.view(), pair.X_AB};
}

bool endedWithoutAnswer(Tally end) {
  return end == Tally::notFinite || end == Tally::threw || end == Tally::crashed || end == Tally::hung;
}

/// A method and the observations of its answers.
template <int D>
class Examination {
 public:
  Examination(const std::string& pairQuery, bool timed)
      : m_spec(Spec::parse(pairQuery)), m_method(createStage<PairQuery<D>>(m_spec)) {
    m_role = Registry::instance().find(StageKind::pairQuery, D, m_spec.name).info.role;
    m_witness = dynamic_cast<const Witness<D>*>(m_method.get());
    seen.timed = timed;
    XXH64_reset(m_hash, 0);
  }
  ~Examination() { XXH64_freeState(m_hash); }
  Examination(const Examination&) = delete;
  Examination& operator=(const Examination&) = delete;

  PairQuery<D>& method() { return *m_method; }
  const Witness<D>* witness() const { return m_witness; }
  int repeats() const { return seen.timed && !m_witness ? 8 : 1; }  // the first one warms the caches

  /// `ask()` runs `count` queries once; `told()` returns the nanoseconds that a witness needed.
  template <class Ask, class Told>
  void time(std::size_t count, const Ask& ask, const Told& told) {
    for (int r = 0; r < repeats(); ++r) {
      const double before = cpuSeconds();
      ask();
      // A witness runs in a process of its own, which this thread's clock does not see: it reports its own time.
      const double spent = m_witness ? told() : 1e9 * (cpuSeconds() - before);
      seen.queries += static_cast<double>(count);
      if (r > 0 || m_witness) seen.nanoseconds.push_back(spent / static_cast<double>(count));
    }
  }
  /// A witness is always queried one by one.
  void timeSingles(std::span<const PairView<D>> pairs, std::span<PairAnswer<D>> answers) {
    if (!seen.timed) return;
    const auto count = static_cast<double>(pairs.size());
    if (m_witness) return seen.singles.push_back(static_cast<double>(m_witness->nanoseconds()) / count);
    for (int r = 0; r + 1 < repeats(); ++r) seen.singles.push_back(timeOneByOne<D>(*m_method, pairs, answers) / count);
  }
  void judgeOne(const PairView<D>& pair, const PairAnswer<D>& answer, Ending ending) {
    ++seen.asked;
    XXH64_update(m_hash, &answer.distance, sizeof answer.distance);
    const Verdict verdict = judge(pair, pairTruth(pair), answer, m_role, ending, verifyTolerance(m_witness),
                                  m_method->claimsGap(pair.a.kind, pair.b.kind));
    if (verdict.error) seen.errors.push_back(*verdict.error);
    seen.wrong += verdict.end == Tally::wrong;
    seen.wrongSide += verdict.wrongSide;
    seen.sideAlone += verdict.sideAlone;
    seen.refused += verdict.end == Tally::refused;
    seen.failed += endedWithoutAnswer(verdict.end);
  }
  TrialResult result() {
    TrialResult out;
    if (!m_witness) seen.work = work;
    char text[20];
    std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(XXH64_digest(m_hash)));
    out.hash = text;
    measure<PairsSeen>(
        pairsMetrics(), seen, [&](TrialNeed need) { return need != TrialNeed::timing || seen.timed; }, out.metrics);
    // A library may fail on some inputs, which is counted; a method of ours, or a library on all of them, is wrong.
    const bool ours = m_role == AlgorithmRole::competitor;
    const double silent = seen.failed + (ours ? seen.refused : 0);
    const bool fails = silent > 0 && (ours || silent == seen.asked);
    if (seen.wrong > 0 || fails) {
      std::string reason = std::to_string(static_cast<long>(seen.wrong)) + " wrong answers";
      if (fails) {
        reason += ", " + std::to_string(static_cast<long>(silent)) + " of " +
                  std::to_string(static_cast<long>(seen.asked)) + " without a finite answer";
      }
      out.fail("wrong", reason, 0);
    }
    return out;
  }

  PairsSeen seen;
  WorkDone work;

 private:
  Spec m_spec;
  std::unique_ptr<PairQuery<D>> m_method;
  AlgorithmRole m_role;
  const Witness<D>* m_witness;
  XXH64_state_t* m_hash = XXH64_createState();
};

TrialResult unsupported(const std::string& reason) {
  TrialResult out;
  out.fail("unsupported", reason, 0);
  return out;
}

template <int D>
bool sameKinds(const PairView<D>& p, const PairView<D>& q) {
  return p.a.kind == q.a.kind && p.b.kind == q.b.kind;
}

/// Pairs of the same kinds are consecutive: a method gets one pair of kinds at a time.
template <int D>
void examine(Examination<D>& of, const std::vector<DrawnPair<D>>& pairs) {
  constexpr std::size_t kAtOnce = 1024;  // between two reads of the clock
  std::vector<PairView<D>> views;
  std::vector<PairAnswer<D>> answers;
  for (std::size_t begin = 0; begin < pairs.size(); begin += views.size()) {
    views.clear();
    for (std::size_t i = begin; i < std::min(pairs.size(), begin + kAtOnce); ++i) {
      const PairView<D> view = viewOf(pairs[i]);
      if (!views.empty() && !sameKinds(view, views.front())) break;
      views.push_back(view);
    }
    answers.assign(views.size(), {});
    of.time(
        views.size(), [&] { of.method().query(views, QueryNeed::closestPoints, answers, {}, of.work); },
        [&] { return static_cast<double>(of.witness()->nanoseconds()); });
    of.timeSingles(views, answers);
    for (std::size_t i = 0; i < views.size(); ++i) {
      of.judgeOne(views[i], answers[i], of.witness() ? of.witness()->endings()[i] : Ending::answered);
    }
  }
}

template <int D>
double trueDistance(const DrawnPair<D>& pair) {
  return referee<D>(pair.a.view(), {}, pair.b.view(), pair.X_AB).interval().middle();
}

template <int D>
TrialResult runPairs(const PairsRequest& asked) {
  const ShapeKind kindA = shapeKindFromName(asked.kindA), kindB = shapeKindFromName(asked.kindB);
  Examination<D> examination(asked.pairQuery, asked.timed);
  if (!examination.method().supports(kindA, kindB) || !kindExists(kindA, D) || !kindExists(kindB, D)) {
    return unsupported(asked.kindA + " against " + asked.kindB);
  }
  Random random(asked.seed);
  const Spec way = Spec::parse(asked.drawing);
  std::vector<DrawnPair<D>> pairs;
  for (int i = 0; i < asked.n; ++i) {
    pairs.push_back(drawPair<D>(way, {kindA, kindB, i, trueDistance<D>, asked.vertices}, random));
  }
  examine(examination, pairs);
  return examination.result();
}

template <int D>
int verticesOf(const ShapeView<D>& shape) {
  return shape.hull ? static_cast<int>(shape.hull->vertices.size()) : 0;
}

constexpr std::size_t kMostPairPoses = 300000;
constexpr std::size_t kJudged = 2000;  // largest number, of a stream: the referee takes longer than all methods

/// The pairs of a world, or drawn ones of the same kinds in the same numbers as the judged ones (one in `every`), each
/// alone.
template <int D>
TrialResult runStream(const StreamRequest& asked, const SceneFile& file) {
  const StreamReplay<D> replay(
      recordStream<D>(file.name(), file.build<D>(asked.params, asked.seed), asked.from, asked.steps, kMostPairPoses));
  Examination<D> examination(asked.pairQuery, asked.timed);
  PairQuery<D>& method = examination.method();
  if (replay.views.empty()) return unsupported("no boxes come near each other in these steps");
  for (const auto& batch : replay.batches) {
    const ShapeKind a = replay.views[batch.begin].a.kind, b = replay.views[batch.begin].b.kind;
    if (method.supports(a, b)) continue;
    return unsupported(std::string(shapeKindName(a)) + " against " + std::string(shapeKindName(b)));
  }
  if (asked.stream == "warm" && !method.remembers()) return unsupported("the method caches nothing between queries");
  const std::size_t every = (replay.views.size() + kJudged - 1) / kJudged;
  if (asked.stream == "drawn") {
    Random random(asked.seed);
    const Spec way = Spec::parse(asked.drawing);
    std::vector<DrawnPair<D>> pairs;
    for (std::size_t i = 0; i < replay.views.size(); i += every) {
      const PairView<D>& like = replay.views[i];
      const int vertices = std::max(verticesOf(like.a), verticesOf(like.b));
      pairs.push_back(drawPair<D>(
          way, {like.a.kind, like.b.kind, static_cast<int>(pairs.size()), trueDistance<D>, vertices}, random));
    }
    std::stable_sort(pairs.begin(), pairs.end(), [](const DrawnPair<D>& p, const DrawnPair<D>& q) {
      return std::pair(p.a.kind(), p.b.kind()) < std::pair(q.a.kind(), q.b.kind());
    });
    examine(examination, pairs);
    return examination.result();
  }
  std::vector<PairAnswer<D>> answers(replay.views.size());
  std::vector<Ending> endings(replay.views.size(), Ending::answered);
  const Witness<D>* witness = examination.witness();
  double told = 0;
  examination.time(
      replay.views.size(),
      [&] {
        askStream<D>(method, replay, asked.stream == "warm", answers, examination.work, [&](const auto& batch) {
          if (!witness) return;
          told += static_cast<double>(witness->nanoseconds());
          for (std::size_t i = 0; i < batch.count; ++i) endings[batch.begin + i] = witness->endings()[i];
        });
      },
      [&] { return told; });
  for (std::size_t i = 0; i < replay.views.size(); i += every) {
    examination.judgeOne(replay.views[i], answers[i], endings[i]);
  }
  return examination.result();
}

}  // namespace

TrialResult runPairsTrial(const PairsRequest& asked) {
  return asked.dimension == 2 ? runPairs<2>(asked) : runPairs<3>(asked);
}

TrialResult runStreamTrial(const StreamRequest& asked, const std::string& sceneFile) {
  const SceneFile file = SceneFile::load(sceneFile);
  return asked.dimension == 2 ? runStream<2>(asked, file) : runStream<3>(asked, file);
}

}}  // namespace lpc::LPC_PRECISION
