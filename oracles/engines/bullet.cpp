// SPDX-License-Identifier: Zlib
// Bullet's discrete dynamics world, 3D. Debian builds the library twice; this file is compiled once for each, so that
// btScalar is Real.
#include "oracles/engines/engine_world.h"

#ifdef LPC_HAS_BULLET
#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <BulletCollision/CollisionDispatch/btDefaultCollisionConfiguration.h>
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>
#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <BulletCollision/CollisionShapes/btCapsuleShape.h>
#include <BulletCollision/CollisionShapes/btCompoundShape.h>
#include <BulletCollision/CollisionShapes/btConvexHullShape.h>
#include <BulletCollision/CollisionShapes/btCylinderShape.h>
#include <BulletCollision/CollisionShapes/btSphereShape.h>
#include <BulletCollision/CollisionShapes/btStaticPlaneShape.h>
#include <BulletDynamics/ConstraintSolver/btFixedConstraint.h>
#include <BulletDynamics/ConstraintSolver/btHingeConstraint.h>
#include <BulletDynamics/ConstraintSolver/btPoint2PointConstraint.h>
#include <BulletDynamics/ConstraintSolver/btSequentialImpulseConstraintSolver.h>
#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorld.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <Eigen/Eigenvalues>

#include "framework/shape/curved_core.h"
#endif

namespace lpc { inline namespace LPC_PRECISION {
namespace {

struct BulletParams {
  int iterations = 10;
  Real slop = kLinearSlop;
  bool warmStart = true;
  bool splitImpulse = true;
  void visit(ParamVisitor& v) {
    v.integer("iterations", iterations, 1, 10000, "passes over all constraint rows", ParamRole::effort);
    v.real("slop", slop, 0, 1, "m", "penetration left uncorrected; Bullet's default is 0");
    v.flag("warm_start", warmStart, "warm start from 0.85 of the last step's impulses");
    v.flag("split_impulse", splitImpulse, "depths over 4 cm are corrected by split impulses, which add no velocity");
  }
};

#ifdef LPC_HAS_BULLET

static_assert(sizeof(btScalar) == sizeof(Real), "BT_USE_DOUBLE_PRECISION and the libraries of the same precision");

btVector3 vector(const Vec<3>& v) { return {v[0], v[1], v[2]}; }
Vec<3> vectorOf(const btVector3& v) { return {v.x(), v.y(), v.z()}; }
btTransform transform(const Pose<3>& X) { return btTransform(btQuaternion(X.q.x, X.q.y, X.q.z, X.q.w), vector(X.p)); }
Pose<3> poseOf(const btTransform& X) {
  const btQuaternion q = X.getRotation();
  return {vectorOf(X.getOrigin()), Rot<3>{q.w(), q.x(), q.y(), q.z()}.normalized()};
}

// Bullet's rules are products, of friction up to 10. Other rules are global callbacks, which do not know the world: a
// world that needs one installs it for its step.
constexpr btScalar kMaxFriction = 10;
MixRules g_mixing;
btScalar friction(const btCollisionObject* a, const btCollisionObject* b) {
  return mix(g_mixing.friction, a->getFriction(), b->getFriction());
}
btScalar restitution(const btCollisionObject* a, const btCollisionObject* b) {
  return mix(g_mixing.restitution, a->getRestitution(), b->getRestitution());
}

class Callbacks {
 public:
  Callbacks(const MixRules& rules, bool ofFriction, bool ofRestitution) {
    g_mixing = rules;
    if (ofFriction) gCalculateCombinedFrictionCallback = friction;
    if (ofRestitution) gCalculateCombinedRestitutionCallback = restitution;
  }
  Callbacks(const Callbacks&) = delete;
  Callbacks& operator=(const Callbacks&) = delete;
  ~Callbacks() {
    gCalculateCombinedFrictionCallback = m_friction;
    gCalculateCombinedRestitutionCallback = m_restitution;
  }

