// SPDX-License-Identifier: Zlib
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "framework/stage/stage_broadphase.h"

namespace lpc { inline namespace LPC_PRECISION { namespace bench {

/// Another library's broadphase on our boxes. In 2D the third axis is [0, 1] for all.
class BoxPeer {
 public:
  virtual ~BoxPeer() = default;
  struct Box {
    std::array<double, 3> lo, hi;
  };
  virtual void build(const std::vector<Box>& boxes) = 0;
  /// Moves all boxes and appends all pairs that overlap now, a < b, old and new.
  virtual void frame(const std::vector<Box>& boxes, std::vector<ProxyPair>& out) = 0;
};

/// Linked peers register here, like algorithms in the registry.
struct BoxPeerEntry {
  std::string name;
  int most;  // largest number of boxes; beyond it, building takes minutes
  std::function<std::unique_ptr<BoxPeer>()> create;
};
std::vector<BoxPeerEntry>& boxPeers();

struct BoxPeerRegistrar {
  explicit BoxPeerRegistrar(BoxPeerEntry entry) { boxPeers().push_back(std::move(entry)); }
};

}}}  // namespace lpc::LPC_PRECISION::bench
