// SPDX-License-Identifier: Zlib
// The text of a pipeline is rejected, or writing and reading it again gives the same pipeline and a world can be made
// from it.
#include "framework/world/world.h"
#include "tests/fuzz/target.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

template <class Body>
void orRefused(const Body& body) {
  try {
    body();
  } catch (const UserError&) {
  }
}

}  // namespace

void fuzz(std::string_view text) {
  orRefused([&] {
    const Spec spec = Spec::parse(text);
    demand(Spec::parse(spec.text()) == spec, "a spec's text says something else");
  });
  orRefused([&] { engineOf(text); });
  orRefused([&] {
    const Pipeline pipeline = Pipeline::parse(text);
    demand(Pipeline::parse(pipeline.text()) == pipeline, "a pipeline's text says something else");
    orRefused([&] { World<2> world(pipeline); });
    World<3> world(pipeline);
  });
}

}}  // namespace lpc::LPC_PRECISION
