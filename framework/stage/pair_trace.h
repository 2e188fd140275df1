// SPDX-License-Identifier: Zlib
// What a pair query does, step by step, as it does it: the query writes it down itself (PairQuery::trace). Who wants to
// see it pays; a query that is asked for an answer writes nothing.
//
// Most of it is in the space of differences of the two cores, { b - a }, in A's frame: the cores are apart by its
// distance from the origin, and overlap if it holds the origin. A direction n is unit and points from A to B. What it
// proves is that the cores are apart by n . w at least, w being the point of the difference that lies least far along
// it; of cores that overlap this is minus a depth. Radii are not part of the cores.
#pragma once

#include <optional>

#include "framework/math/indexed.h"
#include "framework/stage/stage_narrowphase.h"

namespace lpc { inline namespace LPC_PRECISION {

enum class TraceKind {
  support,    // GJK asks for a support point
  nearest,    // GJK is at its end
  expansion,  // EPA asks for one
  axis,       // an axis is projected
  refined,    // the best axis after steps that are not shown
  answer
};

template <int D>
struct TraceStep {
  TraceKind kind = TraceKind::answer;
  std::string words;

  // What the search stands on: GJK's simplex, EPA's polytope. In the space of differences.
  IndexedVector<Vec<D>> corners;
  std::vector<IndexedArray<int, D>> faces;  // EPA's, by numbers of corners
  int face = -1;                            // whose normal is asked
  std::optional<Vec<D>> nearest;            // of the simplex to the origin

  // What is asked: zero where nothing is.
  Vec<D> direction = Vec<D>::Zero();
  Vec<D> support = Vec<D>::Zero();                        // w = supportB - supportA
  Vec<D> supportA = Vec<D>::Zero(), supportB = supportA;  // of the cores, in A's frame; of the answer the witnesses
  std::vector<Vec<D>> featureA, featureB;                 // all vertices that lie as far, in A's frame
  Real bound = -std::numeric_limits<Real>::infinity();    // m, what it proves; of the answer the shapes' distance
  bool atMost = false;                                    // it proves no more than that: the rest was not looked at

  // The best after it (m, unit); minus infinity: none yet.
  Real best = -std::numeric_limits<Real>::infinity();
  Vec<D> bestAxis = Vec<D>::Zero();
};

template <int D>
struct PairTrace {
  PairView<D> pair;                 // as the query sees it: kind of A <= kind of B. It holds no hull of its own
  bool swapped = false;             // its A is the shape that was named second
  std::vector<TraceStep<D>> steps;  // the last one is the answer
  PairAnswer<D> answer;             // in the frame of this A
  WorkDone work;
};

/// A pair, in any order of kinds, by the query with this text ("gjk_epa{simplex=johnson}"). Throws UserError when it
/// does not support the kinds or cannot show its steps, naming the methods that can.
template <int D>
PairTrace<D> tracePair(std::string_view query, const ShapeView<D>& a, const ShapeView<D>& b, const Pose<D>& X_AB);

/// A line without an end.
template <int D>
std::string describe(const TraceStep<D>& step);
/// A line for each step, numbered from 0.
template <int D>
std::string describe(const PairTrace<D>& trace);

template <int D>
class DebugDraw;

/// A step in the space of differences, where the origin is marked with a cross. Grey: the difference itself, a line
/// around it in 2D, points in 3D. Blue: the simplex, or EPA's polytope, and its nearest point. Yellow: the direction,
/// as long as what it proves, the support point, and the line or plane across it there. Green: the best so far.
template <int D>
void drawTrace(const PairTrace<D>& trace, std::size_t step, DebugDraw<D>& draw);
/// The same step on the shapes, A of the trace being at X_WA. Yellow: the features that are farthest along the
/// direction, and from one to the other the direction, as long as what it proves. Blue: the corners of the simplex on
/// both, and the points whose difference is its nearest point.
template <int D>
void drawTraceOnShapes(const PairTrace<D>& trace, std::size_t step, const Pose<D>& X_WA, DebugDraw<D>& draw);

}}  // namespace lpc::LPC_PRECISION
