// SPDX-License-Identifier: Zlib
// A user's actions on a world between its steps, and the same actions as a script: the runs agree to the last bit.
#include "experiments/trial/scene/script_writer.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <cstdio>
#include <regex>

#include "experiments/trial/scene/scene_file.h"
#include "framework/scene/director.h"
#include "tests/check_property.h"
#include "tests/draw.h"
#include "tests/experiments/workspace.h"

namespace lpc { inline namespace LPC_PRECISION { namespace script_writer_test { namespace {

using namespace test;

// Bodies with a name, with a numbered name and without a name; a joint and a force of the scene.
const std::string kScene = R"(name = "t"
summary = "s"
dimensions = [2, 3]
needs = ["cache", "friction", "joints", "restitution", "rotation", "sleeping"]
dt = 0.015625
[[body]]
type = "fixed"
position = [0, -1, 0]
shapes = [{ kind = "box", half = [20, 1, 20] }]
[[body]]
name = "box"
repeat = { i = 3 }
position = ["2 * i - 3", "0.6 + i", "0.1 * i"]
shapes = [{ kind = "box", half = [0.5, 0.5, 0.5] }, { kind = "circle", radius = 0.3, offset = [0.6, 0, 0] }]
[[body]]
position = [4, 2, 0]
shapes = [{ kind = "circle", radius = 0.5 }]
[[joint]]
kind = "distance"
name = "rod"
a = "box[0]"
b = "box[1]"
anchor = [-3, 0.6]
anchor_b = [-1, 1.6]
[[force]]
kind = "drag"
)";
constexpr int kSteps = 24;

// Performs a user's actions on the world and writes them to a script. Actions that the world rejects are not written.
template <int D>
class Hand {
 public:
  explicit Hand(Draw& draw) : m_draw(draw) {
    const SceneSpec<D> scene = SceneFile::parse(kScene, "t.toml").build<D>({}, 1);
    m_world = std::make_unique<World<D>>(Pipeline::parse("contacts=query_clip sleep=split_average"), scene.settings);
    m_director = std::make_unique<Director<D>>(scene);
    m_director->advance(*m_world);
    m_bodies = {{"#0", m_director->body(0)},
                {"box", m_director->body(1)},
                {"box[1]", m_director->body(2)},
                {"#3", m_director->body(3)},
                {"#4", m_director->body(4)}};
    m_joints = {{"rod", m_director->joint(0)}};
    m_forces = {{"#0", m_director->force(0)}};
    for (m_step = 0; m_step < kSteps; ++m_step) {
      for (int n = m_draw.below(4); n > 0; --n) action();
      m_world->step(scene.dt);
      m_hashes.push_back(m_world->hash());
    }
  }
  std::string script() const { return m_writer.text("by hand", kSteps); }
  const std::vector<std::uint64_t>& hashes() const { return m_hashes; }
  const std::vector<std::string>& done() const { return m_done; }

 private:
  template <class H>
  struct Named {
    std::string name;
    H handle;
  };
  template <class H>
  Named<H> any(const std::vector<Named<H>>& list) {
    return list[static_cast<std::size_t>(m_draw.below(static_cast<int>(list.size())))];
  }
  std::string fresh(const char* what) { return what + std::to_string(m_count++); }
  Real size() { return m_draw.real(0.1, 0.6); }

