// SPDX-License-Identifier: Zlib
#include "experiments/film/film.h"

#include <algorithm>
#include <cstdio>
#include <fstream>

#include "experiments/film/film_file.h"
#include "experiments/film/reel.h"
#include "framework/check.h"

namespace lpc::inline LPC_PRECISION {
namespace {

constexpr double kStripWidth = 320, kFilmWidth = 720;  // px, of one picture
constexpr Colour kDivider{120, 120, 115};

int dimensionOf(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw UserError(path + ": cannot be read");
  try {
    return recordingDimension(in);
  } catch (const UserError& e) {
    throw UserError(path + ": " + e.what());
  }
}

double widthOf(FilmKind kind) { return kind == FilmKind::strip ? kStripWidth : kFilmWidth; }

// `count` of the frames from `first` on, evenly, with both ends.
std::vector<std::size_t> moments(std::size_t first, std::size_t frames, std::size_t count) {
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < count; ++i) {
    out.push_back(count > 1 ? first + i * (frames - first - 1) / (count - 1) : first);
  }
  return out;
}

template <int D>
void film(const std::string& path, const std::string& out) {
  const FilmKind kind = filmKind(out);
  const Reel<D> reel(path);
  const Camera<D> camera = reel.camera(widthOf(kind));
  std::vector<Picture> pictures;
  for (const std::size_t i : moments(0, reel.frames().size(), filmLength(kind, reel.frames().size()))) {
    pictures.push_back(reel.picture(i, camera));
  }
  writeFilm(out, pictures, reel.frames().back().time - reel.frames().front().time);
}

// Seen by one camera: what differs is the runs. Each is as large as in a film of its own.
template <int D>
void filmBoth(const Reel<D>& a, const Reel<D>& b, std::size_t first, const std::string& out) {
  const FilmKind kind = filmKind(out);
  const std::size_t frames = std::max(a.frames().size(), b.frames().size());
  const Camera<D> camera = a.camera(widthOf(kind));
  const double end = camera.width;
  std::vector<Picture> pictures;
  for (const std::size_t i : moments(first, frames, filmLength(kind, frames - first))) {
    Picture both{2 * end, camera.height, {}, {}};
    both.add(a.picture(std::min(i, a.frames().size() - 1), camera), {0, 0});
    both.add(b.picture(std::min(i, b.frames().size() - 1), camera), {end, 0});
    both.patches.push_back({{{end, 0}, {end, camera.height}}, kDivider, kDivider});
    pictures.push_back(std::move(both));
  }
  writeFilm(out, pictures, a.frames().back().time - a.frames()[std::min(first, a.frames().size() - 1)].time);
}

template <int D>
std::string describe(const std::string& path) {
  const Reel<D> reel(path);
  const auto& last = reel.frames().back();
  char text[160];
  std::snprintf(text, sizeof text, ": %dD, steps %lld to %lld (%.4g s), %zu bodies at the end%s", D,
                static_cast<long long>(reel.frames().front().step), static_cast<long long>(last.step), last.time,
                last.bodies.size(), reel.torn() ? "; the last frame is cut short and left out" : "");
  return path + text;
}

template <int D>
std::string compare(const std::string& pathA, const std::string& pathB, double tolerance, const std::string& out) {
  if (!out.empty()) filmKind(out);
  const Reel<D> a(pathA), b(pathB);
  const auto parting = partingOf(a, b, tolerance);
  if (!out.empty()) filmBoth(a, b, parting && parting->frame > 0 ? parting->frame - 1 : 0, out);
  if (!parting) return "the runs never part: " + std::to_string(a.frames().size()) + " frames are the same";
  return "the runs part at step " + std::to_string(parting->step) + ": " + parting->how;
}

}  // namespace

void filmRecording(const std::string& recording, const std::string& out) {
  dimensionOf(recording) == 2 ? film<2>(recording, out) : film<3>(recording, out);
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

}  // namespace lpc::inline LPC_PRECISION
