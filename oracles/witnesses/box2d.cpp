// SPDX-License-Identifier: Zlib
// Box2D 2.4 in float, which is compiled in: an f64 query is rounded to float first, and its error bars include this
// rounding.
#include <box2d/b2_circle_shape.h>
#include <box2d/b2_collision.h>
#include <box2d/b2_distance.h>
#include <box2d/b2_polygon_shape.h>

#include <array>

#include "oracles/witnesses/adapter.h"
#include "oracles/witnesses/witness_process.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

b2Vec2 vector(const Vec<2>& v) { return {static_cast<float>(v[0]), static_cast<float>(v[1])}; }
Eigen::Vector2d vectorOf(const b2Vec2& v) { return {v.x, v.y}; }

// A shape in Box2D's terms, with its frame. Circles have their radius. For polygons the core is queried and the
// rounding subtracted, which is exact: Box2D's only rounding is a skin of 1 cm, which is left out.
class Box2dPlaced {
 public:
  void place(const ShapeView<2>& shape, const Pose<2>& X) {
    m_frame.p = vector(X.p);
    m_frame.q.c = static_cast<float>(X.q.c), m_frame.q.s = static_cast<float>(X.q.s);
    m_core = shape.core(), m_radius = static_cast<double>(shape.radius);
    m_polygon.m_count = 0, m_polygon.m_radius = 0;
    switch (shape.core()) {
      case CoreClass::point:
        m_circle.m_radius = static_cast<float>(shape.radius);
        break;
      case CoreClass::box: {
        const b2Vec2 half = vector(shape.half);
        m_polygon.SetAsBox(half.x, half.y);
        break;
      }
      case CoreClass::hull:
        if (shape.hull->vertices.size() <= b2_maxPolygonVertices) setCorners(shape.hull->vertices);
        break;
      case CoreClass::segment:
      case CoreClass::curved:
      case CoreClass::plane:  // not in the table of kinds
        break;
    }
  }

  bool isCircle() const { return m_core == CoreClass::point; }
  bool exists() const { return isCircle() || m_polygon.m_count > 0; }
  const b2Transform& frame() const { return m_frame; }
  const b2CircleShape& circle() const { return m_circle; }
  const b2PolygonShape& polygon() const { return m_polygon; }
  const b2Shape& shape() const { return isCircle() ? static_cast<const b2Shape&>(m_circle) : m_polygon; }
  /// Radius around the core (m).
  double radius() const { return m_radius; }
  /// The part of the rounding that Box2D does not support.
  double rounding() const { return isCircle() ? 0 : m_radius; }

 private:
  // Not by b2PolygonShape::Set, which merges corners within 2.5 mm, and replaces a polygon of too few corners by a
  // square.
  void setCorners(const std::vector<Vec<2>>& corners) {
    m_polygon.m_count = static_cast<int32>(corners.size());
    for (std::size_t i = 0; i < corners.size(); ++i) m_polygon.m_vertices[i] = vector(corners[i]);
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const b2Vec2 edge = m_polygon.m_vertices[(i + 1) % corners.size()] - m_polygon.m_vertices[i];
      m_polygon.m_normals[i] = b2Cross(edge, 1.0f);
      m_polygon.m_normals[i].Normalize();
    }
  }

  CoreClass m_core = CoreClass::point;
  double m_radius = 0;
  b2Transform m_frame;
  b2CircleShape m_circle;
  b2PolygonShape m_polygon;
};

template <int D>
class Box2dPairs final : public IsolatedWitness<2> {
 public:
  using Params = PairFrameParams;
  explicit Box2dPairs(const Params& params) : IsolatedWitness<2>(params.frame) {}

