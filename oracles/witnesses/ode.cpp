// SPDX-License-Identifier: Zlib
// ODE in double precision, as Debian builds it: spheres, capsules and boxes by closed forms and separating axes. It
// finds contacts, not distances.
#include <ode/collision.h>
#include <ode/odeinit.h>

#include <array>

#include "oracles/witnesses/adapter.h"
#include "oracles/witnesses/witness_process.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

static_assert(sizeof(dReal) == sizeof(double), "the witness is ODE's double precision build");

class Geom {
 public:
  Geom() = default;
  ~Geom() { clear(); }
  Geom(const Geom&) = delete;
  Geom& operator=(const Geom&) = delete;

  dGeomID id() const { return m_id; }
  /// The rounding of a box, which ODE does not support (m).
  double rounding() const { return m_rounding; }

  void make(const ShapeView<3>& shape, const Pose<3>& X) {
    clear();
    Eigen::Matrix3d turn = X.q.matrix().cast<double>();
    switch (shape.core()) {
      case CoreClass::point:
        m_id = dCreateSphere(nullptr, static_cast<double>(shape.radius));
        break;
      case CoreClass::segment:
        m_id = dCreateCapsule(nullptr, static_cast<double>(shape.radius), 2 * static_cast<double>(shape.half[0]));
        turn = turn * turnFromZ();
        break;
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
class Ode final : public IsolatedWitness<3> {
 public:
  using Params = PairFrameParams;
  explicit Ode(const Params& params) : IsolatedWitness<3>(params.frame) {}

  static AlgorithmInfo info() {
    return {.name = "ode",
            .summary = "deepest contact of ODE's dCollide; double precision",
            .paper = "",
            .complexity = "O(1)",
            .guarantee = Guarantee::approximate,
            .failures = {{.when = "boxes with the least depth between two edges, by less than 5 %",
                          .symptom = "the depth of a face is returned, because edges are weighted by 1.05",
                          .test = "Witnesses.OdePrefersFaces"},
                         {.when = "a capsule with its axis through a box",
                          .symptom = "the depth is not the least, off by a tenth of the size",
                          .test = "Witnesses.OdeDepthOfCapsulesInBoxesIsOff"}},
            .role = AlgorithmRole::witness};
  }
  bool claimsGap(ShapeKind, ShapeKind) const override { return false; }
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
    m_a.make(pair.a, placeOfA()), m_b.make(pair.b, placeOfB(pair));
  }
  PairAnswer<3> measure() override {
    std::array<dContactGeom, 8> found;
    const int count = dCollide(m_a.id(), m_b.id(), static_cast<int>(found.size()), found.data(), sizeof found[0]);
    if (count <= 0) return apartAnswer<3>(m_a.rounding() + m_b.rounding());
    const dContactGeom* deepest = found.data();
    for (int i = 1; i < count; ++i) {
      if (found[static_cast<std::size_t>(i)].depth > deepest->depth) deepest = &found[static_cast<std::size_t>(i)];
    }
    // ODE's normals point into the first shape.
    const Eigen::Vector3d normal(-deepest->normal[0], -deepest->normal[1], -deepest->normal[2]);
    const Eigen::Vector3d middle(deepest->pos[0], deepest->pos[1], deepest->pos[2]);
    return depthAnswer<3>(deepest->depth, normal, middle, m_a.rounding(), m_b.rounding());
  }

  Snippet snippet(const PairView<3>& pair) const override {
    Snippet out{.flags = "-lode", .head = "#include <ode/ode.h>\n#include <cmath>\n#include <cstdio>\n"};
    out.body = "  dInitODE2(0);\n" + placed("a", pair.a, placeOfA(), out.rounding) +
               placed("b", pair.b, placeOfB(pair), out.rounding) +
               "  dContactGeom found[8];\n"
               "  const int count = dCollide(a, b, 8, found, sizeof found[0]);\n"
               "  const dContactGeom* deepest = found;\n"
               "  for (int i = 1; i < count; ++i) {\n"
               "    if (found[i].depth > deepest->depth) deepest = &found[i];\n"
               "  }\n"
               "  double distance = count > 0 ? -deepest->depth : INFINITY;  // infinite: apart\n"
               "  for (int i = 0; i < 3 && count > 0; ++i) {\n"
               "    if (!std::isfinite(deepest->normal[i] + deepest->pos[i])) distance = NAN;  // no answer\n"
               "  }\n";
    return out;
  }
  static std::string placed(const std::string& name, const ShapeView<3>& shape, const Pose<3>& X, double& rounding) {
    const std::string radius = literal(static_cast<double>(shape.radius));
    Eigen::Matrix<double, 3, 4> pose;  // with the column by which ODE pads rows
    pose << X.q.matrix().cast<double>(), Eigen::Vector3d::Zero();
    std::string made;
    if (shape.core() == CoreClass::point) {
      made = "dCreateSphere(nullptr, " + radius + ")";
    } else if (shape.core() == CoreClass::segment) {
      made = "dCreateCapsule(nullptr, " + radius + ", " + literal(2 * static_cast<double>(shape.half[0])) + ")";
      pose.leftCols(3) = pose.leftCols(3).eval() * turnFromZ();
    } else {
      made = "dCreateBox(nullptr, " + literals(2 * shape.half.cast<double>()) + ")";
      rounding += static_cast<double>(shape.radius);
    }
    const std::string of = "_" + name;
    return "  dGeomID " + name + " = " + made + ";\n" + "  const dMatrix3 r" + of + " = {" + literals(pose) + "};\n" +
           "  dGeomSetPosition(" + name + ", " + literals(X.p.cast<double>()) + ");\n" + "  dGeomSetRotation(" + name +
           ", r" + of + ");\n";
  }

  Geom m_a, m_b;
};

}  // namespace

LPC_REGISTER(PairQuery, Ode, 3);

}}  // namespace lpc::LPC_PRECISION
