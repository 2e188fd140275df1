// SPDX-License-Identifier: Zlib
#include "experiments/film/film_file.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <ostream>

#include "experiments/film/raster.h"
#include "experiments/trial/formats/output_file.h"

namespace lpc { inline namespace LPC_PRECISION {
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
    out << "<text x=\"" << l.at[0] << "\" y=\"" << l.at[1] << "\"";
    if (l.colour != DrawColour{}) out << " fill=\"" << colourText(l.colour) << "\"";
    out << " paint-order=\"stroke\" stroke=\"#f7f7f5\" stroke-width=\"3\">" << l.text << "</text>\n";
  }
}

void putHead(std::ostream& out, double width, double height) {
  // Without the attribute `height` the picture is as wide as the page or the window.
  out << "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"100%\" viewBox=\"0 0 " << width << " " << height
      << "\" font-family=\"sans-serif\" font-size=\"12\" stroke-linejoin=\"round\">\n"
      << "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n";
}

// As many in a row as fit on a screen; each picture is an <svg> of its own, which clips it.
void putStrip(std::ostream& out, const Film& film) {
  constexpr double kScreen = 1280, kGap = 6;  // px
  for (std::size_t i = 0; i < film.length; ++i) {
    const Picture p = film.picture(i);
    const double width = p.width + kGap, height = p.height + kGap;
    const auto fitting = std::max<std::size_t>(1, static_cast<std::size_t>(kScreen / p.width));
    const std::size_t columns = std::min(fitting, film.length), rows = (film.length + columns - 1) / columns;
    if (i == 0) putHead(out, static_cast<double>(columns) * width + kGap, static_cast<double>(rows) * height + kGap);
    out << "<svg x=\"" << kGap + static_cast<double>(i % columns) * width << "\" y=\""
        << kGap + static_cast<double>(i / columns) * height << "\" width=\"" << p.width << "\" height=\"" << p.height
        << "\">\n<rect width=\"100%\" height=\"100%\" fill=\"#f7f7f5\"/>\n";
    putPatches(out, p);
    out << "</svg>\n";
  }
  out << "</svg>\n";
}

// Contains every picture; each is visible only at its time.
void putAnimated(std::ostream& out, const Film& film) {
  const double seconds = std::max(0.1, film.seconds), length = static_cast<double>(film.length);
  for (std::size_t i = 0; i < film.length; ++i) {
    const Picture picture = film.picture(i);
    if (i == 0) {
      putHead(out, picture.width, picture.height);
      out << "<style>@keyframes turn { 0% { visibility: visible } " << 100 / length
          << "% { visibility: hidden } 100% { visibility: "
          << "hidden } } g { visibility: hidden; animation: turn " << seconds << "s step-end infinite }</style>\n";
    }
    out << "<g style=\"animation-delay: " << seconds * static_cast<double>(i) / length << "s\">\n";
    putPatches(out, picture);
    out << "</g>\n";
  }
  out << "</svg>\n";
}

// A folder that exists whole or not at all: made under an unused name beside its place, then renamed.
class OutputFolder {
 public:
  explicit OutputFolder(const std::string& path) : m_path(path) {
    std::error_code error;
    m_folder = fs::weakly_canonical(path, error);
    if (!m_folder.has_filename()) m_folder = m_folder.parent_path();
    bool made = false;
    for (int i = 1; !made && !error; ++i) {
      m_partial = m_folder.string() + ".partial" + (i > 1 ? std::to_string(i) : "");
      made = fs::create_directory(m_partial, error);
    }
    if (error) throw CannotWrite(m_path + ": cannot be written: " + error.message());
  }
  ~OutputFolder() {
    std::error_code ignored;
    if (!m_partial.empty()) fs::remove_all(m_partial, ignored);
  }
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  std::string file(const char* name) const { return (m_partial / name).string(); }
  void finish() {
    std::error_code error;
    fs::rename(m_partial, m_folder, error);
    if (error) throw CannotWrite(m_path + ": cannot be written: " + error.message());
    m_partial.clear();
  }

 private:
  std::string m_path;  // as given by the user
  fs::path m_folder, m_partial;
};

void writeFrames(const std::string& path, const Film& film) {
  OutputFolder out(path);
  for (std::size_t i = 0; i < film.length; ++i) {
    char name[32];
    std::snprintf(name, sizeof name, "%05zu.png", i);
    writePng(out.file(name), film.picture(i));
  }
  out.finish();
}

}  // namespace

FilmKind filmKind(const std::string& path) {
  std::error_code ignored;
  if (path.ends_with('/') || fs::is_directory(path, ignored)) {
    if (fs::exists(path, ignored) && !fs::is_empty(path, ignored)) {
      throw UserError(path + ": the folder exists and is not empty; valid: a new or an empty folder");
    }
    const OutputFolder probe(path);  // throws if the place cannot be written
    return FilmKind::frames;
  }
  if (!path.ends_with(".svg")) {
    throw UserError(
        path + ": unknown kind of film; valid: NAME.svg (animated), NAME.strip.svg, or NAME/ (folder of PNG files)");
  }
  const OutputFile probe(path);
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

void writeFilm(const std::string& path, FilmKind kind, const Film& film) {
  if (kind == FilmKind::frames) return writeFrames(path, film);
  OutputFile out(path);
  kind == FilmKind::strip ? putStrip(out.stream(), film) : putAnimated(out.stream(), film);
  out.finish();
}

}}  // namespace lpc::LPC_PRECISION