 private:
  CalculateCombinedCallback m_friction = gCalculateCombinedFrictionCallback;
  CalculateCombinedCallback m_restitution = gCalculateCombinedRestitutionCallback;
};

class BulletWorld final : public EngineWorld<3> {
 public:
  BulletWorld(const BulletParams& params, const WorldSettings<3>& settings) : EngineWorld<3>(settings) {
    m_world.setGravity(vector(settings.gravity));
    btContactSolverInfo& info = m_world.getSolverInfo();
    info.m_numIterations = params.iterations;
    info.m_splitImpulse = params.splitImpulse;
    info.m_linearSlop = params.slop;
    info.m_restitutionVelocityThreshold = settings.restitutionThreshold;
    if (!params.warmStart) info.m_solverMode &= ~SOLVER_USE_WARMSTARTING;
  }
  ~BulletWorld() override {
    for (const auto& joint : m_joints) {
      if (joint.constraint) m_world.removeConstraint(joint.constraint.get());
    }
    for (const Body& b : m_bodies) {
      if (b.body) m_world.removeRigidBody(b.body.get());
    }
  }

 private:
  // Bullet needs the principal axes as body axes: frame P, fixed in C.
  struct Body {
    Pose<3> X_CP{};
    std::vector<std::unique_ptr<btCollisionShape>> shapes;  // the last one is the shape of the body
    std::unique_ptr<btRigidBody> body;
    Motion<3> motion{};  // of a kinematic body: Bullet computes its velocity from its poses
  };
  struct Joint {
    std::unique_ptr<btTypedConstraint> constraint;
    btHingeConstraint* motor = nullptr;  // the same constraint, when it has a motor
    Real motorTorque = 0;                // N m
    // For a joint that may break:
    std::unique_ptr<btJointFeedback> load;
    btVector3 anchorB{0, 0, 0}, armB{0, 0, 0};  // in B's axes, and in the world's axes at the start of the step
  };

  void checkBody(const BodyDef<3>& def) const override {
    for (const ShapeDef<3>& s : def.shapes) {
      const ShapeDef<3>& first = def.shapes[0];
      if (s.friction != first.friction || s.restitution != first.restitution || s.category != first.category ||
          s.mask != first.mask) {
        throw UserError("bullet: a body has one friction, restitution, category and mask, not one per shape");
      }
      if (s.shape.surface())
        throw UserError("bullet: meshes are not supported: LPC's are one-sided, Bullet's two-sided");
      forParts(s.shape, {}, [](const ShapeView<3>& part, const Pose<3>&) {
        const bool rounded = part.radius > 0 && (part.core() == CoreClass::box || part.core() == CoreClass::curved);
        const bool strange = part.core() == CoreClass::curved && part.kind != ShapeKind::cylinder;
        if (rounded || strange) {
          const char* article = rounded ? "rounded " : "";
          throw UserError(std::string("bullet: no shape of kind ") + article + std::string(shapeKindName(part.kind)));
        }
      });
    }
  }

  // Margins are 0 except a hull's own rounding: Bullet's default of 4 cm would round corners and lift hulls.
  static std::unique_ptr<btCollisionShape> shapeOf(const ShapeView<3>& s, const Pose<3>& X_PS) {
    switch (s.core()) {
      case CoreClass::point:
        return std::make_unique<btSphereShape>(s.radius);
      case CoreClass::segment:
        return std::make_unique<btCapsuleShapeX>(s.radius, 2 * s.half[0]);
      case CoreClass::plane:
        return std::make_unique<btStaticPlaneShape>(vector(X_PS.q * Vec<3>::UnitY()),
                                                    (X_PS.q * Vec<3>::UnitY()).dot(X_PS.p));
      case CoreClass::curved: {  // cylinders only: see checkBody
        auto cylinder = std::make_unique<btCylinderShapeX>(vector(s.half));
        cylinder->setMargin(0);
        return cylinder;
      }
      case CoreClass::box: {
        auto box = std::make_unique<btBoxShape>(vector(s.half));
        box->setMargin(0);
        return box;
      }
      case CoreClass::hull:
        break;
    }
    auto hull = std::make_unique<btConvexHullShape>();
    for (const Vec<3>& v : s.hull->vertices) hull->addPoint(vector(X_PS * v), false);
    hull->setMargin(s.radius);
    hull->recalcLocalAabb();
    return hull;
  }
  // Sizes of these are already in frame P: see shapeOf.
  static bool baked(const ShapeView<3>& s) { return s.core() == CoreClass::hull || s.core() == CoreClass::plane; }