  static AlgorithmInfo info() {
    return {
        .name = "box2d",
        .summary =
            "Box2D's b2Distance on cores; for overlapping shapes the deepest point of b2Collide*; single precision",
        .paper = "",
        .complexity = "GJK, or corners x faces",
        .guarantee = Guarantee::approximate,
        .failures =
            {{.when = "a polytope of more than eight corners",
              .symptom = "refused (b2_maxPolygonVertices)",
              .test = "Witnesses.Box2dRefusesNineCorners"},
             {.when = "polygons with least depths along a face of A and of B that differ by less than 5e-4 of the size",
              .symptom = "the depth along A's face is returned",
              .test = "Witnesses.Box2dPrefersFacesOfTheFirst"}},
        .role = AlgorithmRole::witness};
  }
  std::span<const ErrorBar> errorBars() const override {
    using enum ShapeKind;
    static constexpr std::array kBars = {ErrorBar{sphere, sphere, 9e-8},   ErrorBar{sphere, box, 4e-8},
                                         ErrorBar{sphere, polytope, 5e-8}, ErrorBar{box, box, 5e-8},
                                         ErrorBar{box, polytope, 7e-8},    ErrorBar{polytope, polytope, 7e-8}};
    return kBars;
  }
  bool computesInFloat() const override { return true; }

 private:
  // m, as in b2TestOverlap: nearer shapes overlap, and b2Distance gives no direction for them.
  static constexpr double kOverlap = 10 * b2_epsilon;

  void place(const PairView<2>& pair) override { m_a.place(pair.a, placeOfA()), m_b.place(pair.b, placeOfB(pair)); }

  PairAnswer<2> measure() override {
    if (!m_a.exists() || !m_b.exists()) return {};
    b2DistanceInput input;
    input.proxyA.Set(&m_a.shape(), 0), input.proxyB.Set(&m_b.shape(), 0);
    input.transformA = m_a.frame(), input.transformB = m_b.frame();
    input.useRadii = false;
    b2SimplexCache cold;
    cold.count = 0;
    b2DistanceOutput nearest;
    b2Distance(&nearest, &cold, &input);
    const double radiiOfBox2d = m_a.radius() - m_a.rounding() + m_b.radius() - m_b.rounding();
    if (nearest.distance <= radiiOfBox2d + kOverlap) return overlap();
    const Eigen::Vector2d onA = vectorOf(nearest.pointA), onB = vectorOf(nearest.pointB);
    return depthAnswer<2>(-nearest.distance, (onB - onA).normalized(), (onA + onB) / 2, m_a.radius(), m_b.radius());
  }

  PairAnswer<2> overlap() const {
    // Box2D takes the polygon first.
    const bool swapped = m_a.isCircle() && !m_b.isCircle();
    const Box2dPlaced &first = swapped ? m_b : m_a, &second = swapped ? m_a : m_b;
    b2Manifold manifold;
    manifold.pointCount = 0;
    if (first.isCircle()) {
      b2CollideCircles(&manifold, &first.circle(), first.frame(), &second.circle(), second.frame());
    } else if (second.isCircle()) {
      b2CollidePolygonAndCircle(&manifold, &first.polygon(), first.frame(), &second.circle(), second.frame());
    } else {
      b2CollidePolygons(&manifold, &first.polygon(), first.frame(), &second.polygon(), second.frame());
    }
    if (manifold.pointCount == 0) {  // b2TestOverlap reports an overlap, but no function its depth
      PairAnswer<2> answer;
      answer.status = QueryStatus::degenerate, answer.distance = -std::numeric_limits<Real>::min();
      return answer;
    }
    b2WorldManifold world;
    world.Initialize(&manifold, first.frame(), first.shape().m_radius, second.frame(), second.shape().m_radius);
    const int deepest = manifold.pointCount == 2 && world.separations[1] < world.separations[0] ? 1 : 0;
    const Eigen::Vector2d normal = vectorOf(world.normal).normalized();
    return depthAnswer<2>(-world.separations[deepest], swapped ? Eigen::Vector2d(-normal) : normal,
                          vectorOf(world.points[deepest]), m_a.rounding(), m_b.rounding());
  }

