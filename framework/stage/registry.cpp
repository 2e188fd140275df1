// SPDX-License-Identifier: Zlib
#include "framework/stage/registry.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>

#include "framework/math/names.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

// The shortest text that reads back as the same number.
std::string numberText(Real value) {
  char buffer[64];
  const auto end = std::to_chars(buffer, buffer + sizeof buffer, value).ptr;
  return {buffer, end};
}

// Reads values out of a spec.
class Reader final : public ParamVisitor {
 public:
  Reader(const Spec& spec, const std::string& algorithm) : m_spec(spec), m_algorithm(algorithm) {}

  void integer(std::string_view name, int& value, int lo, int hi, std::string_view, ParamRole) override {
    if (const Spec* s = field(name)) {
      const auto [end, error] = std::from_chars(s->name.data(), s->name.data() + s->name.size(), value);
      const bool whole = error == std::errc() && end == s->name.data() + s->name.size() && s->fields.empty();
      if (!whole || value < lo || value > hi) {
        fail(name, *s, "; valid: a whole number from " + std::to_string(lo) + " to " + std::to_string(hi));
      }
    }
  }
  void real(std::string_view name, Real& value, Real lo, Real hi, std::string_view, std::string_view,
            ParamRole) override {
    if (const Spec* s = field(name)) {
      const auto [end, error] = std::from_chars(s->name.data(), s->name.data() + s->name.size(), value);
      const bool whole = error == std::errc() && end == s->name.data() + s->name.size() && s->fields.empty();
      if (!whole || !(value >= lo && value <= hi)) {
        fail(name, *s, "; valid: a number from " + numberText(lo) + " to " + numberText(hi));
      }
    }
  }
  void flag(std::string_view name, bool& value, std::string_view) override {
    if (const Spec* s = field(name)) {
      if (s->fields.empty() && (s->name == "true" || s->name == "false")) {
        value = s->name == "true";
      } else {
        fail(name, *s, validNames({"true", "false"}, s->name));
      }
    }
  }
  void stage(std::string_view name, Spec& value, StageKind, std::string_view) override {
    if (const Spec* s = field(name)) value = *s;
  }
  void checkAllKnown() const {
    for (const auto& [key, value] : m_spec.fields) {
      bool known = false;
      for (const std::string& n : m_names) known = known || n == key;
      if (!known) {
        throw UserError("'" + m_algorithm + "' has no parameter '" + key + "'" + validNames(m_names, key));
      }
    }
  }

 protected:
  void choiceIndex(std::string_view name, int& index, const std::vector<std::string_view>& names,
                   std::string_view) override {
    const Spec* s = field(name);
    if (!s) return;
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (names[i] == s->name && s->fields.empty()) {
        index = static_cast<int>(i);
        return;
      }
    }
    fail(name, *s, validNames({names.begin(), names.end()}, s->name));
  }

 private:
  const Spec* field(std::string_view name) {
    m_names.emplace_back(name);
    return m_spec.find(name);
  }
  [[noreturn]] void fail(std::string_view name, const Spec& found, const std::string& valid) const {
    throw UserError("parameter '" + std::string(name) + "' of '" + m_algorithm + "' is '" + found.text() + "'" + valid);
  }
  const Spec& m_spec;
  const std::string& m_algorithm;
  std::vector<std::string> m_names;
};

class Describer final : public ParamVisitor {
 public:
  std::vector<ParamInfo> infos;

  void integer(std::string_view name, int& value, int lo, int hi, std::string_view meaning, ParamRole role) override {
    ParamInfo& info = add(name, "integer", "1", meaning, std::to_string(value));
    info.range = {double(lo), double(hi)}, info.role = role;
  }
  void real(std::string_view name, Real& value, Real lo, Real hi, std::string_view unit, std::string_view meaning,
            ParamRole role) override {
    ParamInfo& info = add(name, "real", unit, meaning, numberText(value));
    info.range = {double(lo), double(hi)}, info.role = role;
  }
  void flag(std::string_view name, bool& value, std::string_view meaning) override {
    add(name, "flag", "1", meaning, value ? "true" : "false").choices = {"true", "false"};
  }
  void stage(std::string_view name, Spec& value, StageKind kind, std::string_view meaning) override {
    add(name, "stage:" + std::string(stageName(kind)), "1", meaning, value.text()).stage = &stageInfo(kind);
  }

