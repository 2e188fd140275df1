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

/// A world of bodies, joints and forces, with one algorithm for each stage. A step runs: boxes, pairs, cache.select,
/// contacts, cache.carry, listeners, sleep, solver, continuous. The same definitions, calls and build give the same
/// bits.
template <int D>
class World final : public Simulation<D> {
 public:
  /// Makes an empty world. Throws UserError when the pipeline names an unknown algorithm or parameter.
  explicit World(const Pipeline& pipeline = {}, const WorldSettings<D>& settings = {});
  /// Makes an empty world with these stages, which may be objects of the user's own (StageSet::set). A save holds no
  /// stage: load it into a world with the same stages.
  explicit World(StageSet<D> stages, const WorldSettings<D>& settings = {});
  ~World() override;
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  // --- building, at any time between steps ---------------------------------------------------------------------------
  /// Adds a body. Throws UserError for poses, velocities or sizes that are not finite, a dynamic body without mass, and
  /// shape kinds that the contact generator does not support.
  BodyHandle add(const BodyDef<D>& def) override;
  void remove(BodyHandle body) override;
  /// Removes all bodies, joints, forces and force generators, in time linear in their number. Sets time and step number
  /// to 0. Listeners get end() as from remove(), in the order of the slots. Listeners of the whole world, settings,
  /// stages and the watcher stay. Bodies added later get the same slots and, to the last bit, the same results as in a
  /// new world. Old handles stay invalid.
  void clear();
  JointHandle add(const JointDef<D>& def) override;
  void remove(JointHandle joint) override;
  /// Adds a force and wakes the bodies on which it acts; remove() wakes them too. The force does not act on a body
  /// while the body sleeps.
  ForceHandle add(const ForceDef<D>& def) override;
  void remove(ForceHandle force) override;
  void add(std::shared_ptr<const ForceGenerator<D>> generator) override;
  void remove(const ForceGenerator<D>* generator);
  /// A bare shape becomes a static body.
  BodyHandle add(const ShapeDef<D>& shape) { return add(BodyDef<D>::fixed(shape)); }
  /// Registers a listener for all contacts, or for the contacts of one body. Does not own the listener. A listener that
  /// is registered twice for a pair is called once. The world's listeners are called first, then those of body A, then
  /// those of body B.
  void addListener(ContactListener<D>* listener);
  void addListener(BodyHandle body, ContactListener<D>* listener);
  /// True when this listener is registered for the body in this slot. A listener uses it to find its body in a
  /// manifold.
  bool isListenerOf(std::int32_t slot, const ContactListener<D>* listener) const;
  void removeListener(ContactListener<D>* listener);  // removes it from the world and from all bodies

  // --- changing bodies and stages, between steps ---------------------------------------------------------------------
  /// Returns the body's current definition. Adding it to an empty world gives the same body.
  BodyDef<D> definition(BodyHandle body) const;
  /// Changes the body to match `def`. Wakes the body and the bodies that touch it. The handle and the joints stay. A
  /// shape that equals an old shape to the last bit keeps its contacts; all other shapes are new. Values that `def`
  /// leaves as `definition` gave them stay, so a body continues the same rigid motion when its centre of mass changes.
  /// Throws UserError, and changes nothing, when add() would reject `def` or a joint would connect two bodies that do
  /// not move.
  void change(BodyHandle body, const BodyDef<D>& def);
  /// Merges `other` into `into`; both are dynamic or both static. `into` gets the shapes of `other`, at their place in
  /// the world, and its joints and forces. Removes `other`, with the joints and forces between the two. Linear and
  /// angular momentum are kept unless a body is pinned. Throws UserError, and changes nothing, for other body types and
  /// when change() would throw.
  void merge(BodyHandle into, BodyHandle other);
  /// Splits the body into one body for each shape, at the same pose and with the same motion. The first one keeps the
  /// handle and the joints. Returns all bodies, in the order of the shapes. An explicitly given mass is lost. Throws
  /// UserError, and changes nothing, when a shape alone makes no valid body.
  std::vector<BodyHandle> splitByShape(BodyHandle body);
  /// Sets the gravity of later steps and wakes all bodies. Throws UserError when it is not finite.
  void setGravity(const Vec<D>& gravity);
  /// Replaces the algorithms from the next step on. Bodies, joints, and contacts with their impulses stay; internal
  /// state of the old stages is lost. Throws UserError, and changes nothing, when the constructor or add() would throw
  /// with this pipeline.
  void setPipeline(const Pipeline& pipeline);
  /// Replaces the algorithms by stage objects. An object of the user's own always counts as another algorithm.
  void setPipeline(StageSet<D> stages);

