// SPDX-License-Identifier: Zlib
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "experiments/lpc/command.h"
#include "experiments/parse/toml_reader.h"
#include "experiments/runner/catalogue.h"
#include "experiments/runner/locations.h"
#include "experiments/trial/box_distribution.h"
#include "experiments/trial/formats/output_file.h"
#include "experiments/trial/pair_drawing.h"
#include "experiments/trial/scene/scene_event.h"
#include "experiments/trial/scene/scene_file.h"
#include "framework/math/names.h"
#include "framework/shape/curved_core.h"

namespace lpc { inline namespace LPC_PRECISION { namespace {

using nlohmann::json;

json describeScenes() {
  json out = json::array();
  for (const std::string& path : listToml("scenes")) {
    const SceneFile file = SceneFile::load(path);
    json params = json::array();
    for (const SceneParameter& p : file.parameters()) {
      json entry = {{"name", p.name}, {"meaning", p.meaning}, {"default", p.value}};
      if (!p.value.isText()) entry["min"] = p.lo, entry["max"] = p.hi;
      params.push_back(std::move(entry));
    }
    out.push_back({{"name", file.name()},
                   {"summary", file.summary()},
                   {"path", path},
                   {"dimensions", file.dimensions()},
                   {"needs", modelText(file.model())},
                   {"params", params}});
  }
  return out;
}

json describeSweeps() {
  json out = json::array();
  for (const std::string& path : listToml("sweeps")) {
    const toml::table table = parseToml(readFile(path), path);
    out.push_back({{"name", std::filesystem::path(path).stem().string()},
                   {"kind", table["kind"].value_or(std::string())},
                   {"summary", table["summary"].value_or(std::string())},
                   {"path", path}});
  }
  return out;
}

// Parameters are described like those of an algorithm, so that they are printed alike.
json describeScripts() {
  json out = json::array();
  for (const std::string& path : listToml("scripts")) {
    const toml::table table = parseToml(readFile(path), path);
    json params = json::array();
    const toml::table none, *own = table["parameters"].as_table();
    for (const auto& [name, node] : inFileOrder(own ? *own : none)) {
      const auto& p = *node->as_table();
      const auto number = [&p = p](const char* key) { return p[key].value_or(0.0); };
      params.push_back({{"name", name},
                        {"unit", "1"},
                        {"meaning", p["meaning"].value_or(std::string())},
                        {"default", asText(number("default"))},
                        {"range", {number("min"), number("max")}},
                        {"choices", json::array()}});
    }
    out.push_back({{"name", std::filesystem::path(path).stem().string()},
                   {"summary", table["summary"].value_or(std::string())},
                   {"path", path},
                   {"params", params}});
  }
  return out;
}

// Every kind, and the size parameters of curved kinds in a scene.
json describeShapes() {
  json out = json::array();
  for (int k = 0; k < kShapeKinds; ++k) {
    const auto kind = static_cast<ShapeKind>(k);
    json dimensions = json::array(), sizes = json::array();
    for (const int d : {2, 3}) {
      if (kindExists(kind, d)) dimensions.push_back(d);
    }
    if (dimensions.empty()) continue;
    if (coreClass(kind) == CoreClass::curved) {
      const auto& names = kindExists(kind, 3) ? curvedKind<3>(kind).sizes : curvedKind<2>(kind).sizes;
      for (const std::string_view s : names) sizes.push_back(std::string(s));
    }
    out.push_back({{"name", std::string(shapeKindName(kind))}, {"dimensions", dimensions}, {"sizes", sizes}});
  }
  return out;
}

// Layouts of boxes and ways of drawing pairs, for sweeps of the kinds `boxes` and `pairs`.
template <class Entry>
json describeEntries(const std::vector<Entry>& table) {
  json out = json::array();
  for (const Entry& e : table) {
    out.push_back({{"name", e.info.name}, {"summary", e.info.meaning}, {"params", describeParams(e.info.params)}});
  }
  return out;
}

json describeEvents() {
  json out = json::array();
  for (const auto& kind : eventKinds<3>())
    out.push_back({{"name", kind.name}, {"summary", kind.meaning}, {"params", json::array()}});
  return out;
}

std::string dimensionsText(const json& dimensions) {
  std::string text;
  for (const json& d : dimensions) text += (text.empty() ? "" : " ") + std::to_string(d.get<int>()) + "D";
  return text;
}

std::string rangeText(const json& range) {
  if (range.is_null()) return "";
  const auto number = [](const json& n) { return n.is_number_integer() ? n.dump() : asText(n.get<double>()); };
  return number(range[0]) + " .. " + number(range[1]);
}

void printParams(const json& params) {
  for (const json& p : params) {
    std::string valid = rangeText(p["range"]);
    for (const json& c : p["choices"]) valid += (valid.empty() ? "" : " | ") + c.get<std::string>();
    std::printf("      %s=%s%s%s%s  %s\n", p["name"].get<std::string>().c_str(),
                p["default"].get<std::string>().c_str(), p["unit"] == "1" ? "" : " ",
                p["unit"] == "1" ? "" : p["unit"].get<std::string>().c_str(),
                valid.empty() ? "" : ("  (" + valid + ")").c_str(), p["meaning"].get<std::string>().c_str());
  }
}

// A line for what fails and where, and one for the symptom and the tests that show it.
void printFailures(const json& algorithm) {
  std::vector<std::pair<json, std::string>> shown;  // a failure, and the names of all its tests
  for (const json& f : algorithm["failures"]) {
    const std::string test = f["test"];
    const auto same = [&](const auto& s) {
      return s.first["when"] == f["when"] && s.first["symptom"] == f["symptom"] &&
             s.first["dimensions"] == f["dimensions"];
    };
    const auto known = std::find_if(shown.begin(), shown.end(), same);
    known == shown.end() ? shown.emplace_back(f, test).second : known->second += ", " + test;
  }
  for (const auto& [f, tests] : shown) {
    const bool everywhere = f["dimensions"] == algorithm["dimensions"];
    std::printf("      declared failure%s: %s\n          %s (shown by %s)\n",
                everywhere ? "" : (" in " + dimensionsText(f["dimensions"])).c_str(),
                f["when"].get<std::string>().c_str(), f["symptom"].get<std::string>().c_str(), tests.c_str());
  }
}

void printAlgorithms(const json& algorithms) {
  std::string stage;
  for (const json& a : algorithms) {
    if (a["stage"] != stage) {
      stage = a["stage"];
      std::printf("%s%s\n", &a == &algorithms[0] ? "" : "\n", stage.c_str());
    }
    std::string law = a["friction"] == "" ? "" : "; friction: " + a["friction"].get<std::string>();
    for (const auto& [choice, other] : a["other_friction"].items()) {
      law += ", by " + choice + ' ' + other.get<std::string>();
    }
    const std::string role = a["role"] == "competitor" ? "" : " (" + a["role"].get<std::string>() + ")";
    std::printf("  %-22s %-6s %s%s%s\n", a["name"].get<std::string>().c_str(), dimensionsText(a["dimensions"]).c_str(),
                a["summary"].get<std::string>().c_str(), law.c_str(), role.c_str());
    printParams(a["params"]);
    printFailures(a);
  }
}

// Named things besides algorithms: their key in the JSON, and their heading.
constexpr std::pair<const char*, const char*> kKinds[] = {{"distributions", "distributions of boxes"},
                                                          {"drawings", "drawings of pairs"},
                                                          {"events", "events of scenes"},
                                                          {"shapes", "shapes"},
                                                          {"metrics", "metrics and series"},
                                                          {"scenes", "scenes"},
                                                          {"scripts", "scripts of scenes"},
                                                          {"sweeps", "sweeps"}};

json everything() {
  return {{"algorithms", describeAlgorithms()},
          {"distributions", describeEntries(boxDistributions())},
          {"drawings", describeEntries(pairDrawings())},
          {"events", describeEvents()},
          {"shapes", describeShapes()},
          {"metrics", describeMeasures()},
          {"scenes", describeScenes()},
          {"scripts", describeScripts()},
          {"sweeps", describeSweeps()}};
}

std::string textOf(const json& entry, const char* key) { return entry[key].get<std::string>(); }

void printMetric(const json& m) {
  const std::string unit = m["unit"] == "1" ? "" : " (" + textOf(m, "unit") + ")";
  const std::string needs = m["needs"] == "" ? "" : "; needs: " + textOf(m, "needs");
  std::printf("  %-26s %-6s %s: %s%s%s\n", textOf(m, "name").c_str(), textOf(m, "kind").c_str(),
              textOf(m, "what").c_str(), textOf(m, "meaning").c_str(), unit.c_str(), needs.c_str());
}

void printScene(const json& s) {
  std::printf("  %-22s %-6s %s\n", textOf(s, "name").c_str(), dimensionsText(s["dimensions"]).c_str(),
              textOf(s, "summary").c_str());
  for (const json& p : s["params"]) {
    if (p["default"].is_string()) {
      std::printf("      %s=%s  (lpc list --stage joint)  %s\n", textOf(p, "name").c_str(),
                  textOf(p, "default").c_str(), textOf(p, "meaning").c_str());
      continue;
    }
    std::printf("      %s=%g  (%g .. %g)  %s\n", textOf(p, "name").c_str(), p["default"].get<double>(),
                p["min"].get<double>(), p["max"].get<double>(), textOf(p, "meaning").c_str());
  }
}

void printEntry(const std::string& kind, const json& e) {
  if (kind == "metrics") return printMetric(e);
  if (kind == "scenes") return printScene(e);
  if (kind == "shapes") {
    std::string sizes;
    for (const json& size : e["sizes"]) sizes += (sizes.empty() ? "" : ", ") + size.get<std::string>();
    std::printf("  %-22s %-6s %s\n", textOf(e, "name").c_str(), dimensionsText(e["dimensions"]).c_str(), sizes.c_str());
  } else if (kind == "sweeps") {
    std::printf("  %-22s %-6s %s\n", textOf(e, "name").c_str(), textOf(e, "kind").c_str(),
                textOf(e, "summary").c_str());
  } else {
    std::printf("  %-22s %s\n", textOf(e, "name").c_str(), textOf(e, "summary").c_str());
    printParams(e["params"]);
  }
}

void printWhole(const json& all) {
  printAlgorithms(all["algorithms"]);
  bool first = all["algorithms"].empty();
  for (const auto& [kind, title] : kKinds) {
    if (!all.contains(kind) || all[kind].empty()) continue;
    std::printf("%s%s\n", first ? "" : "\n", title);
    first = false;
    for (const json& e : all[kind]) printEntry(kind, e);
  }
}

// A heading followed by names, over as many lines as needed.
void printNames(const std::string& heading, const std::vector<std::string>& names) {
  constexpr std::size_t kIndent = 24, kColumns = 140;
  std::string line = heading;
  line.resize(kIndent, ' ');
  for (const std::string& name : names) {
    if (line.size() > kIndent && line.size() + name.size() >= kColumns) {
      std::printf("%s\n", line.c_str());
      line.assign(kIndent, ' ');
    }
    line += (line.size() > kIndent ? " " : "") + name;
  }
  std::printf("%s\n", line.c_str());
}

std::vector<std::string> namesOf(const json& entries) {
  std::vector<std::string> out;
  for (const json& e : entries) {  // a metric and a series may have the same name
    if (const std::string name = textOf(e, "name"); std::find(out.begin(), out.end(), name) == out.end()) {
      out.push_back(name);
    }
  }
  return out;
}

// The algorithms of one stage.
json ofStage(const json& algorithms, const std::string& stage) {
  json out = json::array();
  for (const json& a : algorithms) {
    if (a["stage"] == stage) out.push_back(a);
  }
  return out;
}

void printShort(const json& all) {
  for (const StageInfo& stage : kStages) {
    printNames(std::string(stage.name), namesOf(ofStage(all["algorithms"], std::string(stage.name))));
  }
  for (const auto& [kind, title] : kKinds) printNames(title, namesOf(all[kind]));
  std::printf(
      "\nlpc list --name NAME, --stage STAGE or --all: parameters, ranges, units, meanings, declared failures\n");
}

void requireStage(const std::string& stage) {
  if (stageByName(stage)) return;
  std::vector<std::string> names;
  for (const StageInfo& s : kStages) names.emplace_back(s.name);
  throw UserError("unknown stage '" + stage + "'" + validNames(names, stage));
}

// All entries with this name, of every kind: `naive` is a broadphase and a velocity resolver.
json ofName(const json& all, const std::string& name) {
  json out;
  std::vector<std::string> names;
  bool found = false;
  for (const auto& [kind, entries] : all.items()) {
    out[kind] = json::array();
    for (const json& e : entries) {
      names.push_back(textOf(e, "name"));
      if (e["name"] == name) out[kind].push_back(e), found = true;
    }
  }
  if (found) return out;
  const std::string meant = meantName(names, name);
  throw UserError("unknown name '" + name + "'" +
                  (meant.empty() ? "; valid: " : "; did you mean '" + meant + "'? valid: ") +
                  "the names that lpc list prints");
}

void writeNames(const std::string& page) {
  std::string text = readFile(page);
  try {
    text = withNames(text);
  } catch (const UserError& e) {
    throw UserError(page + ": " + e.what());
  }
  OutputFile out(page);
  out.stream() << text;
  out.finish();
}

struct ListOptions {
  bool asJson = false, all = false;
  std::string page, stage, name;
};

void list(const ListOptions& o) {
  if (!o.page.empty()) return writeNames(o.page);
  if (!o.stage.empty()) requireStage(o.stage);
  json chosen = o.stage.empty() ? everything() : json{{"algorithms", ofStage(describeAlgorithms(), o.stage)}};
  if (!o.name.empty()) chosen = ofName(chosen, o.name);
  if (o.asJson) {
    std::cout << chosen.dump(1) << "\n";
  } else if (o.all || !o.stage.empty() || !o.name.empty()) {
    printWhole(chosen);
  } else {
    printShort(chosen);
  }
}

void addList(CommandLine& app, Session&) {
  CommandLine command =
      app.subcommand("list", "Lists algorithms, kinds of shape, metrics, scenes and sweeps: names, or all details");
  auto o = std::make_shared<ListOptions>();
  const Option stage =
      command.option("--stage", o->stage, "algorithms of one stage, with parameters, ranges and meanings");
  const Option name =
      command.option("--name", o->name,
                     "everything of this name (algorithm, scene, metric, ...), with an algorithm's declared failures");
  const Option all = command.flag("--all", o->all, "all entries with all details");
  const Option asJson = command.flag("--json", o->asJson, "JSON output of all entries, or of the selected ones");
  Option into = command.option("--into", o->page,
                               "writes the table of all algorithms into this page, such as docs/architecture.md");
  for (const Option& other : {stage, name, all, asJson}) into.without(other);
  command.footer(
      "Example: lpc list --stage velocity\n"
      "         lpc list --name pyramid\n"
      "         lpc list --json | python3 -m json.tool");
  command.callback([o] { list(*o); });
}

LPC_COMMAND("list", addList);

}  // namespace
}}  // namespace lpc::LPC_PRECISION
