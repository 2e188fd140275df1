// SPDX-License-Identifier: Zlib
#include "experiments/trial/scene_file.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <utility>

#include "experiments/trial/scene_event.h"
#include "experiments/trial/scene_parsed.h"
#include "framework/names.h"

namespace lpc::inline LPC_PRECISION {
namespace {

constexpr std::string_view kTurns = "turns of loops", kEmptyTurns = "turns of loops around others of no turn";
constexpr double kRightAngle = 1.5707963267948966;  // rad

using Entries = std::vector<std::pair<std::string, const toml::node*>>;

template <int D>
class Builder {
 public:
  Builder(const SceneFile::Parsed& parsed, const ParameterValues& values, std::uint64_t seed)
      : m_parsed(parsed),
        m_numbers(parsed.path, seed, parsed.meshes),
        m_seed(seed),
        m_perturb(values.at(kPerturbParameter).number),
        m_top(parsed.table, parsed.path, "the scene"),
        m_script(parsed.script, parsed.scriptPath, "the script") {
    for (const auto& [name, value] : values) {
      if (value.isText()) {
        m_chosenJoint = value.text;
      } else {
        m_numbers.expressions.setGlobal(name, value.number);
      }
    }
    m_numbers.expressions.setGlobal("dimension", D);
  }

  SceneSpec<D> build() {
    for (const char* done : {"name", "summary", "dimensions", "seed", "needs", "parameters"}) m_top.find(done);
    for (const char* done : {"summary", "parameters"}) m_script.find(done);
    sceneLets();
    m_top.find("saved");
    if (!m_parsed.saved.empty()) startFromSaved(m_top, m_parsed, m_scene);
    if (m_top.find("settings")) startFromSettings();
    m_scene.name = m_parsed.name, m_scene.summary = m_parsed.summary;
    m_scene.settings.features = m_parsed.needs;
    if (const toml::node* g = m_top.find("gravity")) m_scene.settings.gravity = m_numbers.vector<D>(*g);
    const auto real = [&](TableReader& t, const char* key, Real& value) {
      value = static_cast<Real>(m_numbers.between(t, key, value, 0, kLargest));
    };
    if (const toml::node* dt = m_top.find("dt")) {
      m_scene.dt = static_cast<Real>(m_numbers.between(*dt, "dt", 0, kMaxDt));
      if (!(m_scene.dt > 0)) m_top.fail(*dt, "'dt' is 0 s; valid: above 0");
    }
    real(m_top, "restitution_threshold", m_scene.settings.restitutionThreshold);
    real(m_top, "margin", m_scene.settings.margin);
    m_scene.settings.sleepingContacts =
        m_numbers.whole(m_top, "sleeping_contacts", m_scene.settings.sleepingContacts, 0, 1) != 0;
    m_scene.steps = m_numbers.whole(m_top, "steps", m_scene.steps, 0, kMaxSteps);
    m_scene.steps = m_numbers.whole(m_script, "steps", m_scene.steps, 0, kMaxSteps);  // it knows when it ends
    if (const toml::table* t = m_top.table("limits")) {
      TableReader limits(*t, m_parsed.path, "[limits]");
      real(limits, "drift", m_scene.limits.drift);
      real(limits, "creep", m_scene.limits.creep);
      real(limits, "speed", m_scene.limits.speed);
      real(limits, "energy", m_scene.limits.energy);
      limits.finish();
    }
    if (const toml::table* t = m_top.table("mixing")) {
      TableReader mixing(*t, m_parsed.path, "[mixing]");
      mixRule(mixing, "friction", m_scene.settings.mixing.friction);
      mixRule(mixing, "restitution", m_scene.settings.mixing.restitution);
      mixing.finish();
    }
    m_defaults = m_top.table("defaults");
    if (m_defaults) {
      TableReader defaults(*m_defaults, m_parsed.path, "[defaults]");
      for (const char* name : {"density", "friction", "restitution"}) defaults.find(name);
      defaults.finish();
    }
    for (const toml::table* t : m_top.blocks("body")) bodyBlock(*t);
    for (const toml::table* t : m_script.blocks("body")) bodyBlock(*t);
    std::vector<const toml::table*> events = m_top.blocks("event");
    for (const toml::table* t : m_script.blocks("event")) events.push_back(t);
    for (const toml::table* t : events) eventBlock(*t, true);
    sortSpawns();
    if (const toml::table* t = m_top.table("measures")) measures(*t);
    for (const toml::table* t : m_top.blocks("joint")) jointBlock(*t);
    for (const toml::table* t : m_top.blocks("force")) forceBlock(*t);
    if (const toml::node* old = m_top.find("spring")) {
      m_top.fail(*old, "there is no [[spring]]; valid: [[force]] with kind = \"spring\" and its parameters = { ... }");
    }
    for (const toml::table* t : events) eventBlock(*t, false);
    checkUses();
    std::stable_sort(m_scene.events.begin(), m_scene.events.end(),
                     [](const auto& a, const auto& b) { return a.step < b.step; });
    m_top.finish(), m_script.finish();
    m_scene.seeded = m_numbers.expressions.drew();
    if (m_perturb > 0 && !m_scene.saved.empty()) {
      m_top.fail(*m_top.find("saved"), "'perturb' moves who starts, and a saved world has started; valid: perturb = 0");
    }
    perturb(m_scene, m_perturb, m_seed);
    return std::move(m_scene);
  }

