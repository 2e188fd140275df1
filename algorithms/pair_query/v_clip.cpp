// SPDX-License-Identifier: Zlib
#include "algorithms/pair_query/core/plane_pair.h"
#include "algorithms/pair_query/gjk/gjk_cache.h"
#include "algorithms/pair_query/sat/sat_boxes.h"
#include "algorithms/pair_query/sat/sat_polytope3.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using namespace pair_query;

enum class FeatureKind : std::int32_t { vertex, edge, face };

struct Feature {
  FeatureKind kind = FeatureKind::vertex;
  std::int32_t number = 0;
};

// Mirtich's walk: from a pair of features of the two cores to one of lower dimension or shorter distance, while one of
// them lies outside the Voronoi region of the other. It ends where both are inside, and are then the nearest, or where
// a feature lies in the other core.
class Walk {
 public:
  enum class End { apart, overlap, lost };

  /// Starts at these features and replaces them by those where it ends.
  End run(const SatCore& a, const SatCore& b, int steps, IndexedArray<Feature, 2>& features, WorkDone& work) {
    m_core = {&a, &b}, m_feature = &features;
    for (int i = 0; i < steps; ++i) {
      ++work[WorkCount::axisTests];
      const Step step = next();
      if (step == Step::done) return End::apart;
      if (step == Step::overlap) return End::overlap;
    }
    return End::lost;
  }

 private:
  enum class Step { moved, done, overlap };
  using Kind = FeatureKind;

  const SatCore& core(int i) const { return *m_core[i]; }
  Feature& feature(int i) const { return (*m_feature)[i]; }
  Step moveTo(int i, Kind kind, AnyIndex auto number) {
    feature(i) = {kind, static_cast<std::int32_t>(number)};
    return Step::moved;
  }

  // A plane of the feature's Voronoi region, which lies within `height >= 0`; beyond is the region of `neighbour`. If
  // the feature is a face: of the edge that starts at that vertex.
  struct Bound {
    Vec<3> point, inward;
    Feature neighbour;
    Real height(const Vec<3>& q) const { return inward.dot(q - point); }
  };

  // The edge of this face that leaves v in the direction of the face's loop.
  static std::int32_t edgeFrom(const SatCore& core, int v, int face) {
    for (const Polytope<3>::Spoke& s : core.spokes(v)) {
      const SatCore::Edge& e = core.edges()[s.edge];
      if ((e.faceA == face && e.v0 == v) || (e.faceB == face && e.v1 == v)) return s.edge;
    }
    LPC_ASSERT(false);
    return 0;
  }
  // Across the edge, in the plane of its face, into the face.
  static Vec<3> intoFace(const SatCore& core, const SatCore::Edge& e, bool ofA) {
    const Vec<3> along = core.vertex(e.v1) - core.vertex(e.v0);
    return ofA ? Vec<3>(core.normal(e.faceA).cross(along)) : Vec<3>(along.cross(core.normal(e.faceB)));
  }
  Feature beyond(int i, const Feature& neighbour) const {
    if (feature(i).kind != Kind::face) return neighbour;
    return {Kind::edge, edgeFrom(core(i), neighbour.number, feature(i).number)};
  }
  void regionOf(int i, std::vector<Bound>& out) {
    const SatCore& of = core(i);
    const Feature f = feature(i);
    out.clear();
    switch (f.kind) {
      case Kind::vertex: {
        const Vec<3> v = m_origin = of.vertex(f.number);
        for (const Polytope<3>::Spoke& s : of.spokes(f.number)) {
          out.push_back({v, v - of.vertex(s.to), {Kind::edge, s.edge}});
        }
        return;
      }
      case Kind::edge: {
        const SatCore::Edge& e = of.edges()[f.number];
        const Vec<3> v0 = of.vertex(e.v0), v1 = of.vertex(e.v1);
        m_origin = v0;
        out.push_back({v0, v1 - v0, {Kind::vertex, e.v0}});
        out.push_back({v1, v0 - v1, {Kind::vertex, e.v1}});
        if (e.faceA < 0) return;
        out.push_back({v0, -intoFace(of, e, true), {Kind::face, e.faceA}});
        out.push_back({v0, -intoFace(of, e, false), {Kind::face, e.faceB}});
        return;
      }
      case Kind::face: {
        const SatCore::Face& face = of.faces()[f.number];
        const Vec<3> normal = of.normal(f.number);
        int last = of.loop(face).back();
        Vec<3> from = of.vertex(last);
        for (const int next : of.loop(face)) {
          const Vec<3> to = of.vertex(next);
          out.push_back({from, normal.cross(to - from), {Kind::vertex, last}});
          last = next, from = to;
        }
        return;
      }
    }
  }

