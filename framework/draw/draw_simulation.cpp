// SPDX-License-Identifier: Zlib
#include "framework/draw/draw_simulation.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "framework/draw/draw_structure.h"
#include "framework/problem/contact_graph.h"
#include "framework/world/world.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

constexpr double kContactPixels = 6, kAnchorPixels = 5, kCentrePixels = 4;
// Joint errors below these are invisible, and their labels would cover the rest.
constexpr double kSeenGap = kLinearSlop, kSeenTurn = 0.01;  // m, rad

constexpr std::array<DrawColour, 6> kTurns = {
    {{102, 153, 204}, {238, 170, 85}, {119, 178, 119}, {204, 119, 136}, {160, 140, 200}, {190, 180, 100}}};

Look lookOf(const DrawColour& colour, bool awake) {
  const DrawColour fill = colour * (awake ? 1 : 1.15);
  return {fill, fill * 0.55};
}

// Steps of the golden section around the hue circle: however many colours there are, each is far from the last ones.
DrawColour islandColour(std::size_t number) {
  const double hue = std::fmod(0.6180339887498949 * static_cast<double>(number), 1) * 6;
  const auto part = [&](double turn) {
    const double k = std::fmod(turn + hue, 6);
    return static_cast<unsigned char>(std::lround(225 - 125 * std::clamp(std::min(k, 4 - k), 0.0, 1.0)));
  };
  return {part(5), part(3), part(1)};
}

std::string wordsOf(const JointError& error) {
  char text[32];
  std::string out;
  if (error.linear > kSeenGap) {
    const bool large = error.linear >= 1;
    std::snprintf(text, sizeof text, large ? "%.3g m" : "%.3g mm", error.linear * (large ? 1 : 1000));
    out = text;
  }
  if (error.angular > kSeenTurn) {
    std::snprintf(text, sizeof text, "%.3g deg", error.angular * 180 / 3.141592653589793);
    out += (out.empty() ? "" : ", ") + std::string(text);
  }
  return out;
}

template <int D>
class SimulationDrawing {
 public:
  SimulationDrawing(const Simulation<D>& simulation, const DrawLayers& layers, DebugDraw<D>& draw)
      : m_simulation(simulation),
        m_bodies(simulation.bodies()),
        m_manifolds(simulation.contacts().value_or(std::span<const Manifold<D>>())),
        m_layers(layers),
        m_draw(draw) {
    if (simulation.settings().model.joints) m_joints = simulation.joints();
  }

  void all() {
    if (m_layers.shapes) shapes();
    if (const auto* world = dynamic_cast<const World<D>*>(&m_simulation)) {
      if (m_layers.boxes) boxes(world->proxies());
      if (m_layers.structure) drawStructure(*world, m_draw, m_layers.tint);
      if (m_layers.pairs) pairs(*world);
    }
    if (m_layers.joints) {
      for (const Link<D>& link : linksOf(m_simulation)) drawLink(link, m_layers.tint, m_draw);
    }
    if (m_layers.jointErrors) {
      for (const JointRecord<D>& j : m_joints) {
        if (j.active()) jointErrorOf(j);
      }
    }
    for (const Manifold<D>& m : m_manifolds) {
      for (int i = 0; i < m.count; ++i) contact(m, m.points[i]);
    }
    for (std::size_t i = 0; i < m_bodies.pose.size(); ++i) {
      if (m_bodies.used[i] && m_bodies.type[i] != BodyType::fixed) motion(i);
    }
  }

 private:
  void point(const Vec<D>& p, double pixels, const DrawColour& colour) {
    if (p.allFinite()) m_draw.point(p, pixels, m_layers.tint.value_or(colour));
  }
  void line(const Vec<D>& a, const Vec<D>& b, const DrawColour& colour) {
    if (a.allFinite() && b.allFinite() && a != b) m_draw.line(a, b, m_layers.tint.value_or(colour));
  }

  void shapes() {
    const std::vector<Look> looks = looksOfAll();
    for (const ShapeRecord<D>& s : m_simulation.shapes()) {
      if (s.body < 0) continue;
      const auto body = static_cast<std::size_t>(s.body);
      const Pose<D>& X_WC = m_bodies.pose[body];
      if (!isPlace(X_WC)) continue;
      forParts(s.shape, s.X_CS,
               [&](const ShapeView<D>& part, const Pose<D>& X_CP) { m_draw.shape(part, X_WC * X_CP, looks[body]); });
    }
  }

  std::vector<Look> looksOfAll() const {
    std::vector<Look> out;
    for (std::size_t i = 0; i < m_bodies.pose.size(); ++i) {
      out.push_back(bodyLook(i, m_bodies.type[i], !m_layers.sleep || m_bodies.awake[i]));
    }
    if (m_layers.islands && m_simulation.contacts()) colourIslands(out);
    for (Look& look : out) {
      if (m_layers.tint) look.fill = look.edge = *m_layers.tint, look.outline = true;
    }
    return out;
  }

  // By the lowest slot of each island, so that other islands keep their colour when one appears or vanishes.
  void colourIslands(std::vector<Look>& looks) const {
    ContactGraph<D> graph;
    WorkDone work;
    graph.reset(m_bodies, m_manifolds, m_joints, work);
    const std::span<const std::int32_t> islands = graph.islands();
    IndexedVector<std::size_t> lowest(islands.size(), islands.size());
    for (std::size_t i = 0; i < islands.size(); ++i) {
      const bool moves = looks[i].moves;
      if (islands[i] < 0) {
        looks[i] = lookOf(kDrawnFixed, true);
      } else {
        std::size_t& first = lowest[islands[i]];
        first = std::min(first, i);
        looks[i] = lookOf(islandColour(first), !m_layers.sleep || m_bodies.awake[i]);
      }
      looks[i].moves = moves;
    }
  }

