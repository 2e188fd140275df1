// SPDX-License-Identifier: Zlib
#include "experiments/trial/formats/mesh_file.h"

#include <cstdint>
#include <filesystem>
#include <map>

#include "experiments/parse/toml_reader.h"
#include "experiments/trial/formats/mesh_formats.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

constexpr const char* kValidFiles = "; valid: OBJ (.obj), STL (.stl), PLY (.ply) and glTF (.gltf, .glb)";

using MeshReader = MeshFaces (*)(const std::string& bytes, const std::string& path);

/// By the file's ending, in either case; nullptr: none.
MeshReader readerOf(const std::string& ending) {
  const std::pair<const char*, MeshReader> readers[] = {
      {".obj", readObj}, {".stl", readStl}, {".ply", readPly}, {".gltf", readGltf}, {".glb", readGltf}};
  for (const auto& [of, reader] : readers) {
    if (ending == of) return reader;
  }
  return nullptr;
}

std::string endingOf(const std::string& path) {
  std::string ending = std::filesystem::path(path).extension().string();
  for (char& c : ending) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return ending;
}

}  // namespace

std::string meshBytes(const std::string& path) {
  namespace fs = std::filesystem;
  const std::string ending = endingOf(path);
  if (!readerOf(ending)) {
    refuseMesh(path, "'" + ending + "' is not a supported mesh format" + kValidFiles);
  }
  std::error_code error;
  if (!fs::exists(path, error))
    refuseMesh(path, "the file does not exist; valid: a path relative to the scene's folder");
  if (!fs::is_regular_file(path, error)) refuseMesh(path, std::string("is not a file") + kValidFiles);
  const std::uintmax_t size = fs::file_size(path, error);
  if (size > kMostMeshBytes) {
    refuseMesh(path,
               "has " + std::to_string(size >> 20) + " MiB; valid: up to " + std::to_string(kMostMeshBytes >> 20));
  }
  if (size == 0) refuseMesh(path, std::string("is empty") + kValidFiles);
  return readFile(path);
}

MeshFile parseMesh(const std::string& bytes, const std::string& path) {
  const MeshReader read = readerOf(endingOf(path));
  LPC_ASSERT(read);
  const MeshFaces file = read(bytes, path);
  MeshFile out;
  std::map<MeshCorner, int> numbers;
  std::vector<MeshCorner> corners;
  for (const MeshFaces::Face& face : file.faces) {
    corners.clear();
    for (std::size_t i = face.begin; i < face.end; ++i) {
      corners.push_back(file.points[static_cast<std::size_t>(file.corners[i])]);
      for (const float x : corners.back()) {
        if (!std::isfinite(x)) refuseMesh(path, "a coordinate is not finite; valid: numbers");
      }
    }
    try {
      for (const std::array<int, 3>& triangle : trianglesOf(corners)) {
        std::array<int, 3>& points = out.triangles.emplace_back();
        for (std::size_t k = 0; k < 3; ++k) {
          const MeshCorner& corner = corners[static_cast<std::size_t>(triangle[k])];
          const auto [at, isNew] = numbers.emplace(corner, static_cast<int>(out.points.size()));
          if (isNew) out.points.push_back(Eigen::Map<const Eigen::Vector3f>(corner.data()).cast<Real>());
          points[k] = at->second;
        }
      }
    } catch (const UserError& e) {
      if (face.line > 0) refuseMesh(path, face.line, e.what());
      refuseMesh(path, "face " + std::to_string(&face - file.faces.data()) + ": " + e.what());
    }
  }
  if (out.triangles.empty()) refuseMesh(path, "has no faces; valid: a surface of triangles or larger faces");
  return out;
}

void requireConvex(const MeshFile& mesh, const Polytope<3>& hull, const std::string& name) {
  using Point = Eigen::Vector3d;
  const auto at = [&](int i) -> Point { return mesh.points[static_cast<std::size_t>(i)].cast<double>(); };
  const auto vertex = [&](int i) -> Point { return hull.vertices[static_cast<std::size_t>(i)].cast<double>(); };
  double largest = 0, hullArea = 0, area = 0, deepest = 0;
  std::size_t worst = 0;
  for (const Vec<3>& p : mesh.points) largest = std::max(largest, double(p.cwiseAbs().maxCoeff()));
  const double allowed = kConvexRounding * largest;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    const Point p[3] = {at(a), at(b), at(c)};
    area += (p[1] - p[0]).cross(p[2] - p[0]).norm() / 2;
    double depth = std::numeric_limits<double>::infinity();  // below the nearest face
    for (const auto& face : hull.faces) {
      double below = 0;
      for (int k = 0; k < 3 && below < depth; ++k) {
        below = std::max(below, double(face.offset) - face.normal.cast<double>().dot(p[k]));
      }
      depth = std::min(depth, below);
      if (depth <= allowed) break;
    }
    if (depth > deepest) deepest = depth, worst = t;
  }
  const std::string valid =
      "; valid: hull = true, its hull; a compound of convex parts; or kind = \"mesh\" on a fixed body";
  if (deepest > allowed) {
    throw UserError(name + " is not convex: its triangle " + std::to_string(worst + 1) + " lies " + asText(deepest) +
                    " m inside its hull" + valid);
  }
  for (const auto& face : hull.faces) {
    const Point base = vertex(hull.loop[static_cast<std::size_t>(face.begin)]);
    Point twice = Point::Zero();
    for (int i = face.begin + 1; i + 1 < face.end; ++i) {
      const auto k = static_cast<std::size_t>(i);
      twice += (vertex(hull.loop[k]) - base).cross(vertex(hull.loop[k + 1]) - base);
    }
    hullArea += twice.norm() / 2;
  }
  if (std::abs(area - hullArea) <= kConvexArea * hullArea) return;
  throw UserError(name + " is not a closed surface: its triangles have " + asText(area) + " m2, those of its hull " +
                  asText(hullArea) +
                  "; valid: a surface without holes and without faces that lie on each other, or hull = true");
}

}}  // namespace lpc::LPC_PRECISION
