// SPDX-License-Identifier: Zlib
// Meshes from OBJ and STL, by assimp. It passes over much that is wrong: a line of an OBJ that is no point is left out,
// and all faces then name other points; an STL that was cut off ends early. So the text is looked through before.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "framework/shape/shape.h"

namespace lpc { inline namespace LPC_PRECISION {

/// The most bytes of a file: assimp takes some ten times as many.
inline constexpr std::size_t kMostMeshBytes = std::size_t{64} << 20;
/// The most points, and triangles, that a file may have.
inline constexpr long kMostMeshItems = 1000000;
/// The most corners of one face: the time in which it is cut into triangles grows with their square. A million
/// triangles of such faces take ten seconds.
inline constexpr long kMostFaceCorners = 256;
/// The most points whose hull is made: its time grows with the square of its vertices, to some seconds.
inline constexpr std::size_t kMostHullPoints = 10000;

/// A mesh is convex when none of its triangles lies deeper inside of its hull than this part of the largest coordinate
/// (1). Larger: dents are filled in silence. Smaller: bodies whose coordinates have six digits are refused.
inline constexpr double kConvexRounding = 1e-5;
/// Its triangles cover its hull when their areas differ by less than this part (1). Larger: a hole is closed in
/// silence. Smaller: bodies whose coordinates have six digits are refused.
inline constexpr double kConvexArea = 1e-3;

struct MeshFile {
  std::vector<Vec<3>> points;                 // those of triangles, each once, by equality
  std::vector<std::array<int, 3>> triangles;  // as the file turns them; larger faces are cut
};

/// The bytes of a file. Throws UserError before it reads one that is none, or too large.
std::string meshBytes(const std::string& path);
/// What they say; the ending of the path is the format. Throws UserError: path, what was found, what is valid.
MeshFile parseMesh(const std::string& bytes, const std::string& path);

/// Throws UserError with advice unless the mesh is the closed surface of its hull.
void requireConvex(const MeshFile& mesh, const Polytope<3>& hull, const std::string& name);

}}  // namespace lpc::LPC_PRECISION