  void addBody(std::size_t slot, const BodyDef<3>& def) override {
    if (slot >= m_bodies.size()) m_bodies.resize(slot + 1);
    const Bodies<3>& ours = scene().bodies();
    Body& b = m_bodies[slot];
    b = Body{};
    std::vector<std::pair<ShapeView<3>, Pose<3>>> parts;
    const ShapeRecord<3>* record = nullptr;
    forBodyParts(slot, [&](const ShapeView<3>& part, const Pose<3>& X_CS, const ShapeRecord<3>& s) {
      parts.emplace_back(part, X_CS), record = &s;
    });
    const bool dynamic = def.type == BodyType::dynamic;
    Inertia<3> inertia = Inertia<3>::Zero();
    if (dynamic && turns(slot)) inertia = ours.invInertiaBody[slot].inverse();
    if (parts.size() == 1 && !baked(parts[0].first)) {
      b.X_CP = parts[0].second;  // symmetric: its own axes are principal axes
    } else if (!inertia.isDiagonal()) {
      const Eigen::SelfAdjointEigenSolver<Mat<3>> solver(inertia);
      Mat<3> axes = solver.eigenvectors();
      if (axes.determinant() < 0) axes.col(0) *= -1;
      const Eigen::Quaternion<Real> q(axes);
      b.X_CP.q = Rot<3>{q.w(), q.x(), q.y(), q.z()}.normalized();
    }
    addShapes(b, parts);
    const Mat<3> r = b.X_CP.q.matrix();
    const Vec<3> moments = (r.transpose() * inertia * r).diagonal();
    btRigidBody::btRigidBodyConstructionInfo info(dynamic ? ours.mass[slot] : Real(0), nullptr, b.shapes.back().get(),
                                                  vector(moments));
    info.m_startWorldTransform = transform(ours.pose[slot] * b.X_CP);
    b.body = std::make_unique<btRigidBody>(info);
    b.body->setActivationState(DISABLE_DEACTIVATION);
    if (def.type == BodyType::kinematic) {
      b.body->setCollisionFlags(b.body->getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT);
    }
    if (record) setMaterial(*b.body, *record);
    if (def.pinned) b.body->setLinearFactor({0, 0, 0});
    putMotion(slot, motionOf(slot));
    m_world.addRigidBody(b.body.get(), static_cast<int>(record ? record->category : 0u),
                         static_cast<int>(record ? record->mask : 0u));
    putGravity(slot);  // addRigidBody has set the world's gravity
  }
  // A geometric mean is the product of the square roots, up to rounding.
  void setMaterial(btRigidBody& body, const ShapeRecord<3>& s) {
    const MixRules& rules = settings().mixing;
    const bool mean = rules.friction == MixRule::geometricMean;
    const Real f = mean ? std::sqrt(frictionOf(s)) : frictionOf(s), e = restitutionOf(s);
    body.setFriction(f), body.setRestitution(e);
    m_rules = {mean ? MixRule::product : rules.friction, rules.restitution};
    m_mixesFriction = m_mixesFriction || f * f > kMaxFriction || (m_rules.friction != MixRule::product && f != 0);
    m_mixesRestitution = m_mixesRestitution || (m_rules.restitution != MixRule::product && e != 0);
  }
  static void addShapes(Body& b, const std::vector<std::pair<ShapeView<3>, Pose<3>>>& parts) {
    const Pose<3> X_PC = b.X_CP.inverse();
    for (const auto& [view, X_CS] : parts) b.shapes.push_back(shapeOf(view, X_PC * X_CS));
    if (parts.size() == 1) return;
    auto whole = std::make_unique<btCompoundShape>();
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const Pose<3> X_PS = baked(parts[i].first) ? Pose<3>{} : X_PC * parts[i].second;
      whole->addChildShape(transform(X_PS), b.shapes[i].get());
    }
    b.shapes.push_back(std::move(whole));
  }
  void dropBody(std::size_t slot) override {
    m_world.removeRigidBody(m_bodies[slot].body.get());
    m_bodies[slot] = Body{};
  }

