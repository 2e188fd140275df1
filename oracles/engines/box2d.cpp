// SPDX-License-Identifier: Zlib
// Box2D 2.4, 2D, in float: its precision is compiled in.
#include "oracles/engines/engine_world.h"

#ifdef LPC_HAS_BOX2D
#include <box2d/box2d.h>
#endif

namespace lpc { inline namespace LPC_PRECISION {
namespace {

struct Box2dParams {
  int iterations = 10;
  int positionIterations = 4;
  bool warmStart = true;
  void visit(ParamVisitor& v) {
    v.integer("iterations", iterations, 1, 10000, "velocity iterations", ParamRole::effort);
    v.integer("position_iterations", positionIterations, 0, 10000, "largest number of position iterations",
              ParamRole::effort);
    v.flag("warm_start", warmStart, "warm start from the impulses of the last step");
  }
};

#ifdef LPC_HAS_BOX2D

b2Vec2 vector(const Vec<2>& v) { return {static_cast<float>(v[0]), static_cast<float>(v[1])}; }
Vec<2> vectorOf(const b2Vec2& v) { return {v.x, v.y}; }

class Box2dWorld final : public EngineWorld<2>, private b2ContactListener {
 public:
  Box2dWorld(const Box2dParams& params, const WorldSettings<2>& settings)
      : EngineWorld<2>(settings), m_params(params), m_world(vector(settings.gravity)) {
    const b2BodyDef fixed;
    m_ground = m_world.CreateBody(&fixed);
    m_world.SetAllowSleeping(false);
    m_world.SetContinuousPhysics(false);
    m_world.SetWarmStarting(params.warmStart);
  }

 private:
  // Box2D's own rules are the geometric mean of friction and the larger restitution; other rules of a scene are set in
  // this callback.
  void BeginContact(b2Contact* contact) override {
    const b2Fixture &a = *contact->GetFixtureA(), &b = *contact->GetFixtureB();
    const MixRules& rules = settings().mixing;
    contact->SetFriction(static_cast<float>(mix(rules.friction, a.GetFriction(), b.GetFriction())));
    contact->SetRestitution(static_cast<float>(mix(rules.restitution, a.GetRestitution(), b.GetRestitution())));
  }
  bool mixes(const b2Fixture& fixture) const {
    const MixRules& rules = settings().mixing;
    return (rules.friction != MixRule::geometricMean && fixture.GetFriction() != 0) ||
           (rules.restitution != MixRule::maximum && fixture.GetRestitution() != 0);
  }

