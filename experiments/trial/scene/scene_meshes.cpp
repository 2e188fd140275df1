// SPDX-License-Identifier: Zlib
// Points and surfaces of scene files, and shapes in files of their own.
#include <cmath>
#include <filesystem>
#include <functional>

#include "experiments/trial/scene/scene_parsed.h"
#include "framework/shape/flat_triangle.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

// Visits every table of the scene and its nested tables.
void walk(const toml::node& node, const std::function<void(const toml::table&)>& see) {
  if (const toml::table* t = node.as_table()) {
    see(*t);
    for (const auto& [key, inside] : *t) walk(inside, see);
  } else if (const toml::array* list = node.as_array()) {
    for (const toml::node& inside : *list) walk(inside, see);
  }
}

std::string fileOf(TableReader& shape, SceneNumbers& numbers) {
  const std::string name = shape.requireString("file");
  if (shape.find("points")) shape.fail("'file' and 'points' are both given; valid: one of them");
  // Of a table that readMeshes did not take for a shape.
  if (!numbers.meshes.count(name))
    shape.fail("'file' is not supported by this kind of shape; valid: kind = \"polytope\", \"mesh\"");
  return name;
}

/// A number, or one along each axis. Below 0: mirrored.
Eigen::Array3d scaleOf(TableReader& shape, SceneNumbers& numbers) {
  const toml::node* const given = shape.find("scale");
  Eigen::Array3d scale = Eigen::Array3d::Ones();
  if (const toml::array* const list = given ? given->as_array() : nullptr) {
    if (list->size() != 3) shape.fail(*given, "'scale' is " + describe(*given) + "; valid: a number, or three");
    for (std::size_t k = 0; k < 3; ++k) scale[static_cast<int>(k)] = numbers.number(*list->get(k));
  } else {
    scale.setConstant(numbers.number(shape, "scale", 1));
  }
  if (numbers.rehearsing() || (scale != 0).all()) return scale;
  shape.fail(*given, "'scale' is 0; valid: below or above 0");
}

MeshFile scaled(MeshFile mesh, const Eigen::Array3d& scale) {
  for (Vec<3>& p : mesh.points) p.array() *= scale.cast<Real>();
  if (scale.prod() < 0) {  // a mirror reverses the winding
    for (std::array<int, 3>& t : mesh.triangles) std::swap(t[1], t[2]);
  }
  return mesh;
}

MeshFile readMesh(TableReader& shape, SceneNumbers& numbers) {
  const std::string name = fileOf(shape, numbers);
  const Eigen::Array3d scale = scaleOf(shape, numbers);
  if (numbers.rehearsing()) return {};
  MeshFile mesh = scaled(numbers.meshes.at(name).mesh, scale);
  numbers.count(*shape.find("file"), "points", static_cast<long>(mesh.points.size()));
  return mesh;
}

// The mesh of the triangles that have an area; at most `most` others may be dropped.
Shape<3> withArea(const std::vector<Vec<3>>& points, const std::vector<std::array<int, 3>>& triangles, long most) {
  std::vector<std::array<int, 3>> kept;
  std::size_t first = triangles.size();
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    std::array<Vec<3>, 3> p;
    for (std::size_t k = 0; k < 3; ++k) p[k] = points[static_cast<std::size_t>(triangles[i][k])];
    hasArea(p) ? kept.push_back(triangles[i]) : void(first = std::min(first, i));
  }
  const auto dropped = static_cast<long>(triangles.size() - kept.size());
  if (dropped > most) {
    throw UserError("mesh: " + std::to_string(dropped) + " of " + std::to_string(triangles.size()) +
                    " triangles have corners on one line within rounding, the first is triangle " +
                    std::to_string(first) + "; valid: drop_flat = " + std::to_string(dropped) +
                    ", or triangles with area");
  }
  return Shape<3>::mesh(points, kept);
}

}  // namespace

SceneMeshes readMeshes(const toml::table& scene, const std::string& path) {
  SceneMeshes out;
  walk(scene, [&](const toml::table& table) {
    const std::string kind = table["kind"].value_or("");
    const auto name = table["file"].value<std::string>();
    if (!name || (kind != "polytope" && kind != "mesh") || out.count(*name)) return;
    const std::string from = (std::filesystem::path(path).parent_path() / *name).string();
    try {
      SceneMesh read{meshBytes(from), {}};
      read.mesh = parseMesh(read.bytes, from);
      out.emplace(*name, std::move(read));
    } catch (const UserError& e) {
      failAt(path, *table.get("file"), e.what());
    }
  });
  return out;
}

