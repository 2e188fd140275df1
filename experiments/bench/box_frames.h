// SPDX-License-Identifier: Zlib
#pragma once

#include <string_view>
#include <vector>

#include "framework/stage/stage_broadphase.h"

namespace lpc { inline namespace LPC_PRECISION { namespace bench {

/// Inputs of the broadphase comparison.
/// uniform  unit boxes in a square or cube, about 5 overlaps per box
/// cluster  max(8, n/200) round clusters, sizes from 0.1 to 10 m, uniform in the logarithm, 2.5 pairs per box
/// In each frame every box moves by 2 % of its mean size in its own direction, ten frames forward and ten back.
enum class BoxLayout { uniform, cluster };
inline constexpr std::string_view kBoxLayouts[] = {"uniform", "cluster"};

template <int D>
class BoxFrames {
 public:
  BoxFrames(BoxLayout layout, int count);

  const Proxies<D>& proxies() const { return m_proxies; }
  const std::vector<ProxyId>& all() const { return m_all; }
  void advance();
  /// All pairs of the present frame, sorted, by a sweep that uses no registered algorithm.
  std::vector<ProxyPair> pairs() const;

 private:
  Proxies<D> m_proxies;
  std::vector<Vec<D>> m_step;  // m per frame
  std::vector<ProxyId> m_all;
  int m_frame = 0;
};

/// A new copy of the frames; the layout itself is made once per size.
template <int D>
BoxFrames<D> boxFrames(BoxLayout layout, int count);

}}}  // namespace lpc::LPC_PRECISION::bench
