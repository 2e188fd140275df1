// SPDX-License-Identifier: Zlib
#include "framework/stage/stage_narrowphase.h"

#include <optional>

#include "framework/math/names.h"

namespace lpc { inline namespace LPC_PRECISION {

std::string_view queryStatusName(QueryStatus status) {
  constexpr IndexedArray<std::string_view, 5> kNames = {"converged", "iteration_limit", "degenerate", "refused",
                                                        "failed"};
  return kNames[status];
}

template <int D>
PairAnswer<D> queryPair(PairQuery<D>& method, const ShapeView<D>& a, const ShapeView<D>& b, const Pose<D>& X_AB,
                        QueryNeed need) {
  const bool swapped = a.kind > b.kind;
  const ShapeView<D>&first = swapped ? b : a, &second = swapped ? a : b;
  if (!method.supports(first.kind, second.kind)) return {};
  const PairView<D> pair{first, second, swapped ? X_AB.inverse() : X_AB};
  PairAnswer<D> answer;
  WorkDone work;
  method.query({&pair, 1}, need, {&answer, 1}, {}, work);
  if (!swapped) return answer;
  // The method took B as its first shape and answered in B's frame.
  PairAnswer<D> mapped = answer;
  mapped.normal = X_AB.q * Vec<D>(-answer.normal);
  mapped.pA = X_AB * answer.pB;
  mapped.pB = X_AB * answer.pA;
  return mapped;
}

template <int D>
std::span<const ConvexPair<D>> PartPairs<D>::of(std::span<const ShapePair> pairs,
                                                IndexedSpan<const ShapeRecord<D>> shapes,
                                                IndexedSpan<const Pose<D>> pose, Real margin, WorkDone& work) {
  m_pairs.clear();
  for (const ShapePair& p : pairs) {
    const ShapeRecord<D>&a = shapes[p.a], &b = shapes[p.b];
    if (a.shape.convex() && b.shape.convex()) {
      m_pairs.push_back({p, 0, 0, a.shape.view(), b.shape.view(), a.X_CS, b.X_CS});
      continue;
    }
    const Pose<D>&X_WA = pose[a.body], &X_WB = pose[b.body];
    if (a.shape.surface() || b.shape.surface()) {
      ofSurface(p, a, b, X_WA, X_WB, margin, work);
      continue;
    }
    // A plane has no box: test the other shape's box against the plane.
    const auto near = [&](const Aabb<D>& boxA, const Aabb<D>& boxB) {
      ++work[WorkCount::partTests];
      if (a.shape.isPlane()) return overlapsBox(a.shape.view(), X_WA * a.X_CS, boxB.grown(margin));
      if (b.shape.isPlane()) return overlapsBox(b.shape.view(), X_WB * b.X_CS, boxA.grown(margin));
      return boxA.grown(margin).overlaps(boxB);
    };
    m_boxes.clear();
    Aabb<D> whole;
    forParts(b.shape, b.X_CS, [&](const ShapeView<D>& part, const Pose<D>& X_CB) {
      m_boxes.push_back(boundingBox(part, X_WB * X_CB));
      whole = whole.merged(m_boxes.back());
    });
    std::int32_t partA = -1;
    forParts(a.shape, a.X_CS, [&](const ShapeView<D>& viewA, const Pose<D>& X_CA) {
      ++partA;
      const Aabb<D> boxA = boundingBox(viewA, X_WA * X_CA);
      if (!near(boxA, whole)) return;
      std::int32_t partB = -1;
      forParts(b.shape, b.X_CS, [&](const ShapeView<D>& viewB, const Pose<D>& X_CB) {
        ++partB;
        if (!near(boxA, m_boxes[partB])) return;
        m_pairs.push_back({p, partA, partB, viewA, viewB, X_CA, X_CB});
      });
    });
  }
  return m_pairs;
}

// Both are bounded, and one has few parts: a moving shape is never a surface.
template <int D>
void PartPairs<D>::ofSurface(const ShapePair& p, const ShapeRecord<D>& a, const ShapeRecord<D>& b, const Pose<D>& X_WA,
                             const Pose<D>& X_WB, Real margin, WorkDone& work) {
  const auto forNear = [&](const ShapeRecord<D>& of, const Pose<D>& X_WC, const Aabb<D>& box, const auto& f) {
    forPartsNear(of.shape, of.X_CS, X_WC, box, m_near, work,
                 [&](std::int32_t number, const ShapeView<D>& part, const Pose<D>& X_CP) {
                   ++work[WorkCount::partTests];
                   if (box.overlaps(boundingBox(part, X_WC * X_CP))) f(number, part, X_CP);
                 });
  };
  if (b.shape.surface()) {
    std::int32_t partA = 0;
    forParts(a.shape, a.X_CS, [&](const ShapeView<D>& viewA, const Pose<D>& X_CA) {
      forNear(b, X_WB, boundingBox(viewA, X_WA * X_CA).grown(margin),
              [&](std::int32_t partB, const ShapeView<D>& viewB, const Pose<D>& X_CB) {
                m_pairs.push_back({p, partA, partB, viewA, viewB, X_CA, X_CB});
              });
      ++partA;
    });
    return;
  }
  m_boxes.clear();
  Aabb<D> whole;
  forParts(b.shape, b.X_CS, [&](const ShapeView<D>& part, const Pose<D>& X_CB) {
    m_boxes.push_back(boundingBox(part, X_WB * X_CB).grown(margin));
    whole = whole.merged(m_boxes.back());
  });
  forNear(a, X_WA, whole, [&](std::int32_t partA, const ShapeView<D>& viewA, const Pose<D>& X_CA) {
    const Aabb<D> boxA = boundingBox(viewA, X_WA * X_CA);
    std::int32_t partB = -1;
    forParts(b.shape, b.X_CS, [&](const ShapeView<D>& viewB, const Pose<D>& X_CB) {
      ++partB, ++work[WorkCount::partTests];
      if (!boxA.overlaps(m_boxes[partB])) return;
      m_pairs.push_back({p, partA, partB, viewA, viewB, X_CA, X_CB});
    });
  });
}

template <int D>
void markKinds(const Shape<D>& shape, std::array<bool, kShapeKinds>& kinds) {
  const auto mark = [&](const ShapeView<D>& v, const auto&) { kinds[static_cast<std::size_t>(v.kind)] = true; };
  if (shape.surface()) return mark(shape.surfaceParts()[0].view, 0);  // all parts are of one kind
  forParts(shape, Pose<D>{}, mark);
}

namespace {

// The first unsupported pair of these kinds.
std::optional<std::pair<ShapeKind, ShapeKind>> unsupported(const PairSupport& supports,
                                                           const std::array<bool, kShapeKinds>& kinds) {
  for (std::size_t i = 0; i < kShapeKinds; ++i) {
    for (std::size_t k = i; k < kShapeKinds; ++k) {
      const auto a = static_cast<ShapeKind>(i), b = static_cast<ShapeKind>(k);
      const bool planes = coreClass(a) == CoreClass::plane && coreClass(b) == CoreClass::plane;
      if (kinds[i] && kinds[k] && !planes && !supports(a, b)) return std::pair(a, b);
    }
  }
  return {};
}

}  // namespace

void requirePairs(const PairSupport& supports, const std::array<bool, kShapeKinds>& kinds, const std::string& subject,
                  const std::function<std::vector<std::pair<std::string, PairSupport>>()>& others) {
  const auto lacks = unsupported(supports, kinds);
  if (!lacks) return;
  std::vector<std::string> valid;
  for (const auto& [name, support] : others()) {
    if (!unsupported(support, kinds)) valid.push_back(name);
  }
  throw UserError(subject + " does not support " + std::string(shapeKindName(lacks->first)) + " against " +
                  std::string(shapeKindName(lacks->second)) + (valid.empty() ? "" : validNames(valid, "")));
}

template <int D>
void requireContacts(const ContactGenerator<D>& contacts, const std::array<bool, kShapeKinds>& kinds,
                     const std::string& subject) {
  requirePairs([&](ShapeKind a, ShapeKind b) { return contacts.supports(a, b); }, kinds, subject,
               registeredSupport<ContactGenerator<D>>);
}

template class PartPairs<2>;
template class PartPairs<3>;
template void markKinds(const Shape<2>&, std::array<bool, kShapeKinds>&);
template void markKinds(const Shape<3>&, std::array<bool, kShapeKinds>&);
template void requireContacts(const ContactGenerator<2>&, const std::array<bool, kShapeKinds>&, const std::string&);
template void requireContacts(const ContactGenerator<3>&, const std::array<bool, kShapeKinds>&, const std::string&);
template PairAnswer<2> queryPair(PairQuery<2>&, const ShapeView<2>&, const ShapeView<2>&, const Pose<2>&, QueryNeed);
template PairAnswer<3> queryPair(PairQuery<3>&, const ShapeView<3>&, const ShapeView<3>&, const Pose<3>&, QueryNeed);

}}  // namespace lpc::LPC_PRECISION
