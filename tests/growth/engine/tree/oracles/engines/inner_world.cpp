// SPDX-License-Identifier: Zlib
#include "framework/world/stage_engine.h"
#include "framework/world/world.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

// A world of LPC that plays the part of an external engine.
template <int D>
class InnerWorld final : public Engine<D> {
 public:
  using Params = NoParams;
  explicit InnerWorld(const Params&) {}

  static AlgorithmInfo info() {
    return {.name = "inner_world",
            .summary = "our default pipeline behind the interface of engines",
            .paper = "lpc2009",
            .complexity = "that of its stages",
            .guarantee = Guarantee::approximate,
            .failures = {},
            .role = AlgorithmRole::engine};
  }

  std::unique_ptr<Simulation<D>> start(const WorldSettings<D>& settings) const override {
    WorldSettings<D> inner = settings;
    inner.gravity *= Real(1);
    return std::make_unique<World<D>>(Pipeline{}, inner);
  }
  std::string differences() const override { return "nothing"; }
};

}  // namespace

LPC_REGISTER(Engine, InnerWorld, 2);

}}  // namespace lpc::LPC_PRECISION
