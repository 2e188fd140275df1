// SPDX-License-Identifier: Zlib
#include "experiments/film/falls.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <tuple>

#include "experiments/film/reel.h"
#include "experiments/film/temporary_recording.h"
#include "experiments/runner/worker_pool.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using nlohmann::json;

constexpr std::size_t kMostFalls = 6, kMomentsOfFall = 5;
// Limits of a page for one strip, and of a disk for one recording.
constexpr double kMostBodies = 300, kMostPoses = 1e6;
constexpr double kWidth = 320;  // px, of one picture

struct Fall {
  const PlannedTrial* trial;
  std::string outcome;
  double step;
};

// In the order of the sweep.
std::vector<Fall> lastFalls(const PlannedSweep& sweep, Store& store) {
  static const std::set<std::string> kFalls = {"diverged", "exploded", "collapsed"};
  std::map<std::tuple<std::string, int, std::string>, std::size_t> at;  // scene, dimension, outcome
  std::vector<Fall> out;
  for (const PlannedTrial& t : sweep.trials) {
    if (!t.unsupported.empty() || (t.timed() && t.asked().repeat > 0)) continue;
    const auto row = store.measured(t.key);
    if (!row || !kFalls.contains(row->outcome)) continue;
    const auto steps = row->metrics.find("steps_done"), bodies = row->metrics.find("bodies");
    if (steps == row->metrics.end() || bodies == row->metrics.end()) continue;
    // A run that failed at its last step because of creep looks unchanged there.
    if (row->outcome == "collapsed" && steps->second >= static_cast<double>(t.world().steps)) continue;
    if (bodies->second > kMostBodies || bodies->second * steps->second > kMostPoses) continue;
    const auto [place, isNew] = at.try_emplace({t.world().scene, t.asked().dimension, row->outcome}, out.size());
    if (isNew) {
      out.push_back({&t, row->outcome, steps->second});
    } else if (steps->second > out[place->second].step) {
      out[place->second] = {&t, row->outcome, steps->second};
    }
  }
  if (out.size() > kMostFalls) out.resize(kMostFalls);
  return out;
}

template <int D>
using Places = std::map<std::pair<std::int32_t, std::uint32_t>, Vec<D>>;  // slot, generation

// A body with a pose that is not finite has no position.
template <int D>
Places<D> placesOf(const typename Recording<D>::Frame& frame) {
  Places<D> out;
  for (const auto& body : frame.bodies) {
    if (body.X_WC.p.allFinite()) out.try_emplace({body.slot, body.generation}, body.X_WC.p);
  }
  return out;
}

// m, of the body that is farthest from its position in the other frame.
template <int D>
double apart(const Places<D>& a, const Places<D>& b) {
  double out = 0;
  for (const auto& [key, p] : a) {
    if (const auto other = b.find(key); other != b.end()) out = std::max(out, double((p - other->second).norm()));
  }
  return out;
}

// Frames that show a fall: the start, the fall, and in between the last frames in which a body was still 60, 30 and 10
// % of the largest distance from its final position. A tower that stood for long is thus drawn while it leans. If the
// end is out of sight (a body moved by more than the size of the scene, or is not finite), the last frame in sight
// counts instead, and is drawn, too.
template <int D>
std::set<std::size_t> momentsOf(const std::vector<typename Recording<D>::Frame>& frames) {
  std::vector<Places<D>> places;
  for (const auto& frame : frames) places.push_back(placesOf<D>(frame));
  double size = 1;  // m
  for (const auto& [key, p] : places[0]) {
    for (const auto& [other, q] : places[0]) size = std::max(size, double((p - q).norm()));
  }
  const std::size_t last = frames.size() - 1;
  std::size_t seen = last;
  while (seen > 0 && (places[seen].size() < frames[seen].bodies.size() || apart<D>(places[0], places[seen]) > size))
    --seen;
  std::vector<double> ways;
  for (std::size_t i = 0; i <= seen; ++i) ways.push_back(apart<D>(places[i], places[seen]));
  const double farthest = *std::max_element(ways.begin(), ways.end());
  std::set<std::size_t> out = {0, seen, last};
  for (const double share : {0.6, 0.3, 0.1}) {
    std::size_t i = seen;
    while (i > 0 && ways[i] < share * farthest) --i;
    if (out.size() < kMomentsOfFall) out.insert(i);
  }
  while (out.size() < std::min(kMomentsOfFall, frames.size())) {  // two are equal: half way in the longest gap instead
    std::size_t longest = 0, middle = 0;
    for (auto a = out.begin(), b = std::next(a); b != out.end(); ++a, ++b) {
      if (*b - *a > longest) longest = *b - *a, middle = (*a + *b) / 2;
    }
    out.insert(middle);
  }
  return out;
}