 protected:
  void choiceIndex(std::string_view name, int& index, const std::vector<std::string_view>& names,
                   std::string_view meaning) override {
    add(name, "choice", "1", meaning, std::string(names[static_cast<std::size_t>(index)])).choices = {names.begin(),
                                                                                                      names.end()};
  }

 private:
  ParamInfo& add(std::string_view name, std::string type, std::string_view unit, std::string_view meaning,
                 std::string value) {
    infos.push_back(
        {std::string(name), std::move(type), std::string(unit), std::string(meaning), std::move(value), {}, {}});
    return infos.back();
  }
};

class Canonical final : public ParamVisitor {
 public:
  Canonical(std::string name, int dimension) : spec{std::move(name), {}}, m_dimension(dimension) {}
  Spec spec;

  void integer(std::string_view name, int& value, int, int, std::string_view, ParamRole) override {
    spec.set(name, {std::to_string(value), {}});
  }
  void real(std::string_view name, Real& value, Real, Real, std::string_view, std::string_view, ParamRole) override {
    spec.set(name, {numberText(value), {}});
  }
  void flag(std::string_view name, bool& value, std::string_view) override {
    spec.set(name, {value ? "true" : "false", {}});
  }
  void stage(std::string_view name, Spec& value, StageKind kind, std::string_view) override {
    spec.set(name, Registry::instance().find(kind, m_dimension, value.name).canonical(value));
  }

 protected:
  void choiceIndex(std::string_view name, int& index, const std::vector<std::string_view>& names,
                   std::string_view) override {
    spec.set(name, {std::string(names[static_cast<std::size_t>(index)]), {}});
  }

 private:
  int m_dimension;
};

}  // namespace

Registry& Registry::instance() {
  static Registry registry;
  return registry;
}

void Registry::add(Registered entry) {
  Key key{entry.stage, entry.dimension, entry.info.name};
  if (!m_all.emplace(key, std::move(entry)).second) {
    throw UserError("two algorithms are registered as " + std::string(stageName(std::get<0>(key))) + " " +
                    std::get<2>(key) + " (" + std::to_string(std::get<1>(key)) + "D)");
  }
}

const ParamInfo* Registry::parameter(StageKind stage, const std::string& name, std::string_view parameter) const {
  for (const int d : {2, 3}) {
    const auto it = m_all.find(Key{stage, d, name});
    if (it == m_all.end()) continue;
    for (const ParamInfo& p : it->second.params) {
      if (p.name == parameter) return &p;
    }
    if (parameter != "effort") continue;
    if (const ParamInfo* p = firstOf(ParamRole::effort, it->second.params)) return p;
  }
  return nullptr;
}

const Registered& Registry::find(StageKind stage, int dimension, std::string_view name) const {
  const auto it = m_all.find(Key{stage, dimension, std::string(name)});
  if (it != m_all.end()) return it->second;
  std::set<StageKind> others;  // stages that have this name: suggest a stage only when it is the only one
  for (const auto& [key, entry] : m_all) {
    if (entry.info.name == name) others.insert(entry.stage);
  }
  const std::string place = others.size() == 1 && *others.begin() != stage
                                ? placeInPipeline(stageInfo(*others.begin()), std::string(name))
                                : "";
  std::vector<std::string> names;
  for (const Registered* r : list(stage, dimension)) names.push_back(r->info.name);
  throw UserError("unknown " + std::string(stageName(stage)) + " '" + std::string(name) + "' in " +
                  std::to_string(dimension) + "D" + (place.empty() ? "" : "; " + place) + validNames(names, name));
}

