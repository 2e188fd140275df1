// SPDX-License-Identifier: Zlib
// Records the steps of a search (watch.h).
#pragma once

#include <string>

#include "algorithms/pair_query/core/touching.h"
#include "algorithms/pair_query/gjk/gjk_simplex2.h"
#include "framework/stage/pair_trace.h"

namespace lpc { inline namespace LPC_PRECISION { namespace pair_query {

template <int D>
class Tracer {
 public:
  explicit Tracer(PairTrace<D>& out) : m_out(&out) {}
  template <class F>
  void operator()(F&& f) const {
    f(*this);
  }

  static std::string part(const char* what, std::size_t number, bool ofA) {
    return std::string(what) + " " + std::to_string(number) + (ofA ? " of A" : " of B");
  }
  static std::string part(const char* what, int number, bool ofA) {
    return part(what, static_cast<std::size_t>(number), ofA);
  }

  /// An axis was projected; `all`: over all relevant vertices, otherwise the bound is only an upper bound.
  void axis(const CorePair<D>& pair, const Vec<D>& n, Real bound, const BestAxis<D>& best, std::string words,
            bool all = true) const {
    TraceStep<D>& step = add(TraceKind::axis, std::move(words), best);
    ask(pair, n, bound, step);
    step.support = step.supportB - step.supportA;
    step.atMost = !all;
  }

  /// GJK queried w, the support point of the difference against n.
  void support(const CorePair<D>& pair, const NearestFeature<D>& nearest, const Vec<D>& n, const Vec<D>& w, Real bound,
               const BestAxis<D>& best) const {
    TraceStep<D>& step = add(TraceKind::support, "GJK", best);
    show(nearest.feature, step);
    if (nearest.feature.count > 0) step.nearest = nearest.v;
    ask(pair, n, bound, step);
    step.support = w;
  }
  /// GJK's last simplex.
  void nearest(const Simplex<D>& simplex, bool inside, const Vec<D>& v, const BestAxis<D>& best) const {
    TraceStep<D>& step = add(TraceKind::nearest, inside ? "GJK holds the origin" : "GJK gets no nearer", best);
    show(simplex, step);
    if (!inside) step.nearest = v;
  }

  /// EPA queried w; the caller adds the polytope.
  TraceStep<D>& expansion(const CorePair<D>& pair, const Vec<D>& n, const Vec<D>& w, const BestAxis<D>& best,
                          bool ofFace) const {
    TraceStep<D>& step = add(TraceKind::expansion, ofFace ? "EPA" : "EPA's first corners", best);
    ask(pair, n, n.dot(w), step);
    step.support = w;
    return step;
  }

  /// The best axis may have changed by steps that are not recorded one by one.
  void refined(const CorePair<D>& pair, const BestAxis<D>& best, const char* words) const {
    const auto& steps = m_out->steps;
    if (!steps.empty() && steps.back().best == best.bound && steps.back().bestAxis == best.n) return;
    TraceStep<D>& step = add(TraceKind::refined, words, best);
    ask(pair, best.n, best.bound, step);
    step.support = step.supportB - step.supportA;
  }

 private:
  TraceStep<D>& add(TraceKind kind, std::string words, const BestAxis<D>& best) const {
    TraceStep<D>& step = m_out->steps.emplace_back();
    step.kind = kind, step.words = std::move(words), step.best = best.bound, step.bestAxis = best.n;
    return step;
  }
  static void show(const Simplex<D>& simplex, TraceStep<D>& step) {
    for (int i = 0; i < simplex.count; ++i) step.corners.push_back(simplex[i]);
  }
  // In A's frame, by brute force: a climb would change the start of the next one.
  static void ask(const CorePair<D>& pair, const Vec<D>& n, Real bound, TraceStep<D>& step) {
    const Vec<D> back = -(pair.r.transpose() * n);
    step.direction = n, step.bound = bound;
    step.supportA = farthest(pair.a, n), step.supportB = pair.p + pair.r * farthest(pair.b, back);
    WorkDone ofLooking;  // not counted as the search's work
    supportingVertices<D>(pair.a, n, kFeatureBand * pair.scale, step.featureA, ofLooking);
    supportingVertices<D>(pair.b, back, kFeatureBand * pair.scale, step.featureB, ofLooking);
    for (Vec<D>& v : step.featureB) v = pair.p + pair.r * v;
  }

  PairTrace<D>* m_out;
};

}}}  // namespace lpc::LPC_PRECISION::pair_query
