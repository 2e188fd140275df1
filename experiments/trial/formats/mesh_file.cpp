// SPDX-License-Identifier: Zlib
#include "experiments/trial/formats/mesh_file.h"

#include <dlfcn.h>
#include <sys/resource.h>

#include <charconv>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <map>
#include <string_view>

#include "experiments/parse/toml_reader.h"
#include "experiments/trial/formats/library_process.h"
#include "framework/math/names.h"

#ifdef LPC_ASSIMP
#include <assimp/cimport.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#endif

namespace lpc { inline namespace LPC_PRECISION {
namespace {

constexpr const char* kValidFiles = "; valid: OBJ (.obj) and STL (.stl), as text or binary";
constexpr std::size_t kStlHeader = 84, kStlTriangle = 50;  // bytes of a binary STL

[[noreturn]] void refuse(const std::string& path, const std::string& what) { throw UserError(path + ": " + what); }
[[noreturn]] void refuse(const std::string& path, long line, const std::string& what) {
  throw UserError(path + ":" + std::to_string(line) + ": " + what);
}

std::string endingOf(const std::string& path) {
  std::string ending = std::filesystem::path(path).extension().string();
  for (char& c : ending) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return ending;
}

/// The words of a text, line by line.
class Lines {
 public:
  explicit Lines(std::string_view text) : m_rest(text) {}
  bool next() {
    if (m_rest.empty()) return false;
    const std::size_t end = std::min(m_rest.find('\n'), m_rest.size());
    line = m_rest.substr(0, end), m_rest.remove_prefix(std::min(end + 1, m_rest.size()));
    ++number;
    return true;
  }
  /// The next word of the line; empty at the end of the line.
  std::string_view word() {
    constexpr std::string_view kBlank = " \t\r\v\f";
    line.remove_prefix(std::min(line.find_first_not_of(kBlank), line.size()));
    const std::string_view found = line.substr(0, line.find_first_of(kBlank));
    line.remove_prefix(found.size());
    return found;
  }
  std::string_view line;
  long number = 0;