  Step next() {
    const Kind kindA = feature(0).kind, kindB = feature(1).kind;
    if (kindA == Kind::vertex && kindB == Kind::vertex) return vertices();
    if (kindA == Kind::edge && kindB == Kind::edge) return edges();
    const int higher = kindA > kindB ? 0 : 1;
    if (feature(higher).kind == Kind::edge) return vertexAndEdge(1 - higher, higher);
    return feature(1 - higher).kind == Kind::vertex ? vertexAndFace(1 - higher, higher)
                                                    : edgeAndFace(1 - higher, higher);
  }

  Step vertices() {
    for (const int i : {0, 1}) {
      const Vec<3> q = core(1 - i).vertex(feature(1 - i).number);
      regionOf(i, m_region);
      for (const Bound& bound : m_region) {
        if (bound.height(q) < 0) return feature(i) = bound.neighbour, Step::moved;
      }
    }
    return Step::done;
  }

  Step vertexAndEdge(int v, int e) {
    const Vec<3> q = core(v).vertex(feature(v).number);
    regionOf(e, m_region);
    for (const Bound& bound : m_region) {
      if (bound.height(q) < 0) return feature(e) = bound.neighbour, Step::moved;
    }
    return clipBy(v, e);
  }

  Step edges() {
    const Step first = clipBy(0, 1);
    return first == Step::done ? clipBy(1, 0) : first;
  }

  // The part of edge `e` in the region of the other feature, a vertex or an edge. If the edge is nearest at one end of
  // that part, the neighbour behind that end is nearer.
  Step clipBy(int other, int e) {
    regionOf(other, m_region);
    Clip clip;
    cut(e, clip);
    if (clip.simply) return feature(other) = *clip.entry, Step::moved;
    const Vec<3> way = clip.head - clip.tail;
    const auto slope = [&](Real t) {  // of the distance along the edge
      Vec<3> from = clip.tail + t * way - m_origin;
      if (feature(other).kind == Kind::edge) {
        Vec<3> along = m_region.front().inward;
        if (makeUnit<3>(along)) from -= from.dot(along) * along;
      }
      return from.dot(way);
    };
    if (clip.entry && slope(clip.from) > 0) return feature(other) = *clip.entry, Step::moved;
    if (clip.exit && slope(clip.to) < 0) return feature(other) = *clip.exit, Step::moved;
    return Step::done;
  }

  struct Clip {
    Vec<3> tail, head;
    Real from = 0, to = 1;
    const Feature *entry = nullptr, *exit = nullptr;  // behind the planes that clip it
    bool simply = false;                              // all of it is behind one plane
  };
  // Clips by m_region. False if nothing is left.
  bool cut(int e, Clip& clip) const {
    const SatCore::Edge& edge = core(e).edges()[feature(e).number];
    clip.tail = core(e).vertex(edge.v0), clip.head = core(e).vertex(edge.v1);
    for (const Bound& bound : m_region) {
      const Real t = bound.height(clip.tail), h = bound.height(clip.head);
      if (t < 0 && h < 0) {
        clip.entry = clip.exit = &bound.neighbour, clip.simply = true;
        return false;
      }
      if (t < 0 && t / (t - h) > clip.from) clip.from = t / (t - h), clip.entry = &bound.neighbour;
      if (h < 0 && t / (t - h) < clip.to) clip.to = t / (t - h), clip.exit = &bound.neighbour;
      if (clip.from > clip.to) return false;
    }
    return true;
  }

  Step vertexAndFace(int v, int f) {
    const Vec<3> q = core(v).vertex(feature(v).number);
    regionOf(f, m_region);
    const Bound* worst = nullptr;
    Real least = 0;
    for (const Bound& bound : m_region) {
      const Real height = bound.height(q) / bound.inward.norm();
      if (height < least) least = height, worst = &bound;
    }
    if (worst) return feature(f) = beyond(f, worst->neighbour), Step::moved;
    const SatCore::Plane plane = core(f).plane(core(f).faces()[feature(f).number]);
    const auto heightOf = [&](const Vec<3>& point) { return plane.n.dot(point) - plane.offset; };
    const Real height = heightOf(q);
    if (height > 0) {
      regionOf(v, m_region);
      for (const Bound& bound : m_region) {  // its inward vector leads from the other end of the edge to q
        if (heightOf(q - bound.inward) < height) {
          return feature(v) = bound.neighbour, Step::moved;
        }
      }
      return Step::done;
    }
    // Behind the face: inside the core, or in front of another face.
    Real most = -std::numeric_limits<Real>::infinity();
    std::size_t highest = 0;
    for (std::size_t k = 0; k < core(f).faces().size(); ++k) {
      const Real h = heightOver(f, static_cast<std::int32_t>(k), q);
      if (h > most) most = h, highest = k;
    }
    if (!(most > 0)) return Step::overlap;
    return moveTo(f, Kind::face, highest);
  }