// As [x, y, x, y, ...] in tenths of a pixel; empty outside the picture, as most bodies of an explosion are.
template <int D>
json cornersOf(const Patch& patch, const Camera<D>& camera) {
  Vec<2> lo = patch.corners[0], hi = lo;
  json out = json::array();
  for (const Vec<2>& c : patch.corners) {
    if (!c.allFinite()) return nullptr;
    lo = lo.cwiseMin(c), hi = hi.cwiseMax(c);
    out.push_back(std::round(10 * c[0]) / 10), out.push_back(std::round(10 * c[1]) / 10);
  }
  const bool seen = hi[0] >= 0 && lo[0] <= camera.width && hi[1] >= camera.kBand && lo[1] <= camera.height;
  return seen ? out : json();
}

template <int D>
json stripOf(const std::string& recording) {
  const Reel<D> reel(recording);
  Viewport all;
  for (const Viewport& view : reel.views(0)) all.take(view);
  const Camera<D> camera = cameraOf<D>(all, kWidth);
  json pictures = json::array();
  for (const std::size_t i : momentsOf<D>(reel.frames())) {
    json patches = json::array();
    for (const Patch& p : reel.picture(i, camera).patches) {
      const json corners = cornersOf(p, camera);
      if (!corners.is_null()) patches.push_back({colourText(p.fill), colourText(p.edge), corners});
    }
    pictures.push_back({{"step", reel.frames()[i].step}, {"time", reel.frames()[i].time}, {"patches", patches}});
  }
  return {{"width", camera.width}, {"top", camera.kBand}, {"height", camera.height}, {"pictures", pictures}};
}

// Why the recorded run is not the one that fell; empty if it is.
std::string otherwise(const WorkerEnd& end, const Fall& fall) {
  if (end.outcome != "ok") return end.outcome + ", " + end.reason;
  try {
    const json again = json::parse(end.output);
    if (again.at("outcome") == fall.outcome && again.at("step").get<double>() == fall.step) return "";
    return again.at("outcome").get<std::string>() + " at step " + again.at("step").dump();
  } catch (const json::exception&) {
    return "crash, the worker's result is unreadable";
  }
}

}  // namespace

bool filmFalls(const PlannedSweep& sweep, Store& store, const RunOptions& options) {
  if (sweep.kind != "world") return true;
  const InterruptGuard interrupts;
  std::optional<TemporaryRecording> place;
  WorkerPool pool(options.plugins);
  for (const Fall& fall : lastFalls(sweep, store)) {
    const PlannedTrial& t = *fall.trial;
    if (store.hasFilm(t.key)) continue;
    if (!place) place.emplace();
    const std::string recording = place->path();
    TrialRequest request = t.request;
    request.record = recording;
    pool.start(0, request, {sweep.wallLimit, sweep.memoryLimit * 1073741824.0}, -1);
    std::vector<WorkerEnd> ends;
    while (ends.empty() && !InterruptGuard::interrupted()) ends = pool.ended();
    if (ends.empty()) return false;
    if (const std::string what = otherwise(ends[0], fall); !what.empty()) {
      std::fprintf(stderr, "lpc: sweep %s: a run of %s that %s at step %.0f is %s when repeated: not drawn\n",
                   sweep.name.c_str(), t.world().scene.c_str(), fall.outcome.c_str(), fall.step, what.c_str());
      continue;
    }
    const bool flat = t.asked().dimension == 2;
    store.putFilm(t.key, (flat ? stripOf<2>(recording) : stripOf<3>(recording)).dump());
  }
  return true;
}

}}  // namespace lpc::LPC_PRECISION
