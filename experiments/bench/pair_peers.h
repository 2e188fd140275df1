// SPDX-License-Identifier: Zlib
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "experiments/bench/pair_data.h"

namespace lpc { inline namespace LPC_PRECISION { namespace bench {

/// Another library's contacts of our pairs, with all possible preparation done before.
class PairPeer {
 public:
  virtual ~PairPeer() = default;
  /// Queries all pairs; returns how many overlap.
  virtual int run() = 0;
};

struct PairPeerEntry {
  std::string name;
  std::vector<ShapeKind> kinds;  // of both shapes
  std::function<std::unique_ptr<PairPeer>(const PairData<3>&)> create;
};
std::vector<PairPeerEntry>& pairPeers();

struct PairPeerRegistrar {
  explicit PairPeerRegistrar(PairPeerEntry entry) { pairPeers().push_back(std::move(entry)); }
};

}}}  // namespace lpc::LPC_PRECISION::bench
