// SPDX-License-Identifier: Zlib
// Planted bugs: copies of the naive broadphase, each with a mistake that real broadphases had. The conformance test
// must catch them.
#pragma once

#include "framework/stage/stage_broadphase.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test {

/// Reports the pairs that pass `meet` and `filter`; each planted bug changes one of the two.
template <int D>
class PlantedBug : public Broadphase<D> {
 public:
  void findPairs(const Proxies<D>& proxies, std::vector<ProxyPair>& out, WorkDone&) override {
    for (ProxyId a = 0; a < proxies.size(); ++a) {
      for (ProxyId b = a + 1; b < proxies.size(); ++b) {
        if (meet(proxies, a, b) && filter(proxies, a, b)) out.push_back({a, b});
      }
    }
  }

 protected:
  virtual bool meet(const Proxies<D>& proxies, ProxyId a, ProxyId b) { return proxies.boxesOverlap(a, b); }
  virtual bool filter(const Proxies<D>& proxies, ProxyId a, ProxyId b) { return proxies.mayCollide(a, b); }
};

/// `<` for `<=`: boxes that only touch are missed.
template <int D>
class OpenBoxes final : public PlantedBug<D> {
  bool meet(const Proxies<D>& proxies, ProxyId a, ProxyId b) override {
    const Aabb<D> p = proxies.box(a), q = proxies.box(b);
    return (p.lo.array() < q.hi.array()).all() && (q.lo.array() < p.hi.array()).all();
  }
};

/// A tree that never compares the boxes of its root, which cross the centre, with those below.
template <int D>
class ForgetsCenterLine final : public PlantedBug<D> {
  bool meet(const Proxies<D>& proxies, ProxyId a, ProxyId b) override {
    const auto crosses = [&](ProxyId i) {
      return proxies.lo[0][static_cast<std::size_t>(i)] <= 0 && proxies.hi[0][static_cast<std::size_t>(i)] >= 0;
    };
    return proxies.boxesOverlap(a, b) && crosses(a) == crosses(b);
  }
};

/// Keeps its own boxes and overlooks that a slot may be reused between two updates.
template <int D>
class StaleSlot final : public PlantedBug<D> {
 public:
  void update(const Proxies<D>& proxies, const ProxyChanges& changes) override {
    m_boxes.resize(static_cast<std::size_t>(proxies.size()));
    m_known.resize(m_boxes.size());
    for (ProxyId i : changes.added) {
      const auto k = static_cast<std::size_t>(i);
      if (!m_known[k]) m_boxes[k] = proxies.box(i), m_known[k] = true;
    }
    for (ProxyId i : changes.moved) {
      const auto k = static_cast<std::size_t>(i);
      if (!std::count(changes.added.begin(), changes.added.end(), i)) m_boxes[k] = proxies.box(i);
    }
    for (ProxyId i : changes.removed) {
      if (proxies.isFree(i)) m_known[static_cast<std::size_t>(i)] = false;
    }
  }

 private:
  bool meet(const Proxies<D>&, ProxyId a, ProxyId b) override {
    return m_boxes[static_cast<std::size_t>(a)].overlaps(m_boxes[static_cast<std::size_t>(b)]);
  }
  std::vector<Aabb<D>> m_boxes;
  std::vector<bool> m_known;
};

/// A grid that reports a pair once per shared cell; the cells are 4 m wide, along x.
template <int D>
class Duplicates final : public PlantedBug<D> {
 public:
  void findPairs(const Proxies<D>& proxies, std::vector<ProxyPair>& out, WorkDone& work) override {
    PlantedBug<D>::findPairs(proxies, out, work);
    for (std::size_t k = 0, n = out.size(); k < n; ++k) {
      const Aabb<D> a = proxies.box(out[k].a), b = proxies.box(out[k].b);
      if (std::floor(std::max(a.lo[0], b.lo[0]) / 4) < std::floor(std::min(a.hi[0], b.hi[0]) / 4))
        out.push_back(out[k]);
    }
  }
};

/// A hash that rounds the number of a cell toward zero, cells 4 m wide along x, and decides in metres which cell
/// reports a pair. On the negative side this is the next cell, which is empty.
template <int D>
class TruncatesCells final : public PlantedBug<D> {
  bool meet(const Proxies<D>& proxies, ProxyId a, ProxyId b) override {
    const Aabb<D> p = proxies.box(a), q = proxies.box(b);
    const Real begin = std::max(p.lo[0], q.lo[0]) / 4, cell = std::trunc(begin);
    return proxies.boxesOverlap(a, b) && cell <= begin;
  }
};

