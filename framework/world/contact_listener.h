// SPDX-License-Identifier: Zlib
#pragma once

#include "framework/problem/contact.h"

namespace lpc { inline namespace LPC_PRECISION {

template <int D>
class World;

/// What a contact's solver is told of the two materials.
struct PairMaterial {
  Real friction = 0, restitution = 0;
};

/// Is told about contacts, before the solver, in the order of the manifolds. A pair begins in the first step in which
/// it has contact points and ends in the first without. Where a stage has contacts made again within a step
/// (`DetectAgain`), those that begin or end are told of then, with the bodies where they are at that moment. Pairs of
/// sleeping bodies keep silent. A pair is one of shapes: where shapes have several convex parts, it is told of once,
/// with its first manifold; the others follow that one. While it hears, the world must not be changed, nor its
/// listeners.
template <int D>
class ContactListener {
 public:
  virtual ~ContactListener() = default;
  /// May change the material of this pair for this step, before begin or persist is told. It comes as the two shapes
  /// and the world's mixing rules make it, whatever was changed in the step before.
  virtual void mix(const World<D>&, const Manifold<D>&, PairMaterial&) {}
  /// False: the contact is kept, and reported again next step, but not solved (a veto, for this step).
  virtual bool begin(const World<D>&, const Manifold<D>&) { return true; }
  virtual bool persist(const World<D>&, const Manifold<D>&) { return true; }
  /// `last` is the manifold of the step before. Its bodies are still there, also when one is just being removed.
  virtual void end(const World<D>&, const Manifold<D>& /*last*/) {}
};

}}  // namespace lpc::LPC_PRECISION
