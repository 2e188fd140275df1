// SPDX-License-Identifier: Zlib
// Shapes of scene files in files of their own.
#include <filesystem>
#include <functional>

#include "experiments/trial/scene/scene_parsed.h"

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
  if (shape.find("points")) shape.fail("it has 'file' and 'points'; valid: one of them");
  // Of a table that readMeshes did not take for a shape.
  if (!numbers.meshes.count(name))
    shape.fail("'file' is of no shape that has one; valid: kind = \"polytope\", \"mesh\"");
  return name;
}

double scaleOf(TableReader& shape, SceneNumbers& numbers) {
  const double scale = numbers.number(shape, "scale", 1);
  if (scale > 0 || numbers.rehearsing()) return scale;
  shape.fail(*shape.find("scale"), "'scale' is " + asText(scale) + "; valid: above 0");
}

MeshFile scaled(MeshFile mesh, double scale) {
  for (Vec<3>& p : mesh.points) p *= static_cast<Real>(scale);
  return mesh;
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

MeshFile readMesh(TableReader& shape, SceneNumbers& numbers) {
  const std::string name = fileOf(shape, numbers);
  const double scale = scaleOf(shape, numbers);
  if (numbers.rehearsing()) return {};
  MeshFile mesh = scaled(numbers.meshes.at(name).mesh, scale);
  numbers.count(*shape.find("file"), "points", static_cast<long>(mesh.points.size()));
  return mesh;
}

template <int D>
Shape<D> readHull(TableReader& shape, SceneNumbers& numbers, Real rounding) {
  const std::string name = fileOf(shape, numbers);
  const double scale = scaleOf(shape, numbers);
  const bool filled = shape.flag("hull", false);
  if (numbers.rehearsing()) return {};
  if constexpr (D == 2) {
    (void)filled, (void)rounding;
    shape.fail(*shape.find("file"), "a file is of a mesh in 3D; valid: 'points', or a scene of dimensions = [3]");
  } else {
    std::shared_ptr<const Polytope<3>>& hull = numbers.hulls[{name, scale, filled}];
    if (!hull) {
      const MeshFile mesh = readMesh(shape, numbers);
      if (mesh.points.size() > kMostHullPoints) {
        throw UserError(name + " has " + std::to_string(mesh.points.size()) + " points; valid of a hull: up to " +
                        std::to_string(kMostHullPoints));
      }
      hull = convexHull(std::span<const Vec<3>>(mesh.points));
      if (!filled) requireConvex(mesh, *hull, name);
    }
    return Shape<D>::polytope(hull, rounding);
  }
}

template Shape<2> readHull(TableReader&, SceneNumbers&, Real);
template Shape<3> readHull(TableReader&, SceneNumbers&, Real);

}}  // namespace lpc::LPC_PRECISION
