// SPDX-License-Identifier: Zlib
// Planted bugs of pair queries; the properties must catch them.
#pragma once

#include <cstring>

#include "framework/shape/support_map.h"
#include "framework/stage/stage_narrowphase.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace wrong_queries {

/// The correct method of all bugs, spoiled by each in its own way.
template <int D>
class SpoiledQuery : public PairQuery<D> {
 public:
  bool supports(ShapeKind a, ShapeKind b) const override { return m_right->supports(a, b); }
  void query(std::span<const PairView<D>> pairs, QueryNeed need, std::span<PairAnswer<D>> answers,
             std::span<PairMemory> memory, WorkDone& work) override {
    m_right->query(pairs, need, answers, {}, work);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      spoil(pairs[i], answers[i], memory.empty() ? nullptr : &memory[i]);
    }
  }

 protected:
  virtual void spoil(const PairView<D>& pair, PairAnswer<D>& answer, PairMemory* memory) = 0;

  static Real along(const PairView<D>& pair, const Vec<D>& n) {
    return pair.X_AB.p.dot(n) - supportValue(pair.a, n) -
           supportValue(pair.b, Vec<D>(pair.X_AB.q.inverse() * Vec<D>(-n)));
  }
  static void setAxis(const PairView<D>& pair, const Vec<D>& n, PairAnswer<D>& answer) {
    answer.normal = n, answer.distance = along(pair, n);
    answer.pA = coreSupport(pair.a, n) + pair.a.radius * n;
    answer.pB = answer.pA + answer.distance * n;
  }

 private:
  std::unique_ptr<PairQuery<D>> m_right = createStage<PairQuery<D>>(Spec{"sat", {}});
};

template <int D>
class FlippedNormal final : public SpoiledQuery<D> {
  void spoil(const PairView<D>&, PairAnswer<D>& answer, PairMemory*) override { answer.normal = -answer.normal; }
};

/// Boxes by face normals alone: the 2009 engine's bug.
template <int D>
class NoEdgeAxes final : public SpoiledQuery<D> {
  void spoil(const PairView<D>& pair, PairAnswer<D>& answer, PairMemory*) override {
    if (pair.a.kind != ShapeKind::box || pair.b.kind != ShapeKind::box || answer.distance >= 0) return;
    answer.distance = -std::numeric_limits<Real>::max();
    const Real least = answer.distance;
    PairAnswer<D> best = answer;
    for (int k = 0; k < D; ++k) {
      for (const Vec<D>& e : {Vec<D>(Vec<D>::Unit(k)), Vec<D>(pair.X_AB.q.matrix().col(k))}) {
        for (const Real sign : {Real(1), Real(-1)}) {
          this->setAxis(pair, sign * e, answer);
          if (answer.distance > best.distance || best.distance == least) best = answer;
        }
      }
    }
    answer = best;
  }
};

/// The error of portal refinement, without its iterations: the depth along the line of centres.
template <int D>
class CentreRayDepth final : public SpoiledQuery<D> {
  void spoil(const PairView<D>& pair, PairAnswer<D>& answer, PairMemory*) override {
    const Real length = pair.X_AB.p.norm();
    if (answer.distance < 0 && length > 0) this->setAxis(pair, pair.X_AB.p / length, answer);
  }
};

/// A tenth of a millimetre counts as contact at any size.
template <int D>
class AbsoluteTolerance final : public SpoiledQuery<D> {
  void spoil(const PairView<D>&, PairAnswer<D>& answer, PairMemory*) override {
    if (std::abs(answer.distance) < Real(1e-4)) answer.distance = 0, answer.pB = answer.pA;
  }
};

/// Ignores the rounding radius of B.
template <int D>
class ForgetsRounding final : public SpoiledQuery<D> {
  void spoil(const PairView<D>& pair, PairAnswer<D>& answer, PairMemory*) override {
    answer.distance += pair.b.radius;
    answer.pB = answer.pA + answer.distance * answer.normal;
  }
};

/// Returns the distance of the last query.
template <int D>
class TrustsItsMemory final : public SpoiledQuery<D> {
  void spoil(const PairView<D>&, PairAnswer<D>& answer, PairMemory* memory) override {
    if (!memory) return;
    Real last = 0;
    std::memcpy(&last, memory->bytes.data(), sizeof last);
    if (last != 0) answer.distance = last;
    std::memcpy(memory->bytes.data(), &answer.distance, sizeof last);
  }
};

