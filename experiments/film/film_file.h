// SPDX-License-Identifier: Zlib
#pragma once

#include <functional>
#include <string>

#include "experiments/film/picture.h"

namespace lpc { inline namespace LPC_PRECISION {

/// What a film is written as; its name tells.
enum class FilmKind {
  strip,     // NAME.strip.svg: some moments side by side
  animated,  // NAME.svg: a picture that moves
  frames     // NAME/: a folder of numbered PNG files
};

/// Throws UserError for a name that tells no kind, and where it could not be written.
FilmKind filmKind(const std::string& path);
/// How many pictures such a film is made of, of a run with `frames` of them.
std::size_t filmLength(FilmKind kind, std::size_t frames);

/// Pictures are made one by one as they are written: those of a long run of many bodies are gigabytes.
struct Film {
  std::size_t length = 0;
  double seconds = 0;  // of what is shown, for a film that moves
  std::function<Picture(std::size_t)> picture;
};
/// Writes the whole film or none.
void writeFilm(const std::string& path, FilmKind kind, const Film& film);

}}  // namespace lpc::LPC_PRECISION
