// SPDX-License-Identifier: Zlib
#include "experiments/runner/sweep_file.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <set>

#include "experiments/parse/toml_reader.h"
#include "experiments/runner/idle_seeds.h"
#include "experiments/runner/locations.h"
#include "experiments/runner/message_place.h"
#include "experiments/runner/scene_model.h"
#include "experiments/runner/sweep_axis.h"
#include "experiments/runner/sweep_cell.h"
#include "experiments/runner/sweep_size.h"
#include "framework/math/names.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using nlohmann::json;

/// Shared with cells that are calibrated: their trials are planned when a setting is tried.
class Sweep : public std::enable_shared_from_this<Sweep> {
 public:
  /// `matched` and `taken` collect the names of `only`, the methods of `with` and the axes of `set` that were found.
  Sweep(const std::string& path, const std::set<std::string>& only, std::set<std::string>& matched,
        const std::vector<std::string>& with, const std::vector<SetAxis>& set, std::set<std::string>& taken)
      : m_path(path),
        m_only(only),
        m_matched(matched),
        m_with(with),
        m_set(set),
        m_taken(taken),
        m_table(parseToml(readFile(path), path)) {
    m_out.name = std::filesystem::path(path).stem().string();
  }

  PlannedSweep plan(std::shared_ptr<Planner> planner, std::shared_ptr<SweepSize> size) {
    m_planner = std::move(planner), m_size = std::move(size);
    TableReader top(m_table, m_path, "the sweep");
    m_out.summary = top.requireString("summary"), m_out.baseline = top.string("baseline", "");
    m_kind = m_out.kind = top.requireString("kind");
    const std::vector<std::string> kinds = {"world", "boxes", "pairs", "problems"};
    if (std::find(kinds.begin(), kinds.end(), m_kind) == kinds.end()) {
      top.fail(*top.find("kind"), "unknown kind '" + m_kind + "'" + validNames(kinds, m_kind));
    }
    m_twice = top.string("twice", "");
    m_out.wallLimit = limit(top, "wall_limit", m_out.wallLimit);
    m_out.memoryLimit = limit(top, "memory_limit", m_out.memoryLimit);
    readCharts(top);
    if (const toml::table* calibrate = top.table("calibrate")) {
      m_calibration = m_out.calibration = readCalibration(*calibrate, m_path);
      if (m_kind != "world") top.fail(*calibrate, "'calibrate' in a sweep of kind '" + m_kind + "'; valid: world");
    }
    Settings settings;
    readSettings(top, settings);
    for (const std::string& method : m_with) {
      if (addMethod(method, m_calibration ? m_calibration->setting : "", settings.axes)) m_taken.insert(method);
    }
    const auto groups = top.blocks("group");
    top.finish();
    if (groups.empty()) product(settings, m_table);
    for (const toml::table* t : groups) {
      TableReader group(*t, m_path, "[[group]]");
      Settings own = settings;
      readSettings(group, own);
      group.finish();
      product(own, *t);
    }
    for (const auto& [key, value] : {std::pair("baseline", m_out.baseline), std::pair("twice", m_twice)}) {
      if (value.empty() || m_named.count(value)) continue;
      top.fail(*top.find(key),
               "no axis has the value '" + value + "'" + validNames({m_named.begin(), m_named.end()}, value));
    }
    if (!m_timed && !m_twice.empty()) top.fail(*top.find("twice"), "'twice' without times; valid: timed = true");
    m_out.notes = m_seeds.notes();
    refuseWhatIsThere(settings.axes);
    if (m_out.trials.empty() && m_out.calibrated.empty() && m_out.ladders.empty() && m_only.empty())
      throw UserError(m_path + ": the sweep has no cell");
    return std::move(m_out);
  }

 private:
  static double limit(TableReader& t, const char* key, double fallback) {
    const double value = t.number(key, fallback);
    if (!(value > 0)) t.fail(*t.find(key), std::string("'") + key + "' is " + asText(value) + "; valid: above 0");
    return value;
  }

