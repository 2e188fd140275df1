// SPDX-License-Identifier: Zlib
// The pyramid in Bullet, written as its Hello World. Settings that differ from Bullet's defaults, and why:
// sleeping           off: every step shall do its full work
// linear slop        5 mm in place of 0, as in the adapter and in Box2D
// friction           Bullet multiplies the bodies' coefficients, so each has the square root of the pair's
// sub-steps          none: stepSimulation(dt, 0) is one step of dt
// Gravity, 10 iterations, split impulse, warm starting and margins are Bullet's own. Pairs of boxes use no margin.
#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <BulletCollision/CollisionDispatch/btDefaultCollisionConfiguration.h>
#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <BulletDynamics/ConstraintSolver/btSequentialImpulseConstraintSolver.h>
#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorld.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>
#include <LinearMath/btDefaultMotionState.h>

#include <cmath>

#include "experiments/bench/bare_pyramid.h"

namespace bare {
namespace {

btScalar scalar(double x) { return static_cast<btScalar>(x); }

class BulletPyramid final : public Pyramid {
 public:
  explicit BulletPyramid(const Settings& s) : m_friction(std::sqrt(scalar(s.friction))), m_moment(scalar(s.moment)) {
    m_world.setGravity({0, scalar(-kGravity), 0});
    m_world.getSolverInfo().m_numIterations = s.iterations;
    m_world.getSolverInfo().m_linearSlop = scalar(s.slop);
    add(0, m_ground, 0, -1);
    for (int i = 0; i < kBase; ++i) {
      for (int j = 0; j < kBase - i; ++j) add(1, m_box, 0.5 * (i + 1) + j - 0.5 * kBase, 0.5 + i);
    }
  }
  ~BulletPyramid() override {
    for (const auto& body : m_bodies) m_world.removeRigidBody(body.get());
  }
  void step() override { m_world.stepSimulation(scalar(kStep), 0); }
  std::vector<Placed> boxes() const override {
    std::vector<Placed> out;
    for (std::size_t i = 1; i < m_bodies.size(); ++i) {
      const btVector3& p = m_bodies[i]->getWorldTransform().getOrigin();
      const btQuaternion q = m_bodies[i]->getWorldTransform().getRotation();
      out.push_back({p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z()});
    }
    return out;
  }

 private:
  void add(btScalar mass, btCollisionShape& shape, double x, double y) {
    btTransform start = btTransform::getIdentity();
    start.setOrigin({scalar(x), scalar(y), 0});
    btVector3 inertia(0, 0, 0);
    if (mass > 0) shape.calculateLocalInertia(mass, inertia);
    if (mass > 0 && m_moment > 0) inertia = {m_moment, m_moment, m_moment};
    m_states.push_back(std::make_unique<btDefaultMotionState>(start));
    const btRigidBody::btRigidBodyConstructionInfo info(mass, m_states.back().get(), &shape, inertia);
    m_bodies.push_back(std::make_unique<btRigidBody>(info));
    m_bodies.back()->setFriction(m_friction);
    m_bodies.back()->setActivationState(DISABLE_DEACTIVATION);
    m_world.addRigidBody(m_bodies.back().get());
  }

  btScalar m_friction, m_moment;
  btBoxShape m_ground{{100, 1, 100}}, m_box{{scalar(0.5), scalar(0.5), scalar(0.5)}};
  std::vector<std::unique_ptr<btDefaultMotionState>> m_states;
  std::vector<std::unique_ptr<btRigidBody>> m_bodies;
  btDefaultCollisionConfiguration m_configuration;
  btCollisionDispatcher m_dispatcher{&m_configuration};
  btDbvtBroadphase m_broadphase;
  btSequentialImpulseConstraintSolver m_solver;
  btDiscreteDynamicsWorld m_world{&m_dispatcher, &m_broadphase, &m_solver, &m_configuration};
};

}  // namespace

std::unique_ptr<Pyramid> bulletPyramid(const Settings& settings) { return std::make_unique<BulletPyramid>(settings); }

}  // namespace bare
