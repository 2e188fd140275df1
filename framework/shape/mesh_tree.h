// SPDX-License-Identifier: Zlib
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "framework/math/aabb.h"
#include "framework/math/indexed.h"
#include "framework/math/work.h"

namespace lpc { inline namespace LPC_PRECISION {

/// A tree of fixed boxes, split at the median along the longest extent until a leaf has few boxes (Ericson 2005, 6.2).
/// Nodes are in preorder; each stores the index of the node after its subtree.
template <int D>
class MeshTree {
 public:
  explicit MeshTree(std::vector<Aabb<D>> boxes) : m_boxes(std::move(boxes)) {
    m_items.resize(m_boxes.size());
    for (std::size_t i = 0; i < m_items.size(); ++i) m_items[i] = static_cast<std::int32_t>(i);
    if (!m_items.empty()) build(0, m_items.size());
  }

  /// Indices of all boxes for which meets(box) is true, ascending. When `meets` is true for a box, it must be true for
  /// every box that contains this box.
  template <class Meets>
  void find(const Meets& meets, std::vector<std::int32_t>& out, WorkDone& work) const {
    out.clear();
    for (std::size_t i = 0; i < m_nodes.size();) {
      const Node& node = m_nodes[i];
      ++work[WorkCount::nodeVisits];
      if (!meets(node.box)) {
        i = static_cast<std::size_t>(node.past);
        continue;
      }
      for (std::int32_t k = node.first; k < node.last; ++k) {
        const std::int32_t item = m_items[k];
        ++work[WorkCount::partTests];
        if (meets(m_boxes[item])) out.push_back(item);
      }
      ++i;
    }
    std::sort(out.begin(), out.end());
  }

 private:
  static constexpr std::size_t kLeaf = 4;  // boxes; fewer add more nodes than they save tests

  struct Node {
    Aabb<D> box;
    std::int32_t past = 0;             // the node after this subtree
    std::int32_t first = 0, last = 0;  // its items, when it is a leaf
  };

  void build(std::size_t begin, std::size_t end) {
    const std::size_t at = m_nodes.size();
    m_nodes.emplace_back();
    Aabb<D> box, centers;
    for (std::size_t i = begin; i < end; ++i) {
      const Aabb<D>& b = m_boxes[m_items[i]];
      box = box.merged(b), centers = centers.merged({b.center(), b.center()});
    }
    m_nodes[at].box = box;
    if (end - begin <= kLeaf) {
      m_nodes[at].first = static_cast<std::int32_t>(begin), m_nodes[at].last = static_cast<std::int32_t>(end);
    } else {
      Eigen::Index axis = 0;
      (centers.hi - centers.lo).maxCoeff(&axis);
      const auto before = [&](std::int32_t a, std::int32_t b) {  // never equal, so the order is the same in every
                                                                 // standard library
        return std::pair(m_boxes[a].center()[axis], a) < std::pair(m_boxes[b].center()[axis], b);
      };
      const std::size_t middle = begin + (end - begin) / 2;
      const auto from = m_items.begin();
      std::nth_element(from + static_cast<std::ptrdiff_t>(begin), from + static_cast<std::ptrdiff_t>(middle),
                       from + static_cast<std::ptrdiff_t>(end), before);
      build(begin, middle), build(middle, end);
    }
    m_nodes[at].past = static_cast<std::int32_t>(m_nodes.size());
  }

  IndexedVector<Aabb<D>> m_boxes;  // by item
  IndexedVector<std::int32_t> m_items;
  IndexedVector<Node> m_nodes;
};

}}  // namespace lpc::LPC_PRECISION