  void readCharts(TableReader& top) {
    if (!top.find("report")) return;
    m_out.charts = top.strings("report");
    const std::vector<std::string> known = chartsOfSweeps();
    for (const std::string& name : m_out.charts) {
      if (std::find(known.begin(), known.end(), name) != known.end()) continue;
      top.fail(*top.find("report"), "'report' names the chart '" + name + "'" + validNames(known, name));
    }
  }

  // The same trial under two labels runs once, under the first: a method of the command line would vanish.
  void refuseWhatIsThere(const std::vector<Axis>& axes) {
    std::set<std::string> planned;
    const auto add = [&](const auto& cell) {
      for (const auto& [axis, value] : cell.axes.items()) planned.insert(axis + "=" + value.dump());
    };
    std::for_each(m_out.trials.begin(), m_out.trials.end(), add);
    std::for_each(m_out.calibrated.begin(), m_out.calibrated.end(), add);
    std::for_each(m_out.ladders.begin(), m_out.ladders.end(), add);
    for (const Axis& axis : axes) {
      for (const AxisValue& v : axis.values) {
        if (v.by != WrittenBy::with || !m_only.empty() || planned.count(axis.name + "=" + v.label.dump())) continue;
        throw UserError("--with " + valueText(v.label) + ": " + m_path + " has all its trials under another label");
      }
    }
  }

  struct Settings {
    std::vector<Axis> axes;
    std::string pipeline;
    const toml::node* pipelineNode = nullptr;
    bool timed = false, untimed = true;
    long repeats = 1;
    std::optional<double> posesEvery;
    bool series = true;
    std::vector<double> budgets;
    std::optional<BreakQuestion> question;
    std::set<std::string> named;  // axes that are used because a value of another axis names them
  };
  using Shared = std::shared_ptr<const Settings>;

  void readSettings(TableReader& t, Settings& s) {
    s.pipeline = t.string("pipeline", s.pipeline);
    if (const toml::node* node = t.find("pipeline")) s.pipelineNode = node;
    if (t.find("timed")) {
      s.timed = t.flag("timed", false);
      s.untimed = t.flag("untimed", !s.timed);
    }
    s.untimed = t.flag("untimed", s.untimed);
    for (const char* key : {"poses_every", "series"}) {
      if (t.find(key) && m_kind != "world") {
        t.fail(*t.find(key), "'" + std::string(key) + "' in a sweep of kind '" + m_kind + "'; valid: world");
      }
    }
    if (t.find("poses_every")) s.posesEvery = limit(t, "poses_every", 0);
    s.series = t.flag("series", s.series);
    s.repeats = t.integer("repeats", s.repeats);
    if (s.repeats < 1) t.fail(*t.find("repeats"), "'repeats' is " + std::to_string(s.repeats) + "; valid: 1 or more");
    if (const toml::node* budgets = t.find("budgets")) {
      if (!m_calibration) t.fail(*budgets, "'budgets' without 'calibrate', which says of what");
      s.budgets = readBudgets(t);
    }
    if (const toml::table* question = t.table("break")) {
      if (m_kind != "world") t.fail(*question, "'break' in a sweep of kind '" + m_kind + "'; valid: world");
      s.question = readBreak(*question, m_path, s.question);
    }
    if (const toml::table* axes = t.table("axes")) {
      for (const auto& [name, node] : inFileOrder(*axes)) {
        Axis axis = readAxis(m_path, name, *node);
        const auto same =
            std::find_if(s.axes.begin(), s.axes.end(), [&](const Axis& a) { return a.name == axis.name; });
        (same == s.axes.end() ? s.axes.emplace_back() : *same) = std::move(axis);
      }
    }
    for (const SetAxis& set : m_set) {
      for (Axis& axis : s.axes) {
        if (axis.name != set.axis) continue;
        if (axis.labelled) throw UserError("--set '" + set.given + "': " + m_path + " has labelled methods there");
        axis.values = {{set.value, "", valueText(set.value), axis.node, WrittenBy::set}};
        m_taken.insert(set.given);
      }
    }
  }