  Shape<D> shape() {
    if (m_draw.below(5) > 0) {
      const ShapeKind curved =
          D == 2 ? ShapeKind::ellipsoid : m_draw.pick({ShapeKind::ellipsoid, ShapeKind::cylinder, ShapeKind::cone});
      return drawSketch<D>(m_draw, m_draw.below(4) == 1 ? curved : drawKind<D>(m_draw)).build(Real(0.2));
    }
    std::vector<ShapePart<D>> parts;
    for (int n = 2 + m_draw.below(2); n > 0; --n) {
      parts.push_back({drawSketch<D>(m_draw, m_draw.pick({ShapeKind::box, ShapeKind::polytope})).build(Real(0.1)),
                       drawPose<D>(m_draw, Real(0.5))});
    }
    return Shape<D>::compound(parts);
  }
  BodyDef<D> body() {
    BodyDef<D> def;
    def.type = m_draw.pick({BodyType::dynamic, BodyType::dynamic, BodyType::kinematic, BodyType::fixed});
    def.X_WB = drawPose<D>(m_draw, 3), def.X_WB.p[1] += 3;
    def.velocity = drawVector<D>(m_draw), def.angularVelocity = angular();
    def.pinned = m_draw.below(5) == 1, def.rotatable = m_draw.below(5) != 1, def.canSleep = m_draw.below(3) != 1;
    if (m_draw.below(5) == 1) def.gravityScale = m_draw.real(-1, 1);
    for (int n = 1 + m_draw.below(3); n > 0; --n) {
      ShapeDef<D> s;
      s.shape = shape(), s.X_BS = drawPose<D>(m_draw, Real(0.4));
      s.density = size(), s.friction = size(), s.restitution = size();
      if (m_draw.below(5) == 1) s.category = 2, s.mask = 0xfffffffd;
      def.shapes.push_back(s);
    }
    if (def.type == BodyType::dynamic && m_draw.below(4) == 1) {
      MassProperties<D> mass;
      for (const ShapeDef<D>& s : def.shapes) {
        mass = combined(mass, transformed(massProperties(s.shape, s.density), s.X_BS));
      }
      mass.mass *= Real(1.7), mass.inertia *= Real(1.3), mass.center[0] += Real(0.1);
      def.mass = mass;
    }
    return def;
  }
  Ang<D> angular() {
    Ang<D> w;
    for (int k = 0; k < kAngDim<D>; ++k) w[k] = m_draw.signedUnit();
    return w;
  }

  void action() {
    const int what = m_draw.below(20);
    try {
      m_done.push_back(std::to_string(m_step) + ": " + act(what));
    } catch (const UserError& e) {
      m_done.push_back(std::to_string(m_step) + ": not " + std::to_string(what) + ", " + e.what());
    }
  }