 private:
  // What the file's own keys say stands above it.
  void startFromSettings() {
    const std::string name = m_top.requireString("settings");
    try {
      m_settings = Settings::named(name, D);
    } catch (const UserError& e) {
      m_top.fail(*m_top.find("settings"), e.what());
    }
    m_scene.settings = m_settings.world<D>();
    m_scene.dt = m_settings.dt;
  }

  // The scene's own `let`, which all blocks know, and each name those after it: none can come round to itself.
  void sceneLets() {
    const toml::table* lets = m_top.table("let");
    for (const auto& [name, node] : lets ? inFileOrder(*lets) : Entries{}) {
      const double value = m_numbers.number(*node);
      ++m_sceneLets;
      checkNew(*node, name);
      m_numbers.expressions.setGlobal(name, value);
    }
  }

  // Runs `once` for every turn of the block's loops. `k` counts the turns over all loops and script steps.
  void loops(TableReader& block, const std::function<void()>& once) {
    const toml::node* repeat = block.find("repeat");
    if (!repeat || !repeat->is_table()) {
      const long n = repeat ? times(*repeat) : 1;
      if (repeat) m_numbers.count(*repeat, kTurns, n);
      for (long i = 0; i < n; ++i) turn(block, once);
      return;
    }
    // The turns are counted before the first is made.
    const Entries indices = inFileOrder(*repeat->as_table());
    m_numbers.expressions.aside([&] { nested(indices, 0, nullptr); });
    nested(indices, 0, [&] { turn(block, once); });
  }
  // Without a `body` it only counts: the innermost turns, and those of outer loops that have none.
  void nested(const Entries& indices, std::size_t depth, const std::function<void()>& body) {
    if (depth == indices.size()) return body ? body() : void();
    const auto& [name, bound] = indices[depth];
    const long n = times(*bound);
    const bool innermost = depth + 1 == indices.size();
    if (!body && innermost) m_numbers.count(*bound, kTurns, n);
    if (!body && n == 0 && depth > 0) m_numbers.count(*bound, kEmptyTurns);
    local(*bound, name, 0);
    if (!body && innermost) return;
    for (long i = 0; i < n; ++i) {
      m_numbers.expressions.setLocal(name, static_cast<double>(i));
      nested(indices, depth + 1, body);
    }
  }
  void turn(TableReader& block, const std::function<void()>& once) {
    auto& e = m_numbers.expressions;
    e.setLocal("k", static_cast<double>(m_turns));
    if (const toml::table* lets = block.table("let")) {
      for (const auto& [name, node] : inFileOrder(*lets)) local(*node, name, m_numbers.number(*node));
    }
    const toml::node* when = block.find("when");
    if (when && m_numbers.number(*when) == 0 && !m_numbers.rehearsing()) return;
    ++m_turns;
    once();
  }
  // At the end of a block. One that made no turn is read all the same, for its mistakes.
  void endLoops(TableReader& block, const std::function<void()>& once) {
    if (m_turns == 0) {
      const SceneNumbers::Rehearsal rehearsal(m_numbers);
      const toml::node* repeat = block.find("repeat");
      const toml::table* indices = repeat ? repeat->as_table() : nullptr;
      for (const auto& [name, bound] : indices ? inFileOrder(*indices) : Entries{}) {
        m_numbers.number(*bound), local(*bound, name, 0);
      }
      SceneSpec<D> scene = std::exchange(m_scene, {});
      m_scene.spawns.emplace_back();  // whatever body is named
      turn(block, once);
      m_scene = std::move(scene);
    }
    block.finish();
  }
  long times(const toml::node& bound) {
    const double n = m_numbers.number(bound);
    if (!(n >= 0) || n > static_cast<double>(kMostOfEach) || n != std::floor(n)) {
      failAt(m_parsed.path, bound, "a loop runs " + asText(n) + " times; valid: a whole number from 0 to 1000000");
    }
    return static_cast<long>(n);
  }
  // The steps from `from` before `until`.
  void checkSteps(TableReader& block, long from, long every, long until) const {
    if (until < from) {
      block.fail(*block.find("until"), "'until' is " + std::to_string(until) + "; valid: from step " +
                                           std::to_string(from) + " on, when it begins");
    }
    if (every > 0 && (until - from) / every > kMostOfEach) block.fail("more than 1000000 turns");
  }
  void local(const toml::node& node, const std::string& name, double value) {
    const toml::node*& known = m_locals[name];
    if (known != &node) {
      checkNew(node, name);
      known = &node;
    }
    m_numbers.expressions.setLocal(name, value);
  }
  void checkNew(const toml::node& node, const std::string& name) const {
    const std::size_t names = m_locals.size() + m_sceneLets + m_parsed.parameters.size() - 1;
    if (names > kMostNames) failAt(m_parsed.path, node, kTooManyNames);
    try {
      Expressions::checkName(name);
      const bool set = std::find(std::begin(kSetNames), std::end(kSetNames), name) != std::end(kSetNames);
      if (set || m_numbers.expressions.knows(name)) {
        throw UserError("'" + name + "' is already the name of something else");
      }
    } catch (const UserError& e) {
      failAt(m_parsed.path, node, e.what());
    }
  }
  void beginBlock() {
    m_numbers.expressions.forgetLocals();
    m_locals.clear();
    m_turns = 0;
    for (const char* name : {"k", "step", "part"}) m_numbers.expressions.setLocal(name, 0);
  }

