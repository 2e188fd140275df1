// SPDX-License-Identifier: Zlib
#include "experiments/trial/formats/pair_stream.h"

#include <algorithm>

#include "framework/shape/curved_core.h"
#include "framework/world/box_index.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

/// A copy of the convex part, which outlives its body.
template <int D>
Shape<D> partOf(const Shape<D>& shape, std::int32_t part) {
  if (shape.convex()) return shape;
  if (!shape.surface()) return shape.parts()[static_cast<std::size_t>(part)].shape;
  const ShapeView<D>& view = shape.surfaceParts()[static_cast<std::size_t>(part)].view;
  return view.hull ? Shape<D>::ofCorners(view.kind, view.hull->vertices) : Shape<D>::segment(view.half[0]);
}

/// Equal for equal shapes of any body.
template <int D>
std::vector<double> identity(const ShapeView<D>& shape) {
  std::vector<double> out = {static_cast<double>(shape.kind), static_cast<double>(shape.radius)};
  const auto add = [&](const auto& numbers) { out.insert(out.end(), numbers.begin(), numbers.end()); };
  add(shape.half);
  if (shape.curved) add(shape.curved->sizes());
  if (shape.hull) {
    for (const Vec<D>& p : shape.hull->vertices) add(p);
  }
  return out;
}

/// Pairs of bodies with collision disabled by a joint, sorted.
template <int D>
std::vector<std::pair<std::int32_t, std::int32_t>> unpairedBodies(const Simulation<D>& simulation) {
  std::vector<std::pair<std::int32_t, std::int32_t>> out;
  if (!simulation.settings().model.joints) return out;
  for (const JointRecord<D>& j : simulation.joints()) {
    if (j.active() && j.bodyA >= 0 && !j.collide) out.emplace_back(std::minmax(j.bodyA, j.bodyB));
  }
  std::sort(out.begin(), out.end());
  return out;
}

/// In a world's order: body of a < body of b, one of them dynamic.
template <int D>
std::vector<ShapePair> shapePairs(const Simulation<D>& simulation, Real margin, WorkDone& work) {
  const auto shapes = simulation.shapes();
  const Bodies<D>& bodies = simulation.bodies();
  const auto broadphase = createStage<Broadphase<D>>({"sort_and_sweep", {}});
  BoxIndex<D> boxes(*broadphase, margin);
  for (std::size_t s = 0; s < shapes.size(); ++s) {
    if (shapes[s].body >= 0) boxes.add(s, shapes[s]);
  }
  boxes.sync(shapes, bodies, {}, simulation.settings().sleepingContacts);
  std::vector<ProxyPair> found;
  boxes.findPairs(found, work);
  const auto unpaired = unpairedBodies(simulation);
  std::vector<ShapePair> out;
  for (const ProxyPair& p : found) {
    ShapePair pair{p.a, p.b};
    std::int32_t a = shapes[static_cast<std::size_t>(p.a)].body, b = shapes[static_cast<std::size_t>(p.b)].body;
    if (a > b) std::swap(a, b), std::swap(pair.a, pair.b);
    const auto moves = [&](std::int32_t body) {
      return bodies.type[static_cast<std::size_t>(body)] == BodyType::dynamic;
    };
    if (!moves(a) && !moves(b)) continue;
    if (std::binary_search(unpaired.begin(), unpaired.end(), std::pair(a, b))) continue;
    out.push_back(pair);
  }
  return out;
}

}  // namespace

template <int D>
PairCollector<D>::PairCollector(std::string scene, Real dt, Real margin) {
  m_stream.scene = std::move(scene);
  m_stream.dt = static_cast<double>(dt), m_stream.margin = static_cast<double>(margin);
}

template <int D>
std::uint32_t PairCollector<D>::shapeNumber(const Shape<D>& shape) {
  const auto next = static_cast<std::uint32_t>(m_stream.shapes.size());
  const auto [at, isNew] = m_shapeNumbers.emplace(identity(shape.view()), next);
  if (isNew) m_stream.shapes.push_back(shape);
  return at->second;
}

template <int D>
bool PairCollector<D>::see(const Simulation<D>& simulation, long step, std::size_t most) {
  const auto shapes = simulation.shapes();
  const Bodies<D>& bodies = simulation.bodies();
  const auto margin = static_cast<Real>(m_stream.margin);
  WorkDone work;
  PartPairs<D> partPairs;
  const auto convexPairs = partPairs.of(shapePairs(simulation, margin, work), shapes, bodies.pose, margin, work);
  if (convexPairs.size() > most - std::min(most, m_stream.pairPoses.size())) return false;
  const auto begin = static_cast<std::ptrdiff_t>(m_stream.pairPoses.size());
  for (const ConvexPair<D>& pair : convexPairs) {
    struct Side {
      PartOfBody part;
      Shape<D> shape;
      Pose<D> X_CP;
    };
    const auto side = [&](std::int32_t slot, std::int32_t part, const Pose<D>& X_CP) {
      const ShapeRecord<D>& s = shapes[static_cast<std::size_t>(slot)];
      const std::uint32_t generation = bodies.generation[static_cast<std::size_t>(s.body)];
      return Side{{s.body, generation, s.index, part}, partOf(s.shape, part), X_CP};
    };
    Side a = side(pair.shapes.a, pair.partA, pair.X_CA), b = side(pair.shapes.b, pair.partB, pair.X_CB);
    if (a.shape.kind() > b.shape.kind()) std::swap(a, b);
    const auto next = static_cast<std::uint32_t>(m_stream.pairs.size());
    const auto [at, isNew] = m_pairNumbers.emplace(std::pair(a.part, b.part), next);
    if (isNew) m_stream.pairs.push_back({a.part, b.part, shapeNumber(a.shape), shapeNumber(b.shape)});
    const Pose<D> X_CaCb = poseBetween(bodies.pose[static_cast<std::size_t>(a.part.body)],
                                       bodies.pose[static_cast<std::size_t>(b.part.body)]);
    m_stream.pairPoses.push_back({at->second, a.X_CP.inverse() * X_CaCb * b.X_CP});
  }
  std::sort(m_stream.pairPoses.begin() + begin, m_stream.pairPoses.end(),
            [](const auto& p, const auto& q) { return p.pair < q.pair; });
  m_stream.steps.push_back({step, convexPairs.size()});
  return true;
}

template class PairCollector<2>;
template class PairCollector<3>;

}}  // namespace lpc::LPC_PRECISION
