// SPDX-License-Identifier: Zlib
#pragma once

#include <functional>
#include <string>

#include "experiments/film/picture.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Kinds of films, decided by the file name.
enum class FilmKind {
  strip,     // NAME.strip.svg: some moments side by side
  animated,  // NAME.svg: an animated picture
  frames     // NAME/: a folder of numbered PNG files
};

/// Throws UserError for a name of no kind, and if it cannot be written.
FilmKind filmKind(const std::string& path);
/// Number of pictures of such a film, for a run with `frames` frames.
std::size_t filmLength(FilmKind kind, std::size_t frames);

/// Pictures are made one by one during writing: those of a long run of many bodies are gigabytes.
struct Film {
  std::size_t length = 0;
  double seconds = 0;  // duration shown, for an animated film
  std::function<Picture(std::size_t)> picture;
};
/// Writes the whole film or nothing.
void writeFilm(const std::string& path, FilmKind kind, const Film& film);

}}  // namespace lpc::LPC_PRECISION
