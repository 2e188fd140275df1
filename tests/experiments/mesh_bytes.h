// SPDX-License-Identifier: Zlib
// A box as the bytes of mesh files.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "framework/math/space.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace mesh_bytes {

using Triangles = std::vector<std::array<int, 3>>;

/// 1 x 2 x 3 m from the origin; corners numbered from 0, x slowest.
inline const std::vector<Vec<3>> kCorners = {{0, 0, 0}, {0, 0, 3}, {0, 2, 0}, {0, 2, 3},
                                             {1, 0, 0}, {1, 0, 3}, {1, 2, 0}, {1, 2, 3}};
inline const Triangles kSides = {{0, 1, 3}, {0, 3, 2}, {4, 6, 7}, {4, 7, 5}, {0, 4, 5}, {0, 5, 1},
                                 {2, 3, 7}, {2, 7, 6}, {0, 2, 6}, {0, 6, 4}, {1, 5, 7}, {1, 7, 3}};

inline std::string numbersOf(const Vec<3>& p) {
  return std::to_string(p[0]) + " " + std::to_string(p[1]) + " " + std::to_string(p[2]);
}

inline std::string obj(const std::vector<Vec<3>>& points, const Triangles& triangles) {
  std::string out;
  for (const Vec<3>& p : points) out += "v " + numbersOf(p) + "\n";
  for (const auto& [a, b, c] : triangles) {
    out += "f " + std::to_string(a + 1) + " " + std::to_string(b + 1) + " " + std::to_string(c + 1) + "\n";
  }
  return out;
}

inline std::string stlText(const std::vector<Vec<3>>& points, const Triangles& triangles) {
  std::string out = "solid x\n";
  for (const auto& t : triangles) {
    out += "facet normal 0 0 0\nouter loop\n";
    for (const int i : t) out += "vertex " + numbersOf(points[static_cast<std::size_t>(i)]) + "\n";
    out += "endloop\nendfacet\n";
  }
  return out + "endsolid x\n";
}

inline std::string stl(const std::vector<Vec<3>>& points, const Triangles& triangles, std::uint32_t told) {
  std::string out(80, 'x');
  const auto add = [&](const auto& value) { out.append(reinterpret_cast<const char*>(&value), sizeof value); };
  add(told);
  for (const auto& t : triangles) {
    out.append(12, '\0');
    for (const int i : t) {
      for (const Real x : points[static_cast<std::size_t>(i)]) add(static_cast<float>(x));
    }
    out.append(2, '\0');
  }
  return out;
}
inline std::string stl(const std::vector<Vec<3>>& points, const Triangles& triangles) {
  return stl(points, triangles, static_cast<std::uint32_t>(triangles.size()));
}

/// Flat arrays of little-endian floats and indices in a file of two chunks, at the pose of a node.
inline std::string glb(const std::vector<Vec<3>>& points, const Triangles& triangles, const std::string& node) {
  std::string data, json;
  const auto add = [](std::string& to, const auto& value) {
    to.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  for (const auto& t : triangles) {
    for (const int i : t) add(data, static_cast<std::uint32_t>(i));
  }
  const std::string n = std::to_string(3 * triangles.size()), at = std::to_string(data.size());
  for (const Vec<3>& p : points) {
    for (const Real x : p) add(data, static_cast<float>(x));
  }
  json = R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0)" + node +
         R"(}],"meshes":[{"primitives":[{"attributes":{"POSITION":1},"indices":0}]}],"accessors":[)" +
         R"({"bufferView":0,"componentType":5125,"count":)" + n + R"(,"type":"SCALAR"},)" +
         R"({"bufferView":1,"componentType":5126,"count":)" + std::to_string(points.size()) + R"(,"type":"VEC3"}],)" +
         R"("bufferViews":[{"buffer":0,"byteLength":)" + at + R"(},{"buffer":0,"byteOffset":)" + at +
         R"(,"byteLength":)" + std::to_string(12 * points.size()) + R"(}],"buffers":[{"byteLength":)" +
         std::to_string(data.size()) + "}]}";
  json.append((4 - json.size() % 4) % 4, ' ');
  std::string out = "glTF";
  const auto word = [&](std::size_t value) { add(out, static_cast<std::uint32_t>(value)); };
  word(2), word(28 + json.size() + data.size()), word(json.size());
  out += "JSON" + json;
  word(data.size());
  out += std::string("BIN\0", 4);
  return out + data;
}

enum class Ply { text, littleEndian, bigEndian };
/// The numbers of both elements have properties that are skipped.
inline std::string ply(const std::vector<Vec<3>>& points, const std::vector<std::vector<int>>& faces, Ply format) {
  const bool text = format == Ply::text;
  std::string out = std::string("ply\nformat ") +
                    (text                          ? "ascii"
                     : format == Ply::littleEndian ? "binary_little_endian"
                                                   : "binary_big_endian") +
                    " 1.0\ncomment x\nelement vertex " + std::to_string(points.size()) +
                    "\nproperty uchar red\nproperty float x\nproperty double y\nproperty float z\nelement face " +
                    std::to_string(faces.size()) +
                    "\nproperty list uchar ushort vertex_indices\nproperty short flags\nend_header\n";
  const auto add = [&](auto value) {
    if (text) {
      out += std::to_string(value) + " ";
      return;
    }
    std::string raw(reinterpret_cast<const char*>(&value), sizeof value);
    if (format == Ply::bigEndian) std::reverse(raw.begin(), raw.end());
    out += raw;
  };
  for (const Vec<3>& p : points) {
    add(std::uint8_t{7}), add(static_cast<float>(p[0])), add(double(p[1])), add(static_cast<float>(p[2]));
    if (text) out += "\n";
  }
  for (const auto& face : faces) {
    add(static_cast<std::uint8_t>(face.size()));
    for (const int i : face) add(static_cast<std::uint16_t>(i));
    add(std::int16_t{-3});
    if (text) out += "\n";
  }
  return out;
}
inline std::vector<std::vector<int>> facesOf(const Triangles& triangles) {
  std::vector<std::vector<int>> out;
  for (const auto& t : triangles) out.emplace_back(t.begin(), t.end());
  return out;
}

}}}}  // namespace lpc::LPC_PRECISION::test::mesh_bytes
