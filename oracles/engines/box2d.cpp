// SPDX-License-Identifier: Zlib
// Box2D 2.4, 2D, in float: its precision is compiled in.
#include "oracles/engines/engine_world.h"

#ifdef LPC_HAS_BOX2D
#include <box2d/box2d.h>
#endif

namespace lpc::inline LPC_PRECISION {
namespace {

struct Box2dParams {
  int iterations = 10;
  int positionIterations = 4;
  bool warmStart = true;
  void visit(ParamVisitor& v) {
    v.integer("iterations", iterations, 1, 10000, "sweeps over all velocities");
    v.integer("position_iterations", positionIterations, 0, 10000, "sweeps over all positions, at most");
    v.flag("warm_start", warmStart, "start from the last step's impulses");
  }
};

#ifdef LPC_HAS_BOX2D

b2Vec2 vector(const Vec<2>& v) { return {static_cast<float>(v[0]), static_cast<float>(v[1])}; }
Vec<2> vectorOf(const b2Vec2& v) { return {v.x, v.y}; }

class Box2dWorld final : public EngineWorld<2>, private b2ContactListener {
 public:
  Box2dWorld(const Box2dParams& params, const WorldSettings<2>& settings)
      : EngineWorld<2>(settings), m_params(params), m_world(vector(settings.gravity)) {
    m_world.SetAllowSleeping(false);
    m_world.SetContinuousPhysics(false);
    m_world.SetWarmStarting(params.warmStart);
    m_world.SetContactListener(this);
  }

 private:
  // Friction mixes as ours does; Box2D's own pair restitution is the larger of the two.
  void BeginContact(b2Contact* contact) override {
    const Real pair =
        mixRestitution(contact->GetFixtureA()->GetRestitution(), contact->GetFixtureB()->GetRestitution());
    contact->SetRestitution(static_cast<float>(pair));
  }

  void checkBody(const BodyDef<2>& def) const override {
    if (def.pinned) throw UserError("box2d: a body that is pinned and turns is not mapped");
    for (const ShapeDef<2>& s : def.shapes) {
      if (s.category > 0xffff) throw UserError("box2d: categories have 16 bits");
      forParts(s.shape, {}, [](const ShapeView<2>& part, const Pose<2>&) {
        const bool polygon = part.core() == CoreClass::box || part.core() == CoreClass::hull;
        if (!polygon && part.core() != CoreClass::point) {
          throw UserError("box2d: no shape is a " + std::string(shapeKindName(part.kind)));
        }
        if (polygon && part.radius > 0) throw UserError("box2d: no shape is a rounded polygon");
        if (part.hull && part.hull->vertices.size() > b2_maxPolygonVertices) {
          throw UserError("box2d: a polygon has at most " + std::to_string(b2_maxPolygonVertices) + " corners");
        }
      });
    }
  }

  void addBody(std::size_t slot, const BodyDef<2>& def) override {
    if (slot >= m_bodies.size()) m_bodies.resize(slot + 1);
    const Bodies<2>& ours = scene().bodies();
    b2BodyDef d;
    d.type = def.type == BodyType::dynamic     ? b2_dynamicBody
             : def.type == BodyType::kinematic ? b2_kinematicBody
                                               : b2_staticBody;
    d.position = vector(ours.pose[slot].p);
    d.angle = static_cast<float>(ours.pose[slot].q.radians());
    d.linearVelocity = vector(ours.motion[slot].v);
    d.angularVelocity = static_cast<float>(ours.motion[slot].w[0]);
    d.fixedRotation = !turns(slot);
    b2Body* body = m_bodies[slot] = m_world.CreateBody(&d);
    forBodyParts(slot, [&](const ShapeView<2>& part, const Pose<2>& X_CS, const ShapeRecord<2>& s) {
      addShape(*body, part, X_CS, s);
    });
    if (def.type != BodyType::dynamic) return;
    b2MassData mass{static_cast<float>(ours.mass[slot]), {0, 0}, 0};  // about the centre of mass, where the body stands
    if (turns(slot)) mass.I = static_cast<float>(1 / ours.invInertiaBody[slot](0, 0));
    body->SetMassData(&mass);
  }
  void addShape(b2Body& body, const ShapeView<2>& part, const Pose<2>& X_CS, const ShapeRecord<2>& s) const {
    b2CircleShape circle;
    b2PolygonShape polygon;
    b2FixtureDef d;
    d.shape = &polygon;
    if (part.core() == CoreClass::point) {
      circle.m_p = vector(X_CS.p), circle.m_radius = static_cast<float>(part.radius);
      d.shape = &circle;
    } else if (part.core() == CoreClass::box) {
      const b2Vec2 half = vector(part.half);
      polygon.SetAsBox(half.x, half.y, vector(X_CS.p), static_cast<float>(X_CS.q.radians()));
    } else {
      std::vector<b2Vec2> corners;
      for (const Vec<2>& v : part.hull->vertices) corners.push_back(vector(X_CS * v));
      polygon.Set(corners.data(), static_cast<int32>(corners.size()));
    }
    d.density = 0;  // the scene has the masses
    d.friction = static_cast<float>(frictionOf(s)), d.restitution = static_cast<float>(restitutionOf(s));
    d.restitutionThreshold = static_cast<float>(settings().restitutionThreshold);
    d.filter.categoryBits = static_cast<uint16>(s.category), d.filter.maskBits = static_cast<uint16>(s.mask & 0xffff);
    body.CreateFixture(&d);
  }
  void dropBody(std::size_t slot) override {
    m_world.DestroyBody(m_bodies[slot]);
    m_bodies[slot] = nullptr;
  }

