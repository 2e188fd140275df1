// SPDX-License-Identifier: Zlib
// Islands, support levels and colours of contacts, on any graph.
#include "framework/problem/contact_graph.h"

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "framework/world/world.h"
#include "tests/check_property.h"
#include "tests/draw.h"
#include "tests/expect_caught.h"
#include "tests/planted_bugs/graph_bugs.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace contact_graph_test { namespace {

using Answer = GraphAnswers (*)(const GraphInput&);

std::size_t at(int i) { return static_cast<std::size_t>(i); }

void touch(GraphInput& in, int a, int b, bool ignored = false) {
  Manifold<2>& m = in.manifolds.emplace_back();
  m.bodyA = std::min(a, b), m.bodyB = std::max(a, b), m.ignored = ignored;
}
JointRecord<2> pivot(int a, int b) {
  static const std::shared_ptr<const JointKind<2>> kind = createStage<JointKind<2>>(Spec{"pivot", {}});
  JointRecord<2> joint;
  joint.kind = kind, joint.bodyA = a, joint.bodyB = b;
  return joint;
}
void addBodies(GraphInput& in, int n, BodyType type) {
  for (int i = 0; i < n; ++i) {
    in.bodies.pose.emplace_back();
    in.bodies.used.push_back(1), in.bodies.type.push_back(type);
  }
}
void colourAll(GraphInput& in) {
  for (std::size_t k = 0; k < in.manifolds.size(); ++k) in.contacts.push_back(static_cast<int>(k));
}

// A small graph, or one in which some bodies have more contacts than there are greedy colours.
GraphInput drawGraph(Draw& draw) {
  GraphInput in;
  const bool hubs = draw.below(4) == 3;
  const int n = 1 + draw.below(hubs ? 90 : 12);
  addBodies(in, n, BodyType::dynamic);
  for (int i = 0; i < n; ++i) {
    in.bodies.used[at(i)] = draw.below(8) != 1;
    in.bodies.type[at(i)] = draw.pick({BodyType::dynamic, BodyType::dynamic, BodyType::fixed, BodyType::kinematic});
  }
  in.joints.resize(1);  // a free slot
  for (int k = draw.below(hubs ? 200 : 15); k > 0; --k) {
    const int a = hubs ? draw.below(std::min(n, 3)) : draw.below(n), b = draw.below(n);
    if (a == b || !in.bodies.used[at(a)] || !in.bodies.used[at(b)]) continue;
    const int kind = draw.below(4);
    if (kind == 3) {
      in.joints.push_back(pivot(a, b));
      in.joints.back().broken = draw.below(5) == 4;
    } else {
      touch(in, a, b, kind == 2);
    }
  }
  for (std::size_t k = 0; k < in.manifolds.size(); ++k) {
    if (draw.below(5) != 1) in.contacts.push_back(static_cast<int>(k));
  }
  if (draw.coin()) std::reverse(in.contacts.begin(), in.contacts.end());
  return in;
}

// --- islands --------------------------------------------------------------------------------------------------------

// Walks from body to body until nothing changes; islands are numbered by their lowest slot.
std::vector<std::int32_t> walked(const GraphInput& in, bool alsoTouching) {
  std::vector<std::pair<int, int>> links;
  for (const JointRecord<2>& j : in.joints) {
    if (j.active()) links.emplace_back(j.bodyA, j.bodyB);
  }
  for (const Manifold<2>& m : in.manifolds) {
    if (alsoTouching && !m.ignored) links.emplace_back(m.bodyA, m.bodyB);
  }
  std::vector<std::int32_t> out(in.bodies.pose.size(), -1);
  std::int32_t next = 0;
  for (int i = 0; i < in.bodies.size(); ++i) {
    if (!in.node(i) || out[at(i)] >= 0) continue;
    out[at(i)] = next;
    for (bool again = true; again;) {
      again = false;
      for (const auto& [a, b] : links) {
        if (!in.node(a) || !in.node(b) || (out[at(a)] == next) == (out[at(b)] == next)) continue;
        out[at(a)] = out[at(b)] = next, again = true;
      }
    }
    ++next;
  }
  return out;
}

void islandsAreWhatIsConnected(Answer answer) {
  RapidCheckDraw draw;
  const GraphInput in = drawGraph(draw);
  const GraphAnswers found = answer(in);
  RC_ASSERT(found.islands == walked(in, true));
  RC_ASSERT(found.groups == walked(in, false));
}

