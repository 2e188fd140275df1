// SPDX-License-Identifier: Zlib
#include "experiments/film/film.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <optional>

#include "experiments/film/film_file.h"
#include "experiments/film/reel.h"
#include "experiments/runner/worker_pool.h"
#include "framework/math/check.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

constexpr double kStripWidth = 320, kFilmWidth = 720;  // px, of one picture
constexpr DrawColour kDivider{120, 120, 115};

int dimensionOf(const std::string& path) {
  std::error_code absent;  // a pipe would block, and be empty when it is read again
  if (std::filesystem::exists(path, absent) && !std::filesystem::is_regular_file(path, absent)) {
    throw UserError(path + ": not a recording: it is not a regular file");
  }
  std::ifstream in(path, std::ios::binary);
  if (!in) throw UserError(path + ": cannot be read: " + std::strerror(errno));
  try {
    return recordingDimension(in);
  } catch (const UserError& e) {
    throw UserError(path + ": " + e.what());
  }
}

double widthOf(FilmKind kind) { return kind == FilmKind::strip ? kStripWidth : kFilmWidth; }

// `count` evenly spaced frames from `first` on, with both ends.
std::vector<std::size_t> moments(std::size_t first, std::size_t frames, std::size_t count) {
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < count; ++i) {
    out.push_back(count > 1 ? first + i * (frames - first - 1) / (count - 1) : first);
  }
  return out;
}

// Films frames `first` to `frames` and says how many of them are shown: a film may omit some.
std::string filmed(const std::string& out, std::size_t first, std::size_t frames, double seconds, FilmKind kind,
                   const std::function<Picture(std::size_t)>& picture) {
  const std::vector<std::size_t> shown = moments(first, frames, filmLength(kind, frames - first));
  writeFilm(out, kind, {shown.size(), seconds, [&](std::size_t i) {
                          if (InterruptGuard::interrupted()) throw Interrupted();
                          return picture(shown[i]);
                        }});
  return "film      " + out + ": " + std::to_string(shown.size()) + " of " + std::to_string(frames - first) +
         " frames" + (kind == FilmKind::frames ? ", without step numbers and times" : "");
}

// Duration from frame `first` on (s). A cleared world starts at 0 again.
double secondsOf(const auto& frames, std::size_t first) {
  double seconds = frames.back().time - frames[first].time;
  for (std::size_t i = first + 1; i < frames.size(); ++i) {
    if (frames[i].time < frames[i - 1].time) seconds += frames[i - 1].time;
  }
  return seconds;
}

template <int D>
std::string film(const std::string& path, const std::string& out) {
  const FilmKind kind = filmKind(out);
  const Reel<D> reel(path);
  const auto& frames = reel.frames();
  const std::vector<Camera<D>> cameras = camerasOf<D>(reel.views(), widthOf(kind));
  return filmed(out, 0, frames.size(), secondsOf(frames, 0), kind,
                [&](std::size_t i) { return reel.picture(i, cameras[i]); });
}

// Each camera sees both runs, so only the runs differ. The run that ends first keeps its last frame.
template <int D>
std::string filmBoth(const Reel<D>& a, const Reel<D>& b, std::size_t first, FilmKind kind, const std::string& out) {
  const auto& longer = (a.frames().size() < b.frames().size() ? b : a).frames();
  const std::vector<Viewport> left = a.views(), right = b.views();
  std::vector<Viewport> views;
  for (std::size_t i = 0; i < longer.size(); ++i) {
    views.push_back(left[std::min(i, left.size() - 1)]);
    views.back().take(right[std::min(i, right.size() - 1)]);
  }
  const std::vector<Camera<D>> cameras = camerasOf<D>(views, widthOf(kind));
  return filmed(out, first, longer.size(), secondsOf(longer, first), kind, [&](std::size_t i) {
    const Camera<D>& camera = cameras[i];
    const double end = camera.width;
    Picture both{2 * end, camera.height, {}, {}};
    both.add(a.picture(std::min(i, a.frames().size() - 1), camera), {0, 0});
    both.add(b.picture(std::min(i, b.frames().size() - 1), camera), {end, 0});
    both.patches.push_back({{{end, 0}, {end, camera.height}}, kDivider, kDivider});
    return both;
  });
}

template <int D>
std::string describe(const std::string& path) {
  const Reel<D> reel(path);
  const auto& last = reel.frames().back();
  char text[160];
  std::snprintf(text, sizeof text, ": %dD, steps %lld to %lld (%.4g s), %zu bodies at the end%s", D,
                static_cast<long long>(reel.frames().front().step), static_cast<long long>(last.step), last.time,
                last.bodies.size(), reel.torn() ? "; the last frame is incomplete and left out" : "");
  return path + text;
}

template <int D>
std::string compare(const std::string& pathA, const std::string& pathB, double tolerance, const std::string& out) {
  std::optional<FilmKind> kind;
  if (!out.empty()) kind = filmKind(out);
  const Reel<D> a(pathA), b(pathB);
  const auto divergence = divergenceOf(a, b, tolerance);
  std::string text;
  if (divergence) {
    text = "the runs diverge at step " + std::to_string(divergence->step) + ": " + divergence->how;
  } else {
    char within[48];
    std::snprintf(within, sizeof within, " frames are within %.6g m and rad", tolerance);
    text = "the runs do not diverge: " + std::to_string(a.frames().size()) + within;
  }
  const std::size_t before = divergence && divergence->frame > 0 ? divergence->frame - 1 : 0;
  return kind ? text + "\n" + filmBoth(a, b, before, *kind, out) : text;
}

}  // namespace

std::string filmRecording(const std::string& recording, const std::string& out) {
  return dimensionOf(recording) == 2 ? film<2>(recording, out) : film<3>(recording, out);
}

std::string describeRecording(const std::string& recording) {
  return dimensionOf(recording) == 2 ? describe<2>(recording) : describe<3>(recording);
}

std::string compareRecordings(const std::string& a, const std::string& b, double tolerance, const std::string& out) {
  const int dimension = dimensionOf(a), other = dimensionOf(b);
  if (dimension != other) {
    throw UserError(b + ": the recording is " + std::to_string(other) + "D; valid: " + std::to_string(dimension) +
                    "D, as " + a);
  }
  return dimension == 2 ? compare<2>(a, b, tolerance, out) : compare<3>(a, b, tolerance, out);
}

}}  // namespace lpc::LPC_PRECISION
