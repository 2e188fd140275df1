// SPDX-License-Identifier: Zlib
#include "experiments/trial/measure/ghost_hits.h"

#include <algorithm>

namespace lpc { inline namespace LPC_PRECISION {

template <int D>
GhostHits<D>::GhostHits() : m_cast(createStage<TimeOfImpact<D>>({"bilateral", {}})) {}

template <int D>
void GhostHits<D>::before(const Simulation<D>& world) {
  m_pose = world.bodies().pose, m_motion = world.bodies().motion;
}

template <int D>
void GhostHits<D>::observe(const Simulation<D>& world, double dt) {
  const auto contacts = world.contacts();
  m_told = contacts.has_value();
  if (!m_told) return;
  for (const Manifold<D>& m : *contacts) {
    bool pushes = false, near = false;
    for (int k = 0; k < m.count; ++k) {
      const ContactPoint<D>& c = m.points[static_cast<std::size_t>(k)];
      pushes = pushes || c.load > 0;
      near = near || c.separation <= world.settings().margin;
    }
    m_count += pushes && !near && misses(world, m, static_cast<Real>(dt));
  }
}

template <int D>
bool GhostHits<D>::misses(const Simulation<D>& world, const Manifold<D>& m, Real dt) {
  const auto moving = [&](std::int32_t shape, std::int32_t wanted, ShapeView<D>& view, ShapeMotion<D>& motion) {
    const ShapeRecord<D>& record = world.shapes()[static_cast<std::size_t>(shape)];
    const auto body = static_cast<std::size_t>(record.body);
    std::int32_t number = 0;
    forParts(record.shape, record.X_CS, [&](const ShapeView<D>& part, const Pose<D>& X_CP) {
      if (number++ == wanted) view = part, motion.X_CS = X_CP;
    });
    motion.X_WC = m_pose[body], motion.motion = m_motion[body];
    if (world.bodies().type[body] == BodyType::dynamic) {
      motion.motion.v += dt * world.bodies().gravityScale[body] * world.settings().gravity;
    }
  };
  MovingPair<D> pair;
  moving(m.shapeA, m.partA, pair.a, pair.A);
  moving(m.shapeB, m.partB, pair.b, pair.B);
  if (pair.a.kind > pair.b.kind) std::swap(pair.a, pair.b), std::swap(pair.A, pair.B);
  TimeOfImpactAnswer<D> answer;
  WorkDone work;
  m_cast->cast({&pair, 1}, dt, {&answer, 1}, work);
  return answer.status == QueryStatus::converged && !answer.hit;
}

template class GhostHits<2>;
template class GhostHits<3>;

}}  // namespace lpc::LPC_PRECISION
