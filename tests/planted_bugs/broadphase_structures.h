// SPDX-License-Identifier: Zlib
// Two broadphases that report their structure, a grid and a tree of two levels, and planted bugs that report it
// wrongly.
#pragma once

#include "tests/planted_bugs/broadphase.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test {

/// Cells of 4 m; a box is in every cell that it overlaps.
template <int D>
class TellsCells : public PlantedBug<D> {
 public:
  void findPairs(const Proxies<D>& proxies, std::vector<ProxyPair>& out, WorkDone& work) override {
    PlantedBug<D>::findPairs(proxies, out, work);
    if (forgets()) m_boxes.clear();
    for (ProxyId i = 0; i < proxies.size(); ++i) {
      if (proxies.box(i).lo[0] <= proxies.box(i).hi[0]) m_boxes.push_back(proxies.box(i));
    }
  }
  void structure(std::vector<StructureBox<D>>& out) const override {
    for (const Aabb<D>& box : m_boxes) {
      Vec<D> lo, hi;
      for (int d = 0; d < D; ++d) lo[d] = cell(box.lo[d] / 4), hi[d] = reaches(lo[d], cell(box.hi[d] / 4));
      for (Vec<D> at = lo; at[D - 1] <= hi[D - 1];) {
        out.push_back({{4 * at, 4 * at.array() + 4}, 0, true});
        int d = 0;
        while (++at[d] > hi[d] && d + 1 < D) at[d] = lo[d], ++d;
      }
    }
  }

 private:
  virtual bool forgets() const { return true; }
  virtual Real cell(Real x) const { return std::floor(x); }
  virtual Real reaches(Real /*first*/, Real last) const { return last; }
  std::vector<Aabb<D>> m_boxes;  // of the last findPairs
};

/// The two cells beside 0 are reported as one.
template <int D>
class TellsTruncated final : public TellsCells<D> {
  Real cell(Real x) const override { return std::trunc(x); }
};

/// A box is reported only in the cell of its lower corner.
template <int D>
class TellsFirstCell final : public TellsCells<D> {
  Real reaches(Real first, Real) const override { return first; }
};

/// Cells remain after their boxes have left.
template <int D>
class TellsTheGone final : public TellsCells<D> {
  bool forgets() const override { return false; }
};

/// Each four slots share a parent box.
template <int D>
class TellsTree : public PlantedBug<D> {
 public:
  void findPairs(const Proxies<D>& proxies, std::vector<ProxyPair>& out, WorkDone& work) override {
    PlantedBug<D>::findPairs(proxies, out, work);
    if (m_dropsOne && !out.empty()) out.pop_back();
    m_dropsOne = false;
    m_leaf.assign(static_cast<std::size_t>((proxies.size() + 3) / 4 * 4), {});
    m_parent.resize(m_leaf.size() / 4);
    for (std::size_t p = 0; p < m_parent.size(); ++p) {
      Aabb<D> box;
      for (std::size_t k = 4 * p; k < 4 * p + 4 && k < static_cast<std::size_t>(proxies.size()); ++k) {
        m_leaf[k] = proxies.box(static_cast<ProxyId>(k)), box = box.merged(m_leaf[k]);
      }
      if (refits() || m_parent[p].lo[0] > m_parent[p].hi[0]) m_parent[p] = box;
    }
  }
  void structure(std::vector<StructureBox<D>>& out) const override {
    m_dropsOne = touches();
    for (std::size_t p = 0; p < m_parent.size(); ++p) {
      tell(m_parent[p], 0, out);
      if (byLevels()) continue;
      for (std::size_t k = 4 * p; k < 4 * p + 4; ++k) tell(m_leaf[k], 1, out);
    }
    if (!byLevels()) return;
    for (const Aabb<D>& leaf : m_leaf) tell(leaf, 1, out);
  }

 private:
  static void tell(const Aabb<D>& box, int level, std::vector<StructureBox<D>>& out) {
    if (box.lo[0] <= box.hi[0]) out.push_back({box, level, level == 1});
  }
  virtual bool refits() const { return true; }
  virtual bool byLevels() const { return false; }
  virtual bool touches() const { return false; }
  std::vector<Aabb<D>> m_leaf, m_parent;
  mutable bool m_dropsOne = false;
};

/// Parents are reported as built, although their children have moved.
template <int D>
class TellsOldParents final : public TellsTree<D> {
  bool refits() const override { return false; }
};

/// All parents come first, so the parent of a leaf is unknown.
template <int D>
class TellsByLevels final : public TellsTree<D> {
  bool byLevels() const override { return true; }
};

/// Reporting the structure changes the next step.
template <int D>
class TellingTouches final : public TellsTree<D> {
  bool touches() const override { return true; }
};

}}}  // namespace lpc::LPC_PRECISION::test