  void boxes(const Proxies<D>& proxies) {
    for (ProxyId i = 0; i < proxies.size(); ++i) {
      const Aabb<D> box = proxies.box(i);
      if (!(box.lo[0] <= box.hi[0])) continue;  // free slot, or no box
      const auto corner = [&](int sides) {
        Vec<D> p;
        for (int d = 0; d < D; ++d) p[d] = sides >> d & 1 ? box.hi[d] : box.lo[d];
        return p;
      };
      for (int sides = 0; sides < 1 << D; ++sides) {
        for (int d = 0; d < D; ++d) {
          if (!(sides >> d & 1)) line(corner(sides), corner(sides | 1 << d), kDrawnBox);
        }
      }
    }
  }

  // A plane has no box: use its point nearest to the other box.
  void pairs(const World<D>& world) {
    const Proxies<D>& proxies = world.proxies();
    const auto end = [&](ProxyId shape, ProxyId other) -> Vec<D> {
      const ShapeRecord<D>& s = world.shapes()[static_cast<std::size_t>(shape)];
      if (!s.shape.isPlane()) return proxies.box(shape).center();
      const Pose<D> X_WS = poseOf(m_bodies, s.body) * s.X_CS;
      Vec<D> foot = X_WS.inverse() * proxies.box(other).center();
      foot[1] = 0;
      return X_WS * foot;
    };
    for (const ShapePair& p : world.pairs()) {
      if (!proxies.isFree(p.a) && !proxies.isFree(p.b)) line(end(p.a, p.b), end(p.b, p.a), kDrawnPair);
    }
  }

  void jointErrorOf(const JointRecord<D>& j) {
    const Pose<D> X_WA = poseOf(m_bodies, j.bodyA), X_WB = poseOf(m_bodies, j.bodyB);
    const Vec<D> a = X_WA * j.X_CaJ.p, b = X_WB * j.X_CbJ.p;
    if (!isPlace(X_WA) || !isPlace(X_WB)) return;
    JointRows<D> rows;
    j.kind->rows(j, X_WA, X_WB, rows);
    const JointError error = jointError(rows.all());
    const std::string words = wordsOf(error);
    if (words.empty()) return;
    line(a, b, kDrawnJointError);
    point(b, kAnchorPixels, kDrawnJointError);
    m_draw.text(b, words, m_layers.tint.value_or(kDrawnJointError));
  }

  void contact(const Manifold<D>& m, const ContactPoint<D>& c) {
    const Vec<D> onA = poseOf(m_bodies, m.bodyA) * c.localA, onB = poseOf(m_bodies, m.bodyB) * c.localB;
    const Vec<D> p = onA + (onB - onA) / 2;
    // after a veto the impulses are old
    const bool bears = c.load > 0 && !m.ignored;
    if (m_layers.normals) line(p, p + m_layers.normalLength * m.normal, kDrawnNormal);
    if (m_layers.impulses && bears) line(p, p + m_layers.impulseLength * c.load * m.normal, kDrawnImpulse);
    if (m_layers.friction && !m.ignored) {
      Vec<D> friction = Vec<D>::Zero();
      const auto along = tangents(m.normal);
      for (int k = 1; k < D; ++k) friction += c.impulse[k] * along.col(k - 1);
      line(p, p + m_layers.impulseLength * friction, kDrawnFriction);
    }
    if (m_layers.contacts) point(p, kContactPixels, bears ? kDrawnBearing : kDrawnIdle);
  }

  void motion(std::size_t body) {
    const Vec<D>& p = m_bodies.pose[body].p;
    if (m_layers.velocities) line(p, p + m_layers.velocityTime * m_bodies.motion[body].v, kDrawnVelocity);
    if (m_layers.centres) point(p, kCentrePixels, kDrawnCentre);
  }

  const Simulation<D>& m_simulation;
  const Bodies<D>& m_bodies;
  std::span<const Manifold<D>> m_manifolds;
  std::span<const JointRecord<D>> m_joints;
  const DrawLayers& m_layers;
  DebugDraw<D>& m_draw;
};

}  // namespace

Look bodyLook(std::size_t slot, BodyType type, bool awake) {
  if (type == BodyType::fixed) return {.fill = kDrawnFixed, .edge = {120, 120, 115}, .moves = false};
  return lookOf(kTurns[slot % kTurns.size()], awake);
}

template <int D>
void drawLink(const Link<D>& link, const std::optional<DrawColour>& tint, DebugDraw<D>& draw) {
  const DrawColour colour = tint.value_or(link.force ? kDrawnForce : kDrawnJoint);
  const Vec<D>* const ends[] = {&link.from, &link.a, &link.b, &link.to};
  for (int i = 0; i < 3; ++i) {
    if (*ends[i] != *ends[i + 1]) draw.line(*ends[i], *ends[i + 1], colour);
  }
  draw.point(link.a, kAnchorPixels, colour), draw.point(link.b, kAnchorPixels, colour);
}

template <int D>
void drawSimulation(const Simulation<D>& simulation, const DrawLayers& layers, DebugDraw<D>& draw) {
  SimulationDrawing<D>(simulation, layers, draw).all();
}

template void drawLink(const Link<2>&, const std::optional<DrawColour>&, DebugDraw<2>&);
template void drawLink(const Link<3>&, const std::optional<DrawColour>&, DebugDraw<3>&);
template void drawSimulation(const Simulation<2>&, const DrawLayers&, DebugDraw<2>&);
template void drawSimulation(const Simulation<3>&, const DrawLayers&, DebugDraw<3>&);

}}  // namespace lpc::LPC_PRECISION
