// SPDX-License-Identifier: Zlib
#pragma once

#include "framework/problem/contact.h"

namespace lpc { inline namespace LPC_PRECISION {

template <int D>
class World;

/// Friction and restitution of a pair of shapes, as the solver uses them.
struct PairMaterial {
  Real friction = 0, restitution = 0;
};

/// Receives contact events before the solver runs, in the order of the manifolds. An event concerns a pair of shapes:
/// with several convex parts, the pair is reported once, with its first manifold, and the answer applies to all its
/// manifolds. A pair begins in the first step in which it has contact points, and ends in the first step without them.
/// When a solver makes contacts again within a step (`DetectAgain`), pairs that begin or end there are reported
/// immediately, at the current poses. Pairs of sleeping bodies are not reported. A callback must not change the world
/// or its listeners.
template <int D>
class ContactListener {
 public:
  virtual ~ContactListener() = default;
  /// May change the material of this pair for this step. Called before begin() or persist(). The given material follows
  /// from the two shapes and the world's mixing rules; changes made in the last step are not kept.
  virtual void mix(const World<D>&, const Manifold<D>&, PairMaterial&) {}
  /// Return false to veto the contact: in this step it is kept and reported, but not solved.
  virtual bool begin(const World<D>&, const Manifold<D>&) { return true; }
  virtual bool persist(const World<D>&, const Manifold<D>&) { return true; }
  /// `last` is the manifold of the last step. Its bodies still exist, even when one of them is about to be removed.
  virtual void end(const World<D>&, const Manifold<D>& /*last*/) {}
};

}}  // namespace lpc::LPC_PRECISION
