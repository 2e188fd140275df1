// SPDX-License-Identifier: Zlib
#pragma once

#include <iosfwd>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "framework/problem/contact_graph.h"
#include "framework/stage/spec.h"
#include "framework/world/body_queries.h"
#include "framework/world/body_table.h"
#include "framework/world/contact_listener.h"
#include "framework/world/contact_maker.h"
#include "framework/world/continuous_pass.h"
#include "framework/world/force_table.h"
#include "framework/world/joint_table.h"
#include "framework/world/listener_table.h"
#include "framework/world/simulation.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Bodies, joints, forces, and one algorithm of each stage. A step: boxes, pairs, cache.select, contacts, cache.carry,
/// listeners, sleep, solver. Same definitions, same calls, same build: the same bits.
template <int D>
class World final : public Simulation<D> {
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
  bool valid(Handle body) const override { return m_table.valid(body); }
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
  Handle handle(std::int32_t slot) const { return m_table.handle(slot); }  // of the body now in that slot
  int bodyCount() const override { return m_table.count(); }

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
  const Bodies<D>& bodies() const override { return m_table.bodies; }
  std::span<const ShapeRecord<D>> shapes() const override { return m_table.shapes; }
  // Slots of a body's shapes and joints, in ascending order.
  std::span<const std::int32_t> shapesOf(std::size_t body) const { return m_table.shapesOf(body); }
  std::span<const std::int32_t> jointsOf(std::size_t body) const { return m_joints.of(body); }
  std::span<const Manifold<D>> manifolds() const { return m_contacts.manifolds; }
  /// Sorted by key. There are none where the contact generator remembers nothing of pairs.
  std::span<const PairRecord> pairRecords() const { return m_contacts.records; }
  /// Shape pairs passed to the contact generator in the last step, by slots; as many as its profile counts. Slots may
  /// have been reused since.
  std::span<const ShapePair> pairs() const { return m_contacts.pairs(); }
  std::optional<std::span<const Manifold<D>>> contacts() const override { return manifolds(); }
  std::span<const JointRecord<D>> joints() const override { return m_joints.records; }
  std::span<const ForceRecord<D>> forces() const override { return m_forces.records; }
  const Proxies<D>& proxies() const { return m_table.boxes.proxies(); }  // as of the last step or query
  /// What the broadphase divides by (Broadphase::structure), as of the last step or query.
  void broadphaseStructure(std::vector<StructureBox<D>>& out) const { stage<Broadphase>().structure(out); }
  const WorldSettings<D>& settings() const override { return m_settings; }
  const Pipeline& pipeline() const { return m_pipeline; }
  Profiler& profiler() override { return m_profiler; }
  const Profiler& profiler() const { return m_profiler; }

  std::uint64_t hash() const override { return m_table.hash(); }

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
  std::size_t slotOf(Handle body) const { return m_table.slotOf(body); }
  void sync() const { m_table.sync(m_settings.sleepingContacts); }
  Weighed<D> weigh(const BodyDef<D>& def, std::int32_t inPlaceOf) const;  // a body's slot, -1: of none
  void requireStages(const StageSet<D>& stages, const Pipeline& pipeline, const std::array<bool, kShapeKinds>& kinds,
                     const std::string& prefix) const;
  template <class Gone>
  void endContacts(const Gone& gone);
  std::span<const JointRecord<D>> jointsInUse() const {
    return m_settings.features.joints ? joints() : std::span<const JointRecord<D>>();
  }
  /// For instance stage<Solver>(): what the pipeline says.
  template <template <int> class S>
  S<D>& stage() const {
    return m_stages.template get<S<D>>();
  }

  Pipeline m_pipeline;
  WorldSettings<D> m_settings;
  StageSet<D> m_stages;

  // Parts. Each holds its share of the state, what is derived from it, and scratch of a step.
  BodyTable<D> m_table;
  JointTable<D> m_joints;
  ForceTable<D> m_forces;
  ContactMaker<D> m_contacts;
  ContinuousPass<D> m_continuous;
  ListenerTable<D> m_listeners;

  Real m_time = 0, m_lastDt = 0;
  long m_steps = 0;

  // Of a step.
  UnpairedBodies m_unpaired;
  ContactGraph<D> m_graph;
  std::vector<std::uint8_t> m_awakeBefore;
  VelocityWatcher<D>* m_watcher = nullptr;
  Profiler m_profiler;
};

}}  // namespace lpc::LPC_PRECISION