  // --- running -------------------------------------------------------------------------------------------------------
  void step(Real dt) override;
  long stepCount() const override { return m_steps; }
  Real time() const override { return m_time; }
  Real lastDt() const override { return m_lastDt; }

  // --- bodies --------------------------------------------------------------------------------------------------------
  bool valid(BodyHandle body) const override { return m_table.valid(body); }
  Pose<D> pose(BodyHandle body) const override;
  Motion<D> motion(BodyHandle body) const;     // of the centre of mass
  Vec<D> centerOfMass(BodyHandle body) const;  // in the world, m
  Real mass(BodyHandle body) const;            // kg, 0 for static and kinematic bodies
  bool awake(BodyHandle body) const;
  void setPose(BodyHandle body, const Pose<D>& X_WB) override;
  void setMotion(BodyHandle body, const Motion<D>& motion) override;
  /// Applies a force (N) at a world point, or a torque (N m), in the next step only. Wakes the body.
  void applyForce(BodyHandle body, const Vec<D>& force, const Vec<D>& point) override;
  void applyTorque(BodyHandle body, const Ang<D>& torque) override;
  void applyImpulse(BodyHandle body, const Wrench<D>& impulse) override;  // wakes the body
  /// Applies an impulse (N s) at a world point, or an angular impulse (N m s). Wakes the body.
  void applyImpulse(BodyHandle body, const Vec<D>& impulse, const Vec<D>& point);
  void applyAngularImpulse(BodyHandle body, const Ang<D>& impulse);
  void wake(BodyHandle body);
  void wakeAll();
  /// The user's own number, from BodyDef or setUserData(). A step neither reads nor changes it.
  std::uint64_t userData(BodyHandle body) const;
  void setUserData(BodyHandle body, std::uint64_t data);
  /// For a world that displays bodies simulated elsewhere: sets the pose X_WC and motion of each body that is not
  /// static, by slot. Creates no events and wakes no body. Precondition: both have bodies().size() entries.
  void follow(std::span<const Pose<D>> X_WC, std::span<const Motion<D>> motion);
  /// Breaks the joint in this slot. It keeps its slot, without rows, until it is removed. Precondition: joints()[slot]
  /// is active.
  void breakJoint(std::size_t slot);
  BodyHandle handle(std::int32_t slot) const { return m_table.handle(slot); }  // of the body now in this slot
  int bodyCount() const override { return m_table.count(); }

  // --- queries on exact shapes, through the broadphase ---------------------------------------------------------------
  /// Bodies with a shape that contains this world point, or that overlaps this world box.
  std::vector<BodyHandle> at(const Vec<D>& point) const;
  std::vector<BodyHandle> overlap(const Aabb<D>& box) const;
  /// As at() and overlap(), for one body.
  bool contains(BodyHandle body, const Vec<D>& point) const;
  bool intersects(BodyHandle body, const Aabb<D>& box) const;
  // A filter selects shapes; without one, a query finds every shape.
  using Filter = std::optional<QueryFilter<D>>;
  /// Bodies with a shape that overlaps `shape` at this pose. Shapes that touch overlap, except for rounding. Throws
  /// UserError for a plane, a surface, and a pose that is not finite.
  std::vector<BodyHandle> overlap(const Shape<D>& shape, const Pose<D>& X_WS, const Filter& filter = {}) const;
  /// First contact of `shape` moved by t * displacement (m), 0 <= t <= 1, without rotation: where the gap is below the
  /// one of TimeOfImpactAnswer. Throws as overlap().
  std::optional<BodyCastHit<D>> castFirst(const Shape<D>& shape, const Pose<D>& X_WS, const Vec<D>& displacement,
                                          const Filter& filter = {}) const;
  /// The body nearest to a world point, within maxDistance (m), which may be infinite; its time grows with the number
  /// of boxes within maxDistance. Throws UserError when the point is not finite, or maxDistance is negative.
  std::optional<ClosestBody<D>> closest(const Vec<D>& point, Real maxDistance, const Filter& filter = {}) const;
  /// All hits of the ray p + t * direction, 0 <= t <= maxT, sorted by t. maxT may be infinite. Throws UserError when
  /// the point or direction is not finite, the direction is zero, or maxT is negative.
  std::vector<BodyRayHit<D>> rayAll(const Vec<D>& p, const Vec<D>& direction, Real maxT,
                                    const Filter& filter = {}) const;
  /// The hit with the smallest t. Throws as rayAll().
  std::optional<BodyRayHit<D>> rayFirst(const Vec<D>& p, const Vec<D>& direction, Real maxT,
                                        const Filter& filter = {}) const;