TEST(ContactGraph, IslandsAreConnectedBodies) {
  check(
      "islands of any graph", [] { islandsAreWhatIsConnected([](const GraphInput& in) { return answersOf(in); }); },
      500);
  const std::pair<const char*, Answer> bugs[] = {{"islands through the ground", throughTheGround},
                                                 {"islands without joints", withoutJoints},
                                                 {"islands through broken joints", throughBrokenJoints},
                                                 {"islands through vetoed contacts", hearsNoVeto},
                                                 {"an island cut in two", cutsIslands}};
  for (const auto& [name, bug] : bugs) {
    expectFalsified(
        name, [bug = bug] { islandsAreWhatIsConnected(bug); }, 500);
  }
}

// --- levels ---------------------------------------------------------------------------------------------------------

// 0 for bodies that no contact moves; otherwise one more than the lowest level that the body touches; none if there is
// no path.
void levelsAreDistances(Answer answer) {
  RapidCheckDraw draw;
  const GraphInput in = drawGraph(draw);
  const GraphAnswers found = answer(in);
  std::vector<std::int32_t> expected(in.bodies.pose.size(), -1);
  for (int i = 0; i < in.bodies.size(); ++i) {
    if (in.bodies.used[at(i)] && !in.node(i)) expected[at(i)] = 0;
  }
  for (std::int32_t level = 0; level <= in.bodies.size(); ++level) {
    for (const Manifold<2>& m : in.manifolds) {
      for (const auto& [from, to] : {std::pair(m.bodyA, m.bodyB), std::pair(m.bodyB, m.bodyA)}) {
        if (!m.ignored && expected[at(from)] == level && expected[at(to)] < 0) expected[at(to)] = level + 1;
      }
    }
  }
  RC_ASSERT(found.levels == expected);
}

TEST(ContactGraph, LevelsAreDistancesFromTheGround) {
  check(
      "support levels of any graph", [] { levelsAreDistances([](const GraphInput& in) { return answersOf(in); }); },
      500);
  expectFalsified(
      "a level that skips", [] { levelsAreDistances(skipsLevels); }, 500);
  expectFalsified(
      "levels through vetoed contacts", [] { levelsAreDistances(hearsNoVeto); }, 500);
}

// --- colours --------------------------------------------------------------------------------------------------------

void coloursAreGreedyAndApart(Answer answer) {
  RapidCheckDraw draw;
  const GraphInput in = drawGraph(draw);
  const GraphAnswers found = answer(in);
  const auto& offsets = found.offsets;
  RC_ASSERT(!offsets.empty() && offsets.front() == 0 && offsets.back() == static_cast<int>(in.contacts.size()));
  std::vector<int> place(in.manifolds.size(), -1);  // index in the given order
  for (std::size_t k = 0; k < in.contacts.size(); ++k) place[at(in.contacts[k])] = static_cast<int>(k);
  std::vector<int> sorted = found.order, given = in.contacts;
  std::sort(sorted.begin(), sorted.end()), std::sort(given.begin(), given.end());
  RC_ASSERT(sorted == given);  // each once

  std::vector<std::map<int, std::set<int>>> placesOf(in.bodies.pose.size());  // by body, colour
  for (std::size_t c = 0; c + 1 < offsets.size(); ++c) {
    RC_ASSERT(offsets[c] < offsets[c + 1]);
    std::set<int> busy;
    for (int k = offsets[c]; k < offsets[c + 1]; ++k) {
      const Manifold<2>& m = in.manifolds[at(found.order[at(k)])];
      if (k > offsets[c]) RC_ASSERT(place[at(found.order[at(k - 1)])] < place[at(found.order[at(k)])]);
      for (const int body : {m.bodyA, m.bodyB}) {
        if (!in.node(body)) continue;
        RC_ASSERT(busy.insert(body).second);  // otherwise two contacts of a body are solved at the same time
        placesOf[at(body)][static_cast<int>(c)].insert(place[at(found.order[at(k)])]);
      }
    }
  }
  // When a contact was coloured, none of the lower greedy colours was free.
  for (std::size_t c = 0; c + 1 < offsets.size(); ++c) {
    for (int k = offsets[c]; k < offsets[c + 1]; ++k) {
      const int contact = found.order[at(k)];
      const Manifold<2>& m = in.manifolds[at(contact)];
      for (int lower = 0; lower < std::min(static_cast<int>(c), ContactGraph<2>::kGreedyColours); ++lower) {
        bool taken = false;
        for (const int body : {m.bodyA, m.bodyB}) {
          const auto it = placesOf[at(body)].find(lower);
          taken = taken || (it != placesOf[at(body)].end() && *it->second.begin() < place[at(contact)]);
        }
        RC_ASSERT(taken);
      }
    }
    if (static_cast<int>(c) >= ContactGraph<2>::kGreedyColours) RC_ASSERT(offsets[c + 1] == offsets[c] + 1);
  }
}