 private:
  std::string_view m_rest;
};

void requireNumbers(Lines& lines, int least, int most, const std::string& path) {
  int n = 0;
  for (std::string_view word = lines.word(); !word.empty() && !word.starts_with('#'); word = lines.word(), ++n) {
    const std::string shown(word.substr(0, 40));
    if (word.starts_with('+')) word.remove_prefix(1);
    float value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    const bool read = error != std::errc::invalid_argument && end == word.data() + word.size();
    if (!read) refuse(path, lines.number, "'" + shown + "' is no coordinate; valid: a number");
    // A number closer to 0 than any float is read as 0.
    const bool tiny =
        error == std::errc::result_out_of_range && (word.find("e-") != word.npos || word.find("E-") != word.npos);
    if (!tiny && (error != std::errc() || !std::isfinite(value))) {
      refuse(path, lines.number, "the coordinate " + shown + "; valid: finite, as a number of 32 bits");
    }
  }
  if (n >= least && n <= most) return;
  refuse(path, lines.number, "a point of " + std::to_string(n) + " numbers; valid: 3");
}

void requireFew(long n, const char* what, const std::string& path) {
  if (n <= kMostMeshItems) return;
  refuse(path, "more than " + std::to_string(kMostMeshItems) + " " + what + "; valid: a coarser mesh");
}

void checkObj(const std::string& bytes, const std::string& path) {
  long points = 0, triangles = 0;
  for (Lines lines(bytes); lines.next();) {
    const std::string_view key = lines.word();
    if (key == "v") {
      requireNumbers(lines, 3, 7, path);  // w, a colour, or both may follow
      requireFew(++points, "points", path);
    } else if (key == "f") {
      long corners = 0;
      for (std::string_view w = lines.word(); !w.empty() && !w.starts_with('#'); w = lines.word()) corners += w != "\\";
      if (corners > kMostFaceCorners) {
        refuse(path, lines.number,
               "a face of " + std::to_string(corners) + " corners; valid: up to " + std::to_string(kMostFaceCorners));
      }
      requireFew(triangles += std::max(1L, corners - 2), "triangles", path);
    } else if (key == "l" || key == "p") {
      refuse(path, lines.number, "a line or a point by itself ('" + std::string(key) + "'); valid: faces");
    }
  }
  if (triangles == 0) refuse(path, "has no faces ('f'); valid: a surface of triangles or larger faces");
}

void checkStlText(const std::string& bytes, const std::string& path) {
  long triangles = 0, ends = 0, points = 0, solids = 0, solidEnds = 0;
  for (Lines lines(bytes); lines.next();) {
    const std::string_view key = lines.word();
    if (key == "vertex") ++points, requireNumbers(lines, 3, 3, path);
    triangles += key == "facet", ends += key == "endfacet", solids += key == "solid", solidEnds += key == "endsolid";
    requireFew(triangles, "triangles", path);
  }
  if (triangles != ends || solids != solidEnds) {
    refuse(path, "is cut off: " + std::to_string(triangles) + " 'facet' and " + std::to_string(ends) + " 'endfacet', " +
                     std::to_string(solids) + " 'solid' and " + std::to_string(solidEnds) +
                     " 'endsolid'; valid: as many of each");
  }
  if (triangles == 0) refuse(path, "has no triangles ('facet'); valid: a surface of them");
  if (points != 3 * triangles) {
    refuse(path, "has " + std::to_string(points) + " 'vertex' in " + std::to_string(triangles) +
                     " 'facet'; valid: three in each");
  }
}

void checkStl(const std::string& bytes, const std::string& path) {
  const std::size_t begin = bytes.find_first_not_of(" \t\r\n");
  const bool text = begin != bytes.npos && bytes.compare(begin, 5, "solid") == 0 && bytes.find('\0') == bytes.npos;
  if (text) return checkStlText(bytes, path);
  if (bytes.size() < kStlHeader) {
    refuse(path, "has " + std::to_string(bytes.size()) +
                     " bytes, fewer than the header of a binary STL; valid: 84 and " +
                     "50 for each triangle, or a text that begins with 'solid'");
  }
  std::uint32_t n = 0;
  std::memcpy(&n, bytes.data() + kStlHeader - sizeof n, sizeof n);
  if (bytes.size() != kStlHeader + kStlTriangle * std::size_t{n}) {
    refuse(path, "its header says " + std::to_string(n) + " triangles, and it has " + std::to_string(bytes.size()) +
                     " bytes; valid: 84 and 50 for each triangle");
  }
  if (n == 0) refuse(path, "has no triangles; valid: a surface of them");
  requireFew(n, "triangles", path);
}

/// As assimp returns them: corners one by one, three for each triangle.
using Corners = std::vector<std::array<float, 3>>;

#ifdef LPC_ASSIMP

template <class F>
F* ofAssimp(const char* name) {
  static void* const loaded = dlopen(LPC_ASSIMP, RTLD_NOW | RTLD_LOCAL);
  void* const at = loaded ? dlsym(loaded, name) : nullptr;
  if (!at) throw UserError("assimp cannot be loaded: " + std::string(dlerror()));
  return reinterpret_cast<F*>(at);
}
#define LPC_OF_ASSIMP(function) ofAssimp<decltype(function)>(#function)

/// Called in a child process. A file may name others (`mtllib`): none is opened.
std::string cornersByAssimp(const std::string& bytes, const std::string& ending) {
  const auto import = LPC_OF_ASSIMP(aiImportFileFromMemory);
#if !defined(LPC_SANITIZED)  // AddressSanitizer reads /proc/self/maps when assimp throws, and aborts if it cannot
  const rlimit none{0, 0};
  setrlimit(RLIMIT_NOFILE, &none);
#endif
  const aiScene* scene =
      import(bytes.data(), static_cast<unsigned>(bytes.size()), aiProcess_Triangulate, ending.c_str() + 1);
  if (!scene) {
    const std::string said = oneLine(LPC_OF_ASSIMP(aiGetErrorString)());
    throw UserError("cannot be read: " + said.substr(0, 200) + kValidFiles);
  }
  std::string out;
  for (unsigned m = 0; m < scene->mNumMeshes; ++m) {
    const aiMesh& mesh = *scene->mMeshes[m];
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      if (face.mNumIndices != 3) {
        throw UserError("a face of " + std::to_string(face.mNumIndices) + " corners; valid: three or more");
      }
      for (unsigned k = 0; k < 3; ++k) {
        const aiVector3D& p = mesh.mVertices[face.mIndices[k]];
        const std::array<float, 3> corner = {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
        out.append(reinterpret_cast<const char*>(corner.data()), sizeof corner);
      }
    }
  }
  return out;
}

#else

std::string cornersByAssimp(const std::string&, const std::string&) {
  throw UserError("this build is without assimp; valid: one with libassimp-dev, or 'points'");
}

#endif

Corners cornersOf(const std::string& bytes, const std::string& path) {
  const std::string ending = endingOf(path);
  const std::string read = inItsProcess("assimp", path, [&] { return cornersByAssimp(bytes, ending); });
  Corners out(read.size() / sizeof(Corners::value_type));
  std::memcpy(out.data(), read.data(), out.size() * sizeof(Corners::value_type));
  return out;
}

}  // namespace

std::string meshBytes(const std::string& path) {
  namespace fs = std::filesystem;
  const std::string ending = endingOf(path);
  if (ending != ".obj" && ending != ".stl")
    refuse(path, "'" + ending + "' is no format of meshes that is read" + kValidFiles);
  std::error_code error;
  if (!fs::exists(path, error)) refuse(path, "there is no such file; valid: a path from the scene's folder");
  if (!fs::is_regular_file(path, error)) refuse(path, std::string("is no file") + kValidFiles);
  const std::uintmax_t size = fs::file_size(path, error);
  if (size > kMostMeshBytes) {
    refuse(path, "has " + std::to_string(size >> 20) + " MiB; valid: up to " + std::to_string(kMostMeshBytes >> 20));
  }
  if (size == 0) refuse(path, std::string("is empty") + kValidFiles);
  return readFile(path);
}

MeshFile parseMesh(const std::string& bytes, const std::string& path) {
  endingOf(path) == ".obj" ? checkObj(bytes, path) : checkStl(bytes, path);
  MeshFile out;
  std::map<std::array<float, 3>, int> numbers;
  std::array<int, 3> triangle{};
  int filled = 0;
  for (const std::array<float, 3>& corner : cornersOf(bytes, path)) {
    const Vec<3> p(static_cast<Real>(corner[0]), static_cast<Real>(corner[1]), static_cast<Real>(corner[2]));
    if (!p.allFinite()) refuse(path, "a coordinate is not finite; valid: numbers");
    const auto [at, isNew] = numbers.emplace(corner, static_cast<int>(out.points.size()));
    if (isNew) out.points.push_back(p);
    triangle[static_cast<std::size_t>(filled++)] = at->second;
    if (filled == 3) out.triangles.push_back(triangle), filled = 0;
  }
  if (out.triangles.empty()) refuse(path, "has no faces; valid: a surface of triangles or larger faces");
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
                    " m inside of its hull" + valid);
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
  throw UserError(name + " is no closed surface: its triangles have " + asText(area) + " m2, those of its hull " +
                  asText(hullArea) +
                  "; valid: a surface without holes and without faces that lie on each other, or hull = true");
}

}}  // namespace lpc::LPC_PRECISION
