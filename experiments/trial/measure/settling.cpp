// SPDX-License-Identifier: Zlib
#include "experiments/trial/measure/settling.h"

#include <algorithm>
#include <cmath>

#include "experiments/trial/measure/metric.h"
#include "framework/math/worse.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

double turnBetween(const Rot<2>& a, const Rot<2>& b) { return std::abs(double((a.inverse() * b).radians())); }
double turnBetween(const Rot<3>& a, const Rot<3>& b) {
  const Rot<3> q = a.inverse() * b;
  return 2 * std::atan2(double(q.imag().norm()), std::abs(double(q.w)));
}

}  // namespace

template <int D>
void Settling<D>::start(const Simulation<D>& world, std::vector<std::int32_t> slots) {
  m_bodies.clear();
  for (const std::int32_t slot : slots) {
    const auto i = static_cast<std::size_t>(slot);
    m_bodies.push_back({slot, world.bodies().generation[i], world.bodies().pose[i]});
  }
}

template <int D>
void Settling<D>::observe(const Simulation<D>& world, double dt) {
  const Bodies<D>& b = world.bodies();
  const Vec<D> gravity = world.settings().gravity;
  const double g = gravity.norm();
  const Vec<D> down = g > 0 ? Vec<D>(gravity / static_cast<Real>(g)) : Vec<D>(Vec<D>::Zero());
  double speed = 0;
  sag = rise = lateral = tilt = 0;
  std::vector<Vec<D>> positions;
  positions.reserve(m_bodies.size());
  for (const Body& body : m_bodies) {
    const auto i = static_cast<std::size_t>(body.slot);
    const bool here = b.used[i] && b.generation[i] == body.generation;
    positions.push_back(here ? b.pose[i].p : Vec<D>(Vec<D>::Constant(static_cast<Real>(kNaN))));
    if (!here) continue;
    const Vec<D> way = b.pose[i].p - body.start.p;
    const Real along = way.dot(down);
    sag = worse(sag, along), rise = worse(rise, -along);
    lateral = worse(lateral, (way - along * down).norm());
    tilt = worse(tilt, turnBetween(body.start.q, b.pose[i].q));
    speed = worse(speed, b.motion[i].v.norm());
  }
  lateralMax = worse(lateralMax, lateral), m_down = down;
  if (m_window == 0) m_window = static_cast<std::size_t>(std::clamp(std::round(kLast / dt), 1.0, 1e15));
  // A short run of tiny steps never fills the window.
  if (m_positions.size() < m_window + 1) m_positions.emplace_back(), m_speeds.emplace_back();
  m_positions[m_steps % m_positions.size()] = std::move(positions);
  m_speeds[m_steps % m_speeds.size()] = speed;
  ++m_steps, m_time += dt;
  m_fast = !(speed <= kRestSpeed);
  if (m_fast) m_restSince = m_time;
  if (!m_supports && m_time >= kSettled - dt / 2) m_supports = touching(world);
}

template <int D>
template <class Way>
double Settling<D>::farthest(const Way& way) const {
  if (m_steps <= m_window) return kNaN;
  const auto& now = m_positions[(m_steps - 1) % m_positions.size()];
  const auto& before = m_positions[m_steps % m_positions.size()];
  double farthest = 0;
  for (std::size_t i = 0; i < now.size(); ++i) {
    const double w = way(now[i] - before[i]);
    if (!std::isnan(w)) farthest = std::max(farthest, w);
  }
  return farthest / kLast;
}

template <int D>
double Settling<D>::creep() const {
  return farthest([](const Vec<D>& way) { return double(way.norm()); });
}

template <int D>
double Settling<D>::sinking() const {
  return farthest([this](const Vec<D>& way) { return double(way.dot(m_down)); });
}

template <int D>
double Settling<D>::jitter() const {
  return m_steps <= m_window ? kNaN : quantile(m_speeds, 0.5);
}

template <int D>
std::optional<typename Settling<D>::Pairs> Settling<D>::touching(const Simulation<D>& world) {
  const auto manifolds = world.contacts();
  if (!manifolds) return std::nullopt;
  Pairs pairs;
  for (const Manifold<D>& m : *manifolds) {
    if (!m.ignored) pairs.emplace(m.bodyA, m.bodyB);
  }
  return pairs;
}

template <int D>
std::optional<long> Settling<D>::supportsChanged(const Simulation<D>& world) const {
  if (!m_supports) return std::nullopt;
  const std::optional<Pairs> now = touching(world);
  if (!now) return std::nullopt;
  Pairs other;
  std::set_symmetric_difference(m_supports->begin(), m_supports->end(), now->begin(), now->end(),
                                std::inserter(other, other.end()));
  return static_cast<long>(other.size());
}

template <int D>
bool Settling<D>::stands(const Simulation<D>& world) const {
  const std::optional<Pairs> pairs = touching(world);
  if (!pairs || (m_supports && *pairs != *m_supports)) return false;
  const Bodies<D>& b = world.bodies();
  std::vector<std::uint8_t> held(b.type.size());
  for (std::size_t i = 0; i < held.size(); ++i) held[i] = b.used[i] && b.type[i] != BodyType::dynamic;
  for (bool more = true; more;) {
    more = false;
    for (const auto& [a, c] : *pairs) {
      auto &one = held[static_cast<std::size_t>(a)], &other = held[static_cast<std::size_t>(c)];
      if (one != other) one = other = 1, more = true;
    }
  }
  return std::all_of(m_bodies.begin(), m_bodies.end(),
                     [&](const Body& body) { return held[static_cast<std::size_t>(body.slot)] != 0; });
}

template class Settling<2>;
template class Settling<3>;

}}  // namespace lpc::LPC_PRECISION
