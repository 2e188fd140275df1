// SPDX-License-Identifier: Zlib
#include "experiments/sandbox/competitor_colours.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <set>

#include "framework/stage/registry.h"
#include "framework/world/stage_engine.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

// PALETTE and SHADES of reports/style.py; a test of the sandbox compares them.
constexpr std::size_t kPalette = 12;
constexpr std::array<DrawColour, 2 * kPalette> kColours = {
    {{0xd5, 0x5e, 0x00}, {0x00, 0x72, 0xb2}, {0x00, 0x9e, 0x73}, {0xcc, 0x79, 0xa7}, {0xe6, 0x9f, 0x00},
     {0x56, 0xb4, 0xe9}, {0x33, 0x22, 0x88}, {0x88, 0x22, 0x55}, {0x44, 0xaa, 0x99}, {0x99, 0x99, 0x33},
     {0x66, 0x11, 0x00}, {0x77, 0x77, 0x77}, {0x8c, 0x3e, 0x00}, {0x66, 0xaa, 0xd1}, {0x00, 0x57, 0x3f},
     {0x7a, 0x3e, 0x61}, {0x8a, 0x5f, 0x00}, {0x1f, 0x6f, 0x9e}, {0x8a, 0x7f, 0xc9}, {0xc9, 0x8a, 0xa3},
     {0x1e, 0x5f, 0x55}, {0x5a, 0x5a, 0x10}, {0xb5, 0x80, 0x6f}, {0x33, 0x33, 0x33}}};

std::array<double, 3> labOf(const DrawColour& c) {
  const auto linear = [](unsigned char x) {
    const double part = x / 255.0;
    return part <= 0.04045 ? part / 12.92 : std::pow((part + 0.055) / 1.055, 2.4);
  };
  const double r = linear(c.red), g = linear(c.green), b = linear(c.blue);
  const auto bent = [](double x) { return x > 0.008856 ? std::cbrt(x) : 7.787 * x + 16.0 / 116; };
  const double x = bent((0.4124 * r + 0.3576 * g + 0.1805 * b) / 0.95047);
  const double y = bent(0.2126 * r + 0.7152 * g + 0.0722 * b);
  const double z = bent((0.0193 * r + 0.1192 * g + 0.9505 * b) / 1.08883);
  return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

// As in zlib.
std::uint32_t crc32(std::string_view text) {
  std::uint32_t crc = ~0u;
  for (const char c : text) {
    crc ^= static_cast<unsigned char>(c);
    for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ (crc & 1 ? 0xedb88320u : 0);
  }
  return ~crc;
}

// The families of methods that occur together in charts, in the report's order of colours: competitors, the rest of the
// group, and engines, which are drawn with resolvers.
std::vector<std::string> familiesOf(std::string_view group) {
  std::vector<std::string> out, others;
  std::set<std::pair<StageKind, std::string>> seen;
  for (const auto& [key, entry] : Registry::instance().all()) {
    if (stageInfo(entry.stage).group != group || !seen.insert({entry.stage, entry.info.name}).second) continue;
    (entry.info.role == AlgorithmRole::competitor ? out : others).push_back(entry.info.name);
  }
  out.insert(out.end(), others.begin(), others.end());
  if (group != stageInfo(StageKind::solver).group) return out;
  std::set<std::string> engines;
  for (const auto& [key, entry] : Registry::instance().all()) {
    if (entry.stage == StageKind::engine) engines.insert(entry.info.name);
  }
  out.insert(out.end(), engines.begin(), engines.end());
  return out;
}

// The place preferred by the name's hash, or the next free one: first in the palette, then in its shades.
DrawColour reportColour(std::string_view group, const std::string& family) {
  std::map<std::string, std::size_t> places;
  std::set<std::size_t> used;
  for (const std::string& name : familiesOf(group)) {
    if (places.contains(name)) continue;
    const std::size_t ring = places.size() / kPalette * kPalette, first = crc32(name) % kPalette;
    for (std::size_t step = 0; !places.contains(name); ++step) {
      const std::size_t place = ring + (first + step) % kPalette;
      if (used.insert(place).second) places[name] = place;
    }
  }
  const auto at = places.find(family);
  return kColours[(at == places.end() ? crc32(family) % kPalette : at->second) % kColours.size()];
}

// In charts of stages a method is named by the varying stage; if several vary, or none, by the solver.
StageKind varyingStage(const std::vector<Pipeline>& pipelines, bool engines) {
  const auto varies = [&](StageKind kind) {
    return std::any_of(pipelines.begin(), pipelines.end(),
                       [&](const Pipeline& p) { return p[kind] != pipelines.front()[kind]; });
  };
  if (engines || varies(StageKind::solver)) return StageKind::solver;
  for (const StageKind kind : kWorldStages) {
    if (varies(kind)) return kind;
  }
  return StageKind::solver;
}

}  // namespace

double difference(const DrawColour& a, const DrawColour& b) {
  const auto x = labOf(a), y = labOf(b);
  return std::sqrt((x[0] - y[0]) * (x[0] - y[0]) + (x[1] - y[1]) * (x[1] - y[1]) + (x[2] - y[2]) * (x[2] - y[2]));
}

std::vector<DrawColour> competitorColours(const std::vector<std::string>& texts, int dimension) {
  std::vector<Pipeline> pipelines;
  for (const std::string& text : texts) {
    if (!engineOf(text)) pipelines.push_back(Pipeline::parse(canonicalText(Pipeline::parse(text), dimension)));
  }
  const StageKind stage = varyingStage(pipelines, pipelines.size() < texts.size());
  std::vector<std::optional<DrawColour>> out(texts.size());
  const auto nearest = [&](const DrawColour& c) {
    double least = 1e9;
    for (const auto& taken : out) least = taken ? std::min(least, difference(c, *taken)) : least;
    return least;
  };
  std::size_t next = 0;
  for (std::size_t competitor = 0; competitor < texts.size(); ++competitor) {  // all families before repeated ones
    const auto engine = engineOf(texts[competitor]);
    const Spec& spec = engine ? *engine : pipelines[next++][stage];
    const Spec* velocity = spec.find("velocity");  // charts name a split solver by it
    const DrawColour wanted = reportColour(stageInfo(stage).group, velocity ? velocity->name : spec.name);
    if (nearest(wanted) >= kToldApart) out[competitor] = wanted;
  }
  std::vector<DrawColour> all;
  for (auto& colour : out) {
    if (!colour) {
      colour = *std::max_element(kColours.begin(), kColours.begin() + kPalette,
                                 [&](const DrawColour& a, const DrawColour& b) { return nearest(a) < nearest(b); });
    }
    all.push_back(*colour);
  }
  return all;
}

}}  // namespace lpc::LPC_PRECISION
