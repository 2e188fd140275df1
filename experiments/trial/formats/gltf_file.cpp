// SPDX-License-Identifier: Zlib
// Meshes from glTF, text (.gltf) or binary (.glb), read by assimp: all meshes of the scene at the poses of their nodes.
// A file may name others, such as buffers and textures: none is opened, since a trial's key holds this file alone.
#include <dlfcn.h>
#include <sys/resource.h>

#include <cstdint>
#include <cstring>
#include <filesystem>

#include "experiments/trial/formats/library_process.h"
#include "experiments/trial/formats/mesh_formats.h"
#include "framework/math/names.h"

#ifdef LPC_ASSIMP
#include <assimp/cimport.h>
#include <assimp/scene.h>
#endif

namespace lpc { inline namespace LPC_PRECISION {
namespace {

#ifdef LPC_ASSIMP

template <class F>
F* ofAssimp(const char* name) {
  static void* const loaded = dlopen(LPC_ASSIMP, RTLD_NOW | RTLD_LOCAL);
  void* const at = loaded ? dlsym(loaded, name) : nullptr;
  if (!at) throw UserError("assimp cannot be loaded: " + std::string(dlerror()));
  return reinterpret_cast<F*>(at);
}
#define LPC_OF_ASSIMP(function) ofAssimp<decltype(function)>(#function)

void addNode(const aiScene& scene, const aiNode& node, const aiMatrix4x4& X_WParent, std::string& out) {
  const aiMatrix4x4 X_WNode = X_WParent * node.mTransformation;
  const bool mirrored = X_WNode.Determinant() < 0;  // glTF: then corners run the other way round
  for (unsigned m = 0; m < node.mNumMeshes; ++m) {
    const aiMesh& mesh = *scene.mMeshes[node.mMeshes[m]];
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      if (face.mNumIndices != 3) {
        throw UserError("a face of " + std::to_string(face.mNumIndices) + " corners; valid: triangles");
      }
      for (const unsigned k : {0u, mirrored ? 2u : 1u, mirrored ? 1u : 2u}) {
        const aiVector3D p = X_WNode * mesh.mVertices[face.mIndices[k]];
        const MeshCorner corner = {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
        out.append(reinterpret_cast<const char*>(corner.data()), sizeof corner);
      }
    }
    requireFew(static_cast<long>(out.size() / (3 * sizeof(MeshCorner))), "triangles", "it has");
  }
  for (unsigned i = 0; i < node.mNumChildren; ++i) addNode(scene, *node.mChildren[i], X_WNode, out);
}

/// Called in a child process.
std::string cornersByAssimp(const std::string& bytes, const std::string& ending) {
  const auto import = LPC_OF_ASSIMP(aiImportFileFromMemory);
#if !defined(LPC_SANITIZED)  // AddressSanitizer reads /proc/self/maps when assimp throws, and aborts if it cannot
  const rlimit none{0, 0};
  setrlimit(RLIMIT_NOFILE, &none);
#endif
  const aiScene* scene = import(bytes.data(), static_cast<unsigned>(bytes.size()), 0, ending.c_str());
  if (!scene || !scene->mRootNode) {
    const std::string said = oneLine(LPC_OF_ASSIMP(aiGetErrorString)());
    throw UserError("cannot be read: " + said.substr(0, 200) + "; valid: glTF 2.0 with its buffers in the file");
  }
  std::string out;
  addNode(*scene, *scene->mRootNode, aiMatrix4x4(), out);
  return out;
}

#else

std::string cornersByAssimp(const std::string&, const std::string&) {
  throw UserError("this build has no assimp; valid: a build with libassimp-dev, or OBJ, STL or PLY");
}

#endif

}  // namespace

MeshFaces readGltf(const std::string& bytes, const std::string& path) {
  const bool binary = bytes.starts_with("glTF");
  std::uint32_t told = 0;  // bytes of the whole file
  constexpr std::size_t kToldAt = 8;
  if (binary && bytes.size() >= kToldAt + sizeof told) std::memcpy(&told, bytes.data() + kToldAt, sizeof told);
  if (binary && told != bytes.size()) {
    refuseMesh(path, "its header says " + std::to_string(told) + " bytes, but the file has " +
                         std::to_string(bytes.size()) + "; valid: equal numbers");
  }
  const std::string read =
      inItsProcess("assimp", path, [&] { return cornersByAssimp(bytes, binary ? "glb" : "gltf"); });
  MeshFaces out;
  out.points.resize(read.size() / sizeof(MeshCorner));
  std::memcpy(out.points.data(), read.data(), out.points.size() * sizeof(MeshCorner));
  for (std::size_t i = 0; i < out.points.size(); ++i) out.corners.push_back(static_cast<int>(i));
  for (std::size_t i = 0; i + 3 <= out.points.size(); i += 3) out.faces.push_back({i, i + 3, 0});
  return out;
}

}}  // namespace lpc::LPC_PRECISION
