// SPDX-License-Identifier: Zlib
#include "experiments/runner/sweep_axis.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "framework/math/names.h"
#include "framework/stage/registry.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

// Prefix of messages: "sweep.toml:12".
std::string placeIn(const std::string& file, const toml::node& node) {
  return file + ":" + std::to_string(node.source().begin.line);
}

/// One way to replace the stars of a text.
struct Choice {
  Spec spec;
  std::map<std::string, std::string> names;  // the replacement of each star, by the word before its `=`
};

class Stars {
 public:
  /// `place`: prefix of messages.
  explicit Stars(std::string place) : m_place(std::move(place)) {}

  static bool isStar(const std::string& name) { return name.starts_with("*"); }

  /// `key`: the word before the `=`, by which a label refers to the star.
  std::vector<Choice> expand(const StageInfo& stage, const std::string& key, const Spec& spec) const {
    if (!isStar(spec.name)) return with(stage, {spec.name, {}}, spec.fields, false);
    const std::vector<std::string> names = namesOf(stage, spec.name);
    for (const auto& [parameter, value] : spec.fields) {
      const auto has = [&, &p = parameter](const std::string& n) {
        return Registry::instance().parameter(stage.kind, n, p) != nullptr;
      };
      if (!names.empty() && std::none_of(names.begin(), names.end(), has)) {
        fail("'" + spec.text() + "': no " + std::string(stage.name) + " has '" + parameter + "'");
      }
    }
    std::vector<Choice> out;
    for (const std::string& name : names) {
      for (Choice& c : with(stage, {name, {}}, spec.fields, true)) {
        join(c, {key, name});
        out.push_back(std::move(c));
      }
    }
    return out;
  }

  /// For a part of a pipeline, such as "solver=split_solver{velocity=*} cache=none".
  std::vector<Choice> expand(const std::string& text, std::vector<std::string>& pipelines) const {
    Pipeline pipeline;
    std::vector<Choice> all = {{}};
    pipelines = {""};
    try {
      if (const auto engine = engineOf(text)) {
        all = expand(stageInfo(StageKind::engine), "engine", *engine);
        pipelines.clear();
        for (const Choice& c : all) pipelines.push_back("engine=" + c.spec.text());
        return all;
      }
      for (const StageKind kind : pipeline.replace(text)) {
        const std::string stage{stageName(kind)};
        std::vector<Choice> next;
        std::vector<std::string> texts;
        for (std::size_t i = 0; i < all.size(); ++i) {
          for (const Choice& c : expand(stageInfo(kind), stage, pipeline[kind])) {
            next.push_back(all[i]);
            for (const auto& name : c.names) join(next.back(), name);
            texts.push_back(pipelines[i] + (pipelines[i].empty() ? "" : " ") + stage + "=" + c.spec.text());
          }
        }
        all = std::move(next), pipelines = std::move(texts);
      }
    } catch (const UserError& e) {
      if (std::string_view(e.what()).starts_with(m_place)) throw;
      fail(e.what());
    }
    return all;
  }

 private:
  // The spec with all its parameters; values of nested stages may contain stars, too.
  std::vector<Choice> with(const StageInfo& stage, Spec spec, const std::vector<Spec::Field>& fields,
                           bool ofAStar) const {
    std::vector<Choice> out = {{std::move(spec), {}}};
    for (const auto& [key, value] : fields) {
      const ParamInfo* p = Registry::instance().parameter(stage.kind, out[0].spec.name, key);
      if (!p && ofAStar) continue;
      const std::vector<Choice> values = p && p->stage ? expand(*p->stage, key, value) : std::vector{Choice{value, {}}};
      std::vector<Choice> next;
      for (const Choice& c : out) {
        for (const Choice& v : values) {
          next.push_back(c);
          next.back().spec.set(ofAStar ? p->name : key, v.spec);
          for (const auto& name : v.names) join(next.back(), name);
        }
      }
      if (next.empty()) return {};
      out = std::move(next);
    }
    return out;
  }

  void join(Choice& c, const std::pair<const std::string, std::string>& name) const {
    if (!c.names.insert(name).second) {
      fail("two stars stand after '" + name.first + "='; a label could not tell them apart");
    }
  }

