// SPDX-License-Identifier: Zlib
#pragma once

#include <algorithm>
#include <functional>
#include <iosfwd>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "framework/math/indexed.h"
#include "framework/math/slots.h"
#include "framework/problem/contact_graph.h"
#include "framework/problem/contact_order.h"
#include "framework/stage/spec.h"
#include "framework/stage/stage_broadphase.h"
#include "framework/stage/stage_narrowphase.h"
#include "framework/stage/stage_sleep.h"
#include "framework/world/box_index.h"
#include "framework/world/fast_parts.h"
#include "framework/world/simulation.h"

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

template <int D>
struct BodyRayHit {
  Handle body;
  std::int32_t shape;      // number among the body's shapes
  Real t;                  // of entering the shape
  Vec<D> normal;           // unit, world, out of the shape and so against the ray; zero when the ray starts inside
  std::uint64_t userData;  // the shape's
};

/// Whom a ray meets: as a shape of this category and mask would collide. Without a filter it meets every shape.
template <int D>
struct RayFilter {
  std::uint32_t category = 1;
  std::uint32_t mask = ~0u;
  /// Empty: all of these. Is asked before the shape is, in no promised order.
  std::function<bool(Handle body, const ShapeRecord<D>& shape)> accepts = {};
};

/// Bodies, joints, forces, and one algorithm of each stage. A step: boxes, pairs, cache.select, contacts, cache.carry,
/// listeners, sleep, solver. Same definitions, same calls, same build: the same bits.
template <int D>
class World final : public Simulation<D>, private DetectAgain, private Forces<D> {
 public:
  /// Throws UserError when the pipeline names an unknown algorithm or parameter.
  explicit World(const Pipeline& pipeline = {}, const WorldSettings<D>& settings = {});
  ~World() override;
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  // --- building, at any time between steps ---------------------------------------------------------------------------
  /// Throws UserError for poses, velocities or sizes that are not finite, for a dynamic body without mass, and for a
  /// shape kind that the contact generator does not support.
  Handle add(const BodyDef<D>& def) override;
  void remove(Handle body) override;
  /// Removes all bodies, joints and forces, also those by code, in time linear in their number, and sets time and step
  /// number to 0. Listeners hear of ends as of `remove`, by slot; those of the world stay, as do settings, stages and
  /// watcher. What is added then gets the slots and lives the life that it has in a new world, to the last bit; handles
  /// of before stay nobody's.
  void clear();
  JointHandle add(const JointDef<D>& def) override;
  void remove(JointHandle joint) override;
  /// Wakes those whom it acts on, as does removing it. Who falls asleep again feels it no more.
  ForceHandle add(const ForceDef<D>& def) override;
  void remove(ForceHandle force) override;
  void add(std::shared_ptr<const ForceGenerator<D>> generator) override;
  void remove(const ForceGenerator<D>* generator);
  Handle add(const ShapeDef<D>& shape) { return add(BodyDef<D>::fixed(shape)); }  // a bare shape is a fixed body
  /// Of all contacts, or of those of one body alone. Not owned. Who is registered twice for a pair is told once; the
  /// world's listeners come first, then those of body A, then those of B.
  void addListener(ContactListener<D>* listener);
  void addListener(Handle body, ContactListener<D>* listener);
  /// Whether the body of this slot is one that it was registered for: which of a manifold's two it hears of.
  bool isListenerOf(std::int32_t slot, const ContactListener<D>* listener) const;
  void removeListener(ContactListener<D>* listener);  // wherever it is registered; those of a body go with the body

