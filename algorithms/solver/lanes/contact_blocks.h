// SPDX-License-Identifier: Zlib
// Contacts of a solve in blocks of manifolds that lie side by side in memory, one in each lane of a register, so that
// one instruction updates all of them. The manifolds of a block share no dynamic body. In an order without colours each
// block has one manifold.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "algorithms/solver/rows/contact_rows.h"
#include "framework/math/indexed.h"
#include "framework/stage/params.h"

namespace lpc { inline namespace LPC_PRECISION { namespace solver {

/// Offsets of the numbers of a manifold, and of those of each of its points, in a block. Vectors and matrices are
/// stored by element, matrices by column. A number at offset f has one value per lane, from f x lanes on.
template <int D>
struct BlockLayout {
  static constexpr int kAng = kAngDim<D>;
  // Of a manifold.
  static constexpr int kInvMassA = 0, kInvMassB = 1, kFriction = 2, kNormal = 3;
  static constexpr int kTangents = kNormal + D;
  static constexpr int kInvIA = kTangents + D * (D - 1), kInvIB = kInvIA + kAng * kAng;
  static constexpr int kBetween = kInvIB + kAng * kAng;  // from the start of A to that of B, m
  static constexpr int kManifold = kBetween + D;
  // Of a point. Arms are r x d, m, for the normal and each tangent: of A, then of B.
  static constexpr int kArms = 0, kMass = 2 * D * kAng;
  static constexpr int kSlide = kMass + 1;                                 // as in PointRows
  static constexpr int kStick = kSlide + 1, kStickCount = D == 2 ? 0 : 3;  // 2D: equal to slide; 3D: 00, 01, 11
  static constexpr int kImpulse = kStick + kStickCount;
  static constexpr int kGoal = kImpulse + D;       // separation, m, or least normal velocity, m/s
  static constexpr int kMaxImpulse = kGoal + 1;    // largest normal impulse of all sweeps
  static constexpr int kLocalA = kMaxImpulse + 1;  // anchors in the bodies' frames, m
  static constexpr int kLocalB = kLocalA + D;
  static constexpr int kVelocity = kLocalB + D;  // along the normal before the step, m/s
  static constexpr int kLoad = kVelocity + 1;    // sum of the normal impulses so far, N s
  static constexpr int kPoint = kLoad + 1;
};

/// Numbers of a body as a block reads them, padded to whole groups of four: velocity and angular velocity, or
/// displacement since the start of the step and rotation.
template <int D>
inline constexpr int kLine = D == 2 ? 4 : 8;
/// Numbers that a step does not change: position at its start, m, inverse mass and inverse inertia.
template <int D>
inline constexpr int kFixedLine = D == 2 ? 4 : 16;
template <int D>
inline constexpr int kLineTurn = D == 2 ? 2 : 4;  // offset of the angular part

/// Order of the contacts in a sweep, and whether a solver uses SIMD lanes, which need colours.
enum class SweepOrder : std::uint8_t { stored, coloured };
enum class SweepLanes : std::uint8_t { automatic, scalar };
inline void visitSweepOrder(ParamVisitor& v, SweepOrder& order) {
  v.choice("order", order, {"stored", "coloured"},
           "order of the contacts in a pass: stored, or in groups that share no dynamic body, which lanes need");
}
inline void visitSweepLanes(ParamVisitor& v, SweepLanes& lanes, const char* when = "") {
  v.choice("lanes", lanes, {"auto", "scalar"},
           std::string("coloured contacts in SIMD lanes, or one at a time; the same bits") + when);
}

/// Lanes of a register on this machine.
int contactLanes();
struct ContactBlock {
  std::size_t at;             // of its first number
  std::size_t index;          // of its first offset: by lane, A and B to read, A and B to write, and the manifold
  std::int32_t lanes, count;  // count: points of each of its manifolds
  bool hasFriction;           // whether its manifolds have friction
};

/// A manifold in its block.
struct ContactPlace {
  std::size_t at;  // of its first number; number f is at `at + f * lanes`
  std::int32_t lanes, count;
  std::int32_t a, b, manifold;
  bool hasFriction;
};

template <int D>
class ContactBlocks {
 public:
  using Layout = BlockLayout<D>;

  std::vector<ContactBlock> blocks;   // in solving order
  std::vector<ContactPlace> places;   // in the order of the blocks
  std::vector<std::int32_t> offsets;  // of bodies in `motion` and `pose`, and of manifolds
  IndexedVector<Real> motion, pose;   // kLine numbers per body
  IndexedVector<Real> fixed;          // kFixedLine numbers per body

