// SPDX-License-Identifier: Zlib
// Angles and rotations in blocks of a scene.
#include <array>
#include <cmath>

#include "experiments/trial/formats/written_rotation.h"
#include "experiments/trial/scene/scene_parsed.h"

namespace lpc { inline namespace LPC_PRECISION {

template <int D>
Ang<D> readAngular(TableReader& table, SceneNumbers& numbers, const std::string& key) {
  const toml::node* n = table.find(key);
  Ang<D> out = Ang<D>::Zero();
  if (!n) return out;
  const Vec<3> v = n->is_array() ? numbers.vector<3>(*n) : Vec<3>(0, 0, static_cast<Real>(numbers.number(*n)));
  if constexpr (D == 2) {
    out[0] = v[2];
  } else {
    out = v;
  }
  return out;
}

template <int D>
Ang<D> readAngle(TableReader& table, SceneNumbers& numbers, const std::string& key) {
  const Ang<D> angle = readAngular<D>(table, numbers, key);
  for (const Real a : angle) {
    if (std::abs(a) <= static_cast<Real>(kLargestAngle)) continue;
    table.fail(*table.find(key), "'" + key + "' is " + asText(a) + "; valid: -" + asText(kLargestAngle) + " to " +
                                     asText(kLargestAngle) + " rad");
  }
  return angle;
}

template <int D>
Rot<D> readRotation(TableReader& table, SceneNumbers& numbers) {
  constexpr std::size_t kNumbers = D == 2 ? 2 : 4;
  const toml::node *given = table.find("rotation"), *angle = table.find("angle");
  if (!given) return rotationOf(readAngle<D>(table, numbers, "angle"));
  if (angle) table.fail(*given, "'rotation' and 'angle' are both given; valid: one of them");
  const toml::array* list = given->as_array();
  std::array<Real, kNumbers> x{};
  const bool other = numbers.rehearsing() && list && list->size() == 6 - kNumbers;  // of the other dimension
  if (!other && (!list || list->size() != kNumbers)) {
    table.fail(*given, "'rotation' is " + describe(*given) + "; valid: a list of " +
                           (D == 2 ? "cosine and sine" : "the four numbers w, x, y, z of a quaternion"));
  }
  for (std::size_t i = 0; i < list->size(); ++i) {
    const auto value = static_cast<Real>(numbers.number(*list->get(i)));
    if (!other) x[i] = value;
  }
  Rot<D> q;
  if constexpr (D == 2) {
    q = {x[0], x[1]};
  } else {
    q = {x[0], x[1], x[2], x[3]};
  }
  if (!numbers.rehearsing() && !takeWritten<D>(q)) table.fail(*given, "'rotation' does not have length 1");
  return numbers.rehearsing() ? Rot<D>{} : q;
}

template Ang<2> readAngle<2>(TableReader&, SceneNumbers&, const std::string&);
template Ang<3> readAngle<3>(TableReader&, SceneNumbers&, const std::string&);
template Ang<2> readAngular<2>(TableReader&, SceneNumbers&, const std::string&);
template Ang<3> readAngular<3>(TableReader&, SceneNumbers&, const std::string&);
template Rot<2> readRotation(TableReader&, SceneNumbers&);
template Rot<3> readRotation(TableReader&, SceneNumbers&);

}}  // namespace lpc::LPC_PRECISION
