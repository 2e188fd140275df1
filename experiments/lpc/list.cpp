// SPDX-License-Identifier: Zlib
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
#include "experiments/trial/output_file.h"
#include "experiments/trial/pair_drawing.h"
#include "experiments/trial/scene_event.h"
#include "experiments/trial/scene_file.h"
#include "framework/curved_core.h"

namespace lpc::inline LPC_PRECISION {
namespace {

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
                   {"needs", featuresText(file.needs())},
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

// Every kind, and what a scene must say of the sizes of those that are curved.
json describeShapes() {
  json out = json::array();
  for (int k = 0; k < kShapeKinds; ++k) {
    const auto kind = static_cast<ShapeKind>(k);
    json dimensions = json::array(), sizes = json::array();
    for (const int d : {2, 3}) {
      if (kindExists(kind, d)) dimensions.push_back(d);
    }
    if (coreClass(kind) == CoreClass::curved) {
      for (const std::string_view s : curvedKind<3>(kind).sizes) sizes.push_back(std::string(s));
    }
    out.push_back({{"name", std::string(shapeKindName(kind))}, {"dimensions", dimensions}, {"sizes", sizes}});
  }
  return out;
}

// Ways to lay out boxes and to draw pairs, for sweeps of the kinds `boxes` and `pairs`.
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

void printAlgorithms(const json& algorithms) {
  std::string stage;
  for (const json& a : algorithms) {
    if (a["stage"] != stage) {
      stage = a["stage"];
      std::printf("%s%s\n", &a == &algorithms[0] ? "" : "\n", stage.c_str());
    }
    const std::string role = a["role"] == "competitor" ? "" : " (" + a["role"].get<std::string>() + ")";
    std::printf("  %-22s %-6s %s%s\n", a["name"].get<std::string>().c_str(), dimensionsText(a["dimensions"]).c_str(),
                a["summary"].get<std::string>().c_str(), role.c_str());
    printParams(a["params"]);
  }
}

void print(const json& all) {
  printAlgorithms(all["algorithms"]);
  for (const auto& [key, title] :
       {std::pair("distributions", "distributions of boxes"), std::pair("drawings", "drawings of pairs"),
        std::pair("events", "events of scenes")}) {
    std::printf("\n%s\n", title);
    for (const json& e : all[key]) {
      std::printf("  %-22s %s\n", e["name"].get<std::string>().c_str(), e["summary"].get<std::string>().c_str());
      printParams(e["params"]);
    }
  }
  std::printf("\nshapes\n");
  for (const json& s : all["shapes"]) {
    std::string sizes;
    for (const json& size : s["sizes"]) sizes += (sizes.empty() ? "" : ", ") + size.get<std::string>();
    std::printf("  %-22s %-6s %s\n", s["name"].get<std::string>().c_str(), dimensionsText(s["dimensions"]).c_str(),
                sizes.c_str());
  }
  std::printf("\nmetrics and series\n");
  for (const json& m : all["metrics"]) {
    const std::string unit = m["unit"] == "1" ? "" : " (" + m["unit"].get<std::string>() + ")";
    const std::string needs = m["needs"] == "" ? "" : "; needs: " + m["needs"].get<std::string>();
    std::printf("  %-26s %-6s %s: %s%s%s\n", m["name"].get<std::string>().c_str(), m["kind"].get<std::string>().c_str(),
                m["what"].get<std::string>().c_str(), m["meaning"].get<std::string>().c_str(), unit.c_str(),
                needs.c_str());
  }
  std::printf("\nscenes\n");
  for (const json& s : all["scenes"]) {
    std::printf("  %-22s %-6s %s\n", s["name"].get<std::string>().c_str(), dimensionsText(s["dimensions"]).c_str(),
                s["summary"].get<std::string>().c_str());
    for (const json& p : s["params"]) {
      if (p["default"].is_string()) {
        std::printf("      %s=%s  (lpc list --stage joint)  %s\n", p["name"].get<std::string>().c_str(),
                    p["default"].get<std::string>().c_str(), p["meaning"].get<std::string>().c_str());
        continue;
      }
      std::printf("      %s=%g  (%g .. %g)  %s\n", p["name"].get<std::string>().c_str(), p["default"].get<double>(),
                  p["min"].get<double>(), p["max"].get<double>(), p["meaning"].get<std::string>().c_str());
    }
  }
  std::printf("\nsweeps\n");
  for (const json& s : all["sweeps"]) {
    std::printf("  %-22s %-6s %s\n", s["name"].get<std::string>().c_str(), s["kind"].get<std::string>().c_str(),
                s["summary"].get<std::string>().c_str());
  }
}

// The algorithms of one stage alone.
json ofStage(const std::string& stage) {
  if (!stageByName(stage)) {
    std::string valid;
    for (const StageInfo& s : kStages) valid += (valid.empty() ? "" : ", ") + std::string(s.name);
    throw UserError("there is no stage '" + stage + "'; valid: " + valid);
  }
  json out = json::array();
  for (const json& a : describeAlgorithms()) {
    if (a["stage"] == stage) out.push_back(a);
  }
  return out;
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

void addList(CommandLine& app, Session&) {
  CommandLine command =
      app.subcommand("list", "All algorithms with their parameters, all kinds of shape, metrics, scenes and sweeps");
  auto asJson = std::make_shared<bool>(false);
  auto page = std::make_shared<std::string>();
  auto stage = std::make_shared<std::string>();
  command.flag("--json", *asJson, "for programs");
  command.option("--into", *page, "writes the algorithms' names into this page, such as docs/architecture.md");
  command.option("--stage", *stage, "the algorithms of one stage alone, for instance velocity or joint");
  command.footer("Example: lpc list --json | python3 -m json.tool");
  command.callback([asJson, page, stage] {
    if (!page->empty()) return writeNames(*page);
    if (!stage->empty()) {
      const json algorithms = ofStage(*stage);
      if (*asJson) {
        std::cout << json{{"algorithms", algorithms}}.dump(1) << "\n";
      } else {
        printAlgorithms(algorithms);
      }
      return;
    }
    const json all = {{"algorithms", describeAlgorithms()},
                      {"distributions", describeEntries(boxDistributions())},
                      {"drawings", describeEntries(pairDrawings())},
                      {"events", describeEvents()},
                      {"shapes", describeShapes()},
                      {"metrics", describeMeasures()},
                      {"scenes", describeScenes()},
                      {"sweeps", describeSweeps()}};
    if (*asJson) {
      std::cout << all.dump(1) << "\n";
    } else {
      print(all);
    }
  });
}

LPC_COMMAND("list", addList);

}  // namespace
}  // namespace lpc::inline LPC_PRECISION