  /// Places the manifolds `order`. prepareBlocks() sets their numbers. `colours` are offsets into `order` as in
  /// VelocityInput; empty: none.
  void arrange(const Bodies<D>& bodies, IndexedSpan<const Manifold<D>> all, IndexedSpan<const int> order,
               IndexedSpan<const int> colours, int lanes, bool friction) {
    LPC_ASSERT(all.size() * (sizeof(Manifold<D>) / sizeof(Real)) <= std::numeric_limits<std::int32_t>::max());
    blocks.clear(), places.clear(), offsets.clear(), m_bodies.clear();
    m_line.resize(bodies.pose.size(), 0);
    m_end = 0, m_rows = 0;
    const bool wide = !colours.empty() && lanes > 1;
    if (!wide) {
      for (const int k : order) addBlock(bodies, all, {&k, 1}, 1, friction);
    }
    for (std::size_t c = 0; wide && c + 1 < colours.size(); ++c) {
      for (std::vector<int>& sorted : m_sorted) sorted.clear();
      for (const int k : order.part(colours[c], colours[c + 1] - colours[c])) {
        const Manifold<D>& m = all[k];
        m_sorted[static_cast<std::size_t>(2 * m.count + (friction && m.friction > 0))].push_back(k);
      }
      for (const std::vector<int>& sorted : m_sorted) {
        const std::span<const int> members(sorted);
        for (std::size_t i = 0; i < members.size();) {
          const std::size_t n = std::min(members.size() - i, static_cast<std::size_t>(lanes));
          addBlock(bodies, all, members.subspan(i, n), n == 1 ? 1 : lanes, friction);
          i += n;
        }
      }
    }
    m_numbers.resize(m_end);
    motion.assign((m_bodies.size() + kReserved) * kLine<D>, 0);
    pose.assign(motion.size(), 0);
    fixed.assign((m_bodies.size() + kReserved) * kFixedLine<D>, 0);
  }

  Real* numbers() { return m_numbers.empty() ? nullptr : m_numbers.data()->x; }
  /// Rows of one sweep, and those of one manifold.
  std::uint64_t rows() const { return m_rows; }
  static std::uint64_t rowsOf(const ContactPlace& m) {
    return static_cast<std::uint64_t>(m.count * (m.hasFriction ? D : 1));
  }
  /// A number of a manifold, or of its point i.
  Real& of(const ContactPlace& m, int field) { return numbers()[m.at + stride(m, field)]; }
  Real& of(const ContactPlace& m, int i, int field) { return of(m, ofPoint(i, field)); }

  template <class M>
  void put(const ContactPlace& at, int field, const M& m) {
    for (int k = 0; k < static_cast<int>(m.size()); ++k) of(at, field + k) = m.data()[k];
  }
  template <class M>
  void get(const ContactPlace& at, int field, M& m) {
    for (int k = 0; k < static_cast<int>(m.size()); ++k) m.data()[k] = of(at, field + k);
  }
  /// Offset of a number of point i among those of its manifold.
  static constexpr int ofPoint(int i, int field) { return Layout::kManifold + i * Layout::kPoint + field; }

  /// Makes the rows of point i with these arms (m, world axes), without impulses.
  void setRows(const ContactPlace& at, int i, const Bodies<D>& bodies, const Manifold<D>& m, const Vec<D>& rA,
               const Vec<D>& rB) {
    const Real invMassSum = bodies.invMass[at.a] + bodies.invMass[at.b];
    const auto make = [&](const Vec<D>& d) {
      return makeRow<D>(d, rA, rB, invMassSum, bodies.invInertia[at.a], bodies.invInertia[at.b]);
    };
    PointRows<D> row;
    row.normal = make(m.normal);
    putArms(at, i, 0, row.normal);
    of(at, i, Layout::kMass) = row.normal.mass;
    if (!at.hasFriction) return;
    const RealMatrix<D, D - 1> t = tangents(m.normal);
    for (int d = 0; d < D - 1; ++d) row.tangent[d] = make(t.col(d)), putArms(at, i, d + 1, row.tangent[d]);
    prepareFriction(row);
    of(at, i, Layout::kSlide) = row.slide;
    if constexpr (D == 3) {
      of(at, i, Layout::kStick) = row.stick(0, 0), of(at, i, Layout::kStick + 1) = row.stick(0, 1);
      of(at, i, Layout::kStick + 2) = row.stick(1, 1);
    }
  }

