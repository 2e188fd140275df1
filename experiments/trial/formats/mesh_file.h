// SPDX-License-Identifier: Zlib
// Meshes from OBJ, STL, PLY and glTF. Invalid points and truncated files, which readers of these formats commonly
// accept, are refused.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "framework/shape/shape.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Largest file size (bytes): reading needs about ten times as much memory.
inline constexpr std::size_t kMostMeshBytes = std::size_t{64} << 20;
/// Largest number of points, and of triangles, of a file.
inline constexpr long kMostMeshItems = 1000000;
/// Largest number of corners of a face: triangulation takes quadratic time. A million triangles of such faces take ten
/// seconds.
inline constexpr long kMostFaceCorners = 256;
/// Largest number of points for a hull: its time is quadratic in its vertices, up to some seconds.
inline constexpr std::size_t kMostHullPoints = 10000;

/// A mesh is convex if none of its triangles lies deeper inside its hull than this fraction of the largest coordinate
/// (1). Larger: dents are filled silently. Smaller: bodies with coordinates of six digits are refused.
inline constexpr double kConvexRounding = 1e-5;
/// The triangles cover the hull if the areas differ by less than this fraction (1). Larger: a hole is closed silently.
/// Smaller: bodies with coordinates of six digits are refused.
inline constexpr double kConvexArea = 1e-3;

struct MeshFile {
  std::vector<Vec<3>> points;                 // points of triangles, each once, compared by equality
  std::vector<std::array<int, 3>> triangles;  // oriented as in the file; larger faces are triangulated
};

/// The bytes of a file. Throws UserError before reading if it is not a regular file or too large.
std::string meshBytes(const std::string& path);
/// Parses the bytes; the ending of the path decides the format. Throws UserError: path, what was found, what is valid.
MeshFile parseMesh(const std::string& bytes, const std::string& path);

/// Throws UserError with advice unless the mesh is the closed surface of its hull.
void requireConvex(const MeshFile& mesh, const Polytope<3>& hull, const std::string& name);

}}  // namespace lpc::LPC_PRECISION