/// A hash that does not compare the cells of two boxes in one slot. Cells along x, 4 m wide, share seven slots in turn;
/// a pair is reported in each slot that both occupy.
template <int D>
class ForgetsTheCell final : public PlantedBug<D> {
 public:
  void findPairs(const Proxies<D>& proxies, std::vector<ProxyPair>& out, WorkDone& work) override {
    PlantedBug<D>::findPairs(proxies, out, work);
    for (std::size_t k = 0, n = out.size(); k < n; ++k) {
      const auto wide = [&](ProxyId i) {
        const Aabb<D> box = proxies.box(i);
        return std::floor(box.hi[0] / 4) - std::floor(box.lo[0] / 4) >= 7;
      };
      if (wide(out[k].a) || wide(out[k].b)) out.push_back(out[k]);
    }
  }
};

/// A tree that stores a box across its plane, here x = 0, only on the side where the box begins.
template <int D>
class OneSideOfPlane final : public PlantedBug<D> {
  bool meet(const Proxies<D>& proxies, ProxyId a, ProxyId b) override {
    const auto below = [&](ProxyId i) { return proxies.lo[0][static_cast<std::size_t>(i)] < 0; };
    return proxies.boxesOverlap(a, b) && below(a) == below(b);
  }
};

/// Reports pairs of two sleeping boxes.
template <int D>
class WakesTheDead final : public PlantedBug<D> {
  bool filter(const Proxies<D>& proxies, ProxyId a, ProxyId b) override {
    const auto i = static_cast<std::size_t>(a), j = static_cast<std::size_t>(b);
    return proxies.body[i] != proxies.body[j] && (proxies.category[i] & proxies.mask[j]) &&
           (proxies.category[j] & proxies.mask[i]);
  }
};

/// Uses spheres inside the boxes instead of around them, and claims to be conservative.
template <int D>
class InnerSpheres final : public PlantedBug<D> {
  bool meet(const Proxies<D>& proxies, ProxyId a, ProxyId b) override {
    const Aabb<D> p = proxies.box(a), q = proxies.box(b);
    const Real reach = ((p.hi - p.lo).minCoeff() + (q.hi - q.lo).minCoeff()) / 2;
    return (p.center() - q.center()).squaredNorm() <= reach * reach;
  }
};

/// Compares neighbours in a list that is not sorted.
template <int D>
class NearbySlots final : public PlantedBug<D> {
  bool meet(const Proxies<D>& proxies, ProxyId a, ProxyId b) override {
    return b - a < 8 && proxies.boxesOverlap(a, b);
  }
};

/// Stores a box when it is added and never updates it.
template <int D>
class KeepsFirstBox final : public PlantedBug<D> {
 public:
  void update(const Proxies<D>& proxies, const ProxyChanges& changes) override {
    m_boxes.resize(static_cast<std::size_t>(proxies.size()));
    for (ProxyId i : changes.added) m_boxes[static_cast<std::size_t>(i)] = proxies.box(i);
  }

 private:
  bool meet(const Proxies<D>&, ProxyId a, ProxyId b) override {
    return m_boxes[static_cast<std::size_t>(a)].overlaps(m_boxes[static_cast<std::size_t>(b)]);
  }
  std::vector<Aabb<D>> m_boxes;
};

/// Processes the lists in the wrong order: a proxy that was removed and added in one update is lost.
template <int D>
class RemovesLast final : public PlantedBug<D> {
 public:
  void update(const Proxies<D>& proxies, const ProxyChanges& changes) override {
    m_known.resize(static_cast<std::size_t>(proxies.size()));
    for (ProxyId i : changes.added) m_known[static_cast<std::size_t>(i)] = true;
    for (ProxyId i : changes.removed) m_known[static_cast<std::size_t>(i)] = false;
  }

 private:
  bool meet(const Proxies<D>& proxies, ProxyId a, ProxyId b) override {
    return m_known[static_cast<std::size_t>(a)] && m_known[static_cast<std::size_t>(b)] && proxies.boxesOverlap(a, b);
  }
  std::vector<bool> m_known;
};

/// Boxes without their upper bounds: whether two touch depends on the side.
template <int D>
class HalfOpenBoxes final : public PlantedBug<D> {
  bool meet(const Proxies<D>& proxies, ProxyId a, ProxyId b) override {
    const Aabb<D> p = proxies.box(a), q = proxies.box(b);
    return (p.lo.array() <= q.hi.array()).all() && (q.lo.array() < p.hi.array()).all();
  }
};

/// Two boxes overlap if one contains a corner of the other: a cross, or a plank through a wall, is missed.
template <int D>
class CornersOnly final : public PlantedBug<D> {
  bool meet(const Proxies<D>& proxies, ProxyId a, ProxyId b) override {
    const Aabb<D> p = proxies.box(a), q = proxies.box(b);
    for (int bits = 0; bits < 1 << D; ++bits) {
      Vec<D> ofP, ofQ;
      for (int d = 0; d < D; ++d) {
        ofP[d] = (bits >> d) & 1 ? p.hi[d] : p.lo[d];
        ofQ[d] = (bits >> d) & 1 ? q.hi[d] : q.lo[d];
      }
      if (p.contains(ofQ) || q.contains(ofP)) return true;
    }
    return false;
  }
};