std::vector<const Registered*> Registry::list(StageKind stage, int dimension) const {
  std::vector<const Registered*> out;
  for (const auto& [key, entry] : m_all) {
    if (entry.stage == stage && entry.dimension == dimension) out.push_back(&entry);
  }
  return out;
}

void readParams(const Spec& spec, const std::string& algorithm, const std::function<void(ParamVisitor&)>& visit) {
  Reader reader(spec, algorithm);
  visit(reader);
  reader.checkAllKnown();
}

std::vector<ParamInfo> describeParams(const std::function<void(ParamVisitor&)>& visit) {
  Describer describer;
  visit(describer);
  return std::move(describer.infos);
}

Spec canonicalSpec(const std::string& algorithm, int dimension, const std::function<void(ParamVisitor&)>& visit) {
  Canonical canonical(algorithm, dimension);
  visit(canonical);
  return std::move(canonical.spec);
}

std::string_view frictionLawName(FrictionLaw law) {
  switch (law) {
    case FrictionLaw::unstated:
      return "";
    case FrictionLaw::coulomb:
      return "coulomb";
    case FrictionLaw::convex:
      return "convex";
    case FrictionLaw::pyramid:
      return "pyramid";
    case FrictionLaw::facets:
      return "facets";
    case FrictionLaw::lagged:
      return "lagged";
    case FrictionLaw::ofItsParts:
      return "of its parts";
  }
  return "";
}

FrictionLaw frictionLaw(const AlgorithmInfo& info, const Spec& spec) {
  for (const FrictionChoice& other : info.otherFriction) {
    const Spec* value = spec.find(other.parameter);
    if (value && value->name == other.choice) return other.law;
  }
  return info.friction;
}

const ParamInfo* firstOf(ParamRole role, const std::vector<ParamInfo>& params) {
  const auto it = std::find_if(params.begin(), params.end(), [&](const ParamInfo& p) { return p.role == role; });
  return it == params.end() ? nullptr : &*it;
}

EffortPlace effortIn(StageKind stage, int dimension, Spec& spec) {
  const Registered& entry = Registry::instance().find(stage, dimension, spec.name);
  const ParamInfo* own = firstOf(ParamRole::effort, entry.params);
  const auto part = std::find_if(entry.params.begin(), entry.params.end(), [](const ParamInfo& p) { return p.stage; });
  if (own || part == entry.params.end()) return {&spec, &entry, own};
  if (!spec.find(part->name)) spec.set(part->name, Spec::parse(part->defaultText));
  const auto given =
      std::find_if(spec.fields.begin(), spec.fields.end(), [&](const Spec::Field& f) { return f.key == part->name; });
  return effortIn(part->stage->kind, dimension, given->value);
}

std::string canonicalText(const Pipeline& pipeline, int dimension) {
  Pipeline whole;
  for (const StageKind stage : kWorldStages) {
    const Spec& spec = pipeline[stage];
    whole[stage] = Registry::instance().find(stage, dimension, spec.name).canonical(spec);
  }
  return whole.text();
}

std::string placeInPipeline(const StageInfo& stage, const std::string& algorithm) {
  if (isWorldStage(stage)) return "";
  const std::string name(stage.name);
  for (const auto& [key, entry] : Registry::instance().all()) {
    const StageInfo& outer = stageInfo(entry.stage);
    if (!isWorldStage(outer)) continue;
    for (const ParamInfo& p : entry.params) {
      if (p.stage != &stage) continue;
      return name + " is a part of " + std::string(outer.name) + ": " + std::string(outer.name) + "=" +
             entry.info.name + "{" + p.name + "=" + algorithm + "}";
    }
  }
  if (!isOurs(stage)) return "an engine replaces all stages: engine=" + algorithm;
  return name + " is not part of a pipeline: scenes choose it";
}

}}  // namespace lpc::LPC_PRECISION