  void product(Settings settings, const toml::node& where) {
    if (m_calibration) refuseUncalibrated(settings, where);
    if (settings.question) refuseSearched(settings, where);
    for (const Axis& axis : settings.axes) {
      if (axis.values.empty()) return;
    }
    addSize(settings, where);
    json axes = json::object();
    for (const Axis& axis : settings.axes) axes[axis.name] = nullptr;
    if (m_calibration) axes[m_calibration->setting] = nullptr;
    if (settings.question) axes[settings.question->parameter] = nullptr;
    for (const Axis& axis : settings.axes) {
      if (!axis.labelled && !stageByName(axis.name)) continue;  // its values are not checked
      for (const AxisValue& value : axis.values) settings.named.merge(namedIn(value.written, axes));
    }
    const Shared s = std::make_shared<const Settings>(std::move(settings));
    std::vector<std::size_t> at(s->axes.size(), 0);
    for (;;) {
      cell(s, at, where);
      std::size_t i = at.size();
      while (i > 0 && ++at[i - 1] == s->axes[i - 1].values.size()) at[--i] = 0;
      if (i == 0) return;
    }
  }

  void addSize(const Settings& s, const toml::node& where) {
    const std::size_t budgets = m_calibration ? s.budgets.size() : 1;
    if (const auto& q = s.question) {  // the timed unit is one rung
      return m_size->add({s.axes, budgets, 1, false, true, "", q->mostTrials()}, m_path, where);
    }
    m_size->add({s.axes, budgets, s.repeats, s.timed, s.untimed, m_twice}, m_path, where);
  }

  void refuseUncalibrated(const Settings& s, const toml::node& where) const {
    const std::string& setting = m_calibration->setting;
    for (const Axis& axis : s.axes) {
      if (axis.name != setting && axis.name != "budget") continue;
      failAt(m_path, *axis.node, "axis '" + axis.name + "' is what 'calibrate' finds; valid: budgets = [...]");
    }
    if (s.budgets.empty()) failAt(m_path, where, "'calibrate' needs budgets = [...], here or for all groups");
    if (m_calibration->isTime && !s.timed) {
      failAt(m_path, where, "'calibrate' by '" + m_calibration->metric + "', a time; valid: timed = true");
    }
  }

  void refuseSearched(const Settings& s, const toml::node& where) const {
    s.question->check();
    for (const Axis& axis : s.axes) {
      if (axis.name != s.question->parameter && axis.name != "seed" && axis.name != "question") continue;
      failAt(m_path, *axis.node, "axis '" + axis.name + "' is what 'break' searches; valid: another name");
    }
    if (m_calibration && m_calibration->isTime) {
      failAt(m_path, where, "'break' at equal '" + m_calibration->metric + "', a time; valid: a count");
    }
  }

  // One ladder, or one for each budget.
  void ladder(const Shared& s, const std::vector<std::size_t>& at, const toml::node& where, const json& axes) {
    const auto trialsAt = [self = shared_from_this(), s, at, &where, axes](const Ladder::Place& p,
                                                                           std::set<std::string>& names) {
      json cell = axes;
      cell[s->question->parameter] = axisNumber(p.value), cell["seed"] = p.seed;
      cell.emplace(kPerturbParameter, s->question->perturb);
      if (self->m_calibration) cell[self->m_calibration->setting] = p.setting;
      return self->trialsOf(*s, at, where, cell, names, !p.timed, p.timed);
    };
    std::set<std::string> names;
    trialsAt({s->question->from, 1, 1, false}, names);
    m_out.roles["question"] = "run";
    if (m_calibration) m_out.roles["budget"] = "run";
    if (!wanted(names)) return;
    for (const double budget : m_calibration ? s->budgets : std::vector<double>{0}) {
      Ladder made{*s->question, axes, budget, [trialsAt](const Ladder::Place& p) {
                    std::set<std::string> unused;
                    return trialsAt(p, unused);
                  }};
      made.timed = s->timed;
      addLadder(m_out, std::move(made));
    }
  }