  /// The same numbers as code that updates one manifold at a time takes them; not set: tangent masses, target, kick.
  ManifoldRows<D> manifoldRows(const ContactPlace& at) {
    ManifoldRows<D> m{};
    m.a = at.a, m.b = at.b, m.count = at.count, m.manifold = at.manifold;
    m.invMassA = of(at, Layout::kInvMassA), m.invMassB = of(at, Layout::kInvMassB);
    m.friction = at.hasFriction ? of(at, Layout::kFriction) : Real(0);
    get(at, Layout::kNormal, m.n), get(at, Layout::kTangents, m.t);
    return m;
  }
  PointRows<D> pointRows(const ContactPlace& at, int i) {
    Inertia<D> invIA, invIB;
    get(at, Layout::kInvIA, invIA), get(at, Layout::kInvIB, invIB);
    PointRows<D> row{};
    for (int d = 0; d < (at.hasFriction ? D : 1); ++d) {
      Row<D>& to = d == 0 ? row.normal : row.tangent[d - 1];
      const int arms = ofPoint(i, Layout::kArms + 2 * d * Layout::kAng);
      get(at, arms, to.armA), get(at, arms + Layout::kAng, to.armB);
      to.turnA = invIA * to.armA, to.turnB = invIB * to.armB;
    }
    row.normal.mass = of(at, i, Layout::kMass);
    for (int d = 0; d < D; ++d) row.impulse[d] = of(at, i, Layout::kImpulse + d);
    if (!at.hasFriction) return row;
    row.slide = of(at, i, Layout::kSlide);
    if constexpr (D == 2) {
      row.stick(0, 0) = row.slide;
    } else {
      row.stick(0, 0) = of(at, i, Layout::kStick), row.stick(1, 1) = of(at, i, Layout::kStick + 2);
      row.stick(0, 1) = row.stick(1, 0) = of(at, i, Layout::kStick + 1);
    }
    return row;
  }

  /// Calls f(place, index of the point) for each point.
  template <class F>
  void forPoints(const F& f) const {
    for (const ContactPlace& at : places) {
      for (int k = 0; k < at.count; ++k) f(at, k);
    }
  }

  /// Adds the normal impulses to the loads.
  void addLoads() {
    for (const ContactBlock& block : blocks) {
      const std::size_t n = static_cast<std::size_t>(block.lanes);
      for (int k = 0; k < block.count; ++k) {
        Real* const point = numbers() + block.at + static_cast<std::size_t>(ofPoint(k, 0)) * n;
        for (std::size_t i = 0; i < n; ++i) point[Layout::kLoad * n + i] += point[Layout::kImpulse * n + i];
      }
    }
  }

  void loadMotion(IndexedSpan<const Motion<D>> from) {
    forLines<kLine<D>>(motion, [&](std::int32_t body, Real* line) {
      const Motion<D>& m = from[body];
      std::copy_n(m.v.data(), D, line), std::copy_n(m.w.data(), kAngDim<D>, line + kLineTurn<D>);
    });
  }
  void storeMotion(const Bodies<D>& bodies, IndexedVector<Motion<D>>& to) {
    forLines<kLine<D>>(motion, [&](std::int32_t body, const Real* line) {
      if (bodies.type[body] != BodyType::dynamic) return;
      Motion<D>& m = to[body];
      std::copy_n(line, D, m.v.data()), std::copy_n(line + kLineTurn<D>, kAngDim<D>, m.w.data());
    });
  }
  /// `start(body)` is its position at the start of the step, m.
  template <class Start>
  void loadFixed(const Bodies<D>& bodies, const Start& start) {
    forLines<kFixedLine<D>>(fixed, [&](std::int32_t body, Real* line) {
      const Vec<D> at = start(body);
      std::copy_n(at.data(), D, line);
      line[D] = bodies.invMass[body];
      std::copy_n(bodies.invInertia[body].data(), Layout::kAng * Layout::kAng, line + D + 1);
    });
  }
  void loadPose(const Bodies<D>& bodies) {
    fillPose(bodies, [&](std::int32_t body) { return bodies.pose[body].p; });
  }
  /// `displacement` since the start of the step, m, in place of the positions.
  void loadPose(const Bodies<D>& bodies, IndexedSpan<const Vec<D>> displacement) {
    fillPose(bodies, [&](std::int32_t body) { return displacement[body]; });
  }

