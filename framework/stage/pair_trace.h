// SPDX-License-Identifier: Zlib
// Records the steps of a pair query. The query itself writes the record (PairQuery::trace); an ordinary query does not
// record and has no extra cost.
//
// Most steps are in the space of differences of the two cores, { b - a }, in A's frame. The separation of the cores is
// the distance of this set from the origin; the cores overlap if it contains the origin. A direction n is unit and
// points from A to B. Let w be the point of the difference with the least n . w. This proves a separation of the cores
// of at least n . w; for overlapping cores n . w is minus a depth. Radii are not part of the cores.
#pragma once

#include <optional>

#include "framework/math/indexed.h"
#include "framework/stage/stage_narrowphase.h"

namespace lpc { inline namespace LPC_PRECISION {

enum class TraceKind {
  support,    // GJK computes a support point
  nearest,    // GJK has finished
  expansion,  // EPA computes a support point
  axis,       // an axis is projected
  refined,    // the best axis after steps that are not recorded
  answer
};

template <int D>
struct TraceStep {
  TraceKind kind = TraceKind::answer;
  std::string words;

  // The state of the search: GJK's simplex or EPA's polytope, in the space of differences.
  IndexedVector<Vec<D>> corners;
  std::vector<IndexedArray<int, D>> faces;  // of EPA, by indices of corners
  int face = -1;                            // its normal is the next direction
  std::optional<Vec<D>> nearest;            // point of the simplex nearest to the origin

  // The support direction; zero when there is none.
  Vec<D> direction = Vec<D>::Zero();
  Vec<D> support = Vec<D>::Zero();                        // w = supportB - supportA
  Vec<D> supportA = Vec<D>::Zero(), supportB = supportA;  // of the cores, in A's frame; in the answer the closest
                                                          // points
  std::vector<Vec<D>> featureA, featureB;                 // all support vertices at the same distance, in A's frame
  Real bound = -std::numeric_limits<Real>::infinity();    // m, the proved lower bound; in the answer the separation of
                                                          // the shapes
  bool atMost = false;                                    // the search skipped the rest, so the bound may be smaller

  // The best axis after this step (m, unit); minus infinity: none yet.
  Real best = -std::numeric_limits<Real>::infinity();
  Vec<D> bestAxis = Vec<D>::Zero();
};

template <int D>
struct PairTrace {
  PairView<D> pair;                 // as the query gets it: kind of A <= kind of B. Does not own hulls
  bool swapped = false;             // A is the second shape of the caller
  std::vector<TraceStep<D>> steps;  // the last one is the answer
  PairAnswer<D> answer;             // in the frame of this A
  WorkDone work;
};

/// Traces a pair, in any order of kinds, with the pair query of this spec ("gjk_epa{simplex=johnson}"). Throws
/// UserError when the query does not support the kinds or cannot record its steps; the message lists the methods that
/// can.
template <int D>
PairTrace<D> tracePair(std::string_view query, const ShapeView<D>& a, const ShapeView<D>& b, const Pose<D>& X_AB);

/// One line of text, without newline.
template <int D>
std::string describe(const TraceStep<D>& step);
/// One line for each step, numbered from 0.
template <int D>
std::string describe(const PairTrace<D>& trace);

template <int D>
class DebugDraw;

/// Draws a step in the space of differences; a cross marks the origin. Grey: the difference, as an outline in 2D, as
/// points in 3D. Blue: the simplex or EPA's polytope, and its point nearest to the origin. Yellow: the direction with
/// the length of its bound, the support point, and the line or plane through it. Green: the best axis so far.
template <int D>
void drawTrace(const PairTrace<D>& trace, std::size_t step, DebugDraw<D>& draw);
/// Draws the same step on the shapes, with A of the trace at X_WA. Yellow: the support features, and between them the
/// direction with the length of its bound. Blue: the corners of the simplex on both shapes, and the two points whose
/// difference is the nearest point.
template <int D>
void drawTraceOnShapes(const PairTrace<D>& trace, std::size_t step, const Pose<D>& X_WA, DebugDraw<D>& draw);

}}  // namespace lpc::LPC_PRECISION