  // Seeds share a setting: with separate settings, the ranking would mix methods and settings.
  void calibratedCell(const Shared& s, const std::vector<std::size_t>& at, const toml::node& where, const json& axes) {
    const std::vector<json> seeds = seedsOf(s->axes);
    if (!seeds.empty() && axes["seed"] != seeds.front()) return;
    const auto trialsAt = [self = shared_from_this(), s, at, &where, axes, seeds](long setting,
                                                                                  std::set<std::string>& names) {
      json cell = axes;
      cell[self->m_calibration->setting] = setting;
      std::vector<PlannedTrial> out;
      for (std::size_t i = 0; i < std::max<std::size_t>(1, seeds.size()); ++i) {
        if (!seeds.empty()) cell["seed"] = seeds[i];
        for (auto& t : self->trialsOf(*s, at, where, cell, names, s->untimed, s->timed)) out.push_back(std::move(t));
      }
      return out;
    };
    std::set<std::string> names;
    trialsAt(1, names);
    m_out.roles["budget"] = "run";
    if (!wanted(names)) return;
    addCalibrated(m_out, {axes, s->budgets, [trialsAt](long setting) {
                            std::set<std::string> unused;
                            return trialsAt(setting, unused);
                          }});
  }

  void cell(const Shared& s, const std::vector<std::size_t>& at, const toml::node& where) {
    json axes = json::object();
    for (std::size_t i = 0; i < at.size(); ++i) {
      const json& label = axes[s->axes[i].name] = s->axes[i].values[at[i]].label;
      if (label.is_string()) m_named.insert(label.get<std::string>());
    }
    if (s->question) return ladder(s, at, where, axes);
    if (m_calibration) return calibratedCell(s, at, where, axes);
    std::set<std::string> names;
    for (PlannedTrial& trial : trialsOf(*s, at, where, axes, names, s->untimed, s->timed)) {
      // Two groups may share a cell; it runs once.
      if (wanted(names) && m_seen.insert(trial.key).second) m_out.trials.push_back(std::move(trial));
    }
  }

  // `names` gets the participating labels, algorithms and scenes.
  std::vector<PlannedTrial> trialsOf(const Settings& s, const std::vector<std::size_t>& at, const toml::node& where,
                                     const json& axes, std::set<std::string>& names, bool untimed, bool timed) {
    std::vector<PlannedTrial> out;
    const auto add = [&](bool clocked, long repeats) {
      PlannedTrial trial;
      try {
        trial = m_kind == "world" ? world(s, at, axes, clocked, names) : frozen(axes, clocked, names);
      } catch (const UserError& e) {
        if (std::string_view(e.what()).find(".toml:") != std::string_view::npos) throw;
        failInCell(e.what(), s, at, where);
      }
      if (m_kind != "world") trial.axes = axes;
      trial.axes["kind"] = m_kind, trial.axes["precision"] = trial.asked().precision;
      if (m_kind == "world") trial.axes["scene"] = trial.world().scene;
      if (m_kind == "world" && !trial.world().script.empty()) trial.axes["script"] = trial.world().script;
      if (m_kind == "problems") trial.axes["dimension"] = trial.asked().dimension;
      trial.axes["timed"] = clocked;
      for (long r = 0; r < repeats; ++r) {  // planned once: 65,536 repeats took 14 s
        trial.setRepeat(static_cast<int>(r));
        out.push_back(trial);
      }
    };
    if (untimed) add(false, s.timed ? 1 : s.repeats);
    if (m_timed = m_timed || s.timed; timed) {
      const bool twice = std::find(axes.begin(), axes.end(), json(m_twice)) != axes.end();
      add(true, (twice ? 2 : 1) * s.repeats);
    }
    return out;
  }

