// SPDX-License-Identifier: Zlib
#include "framework/stage/stage_speed_limit.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

template <int D>
class LongestStep final : public SpeedLimit<D> {
 public:
  struct Params {
    Real length = 1000000;
    void visit(ParamVisitor& v) { v.real("length", length, 0, 1000000, "m", "farthest way of a centre in one step"); }
  };
  explicit LongestStep(const Params& params) : m_length(params.length) {}

  static AlgorithmInfo info() {
    return {.name = "longest_step",
            .summary = "no centre moves farther than a length in one step; the default lets everybody pass",
            .paper = "",
            .complexity = "n"};
  }

  void limit(Real dt, Bodies<D>& bodies) override {
    for (std::size_t i = 0; i < bodies.pose.size(); ++i) {
      if (!bodies.active(static_cast<int>(i))) continue;
      const Real way = bodies.motion[i].v.norm() * dt;
      if (way > m_length) bodies.motion[i].v *= m_length / way;
    }
  }

 private:
  Real m_length;  // m
};

}  // namespace

LPC_REGISTER(SpeedLimit, LongestStep, 2, 3);

}}  // namespace lpc::LPC_PRECISION