  // Empty where it has none.
  static std::string nameOf(TableReader& block) {
    std::string name = block.string("name", "");
    if (name == "world" || name.find('[') != name.npos) {
      block.fail(*block.find("name"), "'name' is '" + name + "'; valid: any but 'world', and without a '['");
    }
    return name;
  }

  void bodyBlock(const toml::table& table) {
    TableReader block(table, m_parsed.path, "[[body]]");
    beginBlock();
    const std::string name = nameOf(block);
    const long from = m_numbers.whole(block, "from", 0, 0, kMaxSteps);
    const long every = m_numbers.whole(block, "every", 0, 0, kMaxSteps);
    const long until = m_numbers.whole(block, "until", from + 1, 0, kMaxSteps);
    if (block.find("until") && every <= 0) block.fail("'until' needs 'every' > 0");
    checkSteps(block, from, every, until);
    if (!name.empty()) m_named[name];
    long step = from;
    const auto once = [&] { addBody(block, name, step, m_numbers.whole(block, "remove", -1, -1, kMaxSteps)); };
    for (; step<until; step += every> 0 ? every : until - from) {
      m_numbers.expressions.setLocal("step", static_cast<double>(step));
      loops(block, once);
    }
    endLoops(block, once);
  }

  void addBody(TableReader& block, const std::string& name, long step, long removeAt) {
    typename SceneSpec<D>::Spawn spawn;
    spawn.step = step, spawn.removeAt = removeAt;
    spawn.body = readBody<D>(block, m_numbers, m_defaults, m_settings);
    spawn.body.name = name;
    if (m_numbers.rehearsing()) return;
    if (removeAt >= 0 && removeAt < step) {
      block.fail(*block.find("remove"), "'remove' is " + std::to_string(removeAt) + "; valid: from step " +
                                            std::to_string(step) + " on, when the body comes");
    }
    m_numbers.count(block.raw(), "bodies");
    if (!name.empty()) m_named[name].push_back(static_cast<int>(m_scene.spawns.size()));
    m_scene.spawns.push_back(std::move(spawn));
  }