  [[noreturn]] void failInCell(const std::string& message, const Settings& s, const std::vector<std::size_t>& at,
                               const toml::node& where) const {
    std::vector<WrittenText> texts;
    for (std::size_t i = at.size(); i-- > 0;) {  // a later axis replaces the stage of an earlier one
      const Axis& axis = s.axes[i];
      const AxisValue& value = axis.values[at[i]];
      texts.push_back({axis.name, value.written + " " + value.pipeline, value.node, ""});
      // An invalid method of the command line fails in its first cell, after the other methods were planned.
      if (value.by == WrittenBy::with) throw UserError("--with " + valueText(value.label) + ": " + message);
      for (const SetAxis& set : m_set) {
        if (value.by == WrittenBy::set && set.axis == axis.name) texts.back().given = "--set '" + set.given + "'";
      }
    }
    if (s.pipelineNode) texts.push_back({"pipeline", s.pipeline, s.pipelineNode, ""});
    // Several axes together may cause the error.
    failWhereWritten(m_path, message, texts, at.empty() ? where : *s.axes[0].values[at[0]].node);
  }

  bool wanted(const std::set<std::string>& names) {
    bool any = m_only.empty();
    for (const std::string& n : m_only) {
      if (names.count(n)) any = true, m_matched.insert(n);
    }
    return any;
  }

  PlannedTrial world(const Settings& s, const std::vector<std::size_t>& at, const json& axes, bool timed,
                     std::set<std::string>& names) {
    WorldCell cell;
    cell.timed = timed, cell.posesEvery = s.posesEvery, cell.series = s.series;
    std::set<std::string> used = s.named;
    CellPipeline pipeline(s.pipeline, axes, used);
    for (std::size_t i = 0; i < at.size(); ++i) {
      const Axis& axis = s.axes[i];
      const AxisValue& value = axis.values[at[i]];
      std::string part;
      if (axis.labelled) {
        part = value.pipeline;
        names.insert(value.label.get<std::string>());
        m_out.roles[axis.name] = "label";
      } else if (const StageInfo* stage = stageByName(axis.name);
                 isWorldStage(stage) || (stage && stage->kind == StageKind::engine)) {
        m_out.roles[axis.name] = "stage";
        part = axis.name + "=" + valueText(value.label);
      } else {
        continue;
      }
      pipeline.put(part, names, used);
      used.insert(axis.name);
    }
    cell.pipeline = pipeline.finish(names);
    std::set<std::string> named = pipeline.named();
    if (!axes.contains("scene")) throw UserError("a sweep of kind 'world' needs the axis 'scene'");
    const std::string scenePath = beside(m_path, valueText(axes["scene"]));
    cell.script = scriptOf(axes, used);
    const SceneFile& file = m_planner->scene(scenePath, cell.script);
    m_files.add(file, axes.contains("script") && !used.count("script"));
    names.insert(file.name());
    if (const SceneParameter* p = file.parameter(kJointParameter); p && p->value.isText() && axes.contains(p->name)) {
      std::set<std::string> ofJoint;
      cell.params[p->name] = withValues(valueText(axes[p->name]), axes, ofJoint);
      used.insert(ofJoint.begin(), ofJoint.end()), named.merge(ofJoint);
    }
    const std::string model = readWorldAxes(file, axes, used, cell, m_out.roles);
    if (!model.empty()) applyModel(file, model, cell);
    PlannedTrial trial = m_planner->world(scenePath, cell);
    for (const auto& [name, value] : axes.items()) {  // a method without the setting has no value of it
      const bool searched = s.question && s.question->parameter == name;
      if (m_out.roles[name] != "setting" || named.count(name) || searched) trial.axes[name] = value;
    }
    if (trial.unsupported.empty()) {
      json choices = json::object();
      for (const auto& [name, value] : axes.items()) {
        if (name == "dimension" || m_out.roles[name] == "parameter") choices[name] = value;
      }
      m_seeds.saw(trial, choices);
    }
    const auto kind = cell.params.find(kJointParameter);  // now known to be valid
    if (kind != cell.params.end() && kind->second.isText()) collectNames(Spec::parse(kind->second.text), names);
    return trial;
  }

