// SPDX-License-Identifier: Zlib
// Meshes from STL, as text in either case or binary.
#include <cstdint>
#include <cstring>

#include "experiments/trial/formats/mesh_text.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

constexpr std::size_t kStlHeader = 84, kStlTriangle = 50;  // bytes of a binary STL
constexpr std::size_t kStlNormal = 12;                     // bytes of a triangle's normal, which precedes its corners

std::string lowerCase(std::string_view word) {
  std::string out(word);
  for (char& c : out) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return out;
}

void addTriangle(std::span<const MeshCorner> corners, long line, MeshFaces& out) {
  const std::size_t begin = out.corners.size();
  for (const MeshCorner& p : corners) {
    out.corners.push_back(static_cast<int>(out.points.size()));
    out.points.push_back(p);
  }
  out.faces.push_back({begin, begin + 3, line});
}

MeshFaces readText(const std::string& bytes, const std::string& path) {
  MeshFaces out;
  long triangles = 0, ends = 0, solids = 0, solidEnds = 0;
  std::vector<MeshCorner> corners;
  for (MeshLines lines(bytes); lines.next();) {
    const std::string key = lowerCase(lines.word());
    if (key == "vertex") {
      const std::vector<float> p = meshPoint(lines, path);
      if (p.size() != 3) refusePoint(p.size(), path, lines.number);
      corners.push_back({p[0], p[1], p[2]});
    }
    triangles += key == "facet", ends += key == "endfacet", solids += key == "solid", solidEnds += key == "endsolid";
    requireFew(triangles, "triangles", path);
    if (key != "endfacet") continue;
    if (corners.size() != 3) {
      refuseMesh(path, lines.number, "a 'facet' of " + std::to_string(corners.size()) + " 'vertex'; valid: 3");
    }
    addTriangle(corners, lines.number, out), corners.clear();
  }
  if (triangles != ends || solids != solidEnds) {
    refuseMesh(path, "is cut off: " + std::to_string(triangles) + " 'facet' and " + std::to_string(ends) +
                         " 'endfacet', " + std::to_string(solids) + " 'solid' and " + std::to_string(solidEnds) +
                         " 'endsolid'; valid: as many of each");
  }
  if (triangles == 0) refuseMesh(path, "has no triangles ('facet'); valid: a surface of them");
  return out;
}

}  // namespace

MeshFaces readStl(const std::string& bytes, const std::string& path) {
  std::uint32_t n = 0;
  if (bytes.size() >= kStlHeader) std::memcpy(&n, bytes.data() + kStlHeader - sizeof n, sizeof n);
  const bool binary = bytes.size() == kStlHeader + kStlTriangle * std::size_t{n};  // also if its header says 'solid'
  const std::size_t begin = bytes.find_first_not_of(" \t\r\n");
  const bool text = begin != bytes.npos && lowerCase(bytes.substr(begin, 5)) == "solid";
  if (!binary && text && bytes.find('\0') == bytes.npos) return readText(bytes, path);
  if (bytes.size() < kStlHeader) {
    refuseMesh(path, "has " + std::to_string(bytes.size()) +
                         " bytes, fewer than the header of a binary STL; valid: 84 and " +
                         "50 for each triangle, or a text that begins with 'solid'");
  }
  if (!binary) {
    refuseMesh(path, "its header says " + std::to_string(n) + " triangles, but the file has " +
                         std::to_string(bytes.size()) + " bytes; valid: 84 and 50 for each triangle");
  }
  if (n == 0) refuseMesh(path, "has no triangles; valid: a surface of them");
  requireFew(n, "triangles", path);
  MeshFaces out;
  for (std::size_t i = 0; i < n; ++i) {
    std::array<MeshCorner, 3> corners;
    std::memcpy(corners.data(), bytes.data() + kStlHeader + kStlTriangle * i + kStlNormal, sizeof corners);
    addTriangle(corners, 0, out);
  }
  return out;
}

}}  // namespace lpc::LPC_PRECISION
