// SPDX-License-Identifier: Zlib
// Runs a 3D library on 2D pairs. Each shape becomes a prism along z, longer than both shapes are wide. So the signed
// distance is that of the 2D shapes, along a normal without z. B's prism is longer than A's: between the same two
// planes Bullet reports one in six overlapping pairs of sharp shapes as separated. A circle becomes a capsule along z,
// and a capsule's core a sheet: no new kinds are needed.
#pragma once

#include <deque>

#include "oracles/witnesses/witness_process.h"

namespace lpc { inline namespace LPC_PRECISION {

/// `Solid` is an IsolatedWitness<3>. The derived class has the table of error bars in 2D.
template <class Solid>
class Prisms : public Witness<2> {
 public:
  using Params = typename Solid::Params;
  explicit Prisms(const Params& params) : m_solid(params) {}
  static AlgorithmInfo info() { return Solid::info(); }
  bool claimsGap(ShapeKind a, ShapeKind b) const final { return m_solid.claimsGap(a, b); }

  std::span<const Ending> endings() const final { return m_solid.endings(); }
  std::int64_t nanoseconds() const final { return m_solid.nanoseconds(); }
  std::optional<Question> question(const PairView<2>& pair) final {
    m_hulls.clear();
    std::optional<Question> asked = m_solid.question(prisms(pair));
    if (asked) {
      asked->snippet.head =
          "// A 2D case: both shapes are extruded along z, much farther than they overlap.\n" + asked->snippet.head;
    }
    return asked;
  }

  void query(std::span<const PairView<2>> pairs, QueryNeed, std::span<PairAnswer<2>> answers, std::span<PairMemory>,
             WorkDone& work) final {
    work[WorkCount::pairQueries] += pairs.size();
    m_hulls.clear(), m_pairs.clear();
    for (const PairView<2>& pair : pairs) m_pairs.push_back(prisms(pair));
    m_answers.resize(m_pairs.size());
    m_solid.ask(m_pairs, m_answers);
    for (std::size_t i = 0; i < pairs.size(); ++i) answers[i] = flat(m_answers[i], pairs[i].a.kind);
  }

 private:
  PairView<3> prisms(const PairView<2>& pair) {
    const Real height = extent(pair.a) + extent(pair.b);  // half the height: the overlap along z is never the least
    const Pose<3> X_AB{{pair.X_AB.p[0], pair.X_AB.p[1], 0}, aboutZ(pair.X_AB.q)};
    return {prism(pair.a, height), prism(pair.b, Real(1.375) * height),
            upright(pair.a.kind).inverse() * X_AB * upright(pair.b.kind)};
  }

  static Real extent(const ShapeView<2>& shape) {
    const Aabb<2> box = boundingBox(shape, Pose<2>{});
    return (box.hi - box.lo).norm();
  }
  // Circles become capsules; capsules lie along x, so rotate them to z.
  static Pose<3> upright(ShapeKind kind) {
    const Real half = std::sqrt(Real(0.5));
    return {Vec<3>::Zero(), kind == ShapeKind::sphere ? Rot<3>{half, 0, -half, 0} : Rot<3>{}};
  }
  static Rot<3> aboutZ(const Rot<2>& q) {
    if (q.c >= 0) return Rot<3>{1 + q.c, 0, 0, q.s}.normalized();
    return Rot<3>{q.s, 0, 0, 1 - q.c}.normalized();  // the other formula is 0 / 0 at half a turn
  }

  ShapeView<3> prism(const ShapeView<2>& shape, Real height) {
    ShapeView<3> out;
    out.radius = shape.radius, out.half = {shape.half[0], shape.half[1], height};
    switch (shape.core()) {
      case CoreClass::point:
        out.kind = ShapeKind::capsule, out.half = {height, 0, 0};
        break;
      case CoreClass::segment:
        out.kind = ShapeKind::box, out.half[1] = 0;
        break;
      case CoreClass::box:
        out.kind = ShapeKind::box;
        break;
      case CoreClass::hull:
        out.kind = ShapeKind::polytope, out.hull = &m_hulls.emplace_back(prism(*shape.hull, height));
        break;
      case CoreClass::curved:
      case CoreClass::plane:
        LPC_ASSERT(false);  // has no error bar in 2D, so it is never used
        break;
    }
    return out;
  }
  static Polytope<3> prism(const Polytope<2>& hull, Real height) {
    Polytope<3> out;
    const int n = static_cast<int>(hull.vertices.size());
    for (const Real z : {-height, height}) {
      for (const Vec<2>& v : hull.vertices) out.vertices.emplace_back(v[0], v[1], z);
    }
    const auto addFace = [&](const Vec<3>& normal, std::initializer_list<int> corners) {
      const int begin = static_cast<int>(out.loop.size());
      out.loop.insert(out.loop.end(), corners);
      out.faces.push_back({normal, normal.dot(out.vertices[static_cast<std::size_t>(out.loop.back())]), begin,
                           static_cast<int>(out.loop.size())});
    };
    for (int i = 0; i < n; ++i) {
      const Vec<2>& normal = hull.normals[static_cast<std::size_t>(i)];
      addFace({normal[0], normal[1], 0}, {i, (i + 1) % n, (i + 1) % n + n, i + n});
    }
    for (const Real side : {Real(-1), Real(1)}) {
      const int begin = static_cast<int>(out.loop.size());
      for (int i = 0; i < n; ++i) out.loop.push_back(side < 0 ? n - 1 - i : n + i);
      out.faces.push_back({{0, 0, side}, height, begin, begin + n});
    }
    return out;
  }

  PairAnswer<2> flat(const PairAnswer<3>& answer, ShapeKind kindA) const {
    const auto inPlane = [turn = upright(kindA).q](const Vec<3>& v) { return Vec<2>((turn * v).template head<2>()); };
    PairAnswer<2> out;
    out.status = answer.status, out.distance = answer.distance;
    out.normal = inPlane(answer.normal).normalized(), out.pA = inPlane(answer.pA), out.pB = inPlane(answer.pB);
    return out;
  }

  Solid m_solid;
  std::deque<Polytope<3>> m_hulls;  // views point into it
  std::vector<PairView<3>> m_pairs;
  std::vector<PairAnswer<3>> m_answers;
};

}}  // namespace lpc::LPC_PRECISION