/// Takes foreign bytes in the memory, as of a damaged file, for a hint, and the hint for the answer.
template <int D>
class BelievesAnyBytes final : public SpoiledQuery<D> {
  void spoil(const PairView<D>&, PairAnswer<D>& answer, PairMemory* memory) override {
    if (memory && !(*memory == PairMemory{})) answer.distance *= 2;
  }
};

/// Returns A's centre as its closest point although it is deep inside B.
template <int D>
class CentreWitness final : public SpoiledQuery<D> {
  void spoil(const PairView<D>&, PairAnswer<D>& answer, PairMemory*) override {
    answer.pA = Vec<D>::Zero(), answer.pB = answer.distance * answer.normal;
  }
};

/// Compares unrotated boxes by their intervals: beyond a corner, the widest gap is returned as the distance.
template <int D>
class AxisAlignedShortcut final : public SpoiledQuery<D> {
  void spoil(const PairView<D>& pair, PairAnswer<D>& answer, PairMemory*) override {
    if (pair.a.kind != ShapeKind::box || pair.b.kind != ShapeKind::box) return;
    if (pair.X_AB.q.matrix() != Mat<D>::Identity()) return;
    int widest = 0;
    const Vec<D> gap = pair.X_AB.p.cwiseAbs() - pair.a.half - pair.b.half;
    gap.maxCoeff(&widest);
    this->setAxis(pair, (pair.X_AB.p[widest] < 0 ? Real(-1) : Real(1)) * Vec<D>(Vec<D>::Unit(widest)), answer);
  }
};

/// A search that starts along x and never turns back.
template <int D>
class NeverTurnsBack final : public SpoiledQuery<D> {
  void spoil(const PairView<D>& pair, PairAnswer<D>& answer, PairMemory*) override {
    if (answer.normal[0] < 0) this->setAxis(pair, Vec<D>(-Vec<D>::Unit(0)), answer);
  }
};

/// Returns half the depth.
template <int D>
class HalfDepth final : public SpoiledQuery<D> {
  void spoil(const PairView<D>&, PairAnswer<D>& answer, PairMemory*) override {
    if (answer.distance < 0) answer.distance /= 2, answer.pB = answer.pA + answer.distance * answer.normal;
  }
};

/// Counts the rounding radius twice when the shapes penetrate.
template <int D>
class RoundingTwiceInside final : public SpoiledQuery<D> {
  void spoil(const PairView<D>& pair, PairAnswer<D>& answer, PairMemory*) override {
    if (answer.distance < 0) answer.distance -= pair.a.radius;
    answer.pB = answer.pA + answer.distance * answer.normal;
  }
};

/// Returns a cut-off of the search as the distance.
template <int D>
class ReportsItsCutOff final : public SpoiledQuery<D> {
  void spoil(const PairView<D>& pair, PairAnswer<D>& answer, PairMemory*) override {
    answer.distance = std::min(answer.distance, (pair.a.half.norm() + pair.a.radius) / 4);
  }
};

/// For a boolean query, compares bounding spheres.
template <int D>
class SphereBoolean final : public SpoiledQuery<D> {
 public:
  void query(std::span<const PairView<D>> pairs, QueryNeed need, std::span<PairAnswer<D>> answers,
             std::span<PairMemory> memory, WorkDone& work) override {
    m_boolean = need == QueryNeed::boolean;
    SpoiledQuery<D>::query(pairs, need, answers, memory, work);
  }

 private:
  void spoil(const PairView<D>& pair, PairAnswer<D>& answer, PairMemory*) override {
    if (m_boolean) answer.distance = pair.X_AB.p.norm() - boundingRadius(pair.a) - boundingRadius(pair.b);
  }
  bool m_boolean = false;
};

/// No normal where the shapes just touch.
template <int D>
class NoNormalAtTouch final : public SpoiledQuery<D> {
  void spoil(const PairView<D>& pair, PairAnswer<D>& answer, PairMemory*) override {
    if (std::abs(answer.distance) <= Real(1e-5) * boundingRadius(pair.a)) answer.normal = Vec<D>::Zero();
  }
};