/// A tree that divides until a region holds one box: equal boxes stop it only after a thousand levels.
template <int D>
class Bottomless final : public PlantedBug<D> {
 public:
  void findPairs(const Proxies<D>& proxies, std::vector<ProxyPair>& out, WorkDone& work) override {
    PlantedBug<D>::findPairs(proxies, out, work);
    const bool alike = std::any_of(out.begin(), out.end(), [&](const ProxyPair& p) {
      const Aabb<D> a = proxies.box(p.a), b = proxies.box(p.b);
      return a.lo == b.lo && a.hi == b.hi;
    });
    work[WorkCount::nodeVisits] += alike ? 1000 : out.size();
  }
};

/// A tree that only grows: each step adds a node per box.
template <int D>
class OnlyGrows final : public PlantedBug<D> {
 public:
  void findPairs(const Proxies<D>& proxies, std::vector<ProxyPair>& out, WorkDone& work) override {
    PlantedBug<D>::findPairs(proxies, out, work);
    work[WorkCount::nodeVisits] += m_nodes += static_cast<std::uint64_t>(proxies.size());
  }

 private:
  std::uint64_t m_nodes = 0;
};

/// A tree that is refitted but never rebuilt: the more boxes have moved, the more of its nodes overlap.
template <int D>
class WearsOut final : public PlantedBug<D> {
 public:
  void update(const Proxies<D>&, const ProxyChanges& changes) override { m_moved += changes.moved.size(); }
  void findPairs(const Proxies<D>& proxies, std::vector<ProxyPair>& out, WorkDone& work) override {
    PlantedBug<D>::findPairs(proxies, out, work);
    work[WorkCount::nodeVisits] += m_moved;
  }

 private:
  std::size_t m_moved = 0;
};

/// A tree of two levels that never refits its parents. Each four slots share a parent with the box as built; a box that
/// leaves it is no longer found.
template <int D>
class ForgetsParent final : public PlantedBug<D> {
 public:
  void update(const Proxies<D>& proxies, const ProxyChanges& changes) override {
    const auto parents = static_cast<std::size_t>(proxies.size() / 4 + 1);
    const bool anew = !changes.added.empty() || !changes.removed.empty() || m_parent.size() != parents;
    if (!anew) return;
    m_parent.assign(parents, Aabb<D>{});
    for (ProxyId i = 0; i < proxies.size(); ++i) {
      if (!proxies.isFree(i)) parent(i) = parent(i).merged(proxies.box(i));
    }
  }

 private:
  bool meet(const Proxies<D>& proxies, ProxyId a, ProxyId b) override {
    return parent(a).overlaps(parent(b)) && proxies.boxesOverlap(a, b);
  }
  Aabb<D>& parent(ProxyId i) { return m_parent[static_cast<std::size_t>(i / 4)]; }
  std::vector<Aabb<D>> m_parent;
};

/// Keeps pairs of fat boxes from step to step. A box that leaves its fat box gets a new one, but the pairs are not
/// found again.
template <int D>
class KeepsFatPairs final : public PlantedBug<D> {
 public:
  void update(const Proxies<D>& proxies, const ProxyChanges& changes) override {
    m_fat.resize(static_cast<std::size_t>(proxies.size()));
    for (const auto list : {changes.added, changes.moved}) {
      for (const ProxyId i : list) {
        Aabb<D>& fat = m_fat[static_cast<std::size_t>(i)];
        const bool isNew = list.data() == changes.added.data();
        if (isNew || !fat.contains(proxies.box(i))) fat = proxies.box(i).grown(Real(0.1));
        m_anew = m_anew || isNew;
      }
    }
    if (!m_anew && changes.removed.empty()) return;
    m_pairs.clear(), m_anew = false;
    for (ProxyId a = 0; a < proxies.size(); ++a) {
      for (ProxyId b = a + 1; b < proxies.size(); ++b) {
        if (fat(a).overlaps(fat(b))) m_pairs.push_back({a, b});
      }
    }
  }

 private:
  bool meet(const Proxies<D>& proxies, ProxyId a, ProxyId b) override {
    return std::binary_search(m_pairs.begin(), m_pairs.end(), ProxyPair{a, b}) && proxies.boxesOverlap(a, b);
  }
  const Aabb<D>& fat(ProxyId i) const { return m_fat[static_cast<std::size_t>(i)]; }
  std::vector<Aabb<D>> m_fat;
  std::vector<ProxyPair> m_pairs;
  bool m_anew = false;
};

/// The empty box of a body that has become NaN is compared the wrong way round and overlaps everything.
template <int D>
class MeetsTheLost final : public PlantedBug<D> {
  bool meet(const Proxies<D>& proxies, ProxyId a, ProxyId b) override {
    const Aabb<D> p = proxies.box(a), q = proxies.box(b);
    return proxies.boxesOverlap(a, b) || (p.lo[0] > p.hi[0]) != (q.lo[0] > q.hi[0]);
  }
};

}}}  // namespace lpc::LPC_PRECISION::test