  void addJoint(std::size_t slot, const JointRecord<3>& joint) override {
    if (slot >= m_joints.size()) m_joints.resize(slot + 1);
    const JointSpec<3> spec(joint, "bullet");
    const Body* a = joint.bodyA < 0 ? nullptr : &m_bodies[static_cast<std::size_t>(joint.bodyA)];
    const Body& b = m_bodies[static_cast<std::size_t>(joint.bodyB)];
    btRigidBody& bodyA = a ? *a->body : btTypedConstraint::getFixedBody();
    const btTransform frameA = transform(a ? a->X_CP.inverse() * joint.X_CaJ : joint.X_CaJ);
    const btTransform frameB = transform(b.X_CP.inverse() * joint.X_CbJ);
    Joint j;
    if (spec.kind() == "pivot") {
      spec.takes({});
      j.constraint = std::make_unique<btPoint2PointConstraint>(bodyA, *b.body, frameA.getOrigin(), frameB.getOrigin());
    } else if (spec.kind() == "hinge") {
      auto hinge = std::make_unique<btHingeConstraint>(bodyA, *b.body, frameA, frameB, true);  // true: angle of B
                                                                                               // relative to A
      setUp(*hinge, spec, joint.state[0]);
      j.motorTorque = spec.real("motor_torque");
      if (j.motorTorque > 0) j.motor = hinge.get();
      j.constraint = std::move(hinge);
    } else if (spec.kind() == "weld") {
      spec.takes({});
      j.constraint = std::make_unique<btFixedConstraint>(bodyA, *b.body, frameA, frameB);
    } else {
      spec.refuse("no joint of kind " + spec.kind());
    }
    if (std::isfinite(joint.breakForce) || std::isfinite(joint.breakTorque)) {
      if (scene().bodies().pinned[static_cast<std::size_t>(joint.bodyB)]) {
        spec.refuse("Bullet reports no joint force on a pinned body, so the joint cannot break");
      }
      j.load = std::make_unique<btJointFeedback>(), j.anchorB = frameB.getOrigin();
      j.constraint->setJointFeedback(j.load.get());
    }
    const bool parts = a && !joint.collide;
    m_world.addConstraint(j.constraint.get(), parts);
    if (parts) forgetContacts(bodyA, *b.body);
    m_joints[slot] = std::move(j);
  }
  // Bullet's limits are angles within one turn. No bounce, no slack before a stop, full correction.
  static void setUp(btHingeConstraint& hinge, const JointSpec<3>& spec, Real angle) {
    spec.takes({"lower", "upper", "motor_speed", "motor_torque"});
    const Real lower = spec.real("lower"), upper = spec.real("upper");
    const bool stops = !spec.usual("lower") || !spec.usual("upper");
    if (stops && (upper - lower > Real(1.5) * SIMD_PI || std::abs(angle - (lower + upper) / 2) >= SIMD_PI)) {
      spec.refuse(
          "Bullet's hinge does not count whole turns; valid: limits at most 3/4 of a turn apart, and a start within "
          "half a turn of their middle");
    }
    if (stops) hinge.setLimit(lower, upper, Real(0.9), 1, 0);
    hinge.enableAngularMotor(spec.real("motor_torque") > 0, spec.real("motor_speed"), 0);
  }
  // Otherwise the joined bodies would keep their old contacts, never updated again.
  void forgetContacts(btRigidBody& a, btRigidBody& b) {
    btOverlappingPairCache& cache = *m_broadphase.getOverlappingPairCache();
    btBroadphasePair* pair = cache.findPair(a.getBroadphaseHandle(), b.getBroadphaseHandle());
    if (pair) cache.cleanOverlappingPair(*pair, &m_dispatcher);
  }
  void dropJoint(std::size_t slot) override {
    m_world.removeConstraint(m_joints[slot].constraint.get());
    m_joints[slot] = Joint{};
  }
  // Bullet reports the torque about B's centre.
  JointLoad load(std::size_t slot, Real) const override {
    const Joint& j = m_joints[slot];
    const btVector3 torque = j.load->m_appliedTorqueBodyB - j.armB.cross(j.load->m_appliedForceBodyB);
    return {j.load->m_appliedForceBodyB.length(), torque.length()};
  }

  void putGravity() override {
    m_world.setGravity(vector(settings().gravity));
    for (std::size_t slot = 0; slot < m_bodies.size(); ++slot) {
      if (m_bodies[slot].body) putGravity(slot);
    }
  }
  void putGravity(std::size_t slot) {
    m_bodies[slot].body->setGravity(vector(Vec<3>(scene().bodies().gravityScale[slot] * settings().gravity)));
  }
  void putPose(std::size_t slot, const Pose<3>& X_WC) override {
    const Body& b = m_bodies[slot];
    b.body->setCenterOfMassTransform(transform(X_WC * b.X_CP));
  }
  void putMotion(std::size_t slot, const Motion<3>& motion) override {
    m_bodies[slot].motion = motion;
    m_bodies[slot].body->setLinearVelocity(vector(motion.v));
    m_bodies[slot].body->setAngularVelocity(vector(motion.w));
  }

