// SPDX-License-Identifier: Zlib
#include <time.h>

#include <algorithm>

#include "experiments/bench/bench_groups.h"
#include "experiments/bench/box_frames.h"
#include "experiments/bench/box_peers.h"

namespace lpc { inline namespace LPC_PRECISION { namespace bench {

std::vector<BoxPeerEntry>& boxPeers() {
  static std::vector<BoxPeerEntry> peers;
  return peers;
}

namespace {

constexpr int kSizes[] = {30, 100, 300, 1000, 3000, 10000, 100000};

// Frame: every box has moved, and the method keeps its structure. Scratch: a new structure each time.
enum class Mode { frame, scratch };

/// Times of single operations, which a mean hides: methods with fat boxes work in bursts. Thread time, so that other
/// programs disturb it less.
class Timer {
 public:
  void start() { m_start = now(); }
  void stop(benchmark::State& state) {
    const double seconds = now() - m_start;
    state.SetIterationTime(seconds);
    m_seconds.push_back(seconds);
  }
  void report(benchmark::State& state) {
    std::sort(m_seconds.begin(), m_seconds.end());
    const auto at = [&](double q) { return m_seconds[static_cast<std::size_t>(q * double(m_seconds.size() - 1))]; };
    state.counters["median_us"] = 1e6 * at(0.5);
    state.counters["p99_us"] = 1e6 * at(0.99);
  }

 private:
  static double now() {
    timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
  }
  double m_start = 0;
  std::vector<double> m_seconds;
};

// Missing pairs and false ones; `pairs` arrives unsorted.
template <int D>
void judge(benchmark::State& state, const BoxFrames<D>& frames, std::vector<ProxyPair> pairs) {
  const std::vector<ProxyPair> truth = frames.pairs();
  std::sort(pairs.begin(), pairs.end());
  std::vector<ProxyPair> missing, extra;
  std::set_difference(truth.begin(), truth.end(), pairs.begin(), pairs.end(), std::back_inserter(missing));
  std::set_difference(pairs.begin(), pairs.end(), truth.begin(), truth.end(), std::back_inserter(extra));
  state.counters["pairs"] = static_cast<double>(truth.size());
  state.counters["missing"] = static_cast<double>(missing.size());
  state.counters["extra"] = static_cast<double>(extra.size());
}

template <int D>
void runAlgorithm(benchmark::State& state, const std::string& spec, BoxLayout layout, Mode mode) {
  BoxFrames<D> frames = boxFrames<D>(layout, static_cast<int>(state.range(0)));
  auto broadphase = createStage<Broadphase<D>>(Spec::parse(spec));
  std::vector<ProxyPair> pairs;
  WorkDone work;
  Timer timer;
  broadphase->update(frames.proxies(), {frames.all(), {}, {}});
  broadphase->findPairs(frames.proxies(), pairs, work);
  work = WorkDone{};
  for (auto _ : state) {
    frames.advance();
    pairs.clear();
    if (mode == Mode::scratch) broadphase = createStage<Broadphase<D>>(Spec::parse(spec));
    timer.start();
    if (mode == Mode::scratch) {
      broadphase->update(frames.proxies(), {frames.all(), {}, {}});
    } else {
      broadphase->update(frames.proxies(), {{}, {}, frames.all()});
    }
    broadphase->findPairs(frames.proxies(), pairs, work);
    timer.stop(state);
  }
  timer.report(state);
  report(state, work, static_cast<double>(state.iterations()));
  judge(state, frames, std::move(pairs));
}

template <int D>
void convert(const Proxies<D>& proxies, std::vector<BoxPeer::Box>& boxes) {
  boxes.resize(static_cast<std::size_t>(proxies.size()));
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    boxes[i].lo[2] = 0, boxes[i].hi[2] = 1;
    for (std::size_t d = 0; d < D; ++d) {
      boxes[i].lo[d] = static_cast<double>(proxies.lo[d][i]), boxes[i].hi[d] = static_cast<double>(proxies.hi[d][i]);
    }
  }
}

template <int D>
void runPeer(benchmark::State& state, const BoxPeerEntry& entry, BoxLayout layout, Mode mode) {
  BoxFrames<D> frames = boxFrames<D>(layout, static_cast<int>(state.range(0)));
  std::vector<BoxPeer::Box> boxes;
  convert<D>(frames.proxies(), boxes);
  std::vector<ProxyPair> pairs;
  Timer timer;
  auto peer = entry.create();
  if (mode == Mode::frame) {
    peer->build(boxes);
    peer->frame(boxes, pairs);
  }
  for (auto _ : state) {
    frames.advance();
    convert<D>(frames.proxies(), boxes);
    pairs.clear();
    if (mode == Mode::scratch) peer = entry.create();
    timer.start();
    if (mode == Mode::scratch) peer->build(boxes);
    peer->frame(boxes, pairs);
    timer.stop(state);
  }
  timer.report(state);
  judge(state, frames, std::move(pairs));
}

// A method that tests a large share of all pairs of a small set is not run on a large set.
template <int D>
int mostBoxes(const std::string& spec) {
  constexpr int kProbe = 1000;
  const BoxFrames<D> frames = boxFrames<D>(BoxLayout::uniform, kProbe);
  auto broadphase = createStage<Broadphase<D>>(Spec::parse(spec));
  std::vector<ProxyPair> pairs;
  WorkDone work;
  broadphase->update(frames.proxies(), {frames.all(), {}, {}});
  broadphase->findPairs(frames.proxies(), pairs, work);
  return work[WorkCount::boxTests] > std::uint64_t{kProbe} * kProbe / 5 ? 10000 : 100000;
}

template <int D, class Run>
void add(const std::string& name, int most, Run run) {
  for (BoxLayout layout : {BoxLayout::uniform, BoxLayout::cluster}) {
    for (Mode mode : {Mode::frame, Mode::scratch}) {
      const std::string full = "broadphase/" + std::to_string(D) + "D/" + name + "/" +
                               std::string(kBoxLayouts[static_cast<int>(layout)]) +
                               (mode == Mode::frame ? "/frame" : "/scratch");
      auto* bench = benchmark::RegisterBenchmark(
          full.c_str(), [run, layout, mode](benchmark::State& state) { run(state, layout, mode); });
      for (int size : kSizes) {
        if (size <= most) bench->Arg(size);
      }
      bench->UseManualTime()->Unit(benchmark::kMicrosecond);
    }
  }
}

template <int D>
void addDimension() {
  for (const Registered* algorithm : Registry::instance().list(StageKind::broadphase, D)) {
    for (const std::string& spec : specsOf(*algorithm)) {
      add<D>(spec, mostBoxes<D>(spec), [spec](benchmark::State& state, BoxLayout layout, Mode mode) {
        runAlgorithm<D>(state, spec, layout, mode);
      });
    }
  }
  for (const BoxPeerEntry& peer : boxPeers()) {
    add<D>(peer.name, peer.most,
           [peer](benchmark::State& state, BoxLayout layout, Mode mode) { runPeer<D>(state, peer, layout, mode); });
  }
}

}  // namespace

void addBroadphases() {
  addDimension<2>();
  addDimension<3>();
}

}}}  // namespace lpc::LPC_PRECISION::bench
