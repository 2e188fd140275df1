// SPDX-License-Identifier: Zlib
// Meshes from PLY, as text or binary of either byte order: the elements `vertex` and `face`. Other elements and other
// properties are skipped.
#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>

#include "experiments/parse/toml_reader.h"
#include "experiments/trial/formats/mesh_text.h"
#include "framework/math/names.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

enum class PlyType { int8, uint8, int16, uint16, int32, uint32, float32, float64 };
constexpr std::pair<const char*, PlyType> kPlyTypes[] = {
    {"char", PlyType::int8},      {"uchar", PlyType::uint8},    {"short", PlyType::int16},
    {"ushort", PlyType::uint16},  {"int", PlyType::int32},      {"uint", PlyType::uint32},
    {"float", PlyType::float32},  {"double", PlyType::float64}, {"int8", PlyType::int8},
    {"uint8", PlyType::uint8},    {"int16", PlyType::int16},    {"uint16", PlyType::uint16},
    {"int32", PlyType::int32},    {"uint32", PlyType::uint32},  {"float32", PlyType::float32},
    {"float64", PlyType::float64}};

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::float32;
  bool list = false;
  PlyType count = PlyType::uint8;  // of a list
};
struct PlyElement {
  std::string name;
  long n = 0;
  std::vector<PlyProperty> properties;
};

/// The header, and the values after it one by one.
class PlyFile {
 public:
  PlyFile(const std::string& bytes, const std::string& path) : m_lines(bytes), m_path(path) { readHeader(); }

  const std::vector<PlyElement>& elements() const { return m_elements; }
  long line() const { return m_text ? m_lines.number : 0; }

  double next(PlyType type) {
    if (m_text) return nextWord();
    switch (type) {
      case PlyType::int8:
        return nextBytes<std::int8_t>();
      case PlyType::uint8:
        return nextBytes<std::uint8_t>();
      case PlyType::int16:
        return nextBytes<std::int16_t>();
      case PlyType::uint16:
        return nextBytes<std::uint16_t>();
      case PlyType::int32:
        return nextBytes<std::int32_t>();
      case PlyType::uint32:
        return nextBytes<std::uint32_t>();
      case PlyType::float32:
        return static_cast<double>(nextBytes<float>());
      case PlyType::float64:
        return nextBytes<double>();
    }
    return 0;
  }
  /// The number of items of a list; 1 for another property.
  double nextCount(const PlyProperty& p) {
    if (!p.list) return 1;
    const double n = next(p.count);
    if (!(n >= 0 && n < 1e9) || n != std::floor(n)) {
      fail("a list of " + asText(n) + " items; valid: a whole number from 0 to 999999999");
    }
    return n;
  }
  void requireEnd() {
    if (m_text) {
      std::string_view word = m_lines.word();
      while (word.empty() && m_lines.next()) word = m_lines.word();
      m_data = word;
    }
    if (!m_data.empty()) fail("has more than its header says; valid: the elements of its header");
  }
  [[noreturn]] void fail(const std::string& what) const {
    m_text ? refuseMesh(m_path, m_lines.number, what) : refuseMesh(m_path, what);
  }

 private:
  PlyType typeOf(std::string_view word) const {
    for (const auto& [name, type] : kPlyTypes) {
      if (word == name) return type;
    }
    fail("'" + std::string(word.substr(0, 40)) + "' is not a type; valid: char, uchar, short, ushort, int, uint, " +
         "float, double");
  }
  void readHeader() {
    m_text = true;  // errors have lines
    if (!m_lines.next() || m_lines.word() != "ply") fail("does not begin with 'ply'; valid: a PLY file");
    std::string format;
    while (m_lines.next()) {
      const std::string_view key = m_lines.word();
      if (key == "end_header") break;
      if (key == "format") {
        format = m_lines.word();
      } else if (key == "element") {
        PlyElement& e = m_elements.emplace_back();
        e.name = m_lines.word();
        const std::string_view n = m_lines.word();
        const auto [end, error] = std::from_chars(n.data(), n.data() + n.size(), e.n);
        if (n.empty() || error != std::errc() || end != n.data() + n.size() || e.n < 0) {
          fail("an element of '" + std::string(n.substr(0, 40)) + "' items; valid: a count");
        }
        requireFew(e.n, "'" + e.name.substr(0, 40) + "'", m_path);
      } else if (key == "property") {
        if (m_elements.empty()) fail("a property of no element; valid: after an 'element'");
        PlyProperty p;
        std::string_view type = m_lines.word();
        if ((p.list = type == "list")) p.count = typeOf(m_lines.word()), type = m_lines.word();
        p.type = typeOf(type), p.name = m_lines.word();
        m_elements.back().properties.push_back(p);
      } else if (key != "comment" && key != "obj_info" && !key.empty()) {
        fail("unknown word '" + std::string(key.substr(0, 40)) + "' of the header; valid: format, element, property, " +
             "comment, obj_info, end_header");
      }
    }
    if (format != "ascii" && format != "binary_little_endian" && format != "binary_big_endian") {
      fail("its format is '" + format.substr(0, 40) + "'; valid: ascii, binary_little_endian, binary_big_endian");
    }
    m_text = format == "ascii", m_data = m_lines.rest();
    m_swapped = (format == "binary_big_endian") != (std::endian::native == std::endian::big);
  }
  double nextWord() {
    std::string_view word = m_lines.word();
    while (word.empty()) {
      if (!m_lines.next()) fail("is cut off; valid: the elements of its header");
      word = m_lines.word();
    }
    const std::string shown(word.substr(0, 40));
    if (word.starts_with('+')) word.remove_prefix(1);
    double value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error == std::errc::invalid_argument || end != word.data() + word.size()) {
      fail("'" + shown + "' is not a number; valid: a number");
    }
    if (error == std::errc::result_out_of_range) {
      const double infinity = std::numeric_limits<double>::infinity();
      return isTiny(word) ? 0 : word.starts_with('-') ? -infinity : infinity;
    }
    return value;
  }
  template <class T>
  T nextBytes() {
    std::array<char, sizeof(T)> raw;
    if (m_data.size() < raw.size()) fail("is cut off; valid: the elements of its header");
    std::copy_n(m_data.begin(), raw.size(), raw.begin());
    m_data.remove_prefix(raw.size());
    if (m_swapped) std::reverse(raw.begin(), raw.end());
    return std::bit_cast<T>(raw);
  }

  MeshLines m_lines;
  const std::string& m_path;
  std::string_view m_data;  // of a binary file: what is left
  bool m_text = true, m_swapped = false;
  std::vector<PlyElement> m_elements;
};

