// SPDX-License-Identifier: Zlib
// Planted bugs of the drawing of a simulation.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "framework/draw/draw_simulation.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test {

/// Records what is drawn.
template <int D>
class HeardDrawing : public DebugDraw<D> {
 public:
  struct Dot {
    Vec<D> p;
    DrawColour colour;
  };
  struct Stroke {
    Vec<D> a, b;
    DrawColour colour;
  };
  struct Solid {
    ShapeView<D> shape;
    Pose<D> X_WS;
    Look look;
  };
  struct Words {
    Vec<D> p;
    std::string text;
    DrawColour colour;
  };
  std::vector<Dot> dots;
  std::vector<Stroke> strokes;
  std::vector<Solid> solids;
  std::vector<Words> words;

  void point(const Vec<D>& p, double, const DrawColour& c) override { dots.push_back({p, c}); }
  void line(const Vec<D>& a, const Vec<D>& b, const DrawColour& c) override { strokes.push_back({a, b, c}); }
  void shape(const ShapeView<D>& s, const Pose<D>& X_WS, const Look& look) override {
    solids.push_back({s, X_WS, look});
  }
  void text(const Vec<D>& p, std::string_view text, const DrawColour& c) override {
    words.push_back({p, std::string(text), c});
  }
  std::size_t size() const { return dots.size() + strokes.size() + solids.size() + words.size(); }
};

/// The drawing under test: drawSimulation, or one with a planted bug.
template <int D>
using Drawing = std::function<void(const Simulation<D>&, const DrawLayers&, DebugDraw<D>&)>;

/// The output of drawSimulation, changed by `change`.
template <int D>
Drawing<D> redrawn(std::function<void(HeardDrawing<D>&)> change) {
  return [change](const Simulation<D>& simulation, const DrawLayers& layers, DebugDraw<D>& draw) {
    HeardDrawing<D> all;
    drawSimulation(simulation, layers, all);
    change(all);
    for (const auto& d : all.dots) draw.point(d.p, 5, d.colour);
    for (const auto& l : all.strokes) draw.line(l.a, l.b, l.colour);
    for (const auto& s : all.solids) draw.shape(s.shape, s.X_WS, s.look);
    for (const auto& w : all.words) draw.text(w.p, w.text, w.colour);
  };
}

template <int D>
Drawing<D> forgetsAPoint() {
  return redrawn<D>([](HeardDrawing<D>& all) {
    if (!all.dots.empty()) all.dots.pop_back();
  });
}
template <int D>
Drawing<D> drawnUpsideDown() {
  return redrawn<D>([](HeardDrawing<D>& all) {
    for (auto& d : all.dots) d.p[1] *= -1;
    for (auto& l : all.strokes) l.a[1] *= -1, l.b[1] *= -1;
  });
}
/// Draws every contact as loaded.
template <int D>
Drawing<D> allBear() {
  return redrawn<D>([](HeardDrawing<D>& all) {
    for (auto& d : all.dots) {
      if (d.colour == kDrawnIdle) d.colour = kDrawnBearing;
    }
  });
}
/// Draws the force on A instead of that on B.
template <int D>
Drawing<D> backwards() {
  return redrawn<D>([](HeardDrawing<D>& all) {
    for (auto& l : all.strokes) l.b = 2 * l.a - l.b;
  });
}
template <int D>
Drawing<D> forgetsAStroke() {
  return redrawn<D>([](HeardDrawing<D>& all) {
    if (!all.strokes.empty()) all.strokes.pop_back();
  });
}
/// All bodies have one colour.
template <int D>
Drawing<D> oneColour() {
  return redrawn<D>([](HeardDrawing<D>& all) {
    for (auto& s : all.solids) s.look.fill = all.solids.back().look.fill;
  });
}
template <int D>
Drawing<D> withoutWords() {
  return redrawn<D>([](HeardDrawing<D>& all) { all.words.clear(); });
}
/// Draws each shape at its body's centre of mass.
template <int D>
Drawing<D> atTheCentre() {
  return [](const Simulation<D>& simulation, const DrawLayers& layers, DebugDraw<D>& draw) {
    HeardDrawing<D> all;
    drawSimulation(simulation, layers, all);
    std::size_t i = 0;
    for (const ShapeRecord<D>& s : simulation.shapes()) {
      forParts(s.shape, s.X_CS, [&](const ShapeView<D>& part, const Pose<D>&) {
        draw.shape(part, simulation.bodies().pose[static_cast<std::size_t>(s.body)], all.solids[i++].look);
      });
    }
  };
}
/// Inverts the setting of `layer`.
template <int D>
Drawing<D> deafTo(bool DrawLayers::*layer) {
  return [layer](const Simulation<D>& simulation, DrawLayers layers, DebugDraw<D>& draw) {
    layers.*layer = !(layers.*layer);
    drawSimulation(simulation, layers, draw);
  };
}
/// Changes the bodies that it draws: drawing affects the simulation.
template <int D>
Drawing<D> meddles() {
  return [](const Simulation<D>& simulation, const DrawLayers& layers, DebugDraw<D>& draw) {
    drawSimulation(simulation, layers, draw);
    const Bodies<D>& b = simulation.bodies();
    for (std::int32_t i = 0; i < b.size(); ++i) {
      const auto k = static_cast<std::size_t>(i);
      if (!b.active(i)) continue;
      Motion<D> motion = b.motion[k];
      motion.v[0] += Real(1e-6);
      const_cast<Simulation<D>&>(simulation).setMotion({i, b.generation[k]}, motion);
    }
  };
}

}}}  // namespace lpc::LPC_PRECISION::test
