// SPDX-License-Identifier: Zlib
// Sweeps over contact blocks (contact_blocks.h) with the widest registers of this processor; Highway chooses at run
// time. Every width gives the same bits: no fused multiply-adds, and sums in the order in which Eigen sums.
#pragma once

#include "algorithms/solver/lanes/contact_blocks.h"
#include "algorithms/solver/rows/joint_rows.h"

namespace lpc { inline namespace LPC_PRECISION { namespace solver {

struct BlockSweep {
  Feedback contact = {}, contactFixed = {};  // contactFixed: one body cannot move
  Real slop = 0, maxSpeed = 0;               // m, m/s
  Real h = 0;                                // s
  bool softGaps = false;                     // springs also act on contacts that are still apart
  bool targets = false;                      // the goal of a point is its least normal velocity, not its separation
  bool rotation = true;
};

/// Updates each normal impulse of each manifold once, then its friction: solveFrictionAt() in lanes.
void sweepBlocks(ContactBlocks<2>& blocks, const BlockSweep& law);
void sweepBlocks(ContactBlocks<3>& blocks, const BlockSweep& law);
/// Sets all numbers of the manifolds: rows with one arm to the middle between the anchors, at the poses (of absolute
/// position) in blocks.pose; goals are separations, impulses the stored ones times `warmStart`, and other sums 0.
/// `manifolds`: those given to arrange().
void prepareBlocks(ContactBlocks<2>& blocks, IndexedSpan<const Manifold<2>> manifolds, Real warmStart);
void prepareBlocks(ContactBlocks<3>& blocks, IndexedSpan<const Manifold<3>> manifolds, Real warmStart);
/// Applies the accumulated impulses.
void applyBlocks(ContactBlocks<2>& blocks, bool rotation);
void applyBlocks(ContactBlocks<3>& blocks, bool rotation);
/// Sets number `field` of each point to its normal velocity, m/s.
void velocityBlocks(ContactBlocks<2>& blocks, int field, bool rotation);
void velocityBlocks(ContactBlocks<3>& blocks, int field, bool rotation);
/// Sets the goals to the separations at the poses in blocks.pose, m.
void measureBlocks(ContactBlocks<2>& blocks);
void measureBlocks(ContactBlocks<3>& blocks);

}}}  // namespace lpc::LPC_PRECISION::solver
