// SPDX-License-Identifier: Zlib
// A crowd of boxes driven by a list of commands. It is kept twice: as a broadphase sees it (Proxies and lists of
// changes, as the world makes them), and as plain records. Brute force on the records gives the right pairs.
#pragma once

#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <ostream>
#include <string_view>
#include <vector>

#include "framework/math/random.h"
#include "framework/stage/stage_broadphase.h"
#include "tests/assertion.h"
#include "tests/draw.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test {

/// Where boxes are placed: one family for a whole sequence, or another for each box. On these inputs published
/// broadphases were seen to fail.
enum class BoxFamily { scattered, touching, identical, huge, farOut, thin, centerLine, extreme, mixed };
inline constexpr int kBoxFamilies = 9;

/// Call inside a property. Each family has the same chance.
inline BoxFamily anyFamily() { return static_cast<BoxFamily>(RapidCheckDraw().below(kBoxFamilies)); }

/// `bits` selects the details. Any value is valid, so that a list stays valid when shrinking removes commands.
struct Command {
  enum Kind : std::uint8_t { add, remove, move, teleport, refilter, sleepOrWake, lose, update, spawnMany, clear };
  Kind kind;
  std::uint64_t bits;
};
inline std::ostream& operator<<(std::ostream& out, const Command& c) {
  static constexpr std::array<std::string_view, 10> names = {
      "add", "remove", "move", "teleport", "refilter", "sleepOrWake", "lose", "update", "spawn_many", "clear"};
  return out << names[c.kind] << '(' << c.bits << ')';
}

/// Call inside a property. The length is uniform up to 80 times the size of the case, at most 4000. It shrinks by
/// removing commands.
std::vector<Command> drawCommands();

template <int D>
Aabb<D> drawBox(Random& random, BoxFamily family) {
  if (family == BoxFamily::mixed) family = static_cast<BoxFamily>(random.below(kBoxFamilies - 1));
  const auto whole = [&](int lo, int hi) {
    return static_cast<Real>(lo + static_cast<int>(random.below(static_cast<std::uint64_t>(hi - lo + 1))));
  };
  Aabb<D> box;
  for (int d = 0; d < D; ++d) {
    Real at = static_cast<Real>(random.uniform(-12, 12)), size = static_cast<Real>(random.uniform(0.1, 3));
    switch (family) {
      case BoxFamily::touching:  // integers: most neighbours touch exactly, and many sizes are 0
        at = whole(-6, 6), size = whole(0, 3);
        break;
      case BoxFamily::identical:
        at = 1, size = 2;
        break;
      case BoxFamily::huge:
        if (random.below(6) == 0) at = static_cast<Real>(-1e7 * random.uniform()), size = Real(1e7);
        break;
      case BoxFamily::farOut:
        at += (d == 0 ? 1 : -1) * (random.below(9) == 0 ? Real(3e7) : Real(1e5));
        break;
      case BoxFamily::thin:
        size = random.below(D) == 0 ? Real(15) : whole(0, 1) * Real(1e-3);
        break;
      case BoxFamily::centerLine:  // all boxes cross the line through the origin along the last axis
        if (d < D - 1)
          size = static_cast<Real>(random.uniform(0.1, 2)), at = -size * static_cast<Real>(random.uniform());
        if (d == D - 1) at *= 10;
        break;
      case BoxFamily::extreme:
        size = static_cast<Real>(std::pow(10.0, random.uniform(-30, 30)));
        at = (random.below(2) ? size : -size) * static_cast<Real>(random.uniform(-3, 3));
        break;
      default:
        break;
    }
    box.lo[d] = at, box.hi[d] = std::max(at, at + size);
  }
  return box;
}

template <int D>
class BoxCrowd {
 public:
  explicit BoxCrowd(BoxFamily family) : m_family(family) {}

  const Proxies<D>& proxies() const { return m_proxies; }

  void apply(const Command& c) {
    Random random(c.bits);
    if (c.kind == Command::spawnMany) {
      for (int k = 0; k < 40; ++k) add(random);
    } else if (c.kind == Command::clear) {
      for (std::size_t i = 0; i < m_records.size(); ++i) remove(i);
    } else if (c.kind == Command::add) {
      add(random);
    } else if (const auto i = pick(random)) {
      change(c.kind, *i, random);
    }
  }

  /// As the world before a step or a query.
  void update(Broadphase<D>& broadphase) {
    std::vector<ProxyId> added, removed, moved;
    for (std::size_t i = 0; i < m_records.size(); ++i) {
      const Record& r = m_records[i];
      const auto slot = static_cast<ProxyId>(i);
      const bool wasUsed = i < m_told.size() && m_told[i].tenant > 0, isUsed = r.tenant > 0;
      const bool same = wasUsed && isUsed && m_told[i].tenant == r.tenant;
      if (wasUsed && !same) removed.push_back(slot);
      if (isUsed && !same) added.push_back(slot);
      // As in the world: every active proxy counts as moved.
      if (isUsed && (r.active || (same && m_told[i].active))) moved.push_back(slot);
      if (same && !r.active && (m_told[i].box.lo != r.box.lo || m_told[i].box.hi != r.box.hi)) {
        if (!m_told[i].active) moved.push_back(slot);
      }
    }
    broadphase.update(m_proxies, {added, removed, moved});
    m_told = m_records;
  }

