// SPDX-License-Identifier: Zlib
#include "experiments/runner/code_identity.h"

#include <sys/utsname.h>
#include <unistd.h>
#include <xxhash.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <set>

#include "experiments/parse/toml_reader.h"
#include "experiments/runner/plugin_probe.h"
#include "experiments/trial/plugin.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using nlohmann::json;

constexpr SourceHash kContents[] = {
#include "content_hashes.inc"
};

std::map<std::string, std::string>& pluginOf() {  // "stage/name" -> hash of the plugin's bytes
  static std::map<std::string, std::string> map;
  return map;
}

std::string keyOf(StageKind stage, const std::string& name) { return std::string(stageName(stage)) + "/" + name; }

bool isHeader(std::string_view path) { return path.ends_with(".h"); }

// Paths and hashes of the sources in a folder.
std::string contentOf(std::string_view folder) {
  std::string all;
  for (const SourceHash& c : kContents) {
    if (c.path.starts_with(folder)) all.append(c.path).append(c.hash);
  }
  return all;
}

bool isOfEngines(const SourceHash& source) { return source.path.starts_with("oracles/engines/"); }
bool isOf(const SourceHash& source, const Registered& entry) {
  return entry.file.ends_with("/" + std::string(source.path));
}
bool isOfAnAlgorithm(const SourceHash& source) {
  const auto& all = Registry::instance().all();
  return std::any_of(all.begin(), all.end(), [&](const auto& item) { return isOf(source, item.second); });
}

std::string codeHash(const Registered& entry) {
  const std::string key = keyOf(entry.stage, entry.info.name);
  if (const auto it = pluginOf().find(key); it != pluginOf().end()) return it->second;
  static std::map<std::string, std::string> known;  // a sweep plans thousands of cells
  auto it = known.find(key);
  if (it == known.end()) it = known.emplace(key, methodHash(entry, kContents)).first;
  return it->second;
}

void addHashes(json& out, StageKind stage, const Spec& spec, int dimension) {
  const Registered& entry = Registry::instance().find(stage, dimension, spec.name);
  out[keyOf(stage, spec.name)] = codeHash(entry);
  for (const SourceHash& c : kContents) {
    if (isOf(c, entry) && !c.library.empty()) out["library"] = c.library;
  }
  for (const ParamInfo& p : entry.params) {
    if (!p.stage) continue;
    if (const Spec* value = spec.find(p.name)) addHashes(out, p.stage->kind, *value, dimension);
  }
}

std::string firstLine(const std::string& path, const std::string& key = "") {
  std::ifstream in(path);
  for (std::string line; std::getline(in, line);) {
    if (!line.starts_with(key)) continue;
    const std::size_t colon = key.empty() ? std::string::npos : line.find(':');
    line = colon == std::string::npos ? line : line.substr(line.find_first_not_of(" \t", colon + 1));
    return line;
  }
  return "unknown";
}

}  // namespace

std::string hexHash(std::string_view bytes) {
  const XXH128_hash_t h = XXH3_128bits(bytes.data(), bytes.size());
  char text[33];
  std::snprintf(text, sizeof text, "%016llx%016llx", static_cast<unsigned long long>(h.high64),
                static_cast<unsigned long long>(h.low64));
  return text;
}

const std::string& coreHash() {
  static const std::string hash = hexHash(std::string(LPC_COMPILER) + "\n" + LPC_FLAGS + "\n" +
                                          contentOf("framework/") + contentOf("experiments/"));
  return hash;
}

std::string judgesHash(std::span<const SourceHash> sources) {
  std::string all;
  for (const SourceHash& s : sources) {
    if (s.path.starts_with("oracles/") && !isOfEngines(s) && !isOfAnAlgorithm(s)) all.append(s.path).append(s.hash);
  }
  return hexHash(all);
}

std::string methodHash(const Registered& entry, std::span<const SourceHash> sources) {
  std::string all;
  for (const SourceHash& c : sources) {
    const StageInfo* home = stageOfPath(c.path);
    const bool ofGroup = home && home->group == stageInfo(entry.stage).group;
    if (ofGroup && (isHeader(c.path) || !isOfAnAlgorithm(c))) all.append(c.path).append(c.hash);
    if (isHeader(c.path) && entry.stage == StageKind::engine && isOfEngines(c)) all.append(c.path).append(c.hash);
  }
  for (const SourceHash& c : sources) {
    if (isOf(c, entry)) all += c.hash;
  }
  return hexHash(all);
}

const std::string& oraclesHash() {
#ifdef LPC_HAS_ORACLES
  static const std::string hash = judgesHash(kContents);
#else
  static const std::string hash = "not built";  // nothing was judged: a build with oracles has to do it all
#endif
  return hash;
}

json codeHashes(StageKind stage, const Spec& spec, int dimension) {
  json out = json::object();
  addHashes(out, stage, spec, dimension);
  return out;
}

bool anyPlugin() { return !pluginOf().empty(); }

bool isOfPlugin(const Registered& entry) { return pluginOf().count(keyOf(entry.stage, entry.info.name)) > 0; }

void adoptPlugin(const std::string& path) {
  if (const auto failure = failureInChild([&] { loadPlugin(path); })) {
    throw UserError("plugin " + path + ": it cannot be loaded: " + *failure);
  }
  std::set<Registry::Key> before;
  for (const auto& [key, entry] : Registry::instance().all()) before.insert(key);
  loadPlugin(path);
  const std::string hash = "plugin:" + hexHash(readFile(path));
  for (const auto& [key, entry] : Registry::instance().all()) {
    if (!before.count(key)) pluginOf()[keyOf(entry.stage, entry.info.name)] = hash;
  }
}

std::string machineDescription() {
  utsname name{};
  uname(&name);
  std::string os = firstLine("/etc/os-release", "PRETTY_NAME=");
  if (os.starts_with("PRETTY_NAME=")) os = os.substr(13, os.size() - 14);
  const double bytes = static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGE_SIZE));
  return json{{"cpu", firstLine("/proc/cpuinfo", "model name")},
              {"cores", sysconf(_SC_NPROCESSORS_ONLN)},
              {"memory_gib", std::round(bytes / 1073741824.0)},
              {"os", os + ", " + name.sysname + " " + name.release},
              {"compiler", LPC_COMPILER},
              {"flags", LPC_FLAGS},
              {"governor", firstLine("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor")}}
      .dump();
}

}}  // namespace lpc::LPC_PRECISION