TEST(ContactGraph, ColoursAreGreedyAndApart) {
  check(
      "colours of any graph", [] { coloursAreGreedyAndApart([](const GraphInput& in) { return answersOf(in); }); },
      500);
  const std::pair<const char*, Answer> bugs[] = {{"a colour with two contacts of one body", coloursByOneBody},
                                                 {"a colour for each contact", coloursEach},
                                                 {"a contact without a colour", coloursAllButOne}};
  for (const auto& [name, bug] : bugs) {
    expectFalsified(
        name, [bug = bug] { coloursAreGreedyAndApart(bug); }, 500);
  }
}

// --- the whole graph ------------------------------------------------------------------------------------------------

template <class Ask>
void isIndependentOfTheQuestions(const Ask& ask) {
  RapidCheckDraw draw;
  const GraphInput in = drawGraph(draw);
  std::vector<Asked> questions(kEachOnce.begin(), kEachOnce.end());
  for (std::size_t i = questions.size(); i > 1; --i) {
    std::swap(questions[i - 1], questions[at(draw.below(static_cast<int>(i)))]);
  }
  questions.push_back(questions[0]);
  RC_ASSERT(ask(in, questions) == answersOf(in));
}

TEST(ContactGraph, AnswersDoNotDependOnEarlierQueries) {
  check("answers in any order",
        [] { isIndependentOfTheQuestions([](const auto& in, const auto& q) { return answersOf(in, q); }); });
  expectFalsified("islands are what was grouped first", [] {
    isIndependentOfTheQuestions([](const auto& in, const auto& q) {
      GraphAnswers out = answersOf(in, q);
      if (q[0] == Asked::groups) out.islands = out.groups;
      return out;
    });
  });
}

TEST(ContactGraph, KnowsTheEdgesOfEachBody) {
  GraphInput in;
  addBodies(in, 1, BodyType::fixed), addBodies(in, 3, BodyType::dynamic);
  touch(in, 0, 1), touch(in, 0, 2, true), touch(in, 1, 2), touch(in, 0, 3);
  in.joints = {JointRecord<2>{}, pivot(3, 1), pivot(-1, 3)};
  WorkDone work;
  ContactGraph<2> graph;
  graph.reset(in.bodies, in.manifolds, in.joints, work);
  const auto list = [](std::span<const std::int32_t> s) { return std::vector<std::int32_t>(s.begin(), s.end()); };
  EXPECT_EQ(list(graph.manifoldsOf(0)), (std::vector<std::int32_t>{0, 3})) << "what was vetoed is no edge";
  EXPECT_EQ(list(graph.manifoldsOf(1)), (std::vector<std::int32_t>{0, 2}));
  EXPECT_EQ(list(graph.jointsOf(1)), (std::vector<std::int32_t>{1}));
  EXPECT_EQ(list(graph.jointsOf(3)), (std::vector<std::int32_t>{1, 2})) << "also to the world";
  EXPECT_TRUE(graph.jointsOf(2).empty());
}

// A tower, many boxes on one plate, a grid: the work grows no faster than bodies, contacts and joints.
GraphInput drawLarge(int kind, int n) {
  GraphInput in;
  addBodies(in, 1, BodyType::fixed), addBodies(in, n, BodyType::dynamic);
  for (int i = 1; i <= n; ++i) {
    if (kind == 0) touch(in, i - 1, i);
    if (kind == 1) touch(in, 0, i), touch(in, 1, 1 + i % n);
    if (kind == 2) touch(in, std::max(0, i - 1), i), touch(in, std::max(0, i - 30), i);
  }
  if (kind == 1) std::erase_if(in.manifolds, [](const Manifold<2>& m) { return m.bodyA == m.bodyB; });
  for (int j = 0; j < n / 3; ++j) in.joints.push_back(pivot(1 + j, 1 + (j * 7) % n));
  colourAll(in);
  return in;
}
std::uint64_t visits(const GraphInput& in) {
  WorkDone work;
  ContactGraph<2> graph;
  graph.reset(in.bodies, in.manifolds, in.joints, work);
  GraphAnswers out;
  (void)graph.islands(), (void)graph.jointedGroups(), (void)graph.supportLevels();
  graph.colour(in.contacts, out.order, out.offsets);
  return work[WorkCount::graphVisits];
}
// Planted bug: a colouring that visits all neighbours of both bodies for each contact.
std::uint64_t visitsOfNeighbours(const GraphInput& in) {
  std::vector<std::uint64_t> contacts(in.bodies.pose.size(), 0);
  for (const Manifold<2>& m : in.manifolds) ++contacts[at(m.bodyA)], ++contacts[at(m.bodyB)];
  std::uint64_t sum = 0;
  for (const Manifold<2>& m : in.manifolds) sum += contacts[at(m.bodyA)] + contacts[at(m.bodyB)];
  return sum;
}
template <class Counted>
bool isLinear(const Counted& count) {
  for (int kind = 0; kind < 3; ++kind) {
    for (const int n : {10, 100, 1000, 10000}) {
      const GraphInput in = drawLarge(kind, n);
      if (count(in) > 14 * (in.bodies.pose.size() + in.manifolds.size() + in.joints.size())) return false;
    }
  }
  return true;
}
TEST(ContactGraph, WorkIsLinear) {
  EXPECT_TRUE(isLinear(visits));
  expectCaught("a colouring that asks all neighbours", isLinear(visitsOfNeighbours));
  EXPECT_EQ(visits(drawLarge(0, 0)), visits(drawLarge(0, 0)));
  WorkDone work;
  ContactGraph<2>().reset({}, {}, {}, work);
  EXPECT_EQ(work[WorkCount::graphVisits], 0u) << "nothing is built before it is asked for";
}