  // Once at `step`, or at every `every`-th before `until`. Those that name new bodies are read in a round of their own.
  void eventBlock(const toml::table& table, bool naming) {
    TableReader block(table, m_parsed.path, "[[event]]");
    const std::string name = block.requireString("do");
    const auto kinds = eventKinds<D>();
    const auto kind = std::find_if(kinds.begin(), kinds.end(), [&](const auto& k) { return k.name == name; });
    if (kind == kinds.end()) {
      std::vector<std::string> names;
      for (const auto& k : kinds) names.emplace_back(k.name);
      block.fail(*block.find("do"), "unknown event '" + name + "'" + validNames(names, name));
    }
    if (kind->names != naming) return;
    beginBlock();
    block.require("step");
    const long from = m_numbers.whole(block, "step", 0, 0, kMaxSteps);
    const long every = m_numbers.whole(block, "every", 1, 1, kMaxSteps);
    const long until = m_numbers.whole(block, "until", from + 1, 0, kMaxSteps);
    if (block.find("every") && !block.find("until")) block.fail("'every' needs 'until'");
    checkSteps(block, from, every, until);
    if (naming && block.find("name")) m_named[nameOf(block)];
    long step = from;
    const auto bodyNamed = [&](const std::string& key) {
      const int body = bodyOf(block, key, false);
      use(body, step, table);
      return body;
    };
    const auto joint = [&](TableReader& t) {
      const auto j = readJointOf(t);
      use(j.bodyA, step, table), use(j.bodyB, step, table);
      return j;
    };
    const auto add = [&] { addBody(block, nameOf(block), step, -1); };
    const auto once = [&] {
      m_numbers.count(table, "events");
      kind->read({block, m_numbers, step, m_scene, bodyNamed, add, joint});
    };
    for (; step < until; step += every) {
      m_numbers.expressions.setLocal("step", static_cast<double>(step));
      loops(block, once);
    }
    endLoops(block, once);
  }
  void use(int body, long step, const toml::table& block) {
    if (body >= 0 && !m_numbers.rehearsing()) m_uses.push_back({body, step, &block});
  }
  // The bodies that events name must be there then.
  void checkUses() const {
    for (const Use& use : m_uses) {
      const auto& spawn = m_scene.spawns[static_cast<std::size_t>(use.body)];
      const std::string who = "at step " + std::to_string(use.step) + " '" + spawn.body.name + "' is not there: it ";
      if (use.step < spawn.step) failAt(m_parsed.path, *use.block, who + "comes at " + std::to_string(spawn.step));
      if (spawn.removeAt >= 0 && use.step > spawn.removeAt) {
        failAt(m_parsed.path, *use.block, who + "is removed at " + std::to_string(spawn.removeAt));
      }
    }
  }

  static void mixRule(TableReader& table, const std::string& key, MixRule& rule) {
    const std::string name = table.string(key, std::string(kMixRuleNames[static_cast<std::size_t>(rule)]));
    const auto found = std::find(kMixRuleNames.begin(), kMixRuleNames.end(), name);
    if (found == kMixRuleNames.end()) {
      const std::vector<std::string> valid(kMixRuleNames.begin(), kMixRuleNames.end());
      table.fail(table.require(key), "'" + key + "' is '" + name + "'" + validNames(valid, name));
    }
    rule = static_cast<MixRule>(found - kMixRuleNames.begin());
  }

  // Bodies are known by their place among the spawns, which are sorted by step.
  void sortSpawns() {
    auto& spawns = m_scene.spawns;
    std::vector<std::size_t> order(spawns.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return spawns[a].step < spawns[b].step; });
    std::vector<typename SceneSpec<D>::Spawn> sorted;
    std::vector<int> place(spawns.size());
    for (std::size_t i : order) {
      place[i] = static_cast<int>(sorted.size());
      sorted.push_back(std::move(spawns[i]));
    }
    spawns = std::move(sorted);
    for (auto& [name, list] : m_named) {
      for (int& i : list) i = place[static_cast<std::size_t>(i)];
    }
  }

