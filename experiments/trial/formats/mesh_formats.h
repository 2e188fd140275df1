// SPDX-License-Identifier: Zlib
// Internals of parseMesh: what a mesh file holds, and the readers of the formats. Only the sources that read meshes
// include it.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "experiments/trial/formats/mesh_file.h"
#include "framework/math/check.h"

namespace lpc { inline namespace LPC_PRECISION {

using MeshCorner = std::array<float, 3>;

struct MeshFaces {
  struct Face {
    std::size_t begin, end;  // of `corners`
    long line;               // 0: the format has no lines
  };
  std::vector<MeshCorner> points;
  std::vector<int> corners;  // indices of points, face by face
  std::vector<Face> faces;
};

/// The readers throw UserError: path and line, what was found, what is valid. Every corner is a point.
MeshFaces readObj(const std::string& bytes, const std::string& path);
MeshFaces readStl(const std::string& bytes, const std::string& path);
MeshFaces readPly(const std::string& bytes, const std::string& path);
MeshFaces readGltf(const std::string& bytes, const std::string& path);

/// Cuts a planar face into triangles, wound as the face: three indices of `corners` each. Decisions are exact. Corners
/// may lie on a line with their neighbours, and equal neighbours count once. A face without area gives triangles
/// without area. Throws UserError for a face that crosses or touches itself.
std::vector<std::array<int, 3>> trianglesOf(std::span<const MeshCorner> corners);

[[noreturn]] inline void refuseMesh(const std::string& path, const std::string& what) {
  throw UserError(path + ": " + what);
}
[[noreturn]] inline void refuseMesh(const std::string& path, long line, const std::string& what) {
  throw UserError(path + ":" + std::to_string(line) + ": " + what);
}
inline void requireFew(long n, const std::string& what, const std::string& path) {
  if (n > kMostMeshItems) {
    refuseMesh(path, "more than " + std::to_string(kMostMeshItems) + " " + what + "; valid: a coarser mesh");
  }
}
/// Refuses a face of too few or too many corners.
inline void requireCorners(long n, const std::string& path, long line) {
  if (n >= 3 && n <= kMostFaceCorners) return;
  refuseMesh(path, line,
             "a face of " + std::to_string(n) + " corners; valid: 3 to " + std::to_string(kMostFaceCorners));
}

}}  // namespace lpc::LPC_PRECISION
