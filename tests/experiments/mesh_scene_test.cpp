// SPDX-License-Identifier: Zlib
// Shapes from mesh files in scenes: hulls, ground, scales and refusals; a changed file is another trial.
#include <algorithm>

#include "experiments/parse/toml_reader.h"
#include "experiments/runner/trial_plan.h"
#include "experiments/trial/formats/mesh_file.h"
#include "experiments/trial/scene/scene_file.h"
#include "framework/shape/mass.h"
#include "framework/shape/surface.h"
#include "tests/expect_caught.h"
#include "tests/experiments/mesh_bytes.h"
#include "tests/experiments/workspace.h"

namespace lpc { inline namespace LPC_PRECISION { namespace mesh_scene_test { namespace {

using test::Workspace;
using namespace test::mesh_bytes;

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
  w.write("box.stl", stl(kCorners, kSides));
  w.write("letter.obj", obj(kLetter, kLetterSides));
  const auto massOf = [&](const std::string& shape) {
    const auto spec = SceneFile::parse(scene(shape), w.path("t.toml")).build<3>({}, 1);
    return massProperties(spec.spawns.at(0).body.shapes.at(0).shape, Real(1)).mass;
  };
  EXPECT_NEAR(massOf("file = \"box.stl\""), 6, 1e-12);
  EXPECT_NEAR(massOf("file = \"box.stl\", scale = \"1 / 2\""), 0.75, 1e-12);
  EXPECT_NEAR(massOf("file = \"box.stl\", scale = [-1, 2, \"1 / 4\"]"), 3, 1e-12);
  EXPECT_NEAR(massOf("file = \"letter.obj\", hull = true"), 3.5, 1e-12);
  // One hull for all iterations of a block.
  const std::string many = scene("file = \"box.stl\"") + "repeat = 2000\n";
  const auto spec = SceneFile::parse(many, w.path("t.toml")).build<3>({}, 1);
  EXPECT_EQ(spec.spawns.at(0).body.shapes.at(0).shape.view().hull,
            spec.spawns.back().body.shapes.at(0).shape.view().hull);
}

TEST(MeshFile, UnsuitableMeshesOfBodiesAreRefusedWithAdvice) {
  const Workspace w;
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
      {"file = \"box.obj\", scale = 0", "t.toml:5: 'scale' is 0; valid: below or above 0"},
      {"file = \"box.obj\", scale = [1, 2]", "t.toml:5: 'scale' is "},
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

// Outside stays outside in a mirror: the volume under the triangles is that of the letter, 3 m3, times the scales.
TEST(MeshFile, MirroredGroundKeepsItsOutside) {
  const Workspace w;
  w.write("letter.obj", obj(kLetter, kLetterSides));
  for (const auto& [scale, volume] : {std::pair{"-1", 3.0}, {"[1, -2, 1]", 6.0}, {"[-1, -2, 0.5]", 3.0}}) {
    const std::string text =
        std::string("name = \"t\"\nsummary = \"s\"\ndimensions = [3]\n[[body]]\ntype = \"fixed\"\n") +
        "shapes = [{ kind = \"mesh\", file = \"letter.obj\", scale = " + scale + " }]\n";
    const auto spec = SceneFile::parse(text, w.path("t.toml")).build<3>({}, 1);
    const Surface<3>& surface = *spec.spawns.at(0).body.shapes.at(0).shape.surface();
    double sum = 0;
    for (const auto& [a, b, c] : surface.corners()) {
      const auto at = [&](int i) { return surface.points()[static_cast<std::size_t>(i)]; };
      sum += double(at(a).dot(at(b).cross(at(c)))) / 6;
    }
    EXPECT_NEAR(sum, volume, 1e-6) << scale;
  }
}

TEST(MeshFile, TrianglesWithoutAreaAreDroppedOnRequest) {
  const Workspace w;
  const std::string clean = obj(kLetter, kLetterSides);
  w.write("clean.obj", clean), w.write("letter.obj", clean + "f 1 1 2\nf 1 2 2 1\n");
  const auto ground = [&](const std::string& more, const std::string& file = "letter.obj") {
    return "name = \"t\"\nsummary = \"s\"\ndimensions = [3]\n[[body]]\ntype = \"fixed\"\n"
           "shapes = [{ kind = \"mesh\", file = \"" +
           file + "\"" + more + " }]\n";
  };
  for (const char* more : {"", ", drop_flat = 2"}) {
    EXPECT_EQ(sceneSays<3>(w, ground(more)),
              "t.toml:6: mesh: 3 of 23 triangles have corners on one line within rounding, the first is triangle 20; "
              "valid: drop_flat = 3, or triangles with area");
  }
  const auto trianglesOf = [&](const std::string& text) {
    const auto spec = SceneFile::parse(text, w.path("t.toml")).build<3>({}, 1);
    return spec.spawns.at(0).body.shapes.at(0).shape.surface()->corners();
  };
  EXPECT_EQ(trianglesOf(ground(", drop_flat = 3")), trianglesOf(ground("", "clean.obj")));
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
}}}  // namespace lpc::LPC_PRECISION::mesh_scene_test