  Step edgeAndFace(int e, int f) {
    regionOf(f, m_region);
    Clip clip;
    const SatCore::Edge& edge = core(e).edges()[feature(e).number];
    if (!cut(e, clip)) {  // beside the face: its nearest edge
      const SatRidge ridge(core(e), feature(e).number);
      Real least2 = std::numeric_limits<Real>::infinity();
      Feature nearest = beyond(f, m_region.front().neighbour);
      for (const Bound& bound : m_region) {
        const Feature rim = beyond(f, bound.neighbour);
        const Real length2 = betweenEdges(ridge, SatRidge(core(f), rim.number)).squaredNorm();
        if (length2 < least2) least2 = length2, nearest = rim;
      }
      return feature(f) = nearest, Step::moved;
    }
    const Vec<3> way = clip.head - clip.tail;
    const Real from = heightOver(f, feature(f).number, clip.tail + clip.from * way);
    const Real to = heightOver(f, feature(f).number, clip.tail + clip.to * way);
    if (from * to <= 0) return Step::overlap;
    if (std::abs(from) <= std::abs(to)) {
      return clip.entry ? (feature(f) = beyond(f, *clip.entry), Step::moved) : moveTo(e, Kind::vertex, edge.v0);
    }
    return clip.exit ? (feature(f) = beyond(f, *clip.exit), Step::moved) : moveTo(e, Kind::vertex, edge.v1);
  }

  Real heightOver(int i, std::int32_t face, const Vec<3>& q) const {
    const SatCore::Plane plane = core(i).plane(core(i).faces()[face]);
    return plane.n.dot(q) - plane.offset;
  }

  IndexedArray<const SatCore*, 2> m_core{};
  IndexedArray<Feature, 2>* m_feature = nullptr;
  std::vector<Bound> m_region;
  Vec<3> m_origin = Vec<3>::Zero();  // of the region's feature: the vertex, or the edge's first end
};

// V-Clip (Mirtich 1998): the nearest features of the cores by a walk that starts at those of the last step. They are
// accepted if the vector between them is as long as its direction proves (core_pair.h). For overlapping cores the walk
// gives no depth; these pairs, and walks that fail by rounding, are left to separating axes. Climbs from those features
// prove the direction (hull_climb.h), so that few vertices are visited on hulls that have hardly moved.
template <int D>
class VClip final : public PairQuery<D> {
 public:
  struct Params {
    int iterations = 100;
    void visit(ParamVisitor& v) {
      v.integer("iterations", iterations, 1, 10000,
                "steps of the feature walk; after these, a separating axis test decides", ParamRole::effort);
    }
  };
  explicit VClip(const Params& params) : m_params(params) {}

  static AlgorithmInfo info() {
    return {.name = "v_clip",
            .summary = "V-Clip: walk to the closest features, and separating axes for the depth; no curved cores",
            .paper = "mirtich1998",
            .complexity = "when separated, a few local steps from the last features; else that of sat"};
  }

  bool supports(ShapeKind a, ShapeKind b) const override {
    if (coreClass(a) == CoreClass::curved || coreClass(b) == CoreClass::curved) return false;
    return !hasPlane(a, b) || supportsPlane(a, b);
  }

  bool remembers() const override { return true; }