  PlannedTrial frozen(json axes, bool timed, std::set<std::string>& names) {
    if (m_kind == "problems" && axes.contains("problems")) {
      axes["problems"] = beside(m_path, valueText(axes["problems"]), ".json");
    }
    if (m_kind == "pairs" && axes.contains("scene")) axes["scene"] = beside(m_path, valueText(axes["scene"]));
    return frozenTrial(*m_planner, m_kind, axes, timed, m_out.roles, names);
  }

  // The script of the scene; empty: none, also if the axis belongs to pipelines or is a setting of theirs.
  std::string scriptOf(const json& axes, const std::set<std::string>& used) const {
    if (used.count("script") || !axes.contains("script")) return "";
    const std::string script = valueText(axes["script"]);
    return script == "none" ? "" : beside(m_path, script);
  }

  std::string m_path, m_kind;
  const std::set<std::string>& m_only;
  std::set<std::string>& m_matched;
  const std::vector<std::string>& m_with;
  const std::vector<SetAxis> m_set;
  std::set<std::string>& m_taken;
  toml::table m_table;
  std::shared_ptr<Planner> m_planner;
  std::shared_ptr<SweepSize> m_size;
  std::optional<Calibration> m_calibration;
  std::set<std::string> m_seen, m_named;  // keys; values of axes that are not numbers
  std::string m_twice;                    // a value of an axis: its cells are timed as if they were two
  bool m_timed = false;                   // whether any trial is
  IdleSeeds m_seeds;
  AxisFiles m_files;
  PlannedSweep m_out;
};

}  // namespace

std::vector<PlannedSweep> planSweeps(const std::string& nameOrPath, const std::vector<std::string>& onlyList,
                                     const std::vector<std::string>& with, const std::vector<std::string>& setList) {
  const std::string path = findToml("sweeps", nameOrPath);
  const std::set<std::string> only(onlyList.begin(), onlyList.end());
  const std::vector<SetAxis> set(setList.begin(), setList.end());
  std::set<std::string> matched, taken;
  std::vector<std::pair<std::string, std::string>> files = {{nameOrPath, path}};  // as given, and its path
  const toml::table table = parseToml(readFile(path), path);
  if (table.contains("sweeps")) {
    TableReader named(table, path, "a set of sweeps");
    named.requireString("summary");
    files.clear();
    for (const std::string& name : named.strings("sweeps")) {
      try {
        files.emplace_back(name, findToml("sweeps", name));
      } catch (const UserError& e) {
        named.fail(*named.find("sweeps"), e.what());
      }
    }
    if (files.empty()) named.fail(*named.find("sweeps"), "'sweeps' is empty; valid: names of sweeps");
    named.finish();
  }
  const auto planner = std::make_shared<Planner>();
  std::vector<PlannedSweep> out;
  const auto size = std::make_shared<SweepSize>();
  for (const auto& [name, file] : files) {
    std::set<std::string> here, used;
    out.push_back(std::make_shared<Sweep>(file, only, here, with, set, used)->plan(planner, size));
    if (only.empty() || !here.empty()) out.back().command = commandOf(name, here, used, with, setList);
    matched.merge(here), taken.merge(used);
  }
  for (const SetAxis& s : set) {
    if (taken.count(s.given)) continue;
    throw UserError("--set '" + s.given + "': no sweep of '" + nameOrPath + "' has an axis '" + s.axis + "'");
  }
  for (const std::string& method : with) {
    if (!taken.count(method)) {
      throw UserError("--with '" + method + "': no sweep of '" + nameOrPath +
                      "' has labelled methods in [axes], and an axis for each $name that this one uses");
    }
  }
  for (const std::string& name : only) {
    if (matched.count(name)) continue;
    throw UserError("--only " + name + ": no cell of '" + nameOrPath +
                    "' has a label, algorithm or scene of that name");
  }
  return out;
}

}}  // namespace lpc::LPC_PRECISION
