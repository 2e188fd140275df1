// SPDX-License-Identifier: Zlib
// Meshes from OBJ: points ('v') and faces ('f'). Everything else, such as groups and materials, is skipped.
#include "experiments/trial/formats/mesh_text.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

// "3", "3/1", "3/1/2" or "3//2" names point 3.
long pointNumber(std::string_view word, const std::string& path, long line) {
  long value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error == std::errc() && (end == word.data() + word.size() || *end == '/')) return value;
  refuseMesh(path, line, "'" + std::string(word.substr(0, 40)) + "' is not a corner; valid: the number of a point");
}

MeshCorner pointOf(MeshLines& lines, const std::string& path) {
  const std::vector<float> n = meshPoint(lines, path);
  if (n.size() != 3 && n.size() != 4 && n.size() != 6 && n.size() != 7) refusePoint(n.size(), path, lines.number);
  const float w = n.size() % 3 == 1 ? n[3] : 1;  // w, a colour, or both may follow
  if (w == 0) refuseMesh(path, lines.number, "a point of weight 0; valid: another number");
  return {n[0] / w, n[1] / w, n[2] / w};
}

}  // namespace

MeshFaces readObj(const std::string& bytes, const std::string& path) {
  MeshFaces out;
  long triangles = 0;
  for (MeshLines lines(bytes); lines.next();) {
    const std::string_view key = lines.word();
    if (key == "v") {
      out.points.push_back(pointOf(lines, path));
      requireFew(static_cast<long>(out.points.size()), "points", path);
    } else if (key == "f") {
      const std::size_t begin = out.corners.size();
      for (std::string_view w = lines.word(); !w.empty() && !w.starts_with('#'); w = lines.word()) {
        const long number = pointNumber(w, path, lines.number), n = static_cast<long>(out.points.size());
        const long index = number > 0 ? number - 1 : n + number;  // negative: from the last one back
        if (number == 0 || index < 0 || index >= kMostMeshItems) {
          refuseMesh(path, lines.number,
                     "unknown point " + std::to_string(number) + "; valid: 1 to " + std::to_string(n) +
                         ", or negative, from the last one back");
        }
        out.corners.push_back(static_cast<int>(index));
      }
      const auto corners = static_cast<long>(out.corners.size() - begin);
      requireCorners(corners, path, lines.number);
      requireFew(triangles += corners - 2, "triangles", path);
      out.faces.push_back({begin, out.corners.size(), lines.number});
    } else if (key == "l" || key == "p") {
      refuseMesh(path, lines.number, "a separate line or point ('" + std::string(key) + "'); valid: faces");
    }
  }
  if (out.faces.empty()) refuseMesh(path, "has no faces ('f'); valid: a surface of triangles or larger faces");
  for (const MeshFaces::Face& face : out.faces) {  // a face may precede its points
    for (std::size_t i = face.begin; i < face.end; ++i) {
      if (out.corners[i] < static_cast<int>(out.points.size())) continue;
      refuseMesh(path, face.line,
                 "unknown point " + std::to_string(out.corners[i] + 1) + "; valid: 1 to " +
                     std::to_string(out.points.size()) + ", or negative, from the last one back");
    }
  }
  return out;
}

}}  // namespace lpc::LPC_PRECISION
