// SPDX-License-Identifier: Zlib
#include "experiments/trial/scene/scene_file.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <utility>

#include "experiments/trial/scene/scene_event.h"
#include "experiments/trial/scene/scene_names.h"
#include "experiments/trial/scene/scene_parsed.h"
#include "framework/math/names.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

constexpr std::string_view kTurns = "turns of loops", kEmptyTurns = "turns of loops with empty inner loops";
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
    for (const char* done : {"summary", "needs", "parameters"}) m_script.find(done);
    sceneLets();
    m_top.find("saved");
    if (!m_parsed.saved.empty()) startFromSaved(m_top, m_parsed, m_scene);
    for (std::size_t i = 0; i < m_scene.spawns.size(); ++i) m_bodies.number(static_cast<int>(i));
    if (m_top.find("settings")) startFromSettings();
    m_scene.name = m_parsed.name, m_scene.summary = m_parsed.summary;
    m_scene.settings.model = m_parsed.model;
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
    m_scene.steps = m_numbers.whole(m_script, "steps", m_scene.steps, 0, kMaxSteps);  // it knows its end
    if (const toml::table* t = m_top.table("limits")) {
      TableReader limits(*t, m_parsed.path, "[limits]");
      real(limits, "drift", m_scene.limits.drift);
      real(limits, "creep", m_scene.limits.creep);
      real(limits, "speed", m_scene.limits.speed);
      real(limits, "energy", m_scene.limits.energy);
      real(limits, "levels", m_scene.limits.levels);
      real(limits, "fall", m_scene.limits.fall);
      m_scene.limits.mayLeave = m_numbers.whole(limits, "may_leave", 0, 0, 1) != 0;
      limits.finish();
    }
    if (const toml::table* t = m_top.table("mixing")) {
      TableReader mixing(*t, m_parsed.path, "[mixing]");
      readMixRule(mixing, "friction", m_scene.settings.mixing.friction);
      readMixRule(mixing, "restitution", m_scene.settings.mixing.restitution);
      mixing.finish();
    }
    m_defaults = m_top.table("defaults");
    if (m_defaults) {
      TableReader defaults(*m_defaults, m_parsed.path, "[defaults]");
      for (const char* name : {"density", "friction", "restitution"}) defaults.find(name);
      defaults.finish();
    }
    for (const toml::table* t : m_top.blocks("body")) bodyBlock(*t, true);
    for (const toml::table* t : m_script.blocks("body")) bodyBlock(*t, false);
    const std::vector<const toml::table*> own = m_top.blocks("event"), scripted = m_script.blocks("event");
    events(own, scripted, true);
    sortSpawns();
    if (const toml::table* t = m_top.table("measures")) measures(*t);
    for (const toml::table* t : m_top.blocks("joint")) jointBlock(*t);
    for (const toml::table* t : m_top.blocks("force")) forceBlock(*t);
    if (const toml::node* old = m_top.find("spring")) {
      m_top.fail(*old, "unknown block [[spring]]; valid: [[force]] with kind = \"spring\", parameters = { ... }");
    }
    events(own, scripted, false);
    m_presence.check(m_scene, m_parsed.path);
    std::stable_sort(m_scene.events.begin(), m_scene.events.end(), [](const auto& a, const auto& b) {
      return std::pair(a.step, a.block) < std::pair(b.step, b.block);
    });
    m_top.finish(), m_script.finish();
    m_scene.seeded = m_numbers.expressions.drew();
    if (m_perturb > 0 && !m_scene.saved.empty()) {
      m_top.fail(*m_top.find("saved"), "'perturb' moves start poses, which a saved world has not; valid: perturb = 0");
    }
    perturb(m_scene, m_perturb, m_seed);
    m_bodies.write(m_scene);
    return std::move(m_scene);
  }

 private:
  // The settings of a saved world; keys of the file override them.
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

  // The scene's own `let`: all blocks may use them, and each may use those before it, so that none is circular.
  void sceneLets() {
    const toml::table* lets = m_top.table("let");
    for (const auto& [name, node] : lets ? inFileOrder(*lets) : Entries{}) {
      const double value = m_numbers.number(*node);
      ++m_sceneLets;
      checkNew(*node, name);
      m_numbers.expressions.setGlobal(name, value);
    }
  }

  // Calls `once` for every turn of the block's loops. `k` counts the turns over all loops and script steps.
  void loops(TableReader& block, const std::function<void()>& once) {
    const toml::node* repeat = block.find("repeat");
    if (!repeat || !repeat->is_table()) {
      const long n = repeat ? times(*repeat) : 1;
      if (repeat) m_numbers.count(*repeat, kTurns, n);
      for (long i = 0; i < n; ++i) turn(block, once);
      return;
    }
    // Counts the turns before the first is made.
    const Entries indices = inFileOrder(*repeat->as_table());
    m_numbers.expressions.aside([&] { nested(indices, 0, nullptr); });
    nested(indices, 0, [&] { turn(block, once); });
  }
  // Without a `body` it counts only: the innermost turns, and turns of outer loops without inner ones.
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
  // At the end of a block. A block without turns is still read, to report its errors.
  void endLoops(TableReader& block, const std::function<void()>& once) {
    if (m_turns == 0) {
      const SceneNumbers::Rehearsal rehearsal(m_numbers);
      const toml::node* repeat = block.find("repeat");
      const toml::table* indices = repeat ? repeat->as_table() : nullptr;
      for (const auto& [name, bound] : indices ? inFileOrder(*indices) : Entries{}) {
        m_numbers.number(*bound), local(*bound, name, 0);
      }
      SceneSpec<D> scene = std::exchange(m_scene, {});
      m_scene.spawns.emplace_back();  // whatever body it names
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
  // Checks the steps from `from` before `until`.
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

  void bodyBlock(const toml::table& table, bool ofScene) {
    TableReader block(table, m_parsed.path, "[[body]]");
    beginBlock();
    const std::string name = nameOf(block);
    const long from = m_numbers.whole(block, "from", 0, 0, kMaxSteps);
    const long every = m_numbers.whole(block, "every", 0, 0, kMaxSteps);
    const long until = m_numbers.whole(block, "until", from + 1, 0, kMaxSteps);
    if (block.find("until") && every <= 0) block.fail("'until' needs 'every' > 0");
    checkSteps(block, from, every, until);
    if (!name.empty()) m_bodies.know(name);
    long step = from;
    const auto once = [&] { addBody(block, name, step, m_numbers.whole(block, "remove", -1, -1, kMaxSteps), ofScene); };
    for (; step<until; step += every> 0 ? every : until - from) {
      m_numbers.expressions.setLocal("step", static_cast<double>(step));
      loops(block, once);
    }
    endLoops(block, once);
  }

  int addBody(TableReader& block, const std::string& name, long step, long removeAt, bool ofScene) {
    typename SceneSpec<D>::Spawn spawn;
    spawn.step = step, spawn.removeAt = removeAt;
    spawn.body = readBody<D>(block, m_numbers, m_defaults, m_settings);
    spawn.body.name = name, spawn.exact = block.flag("exact", false);
    if (m_numbers.rehearsing()) return -1;
    if (removeAt >= 0 && removeAt < step) {
      block.fail(*block.find("remove"), "'remove' is " + std::to_string(removeAt) + "; valid: from step " +
                                            std::to_string(step) + " on, when the body is added");
    }
    m_numbers.count(block.raw(), "bodies");
    return addSpawn(std::move(spawn), ofScene);
  }
  int addSpawn(typename SceneSpec<D>::Spawn spawn, bool ofScene) {
    const int place = static_cast<int>(m_scene.spawns.size());
    m_bodies.add(spawn.body.name, place);
    ofScene ? m_bodies.number(place) : m_bodies.numberOfScript(place);
    m_scene.spawns.push_back(std::move(spawn));
    return place;
  }

  // Events that name their new bodies are read in a first pass, before those that may use these names.
  void events(const std::vector<const toml::table*>& own, const std::vector<const toml::table*>& scripted,
              bool naming) {
    int number = 0;
    for (const toml::table* t : own) eventBlock(*t, number++, true, naming);
    for (const toml::table* t : scripted) eventBlock(*t, number++, false, naming);
  }
  // Once at `step`, or at every `every`-th step before `until`.
  void eventBlock(const toml::table& table, int number, bool ofScene, bool naming) {
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
    if (naming && block.find("name")) m_bodies.know(nameOf(block));
    EventBlock<D> event{block, m_numbers, m_scene, number};
    event.place = std::make_shared<const std::string>(placeOf(m_parsed.path, table));
    event.bodyOf = [&](const std::string& key) {
      const int body = bodyOf(block, key, false);
      use(body, event.step, number, table);
      return body;
    };
    event.jointOf = [&](const std::string& key) { return m_joints.find(block, m_numbers, key); };
    event.forceOf = [&](const std::string& key) { return m_forces.find(block, m_numbers, key); };
    event.addBody = [&] { return addBody(block, nameOf(block), event.step, -1, ofScene); };
    event.addJoint = [&] {
      auto joint = readJointOf(block);
      joint.step = event.step, joint.byEvent = true;
      use(joint.bodyA, event.step, number, table), use(joint.bodyB, event.step, number, table);
      return addJoint(block, std::move(joint));
    };
    event.addForce = [&] {
      auto force = readForceOf(block);
      force.step = event.step, force.byEvent = true;
      use(force.bodyA, event.step, number, table), use(force.bodyB, event.step, number, table);
      return addForce(block, std::move(force));
    };
    event.addPart = [&](typename SceneSpec<D>::Spawn part) { return addSpawn(std::move(part), ofScene); };
    event.nameBody = [&](const std::string& of, int body) {
      m_bodies.know(of);
      if (!m_numbers.rehearsing()) m_bodies.add(of, body);
    };
    event.clear = [&] { m_presence.clear(event.step, number); };
    const auto once = [&] {
      m_numbers.count(table, "events");
      kind->read(event);
    };
    for (event.step = from; event.step < until; event.step += every) {
      m_numbers.expressions.setLocal("step", static_cast<double>(event.step));
      loops(block, once);
    }
    endLoops(block, once);
  }
  void use(int body, long step, int block, const toml::table& place) {
    if (!m_numbers.rehearsing()) m_presence.use(body, step, block, place);
  }

  // Bodies are identified by their index among the spawns, which are sorted by step.
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
    m_bodies.renumber(place);
    for (auto& event : m_scene.events) event.body = place[static_cast<std::size_t>(event.body)];
  }

  // -1: the world.
  int bodyOf(TableReader& block, const std::string& key, bool worldAllowed) {
    if (worldAllowed && block.requireString(key) == "world") return -1;
    return m_bodies.find(block, m_numbers, key);
  }
  // Measures with a closed form, against which the run is compared.
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
  // A joint of a block is added with the later of its bodies.
  void jointBlock(const toml::table& table) {
    TableReader block(table, m_parsed.path, "[[joint]]");
    beginBlock();
    const auto once = [&] {
      auto joint = readJointOf(block);
      useEnds(joint, 0, table);
      addJoint(block, std::move(joint));
    };
    loops(block, once);
    endLoops(block, once);
  }
  // Both ends must exist when the later one is added, or at `step`.
  template <class Link>
  void useEnds(const Link& link, long step, const toml::table& table) {
    if (m_numbers.rehearsing()) return;
    std::pair when(step, false);
    for (const int end : {link.bodyA, link.bodyB}) {
      if (end < 0) continue;
      const auto& spawn = m_scene.spawns[static_cast<std::size_t>(end)];
      when = std::max(when, std::pair(spawn.step, spawn.addedBy >= 0));
    }
    const int block = when.second ? ScenePresence<D>::kAfter : ScenePresence<D>::kBefore;
    use(link.bodyA, when.first, block, table), use(link.bodyB, when.first, block, table);
  }
  int addJoint(TableReader& block, typename SceneSpec<D>::Joint joint) {
    const int place = static_cast<int>(m_scene.joints.size());
    const std::string name = nameOf(block);
    if (!m_numbers.rehearsing()) m_joints.add(name, place), m_joints.number(place);
    m_scene.joints.push_back(std::move(joint));
    return place;
  }
  typename SceneSpec<D>::Joint readJointOf(TableReader& block) {
    if (!m_parsed.model.joints) {
      block.fail("a joint, but joints are disabled in this scene; valid: 'needs' with \"joints\"");
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
      if (body < 0) return false;
      const auto& spawn = m_scene.spawns[static_cast<std::size_t>(body)];
      return spawn.body.type == BodyType::dynamic || spawn.retyped;
    };
    if (bodyA == bodyB) {
      block.fail("a joint between a body and itself; valid: two bodies, or \"world\" and a body");
    }
    if (!moves(bodyA) && !moves(bodyB)) block.fail("a joint of two bodies that cannot move; valid: one dynamic body");
  }
  void forceBlock(const toml::table& table) {
    TableReader block(table, m_parsed.path, "[[force]]");
    beginBlock();
    const auto once = [&] {
      auto force = readForceOf(block);
      placeForce<D>(block, m_numbers, m_scene, force);
      useEnds(force, force.step, table);
      addForce(block, std::move(force));
    };
    loops(block, once);
    endLoops(block, once);
  }
  typename SceneSpec<D>::Force readForceOf(TableReader& block) {
    m_numbers.count(block.raw(), "forces");
    typename SceneSpec<D>::Force force;
    if (block.find("a")) force.bodyA = bodyOf(block, "a", true);
    if (block.find("b")) force.bodyB = bodyOf(block, "b", false);
    force.def = readForce<D>(block, m_numbers);
    return force;
  }
  int addForce(TableReader& block, typename SceneSpec<D>::Force force) {
    const int place = static_cast<int>(m_scene.forces.size());
    const std::string name = nameOf(block);
    if (!m_numbers.rehearsing()) m_forces.add(name, place), m_forces.number(place);
    m_scene.forces.push_back(std::move(force));
    return place;
  }

  const SceneFile::Parsed& m_parsed;
  SceneNumbers m_numbers;
  std::uint64_t m_seed;
  double m_perturb;
  std::string m_chosenJoint;  // from the parameter `joint`; empty if there is none
  TableReader m_top, m_script;
  const toml::table* m_defaults = nullptr;
  Settings m_settings;
  SceneSpec<D> m_scene;
  SceneNames m_bodies{"body"}, m_joints{"joint"}, m_forces{"force"};
  ScenePresence<D> m_presence;
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

}}  // namespace lpc::LPC_PRECISION
