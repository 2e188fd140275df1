// SPDX-License-Identifier: Zlib
// The pyramid in Chipmunk, written like the Hello Chipmunk example of its manual. Settings other than the defaults:
// gravity, friction   those of the scene
// collision slop      5 mm, as in the other engines; the default of 0.1 is meant for lengths in pixels
// Debian builds Chipmunk with its debug checks, so a release build is faster than this program.
#include <chipmunk/chipmunk.h>

#include "experiments/bench/bare_pyramid.h"

namespace bare {
namespace {

class ChipmunkPyramid final : public Pyramid {
 public:
  explicit ChipmunkPyramid(const Settings& s) : m_space(cpSpaceNew()) {
    cpSpaceSetIterations(m_space, s.iterations);
    cpSpaceSetGravity(m_space, cpv(0, -kGravity));
    cpSpaceSetCollisionSlop(m_space, s.slop);
    cpBody* const ground = cpSpaceGetStaticBody(m_space);
    add(cpPolyShapeNewRaw(ground, 4, kGround, 0), s.friction);
    for (int i = 0; i < kBase; ++i) {
      for (int j = 0; j < kBase - i; ++j) {
        const double moment = s.moment > 0 ? s.moment : cpMomentForBox(1, 1, 1);
        cpBody* const body = cpSpaceAddBody(m_space, cpBodyNew(1, moment));
        cpBodySetPosition(body, cpv(0.5 * (i + 1) + j - 0.5 * kBase, 0.5 + i));
        add(cpBoxShapeNew(body, 1, 1, 0), s.friction);
        m_boxes.push_back(body);
      }
    }
  }
  ~ChipmunkPyramid() override {
    for (cpShape* shape : m_shapes) cpSpaceRemoveShape(m_space, shape), cpShapeFree(shape);
    for (cpBody* body : m_boxes) cpSpaceRemoveBody(m_space, body), cpBodyFree(body);
    cpSpaceFree(m_space);
  }
  ChipmunkPyramid(const ChipmunkPyramid&) = delete;
  ChipmunkPyramid& operator=(const ChipmunkPyramid&) = delete;

  void step() override { cpSpaceStep(m_space, kStep); }
  std::vector<Placed> boxes() const override {
    std::vector<Placed> out;
    for (const cpBody* body : m_boxes) {
      const cpVect p = cpBodyGetPosition(body), turn = cpBodyGetRotation(body);
      out.push_back({p.x, p.y, 0, turn.x, turn.y, 0, 0});
    }
    return out;
  }

 private:
  static constexpr cpVect kGround[] = {{-100, -2}, {100, -2}, {100, 0}, {-100, 0}};

  void add(cpShape* shape, double friction) {
    cpShapeSetFriction(shape, friction);
    m_shapes.push_back(cpSpaceAddShape(m_space, shape));
  }

  cpSpace* m_space;
  std::vector<cpShape*> m_shapes;
  std::vector<cpBody*> m_boxes;
};

}  // namespace

std::unique_ptr<Pyramid> chipmunkPyramid(const Settings& settings) {
  return std::make_unique<ChipmunkPyramid>(settings);
}

}  // namespace bare
