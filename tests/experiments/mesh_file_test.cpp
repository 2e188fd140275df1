// SPDX-License-Identifier: Zlib
// Shapes from OBJ and STL: a written file reads back equal, a broken one is rejected with a one-line reason, and a
// changed file is another trial.
#include "experiments/trial/formats/mesh_file.h"

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "experiments/parse/toml_reader.h"
#include "experiments/runner/trial_plan.h"
#include "experiments/trial/scene/scene_file.h"
#include "framework/shape/mass.h"
#include "tests/expect_caught.h"
#include "tests/experiments/workspace.h"

namespace lpc { inline namespace LPC_PRECISION { namespace mesh_file_test { namespace {

using test::Workspace;
using Triangles = std::vector<std::array<int, 3>>;

const std::string kNoLibrary = "this build has no assimp";

/// 1 x 2 x 3 m from the origin; corners numbered from 0, x slowest.
const std::vector<Vec<3>> kCorners = {{0, 0, 0}, {0, 0, 3}, {0, 2, 0}, {0, 2, 3},
                                      {1, 0, 0}, {1, 0, 3}, {1, 2, 0}, {1, 2, 3}};
const Triangles kSides = {{0, 1, 3}, {0, 3, 2}, {4, 6, 7}, {4, 7, 5}, {0, 4, 5}, {0, 5, 1},
                          {2, 3, 7}, {2, 7, 6}, {0, 2, 6}, {0, 6, 4}, {1, 5, 7}, {1, 7, 3}};

std::string numbersOf(const Vec<3>& p) {
  return std::to_string(p[0]) + " " + std::to_string(p[1]) + " " + std::to_string(p[2]);
}

std::string obj(const std::vector<Vec<3>>& points, const Triangles& triangles) {
  std::string out;
  for (const Vec<3>& p : points) out += "v " + numbersOf(p) + "\n";
  for (const auto& [a, b, c] : triangles) {
    out += "f " + std::to_string(a + 1) + " " + std::to_string(b + 1) + " " + std::to_string(c + 1) + "\n";
  }
  return out;
}

std::string stlText(const std::vector<Vec<3>>& points, const Triangles& triangles) {
  std::string out = "solid x\n";
  for (const auto& t : triangles) {
    out += "facet normal 0 0 0\nouter loop\n";
    for (const int i : t) out += "vertex " + numbersOf(points[static_cast<std::size_t>(i)]) + "\n";
    out += "endloop\nendfacet\n";
  }
  return out + "endsolid x\n";
}

std::string stl(const std::vector<Vec<3>>& points, const Triangles& triangles, std::uint32_t told) {
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
std::string stl(const std::vector<Vec<3>>& points, const Triangles& triangles) {
  return stl(points, triangles, static_cast<std::uint32_t>(triangles.size()));
}

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

bool isThere(const Workspace& w) {
  return said(w, "probe.obj", obj(kCorners, kSides)).find(kNoLibrary) == std::string::npos;
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

TEST(MeshFile, EveryFormatHoldsTheSameTriangles) {
  const Workspace w;
  if (!isThere(w)) GTEST_SKIP() << "assimp is absent";
  const std::pair<const char*, std::string> files[] = {
      {"a.obj", obj(kCorners, kSides)}, {"a.stl", stlText(kCorners, kSides)}, {"A.STL", stl(kCorners, kSides)}};
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

TEST(MeshFile, BrokenFilesAreRefusedWithAReason) {
  const Workspace w;
  if (!isThere(w)) GTEST_SKIP() << "assimp is absent";
  const std::string box = obj(kCorners, kSides), text = stlText(kCorners, kSides), binary = stl(kCorners, kSides);
  const std::string valid = "; valid: OBJ (.obj) and STL (.stl), as text or binary";
  const auto changed = [](std::string bytes, const std::string& from, const std::string& to) {
    return bytes.replace(bytes.find(from), from.size(), to);
  };
  const std::string first = "v 0.000000 0.000000 0.000000";
  struct Broken {
    std::string name, bytes, reason;
  };
  const std::vector<Broken> all = {
      {"x.ply", box, ": '.ply' is not a supported mesh format" + valid},
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
      {"x.obj", box + "f 1 2\n", ": a face of 2 corners; valid: three or more"},
      {"x.obj", box + "f 1 2 9\n", ": cannot be read: OBJ: vertex index out of range" + valid},
      {"x.obj", box + "f 0 1 2\n", ": cannot be read: OBJ: Invalid face index." + valid},
      {"x.obj",
       box + "f" +
           [] {
             std::string s;
             for (int i = 0; i < 257; ++i) s += " 1";
             return s;
           }() +
           "\n",
       ":21: a face of 257 corners; valid: up to 256"},
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
      {"x.stl", changed(text, "vertex 0.000000 0.000000 0.000000\n", ""),
       ": has 35 'vertex' in 12 'facet'; valid: three in each"},
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
  if (!isThere(w)) GTEST_SKIP() << "assimp is absent";
  const std::pair<const char*, std::string> files[] = {
      {"d.obj", obj(kCorners, kSides)}, {"d.stl", stlText(kCorners, kSides)}, {"e.stl", stl(kCorners, kSides)}};
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

// --- in scenes ------------------------------------------------------------------------------------------------------

std::string scene(const std::string& shape, const std::string& dimensions = "[3]") {
  return "name = \"t\"\nsummary = \"s\"\ndimensions = " + dimensions + "\n[[body]]\nshapes = [{ kind = \"polytope\", " +
         shape + " }]\n";
}

template <int D>
std::string sceneSays(const Workspace& w, const std::string& text) {
  try {
    SceneFile::parse(text, w.path("t.toml")).build<D>({}, 1);
  } catch (const UserError& e) {
    const std::string what = e.what();
    EXPECT_EQ(std::count(what.begin(), what.end(), '\n'), 0) << what;
    return what.substr(w.path("").size());
  }
  return "";
}

// An L in the x-y plane, extruded by 1 m along z, as a closed surface.
const std::vector<Vec<3>> kLetter = {{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0},
                                     {0, 0, 1}, {2, 0, 1}, {2, 1, 1}, {1, 1, 1}, {1, 2, 1}, {0, 2, 1}};
const Triangles kLetterSides = {{0, 2, 1},   {0, 3, 2},  {0, 5, 3},  {3, 5, 4},   {6, 7, 8}, {6, 8, 9}, {6, 9, 11},
                                {9, 10, 11}, {0, 1, 7},  {0, 7, 6},  {1, 2, 8},   {1, 8, 7}, {2, 3, 9}, {2, 9, 8},
                                {3, 4, 10},  {3, 10, 9}, {4, 5, 11}, {4, 11, 10}, {5, 0, 6}, {5, 6, 11}};

TEST(MeshFile, ABodyIsTheHullOfItsFile) {
  const Workspace w;
  if (!isThere(w)) GTEST_SKIP() << "assimp is absent";
  w.write("box.stl", stl(kCorners, kSides));
  w.write("letter.obj", obj(kLetter, kLetterSides));
  const auto massOf = [&](const std::string& shape) {
    const auto spec = SceneFile::parse(scene(shape), w.path("t.toml")).build<3>({}, 1);
    return massProperties(spec.spawns.at(0).body.shapes.at(0).shape, Real(1)).mass;
  };
  EXPECT_NEAR(massOf("file = \"box.stl\""), 6, 1e-12);
  EXPECT_NEAR(massOf("file = \"box.stl\", scale = \"1 / 2\""), 0.75, 1e-12);
  EXPECT_NEAR(massOf("file = \"letter.obj\", hull = true"), 3.5, 1e-12);
  // One hull for all iterations of a block.
  const std::string many = scene("file = \"box.stl\"") + "repeat = 2000\n";
  const auto spec = SceneFile::parse(many, w.path("t.toml")).build<3>({}, 1);
  EXPECT_EQ(spec.spawns.at(0).body.shapes.at(0).shape.view().hull,
            spec.spawns.back().body.shapes.at(0).shape.view().hull);
}

TEST(MeshFile, UnsuitableMeshesOfBodiesAreRefusedWithAdvice) {
  const Workspace w;
  if (!isThere(w)) GTEST_SKIP() << "assimp is absent";
  const std::string advice =
      "; valid: hull = true, its hull; a compound of convex parts; or kind = \"mesh\" on a fixed body";
  Triangles open = kSides;
  open.resize(10);
  std::vector<Vec<3>> dented = kCorners;
  dented.push_back({0.5, 1.999, 1.5});
  const Triangles withDent = {{0, 1, 3}, {0, 3, 2}, {4, 6, 7}, {4, 7, 5}, {0, 4, 5}, {0, 5, 1}, {2, 3, 8},
                              {3, 7, 8}, {7, 6, 8}, {6, 2, 8}, {0, 2, 6}, {0, 6, 4}, {1, 5, 7}, {1, 7, 3}};
  w.write("box.obj", obj(kCorners, kSides)), w.write("letter.obj", obj(kLetter, kLetterSides));
  w.write("open.obj", obj(kCorners, open)), w.write("flat.obj", obj(kCorners, {{0, 1, 3}, {0, 3, 2}}));
  w.write("dented.stl", stl(dented, withDent)), w.write("cut.stl", stl(kCorners, kSides).substr(0, 300));
  struct Case {
    std::string shape, reason;
  };
  const Case cases[] = {
      {"file = \"letter.obj\"", "t.toml:5: polytope: letter.obj is not convex: its triangle 13 lies 0.707106"},
      {"file = \"dented.stl\"", "t.toml:5: polytope: dented.stl is not convex: its triangle 7 lies 0.00"},
      {"file = \"flat.obj\"", "t.toml:5: polytope: convex hull: all points lie in one plane within rounding"},
      {"file = \"open.obj\"",
       "t.toml:5: polytope: open.obj is not a closed surface: its triangles have 20 m2, those of its hull 22; valid: a "
       "surface "
       "without holes and without faces that lie on each other, or hull = true"},
      {"file = \"absent.obj\"",
       "t.toml:5: " + w.path("absent.obj") + ": the file does not exist; valid: a path relative to the scene's folder"},
      {"file = \"cut.stl\"",
       "t.toml:5: " + w.path("cut.stl") +
           ": its header says 12 triangles, but the file has 300 bytes; valid: 84 and 50 for each triangle"},
      {"file = \"box.obj\", scale = 0", "t.toml:5: 'scale' is 0; valid: above 0"},
      {"file = \"box.obj\", points = [[0, 0]]", "t.toml:5: 'file' and 'points' are both given; valid: one of them"},
      {"file = 3", "t.toml:5: "},
      {"file = \"box.obj\", depth = 1", "t.toml:5: "}};
  for (const Case& c : cases) {
    const std::string says = sceneSays<3>(w, scene(c.shape));
    EXPECT_TRUE(says.starts_with(c.reason)) << says << "\n" << c.reason;
    EXPECT_EQ(says.find(" is not convex") != says.npos, says.ends_with(advice)) << says;
  }
  EXPECT_EQ(sceneSays<2>(w, scene("file = \"box.obj\"", "[2, 3]")),
            "t.toml:5: 'file' needs a 3D scene; valid: 'points', or dimensions = [3]");
  EXPECT_EQ(sceneSays<2>(w, scene("file = \"box.obj\"", "[2, 3]") + "repeat = 0\n"), "");
}

// The L cannot be a dynamic body, but can be ground, with its concave edge.
TEST(MeshFile, GroundKeepsTheFilesTriangles) {
  const Workspace w;
  if (!isThere(w)) GTEST_SKIP() << "assimp is absent";
  w.write("letter.obj", obj(kLetter, kLetterSides));
  const auto ground = [](const std::string& rest, const std::string& dimensions = "[3]") {
    return "name = \"t\"\nsummary = \"s\"\ndimensions = " + dimensions + "\n[[body]]\n" + rest +
           "shapes = [{ kind = \"mesh\", file = \"letter.obj\", scale = 2 }]\n";
  };
  const auto spec = SceneFile::parse(ground("type = \"fixed\"\n"), w.path("t.toml")).build<3>({}, 1);
  const Shape<3>& shape = spec.spawns.at(0).body.shapes.at(0).shape;
  long triangles = 0;
  forParts(shape, Pose<3>{}, [&](const ShapeView<3>& part, const Pose<3>&) { triangles += part.hull != nullptr; });
  EXPECT_EQ(triangles, static_cast<long>(kLetterSides.size()));
  const Aabb<3> box = boundingBox(shape, Pose<3>{});
  EXPECT_EQ(box.hi, Vec<3>(4, 4, 2));
  EXPECT_NE(sceneSays<3>(w, ground("") + "[[body]]\nshapes = [{ kind = \"sphere\", radius = 1 }]\n").find("t.toml"),
            std::string::npos);
  EXPECT_NE(sceneSays<2>(w, ground("type = \"fixed\"\n", "[2, 3]")).find("t.toml"), std::string::npos);
}

// All points lie on the hull, but a valley lies where the hull has a ridge.
TEST(MeshFile, AValleyBetweenPointsOfTheHullIsSeen) {
  std::vector<Vec<3>> raised = kCorners;
  raised[7][1] = Real(2.5);
  Triangles ridge = kSides, valley = kSides;
  valley[6] = {2, 3, 6}, valley[7] = {3, 7, 6};
  const auto hull = convexHull(std::span<const Vec<3>>(raised));
  EXPECT_EQ(hull->vertices.size(), 8u);
  EXPECT_NO_THROW(requireConvex({raised, ridge}, *hull, "ridge"));
  EXPECT_THROW(requireConvex({raised, valley}, *hull, "valley"), UserError);
  const auto pointsAlone = [&](const MeshFile& mesh) {
    for (const Vec<3>& p : mesh.points) {
      Real depth = 1;
      for (const auto& face : hull->faces) depth = std::min(depth, face.offset - face.normal.dot(p));
      if (depth > Real(1e-9)) throw UserError("not convex");
    }
  };
  const auto refuses = [](auto&& check) {
    try {
      check();
    } catch (const UserError&) {
      return true;
    }
    return false;
  };
  test::expectCaught("mesh files: points on the hull, whatever is between them", refuses([&] {
                       pointsAlone({raised, valley});
                     }));
}

TEST(MeshFile, AnotherFileIsAnotherTrial) {
  const Workspace w;
  if (!isThere(w)) GTEST_SKIP() << "assimp is absent";
  const std::string path = w.write("t.toml", scene("file = \"box.obj\""));
  const auto follows = [&](auto&& key) {
    w.write("box.obj", obj(kCorners, kSides));
    const std::string before = key(), again = key();
    w.write("box.obj", obj(kCorners, kSides) + "# a comment\n");
    return before == again && key() != before;
  };
  EXPECT_TRUE(follows([&] { return Planner().world(path, {}).key; }));
  test::expectCaught("mesh files: a key of the scene's own bytes", follows([&] { return readFile(path); }));
}

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::mesh_file_test
