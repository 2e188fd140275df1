// SPDX-License-Identifier: Zlib
// Two shapes on two bodies, as the input of a contact generator, and the truth about its answer.
#pragma once

#include <memory>

#include "framework/math/tolerances.h"
#include "framework/stage/stage_narrowphase.h"
#include "oracles/referee/referee.h"
#include "tests/generators.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test {

template <int D>
struct ContactScene {
  std::vector<ShapeRecord<D>> shapes;
  std::vector<Pose<D>> pose;
  Real margin;

  /// X_CS is the pose of each shape in its body: the frames may differ.
  ContactScene(const Shape<D>& a, const Shape<D>& b, const Pose<D>& X_WA, const Pose<D>& X_WB, Real contactMargin,
               const Pose<D>& X_CSa = {}, const Pose<D>& X_CSb = {})
      : margin(contactMargin) {
    shapes.push_back({.shape = a, .X_CS = X_CSa, .body = 0});
    shapes.push_back({.shape = b, .X_CS = X_CSb, .body = 1});
    pose = {X_WA * X_CSa.inverse(), X_WB * X_CSb.inverse()};
  }
  ContactScene(const ShapePairCase<D>& c, Real contactMargin) : ContactScene(c.a, c.b, c.X_WA, c.X_WB, contactMargin) {}

  /// The same scene with the bodies swapped.
  ContactScene swapped() const {
    ContactScene s = *this;
    std::swap(s.shapes[0], s.shapes[1]), std::swap(s.pose[0], s.pose[1]);
    s.shapes[0].body = 0, s.shapes[1].body = 1;
    return s;
  }
  const ShapeView<D>& view(std::size_t i) const { return shapes[i].shape.view(); }
  Pose<D> shapePose(std::size_t i) const { return pose[i] * shapes[i].X_CS; }
  Real trueDistance() const {
    return static_cast<Real>(referee<D>(view(0), shapePose(0), view(1), shapePose(1)).interval().middle());
  }
  /// Largest size or position (m); rounding scales with it.
  Real extent() const {
    Real s = boundingRadius(view(0)) + boundingRadius(view(1));
    for (int i : {0, 1}) {
      s += pose[static_cast<std::size_t>(i)].p.norm() + shapes[static_cast<std::size_t>(i)].X_CS.p.norm();
    }
    return s;
  }
  Real rounding() const { return 1000 * kEps * extent(); }
  /// How much worse (m) a feature may be that a generator prefers: a tenth of the slop, at most 1 % of the smaller
  /// shape.
  Real tolerance() const {
    const auto coreSize = [](const ShapeView<D>& s) {
      return s.kind == ShapeKind::sphere ? std::numeric_limits<Real>::max() : boundingRadius(s) - s.radius;
    };
    return std::min(kLinearSlop / 10, Real(0.01) * std::min(coreSize(view(0)), coreSize(view(1)))) + rounding();
  }

  /// `old`: the generator's manifolds of the previous step.
  std::vector<Manifold<D>> run(ContactGenerator<D>& generator, std::span<const Manifold<D>> old = {}) const {
    const ShapePair pair{0, 1};
    PartPairs<D> partPairs;
    WorkDone work;
    const auto convexPairs = partPairs.of({&pair, 1}, shapes, pose, margin, work);
    std::vector<Manifold<D>> fresh;
    generator.generate({convexPairs, shapes, pose, margin, true, {}, {}, old}, fresh, work);
    return fresh;
  }
};

template <int D>
Real deepest(const Manifold<D>& m) {
  Real s = std::numeric_limits<Real>::infinity();
  for (int i = 0; i < m.count; ++i) s = std::min(s, m.points[static_cast<std::size_t>(i)].separation);
  return s;
}

/// Signed distance of a world point to shape i.
template <int D>
Real pointDistance(const ContactScene<D>& scene, std::size_t i, const Vec<D>& p_W) {
  const auto point = Shape<D>::sphere(0);
  const RefereeAnswer<D> truth = referee<D>(point.view(), {p_W, {}}, scene.view(i), scene.shapePose(i));
  return static_cast<Real>(truth.interval().middle());
}

/// The separation of the shapes along the world direction n.
template <int D>
Real worldSeparation(const ContactScene<D>& scene, const Vec<D>& n) {
  const Interval along = separationAlong<D>(scene.view(0), scene.shapePose(0), scene.view(1), scene.shapePose(1),
                                            n.template cast<double>());
  return static_cast<Real>(along.middle());
}

}}}  // namespace lpc::LPC_PRECISION::test