  std::vector<std::string> namesOf(const StageInfo& stage, const std::string& star) const {
    const std::size_t dash = std::min(star.find('-'), star.size());
    const std::string kind = star.substr(0, dash);
    if (kind != "*" && kind != "*witness") {
      fail("'" + star + "'; valid: *, *witness, *-name for all but some, names");
    }
    std::set<std::string> names;
    for (const auto& [key, entry] : Registry::instance().all()) {
      const bool witness = entry.info.role == AlgorithmRole::witness,
                 referee = entry.info.role == AlgorithmRole::referee;
      if (entry.stage == stage.kind && !referee && witness == (kind == "*witness")) names.insert(entry.info.name);
    }
    const std::vector<std::string> valid(names.begin(), names.end());
    if (names.empty() && kind == "*") {
      fail("nobody is registered as " + std::string(stage.name));
    }
    for (std::size_t at = dash; at < star.size();) {
      const std::size_t end = std::min(star.find('-', at + 1), star.size());
      const std::string name = star.substr(at + 1, end - at - 1);
      if (!names.erase(name)) {
        fail("'" + star + "' leaves out '" + name + "', who is not there" + validNames(valid, name));
      }
      at = end;
    }
    return {names.begin(), names.end()};
  }

  [[noreturn]] void fail(const std::string& what) const { throw UserError(m_place + ": " + what); }

  std::string m_place;
};

// "catto+$position" with the replacement of `position=*`.
std::string labelOf(const std::string& place, std::string label, const Choice& choice) {
  std::vector<std::string> keys;  // the longest first: $query must not match the beginning of $query_of
  for (const auto& [key, name] : choice.names) keys.push_back(key);
  std::sort(keys.begin(), keys.end(), [](const auto& a, const auto& b) { return a.size() > b.size(); });
  for (const std::string& key : keys) {
    const std::size_t at = label.find("$" + key);
    if (at == label.npos) {
      throw UserError(place + ": the label '" + label + "' is that of several methods; valid: one with $" + key);
    }
    label.replace(at, key.size() + 1, choice.names.at(key));
  }
  return label;
}

// `node`: its position.
void addLabelled(const std::string& place, const std::string& label, const std::string& text, const toml::node* node,
                 WrittenBy by, Axis& axis) {
  std::vector<std::pair<std::string, std::string>> found;
  if (text.find('*') == text.npos) {
    found.emplace_back(label, text);
  } else {
    std::vector<std::string> pipelines;
    const std::vector<Choice> choices = Stars(place).expand(text, pipelines);
    for (std::size_t i = 0; i < choices.size(); ++i) {
      found.emplace_back(labelOf(place, label, choices[i]), pipelines[i]);
    }
  }
  for (const auto& [name, pipeline] : found) {
    for (const AxisValue& v : axis.values) {
      if (v.label == name) throw UserError(place + ": two methods have the label '" + name + "'");
    }
    axis.values.push_back({name, pipeline, text, node, by});
  }
}

void readValue(const std::string& file, const toml::node& node, Axis& axis) {
  if (node.is_integer()) {
    axis.values.push_back({*node.value<std::int64_t>(), "", "", &node});
  } else if (node.is_floating_point() && std::isfinite(*node.value<double>())) {
    axis.values.push_back({*node.value<double>(), "", "", &node});
  } else if (node.is_string()) {
    const std::string text = *node.value<std::string>();
    const StageInfo* stage = stageByName(axis.name);
    if (!Stars::isStar(text)) {
      axis.values.push_back({text, "", text, &node});
    } else if (!stage) {
      failAt(file, node, "'" + text + "' in axis '" + axis.name + "', which is no stage's");
    } else {
      std::vector<Choice> choices;
      try {
        choices = Stars(placeIn(file, node)).expand(*stage, axis.name, Spec::parse(text));
      } catch (const UserError& e) {
        if (std::string_view(e.what()).starts_with(file)) throw;
        failAt(file, node, e.what());
      }
      for (const Choice& c : choices) axis.values.push_back({c.spec.text(), "", text, &node});
    }
  } else {
    failAt(file, node, describe(node) + " in axis '" + axis.name + "'; valid: finite numbers and strings");
  }
}

// The longest axis name at this position: $n must not match the beginning of $number. Empty: none.
std::string axisAt(const std::string& text, std::size_t at, const nlohmann::json& axes) {
  std::string longest;
  for (const auto& [name, value] : axes.items()) {
    if (name.size() > longest.size() && text.compare(at, name.size(), name) == 0) longest = name;
  }
  return longest;
}

}  // namespace