  // "plank[i + 1]", "plank" for the first, "world"
  int bodyOf(TableReader& block, const std::string& key, bool worldAllowed) {
    const toml::node& node = block.require(key);
    const std::string text = block.requireString(key);
    if (text == "world" && worldAllowed) return -1;
    const std::size_t bracket = text.find('[');
    const auto it = m_named.find(text.substr(0, bracket));
    if (it == m_named.end()) {
      std::vector<std::string> names;
      for (const auto& [name, list] : m_named) names.push_back(name);
      block.fail(node, "there is no body named '" + text + "'" + validNames(names, text));
    }
    double index = 0;
    if (bracket != std::string::npos) {
      if (text.back() != ']') block.fail(node, "']' is missing in '" + text + "'");
      try {
        const std::string inside = text.substr(bracket + 1, text.size() - bracket - 2);
        if (m_numbers.rehearsing()) m_numbers.expressions.check(inside);
        if (!m_numbers.rehearsing()) index = m_numbers.expressions.evaluate(inside);
      } catch (const UserError& e) {
        block.fail(node, e.what());
      }
    }
    if (m_numbers.rehearsing()) return 0;
    if (index < 0 || index >= static_cast<double>(it->second.size()) || index != std::floor(index)) {
      block.fail(node, "'" + it->first + "' has " + std::to_string(it->second.size()) + " bodies, asked is number " +
                           asText(index));
    }
    return it->second[static_cast<std::size_t>(index)];
  }
  // What has a closed form, so that it can be measured against it.
  void measures(const toml::table& table) {
    TableReader all(table, m_parsed.path, "[measures]");
    if (const toml::table* t = all.table("slope")) {
      TableReader block(*t, m_parsed.path, "[measures.slope]");
      beginBlock();
      typename SceneSpec<D>::Slope slope;
      slope.body = bodyOf(block, "body", false);
      if (m_scene.spawns[static_cast<std::size_t>(slope.body)].body.type != BodyType::dynamic) {
        block.fail(block.require("body"), "'body' does not move; valid: a dynamic body");
      }
      slope.angle = static_cast<Real>(m_numbers.between(block.require("angle"), "angle", 0, kRightAngle));
      slope.friction = static_cast<Real>(m_numbers.between(block.require("friction"), "friction", 0, kLargest));
      block.finish();
      m_scene.slope = slope;
    }
    all.finish();
  }
  void jointBlock(const toml::table& table) {
    TableReader block(table, m_parsed.path, "[[joint]]");
    beginBlock();
    const auto comes = [&](int body) { return body < 0 ? 0 : m_scene.spawns[static_cast<std::size_t>(body)].step; };
    const auto once = [&] {
      const auto joint = readJointOf(block);
      if (!m_numbers.rehearsing()) {  // it comes with the later of the two
        const long step = std::max(comes(joint.bodyA), comes(joint.bodyB));
        use(joint.bodyA, step, table), use(joint.bodyB, step, table);
      }
      m_scene.joints.push_back(joint);
    };
    loops(block, once);
    endLoops(block, once);
  }
  typename SceneSpec<D>::Joint readJointOf(TableReader& block) {
    if (!m_parsed.needs.joints) {
      block.fail("a joint in a scene without the need of them, where it holds nothing; valid: 'needs' with \"joints\"");
    }
    m_numbers.count(block.raw(), "joints");
    typename SceneSpec<D>::Joint joint;
    joint.bodyA = bodyOf(block, "a", true), joint.bodyB = bodyOf(block, "b", false);
    checkTwo(block, joint.bodyA, joint.bodyB);
    joint.def = readJoint<D>(block, m_numbers, m_chosenJoint);
    return joint;
  }
  void checkTwo(const TableReader& block, int bodyA, int bodyB) const {
    if (m_numbers.rehearsing()) return;
    const auto moves = [&](int body) {
      return body >= 0 && m_scene.spawns[static_cast<std::size_t>(body)].body.type == BodyType::dynamic;
    };
    if (bodyA == bodyB) {
      block.fail("a joint of a body with itself; valid: two bodies, or \"world\" and one");
    }
    if (!moves(bodyA) && !moves(bodyB)) block.fail("a joint of two bodies that do not move");
  }
  void forceBlock(const toml::table& table) {
    TableReader block(table, m_parsed.path, "[[force]]");
    beginBlock();
    const auto once = [&] {
      m_numbers.count(table, "forces");
      const int a = block.find("a") ? bodyOf(block, "a", true) : -1,
                b = block.find("b") ? bodyOf(block, "b", false) : -1;
      const auto force = readForce<D>(block, m_numbers, m_scene, a, b);
      use(a, force.step, table), use(b, force.step, table);
      m_scene.forces.push_back(force);
    };
    loops(block, once);
    endLoops(block, once);
  }

  const SceneFile::Parsed& m_parsed;
  SceneNumbers m_numbers;
  std::uint64_t m_seed;
  double m_perturb;
  std::string m_chosenJoint;  // by the parameter `joint`; empty where there is none
  TableReader m_top, m_script;
  const toml::table* m_defaults = nullptr;
  Settings m_settings;
  SceneSpec<D> m_scene;
  std::map<std::string, std::vector<int>> m_named;
  struct Use {  // of a body by an event
    int body;
    long step;
    const toml::table* block;
  };
  std::vector<Use> m_uses;
  std::map<std::string, const toml::node*> m_locals;  // indices and `let`s of the block
  std::size_t m_sceneLets = 0;
  long m_turns = 0;
};

}  // namespace

template <int D>
SceneSpec<D> SceneFile::build(const ParameterValues& given, std::uint64_t seed) const {
  if (!has(D)) {
    throw UserError("scene '" + m_parsed->name + "' does not exist in " + std::to_string(D) + "D");
  }
  return Builder<D>(*m_parsed, values(given), seed).build();
}

template SceneSpec<2> SceneFile::build<2>(const ParameterValues&, std::uint64_t) const;
template SceneSpec<3> SceneFile::build<3>(const ParameterValues&, std::uint64_t) const;

}  // namespace lpc::inline LPC_PRECISION