  // --- changing what is there, between steps -------------------------------------------------------------------------
  /// What a body is now: added to an empty world, the same body.
  BodyDef<D> definition(Handle body) const;
  /// Makes the body what `def` says, and wakes it and those that touch it. It keeps its handle, its joints, and the
  /// contacts of each shape that is, to the last bit, where `definition` says it was; others are new ones. What `def`
  /// leaves as `definition` gave it stays, so a body whose centre of mass moves goes on as the same rigid motion.
  /// Throws UserError, and has changed nothing, for what add() would refuse, and for a joint between two that do not
  /// move.
  void change(Handle body, const BodyDef<D>& def);
  /// Makes one body of two, both dynamic or both fixed: the shapes of `other` come behind those of `into`, where they
  /// are, its joints and forces are those of `into`, and it is gone, with what is between the two. Both momenta stay,
  /// where none of them is pinned. Throws UserError, and has changed nothing, for other types and for what change()
  /// would refuse.
  void merge(Handle into, Handle other);
  /// Makes one body of each shape, where it is and moving as it moved: the first keeps handle and joints. Returns all,
  /// in the order of the shapes. A mass that was given is forgotten. Throws UserError, and has changed nothing, where a
  /// shape alone is no body.
  std::vector<Handle> takeApart(Handle body);
  /// For coming steps; all wake. Throws UserError for one that is not finite.
  void setGravity(const Vec<D>& gravity);
  /// Other algorithms from the next step on: bodies, contacts with their impulses, and joints stay; what the former
  /// stages kept for themselves is forgotten. Throws UserError, and has changed nothing, as the constructor and add()
  /// would.
  void exchange(const Pipeline& pipeline);

  // --- running -------------------------------------------------------------------------------------------------------
  void step(Real dt) override;
  long stepCount() const override { return m_steps; }
  Real time() const override { return m_time; }
  Real lastDt() const override { return m_lastDt; }

  // --- bodies --------------------------------------------------------------------------------------------------------
  bool valid(Handle body) const override;
  Pose<D> pose(Handle body) const override;
  Motion<D> motion(Handle body) const;  // of its centre of mass
  Real mass(Handle body) const;         // kg, 0 for bodies that forces do not move
  bool awake(Handle body) const;
  void setPose(Handle body, const Pose<D>& X_WB) override;
  void setMotion(Handle body, const Motion<D>& motion) override;
  /// A force (N) at a world point, or a torque, for the coming step only. Wakes the body.
  void applyForce(Handle body, const Vec<D>& force, const Vec<D>& point) override;
  void applyTorque(Handle body, const Ang<D>& torque) override;
  void applyImpulse(Handle body, const Wrench<D>& impulse) override;  // wakes the body
  /// The same of an impulse (N s) at a world point, or of an angular one (N m s).
  void applyImpulse(Handle body, const Vec<D>& impulse, const Vec<D>& point);
  void applyAngularImpulse(Handle body, const Ang<D>& impulse);
  void wake(Handle body);
  void wakeAll();
  /// The user's own number, as BodyDef gave it or as it was set last. A step neither reads nor changes it.
  std::uint64_t userData(Handle body) const;
  void setUserData(Handle body, std::uint64_t data);
  /// For a world that only shows what somebody else moves: puts each body that is not fixed at its X_WC with its
  /// motion, by slot. No event, nobody wakes. Precondition: both have bodies().size() entries.
  void follow(std::span<const Pose<D>> X_WC, std::span<const Motion<D>> motion);
  /// It stays, without rows, until it is removed. Precondition: joints()[slot] is active.
  void breakJoint(std::size_t slot);
  Handle handle(std::int32_t slot) const;  // of the body now in that slot
  int bodyCount() const override { return m_bodySlots.inUse(); }

  // --- queries on exact shapes, through the broadphase ---------------------------------------------------------------
  std::vector<Handle> at(const Vec<D>& point) const;
  std::vector<Handle> overlap(const Aabb<D>& box) const;
  bool contains(Handle body, const Vec<D>& point) const;
  bool intersects(Handle body, const Aabb<D>& box) const;
  /// Hits of p + t * direction, 0 <= t <= maxT, nearest first; with firstOnly at most one. Throws UserError for a point
  /// or direction that is not finite and a maxT below zero; an infinite one will do.
  std::vector<BodyRayHit<D>> ray(const Vec<D>& p, const Vec<D>& direction, Real maxT, bool firstOnly) const;
  std::vector<BodyRayHit<D>> ray(const Vec<D>& p, const Vec<D>& direction, Real maxT, bool firstOnly,
                                 const RayFilter<D>& filter) const;