/// Climbs along the list of vertices and stops at the first local maximum.
template <int D>
class FirstPeak final : public SpoiledQuery<D> {
  static Real reach(const ShapeView<D>& shape, const Vec<D>& d) {
    if (!shape.hull) return supportValue(shape, d);
    const auto& v = shape.hull->vertices;
    std::size_t i = 0;
    while (i + 1 < v.size() && v[i + 1].dot(d) >= v[i].dot(d)) ++i;
    return v[i].dot(d) + shape.radius * d.norm();
  }
  void spoil(const PairView<D>& pair, PairAnswer<D>& answer, PairMemory*) override {
    const Vec<D>& n = answer.normal;
    answer.distance = pair.X_AB.p.dot(n) - reach(pair.a, n) - reach(pair.b, Vec<D>(pair.X_AB.q.inverse() * Vec<D>(-n)));
  }
};

/// The rounding radius has the wrong sign: a thicker capsule is farther away.
template <int D>
class ThickerIsFarther final : public SpoiledQuery<D> {
  void spoil(const PairView<D>& pair, PairAnswer<D>& answer, PairMemory*) override {
    answer.distance += 2 * pair.a.radius;
  }
};

/// Treats a long box as a line.
template <int D>
class LongBoxIsALine final : public SpoiledQuery<D> {
  void spoil(const PairView<D>& pair, PairAnswer<D>& answer, PairMemory*) override {
    if (pair.a.kind == ShapeKind::box && pair.a.half.maxCoeff() > 3 * pair.a.half.minCoeff()) {
      answer.distance += pair.a.half.minCoeff();
    }
  }
};

/// Ignores the rounding radius of boxes.
template <int D>
class SharpBoxes final : public SpoiledQuery<D> {
  void spoil(const PairView<D>& pair, PairAnswer<D>& answer, PairMemory*) override {
    if (pair.a.kind == ShapeKind::box) answer.distance += pair.a.radius;
  }
};

/// Uses every second vertex of a hull only.
template <int D>
class EverySecondVertex final : public SpoiledQuery<D> {
  static Real reach(const ShapeView<D>& shape, const Vec<D>& d) {
    if (!shape.hull) return supportValue(shape, d);
    Real most = -std::numeric_limits<Real>::max();
    for (std::size_t i = 0; i < shape.hull->vertices.size(); i += 2) {
      most = std::max(most, shape.hull->vertices[i].dot(d));
    }
    return most + shape.radius * d.norm();
  }
  void spoil(const PairView<D>& pair, PairAnswer<D>& answer, PairMemory*) override {
    const Vec<D>& n = answer.normal;
    answer.distance = pair.X_AB.p.dot(n) - reach(pair.a, n) - reach(pair.b, Vec<D>(pair.X_AB.q.inverse() * Vec<D>(-n)));
  }
};

/// Correct except for the last bits, which depend on the unit of length.
template <int D>
class RoundsInMetres final : public SpoiledQuery<D> {
  void spoil(const PairView<D>&, PairAnswer<D>& answer, PairMemory*) override {
    answer.distance = (answer.distance + Real(0.1)) - Real(0.1);
  }
};

/// Treats one axis differently from the others.
template <int D>
class LikesOneAxis final : public SpoiledQuery<D> {
  void spoil(const PairView<D>&, PairAnswer<D>& answer, PairMemory*) override {
    int along = 0;
    answer.normal.cwiseAbs().maxCoeff(&along);
    if (along == 0) answer.distance *= Real(1.001);
  }
};

/// As if points were stored with half the digits: the error grows with the distance from their own origin.
template <int D>
class CoarsePoints final : public SpoiledQuery<D> {
  void spoil(const PairView<D>& pair, PairAnswer<D>& answer, PairMemory*) override {
    const Real step = std::sqrt(std::numeric_limits<Real>::epsilon());
    if (pair.b.hull) answer.distance += step * pair.b.hull->vertices.front().norm();
  }
};

/// Reports convergence although it stopped at its limit.
template <int D>
class SilentLimit final : public PairQuery<D> {
 public:
  explicit SilentLimit(PairQuery<D>& limited) : m_limited(limited) {}
  bool supports(ShapeKind a, ShapeKind b) const override { return m_limited.supports(a, b); }
  void query(std::span<const PairView<D>> pairs, QueryNeed need, std::span<PairAnswer<D>> answers,
             std::span<PairMemory> memory, WorkDone& work) override {
    m_limited.query(pairs, need, answers, memory, work);
    for (PairAnswer<D>& answer : answers) answer.status = QueryStatus::converged;
  }

 private:
  PairQuery<D>& m_limited;
};

}}}}  // namespace lpc::LPC_PRECISION::test::wrong_queries