  std::string act(int what) {
    World<D>& w = *m_world;
    if (what == 0 || what == 1 || m_bodies.empty()) {
      const std::string name = fresh("new");
      const BodyDef<D> def = body();
      m_bodies.push_back({name, w.add(def)});
      m_writer.add(m_step, name, def);
      return "add " + name;
    }
    const auto [name, h] = any(m_bodies);
    switch (what) {
      case 2: {
        w.remove(h);
        m_writer.remove(m_step, name);
        forget();
        return "remove " + name;
      }
      case 3: {
        const Wrench<D> impulse{drawVector<D>(m_draw), angular()};
        requireDynamic(h);
        w.applyImpulse(h, impulse);
        m_writer.push(m_step, name, impulse);
        return "push " + name;
      }
      case 4: {
        const Wrench<D> force{10 * drawVector<D>(m_draw), angular()};
        requireDynamic(h);
        w.applyForce(h, force.force, w.centerOfMass(h));
        w.applyTorque(h, force.torque);
        m_writer.force(m_step, name, force);
        return "force " + name;
      }
      case 5: {
        const Pose<D> X_WB = drawPose<D>(m_draw, 4);
        w.setPose(h, X_WB);
        m_writer.set(m_step, name, X_WB);
        return "set pose " + name;
      }
      case 6: {
        const Motion<D> motion{drawVector<D>(m_draw), angular()};
        w.setMotion(h, motion);
        m_writer.set(m_step, name, motion);
        return "set motion " + name;
      }
      case 7: {
        auto other = any(m_bodies);
        if (m_draw.coin()) other = {"world", BodyHandle{}};
        JointDef<D> def;
        def.kind = m_draw.pick<const char*>({"pivot", "weld", "hinge{lower=-0.123456789,upper=0.5}", "distance"});
        def.X_WJ = drawPose<D>(m_draw, 3);
        if (m_draw.coin()) def.X_WJb = Pose<D>{3 * drawVector<D>(m_draw), def.X_WJ.q};
        def.collide = m_draw.coin();
        if (m_draw.coin()) def.breakForce = m_draw.real(50, 500);
        def.bodyA = other.handle, def.bodyB = h;
        const std::string joint = fresh("joint");
        m_joints.push_back({joint, w.add(def)});
        m_writer.joint(m_step, joint, def, other.name, name);
        return "join " + name + " to " + other.name;
      }
      case 8: {
        if (m_joints.empty()) throw UserError("no joint");
        const auto [joint, j] = any(m_joints);
        w.remove(j);
        m_writer.unjoin(m_step, joint);
        forget();
        return "unjoin " + joint;
      }
      case 9: {
        ForceDef<D> def;
        def.kind = m_draw.pick<const char*>({"spring{stiffness=12.3456789}", "drag{linear=0.1234567}"});
        const bool spring = def.kind.starts_with("spring");
        def.bodyB = h;
        if (spring) def.anchorA = 3 * drawVector<D>(m_draw), def.anchorB = drawVector<D>(m_draw);
        const std::string force = fresh("force");
        m_forces.push_back({force, w.add(def)});
        m_writer.addForce(m_step, force, def, "", name);
        return "add force to " + name;
      }
      case 10: {
        if (m_forces.empty()) throw UserError("no force");
        const auto [force, f] = any(m_forces);
        w.remove(f);
        m_writer.removeForce(m_step, force);
        forget();
        return "remove force " + force;
      }
      case 11: {
        const auto other = any(m_bodies);
        w.merge(h, other.handle);
        m_writer.merge(m_step, name, other.name);
        forget();
        return "merge " + name + " with " + other.name;
      }
      case 12: {
        const std::vector<BodyHandle> parts = w.splitByShape(h);
        std::vector<std::string> names;
        for (std::size_t i = 0; i < parts.size(); ++i) {
          names.push_back(fresh("part"));
          m_bodies.push_back({names.back(), parts[i]});
        }
        m_writer.splitByShape(m_step, name, names);
        return "take apart " + name;
      }
      case 13: {
        const bool all = m_draw.coin();
        all ? w.wakeAll() : w.wake(h);
        all ? m_writer.wakeAll(m_step) : m_writer.wake(m_step, name);
        return "wake";
      }
      case 14: {
        const Vec<D> gravity = 10 * drawVector<D>(m_draw);
        w.setGravity(gravity);
        m_writer.gravity(m_step, gravity);
        return "gravity";
      }
      case 15: {
        if (m_draw.below(4) > 0) throw UserError("rarely");
        w.clear();
        m_writer.clear(m_step);
        forget();
        return "clear";
      }
      case 16: {
        Pipeline pipeline = w.pipeline();
        pipeline.replace(m_draw.pick<const char*>({"broadphase=naive", "solver=tgs", "sleep=none", "cache=by_distance",
                                                   "solver=split_solver{velocity=catto{iterations=7}}"}));
        w.setPipeline(pipeline);
        m_writer.setPipeline(m_step, pipeline);
        return "exchange";
      }
      case 17: {
        const Vec<D> force = 10 * drawVector<D>(m_draw), at = drawVector<D>(m_draw);
        requireDynamic(h);
        const auto i = static_cast<std::size_t>(h.slot);
        const Pose<D>& X_WC = w.bodies().pose[i];
        w.applyForce(h, force, X_WC.p + X_WC.q * Vec<D>(at - w.bodies().center[i]));
        m_writer.pull(m_step, name, force, at);
        return "pull " + name;
      }
      case 18: {
        BodyDef<D> def = w.definition(h);
        def.type = m_draw.pick({BodyType::fixed, BodyType::dynamic, BodyType::kinematic});
        w.change(h, def);
        m_writer.type(m_step, name, def.type);
        return "type of " + name;
      }
      default: {
        BodyDef<D> def = w.definition(h);
        if (m_draw.coin()) {
          const Real friction = size(), density = size();
          for (ShapeDef<D>& s : def.shapes) s.friction = friction, s.density = density;
          w.change(h, def);
          m_writer.material(m_step, name, {.friction = friction, .density = density});
          return "material of " + name;
        }
        def.pinned = !def.pinned;
        w.change(h, def);
        m_writer.pin(m_step, name, def.pinned);
        return "pin " + name;
      }
    }
  }
  // A script's push and force require a dynamic body; a world ignores them for others.
  void requireDynamic(BodyHandle h) const {
    if (m_world->bodies().type[static_cast<std::size_t>(h.slot)] != BodyType::dynamic) throw UserError("not dynamic");
  }
  void forget() {
    std::erase_if(m_bodies, [&](const auto& b) { return !m_world->valid(b.handle); });
    const auto gone = [](const auto& records, const auto& handle) {
      const auto& record = records[static_cast<std::size_t>(handle.slot)];
      return !record.kind || record.generation != handle.generation;
    };
    std::erase_if(m_joints, [&](const auto& j) { return gone(m_world->joints(), j.handle); });
    std::erase_if(m_forces, [&](const auto& f) { return gone(m_world->forces(), f.handle); });
  }

