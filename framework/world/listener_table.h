// SPDX-License-Identifier: Zlib
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "framework/stage/stage_sleep.h"
#include "framework/world/body_table.h"
#include "framework/world/contact_listener.h"
#include "framework/world/past_pair.h"

namespace lpc { inline namespace LPC_PRECISION {

/// The contacts of this step and of the last step, all sorted by key.
template <int D>
struct StepContacts {
  std::span<Manifold<D>> now;
  std::span<const PastPair> before;   // may leave out resting pairs
  std::span<const Manifold<D>> past;  // of `before`, at least of the pairs that are not in `now`
  Real sinceBefore = 0;  // s, from the detection of `before` to this step; 0 in the first step; unused if `again`
  bool again = false;    // contacts are made again within the step
};

/// Stores the listeners for all bodies and the listeners for single bodies.
template <int D>
class ListenerTable {
 public:
  void add(ContactListener<D>* listener);                    // throws UserError for null
  void add(std::size_t body, ContactListener<D>* listener);  // as above
  bool isOf(std::int32_t slot, const ContactListener<D>* listener) const;
  void remove(ContactListener<D>* listener);
  void forget(std::size_t body);
  void forgetBodies() { m_ofBodies.clear(); }

  /// Calls f(listener) once for each listener of this contact. The order is: listeners of all bodies, then those of
  /// body A, then those of body B.
  template <class F>
  void forEach(const Manifold<D>& m, const F& f) const;

  /// Calls mix(), then reports contacts that begin, persist and end. Writes the listeners' answers into the manifolds.
  /// Adds sleep events: for sleeping bodies, and for awake ones with a deep contact that opens. `world` is passed to
  /// the listeners.
  void notify(const World<D>& world, BodyTable<D>& table, const StepContacts<D>& news) const;

 private:
  bool anyFor(const Manifold<D>& m) const;

  std::vector<ContactListener<D>*> m_all;
  std::vector<std::vector<ContactListener<D>*>> m_ofBodies;  // by body slot; may be shorter than the body table
};

template <int D>
template <class F>
void ListenerTable<D>::forEach(const Manifold<D>& m, const F& f) const {
  for (ContactListener<D>* l : m_all) f(*l);
  const auto of = [&](std::int32_t body) {
    const auto i = static_cast<std::size_t>(body);
    return i < m_ofBodies.size() ? std::span<ContactListener<D>* const>(m_ofBodies[i])
                                 : std::span<ContactListener<D>* const>();
  };
  const auto among = [](std::span<ContactListener<D>* const> list, const ContactListener<D>* l) {
    return std::find(list.begin(), list.end(), l) != list.end();
  };
  for (ContactListener<D>* l : of(m.bodyA)) {
    if (!among(m_all, l)) f(*l);
  }
  for (ContactListener<D>* l : of(m.bodyB)) {
    if (!among(m_all, l) && !among(of(m.bodyA), l)) f(*l);
  }
}

}}  // namespace lpc::LPC_PRECISION
