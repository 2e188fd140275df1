// SPDX-License-Identifier: Zlib
// The drawing of an engine shows what the engine reports: shapes where it moved them, joints, motion. Contacts, boxes
// and islands are not invented.
#include "tests/engines/engine_checks.h"
#include "tests/expect_caught.h"
#include "tests/planted_bugs/draw_bugs.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace engine_drawing_test { namespace {

// One box at rest, and one that hangs beside it.
template <int D>
bool tellsWhatEnginesTell(const Start<D>& start) {
  const auto s = start(gravity<D>(0, -kG));
  s->add(ground<D>());
  const BodyHandle rests = s->add(body<D>(cube<D>(), at<D>(0, 0.6))), hangs = s->add(body<D>(cube<D>(), at<D>(5, 5)));
  s->add(JointDef<D>{.kind = "pivot", .bodyB = hangs, .X_WJ = {at<D>(6, 5), {}}});
  run(*s, 0.5);
  DrawLayers layers;
  for (const DrawLayer& layer : kDrawLayers) layers.*layer.on = true;
  HeardDrawing<D> all;
  drawSimulation(*s, layers, all);
  if (all.solids.size() != 3 || (all.solids[1].X_WS.p - s->pose(rests).p).norm() > 1e-6) return false;
  for (std::size_t i = 0; i < 3; ++i) {
    const BodyType type = i == 0 ? BodyType::fixed : BodyType::dynamic;
    if (all.solids[i].look != bodyLook(i, type, s->bodies().awake[i])) return false;  // no island colours
  }
  std::size_t anchors = 0, centres = 0;
  for (const auto& dot : all.dots) anchors += dot.colour == kDrawnJoint, centres += dot.colour == kDrawnCentre;
  for (const auto& line : all.strokes) {
    if (line.colour != kDrawnJoint && line.colour != kDrawnJointError && line.colour != kDrawnVelocity) return false;
  }
  return anchors == 2 && centres == 2 && all.dots.size() - anchors - centres == all.words.size();
}

template <int D>
void enginesAreDrawn() {
  everyEngine<D>("drawn", tellsWhatEnginesTell<D>);
  expectCaught("EngineDrawing.ShowsWhatEnginesReport: our own world, which tells contacts " + std::to_string(D) + 'D',
               tellsWhatEnginesTell<D>(ownWorld<D>()));
}
TEST(EngineDrawing, ShowsWhatEnginesReport2) { enginesAreDrawn<2>(); }
TEST(EngineDrawing, ShowsWhatEnginesReport3) { enginesAreDrawn<3>(); }

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::engine_drawing_test