  Draw& m_draw;
  std::unique_ptr<World<D>> m_world;
  std::unique_ptr<Director<D>> m_director;
  ScriptWriter<D> m_writer;
  std::vector<Named<BodyHandle>> m_bodies;
  std::vector<Named<JointHandle>> m_joints;
  std::vector<Named<ForceHandle>> m_forces;
  long m_step = 0;
  int m_count = 0;
  std::vector<std::uint64_t> m_hashes;
  std::vector<std::string> m_done;
};

struct Story {
  std::string script;
  std::vector<std::uint64_t> hashes;
  std::vector<std::string> done;
  friend std::ostream& operator<<(std::ostream& out, const Story& s) {
    out << "\n# what was done before which step, or was refused:\n";
    for (const std::string& action : s.done) out << "# " << action << '\n';
    return out << s.script;
  }
};
template <int D>
Gen<Story> stories() {
  return Gen<Story>([](Draw& draw) {
    const Hand<D> hand(draw);
    return Story{hand.script(), hand.hashes(), hand.done()};
  });
}

template <int D>
SceneSpec<D> readBack(const std::string& script) {
  return SceneFile::parse(kScene, "t.toml", script, "hand.toml").build<D>({}, 1);
}
template <int D>
std::vector<std::uint64_t> played(const SceneSpec<D>& scene) {
  World<D> world(Pipeline::parse("contacts=query_clip sleep=split_average"), scene.settings);
  Director<D> director(scene);
  std::vector<std::uint64_t> hashes;
  for (int i = 0; i < kSteps; ++i) {
    director.advance(world);
    world.step(scene.dt);
    hashes.push_back(world.hash());
  }
  return hashes;
}

// Numbers as written with six digits.
std::string rounded(const std::string& script) {
  static const std::regex kNumber("-?[0-9]+\\.[0-9]+(e[-+]?[0-9]+)?");
  std::string out;
  auto at = script.cbegin();
  for (std::sregex_iterator it(script.begin(), script.end(), kNumber), end; it != end; ++it) {
    char text[32];
    std::snprintf(text, sizeof text, "%.6g", std::stod(it->str()));
    out.append(at, (*it)[0].first);
    out += text;
    at = (*it)[0].second;
  }
  return out.append(at, script.cend());
}
template <int D>
void swapTwo(SceneSpec<D>& scene) {
  for (std::size_t i = 1; i < scene.events.size(); ++i) {
    if (scene.events[i].step == scene.events[i - 1].step) return std::swap(scene.events[i], scene.events[i - 1]);
  }
}

template <int D>
void oneLife(const std::function<std::string(const std::string&)>& written,
             const std::function<void(SceneSpec<D>&)>& read) {
  const Story story = *stories<D>();
  SceneSpec<D> scene = readBack<D>(written(story.script));
  read(scene);
  RC_ASSERT(played<D>(scene) == story.hashes);
}
template <int D>
void everyAction() {
  const std::string in = " in " + std::to_string(D) + "D";
  const auto asItIs = [](const std::string& s) { return s; };
  const auto asRead = [](SceneSpec<D>&) {};
  check("a script of deeds lives their life" + in, [=] { oneLife<D>(asItIs, asRead); });
  expectFalsified("six digits" + in, [=] { oneLife<D>(rounded, asRead); });
  // An action on a body that does not exist yet is an error and counts as caught.
  expectFalsified("two events of a step swapped" + in, [=] { oneLife<D>(asItIs, swapTwo<D>); });
}
TEST(ScriptWriter, ActionsReplayAsEvents2) { everyAction<2>(); }
TEST(ScriptWriter, ActionsReplayAsEvents3) { everyAction<3>(); }

// Every kind of action occurs.
template <int D>
void drawsEach() {
  std::string all;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    PlainDraw draw(seed);
    all += Hand<D>(draw).script();
  }
  for (const char* kind : {"add", "remove", "push", "force", "set", "joint", "unjoin", "add_force", "remove_force",
                           "merge", "take_apart", "wake", "gravity", "clear", "exchange", "material", "pin", "type"}) {
    EXPECT_NE(all.find("do = \"" + std::string(kind) + "\"\n"), all.npos) << kind;
  }
  for (const char* key : {"compound", "polytope", "capsule", "ellipsoid", "mass = ", "pinned", "body = \"#4\""}) {
    EXPECT_NE(all.find(key), all.npos) << key;
  }
}
TEST(ScriptWriter, EachIsDrawn) { drawsEach<2>(), drawsEach<3>(); }

// Static bodies as a script writes them.
template <int D>
void surfaces() {
  ScriptWriter<D> writer;
  std::vector<Shape<D>> shapes = {Shape<D>::plane()};
  if constexpr (D == 2) {
    const std::vector<Vec<2>> points = {{Real(0.1), 0}, {-1, Real(0.3)}, {-2, Real(-0.7)}};
    shapes.push_back(Shape<2>::chain(points, false)), shapes.push_back(Shape<2>::chain(points, true));
  } else {
    const std::vector<Vec<3>> points = {{Real(0.1), 0, 0}, {0, 0, 1}, {1, 0, Real(0.3)}, {1, Real(0.2), 1}};
    const std::vector<std::array<int, 3>> triangles = {{0, 1, 2}, {2, 1, 3}};
    shapes.push_back(Shape<3>::mesh(points, triangles));
    shapes.push_back(Shape<3>::triangle(points[0], points[1], points[2]));
  }
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    writer.add(1, "s" + std::to_string(i), BodyDef<D>::fixed({.shape = shapes[i]}));
  }
  const SceneSpec<D> scene = readBack<D>(writer.text("surfaces"));
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const Shape<D>& read = scene.spawns[5 + i].body.shapes.at(0).shape;
    std::vector<Vec<D>> had, has;
    const auto corners = [](std::vector<Vec<D>>& out) {
      return [&out](const ShapeView<D>& part, const Pose<D>& X) {
        out.push_back(X.p), out.push_back(part.half), out.push_back(X.q * Vec<D>(Vec<D>::Ones()));
        if (part.hull) out.insert(out.end(), part.hull->vertices.begin(), part.hull->vertices.end());
      };
    };
    forParts(shapes[i], Pose<D>{}, corners(had)), forParts(read, Pose<D>{}, corners(has));
    EXPECT_EQ(had, has) << i;
  }
}
TEST(ScriptWriter, SurfacesRoundTrip) { surfaces<2>(), surfaces<3>(); }