  bool overlap(std::size_t i, std::size_t j) const {
    const Aabb<D>&a = m_records[i].box, &b = m_records[j].box;
    for (int d = 0; d < D; ++d) {
      if (!(a.lo[d] <= b.hi[d] && b.lo[d] <= a.hi[d])) return false;
    }
    return true;
  }
  bool mayCollide(std::size_t i, std::size_t j) const {
    const Record &a = m_records[i], &b = m_records[j];
    return a.tenant > 0 && b.tenant > 0 && a.body != b.body && (a.active || b.active) && (a.category & b.mask) != 0 &&
           (b.category & a.mask) != 0;
  }
  /// Sorted.
  std::vector<ProxyPair> truth() const {
    std::vector<ProxyPair> pairs;
    for (std::size_t i = 0; i < m_records.size(); ++i) {
      for (std::size_t j = i + 1; j < m_records.size(); ++j) {
        if (mayCollide(i, j) && overlap(i, j)) pairs.push_back({static_cast<ProxyId>(i), static_cast<ProxyId>(j)});
      }
    }
    return pairs;
  }

 private:
  static constexpr std::size_t kMost = 160;  // boxes at a time; brute force on more would make the test slow

  struct Record {
    Aabb<D> box;
    bool active = false;
    std::uint32_t category = 0, mask = 0;
    std::int32_t body = -1;
    int tenant = 0;  // serial number of the box in this slot; 0: the slot is free
  };

  std::optional<std::size_t> pick(Random& random) const {
    if (m_used == 0) return std::nullopt;
    std::uint64_t k = random.below(m_used);
    for (std::size_t i = 0;; ++i) {
      if (m_records[i].tenant > 0 && k-- == 0) return i;
    }
  }

  void add(Random& random) {
    if (m_used == kMost) return;
    std::size_t i = 0;
    while (i < m_records.size() && m_records[i].tenant > 0) ++i;
    if (i == m_records.size()) m_records.emplace_back();
    m_proxies.resize(static_cast<int>(m_records.size()));
    Record& r = m_records[i];
    r = {drawBox<D>(random, m_family), random.below(4) > 0, 1, ~std::uint32_t{0}, 0, ++m_tenants};
    r.body = static_cast<std::int32_t>(random.below(3) > 0 ? i + kMost : random.below(20));  // some boxes share a body
    ++m_used;
    write(i);
  }
  void remove(std::size_t i) {
    if (m_records[i].tenant == 0) return;
    m_records[i] = Record{};
    --m_used;
    write(i);
  }
  void change(Command::Kind kind, std::size_t i, Random& random) {
    Record& r = m_records[i];
    switch (kind) {
      case Command::remove:
        remove(i);
        return;
      case Command::move:
        for (int d = 0; d < D; ++d) {
          const Real step = (r.box.hi[d] - r.box.lo[d]) * static_cast<Real>(random.uniform(-0.1, 0.1));
          r.box.lo[d] += step, r.box.hi[d] += step;
        }
        break;
      case Command::teleport:
        r.box = drawBox<D>(random, m_family);
        break;
      case Command::lose:  // the body became NaN
        r.box = Aabb<D>{};
        break;
      case Command::refilter:
        r.category = 1u << random.below(3), r.mask = static_cast<std::uint32_t>(random.below(8));
        break;
      case Command::sleepOrWake:
        r.active = !r.active;
        break;
      default:
        break;
    }
    if (r.box.lo[0] > r.box.hi[0] || !r.box.lo.allFinite() || !r.box.hi.allFinite()) r.box = Aabb<D>{};
    write(i);
  }
  void write(std::size_t i) {
    const Record& r = m_records[i];
    m_proxies.setBox(static_cast<ProxyId>(i), r.box);
    m_proxies.active[i] = r.active, m_proxies.body[i] = r.body;
    m_proxies.category[i] = r.category, m_proxies.mask[i] = r.mask;
  }

  BoxFamily m_family;
  Proxies<D> m_proxies;
  std::vector<Record> m_records, m_told;  // by slot: now, and at the last update
  std::size_t m_used = 0;
  int m_tenants = 0;
};

template <int D>
using BroadphaseFactory = std::function<std::unique_ptr<Broadphase<D>>()>;

/// Runs the commands, finds the pairs after every sixteenth and at the end, and compares them with brute force.
template <int D>
void checkPairs(const BroadphaseFactory<D>& create, Guarantee guarantee, BoxFamily family,
                const std::vector<Command>& list) {
  const auto broadphase = create();
  BoxCrowd<D> crowd(family);
  std::vector<ProxyPair> found;
  WorkDone work;
  for (std::size_t k = 0; k <= list.size(); ++k) {
    if (k % 16 == 15 || k == list.size()) {
      crowd.update(*broadphase);
      found.clear();
      broadphase->findPairs(crowd.proxies(), found, work);
      std::sort(found.begin(), found.end());
      for (const ProxyPair& p : found) RC_ASSERT(p.a < p.b);
      RC_ASSERT(std::adjacent_find(found.begin(), found.end()) == found.end());
      const std::vector<ProxyPair> truth = crowd.truth();
      if (guarantee == Guarantee::conservative) {
        RC_ASSERT(std::includes(found.begin(), found.end(), truth.begin(), truth.end()));
        for (const ProxyPair& p : found) {
          RC_ASSERT(crowd.mayCollide(static_cast<std::size_t>(p.a), static_cast<std::size_t>(p.b)));
        }
      } else {
        RC_ASSERT(found == truth);
      }
    }
    if (k == list.size()) break;
    crowd.apply(list[k]);
    if (list[k].kind == Command::update) crowd.update(*broadphase);  // as for queries between steps
  }
}

}}}  // namespace lpc::LPC_PRECISION::test

namespace lpc { inline namespace LPC_PRECISION {
inline std::ostream& operator<<(std::ostream& out, const ProxyPair& p) {
  return out << '(' << p.a << ',' << p.b << ')';
}
}}  // namespace lpc::LPC_PRECISION
