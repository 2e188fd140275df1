// SPDX-License-Identifier: Zlib
#include "experiments/film/film_file.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <ostream>

#include "experiments/film/raster.h"
#include "experiments/trial/output_file.h"

namespace lpc::inline LPC_PRECISION {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMoments = 8, kMostMoving = 120, kMostFrames = 600;

void putPatches(std::ostream& out, const Picture& picture) {
  for (const Patch& p : picture.patches) {
    out << "<path d=\"";
    char text[40];
    for (std::size_t i = 0; i < p.corners.size(); ++i) {
      std::snprintf(text, sizeof text, "%c%.1f %.1f", i ? 'L' : 'M', p.corners[i][0], p.corners[i][1]);
      out << text;
    }
    out << "Z\" fill=\"" << colourText(p.fill) << "\" stroke=\"" << colourText(p.edge) << "\"/>\n";
  }
  for (const Label& l : picture.labels) {
    out << "<text x=\"" << l.at[0] << "\" y=\"" << l.at[1] << "\">" << l.text << "</text>\n";
  }
}

void putHead(std::ostream& out, double width, double height) {
  out << "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" << width << "\" height=\"" << height
      << "\" viewBox=\"0 0 " << width << " " << height
      << "\" font-family=\"sans-serif\" font-size=\"12\" stroke-linejoin=\"round\">\n"
      << "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n";
}

// As many in a row as a screen is wide; each picture is an <svg> of its own, so that nothing of it covers its
// neighbour.
void putStrip(std::ostream& out, const std::vector<Picture>& pictures) {
  constexpr double kScreen = 1280, kGap = 6;  // px
  const double width = pictures[0].width + kGap, height = pictures[0].height + kGap;
  const auto fitting = std::max<std::size_t>(1, static_cast<std::size_t>(kScreen / pictures[0].width));
  const std::size_t columns = std::min(fitting, pictures.size()), rows = (pictures.size() + columns - 1) / columns;
  putHead(out, static_cast<double>(columns) * width + kGap, static_cast<double>(rows) * height + kGap);
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const Picture& p = pictures[i];
    out << "<svg x=\"" << kGap + static_cast<double>(i % columns) * width << "\" y=\""
        << kGap + static_cast<double>(i / columns) * height << "\" width=\"" << p.width << "\" height=\"" << p.height
        << "\">\n<rect width=\"100%\" height=\"100%\" fill=\"#f7f7f5\"/>\n";
    putPatches(out, p);
    out << "</svg>\n";
  }
  out << "</svg>\n";
}

// Every picture is there and hidden but for its turn.
void putAnimated(std::ostream& out, const std::vector<Picture>& pictures, double seconds) {
  const double share = 100.0 / static_cast<double>(pictures.size());
  putHead(out, pictures[0].width, pictures[0].height);
  out << "<style>@keyframes turn { 0% { visibility: visible } " << share
      << "% { visibility: hidden } 100% { visibility: "
      << "hidden } } g { visibility: hidden; animation: turn " << seconds << "s step-end infinite }</style>\n";
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    out << "<g style=\"animation-delay: " << seconds * static_cast<double>(i) / static_cast<double>(pictures.size())
        << "s\">\n";
    putPatches(out, pictures[i]);
    out << "</g>\n";
  }
  out << "</svg>\n";
}

void writeFrames(const std::string& path, const std::vector<Picture>& pictures) {
  const fs::path folder = fs::path(path).has_filename() ? fs::path(path) : fs::path(path).parent_path();
  const fs::path partial = folder.string() + ".partial";
  std::error_code error;
  fs::remove_all(partial, error);
  fs::create_directory(partial, error);
  if (error) throw CannotWrite(path + ": cannot be written: " + error.message());
  try {
    for (std::size_t i = 0; i < pictures.size(); ++i) {
      char name[32];
      std::snprintf(name, sizeof name, "%05zu.png", i);
      writePng((partial / name).string(), pictures[i]);
    }
  } catch (...) {
    fs::remove_all(partial, error);
    throw;
  }
  fs::rename(partial, folder, error);
  if (!error) return;
  fs::remove_all(partial, error);
  throw CannotWrite(path + ": is there and not empty; valid: a new or an empty folder");
}

}  // namespace

FilmKind filmKind(const std::string& path) {
  std::error_code ignored;
  if (path.ends_with('/') || fs::is_directory(path, ignored)) {
    if (fs::exists(path, ignored) && !fs::is_empty(path, ignored)) {
      throw UserError(path + ": is there and not empty; valid: a new or an empty folder");
    }
    return FilmKind::frames;
  }
  if (!path.ends_with(".svg")) {
    throw UserError(path +
                    ": what film it shall be is not known; valid: NAME.svg, which moves, NAME.strip.svg, or a folder "
                    "NAME/ for PNG files");
  }
  const OutputFile probe(path);  // throws what is wrong with the place
  return path.ends_with(".strip.svg") ? FilmKind::strip : FilmKind::animated;
}

std::size_t filmLength(FilmKind kind, std::size_t frames) {
  switch (kind) {
    case FilmKind::strip:
      return std::min(frames, kMoments);
    case FilmKind::animated:
      return std::min(frames, kMostMoving);
    case FilmKind::frames:
      return std::min(frames, kMostFrames);
  }
  return 0;
}

void writeFilm(const std::string& path, const std::vector<Picture>& pictures, double seconds) {
  const FilmKind kind = filmKind(path);
  if (kind == FilmKind::frames) return writeFrames(path, pictures);
  OutputFile out(path);
  if (kind == FilmKind::strip) {
    putStrip(out.stream(), pictures);
  } else {
    putAnimated(out.stream(), pictures, std::max(0.1, seconds));
  }
  out.finish();
}

}  // namespace lpc::inline LPC_PRECISION