  void query(std::span<const PairView<D>> pairs, QueryNeed need, std::span<PairAnswer<D>> answers,
             std::span<PairMemory> memory, WorkDone& work) override {
    work[WorkCount::pairQueries] += pairs.size();
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      CorePair<D> pair(pairs[i]);
      if (hasPlane(pair.a.kind, pair.b.kind)) {
        answers[i] = m_plane.answer(pair, need, work);
        continue;
      }
      std::array<int, 2> climb{};
      pair.climb = &climb;
      BestAxis<D> best;
      if (!walk(pair, memory.empty() ? nullptr : &memory[i], best, work)) {
        best = {};
        if (pair.a.hull || pair.b.hull) {
          m_axes.run(pair, need, nullptr, best, work);
        } else {
          SatBoxes<D>(pair, need, best, work).run();
        }
      }
      answers[i] = answerFrom<D>(pair, best, QueryStatus::converged, need, m_touching, work);
    }
  }

 private:
  struct Stored {
    std::uint32_t known = 0;  // 1: there are features; no other value is valid
    IndexedArray<Feature, 2> features;
    std::array<std::uint32_t, 3> none{};
  };

  static bool exists(const Feature& f, const SatCore& core) {
    const auto within = [&](std::size_t count) { return f.number >= 0 && static_cast<std::size_t>(f.number) < count; };
    switch (f.kind) {
      case FeatureKind::vertex:
        return within(static_cast<std::size_t>(core.vertexCount()));
      case FeatureKind::edge:
        return within(core.edges().size());
      case FeatureKind::face:
        return within(core.faces().size());
    }
    return false;  // a number from a file
  }

  // Returns false if it has not found and proved the distance.
  bool walk(const CorePair<D>& pair, PairMemory* memory, BestAxis<D>& best, WorkDone& work) {
    m_a.start(pair.a), m_b.start(pair.b, pair.p, pair.r);
    const Stored last = memory ? std::bit_cast<Stored>(memory->bytes) : Stored{};
    IndexedArray<Feature, 2> features = last.features;
    const bool faces =
        features[0].kind == FeatureKind::face && features[1].kind == FeatureKind::face;  // no walk ends there
    if (last.known != 1 || faces || !exists(features[0], m_a) || !exists(features[1], m_b)) {
      work[WorkCount::supportCalls] += 2;
      features[0] = foremost(pair.a, pair.p, pair.climbOnA());
      features[1] = foremost(pair.b, Vec<D>(-(pair.r.transpose() * pair.p)), pair.climbOnB());
    }
    const Walk::End end = m_walk.run(m_a, m_b, m_params.iterations, features, work);
    *pair.climb = {cornerOf(features[0], m_a), cornerOf(features[1], m_b)};
    if (memory) memory->bytes = std::bit_cast<decltype(memory->bytes)>(Stored{1, features, {}});
    return end == Walk::End::apart && prove(pair, facing(features), best, work);
  }

  static Feature foremost(const ShapeView<D>& shape, const Vec<D>& d, int* climb) {
    std::uint16_t corner = 0;
    supportCorner<D>(shape, d, corner, climb);
    return {FeatureKind::vertex, corner == kNoCorner ? 0 : corner};
  }

  static SatFeatures facing(const IndexedArray<Feature, 2>& f) {
    using enum SatFeatures::Kind;
    const auto kind = [&] {
      if (f[0].kind == FeatureKind::face) return faceOfA;
      if (f[1].kind == FeatureKind::face) return faceOfB;
      if (f[0].kind == FeatureKind::edge) return f[1].kind == FeatureKind::edge ? edges : edgeVertex;
      return f[1].kind == FeatureKind::edge ? vertexEdge : vertices;
    };
    return {kind(), f[0].number, f[1].number};
  }

  bool prove(const CorePair<D>& pair, const SatFeatures& features, BestAxis<D>& best, WorkDone& work) {
    const Vec<D> way = wayBetween(features, m_a, m_b);
    const Real length = way.norm(), slack = kBoundRounding * pair.scale;
    Vec<D> n;
    if (commonNormal(features, m_a, m_b, way, n)) best.tryDirection(pair, n.dot(way) < 0 ? Vec<D>(-n) : n, work);
    if (length - best.bound > slack) best.tryDirection(pair, way, work);
    return length - best.bound <= slack;
  }
  static int cornerOf(const Feature& f, const SatCore& core) {
    switch (f.kind) {
      case FeatureKind::vertex:
        break;
      case FeatureKind::edge:
        return core.edges()[f.number].v0;
      case FeatureKind::face:
        return core.loop(core.faces()[f.number])[0];
    }
    return f.number;
  }

  Params m_params;
  SatCore m_a, m_b;
  Walk m_walk;
  SatPolytope<D> m_axes;
  PlanePair<D> m_plane;
  TouchingPoint m_touching;
};

}  // namespace

LPC_REGISTER(PairQuery, VClip, 3);

}}  // namespace lpc::LPC_PRECISION