  void addJoint(std::size_t slot, const JointRecord<2>& joint) override {
    if (slot >= m_joints.size()) m_joints.resize(slot + 1);
    b2RevoluteJointDef d;
    d.bodyA = m_bodies[static_cast<std::size_t>(joint.bodyA)],
    d.bodyB = m_bodies[static_cast<std::size_t>(joint.bodyB)];
    d.localAnchorA = vector(joint.X_CaJ.p), d.localAnchorB = vector(joint.X_CbJ.p);
    d.collideConnected = joint.collide;
    m_joints[slot] = m_world.CreateJoint(&d);
  }
  void dropJoint(std::size_t slot) override {
    m_world.DestroyJoint(m_joints[slot]);
    m_joints[slot] = nullptr;
  }

  void push(std::size_t slot, const Wrench<2>& wrench) override {
    m_bodies[slot]->ApplyForceToCenter(vector(wrench.force), true);
    m_bodies[slot]->ApplyTorque(static_cast<float>(wrench.torque[0]), true);
  }
  void advance(Real dt) override {
    m_world.Step(static_cast<float>(dt), m_params.iterations, m_params.positionIterations);
  }
  void read(std::size_t slot, Pose<2>& X_WC, Motion<2>& motion) const override {
    const b2Body& b = *m_bodies[slot];
    const b2Rot& q = b.GetTransform().q;
    X_WC = {vectorOf(b.GetWorldCenter()), Rot<2>{q.c, q.s}.normalized()};
    motion.v = vectorOf(b.GetLinearVelocity()), motion.w[0] = b.GetAngularVelocity();
  }
  void count(int& pairs, int& points) const override {
    pairs = m_world.GetContactCount(), points = 0;
    for (const b2Contact* c = m_world.GetContactList(); c; c = c->GetNext()) points += c->GetManifold()->pointCount;
  }

  Box2dParams m_params;
  b2World m_world;
  std::vector<b2Body*> m_bodies;   // by slot; the world's
  std::vector<b2Joint*> m_joints;  // by slot; the world's
};

#endif

template <int D>
class Box2d final : public Engine<D> {
 public:
  using Params = Box2dParams;
  explicit Box2d(const Params& params) : m_params(params) {}

  static Info info() {
    return {.name = "box2d",
            .summary = "Box2D 2.4: sequential impulses with blocks of two, then positions; f32 only",
            .paper = "",
            .complexity = "rows x iterations",
            .guarantee = Guarantee::approximate,
            .role = Role::engine};
  }
  std::unique_ptr<Simulation<D>> start([[maybe_unused]] const WorldSettings<D>& settings) const override {
#ifdef LPC_HAS_BOX2D
    if constexpr (sizeof(Real) == sizeof(float)) return std::make_unique<Box2dWorld>(m_params, settings);
    throw UserError("box2d computes in f32 alone");
#else
    throw UserError("box2d is absent from this build: install libbox2d-dev and configure again");
#endif
  }
  std::string differences() const override {
    return "polygons have a skin of 1 cm, so bodies rest 1 to 1.5 cm apart (b2_polygonRadius); no body moves more than "
           "2 m "
           "or a quarter turn a step; a fifth of each depth over 5 mm is corrected per sweep, 0.2 m at most";
  }

 private:
  Params m_params;
};

}  // namespace

LPC_REGISTER(Engine, Box2d, 2);

}  // namespace lpc::inline LPC_PRECISION
