// SPDX-License-Identifier: Zlib
// ODE in double precision, as Debian builds it: spheres, capsules and boxes by closed forms and separating axes. It
// finds contacts and no distances.
#include <ode/collision.h>
#include <ode/odeinit.h>

#include <array>

#include "oracles/adapter.h"
#include "oracles/witness_process.h"

namespace lpc::inline LPC_PRECISION {
namespace {

static_assert(sizeof(dReal) == sizeof(double), "the witness is ODE's double precision build");

class Geom {
 public:
  Geom() = default;
  ~Geom() { clear(); }
  Geom(const Geom&) = delete;
  Geom& operator=(const Geom&) = delete;

  dGeomID id() const { return m_id; }
  /// Of a box the rounding that ODE does not know (m).
  double rounding() const { return m_rounding; }

  void make(const ShapeView<3>& shape, const Pose<3>& X) {
    clear();
    Eigen::Matrix3d turn = X.q.matrix().cast<double>();
    switch (shape.core()) {
      case CoreClass::point:
        m_id = dCreateSphere(nullptr, static_cast<double>(shape.radius));
        break;
      case CoreClass::segment: {
        m_id = dCreateCapsule(nullptr, static_cast<double>(shape.radius), 2 * static_cast<double>(shape.half[0]));
        Eigen::Matrix3d alongX;  // ODE's lie along z
        alongX << 0, 0, 1, 0, 1, 0, -1, 0, 0;
        turn = turn * alongX;
        break;
      }
      case CoreClass::box: {
        const Eigen::Vector3d side = 2 * shape.half.cast<double>();
        m_id = dCreateBox(nullptr, side[0], side[1], side[2]);
        m_rounding = static_cast<double>(shape.radius);
        break;
      }
      case CoreClass::hull:
      case CoreClass::curved:
      case CoreClass::plane:  // not in the table of kinds
        return;
    }
    dMatrix3 r;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) r[4 * i + j] = turn(i, j);
      r[4 * i + 3] = 0;
    }
    dGeomSetPosition(m_id, static_cast<double>(X.p[0]), static_cast<double>(X.p[1]), static_cast<double>(X.p[2]));
    dGeomSetRotation(m_id, r);
  }

 private:
  void clear() {
    if (m_id) dGeomDestroy(m_id);
    m_id = nullptr, m_rounding = 0;
  }

  dGeomID m_id = nullptr;
  double m_rounding = 0;
};

template <int D>
class Ode final : public IsolatedWitness {
 public:
  using Params = NoParams;
  explicit Ode(const Params&) {}

  static AlgorithmInfo info() {
    return {.name = "ode",
            .summary = "ODE's dCollide, the deepest of its contacts, in double precision",
            .paper = "",
            .complexity = "O(1)",
            .guarantee = Guarantee::approximate,
            .failures = {{.when = "boxes whose least depth is between two edges, by less than 5 %",
                          .symptom = "the depth of a face: the two are weighed 1 to 1.05",
                          .test = "Witnesses.OdePrefersFaces"},
                         {.when = "a capsule whose axis is in a box",
                          .symptom = "a depth that is not the least, off by a tenth of the size",
                          .test = "Witnesses.OdeDepthOfCapsulesInBoxesIsOff"}},
            .role = AlgorithmRole::witness};
  }
  std::span<const ErrorBar> errorBars() const override {
    using enum ShapeKind;
    static constexpr std::array kBars = {ErrorBar{sphere, sphere, 1e-15}, ErrorBar{sphere, capsule, 1e-15},
                                         ErrorBar{sphere, box, 1e-15},    ErrorBar{capsule, capsule, 1e-15},
                                         ErrorBar{capsule, box, 8e-2},    ErrorBar{box, box, 3e-3}};
    return kBars;
  }

 private:
  void place(const PairView<3>& pair) override {
    static const bool started = dInitODE2(0) != 0;
    if (!started) throw std::runtime_error("ODE does not start");
    m_a.make(pair.a, {}), m_b.make(pair.b, pair.X_AB);
  }
  PairAnswer<3> measure() override {
    std::array<dContactGeom, 8> found;
    const int count = dCollide(m_a.id(), m_b.id(), static_cast<int>(found.size()), found.data(), sizeof found[0]);
    if (count <= 0) return apartAnswer(m_a.rounding() + m_b.rounding());
    const dContactGeom* deepest = found.data();
    for (int i = 1; i < count; ++i) {
      if (found[static_cast<std::size_t>(i)].depth > deepest->depth) deepest = &found[static_cast<std::size_t>(i)];
    }
    // ODE's normals point into the first.
    const Eigen::Vector3d normal(-deepest->normal[0], -deepest->normal[1], -deepest->normal[2]);
    const Eigen::Vector3d middle(deepest->pos[0], deepest->pos[1], deepest->pos[2]);
    return depthAnswer(deepest->depth, normal, middle, m_a.rounding(), m_b.rounding());
  }

  Geom m_a, m_b;
};

}  // namespace

LPC_REGISTER(PairQuery, Ode, 3);

}  // namespace lpc::inline LPC_PRECISION