  void checkBody(const BodyDef<2>& def) const override {
    if (def.pinned) throw UserError("box2d: a pinned body that can rotate is not supported");
    for (const ShapeDef<2>& s : def.shapes) {
      if (s.category > 0xffff) throw UserError("box2d: a category has at most 16 bits");
      if (s.shape.surface()) throw UserError("box2d: chains are not supported");
      forParts(s.shape, {}, [](const ShapeView<2>& part, const Pose<2>&) {
        const bool polygon = part.core() == CoreClass::box || part.core() == CoreClass::hull;
        if (!polygon && part.core() != CoreClass::point) {
          throw UserError("box2d: no shape of kind " + std::string(shapeKindName(part.kind)));
        }
        if (polygon && part.radius > 0) throw UserError("box2d: rounded polygons are not supported");
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
    d.linearVelocity = vector(motionOf(slot).v);
    d.angularVelocity = static_cast<float>(motionOf(slot).w[0]);
    d.fixedRotation = !turns(slot);
    d.gravityScale = static_cast<float>(def.gravityScale);
    b2Body* body = m_bodies[slot] = m_world.CreateBody(&d);
    forBodyParts(slot, [&](const ShapeView<2>& part, const Pose<2>& X_CS, const ShapeRecord<2>& s) {
      addShape(*body, part, X_CS, s);
    });
    if (def.type != BodyType::dynamic) return;
    b2MassData mass{static_cast<float>(ours.mass[slot]), {0, 0}, 0};  // about the centre of mass, which is the body's
                                                                      // origin
    if (turns(slot)) mass.I = static_cast<float>(1 / ours.invInertiaBody[slot](0, 0));
    body->SetMassData(&mass);
  }
  void addShape(b2Body& body, const ShapeView<2>& part, const Pose<2>& X_CS, const ShapeRecord<2>& s) {
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
    d.density = 0;  // masses come from the scene
    d.friction = static_cast<float>(frictionOf(s)), d.restitution = static_cast<float>(restitutionOf(s));
    d.restitutionThreshold = static_cast<float>(settings().restitutionThreshold);
    d.filter.categoryBits = static_cast<uint16>(s.category), d.filter.maskBits = static_cast<uint16>(s.mask & 0xffff);
    if (mixes(*body.CreateFixture(&d))) m_world.SetContactListener(this);
  }
  void dropBody(std::size_t slot) override {
    m_world.DestroyBody(m_bodies[slot]);
    m_bodies[slot] = nullptr;
  }

  void addJoint(std::size_t slot, const JointRecord<2>& joint) override {
    if (slot >= m_joints.size()) m_joints.resize(slot + 1);
    const auto create = [&](auto def) {
      def.bodyA = joint.bodyA < 0 ? m_ground : m_bodies[static_cast<std::size_t>(joint.bodyA)];
      def.bodyB = m_bodies[static_cast<std::size_t>(joint.bodyB)];
      def.localAnchorA = vector(joint.X_CaJ.p), def.localAnchorB = vector(joint.X_CbJ.p);
      def.collideConnected = joint.collide;
      // Box2D counts angles of bodies, with whole turns, from the state where this angle is 0.
      if constexpr (requires { def.referenceAngle; }) {
        const float angle = static_cast<float>((framesOf(joint).qA.inverse() * framesOf(joint).qB).radians());
        def.referenceAngle = def.bodyB->GetAngle() - def.bodyA->GetAngle() - angle;
      }
      m_joints[slot] = m_world.CreateJoint(&def);
    };
    const JointSpec<2> spec(joint, "box2d");
    if (spec.kind() == "pivot") {
      spec.takes({});
      create(b2RevoluteJointDef());
    } else if (spec.kind() == "hinge") {
      create(hinge(spec));
    } else if (spec.kind() == "distance") {
      create(distance(spec, framesOf(joint).gap.norm()));
    } else if (spec.kind() == "weld") {
      spec.takes({});
      create(b2WeldJointDef());
    } else {
      spec.refuse("no joint of kind " + spec.kind());
    }
  }
  JointFrames<2> framesOf(const JointRecord<2>& joint) const {
    return {joint, poseOf(scene().bodies(), joint.bodyA), poseOf(scene().bodies(), joint.bodyB)};
  }
  static b2RevoluteJointDef hinge(const JointSpec<2>& spec) {
    spec.takes({"lower", "upper", "motor_speed", "motor_torque"});
    b2RevoluteJointDef d;
    d.enableLimit = !spec.usual("lower") || !spec.usual("upper");
    d.lowerAngle = static_cast<float>(spec.real("lower")), d.upperAngle = static_cast<float>(spec.real("upper"));
    d.motorSpeed = static_cast<float>(spec.real("motor_speed"));
    d.maxMotorTorque = static_cast<float>(spec.real("motor_torque"));
    d.enableMotor = d.maxMotorTorque > 0;
    return d;
  }
  // `now` is the length for a joint without a given one.
  static b2DistanceJointDef distance(const JointSpec<2>& spec, Real now) {
    spec.takes({"mode", "length", "stiffness", "damping"});
    b2DistanceJointDef d;
    const Real length = spec.real("length");
    d.length = static_cast<float>(length < 0 ? now : length);
    if (d.length < b2_linearSlop) spec.refuse("the length of a 'distance' is below 5 mm; valid: 5 mm or more");
    if (spec.text("mode") == "spring") {
      d.stiffness = static_cast<float>(spec.real("stiffness")), d.damping = static_cast<float>(spec.real("damping"));
      if (d.damping > 0 && !(d.stiffness > 0))
        spec.refuse("a spring has damping but no stiffness; valid: stiffness > 0");
    } else {
      d.maxLength = d.length;
      if (spec.text("mode") == "rod") d.minLength = d.length;
    }
    return d;
  }
  void dropJoint(std::size_t slot) override {
    m_world.DestroyJoint(m_joints[slot]);
    m_joints[slot] = nullptr;
  }
  JointLoad load(std::size_t slot, Real dt) const override {
    const float perSecond = static_cast<float>(1 / dt);
    return {vectorOf(m_joints[slot]->GetReactionForce(perSecond)).norm(),
            std::abs(m_joints[slot]->GetReactionTorque(perSecond))};
  }

  void putGravity() override { m_world.SetGravity(vector(settings().gravity)); }
  void putPose(std::size_t slot, const Pose<2>& X_WC) override {
    b2Body& b = *m_bodies[slot];
    // The nearest of the equivalent angles: joints count the whole turns of their bodies.
    const float now = b.GetAngle(), angle = static_cast<float>(X_WC.q.radians());
    b.SetTransform(vector(X_WC.p), now + std::remainder(angle - now, 2 * b2_pi));
  }
  void putMotion(std::size_t slot, const Motion<2>& motion) override {
    m_bodies[slot]->SetLinearVelocity(vector(motion.v));
    m_bodies[slot]->SetAngularVelocity(static_cast<float>(motion.w[0]));
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
  b2Body* m_ground = nullptr;      // the body for joints to the world
  std::vector<b2Body*> m_bodies;   // by slot; owned by the world
  std::vector<b2Joint*> m_joints;  // by slot; owned by the world
};

constexpr const char* kSummary =
    "Box2D 2.4: sequential impulses with blocks of two contacts, then position correction; f32 only";
#else
constexpr const char* kSummary = "not in this build; install libbox2d-dev and configure again";
#endif

template <int D>
class Box2d final : public Engine<D> {
 public:
  using Params = Box2dParams;
  explicit Box2d(const Params& params) : m_params(params) {}

  static AlgorithmInfo info() {
    return {.name = "box2d",
            .summary = kSummary,
            .paper = "",
            .complexity = "rows x iterations",
            .guarantee = Guarantee::approximate,
            .role = AlgorithmRole::engine};
  }
  std::unique_ptr<Simulation<D>> start([[maybe_unused]] const WorldSettings<D>& settings) const override {
#ifdef LPC_HAS_BOX2D
    if constexpr (sizeof(Real) == sizeof(float)) return std::make_unique<Box2dWorld>(m_params, settings);
    throw UserError("box2d runs in f32 only; valid: precision f32");
#else
    throw UserError(std::string("box2d is ") + kSummary);
#endif
  }
  std::string differences() const override {
    return "polygons have a skin of 1 cm, so bodies rest 1 to 1.5 cm apart (b2_polygonRadius); a body moves at most 2 "
           "m and a quarter turn a step; a fifth of each depth over 5 mm is corrected per iteration, at most 0.2 m; "
           "the points of a rope or spring stay 5 mm apart";
  }

 private:
  Params m_params;
};

}  // namespace

LPC_REGISTER(Engine, Box2d, 2);

}}  // namespace lpc::LPC_PRECISION
