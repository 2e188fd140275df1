// SPDX-License-Identifier: Zlib
// The pyramid in Box2D, written as its Hello World. Settings that differ from Box2D's defaults, and why:
// sleeping            off: every step shall do its full work
// continuous          off: the scene needs none
// iterations          10 and 4, as in the adapter; the manual suggests 8 and 3
// friction            that of the scene; Box2D's default is 0.2
// The slop is Box2D's own, 5 mm, which is compiled in.
#include <box2d/box2d.h>

#include "experiments/bench/bare_pyramid.h"

namespace bare {
namespace {

float scalar(double x) { return static_cast<float>(x); }

class Box2dPyramid final : public Pyramid {
 public:
  explicit Box2dPyramid(const Settings& s) : m_settings(s) {
    m_world.SetAllowSleeping(false);
    m_world.SetContinuousPhysics(false);
    add(b2_staticBody, 100, 1, 0, -1);
    for (int i = 0; i < kBase; ++i) {
      for (int j = 0; j < kBase - i; ++j) {
        m_boxes.push_back(add(b2_dynamicBody, 0.5, 0.5, 0.5 * (i + 1) + j - 0.5 * kBase, 0.5 + i));
      }
    }
  }
  void step() override { m_world.Step(scalar(kStep), m_settings.iterations, 4); }
  std::vector<Placed> boxes() const override {
    std::vector<Placed> out;
    for (const b2Body* body : m_boxes) {
      const b2Transform& X = body->GetTransform();
      out.push_back({X.p.x, X.p.y, 0, X.q.c, X.q.s, 0, 0});
    }
    return out;
  }

 private:
  b2Body* add(b2BodyType type, double halfWidth, double halfHeight, double x, double y) {
    b2BodyDef def;
    def.type = type;
    def.position.Set(scalar(x), scalar(y));
    b2PolygonShape box;
    box.SetAsBox(scalar(halfWidth), scalar(halfHeight));
    b2FixtureDef fixture;
    fixture.shape = &box;
    fixture.density = 1;
    fixture.friction = scalar(m_settings.friction);
    b2Body* body = m_world.CreateBody(&def);
    body->CreateFixture(&fixture);
    if (type == b2_dynamicBody && m_settings.moment > 0) {
      const b2MassData mass{1, {0, 0}, scalar(m_settings.moment)};
      body->SetMassData(&mass);
    }
    return body;
  }

  Settings m_settings;
  b2World m_world{{0, scalar(-kGravity)}};
  std::vector<b2Body*> m_boxes;  // owned by the world
};

}  // namespace

std::unique_ptr<Pyramid> box2dPyramid(const Settings& settings) { return std::make_unique<Box2dPyramid>(settings); }

}  // namespace bare
