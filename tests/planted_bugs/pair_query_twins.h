// SPDX-License-Identifier: Zlib
// Pair queries with one bug each; the properties must see them.
#pragma once

#include <cstring>

#include "framework/stage_narrowphase.h"
#include "framework/support_map.h"

namespace lpc::inline LPC_PRECISION::test::wrong_queries {

/// A right method, spoiled.
template <int D>
class SpoiledQuery : public PairQuery<D> {
 public:
  bool supports(ShapeKind a, ShapeKind b) const override { return m_right->supports(a, b); }
  void query(const PairBatch<D>& batch, Need need, PairAnswers<D>& answers, std::span<PairMemory> memory,
             Work& work) override {
    m_right->query(batch, need, answers, {}, work);
    for (int i = 0; i < batch.count; ++i) {
      PairAnswer<D> answer = answers.get(i);
      spoil(batch.pair(i), answer, memory.empty() ? nullptr : &memory[static_cast<std::size_t>(i)]);
      answers.set(i, answer);
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

/// Boxes by face normals alone: the 2009 engine's bug in its purest form.
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

/// Portal refinement's error, without its iterations: the depth along the line of centres.
template <int D>
class CentreRayDepth final : public SpoiledQuery<D> {
  void spoil(const PairView<D>& pair, PairAnswer<D>& answer, PairMemory*) override {
    const Real length = pair.X_AB.p.norm();
    if (answer.distance < 0 && length > 0) this->setAxis(pair, pair.X_AB.p / length, answer);
  }
};

/// A tenth of a millimetre is contact, whatever the size.
template <int D>
class AbsoluteTolerance final : public SpoiledQuery<D> {
  void spoil(const PairView<D>&, PairAnswer<D>& answer, PairMemory*) override {
    if (std::abs(answer.distance) < Real(1e-4)) answer.distance = 0, answer.pB = answer.pA;
  }
};

/// The other shape's rounding is forgotten.
template <int D>
class ForgetsRounding final : public SpoiledQuery<D> {
  void spoil(const PairView<D>& pair, PairAnswer<D>& answer, PairMemory*) override {
    answer.distance += pair.b.radius;
    answer.pB = answer.pA + answer.distance * answer.normal;
  }
};

/// What was true last time is still true.
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

/// Deep inside B, A's centre is called a witness.
template <int D>
class CentreWitness final : public SpoiledQuery<D> {
  void spoil(const PairView<D>&, PairAnswer<D>& answer, PairMemory*) override {
    answer.pA = Vec<D>::Zero(), answer.pB = answer.distance * answer.normal;
  }
};

}  // namespace lpc::inline LPC_PRECISION::test::wrong_queries
