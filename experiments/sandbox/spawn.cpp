// SPDX-License-Identifier: Zlib
// What comes by a key or by itself: random polygons, fireworks, meteors, rain. The numbers are those of the scripts of
// the same names in experiments/scripts.
#include <cmath>

#include "experiments/sandbox/app.h"

namespace lpc::inline LPC_PRECISION {
namespace {

constexpr double kPi = 3.14159265358979323846;

Vec<2> onCircle(double turn) { return {static_cast<Real>(std::cos(turn)), static_cast<Real>(std::sin(turn))}; }

// The i-th of n directions: a circle's, or of a spiral of equal areas on the sphere.
Vec<2> direction(int i, int n, const Vec<2>&) { return onCircle(2 * kPi * (i + 0.5) / n); }
Vec<3> direction(int i, int n, const Vec<3>&) {
  const Real w = 1 - static_cast<Real>(2 * i + 1) / static_cast<Real>(n);
  const Vec<2> flat = std::sqrt(1 - w * w) * onCircle(kPi * (3 - std::sqrt(5.0)) * i);
  return {flat[0], flat[1], w};
}

}  // namespace

template <int D>
Real App<D>::chance(Real lo, Real hi) {
  return static_cast<Real>(m_random.uniform(static_cast<double>(lo), static_cast<double>(hi)));
}

template <int D>
void App<D>::addCircle(const Vec<D>& at, const Vec<D>& velocity, Real radius, Real density) {
  BodyDef<D> def;
  def.X_WB.p = at, def.velocity = velocity;
  def.shapes.push_back({.shape = Shape<D>::sphere(radius), .density = density});
  session.perform(AddBody<D>{std::move(def)});
}

template <int D>
void App<D>::spawnPolygon() {
  const int corners = std::max(D + 1, 3 + static_cast<int>(m_random.below(6)));
  constexpr Real kSize = Real(0.5);  // m
  std::vector<Vec<D>> points;
  while (static_cast<int>(points.size()) < corners) {
    Vec<D> p;
    for (int d = 0; d < D; ++d) p[d] = chance(-1, 1);
    if (p.norm() > Real(0.1)) points.push_back(kSize / p.norm() * p);
  }
  BodyDef<D> def;
  def.X_WB.p = freePoint(session.world(), camera, hand.cursor());
  def.shapes.push_back({.shape = Shape<D>::polytope(points)});
  session.perform(AddBody<D>{std::move(def)});
}

template <int D>
void App<D>::fireworks() {
  burst(freePoint(session.world(), camera, hand.cursor()));
}

template <int D>
void App<D>::burst(const Vec<D>& at) {
  constexpr int kSparks = 36;
  constexpr Real kRadius = Real(0.05), kSpeed = 10;  // m, m/s
  const Real far = kRadius * (1 + (D == 2 ? Real(kSparks) / 3 : Real(1.2) * std::sqrt(Real(kSparks))));
  for (int i = 0; i < kSparks; ++i) {
    const Vec<D> way = direction(i, kSparks, Vec<D>(Vec<D>::Zero()));
    addCircle(at + far * way, kSpeed * way, kRadius, 1);
  }
}

template <int D>
void App<D>::spawnDue() {
  const long step = session.steps();
  // Above what is seen.
  const auto above = [&](Real share) {
    const Vec<2> pixel(static_cast<Real>(camera.left()) + share * static_cast<Real>(camera.width()),
                       static_cast<Real>(camera.top()));
    Vec<D> at = onPlane<D>(camera, pixel, camera.origin());
    if constexpr (D == 3) at[2] += chance(-1, 1) * (camera.eye() - camera.origin()).norm() / 4;
    return at;
  };
  if (meteors && step % 20 == 0) {
    Vec<D> v = Vec<D>::Zero();
    v[0] = 30 * std::sqrt(Real(0.1)), v[1] = -30 * std::sqrt(Real(0.9));
    addCircle(above(chance(0, Real(0.7))), v, Real(0.6), 10);
  }
  if (rain && step % 3 == 0) addCircle(above(chance(Real(0.05), Real(0.95))), Vec<D>::Zero(), Real(0.1), 1);
  if (showers && step % 60 == 0) {
    Vec<D> at = above(chance(Real(0.2), Real(0.8)));
    at[1] = (at[1] + camera.origin()[1]) / 2;
    burst(at);
  }
}

#define LPC_SPAWN(D)                                                         \
  template Real App<D>::chance(Real, Real);                                  \
  template void App<D>::addCircle(const Vec<D>&, const Vec<D>&, Real, Real); \
  template void App<D>::spawnPolygon();                                      \
  template void App<D>::fireworks();                                         \
  template void App<D>::burst(const Vec<D>&);                                \
  template void App<D>::spawnDue();
LPC_SPAWN(2)
LPC_SPAWN(3)

}  // namespace lpc::inline LPC_PRECISION