// --- in a world -----------------------------------------------------------------------------------------------------

// A resolver that checks its input and delegates to catto.
struct Seen {
  long contacts = 0, coloured = 0, shared = 0, unequal = 0;
} seen;

template <int D>
void look(std::span<const int> order, std::span<const int> colours, std::span<const Manifold<D>> manifolds,
          const Bodies<D>& bodies) {
  seen.contacts += static_cast<long>(order.size());
  if (colours.empty()) return;
  if (colours.back() != static_cast<int>(order.size())) ++seen.unequal;
  for (std::size_t c = 0; c + 1 < colours.size(); ++c) {
    std::set<int> busy;
    for (int k = colours[c]; k < colours[c + 1]; ++k, ++seen.coloured) {
      const Manifold<D>& m = manifolds[at(order[at(k)])];
      for (const int body : {m.bodyA, m.bodyB}) {
        if (bodies.type[at(body)] == BodyType::dynamic && !busy.insert(body).second) ++seen.shared;
      }
    }
  }
}

template <int D>
class Onlooker final : public VelocityResolver<D> {
 public:
  using Params = NoParams;
  explicit Onlooker(const Params&) : m_right(createStage<VelocityResolver<D>>({"catto", {}})) {}
  static AlgorithmInfo info() {
    return {.name = "planted_onlooker",
            .summary = "catto, looked at",
            .paper = "",
            .complexity = "that of catto",
            .role = AlgorithmRole::witness};
  }
  void solve(const VelocityInput<D>& in) override {
    look<D>(in.order, in.colours, in.manifolds, in.bodies);
    m_right->solve(in);
  }

 private:
  std::unique_ptr<VelocityResolver<D>> m_right;
};
template <int D>
class PositionOnlooker final : public PositionResolver<D> {
 public:
  using Params = NoParams;
  explicit PositionOnlooker(const Params&) {}
  static AlgorithmInfo info() {
    return {
        .name = "planted_onlooker", .summary = "looks", .paper = "", .complexity = "1", .role = AlgorithmRole::witness};
  }
  void correct(const PositionInput<D>& in) override { look<D>(in.order, in.colours, in.manifolds, in.bodies); }
};
LPC_REGISTER(VelocityResolver, Onlooker, 2, 3);
LPC_REGISTER(PositionResolver, PositionOnlooker, 2, 3);

template <int D>
Seen pyramid(const std::string& order) {
  seen = {};
  World<D> world(
      Pipeline::parse("solver=split_solver{velocity=planted_onlooker,position=planted_onlooker,order=" + order + "}"));
  const auto add = [&](BodyType type, Real x, Real y, Real half) {
    BodyDef<D> body;
    body.type = type, body.X_WB.p[0] = x, body.X_WB.p[1] = y;
    ShapeDef<D> shape;
    shape.shape = Shape<D>::box(Vec<D>::Constant(half));
    body.shapes.push_back(shape);
    world.add(body);
  };
  add(BodyType::fixed, 0, -20, 20);
  for (int row = 0; row < 4; ++row) {
    for (int k = 0; k + row < 4; ++k) {
      add(BodyType::dynamic, Real(1.05) * (static_cast<Real>(k) + static_cast<Real>(row) / 2),
          Real(0.5) + static_cast<Real>(row), Real(0.5));
    }
  }
  for (int step = 0; step < 20; ++step) world.step(Real(1) / 60);
  return seen;
}

template <int D>
void reachResolvers() {
  const Seen coloured = pyramid<D>("coloured"), stored = pyramid<D>("stored");
  EXPECT_GT(coloured.contacts, 20 * 10);
  EXPECT_EQ(coloured.coloured, coloured.contacts) << "each contact has a colour";
  EXPECT_EQ(coloured.shared, 0);
  EXPECT_EQ(coloured.unequal, 0);
  EXPECT_EQ(stored.coloured, 0) << "an order without colours";
}
TEST(ContactGraph, ColoursReachResolvers) { reachResolvers<2>(), reachResolvers<3>(); }

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::contact_graph_test
