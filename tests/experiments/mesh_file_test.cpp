// SPDX-License-Identifier: Zlib
// Shapes from OBJ, STL, PLY and glTF: a written file reads back equal, and a broken one is rejected with a one-line
// reason.
#include "experiments/trial/formats/mesh_file.h"

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "framework/math/random.h"
#include "tests/expect_caught.h"
#include "tests/experiments/mesh_bytes.h"
#include "tests/experiments/workspace.h"

namespace lpc { inline namespace LPC_PRECISION { namespace mesh_file_test { namespace {

using test::Workspace;
using namespace test::mesh_bytes;

const std::string kNoLibrary = "this build has no assimp";

/// The reader's message without the path; empty if there is none.
std::string said(const Workspace& w, const std::string& name, const std::string& bytes) {
  const std::string path = w.write(name, bytes);
  try {
    parseMesh(meshBytes(path), path);
  } catch (const UserError& e) {
    const std::string what = e.what();
    EXPECT_EQ(what.substr(0, path.size()), path);
    EXPECT_EQ(std::count(what.begin(), what.end(), '\n'), 0) << what;
    return what.substr(path.size());
  }
  return "";
}

bool hasAssimp(const Workspace& w) {
  return said(w, "probe.glb", glb(kCorners, kSides, "")).find(kNoLibrary) == std::string::npos;
}

/// Corners of the triangles, sorted, each triangle from its least corner: must survive a round trip through a file.
std::vector<std::array<std::array<double, 3>, 3>> content(const std::vector<Vec<3>>& points,
                                                          const Triangles& triangles) {
  std::vector<std::array<std::array<double, 3>, 3>> out;
  for (const auto& t : triangles) {
    std::array<std::array<double, 3>, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec<3>& p = points[static_cast<std::size_t>(t[k])];
      corners[k] = {double(p[0]), double(p[1]), double(p[2])};
    }
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    out.push_back(corners);
  }
  std::sort(out.begin(), out.end());
  return out;
}
bool isTheBox(const MeshFile& mesh) {
  return mesh.points.size() == kCorners.size() && content(mesh.points, mesh.triangles) == content(kCorners, kSides);
}

std::string upperCase(std::string text) {
  for (char& c : text) c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  return text;
}

TEST(MeshFile, EveryFormatHoldsTheSameTriangles) {
  std::string named = stl(kCorners, kSides);
  named.replace(0, 5, "solid");  // a binary file
  std::fill(named.begin() + 5, named.begin() + 80, ' ');
  const std::pair<const char*, std::string> files[] = {{"a.obj", obj(kCorners, kSides)},
                                                       {"a.stl", stlText(kCorners, kSides)},
                                                       {"b.stl", upperCase(stlText(kCorners, kSides))},
                                                       {"c.stl", named},
                                                       {"A.STL", stl(kCorners, kSides)},
                                                       {"a.ply", ply(kCorners, facesOf(kSides), Ply::text)},
                                                       {"b.ply", ply(kCorners, facesOf(kSides), Ply::littleEndian)},
                                                       {"c.ply", ply(kCorners, facesOf(kSides), Ply::bigEndian)}};
  for (const auto& [name, bytes] : files) EXPECT_TRUE(isTheBox(parseMesh(bytes, name))) << name;
  // Quads are split, groups form one body, the material library is not read, points without a face are dropped.
  const std::string quads =
      "mtllib /no/such/file\nv 9 9 9\nusemtl x\ng a\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 2 3 4 5\ng b\nf -4/1 "
      "-2/1 -1/1\n";
  const MeshFile mesh = parseMesh("vt 0 0\n" + quads, "q.obj");
  EXPECT_EQ(mesh.points.size(), 4u);
  EXPECT_EQ(mesh.triangles.size(), 3u);

  MeshFile planted = parseMesh(stl(kCorners, kSides), "a.stl");
  planted.points.push_back(planted.points[0]);
  planted.triangles[0][0] = 8;
  test::expectCaught("mesh files: corners of an STL that stay apart", isTheBox(planted));
  planted = parseMesh(obj(kCorners, kSides), "a.obj");
  std::swap(planted.triangles[3][0], planted.triangles[3][1]);
  test::expectCaught("mesh files: a triangle that faces inwards", isTheBox(planted));
}

// A node halves, mirrors along x and moves; the file is the box that becomes the usual one.
TEST(MeshFile, NodesOfGltfPlaceTheirMeshes) {
  const Workspace w;
  if (!hasAssimp(w)) GTEST_SKIP() << "assimp is absent";
  EXPECT_TRUE(isTheBox(parseMesh(glb(kCorners, kSides, ""), "a.glb")));
  std::vector<Vec<3>> placed = kCorners;
  for (Vec<3>& p : placed) p = Vec<3>(-p[0] + 4, p[1], p[2]) * 2;
  Triangles wound = kSides;
  for (auto& t : wound) std::swap(t[1], t[2]);
  const std::string node = R"(,"scale":[-0.5,0.5,0.5],"translation":[4,0,0])";
  EXPECT_TRUE(isTheBox(parseMesh(glb(placed, wound, node), "a.glb")));
  test::expectCaught("mesh files: a mirrored node that turns its mesh inside out",
                     isTheBox(parseMesh(glb(placed, kSides, node), "a.glb")));
}

/// Twice the area of a polygon around y (m2), positive when it runs counter-clockwise seen from above.
double twiceArea(const std::vector<Vec<3>>& p) {
  double out = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Vec<3>&a = p[i], &b = p[(i + 1) % p.size()];
    out += double(a[2]) * double(b[0]) - double(a[0]) * double(b[2]);
  }
  return out;
}

/// The triangles of a face in the plane of y = 0 cover it once, whatever its winding: all are wound as the face, none
/// is without area, and their areas add up.
bool isCovered(const std::vector<Vec<3>>& face) {
  std::string text = "f";
  for (std::size_t i = 0; i < face.size(); ++i) text += " " + std::to_string(i + 1);
  const MeshFile mesh = parseMesh(obj(face, {}) + text + "\n", "a.obj");
  const double whole = twiceArea(face);
  double sum = 0;
  for (const auto& t : mesh.triangles) {
    std::vector<Vec<3>> p;
    for (const int i : t) p.push_back(mesh.points[static_cast<std::size_t>(i)]);
    const double area = twiceArea(p) / whole;
    if (!(area > 0)) return false;
    sum += area;
  }
  return mesh.triangles.size() == face.size() - 2 && std::abs(sum - 1) < 1e-6;
}

TEST(MeshFile, FacesOfAnyOutlineAreCovered) {
  const std::vector<Vec<3>> notch = {{-4, 0, -4}, {-4, 0, 4}, {0, 0, 4}, {0, 0, 0}, {4, 0, 0}, {4, 0, -4}};
  std::vector<Vec<3>> comb = {{0, 0, 0}}, onLine;
  for (int i = 0; i < 20; ++i) {  // corners lie on lines with their neighbours along the back and at the tips
    comb.push_back({Real(i), 0, 3}), comb.push_back({Real(i) + Real(0.25), 0, 3});
    comb.push_back({Real(i) + Real(0.5), 0, 3}), comb.push_back({Real(i) + Real(0.5), 0, 1});
    comb.push_back({Real(i + 1), 0, 1});
  }
  for (int i = 20; i > 0; --i) comb.push_back({Real(i), 0, 0});
  for (int i = 0; i < 40; ++i) {  // of a triangle: three corners, and 37 others on its sides
    const double s = i % 40 / 40.0 * 3;
    const Vec<3> corner[] = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {0, 0, 0}};
    const int side = std::min(2, static_cast<int>(s));
    onLine.push_back(corner[side] + static_cast<Real>(s - side) * (corner[side + 1] - corner[side]));
  }
  int wrong = 0;
  for (std::vector<Vec<3>> face : {notch, comb, onLine}) {
    for (const bool turned : {false, true}) {
      if (turned) std::reverse(face.begin(), face.end());
      for (std::size_t first = 0; first < face.size(); first += 3) {
        std::rotate(face.begin(), face.begin() + 1, face.end());
        wrong += !isCovered(face);
      }
    }
  }
  EXPECT_EQ(wrong, 0);
  // Random stars: corners at increasing angles, at random distances; whole numbers, which a file holds exactly.
  Random random(39);
  for (int k = 0; k < 200; ++k) {
    std::vector<Vec<3>> star;
    const int n = 4 + static_cast<int>(random.below(30));
    for (int i = 0; i < n; ++i) {
      const double angle = 6.283185307179586 * (i + random.uniform(0.1, 0.9)) / n,
                   r = 200 + 10000 * std::pow(random.uniform(0, 1), 2);
      star.emplace_back(Real(std::round(r * std::sin(angle))), Real(0), Real(std::round(r * std::cos(angle))));
    }
    wrong += !isCovered(star);
  }
  EXPECT_EQ(wrong, 0);
  const auto fan = [](const std::vector<Vec<3>>& face) {  // not for concave faces
    bool covered = true;
    for (std::size_t i = 1; i + 1 < face.size(); ++i) covered &= twiceArea({face[0], face[i], face[i + 1]}) > 0;
    return covered;
  };
  test::expectCaught("mesh files: a fan across a concave face",
                     fan({notch[4], notch[5], notch[0], notch[1], notch[2], notch[3]}));
}

TEST(MeshFile, BrokenFilesAreRefusedWithAReason) {
  const Workspace w;
  const std::string box = obj(kCorners, kSides), text = stlText(kCorners, kSides), binary = stl(kCorners, kSides);
  const std::string valid = "; valid: OBJ (.obj), STL (.stl), PLY (.ply) and glTF (.gltf, .glb)";
  const std::string plyText = ply(kCorners, facesOf(kSides), Ply::text);
  const std::string plyBytes = ply(kCorners, facesOf(kSides), Ply::bigEndian);
  const auto changed = [](std::string bytes, const std::string& from, const std::string& to) {
    return bytes.replace(bytes.find(from), from.size(), to);
  };
  const std::string first = "v 0.000000 0.000000 0.000000";
  const auto triangle = [](const std::string& corner, const std::string& face) {
    return "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
           "element face 1\nproperty list int int vertex_indices\nend_header\n" +
           corner + "\n0 1 0\n0 0 1\n" + face + "\n";
  };
  struct Broken {
    std::string name, bytes, reason;
  };
  const std::vector<Broken> all = {
      {"x.fbx", box, ": '.fbx' is not a supported mesh format" + valid},
      {"x", box, ": '' is not a supported mesh format" + valid},
      {"x.obj", "", ": is empty" + valid},
      {"x.stl", "", ": is empty" + valid},
      {"x.obj", "hello\nworld\n", ": has no faces ('f'); valid: a surface of triangles or larger faces"},
      {"x.obj", obj(kCorners, {}), ": has no faces ('f'); valid: a surface of triangles or larger faces"},
      {"x.obj", changed(box, first, "v nan 0 0"), ":1: the coordinate nan; valid: finite, as a number of 32 bits"},
      {"x.obj", changed(box, first, "v 0 0 1e39"), ":1: the coordinate 1e39; valid: finite, as a number of 32 bits"},
      {"x.obj", changed(box, first, "v 0 0"), ":1: a point of 2 numbers; valid: 3"},
      {"x.obj", changed(box, first, "v a b c"), ":1: 'a' is not a coordinate; valid: a number"},
      {"x.obj", box + "l 1 2\n", ":21: a separate line or point ('l'); valid: faces"},
      {"x.obj", changed(box, first, "v 0 0 0 1 1"), ":1: a point of 5 numbers; valid: 3"},
      {"x.obj", changed(box, first, "v 0 0 0 0"), ":1: a point of weight 0; valid: another number"},
      {"x.obj", box + "f 1 2\n", ":21: a face of 2 corners; valid: 3 to 256"},
      {"x.obj", box + "f 1 2 9\n", ":21: unknown point 9; valid: 1 to 8, or negative, from the last one back"},
      {"x.obj", box + "f 0 1 2\n", ":21: unknown point 0; valid: 1 to 8, or negative, from the last one back"},
      {"x.obj", box + "f -9 1 2\n", ":21: unknown point -9; valid: 1 to 8, or negative, from the last one back"},
      {"x.obj", box + "f 1 2 x\n", ":21: 'x' is not a corner; valid: the number of a point"},
      {"x.obj", box + "f 1 2 3 4\n", ":21: a face whose sides 2 and 4 cross or touch; valid: a simple polygon"},
      {"x.obj", box + "f 1 3 4 2 1 3 4 2\n", ":21: a face whose sides 1 and 4 cross or touch; valid: a simple polygon"},
      {"x.ply", "solid", ":1: does not begin with 'ply'; valid: a PLY file"},
      {"x.ply", "ply\nformat x 1.0\nend_header\n",
       ":3: its format is 'x'; valid: ascii, binary_little_endian, binary_big_endian"},
      {"x.ply", changed(plyText, "vertex 8", "vertex 8888888"), ": more than 1000000 'vertex'; valid: a coarser mesh"},
      {"x.ply", changed(plyText, "float x", "half x"),
       ":6: 'half' is not a type; valid: char, uchar, short, ushort, int, uint, float, double"},
      {"x.ply", changed(plyText, "float x", "float u"), ":12: its 'vertex' has no x, y and z; valid: all three"},
      {"x.ply", plyText.substr(0, plyText.size() - 20), ":31: is cut off; valid: the elements of its header"},
      {"x.ply", plyText + "1\n", ":33: has more than its header says; valid: the elements of its header"},
      {"x.ply", plyBytes + "1", ": has more than its header says; valid: the elements of its header"},
      {"x.ply", plyBytes.substr(0, plyBytes.size() - 1), ": is cut off; valid: the elements of its header"},
      {"x.ply", ply(kCorners, {{0, 1, 9}}, Ply::bigEndian), ": face 0: unknown point 9; valid: 0 to 7"},
      {"x.ply", ply(kCorners, {{0, 1}}, Ply::bigEndian), ": face 0 has 2 corners; valid: 3 to 256"},
      {"x.ply", ply(kCorners, {{0, 1, 2, 3}}, Ply::bigEndian),
       ": face 0: a face whose sides 2 and 4 cross or touch; valid: a simple polygon"},
      {"x.ply", triangle("1e999 0 0", "3 0 1 2"), ":10: the coordinate inf; valid: finite, as a number of 32 bits"},
      {"x.ply", triangle("-1e999 0 0", "3 0 1 2"), ":10: the coordinate -inf; valid: finite, as a number of 32 bits"},
      {"x.ply", triangle("1 0 0", "2.5 0 1 2"), ":13: a list of 2.5 items; valid: a whole number from 0 to 999999999"},
      {"x.ply", triangle("1 0 0", "-3 0 1 2"), ":13: a list of -3 items; valid: a whole number from 0 to 999999999"},
      {"x.ply", triangle("1 0 0", "1e999 0 1 2"),
       ":13: a list of inf items; valid: a whole number from 0 to 999999999"},
      {"x.ply", ply(kCorners, {}, Ply::text), ": has no faces; valid: a surface of triangles or larger faces"},
      {"x.obj",
       box + "f" +
           [] {
             std::string s;
             for (int i = 0; i < 257; ++i) s += " 1";
             return s;
           }() +
           "\n",
       ":21: a face of 257 corners; valid: 3 to 256"},
      {"x.stl", binary.substr(0, binary.size() - 60),
       ": its header says 12 triangles, but the file has 624 bytes; valid: 84 and 50 for each triangle"},
      {"x.stl", stl(kCorners, kSides, 4294967295u),
       ": its header says 4294967295 triangles, but the file has 684 bytes; valid: 84 and 50 for each triangle"},
      {"x.stl", stl(kCorners, {}), ": has no triangles; valid: a surface of them"},
      {"x.stl", "not a mesh",
       ": has 10 bytes, fewer than the header of a binary STL; valid: 84 and 50 for each triangle, or a text that "
       "begins with 'solid'"},
      {"x.stl", text.substr(0, text.find("endfacet", text.size() / 2)),
       ": is cut off: 7 'facet' and 6 'endfacet', 1 'solid' and 0 'endsolid'; valid: as many of each"},
      {"x.stl", "solid x\nendsolid x\n", ": has no triangles ('facet'); valid: a surface of them"},
      {"x.stl", changed(text, "vertex 0.000000 0.000000 0.000000\n", ""), ":7: a 'facet' of 2 'vertex'; valid: 3"},
      {"x.stl", changed(text, "vertex 0.000000", "vertex -inf"),
       ":4: the coordinate -inf; valid: finite, as a number of 32 bits"},
      {"x.stl", stl({{0, 0, 0}, {1, 0, 0}, {0, std::numeric_limits<Real>::quiet_NaN(), 0}}, {{0, 1, 2}}),
       ": a coordinate is not finite; valid: numbers"}};
  for (const Broken& b : all) EXPECT_EQ(said(w, b.name, b.bytes), b.reason) << b.bytes.substr(0, 400);
  EXPECT_THROW(meshBytes(w.path("absent.obj")), UserError);
  EXPECT_THROW(meshBytes("/dev/zero.obj"), UserError);
  std::filesystem::create_directory(w.path("folder.obj"));
  EXPECT_THROW(meshBytes(w.path("folder.obj")), UserError);
}

// Rejected before reading: ten million points take neither time nor memory.
TEST(MeshFile, LargeFilesAreRefusedBeforeReading) {
  const Workspace w;
  const std::string path = w.write("large.obj", "v 0 0 0\n");
  std::filesystem::resize_file(path, std::uintmax_t{10000000} * 30);
  try {
    meshBytes(path);
    ADD_FAILURE();
  } catch (const UserError& e) {
    EXPECT_EQ(std::string(e.what()), path + ": has 286 MiB; valid: up to 64");
  }
  std::string many;
  for (long i = 0; i <= kMostMeshItems; ++i) many += "v 0 0 0\n";
  EXPECT_EQ(said(w, "many.obj", many), ": more than 1000000 points; valid: a coarser mesh");
  many.clear();
  for (long i = 0; i <= kMostMeshItems; ++i) many += "f 1 1 1\n";
  EXPECT_EQ(said(w, "faces.obj", many), ": more than 1000000 triangles; valid: a coarser mesh");
}

// Any length and any byte: rejected with a one-line message, or read.
TEST(MeshFile, DamageIsRefusedInOneLineOrHarmless) {
  const Workspace w;
  const std::pair<const char*, std::string> files[] = {{"d.obj", obj(kCorners, kSides)},
                                                       {"d.stl", stlText(kCorners, kSides)},
                                                       {"e.stl", stl(kCorners, kSides)},
                                                       {"d.ply", ply(kCorners, facesOf(kSides), Ply::text)},
                                                       {"e.ply", ply(kCorners, facesOf(kSides), Ply::bigEndian)},
                                                       {"d.glb", glb(kCorners, kSides, "")}};
  int refused = 0, read = 0;
  const auto look = [&](const char* name, const std::string& bytes) {
    ++(said(w, name, bytes).empty() ? read : refused);
  };
  for (const auto& [name, bytes] : files) {
    for (std::size_t i = 0; i < 20; ++i) {
      const std::size_t at = (2 * i + 1) * bytes.size() / 40;
      look(name, bytes.substr(0, at));
      std::string flipped = bytes;
      flipped[at] = static_cast<char>(flipped[at] ^ (1 << i % 7));
      look(name, flipped);
    }
  }
  EXPECT_GT(refused, 40);
  EXPECT_GT(read, 10);
}

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::mesh_file_test