  // --- data, for invariants, recordings, drawing; slots as in Bodies -------------------------------------------------
  const Bodies<D>& bodies() const override { return m_bodies; }
  std::span<const ShapeRecord<D>> shapes() const override { return m_shapes; }
  // Slots of a body's shapes and joints, in ascending order.
  std::span<const std::int32_t> shapesOf(std::size_t body) const { return m_shapesOf.of(body); }
  std::span<const std::int32_t> jointsOf(std::size_t body) const { return m_jointsOf.of(body); }
  std::span<const Manifold<D>> manifolds() const { return m_manifolds; }
  std::span<const PairRecord> pairRecords() const { return m_records; }  // sorted by key; none where nobody remembers
  /// Whom the last step found near enough to be asked for contacts, as many as its profile counts. By the slots that
  /// they had: who has gone since is free there, and who has come may have taken a slot.
  std::span<const ShapePair> pairs() const { return m_pairs; }
  std::optional<std::span<const Manifold<D>>> contacts() const override { return manifolds(); }
  std::span<const JointRecord<D>> joints() const override { return m_joints; }
  std::span<const ForceRecord<D>> forces() const override { return m_forces; }
  const Proxies<D>& proxies() const { return m_boxes.proxies(); }  // as of the last step or query
  /// What the broadphase divides by (Broadphase::structure), as of the last step or query.
  void broadphaseStructure(std::vector<StructureBox<D>>& out) const { stage<Broadphase>().structure(out); }
  const WorldSettings<D>& settings() const override { return m_settings; }
  const Pipeline& pipeline() const { return m_pipeline; }
  Profiler& profiler() override { return m_profiler; }
  const Profiler& profiler() const { return m_profiler; }

  std::uint64_t hash() const override;

  /// Whom the solver shows its velocity problems; nullptr: nobody. Not owned, not saved.
  void watch(VelocityWatcher<D>* watcher) { m_watcher = watcher; }

  // --- saving --------------------------------------------------------------------------------------------------------
  /// Everything that a trajectory depends on except force generators and listeners, which the caller adds again. The
  /// bytes are a function of the state: saved, loaded and continued is the same as continued.
  void save(std::ostream& out) const;
  /// Replaces this world's state; its pipeline stays. Throws UserError when the bytes are not a world of this
  /// dimension, precision and format, or damaged, or hold shapes that the pipeline does not support; nothing has
  /// changed then.
  void load(std::istream& in);