  // --- data, for invariants, recordings, drawing; slots as in Bodies -------------------------------------------------
  const Bodies<D>& bodies() const override { return m_table.bodies; }
  std::span<const ShapeRecord<D>> shapes() const override { return m_table.shapes; }
  // Slots of a body's shapes and joints, in ascending order.
  std::span<const std::int32_t> shapesOf(std::size_t body) const { return m_table.shapesOf(body); }
  std::span<const std::int32_t> jointsOf(std::size_t body) const { return m_joints.of(body); }
  std::span<const Manifold<D>> manifolds() const { return m_contacts.manifolds; }
  /// Memory of the contact generator, sorted by key. Empty when the generator keeps no memory of pairs.
  std::span<const PairRecord> pairRecords() const { return m_contacts.records; }
  /// Pairs of shapes with near boxes in the last step, sorted by bodies and shapes; Profiler::Frame::pairs is their
  /// number. Slots may have been reused since.
  std::span<const ShapePair> pairs() const { return m_contacts.pairs(); }
  std::optional<std::span<const Manifold<D>>> contacts() const override { return manifolds(); }
  std::span<const JointRecord<D>> joints() const override { return m_joints.records; }
  std::span<const ForceRecord<D>> forces() const override { return m_forces.records; }
  const Proxies<D>& proxies() const { return m_table.boxes.proxies(); }  // as of the last step or query
  /// Boxes of the broadphase's internal structure (Broadphase::structure), as of the last step or query.
  void broadphaseStructure(std::vector<StructureBox<D>>& out) const { stage<Broadphase>().structure(out); }
  const WorldSettings<D>& settings() const override { return m_settings; }
  /// The algorithm of each stage. For a stage of the user's own: the name that StageSet::set gave it. setPipeline()
  /// throws for such a name unless an algorithm of that name is registered.
  const Pipeline& pipeline() const { return m_stages.pipeline(); }
  Profiler& profiler() override { return m_profiler; }
  const Profiler& profiler() const { return m_profiler; }

  std::uint64_t hash() const override { return m_table.hash(); }

  /// Sets the watcher to which the solver shows its velocity problems; nullptr for none. The world neither owns nor
  /// saves the watcher.
  void watch(VelocityWatcher<D>* watcher) { m_watcher = watcher; }

  // --- saving --------------------------------------------------------------------------------------------------------
  /// Saves all state that determines the trajectory, except force generators and listeners: add these again after
  /// load(). The bytes depend on the state only: a loaded world continues exactly as the saved one.
  void save(std::ostream& out) const;
  /// Replaces this world's state; its pipeline stays. Registered stages are created anew. Stages of the user's own
  /// stay; a broadphase of the user's own is first told that every box is removed. Throws UserError, and changes
  /// nothing, when the bytes are damaged, or are not a world of this dimension, precision and format. Also throws when
  /// the bytes hold shapes that the pipeline does not support.
  void load(std::istream& in);

 private:
  std::size_t slotOf(BodyHandle body) const { return m_table.slotOf(body); }
  void sync() const { m_table.sync(m_settings.sleepingContacts); }
  CheckedBody<D> checkBody(const BodyDef<D>& def, std::int32_t inPlaceOf) const;  // inPlaceOf: body slot, or -1
  void requireStages(const StageSet<D>& stages, const std::array<bool, kShapeKinds>& kinds,
                     const std::string& prefix) const;
  template <class EndedBy>
  void endContacts(const EndedBy& endedBy);
  std::span<const JointRecord<D>> jointsInUse() const {
    return m_settings.model.joints ? joints() : std::span<const JointRecord<D>>();
  }
  /// Returns the object of a stage: stage<Solver>() is the solver that the pipeline names.
  template <template <int> class S>
  S<D>& stage() const {
    return m_stages.template get<S<D>>();
  }

  WorldSettings<D> m_settings;
  StageSet<D> m_stages;

  // Parts. Each holds its part of the state, derived data, and scratch memory of a step.
  BodyTable<D> m_table;
  JointTable<D> m_joints;
  ForceTable<D> m_forces;
  ContactMaker<D> m_contacts;
  ContinuousPass<D> m_continuous;
  ListenerTable<D> m_listeners;

  Real m_time = 0, m_lastDt = 0;
  Real m_sinceContacts = 0;  // s, from the newest detection of contacts to now
  long m_steps = 0;

  // Data of a step.
  NonCollidingPairs m_nonColliding;
  ContactGraph<D> m_graph;
  std::vector<std::uint8_t> m_awakeBefore;
  VelocityWatcher<D>* m_watcher = nullptr;
  Profiler m_profiler;
};

}}  // namespace lpc::LPC_PRECISION