Axis readAxis(const std::string& file, const std::string& name, const toml::node& node) {
  if (std::find(kNoAxes.begin(), kNoAxes.end(), name) != kNoAxes.end()) {
    failAt(file, node, "an axis '" + name + "', which the store keeps of every sweep; valid: another name");
  }
  Axis axis{name, {}, node.is_table(), &node};
  if (const toml::table* table = node.as_table()) {
    for (const auto& [label, text] : inFileOrder(*table)) {
      if (!text->is_string()) failAt(file, *text, "'" + label + "' is " + describe(*text) + "; valid: a string");
      addLabelled(placeIn(file, *text), label, *text->value<std::string>(), text, WrittenBy::file, axis);
    }
  } else if (const toml::array* list = node.as_array()) {
    for (const toml::node& n : *list) readValue(file, n, axis);
  } else {
    readValue(file, node, axis);
  }
  const std::string text = node.value<std::string>().value_or("");
  if (axis.values.empty() && !text.starts_with("*witness")) {  // a build may have none
    failAt(file, node, "axis '" + name + "' is empty");
  }
  return axis;
}

SetAxis::SetAxis(const std::string& text) : given(text) {
  const std::size_t equals = text.find('=');
  if (equals == text.npos || equals == 0 || equals + 1 == text.size()) {
    throw UserError("--set '" + text + "'; valid: AXIS=VALUE, such as n=5000");
  }
  if (text.find('*', equals) != text.npos) throw UserError("--set '" + text + "': a star is many; valid: one value");
  axis = text.substr(0, equals);
  value = nlohmann::json::parse(text.substr(equals + 1), nullptr, false);  // a number, or else a text
  if (!value.is_number()) value = text.substr(equals + 1);
}

std::string valueText(const nlohmann::json& label) {
  return label.is_string() ? label.get<std::string>() : label.dump();
}

std::string withValues(const std::string& text, const nlohmann::json& axes, std::set<std::string>& used) {
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    if (text[at] != '$') {
      out += text[at++];
      continue;
    }
    const std::string name = axisAt(text, at + 1, axes);
    if (name.empty()) {
      std::vector<std::string> valid;
      for (const auto& [axis, value] : axes.items()) valid.push_back("$" + axis);
      throw UserError("a '$' in '" + text + "' names no axis; valid: " + joined(valid));
    }
    const std::string value = valueText(axes[name]);
    if (value.find('$') != value.npos) {
      throw UserError("'$" + name + "' becomes '" + value +
                      "', which is not looked at again; valid: a value without $");
    }
    out += value;
    used.insert(name);
    at += 1 + name.size();
  }
  return out;
}

std::set<std::string> namedIn(const std::string& text, const nlohmann::json& axes) {
  std::set<std::string> out;
  for (std::size_t at = text.find('$'); at != text.npos; at = text.find('$', at + 1)) {
    if (std::string name = axisAt(text, at + 1, axes); !name.empty()) out.insert(std::move(name));
  }
  return out;
}

bool addMethod(const std::string& given, const std::string& searched, std::vector<Axis>& axes) {
  const std::string place = "--with '" + given + "'";
  const std::size_t equals = given.find('=');
  const std::string label = given.substr(0, equals);
  if (equals == given.npos || label.empty() || given.find('=', equals + 1) == given.npos) {
    throw UserError(place + "; valid: LABEL=PIPELINE, such as jacobi=solver=split_solver{velocity=jacobi}");
  }
  const std::string text = given.substr(equals + 1);
  const auto axis = std::find_if(axes.begin(), axes.end(), [](const Axis& a) { return a.labelled; });
  if (axis == axes.end()) return false;
  for (std::size_t at = text.find('$'); at != text.npos; at = text.find('$', at + 1)) {
    const auto is = [&](const std::string& name) { return text.compare(at + 1, name.size(), name) == 0; };
    const bool named = std::any_of(axes.begin(), axes.end(), [&](const Axis& a) { return is(a.name); });
    if (!named && (searched.empty() || !is(searched))) return false;
  }
  addLabelled(place, label, text, axis->node, WrittenBy::with, *axis);
  return true;
}

std::vector<std::string> commandOf(const std::string& name, const std::set<std::string>& only,
                                   const std::set<std::string>& used, const std::vector<std::string>& with,
                                   const std::vector<std::string>& set) {
  std::vector<std::string> out = {"sweep", name};
  std::string listed;
  for (const std::string& label : only) listed += (listed.empty() ? "" : ",") + label;
  if (!only.empty()) out.insert(out.end(), {"--only", listed});
  for (const auto& [option, values] : {std::pair("--with", &with), std::pair("--set", &set)}) {
    for (const std::string& value : *values) {
      if (used.count(value)) out.insert(out.end(), {option, value});
    }
  }
  return out;
}

std::vector<nlohmann::json> seedsOf(const std::vector<Axis>& axes) {
  std::vector<nlohmann::json> out;
  for (const Axis& axis : axes) {
    for (const AxisValue& value : axis.values) {
      if (axis.name == "seed") out.push_back(value.label);
    }
  }
  return out;
}

}}  // namespace lpc::LPC_PRECISION