TEST(ScriptWriter, ReportsWhatAScriptCannotDo) {
  ScriptWriter<2> writer;
  const std::string before = writer.text("s");
  BodyDef<2> body;
  body.shapes.emplace_back();
  body.userData = 3;
  EXPECT_THROW(writer.add(0, "a", body), UserError);
  body.userData = 0, body.velocity[0] = std::numeric_limits<Real>::infinity();
  EXPECT_THROW(writer.add(0, "a", body), UserError);
  EXPECT_THROW(writer.remove(0, "two\nlines"), UserError);
  JointDef<2> joint;
  joint.X_WJb = Pose<2>{{1, 0}, Rot<2>::angle(1)};
  EXPECT_THROW(writer.joint(0, "j", joint, "world", "a"), UserError);
  EXPECT_EQ(writer.text("s"), before) << "half-written";
}

// As a user's program writes it: a file that `lpc run --script` plays.
TEST(ScriptWriter, OfTheCommandLine) {
  Workspace w;
  PlainDraw draw(7);
  const Hand<2> hand(draw);
  w.write("t.toml", kScene);
  w.write("hand.toml", hand.script());
  const test::Outcome run =
      w.lpc("run t.toml --dimension 2 --script hand.toml --pipeline \"contacts=query_clip sleep=split_average\"");
  char hash[20];
  std::snprintf(hash, sizeof hash, "%016llx", static_cast<unsigned long long>(hand.hashes().back()));
  EXPECT_NE(run.text.find(hash), run.text.npos) << run.text;
}

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::script_writer_test