  Snippet snippet(const PairView<2>& pair) const override {
    for (const ShapeView<2>* s : {&pair.a, &pair.b}) {
      if (s->hull && s->hull->vertices.size() > b2_maxPolygonVertices) return {};
    }
    Snippet out{
        .flags = "-lbox2d",
        .head = "#include <box2d/b2_distance.h>\n#include <box2d/box2d.h>\n#include <cmath>\n#include <cstdio>\n"};
    const bool isCircleA = pair.a.core() == CoreClass::point, isCircleB = pair.b.core() == CoreClass::point;
    double radii = 0;  // radii supported by Box2D
    for (const ShapeView<2>* s : {&pair.a, &pair.b}) {
      (s->core() == CoreClass::point ? radii : out.rounding) += static_cast<double>(s->radius);
    }
    const std::string first = isCircleA && !isCircleB ? "b" : "a", second = first == "a" ? "b" : "a";
    const std::string collide = !isCircleA && !isCircleB ? "b2CollidePolygons"
                                : isCircleA && isCircleB ? "b2CollideCircles"
                                                         : "b2CollidePolygonAndCircle";
    out.body = placed("a", pair.a, placeOfA()) + placed("b", pair.b, placeOfB(pair)) +
               "  b2DistanceInput input;\n"
               "  input.proxyA.Set(&a, 0), input.proxyB.Set(&b, 0);\n"
               "  input.transformA = xf_a, input.transformB = xf_b;\n"
               "  input.useRadii = false;\n"
               "  b2SimplexCache cold;\n"
               "  cold.count = 0;\n"
               "  b2DistanceOutput nearest;\n"
               "  b2Distance(&nearest, &cold, &input);\n"
               "  const double radii = " +
               literal(radii) +
               ";\n"
               "  double distance = nearest.distance - radii;\n"
               "  if (nearest.distance <= radii + 10 * b2_epsilon) {  // as in b2TestOverlap\n"
               "    b2Manifold manifold;\n"
               "    manifold.pointCount = 0;\n"
               "    " +
               collide + "(&manifold, &" + first + ", xf_" + first + ", &" + second + ", xf_" + second +
               ");\n"
               "    b2WorldManifold world;\n"
               "    world.Initialize(&manifold, xf_" +
               first + ", " + first + ".m_radius, xf_" + second + ", " + second +
               ".m_radius);\n"
               "    const int deepest = manifold.pointCount == 2 && world.separations[1] < world.separations[0];\n"
               "    distance = manifold.pointCount ? world.separations[deepest] : -INFINITY;  // infinite: no depth\n"
               "    if (manifold.pointCount && !std::isfinite(world.normal.x + world.normal.y)) distance = NAN;\n"
               "  }\n";
    return out;
  }
  // The same as Box2dPlaced.
  static std::string placed(const std::string& name, const ShapeView<2>& shape, const Pose<2>& X) {
    std::string out = shape.core() == CoreClass::point
                          ? "  b2CircleShape " + name + ";\n  " + name + ".m_radius = " + rounded(shape.radius) + ";\n"
                          : "  b2PolygonShape " + name + ";\n  " + name + ".m_radius = 0;\n";
    if (shape.core() == CoreClass::box) {
      out += "  " + name + ".SetAsBox(" + rounded(shape.half[0]) + ", " + rounded(shape.half[1]) + ");\n";
    } else if (shape.core() == CoreClass::hull) {
      std::string corners;
      for (const Vec<2>& v : shape.hull->vertices) {
        corners += (corners.empty() ? "{" : ", {") + rounded(v[0]) + ", " + rounded(v[1]) + "}";
      }
      const std::string all = "corners_" + name, n = std::to_string(shape.hull->vertices.size());
      out += "  const b2Vec2 " + all + "[" + n + "] = {" + corners + "};\n" + "  " + name + ".m_count = " + n +
             ";  // Set would merge corners within 2.5 mm\n" + "  for (int i = 0; i < " + n + "; ++i) {\n" + "    " +
             name + ".m_vertices[i] = " + all + "[i];\n" + "    " + name + ".m_normals[i] = b2Cross(" + all +
             "[(i + 1) % " + n + "] - " + all + "[i], 1.0f);\n" + "    " + name + ".m_normals[i].Normalize();\n  }\n";
    }
    const std::string frame = "xf_" + name;
    return out + "  b2Transform " + frame + ";\n  " + frame + ".p.Set(" + rounded(X.p[0]) + ", " + rounded(X.p[1]) +
           ");\n  " + frame + ".q.c = " + rounded(X.q.c) + ", " + frame + ".q.s = " + rounded(X.q.s) + ";\n";
  }
  // The float that Box2D gets.
  static std::string rounded(Real x) { return literal(static_cast<double>(static_cast<float>(x))); }

  Box2dPlaced m_a, m_b;
};

}  // namespace

LPC_REGISTER(PairQuery, Box2dPairs, 2);

}}  // namespace lpc::LPC_PRECISION