void readVertices(PlyFile& file, const PlyElement& vertex, MeshFaces& out) {
  std::array<int, 3> at{-1, -1, -1};
  for (std::size_t i = 0; i < vertex.properties.size(); ++i) {
    const PlyProperty& p = vertex.properties[i];
    if (p.name.size() == 1 && p.name[0] >= 'x' && p.name[0] <= 'z' && !p.list) {
      at[static_cast<std::size_t>(p.name[0] - 'x')] = static_cast<int>(i);
    }
  }
  if (*std::min_element(at.begin(), at.end()) < 0) file.fail("its 'vertex' has no x, y and z; valid: all three");
  for (long n = 0; n < vertex.n; ++n) {
    MeshCorner point{};
    for (std::size_t i = 0; i < vertex.properties.size(); ++i) {
      const PlyProperty& p = vertex.properties[i];
      const double count = file.nextCount(p);
      for (double k = 0; k < count; ++k) {
        const double value = file.next(p.type);
        for (std::size_t c = 0; c < 3; ++c) {
          if (at[c] != static_cast<int>(i)) continue;
          if (!(std::abs(value) <= double(std::numeric_limits<float>::max()))) {
            file.fail("the coordinate " + asText(value) + "; valid: finite, as a number of 32 bits");
          }
          point[c] = static_cast<float>(value);
        }
      }
    }
    out.points.push_back(point);
  }
}

void readFaces(PlyFile& file, const PlyElement& face, const std::string& path, MeshFaces& out) {
  long triangles = 0;
  for (long n = 0; n < face.n; ++n) {
    for (const PlyProperty& p : face.properties) {
      const bool corners = p.list && (p.name == "vertex_indices" || p.name == "vertex_index");
      const double count = file.nextCount(p);
      if (corners && !(count >= 3 && count <= double(kMostFaceCorners))) {
        file.fail("face " + std::to_string(n) + " has " + asText(count) + " corners; valid: 3 to " +
                  std::to_string(kMostFaceCorners));
      }
      const std::size_t begin = out.corners.size();
      for (double k = 0; k < count; ++k) {
        const double value = file.next(p.type);
        if (!corners) continue;
        if (!(value >= 0 && value < 1e9) || value != std::floor(value)) {
          file.fail("face " + std::to_string(n) + ": unknown point " + asText(value) + "; valid: a number from 0");
        }
        out.corners.push_back(static_cast<int>(value));
      }
      if (!corners) continue;
      requireFew(triangles += static_cast<long>(count) - 2, "triangles", path);
      out.faces.push_back({begin, out.corners.size(), file.line()});
    }
  }
}

}  // namespace

MeshFaces readPly(const std::string& bytes, const std::string& path) {
  PlyFile file(bytes, path);
  MeshFaces out;
  for (const PlyElement& e : file.elements()) {
    if (e.name == "vertex") {
      readVertices(file, e, out);
    } else if (e.name == "face") {
      readFaces(file, e, path, out);
    } else {
      for (long n = 0; n < e.n; ++n) {
        for (const PlyProperty& p : e.properties) {
          const double count = file.nextCount(p);
          for (double k = 0; k < count; ++k) file.next(p.type);
        }
      }
    }
  }
  file.requireEnd();
  if (out.faces.empty()) refuseMesh(path, "has no faces; valid: a surface of triangles or larger faces");
  for (std::size_t f = 0; f < out.faces.size(); ++f) {
    for (std::size_t i = out.faces[f].begin; i < out.faces[f].end; ++i) {
      if (out.corners[i] < static_cast<int>(out.points.size())) continue;
      refuseMesh(path, "face " + std::to_string(f) + ": unknown point " + std::to_string(out.corners[i]) +
                           "; valid: 0 to " + std::to_string(static_cast<long>(out.points.size()) - 1));
    }
  }
  return out;
}

}}  // namespace lpc::LPC_PRECISION
