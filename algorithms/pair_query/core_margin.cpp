// SPDX-License-Identifier: Zlib
#include <utility>

#include "algorithms/pair_query/core/plane_pair.h"
#include "algorithms/pair_query/gjk/epa3.h"
#include "algorithms/pair_query/gjk/gjk_cache.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using namespace pair_query;

// The inner core of a shape: the shape reduced by a margin. The inner core with a ball of the margin around each of its
// points lies within the shape.
template <int D>
struct InnerCore {
  ShapeView<D> view;
  Real margin = 0;  // m

  // `share` of the smallest half extent. Points and segments have none.
  void shrink(const ShapeView<D>& shape, Real share) {
    view = shape, margin = 0;
    if (shape.core() == CoreClass::box) {
      margin = share * shape.half.minCoeff();
      view.half.array() -= margin;
    } else if (shape.core() == CoreClass::hull) {
      // Moving its planes inwards would make another hull with other corners. Scaling it towards a point keeps them,
      // and for a ball around that point inside the hull (1 - t) K + t ball lies within K.
      const auto& corners = shape.hull->vertices;
      Vec<D> middle = Vec<D>::Zero();
      for (const Vec<D>& v : corners) middle += v;
      middle /= static_cast<Real>(corners.size());
      margin = share * std::max(Real(0), ballAround(*shape.hull, middle));
      m_hull.vertices.clear();
      for (const Vec<D>& v : corners) m_hull.vertices.push_back(middle + (1 - share) * (v - middle));
      view.hull = &m_hull;
    }
  }

 private:
  static Real ballAround(const Polytope<2>& hull, const Vec<2>& p) {
    Real radius = std::numeric_limits<Real>::infinity();
    for (std::size_t i = 0; i < hull.normals.size(); ++i) {
      radius = std::min(radius, hull.normals[i].dot(hull.vertices[i] - p));
    }
    return radius;
  }
  static Real ballAround(const Polytope<3>& hull, const Vec<3>& p) {
    Real radius = std::numeric_limits<Real>::infinity();
    for (const auto& face : hull.faces) radius = std::min(radius, face.offset - face.normal.dot(p));
    return radius;
  }

  Polytope<D> m_hull;  // corners only: the search for directions reads no faces
};

// Cores with a margin (van den Bergen 2003; Bullet's btGjkPairDetector). GJK runs between the inner cores, which are
// apart while the shapes overlap by less than the margins, so that only deeper overlaps need EPA. Bullet reports the
// inner distance less the margins, the distance of shapes with rounded edges: too large where an edge or corner is
// nearest, and positive where shapes overlap there. Here only the direction comes from the inner cores, and the
// reported distance is what that direction proves for the whole shapes (core_pair.h): equal where faces meet, and never
// more than the truth. If it proves no gap, and the margins do not meet either, an edge or a corner decides. Then, and
// where the inner cores overlap, GJK and EPA continue with the whole shapes from the corners reached.
template <int D>
class CoreMargin final : public PairQuery<D> {
 public:
  struct Params {
    Real margin = kCoreMargin;
    int iterations = 64;
    int faces = 1024;
    void visit(ParamVisitor& v) {
      v.real("margin", margin, Real(0.01), Real(0.9), "1",
             "margin removed from each shape, as a fraction of a box's smallest half extent or of a polytope's "
             "inscribed ball");
      v.integer("iterations", iterations, 1, 10000, "support points of GJK", ParamRole::effort);
      v.integer("faces", faces, 8, 100000, "largest number of EPA faces");
    }
  };
  explicit CoreMargin(const Params& params) : m_params(params) {}

  static AlgorithmInfo info() {
    AlgorithmInfo out{.name = "core_margin",
                      .summary = "GJK between shapes shrunk by a margin, EPA where the shrunk shapes overlap",
                      .paper = "vandenbergen2003",
                      .complexity = "about 3 to 10 support points while shapes overlap by less than the margins",
                      .guarantee = Guarantee::approximate};
    const auto fails = [&](const char* when, const char* symptom, std::initializer_list<const char*> properties) {
      for (const char* property : properties) out.failures.push_back({when, symptom, property});
    };
    fails("shapes that overlap by less than the margins, closest at an edge or a corner",
          "the depth is measured along the closest direction of the shrunk shapes: up to several times the least depth",
          {"N5 depth is minimal", "N5 depth suffices", "N6 Lipschitz", "N11 rounding", "N12 superset", "N13 halves",
           "N15 polygon and circle"});
    fails("separated shapes, closest at an edge or a corner",
          "the distance is a lower bound along the closest direction of the shrunk shapes", {"N6 convex along lines"});
    fails("shapes that overlap by less than the margins, closest at an edge or a corner",
          "the two support features along that normal need not share a point: a closest point lies half-way",
          {"N7 witnesses"});
    fails("the margins just touch, or the shrunk shapes just prove a gap",
          "rounding decides whether the shrunk or the whole shapes give the answer",
          {"N1 swap", "N2 motion of both", "N3 scale", "N16 vertex order"});
    fails("the same box as a box, with faces moved inwards, and as a hull, which is scaled",
          "the two shrunk shapes differ", {"N14 box as hull"});
    return out;
  }

