// SPDX-License-Identifier: Zlib
// Reads a scene's file, and its script's, before anything is built: syntax, header, parameters, meshes.
#include <algorithm>

#include "experiments/trial/scene/scene_parsed.h"
#include "framework/math/names.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

std::string readLine(TableReader& top, const std::string& key) {
  const std::string text = top.requireString(key);
  if (oneLine(text) != text) top.fail(*top.find(key), "'" + key + "' is '" + text + "'; valid: one line of text");
  return text;
}

// Adds the model features of the file.
void readNeeds(TableReader& top, PhysicsModel& model) {
  for (const std::string& need : top.strings("needs")) {
    try {
      setModelFlag(model, need);
    } catch (const UserError& e) {
      top.fail(*top.find("needs"), e.what());
    }
  }
}

void readHeader(TableReader& top, SceneFile::Parsed& out) {
  out.name = readLine(top, "name"), out.summary = readLine(top, "summary");
  const toml::node& dimensions = top.require("dimensions");
  if (!dimensions.is_array())
    top.fail(dimensions, "'dimensions' is " + describe(dimensions) + "; valid: [2], [3], [2, 3]");
  for (const toml::node& n : *dimensions.as_array()) {
    const auto d = n.value<std::int64_t>();
    if (!d || (*d != 2 && *d != 3)) top.fail(n, "'dimensions' holds " + describe(n) + "; valid: 2, 3");
    out.dimensions.push_back(static_cast<int>(*d));
  }
  if (out.dimensions.empty()) top.fail(dimensions, "'dimensions' is empty; valid: [2], [3], [2, 3]");
  const long seed = top.integer("seed", 1);
  if (seed < 0) top.fail(*top.find("seed"), "'seed' is " + std::to_string(seed) + "; valid: 0 or more");
  out.seed = static_cast<std::uint64_t>(seed);
  out.model = modelFromText("");
  readNeeds(top, out.model);
  out.parameters = readParameters(top);
}

}  // namespace

SceneFile SceneFile::load(const std::string& path) { return load(path, ""); }
SceneFile SceneFile::parse(std::string bytes, const std::string& path) { return parse(std::move(bytes), path, "", ""); }
SceneFile SceneFile::load(const std::string& path, const std::string& scriptPath) {
  return parse(readFile(path), path, scriptPath.empty() ? "" : readFile(scriptPath), scriptPath);
}

SceneFile SceneFile::parse(std::string bytes, const std::string& path, std::string scriptBytes,
                           const std::string& scriptPath) {
  auto parsed = std::make_shared<Parsed>();
  parsed->path = path;
  parsed->bytes = std::move(bytes);
  parsed->table = parseToml(parsed->bytes, path);
  TableReader top(parsed->table, path, "the scene");
  readHeader(top, *parsed);
  parsed->saved = readSaved(top, *parsed);
  parsed->meshes = readMeshes(parsed->table, path);
  if (!scriptPath.empty()) {
    parsed->scriptPath = scriptPath, parsed->scriptBytes = std::move(scriptBytes);
    parsed->script = parseToml(parsed->scriptBytes, scriptPath);
    TableReader script(parsed->script, scriptPath, "the script");
    readLine(script, "summary");
    readNeeds(script, parsed->model);
    addScriptParameters(script, *parsed);
    for (auto& [name, mesh] : readMeshes(parsed->script, scriptPath)) {
      if (parsed->meshes.count(name)) throw UserError(scriptPath + ": '" + name + "' is already a file of the scene");
      parsed->meshes.emplace(name, mesh);
    }
  }
  SceneFile file;
  file.m_parsed = std::move(parsed);
  return file;
}

const std::string& SceneFile::name() const { return m_parsed->name; }
const std::string& SceneFile::summary() const { return m_parsed->summary; }
const std::string& SceneFile::path() const { return m_parsed->path; }
const std::string& SceneFile::scriptPath() const { return m_parsed->scriptPath; }
const std::string& SceneFile::scriptText() const { return m_parsed->scriptBytes; }
std::string SceneFile::content() const {
  std::string all = m_parsed->bytes;
  if (!m_parsed->saved.empty()) all += std::string("\0saved\0", 7) + m_parsed->saved;
  for (const auto& [name, file] : m_parsed->meshes) all += '\0' + name + '\0' + file.bytes;
  if (!m_parsed->scriptPath.empty()) all += std::string("\0script\0", 8) + m_parsed->scriptBytes;
  return all;
}
const std::vector<int>& SceneFile::dimensions() const { return m_parsed->dimensions; }
const std::vector<SceneParameter>& SceneFile::parameters() const { return m_parsed->parameters; }
std::uint64_t SceneFile::defaultSeed() const { return m_parsed->seed; }
const PhysicsModel& SceneFile::model() const { return m_parsed->model; }
bool SceneFile::has(int dimension) const {
  const auto& d = m_parsed->dimensions;
  return std::find(d.begin(), d.end(), dimension) != d.end();
}

}}  // namespace lpc::LPC_PRECISION