template <int D>
std::vector<Vec<D>> readPoints(TableReader& shape, SceneNumbers& numbers) {
  const toml::node& list = shape.require("points");
  if (!list.is_array()) shape.fail(list, "'points' is " + describe(list) + "; valid: a list of points");
  const double depth = numbers.between(shape, "depth", 0, 0, kLargest);
  numbers.count(list, "points", static_cast<long>(list.as_array()->size()));
  std::vector<Vec<D>> points;
  for (const toml::node& n : *list.as_array()) {
    Vec<D> p = numbers.vector<D>(n);
    if (D == 3 && depth > 0) {
      p[D - 1] = static_cast<Real>(-depth);
      points.push_back(p);
      p[D - 1] = static_cast<Real>(depth);
    }
    points.push_back(p);
  }
  return points;
}

template <int D>
Shape<D> readSurface(TableReader& shape, SceneNumbers& numbers) {
  const long most = numbers.whole(shape, "drop_flat", 0, 0, kMostMeshItems);
  if (D == 3 && shape.find("file")) {
    const MeshFile mesh = readMesh(shape, numbers);
    if (numbers.rehearsing()) return {};
    if constexpr (D == 3) return withArea(mesh.points, mesh.triangles, most);
  }
  const std::vector<Vec<D>> points = readPoints<D>(shape, numbers);
  const toml::node& list = shape.require("triangles");
  if (!list.is_array()) shape.fail(list, "'triangles' is " + describe(list) + "; valid: a list of three numbers each");
  numbers.count(list, "triangles", static_cast<long>(list.as_array()->size()));
  std::vector<std::array<int, 3>> triangles;
  for (const toml::node& n : *list.as_array()) {
    const toml::array* corners = n.as_array();
    if (!corners || corners->size() != 3) {
      shape.fail(n, "a triangle is " + describe(n) + "; valid: a list of three point numbers");
    }
    auto& triangle = triangles.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      const toml::node& corner = *corners->get(k);
      const double value =
          numbers.between(corner, "a corner", 0, std::max(0.0, static_cast<double>(points.size()) - 1));
      if (value != std::floor(value)) shape.fail(corner, "a corner is " + asText(value) + "; valid: whole numbers");
      triangle[k] = static_cast<int>(value);
    }
  }
  if (numbers.rehearsing()) return {};
  if constexpr (D == 3) {
    return withArea(points, triangles, most);
  } else {
    return Shape<D>::mesh(points, triangles);
  }
}

template <int D>
Shape<D> readHull(TableReader& shape, SceneNumbers& numbers, Real rounding) {
  const std::string name = fileOf(shape, numbers);
  const Eigen::Array3d scale = scaleOf(shape, numbers);
  const bool filled = shape.flag("hull", false);
  if (numbers.rehearsing()) return {};
  if constexpr (D == 2) {
    (void)filled, (void)rounding;
    shape.fail(*shape.find("file"), "'file' needs a 3D scene; valid: 'points', or dimensions = [3]");
  } else {
    std::shared_ptr<const Polytope<3>>& hull = numbers.hulls[{name, {scale[0], scale[1], scale[2]}, filled}];
    if (!hull) {
      const MeshFile mesh = readMesh(shape, numbers);
      if (mesh.points.size() > kMostHullPoints) {
        throw UserError(name + " has " + std::to_string(mesh.points.size()) + " points; valid for a hull: up to " +
                        std::to_string(kMostHullPoints));
      }
      hull = convexHull(std::span<const Vec<3>>(mesh.points));
      if (!filled) requireConvex(mesh, *hull, name);
    }
    return Shape<D>::polytope(hull, rounding);
  }
}

template std::vector<Vec<2>> readPoints(TableReader&, SceneNumbers&);
template std::vector<Vec<3>> readPoints(TableReader&, SceneNumbers&);
template Shape<2> readSurface(TableReader&, SceneNumbers&);
template Shape<3> readSurface(TableReader&, SceneNumbers&);
template Shape<2> readHull(TableReader&, SceneNumbers&, Real);
template Shape<3> readHull(TableReader&, SceneNumbers&, Real);

}}  // namespace lpc::LPC_PRECISION