  void push(std::size_t slot, const Wrench<3>& wrench) override {
    m_bodies[slot].body->applyCentralForce(vector(wrench.force));
    m_bodies[slot].body->applyTorque(vector(wrench.torque));
  }
  void advance(Real dt) override {
    for (Joint& j : m_joints) {
      if (j.motor) j.motor->setMaxMotorImpulse(j.motorTorque * dt);
      if (j.load) j.armB = j.constraint->getRigidBodyB().getWorldTransform().getBasis() * j.anchorB;
    }
    // Bullet computes a kinematic body's velocity from its previous pose. As in our worlds, it collides at its pose at
    // the start of the step, and ends at the pose after the step.
    forKinematic(-dt, [](btRigidBody& b, const btTransform& past) { b.setInterpolationWorldTransform(past); });
    const Callbacks callbacks(m_rules, m_mixesFriction, m_mixesRestitution);
    m_world.stepSimulation(dt, 0);  // one step of dt, whatever its length
    forKinematic(dt, [](btRigidBody& b, const btTransform& next) { b.setWorldTransform(next); });
  }
  // Calls f(body, its pose after `time` s).
  template <class F>
  void forKinematic(Real time, const F& f) {
    for (const Body& b : m_bodies) {
      if (!b.body || !b.body->isKinematicObject()) continue;
      Pose<3> X = poseOf(b.body->getWorldTransform());  // Bullet's own integration limits the rotation to pi / 4
      X.p += time * b.motion.v, X.q = integrateRotation(X.q, Vec<3>(time * b.motion.w));
      f(*b.body, transform(X));
    }
  }
  void read(std::size_t slot, Pose<3>& X_WC, Motion<3>& motion) const override {
    const Body& b = m_bodies[slot];
    X_WC = poseOf(b.body->getWorldTransform()) * b.X_CP.inverse();
    motion = {vectorOf(b.body->getLinearVelocity()), vectorOf(b.body->getAngularVelocity())};
    if (b.body->isKinematicObject()) motion = b.motion;
  }
  void count(int& pairs, int& points) const override {
    pairs = m_dispatcher.getNumManifolds(), points = 0;
    for (int i = 0; i < pairs; ++i) {
      points += const_cast<btCollisionDispatcher&>(m_dispatcher).getManifoldByIndexInternal(i)->getNumContacts();
    }
  }

  btDefaultCollisionConfiguration m_configuration;
  btCollisionDispatcher m_dispatcher{&m_configuration};
  btDbvtBroadphase m_broadphase;
  btSequentialImpulseConstraintSolver m_solver;
  btDiscreteDynamicsWorld m_world{&m_dispatcher, &m_broadphase, &m_solver, &m_configuration};
  MixRules m_rules{};                                        // the rules for which the bodies' coefficients are set
  bool m_mixesFriction = false, m_mixesRestitution = false;  // a callback is needed
  std::vector<Body> m_bodies;                                // by slot
  std::vector<Joint> m_joints;                               // by slot
};

constexpr const char* kSummary = "Bullet 3: sequential impulses over persistent manifolds";
#else
constexpr const char* kSummary = "not in this build; install libbullet-dev and configure again";
#endif

template <int D>
class Bullet final : public Engine<D> {
 public:
  using Params = BulletParams;
  explicit Bullet(const Params& params) : m_params(params) {}

  static AlgorithmInfo info() {
    return {.name = "bullet",
            .summary = kSummary,
            .paper = "",
            .complexity = "rows x iterations",
            .guarantee = Guarantee::approximate,
            .role = AlgorithmRole::engine};
  }
  std::unique_ptr<Simulation<D>> start([[maybe_unused]] const WorldSettings<D>& settings) const override {
#ifdef LPC_HAS_BULLET
    return std::make_unique<BulletWorld>(m_params, settings);
#else
    throw UserError(std::string("bullet is ") + kSummary);
#endif
  }
  std::string differences() const override {
    return "contacts persist between steps, 4 a pair, until they are a fiftieth of a body's size apart; friction is "
           "one row along the sliding direction; a fifth of each depth over the slop is corrected per step, through "
           "velocities below 4 cm; warm start from 0.85; a body rotates at most a quarter turn a step; implicit "
           "gyroscopic torque; joints start cold in each step, a fifth of their error is corrected per step; a hinge's "
           "limit acts once it is passed, in one row with the motor, which slows down before it";
  }

 private:
  Params m_params;
};

}  // namespace

LPC_REGISTER(Engine, Bullet, 3);

}}  // namespace lpc::LPC_PRECISION
