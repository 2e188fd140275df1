// SPDX-License-Identifier: Zlib
// Bodies added by a key or continuously: random polygons, fireworks, meteors, rain. They come from the scripts of these
// names (experiments/scripts), at positions in this window.
#include <cmath>

#include "experiments/parse/toml_reader.h"
#include "experiments/runner/locations.h"
#include "experiments/sandbox/app.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

constexpr int kShowEvery = 60;  // steps between two fireworks

// A script by its name, in an empty scene.
const SceneFile& scriptNamed(const std::string& name) {
  static std::map<std::string, SceneFile> read;
  const auto it = read.find(name);
  if (it != read.end()) return it->second;
  const std::string path = findToml("scripts", name);
  return read
      .emplace(name, SceneFile::parse("name = \"empty\"\nsummary = \"nobody\"\ndimensions = [2, 3]\n", "empty",
                                      readFile(path), path))
      .first->second;
}

long everyOf(const char* script) { return std::lround(scriptNamed(script).parameter("pause")->value.number); }

}  // namespace

template <int D>
Real App<D>::chance(Real lo, Real hi) {
  return static_cast<Real>(m_random.uniform(static_cast<double>(lo), static_cast<double>(hi)));
}

// All bodies of a script.
template <int D>
void App<D>::bring(const char* script, const ParameterValues& given) {
  for (const auto& spawn : scriptNamed(script).build<D>(given, m_random.next()).spawns) {
    session.perform(AddBody<D>{spawn.body});
  }
}

template <int D>
void App<D>::bringOne(const char* script, const Vec<D>& at) {
  BodyDef<D> def = scriptNamed(script).build<D>({{"begin", 0.0}, {"end", 1.0}}, m_random.next()).spawns.front().body;
  def.X_WB.p = at;
  session.perform(AddBody<D>{std::move(def)});
}

template <int D>
void App<D>::burst(const Vec<D>& at) {
  ParameterValues place;
  for (int d = 0; d < D; ++d) place[std::string(1, "xyz"[d])] = static_cast<double>(at[d]);
  bring("firework", place);
}

template <int D>
void App<D>::spawnPolygon() {
  bringOne("polygons", freePoint(session.world(), camera, hand.cursor()));
}

template <int D>
void App<D>::fireworks() {
  burst(freePoint(session.world(), camera, hand.cursor()));
}

template <int D>
void App<D>::spawnDue() {
  const long step = session.steps();
  // Above the visible part.
  const auto above = [&](Real share) {
    const Vec<2> pixel(static_cast<Real>(camera.left()) + share * static_cast<Real>(camera.width()),
                       static_cast<Real>(camera.top()));
    Vec<D> at = onPlane<D>(camera, pixel, camera.origin());
    if constexpr (D == 3) at[2] += chance(-1, 1) * (camera.eye() - camera.origin()).norm() / 4;
    return at;
  };
  if (meteors && step % everyOf("meteors") == 0) bringOne("meteors", above(chance(0, Real(0.7))));
  if (rain && step % everyOf("rain") == 0) bringOne("rain", above(chance(Real(0.05), Real(0.95))));
  if (showers && step % kShowEvery == 0) {
    Vec<D> at = above(chance(Real(0.2), Real(0.8)));
    at[1] = (at[1] + camera.origin()[1]) / 2;
    burst(at);
  }
}

#define LPC_SPAWN(D)                                                \
  template Real App<D>::chance(Real, Real);                         \
  template void App<D>::bring(const char*, const ParameterValues&); \
  template void App<D>::bringOne(const char*, const Vec<D>&);       \
  template void App<D>::burst(const Vec<D>&);                       \
  template void App<D>::spawnPolygon();                             \
  template void App<D>::fireworks();                                \
  template void App<D>::spawnDue();
LPC_SPAWN(2)
LPC_SPAWN(3)

}}  // namespace lpc::LPC_PRECISION
