// SPDX-License-Identifier: Zlib
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "framework/shape/shape.h"

namespace lpc { inline namespace LPC_PRECISION { namespace bench {

/// Another library's contacts of our polygons, boxes and hulls of up to eight corners, in 2D. Two consecutive entries
/// are a pair.
class ManifoldPeer {
 public:
  virtual ~ManifoldPeer() = default;
  virtual void build(const std::vector<Shape<2>>& shapes, const std::vector<Pose<2>>& poses) = 0;
  /// Collides all pairs; the peer keeps the manifolds. Returns the number of points.
  virtual int collide() = 0;
};

/// Linked peers register here, like algorithms in the registry.
struct ManifoldPeerEntry {
  std::string name;
  std::function<std::unique_ptr<ManifoldPeer>()> create;
};
std::vector<ManifoldPeerEntry>& manifoldPeers();

struct ManifoldPeerRegistrar {
  explicit ManifoldPeerRegistrar(ManifoldPeerEntry entry) { manifoldPeers().push_back(std::move(entry)); }
};

}}}  // namespace lpc::LPC_PRECISION::bench
