// SPDX-License-Identifier: Zlib
#include "algorithms/solver/step/ngs_sweep.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using namespace solver;

// Nonlinear Gauss-Seidel as in solver2d: removes a part of each depth, one contact after the other, each at the poses
// that the previous ones left. (In Box2D 2 the normal turns with its body, and contacts precede joints.)
template <int D>
class Ngs final : public PositionResolver<D> {
 public:
  struct Params {
    int iterations = 4;
    NgsShare share;
    void visit(ParamVisitor& v) {
      v.integer("iterations", iterations, 0, 10000, "sweeps over all joints and contacts", ParamRole::effort);
      share.visit(v);
    }
  };
  explicit Ngs(const Params& params) : m_params(params) {}

  static AlgorithmInfo info() {
    return {.name = "ngs",
            .summary = "moves and turns bodies out of each contact in turn, measured where they are by then",
            .paper = "catto2024",
            .complexity = "iterations x (contacts + joints); once where nothing is wrong",
            .guarantee = Guarantee::approximate,
            .failures = {{"bodies that fly past each other", "what moves them changes their angular momentum",
                          "PositionError.KeepsAngularMomentum"}}};
  }

  void correct(const PositionInput<D>& in) override {
    for (int i = 0; i < m_params.iterations; ++i) {
      if (!m_sweep.sweep(in, m_params.share)) return;
    }
  }

 private:
  Params m_params;
  NgsSweep<D> m_sweep;
};

}  // namespace

LPC_REGISTER(PositionResolver, Ngs, 2, 3);

}}  // namespace lpc::LPC_PRECISION