  // A curved core has no corners to scale, nor planes that bound a ball in it; a triangle has no interior.
  bool supports(ShapeKind a, ShapeKind b) const override {
    if (hasPlane(a, b)) return supportsPlane(a, b);
    const auto has = [](ShapeKind k) { return coreClass(k) != CoreClass::curved && k != ShapeKind::triangle; };
    return has(a) && has(b);
  }

  bool remembers() const override { return true; }

  void query(std::span<const PairView<D>> pairs, QueryNeed need, std::span<PairAnswer<D>> answers,
             std::span<PairMemory> memory, WorkDone& work) override {
    work[WorkCount::pairQueries] += pairs.size();
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const CorePair<D> pair(pairs[i]);
      if (hasPlane(pair.a.kind, pair.b.kind)) {
        answers[i] = m_plane.answer(pair, need, work);
        continue;
      }
      PairMemory* remembered = memory.empty() ? nullptr : &memory[i];
      BestAxis<D> best;
      const QueryStatus status = search(pair, remembered, best, work);
      answers[i] = answerFrom<D>(pair, best, status, need, m_touching, work);
    }
  }

 private:
  // How GJK ended between two cores.
  struct Walk {
    Simplex<D> simplex;
    NearestFeature<D> nearest;  // if not inside
    bool inside = false, capped = false;

    Real length() const { return inside ? 0 : std::sqrt(nearest.length2); }
    const Simplex<D>& last() const { return inside ? simplex : nearest.feature; }
  };

  // GJK from the remembered simplex to the nearest point. `best` collects the bounds of its directions.
  Walk approach(const CorePair<D>& pair, Real rounding, GjkCache<D>& cache, BestAxis<D>& best, WorkDone& work) const {
    const auto support = [&](const Vec<D>& n) {
      work[WorkCount::supportCalls] += 2;
      const Vec<D> w = cache.support(pair, n);
      best.take(n, n.dot(w));
      return w;
    };
    Walk walk;
    walk.simplex = cache.simplex();
    if (walk.simplex.count == 0) {
      Vec<D> n = cache.direction();
      if (!makeUnit<D>(n)) n = pair.p;
      if (!makeUnit<D>(n)) n = Vec<D>::Unit(0);
      walk.simplex.push(support(n));
    }
    walk.inside = nearestOfSimplex(walk.simplex, walk.nearest);
    for (int i = 0; !walk.inside; ++i) {
      const Real length = walk.length();
      Vec<D> n;
      if (length - best.bound <= rounding || !featureDirection(walk.nearest, n)) break;
      walk.capped = i >= m_params.iterations;
      if (walk.capped) break;
      const Real before = best.bound;
      const Vec<D> w = support(n);
      if (length - best.bound <= rounding || walk.nearest.feature.contains(w)) break;
      walk.simplex = walk.nearest.feature;
      walk.simplex.push(w);
      NearestFeature<D> next;
      walk.inside = nearestOfSimplex(walk.simplex, next);
      // An improving bound is a descent, too: the length shows only the square of a direction's error.
      if (!walk.inside && !(next.length2 < walk.nearest.length2) && !(best.bound > before)) break;
      if (!walk.inside) walk.nearest = next;
    }
    return walk;
  }

  QueryStatus search(const CorePair<D>& pair, PairMemory* memory, BestAxis<D>& best, WorkDone& work) {
    m_a.shrink(pair.a, m_params.margin), m_b.shrink(pair.b, m_params.margin);
    const CorePair<D> inner = pair.withShapes(m_a.view, m_b.view);
    const Real rounding = kBoundRounding * pair.scale, near = kShallow * pair.scale;
    PairMemory corners = memory ? *memory : PairMemory{};
    m_cache.recall(inner, &corners);
    BestAxis<D> core;  // of the inner cores
    const Walk walk = approach(inner, rounding, m_cache, core, work);
    m_cache.remember(core.n, walk.last(), corners);
    if (memory) *memory = corners;
    if (!(walk.length() <= near)) {  // nearer than this, GJK's direction is rounding
      best.tryDirection(pair, core.n, work);
      const bool meets = walk.length() <= m_a.margin + m_b.margin + pair.radii();
      if (meets || best.bound > pair.radii()) {
        return walk.capped ? QueryStatus::iterationLimit : QueryStatus::converged;
      }
    }
    m_cache.recall(pair, &corners);
    const Walk whole = approach(pair, rounding, m_cache, best, work);
    if (!(whole.length() <= near)) return whole.capped ? QueryStatus::iterationLimit : QueryStatus::converged;
    const EpaLimits limits{m_params.faces, m_params.faces, kNotLocal, rounding, 0, whole.inside};
    return m_epa.run(pair, whole.last(), limits, best, work);
  }

  Params m_params;
  InnerCore<D> m_a, m_b;
  GjkCache<D> m_cache;
  Epa<D> m_epa;
  PlanePair<D> m_plane;
  TouchingPoint m_touching;
};

}  // namespace

LPC_REGISTER(PairQuery, CoreMargin, 2, 3);

}}  // namespace lpc::LPC_PRECISION