 private:
  void again() override;                                                                   // DetectAgain
  void eval(const ForceState<D>& state, Real t, std::span<Wrench<D>> out) const override;  // Forces
  std::size_t slotOf(Handle body) const;  // throws UserError for a handle of nobody
  std::size_t freeBodySlot();
  void freeBody(std::size_t body);  // its row alone: what it had is gone already
  struct Weighed {                  // a definition that was checked
    MassProperties<D> mass;
    Inertia<D> invInertia = Inertia<D>::Zero();
    std::vector<ShapeDef<D>> shapes;  // each near its own frame's origin
  };
  Weighed weigh(const BodyDef<D>& def, std::int32_t inPlaceOf) const;  // a body's slot, -1: of nobody
  void write(std::size_t body, const BodyDef<D>& def, const Weighed& weighed);
  void requireStages(const StageSet<D>& stages, const Pipeline& pipeline, const std::array<bool, kShapeKinds>& kinds,
                     const std::string& who) const;
  void indexShapes();
  void putShape(const ShapeDef<D>& def, std::int32_t body, std::int32_t index);
  void fillShape(std::size_t slot, const ShapeDef<D>& def, std::int32_t body, std::int32_t index);
  void freeShape(std::size_t slot);
  bool sameShape(const ShapeRecord<D>& record, const ShapeDef<D>& def) const;  // in the same place on its body
  void moveCenter(std::size_t body, const Vec<D>& by);
  template <class Gone>
  void endContacts(const Gone& gone);
  template <class F>
  void forListeners(const Manifold<D>& m, const F& f) const;
  void countKinds(const Shape<D>& shape, int change);
  void touched(std::size_t body);  // by the user: its boxes are stale, and it wakes
  void sync() const { m_boxes.sync(m_shapes, m_bodies, m_settings.sleepingContacts); }
  template <class Pair>  // a manifold or a record
  bool resting(const Pair& p) const {
    return !m_boxes.active(p.shapeA) && !m_boxes.active(p.shapeB);
  }
  template <class Holds>
  std::vector<Handle> bodiesOf(std::vector<ProxyId>& found, const Aabb<D>& box, const Holds& holds) const;
  template <class Holds>
  bool anyPart(Handle body, const Aabb<D>& box, const Holds& holds) const;
  template <class Meets>
  std::vector<BodyRayHit<D>> rayHits(const Vec<D>& p, const Vec<D>& direction, Real maxT, bool firstOnly,
                                     const Meets& meets) const;
  void lookAhead(Real dt);
  void stopAtMeetings(Real dt);
  std::span<const typename FastParts<D>::Pair> fastPairs(const Ways<D>& ways);
  Motion<D> wayOf(std::size_t body, Real dt) const;
  FastPair<D> pairFrom(const typename FastParts<D>::Pair& p, const Ways<D>& ways, Real from) const;
  bool vetoed(const typename FastParts<D>::Pair& p) const;
  void findPairs(Real dt);
  bool looks(Lookout when) const {
    return m_settings.features.continuous && stage<ContinuousCollision>().lookout() == when;
  }
  bool unpaired(std::int32_t a, std::int32_t b) const {  // a < b
    return std::binary_search(m_unpaired.begin(), m_unpaired.end(), std::pair(a, b));
  }
  void makeContacts();
  Real marginOf(const ShapePair& pair) const;
  PairMaterial mixed(const Manifold<D>& m) const;  // as its shapes and the mixing rules make it
  void mixKept();
  bool quiet(const Manifold<D>& m) const {  // neither of its bodies moves by itself
    const auto moves = [&](std::int32_t body) {
      const auto i = static_cast<std::size_t>(body);
      return m_bodies.awake[i] && m_bodies.type[i] != BodyType::fixed;
    };
    return !moves(m.bodyA) && !moves(m.bodyB);
  }
  void generate(std::span<const ShapePair> pairs, Real margin);
  std::span<PairMemory> recall(std::span<const ConvexPair<D>> children);
  void remember();
  void tellListeners(bool again);  // of the step's first contacts, or of those that a stage has had made again in it
  void decideSleep(Real dt);
  void refreshMasses();
  void collectActive();
  void outdateGraph() { m_graph.reset(m_bodies, m_manifolds, jointsInUse(), m_profiler.frame().work); }
  std::span<const JointRecord<D>> jointsInUse() const {
    return m_settings.features.joints ? std::span<const JointRecord<D>>(m_joints) : std::span<const JointRecord<D>>();
  }
  void finishJoints(Real dt);
  void listJoint(std::size_t slot);  // by its bodies
  void unlistJoint(std::size_t slot);
  void releaseJoint(const JointRecord<D>& joint);  // tells those whom it held
  void wakeActedOn(const ForceRecord<D>& force);

  /// For instance stage<Solver>(): what the pipeline says.
  template <template <int> class S>
  S<D>& stage() const {
    return m_stages.template get<S<D>>();
  }

  Pipeline m_pipeline;
  WorldSettings<D> m_settings;
  StageSet<D> m_stages;

  // State: what save() writes.
  Bodies<D> m_bodies;
  std::vector<ShapeRecord<D>> m_shapes;
  IndexedVector<JointRecord<D>> m_joints;
  std::vector<ForceRecord<D>> m_forces;
  IndexedVector<Manifold<D>> m_manifolds;
  std::vector<PairRecord> m_records;
  std::vector<Wrench<D>> m_userForces;  // for the coming step, by body slot
  std::vector<SleepEvent> m_events;     // since the last decision
  Real m_time = 0, m_lastDt = 0;
  long m_steps = 0;

  // Derived from the state; the boxes are brought up to date by sync() when somebody asks.
  mutable BoxIndex<D> m_boxes;
  SlotTable m_bodySlots, m_shapeSlots, m_jointSlots, m_forceSlots;
  SlotLists m_shapesOf, m_jointsOf;            // by body slot
  std::array<int, kShapeKinds> m_kindCount{};  // of convex parts
  std::uint64_t m_visits = 0;                  // WorkCount::eventVisits since the last step