 private:
  // Calls f(slot of the body, its line) for each body.
  template <int kNumbers, class F>
  void forLines(IndexedVector<Real>& lines, const F& f) {
    Real* line = lines.data() + kReserved * kNumbers;
    for (const std::int32_t body : m_bodies) f(body, line), line += kNumbers;
  }
  template <class Place>
  void fillPose(const Bodies<D>& bodies, const Place& place) {
    forLines<kLine<D>>(pose, [&](std::int32_t body, Real* line) {
      const Vec<D> at = place(body);
      std::copy_n(at.data(), D, line);
      const Rot<D>& q = bodies.pose[body].q;
      if constexpr (D == 2) {
        line[2] = q.c, line[3] = q.s;
      } else {
        line[4] = q.w, line[5] = q.x, line[6] = q.y, line[7] = q.z;
      }
    });
  }

  // Lines before those of the bodies. Unused lanes hold a copy of a manifold of their block; they read line 0, which is
  // zero, and write to line 1. Lanes with a static or kinematic body read its line and write to line 1.
  static constexpr std::size_t kReserved = 2;
  static constexpr std::int32_t kNothing = 0, kNowhere = kLine<D>;
  struct alignas(64) Chunk {
    Real x[64 / sizeof(Real)];
  };

  void putArms(const ContactPlace& at, int i, int direction, const Row<D>& row) {
    const int field = ofPoint(i, Layout::kArms + 2 * direction * Layout::kAng);
    put(at, field, row.armA), put(at, field + Layout::kAng, row.armB);
  }
  static std::size_t stride(const ContactPlace& m, int field) {
    return static_cast<std::size_t>(field) * static_cast<std::size_t>(m.lanes);
  }
  std::int32_t lineOf(std::int32_t body) {
    std::int32_t& line = m_line[body];
    const auto known = static_cast<std::size_t>(line);
    if (known >= m_bodies.size() || m_bodies[known] != body) {
      line = static_cast<std::int32_t>(m_bodies.size());
      m_bodies.push_back(body);
    }
    return (line + static_cast<std::int32_t>(kReserved)) * kLine<D>;
  }
  void addBlock(const Bodies<D>& bodies, IndexedSpan<const Manifold<D>> all, std::span<const int> members, int lanes,
                bool friction) {
    const Manifold<D>& first = all[members[0]];
    const bool hasFriction = friction && first.friction > 0;
    const std::size_t at = m_end * (64 / sizeof(Real)), n = static_cast<std::size_t>(lanes);
    blocks.push_back({at, offsets.size(), lanes, first.count, hasFriction});
    offsets.resize(offsets.size() + 5 * n, kNothing);
    std::int32_t* const to = offsets.data() + offsets.size() - 5 * n;
    const auto manifoldOffset = [&](int k) {
      return static_cast<std::int32_t>(static_cast<std::size_t>(k) * (sizeof(Manifold<D>) / sizeof(Real)));
    };
    std::fill_n(to + 2 * n, 2 * n, kNowhere);
    std::fill_n(to + 4 * n, n, manifoldOffset(members[0]));
    for (std::size_t lane = 0; lane < members.size(); ++lane) {
      const Manifold<D>& m = all[members[lane]];
      to[4 * n + lane] = manifoldOffset(members[lane]);
      places.push_back({at + lane, lanes, m.count, m.bodyA, m.bodyB, members[lane], hasFriction});
      for (int side = 0; side < 2; ++side) {
        const std::int32_t body = side == 0 ? m.bodyA : m.bodyB, line = lineOf(body);
        to[static_cast<std::size_t>(side) * n + lane] = line;
        if (bodies.type[body] == BodyType::dynamic) to[static_cast<std::size_t>(2 + side) * n + lane] = line;
      }
    }
    const std::size_t size = n * static_cast<std::size_t>(Layout::kManifold + first.count * Layout::kPoint);
    m_end += (size * sizeof(Real) + 63) / 64;
    m_rows += members.size() * static_cast<std::uint64_t>(first.count * (hasFriction ? D : 1));
  }
  std::vector<Chunk> m_numbers;
  std::size_t m_end = 0;  // chunks in use
  std::uint64_t m_rows = 0;
  IndexedVector<std::int32_t> m_line, m_bodies;                         // by body, and body by line
  std::array<std::vector<int>, 2 * (kManifoldPoints<D> + 1)> m_sorted;  // by 2 x points + friction
};

}}}  // namespace lpc::LPC_PRECISION::solver
