// SPDX-License-Identifier: Zlib
// Stages that equal another one except for the last bit of one number in one call, as if a compiler rounded
// differently.
#pragma once

#include <cmath>
#include <limits>

#include "framework/stage/stage_narrowphase.h"
#include "framework/stage/stage_solver.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test {

inline constexpr int kUlpCall = 20;  // the step, counted from 0, in which the bit changes

inline void addUlp(Real& x) { x = std::nextafter(x, std::numeric_limits<Real>::infinity()); }

/// sat_clip, except for the separation of the last contact.
template <int D>
class UlpContacts final : public ContactGenerator<D> {
 public:
  using Params = NoParams;
  explicit UlpContacts(const Params&) : m_inner(createStage<ContactGenerator<D>>({"sat_clip", {}})) {}
  static AlgorithmInfo info() {
    return {.name = "ulp_contacts", .summary = "planted bug", .paper = "", .complexity = "1"};
  }

  bool supports(ShapeKind a, ShapeKind b) const override { return m_inner->supports(a, b); }
  void generate(const ContactInput<D>& in, std::vector<Manifold<D>>& fresh, WorkDone& work) override {
    m_inner->generate(in, fresh, work);
    if (m_call++ == kUlpCall && !fresh.empty()) addUlp(fresh.back().points[0].separation);
  }

 private:
  std::unique_ptr<ContactGenerator<D>> m_inner;
  int m_call = 0;
};

/// catto, except for one component of the velocity of body 3.
template <int D>
class UlpVelocity final : public VelocityResolver<D> {
 public:
  using Params = NoParams;
  explicit UlpVelocity(const Params&) : m_inner(createStage<VelocityResolver<D>>({"catto", {}})) {}
  static AlgorithmInfo info() {
    return {.name = "ulp_velocity", .summary = "planted bug", .paper = "", .complexity = "1"};
  }

  void solve(const VelocityInput<D>& in) override {
    m_inner->solve(in);
    if (m_call++ == kUlpCall) addUlp(in.bodies.motion[3].v[1]);
  }

 private:
  std::unique_ptr<VelocityResolver<D>> m_inner;
  int m_call = 0;
};

/// split_impulse, except for one coordinate of body 3.
template <int D>
class UlpPosition final : public PositionResolver<D> {
 public:
  using Params = NoParams;
  explicit UlpPosition(const Params&) : m_inner(createStage<PositionResolver<D>>({"split_impulse", {}})) {}
  static AlgorithmInfo info() {
    return {.name = "ulp_position", .summary = "planted bug", .paper = "", .complexity = "1"};
  }

  Real bias(Real separation, Real dt) const override { return m_inner->bias(separation, dt); }
  Real jointBias(Real dt) const override { return m_inner->jointBias(dt); }
  void correct(const PositionInput<D>& in) override {
    m_inner->correct(in);
    if (m_call++ == kUlpCall) addUlp(in.bodies.pose[3].p[0]);
  }

 private:
  std::unique_ptr<PositionResolver<D>> m_inner;
  int m_call = 0;
};

}}}  // namespace lpc::LPC_PRECISION::test