  // Scratch and indices, rebuilt in each step.
  std::vector<Manifold<D>> m_oldManifolds;
  std::vector<Manifold<D>> m_lastContacts;  // of the step before, for forces that read them
  Real m_dt = 0;                            // of the step that is made
  std::vector<PairRecord> m_oldRecords;
  std::vector<PairMemory> m_memory;
  ContactOrder m_order;
  ContactGraph<D> m_graph;
  std::vector<ProxyPair> m_proxyPairs;
  std::vector<ShapePair> m_pairs, m_regenerate;
  struct Ahead {  // two shapes that may meet in this step, body of the first < body of the second
    ShapePair shapes;
    Real margin;  // m: contacts are made for separations up to this
  };
  std::vector<Ahead> m_ahead;       // sorted by their slots
  std::vector<PairRecord> m_asked;  // pairs of children that the generator was asked for
  std::vector<Pose<D>> m_start;     // of the step, X_WC by body slot
  std::vector<Motion<D>> m_ways;    // of the step just solved, by body slot
  std::vector<Real> m_stop;         // s after the start
  struct Meeting {
    Real t;  // s after the start
    std::size_t pair;
    Real asked;  // when the first of the two was stopped, as known then
    bool operator<(const Meeting& o) const {
      return std::tie(o.t, o.pair) < std::tie(t, pair);
    }  // of a heap: the first
  };
  std::vector<Meeting> m_meetings;
  std::vector<FastPair<D>> m_questions;
  std::vector<Real> m_times;
  std::vector<std::pair<std::int32_t, std::size_t>> m_pairsOf;  // body, pair; sorted
  std::vector<std::int32_t> m_stopped;
  FastParts<D> m_fast;
  ChildPairs<D> m_children;
  std::vector<std::pair<std::int32_t, std::int32_t>> m_unpaired;  // jointed bodies that do not collide, sorted
  IndexedVector<int> m_active;
  std::vector<std::uint8_t> m_awakeBefore;

  std::vector<std::shared_ptr<const ForceGenerator<D>>> m_generators;
  std::vector<ContactListener<D>*> m_listeners;
  std::vector<std::vector<ContactListener<D>*>> m_bodyListeners;  // by body slot; shorter where the rest has none
  VelocityWatcher<D>* m_watcher = nullptr;
  Profiler m_profiler;
};

// f(listener) for each who hears of this pair, once.
template <int D>
template <class F>
void World<D>::forListeners(const Manifold<D>& m, const F& f) const {
  for (ContactListener<D>* l : m_listeners) f(*l);
  const auto of = [&](std::int32_t body) {
    const auto i = static_cast<std::size_t>(body);
    return i < m_bodyListeners.size() ? std::span<ContactListener<D>* const>(m_bodyListeners[i])
                                      : std::span<ContactListener<D>* const>();
  };
  const auto among = [](std::span<ContactListener<D>* const> list, const ContactListener<D>* l) {
    return std::find(list.begin(), list.end(), l) != list.end();
  };
  for (ContactListener<D>* l : of(m.bodyA)) {
    if (!among(m_listeners, l)) f(*l);
  }
  for (ContactListener<D>* l : of(m.bodyB)) {
    if (!among(m_listeners, l) && !among(of(m.bodyA), l)) f(*l);
  }
}

// Contacts of a body that goes, or of shapes of it: who touched them hears of it, and listeners, who may still ask both
// bodies for their user data. `gone` is asked about manifolds and records.
template <int D>
template <class Gone>
void World<D>::endContacts(const Gone& gone) {
  std::optional<decltype(Manifold<D>{}.shapeKey())> told;  // once for each pair of shapes
  std::erase_if(m_manifolds, [&](const Manifold<D>& m) {
    const std::int32_t whose = gone(m);
    if (whose < 0) return false;
    if (std::exchange(told, m.shapeKey()) == m.shapeKey()) return true;
    m_events.push_back({SleepEvent::bodyRemoved, m.bodyA == whose ? m.bodyB : m.bodyA, whose});
    forListeners(m, [&](ContactListener<D>& l) { l.end(*this, m); });
    return true;
  });
  std::erase_if(m_records, [&](const PairRecord& r) { return gone(r) >= 0; });
}

}}  // namespace lpc::LPC_PRECISION
