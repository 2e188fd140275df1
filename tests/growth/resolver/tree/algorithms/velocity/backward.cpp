// SPDX-License-Identifier: Zlib
#include "algorithms/solver/contact_rows.h"
#include "algorithms/solver/joint_rows.h"

namespace lpc::inline LPC_PRECISION {
namespace {

using namespace solver;

// Accumulated impulses, from the last contact to the first, started from nothing in each step; joints of any kind
// before them.
template <int D>
class Backward final : public VelocityResolver<D> {
 public:
  struct Params {
    int iterations = 10;
    void visit(ParamVisitor& v) {
      v.integer("iterations", iterations, 0, 100000, "sweeps over all joints and contacts");
    }
  };
  explicit Backward(const Params& params) : m_params(params) {}

  static AlgorithmInfo info() {
    return {.name = "backward",
            .summary = "accumulated impulses, the last contact first, never warm",
            .paper = "",
            .complexity = "iterations x (contacts + joints)",
            .guarantee = Guarantee::approximate,
            .failures = {
                {"a heavy body on a light one", "ten sweeps are far from the weight", "Impulse.CarriesHeavyOnLight"}}};
  }

  void solve(const VelocityInput<D>& in) override {
    m_contacts.prepare(in);
    m_joints.clear();
    if (in.features.joints) m_joints.prepare(in.bodies, in.joints);
    for (int i = 0; i < m_params.iterations; ++i) {
      in.work[WorkCount::rowUpdates] += m_joints.sweep(in.bodies.motion, in.dt, {.rate = in.position.jointBias(in.dt)});
      for (std::size_t k = m_contacts.manifolds.size(); k-- > 0;) push(m_contacts.manifolds[k], in);
    }
    m_contacts.store(in.manifolds);
    m_joints.store(in.joints);
  }

 private:
  void push(const ManifoldRows<D>& m, const VelocityInput<D>& in) {
    const bool rotation = in.features.rotation;
    Motion<D>& a = in.bodies.motion[static_cast<std::size_t>(m.a)];
    Motion<D>& b = in.bodies.motion[static_cast<std::size_t>(m.b)];
    for (int i = m.count; i-- > 0;) {
      PointRows<D>& row = m_contacts.points[static_cast<std::size_t>(m.first + i)];
      const Real old = row.impulse[0], v = rowVelocity<D>(row.normal, m.n, a, b, rotation);
      row.impulse[0] = std::max(old + row.normal.mass * (row.target - v), Real(0));
      applyRow<D>(row.normal, m.n, m.invMassA, m.invMassB, row.impulse[0] - old, a, b, rotation);
      if (m.friction > 0) rubAt(m, row, a, b, rotation);
      in.work[WorkCount::rowUpdates] += m.friction > 0 ? D : 1;
    }
  }

  Params m_params;
  ContactRows<D> m_contacts;
  JointSystem<D> m_joints;
};

}  // namespace

LPC_REGISTER(VelocityResolver, Backward, 2, 3);

}  // namespace lpc::inline LPC_PRECISION
