// SPDX-License-Identifier: Zlib
// Replays a stream of pairs as a world queries it: in each step by pair of kinds, with the cache of each pair.
#pragma once

#include <algorithm>

#include "experiments/trial/formats/pair_stream.h"
#include "framework/scene/director.h"
#include "framework/world/world.h"

namespace lpc { inline namespace LPC_PRECISION {

/// The pairs of steps [from, from + steps) of a scene, in a world with the default pipeline; of fewer steps if there
/// would be more than `most` entries.
template <int D>
PairStream<D> recordStream(const std::string& name, SceneSpec<D> scene, long from, long steps, std::size_t most) {
  Director<D> director(std::move(scene));
  const Real dt = director.scene().dt;
  World<D> world(Pipeline{}, director.scene().settings);
  PairCollector<D> collector(name, dt, world.settings().margin);
  for (long step = 0; step < from + steps; ++step) {
    director.advance(world);
    if (step >= from && !collector.see(world, step, most)) break;
    world.step(dt);
  }
  return collector.stream();
}

/// The views of a stream in the order of a contact generator.
template <int D>
struct StreamReplay {
  struct Batch {
    std::size_t begin, count;
    long step;
  };
  PairStream<D> stream;
  std::vector<PairView<D>> views;
  std::vector<std::uint32_t> pairs;  // index of each view's pair
  std::vector<Batch> batches;        // of one step and two kinds

  explicit StreamReplay(PairStream<D> recorded) : stream(std::move(recorded)) {
    auto begin = stream.pairPoses.begin();
    const auto kindsOf = [&](const typename PairStream<D>::PairPose& m) {
      const PairView<D> v = stream.view(m);
      return std::pair(v.a.kind, v.b.kind);
    };
    for (const auto& step : stream.steps) {
      const auto end = begin + static_cast<std::ptrdiff_t>(step.pairPoses);
      std::stable_sort(begin, end, [&](const auto& p, const auto& q) { return kindsOf(p) < kindsOf(q); });
      for (auto m = begin; m != end; ++m) {
        if (m == begin || kindsOf(*m) != kindsOf(*(m - 1))) batches.push_back({views.size(), 0, step.step});
        ++batches.back().count;
        views.push_back(stream.view(*m)), pairs.push_back(m->pair);
      }
      begin = end;
    }
  }
  // Views point into the stream.
  StreamReplay(const StreamReplay&) = delete;
  StreamReplay& operator=(const StreamReplay&) = delete;
};

/// The cache of each pair, kept while the pair occurs in every step, like a World's records.
class StreamMemories {
 public:
  explicit StreamMemories(std::size_t pairs) : m_of(pairs) {}

  std::span<PairMemory> recall(std::span<const std::uint32_t> pairs, long step) {
    m_batch.clear();
    for (const std::uint32_t p : pairs) m_batch.push_back(m_of[p].step == step - 1 ? m_of[p].memory : PairMemory{});
    return m_batch;
  }
  void keep(std::span<const std::uint32_t> pairs, long step) {
    for (std::size_t k = 0; k < pairs.size(); ++k) m_of[pairs[k]] = {m_batch[k], step};
  }

 private:
  struct Kept {
    PairMemory memory{};
    long step = -2;
  };
  std::vector<Kept> m_of;
  std::vector<PairMemory> m_batch;
};

/// Queries the whole stream once, from the first step; `warm`: with the method's caches. Calls `asked(batch)` after
/// each batch.
template <int D, class Asked>
void askStream(PairQuery<D>& method, const StreamReplay<D>& replay, bool warm, std::span<PairAnswer<D>> answers,
               WorkDone& work, const Asked& asked) {
  StreamMemories memories(replay.stream.pairs.size());
  for (const auto& batch : replay.batches) {
    const std::span pairs = std::span(replay.pairs).subspan(batch.begin, batch.count);
    const std::span<PairMemory> memory = warm ? memories.recall(pairs, batch.step) : std::span<PairMemory>();
    method.query(std::span(replay.views).subspan(batch.begin, batch.count), QueryNeed::closestPoints,
                 answers.subspan(batch.begin, batch.count), memory, work);
    if (warm) memories.keep(pairs, batch.step);
    asked(batch);
  }
}

}}  // namespace lpc::LPC_PRECISION
