// SPDX-License-Identifier: Zlib
// Streams of pairs: the queries of a world's generator, complete for near pairs, with the same number for a pair in
// every step; written and read.
#include "experiments/trial/formats/pair_stream.h"

#include <xxhash.h>

#include <set>
#include <sstream>

#include "experiments/parse/toml_reader.h"
#include "framework/shape/curved_core.h"
#include "framework/world/world.h"
#include "tests/expect_caught.h"
#include "tests/experiments/refused.h"
#include "tests/small_worlds.h"

namespace lpc { inline namespace LPC_PRECISION { namespace pair_stream_test { namespace {

using test::expectParts;
using test::Parts;
using test::refused;
using test::Workspace;

constexpr std::size_t kNoLimit = 1000000;
const char* const kPipeline = "contacts=query_clip{query=gjk_epa}";  // supports all kinds, and keeps pair memory

template <int D>
Shape<D> spiky() {
  std::vector<Vec<D>> points = {Vec<D>::Zero()};
  for (int d = 0; d < D; ++d) points.push_back(Real(0.5 + 0.1 * d) * Vec<D>::Unit(d));
  points.push_back(Vec<D>::Constant(Real(-0.3)));
  return Shape<D>::polytope(std::span<const Vec<D>>(points), Real(0.02));
}

template <int D>
std::vector<Shape<D>> everyShape() {
  const Vec<D> half = test::at<D>(0.3, 0.2, 0.1);
  std::vector<Shape<D>> out = {Shape<D>::sphere(Real(0.3)), Shape<D>::capsule(Real(0.3), Real(0.1)),
                               Shape<D>::box(half), Shape<D>::box(half, Real(0.05)), spiky<D>()};
  for (const auto& [kind, made] : curvedKinds<D>()) {
    const std::vector<Real> sizes(made.sizes.size(), Real(0.3));
    out.push_back(Shape<D>::curved(kind, sizes, Real(0.01)));
  }
  const ShapePart<D> parts[] = {{Shape<D>::box(half), {test::at<D>(0.3, 0), {}}}, {out[0], {test::at<D>(-0.3, 0), {}}}};
  out.push_back(Shape<D>::compound(parts));
  return out;
}

/// Bodies of all kinds fall on a plane and on each other. Two of them never collide, and now and then one is removed
/// and another takes its slot. Each body has its own number as user data.
template <int D>
class Crowd {
 public:
  Crowd() : world(Pipeline::parse(kPipeline)), collector("crowd", kDt, world.settings().margin) {
    BodyDef<D> ground = test::body<D>(Shape<D>::plane(), test::at<D>(0, 0), BodyType::fixed);
    add(ground);
    for (const Shape<D>& shape : everyShape<D>()) {
      for (int i = 0; i < 2; ++i, ++m_count) {
        BodyDef<D> def = test::body<D>(shape, test::at<D>(0.4 * (m_count % 5), 0.6 + 0.35 * m_count, 0.1 * i));
        if (m_count % 7 == 3) def.shapes[0].mask = 2;
        m_handles.push_back(add(def));
      }
    }
    world.add(test::pivot<D>(m_handles[0], m_handles[2], test::at<D>(0, 1)));
  }

  /// Writes the pairs of the coming step, and steps.
  void step() {
    if (steps % 20 == 10) {
      world.remove(m_handles.back());
      m_handles.back() = add(test::body<D>(Shape<D>::sphere(Real(0.25)), test::at<D>(0.4, 0.3)));
    }
    ASSERT_TRUE(collector.see(world, steps, kNoLimit));
    world.step(kDt);
    ++steps;
  }

  static constexpr Real kDt = Real(1) / 60;
  World<D> world;
  PairCollector<D> collector;
  long steps = 0;

 private:
  BodyHandle add(BodyDef<D> def) {
    def.userData = ++m_names;
    return world.add(def);
  }
  int m_count = 0;
  std::uint64_t m_names = 0;
  std::vector<BodyHandle> m_handles;
};

using Ids = std::set<std::pair<std::array<std::int32_t, 3>, std::array<std::int32_t, 3>>>;  // body, shape, child; twice

void addId(Ids& ids, const std::array<std::int32_t, 3>& a, const std::array<std::int32_t, 3>& b) {
  EXPECT_TRUE(ids.insert(std::minmax(a, b)).second) << "twice in a step";
}

/// The queries of the stream's last step.
template <int D>
std::span<const typename PairStream<D>::PairPose> lastPairPoses(const PairStream<D>& stream) {
  return std::span(stream.pairPoses).last(stream.steps.back().pairPoses);
}

template <int D>
Ids lastIds(const PairStream<D>& stream) {
  Ids out;
  for (const auto& m : lastPairPoses(stream)) {
    const auto& p = stream.pairs[m.pair];
    addId(out, {p.a.body, p.a.shape, p.a.part}, {p.b.body, p.b.shape, p.b.part});
  }
  return out;
}

/// The queries of the world's last step, from its pair records.
template <int D>
Ids askedIds(const World<D>& world) {
  Ids out;
  const auto index = [&](std::int32_t slot) { return world.shapes()[static_cast<std::size_t>(slot)].index; };
  for (const PairRecord& r : world.pairRecords()) {
    addId(out, {r.bodyA, index(r.shapeA), r.partA}, {r.bodyB, index(r.shapeB), r.partB});
  }
  return out;
}

template <int D>
void asAWorldAsks() {
  Crowd<D> crowd;
  std::size_t met = 0;
  bool isLate = false;
  for (int i = 0; i < 100; ++i) {
    crowd.step();
    const Ids ids = lastIds(crowd.collector.stream());
    ASSERT_EQ(ids, askedIds(crowd.world)) << "step " << i;
    met += ids.size();
    PairCollector<D> late("crowd", crowd.kDt, crowd.world.settings().margin);
    late.see(crowd.world, i, kNoLimit);
    isLate = isLate || lastIds(late.stream()) != ids;
  }
  EXPECT_GT(met, 1000u);
  test::expectCaught("PairCollector looks after the step", !isLate);
}
TEST(PairStream, HoldsTheQueriesOfAWorld2) { asAWorldAsks<2>(); }
TEST(PairStream, HoldsTheQueriesOfAWorld3) { asAWorldAsks<3>(); }

/// Number of pairs of parts that may collide, are nearer than the margin and are not in these ids. Tests every two
/// parts with a query.
template <int D>
int missing(const World<D>& world, const Ids& ids) {
  struct Part {
    std::array<std::int32_t, 3> id;
    ShapeView<D> view;
    Pose<D> X_WP;
    const ShapeRecord<D>* shape;
  };
  std::vector<Part> parts;
  const Bodies<D>& bodies = world.bodies();
  for (const ShapeRecord<D>& s : world.shapes()) {
    if (s.body < 0) continue;
    std::int32_t part = 0;
    forParts(s.shape, bodies.pose[static_cast<std::size_t>(s.body)] * s.X_CS,
             [&](const ShapeView<D>& view, const Pose<D>& X_WP) {
               parts.push_back({{s.body, s.index, part++}, view, X_WP, &s});
             });
  }
  const auto query = createStage<PairQuery<D>>({"gjk_epa", {}});
  int out = 0;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    for (std::size_t j = i + 1; j < parts.size(); ++j) {
      const Part &a = parts[i], &b = parts[j];
      const auto joined = [&](const JointRecord<D>& joint) {
        return joint.active() && std::minmax(joint.bodyA, joint.bodyB) == std::minmax(a.id[0], b.id[0]);
      };
      const auto moves = [&](const Part& p) { return bodies.active(p.id[0]); };
      if (a.id[0] == b.id[0] || (!moves(a) && !moves(b))) continue;
      if (!(a.shape->category & b.shape->mask) || !(b.shape->category & a.shape->mask)) continue;
      if (std::any_of(world.joints().begin(), world.joints().end(), joined)) continue;
      const Real distance =
          queryPair(*query, a.view, b.view, poseBetween(a.X_WP, b.X_WP), QueryNeed::distance).distance;
      out += distance <= world.settings().margin && !ids.contains(std::minmax(a.id, b.id));
    }
  }
  return out;
}

template <int D>
void nobodyNearIsMissing() {
  Crowd<D> crowd;
  int narrow = 0, partless = 0, forgetful = 0;
  for (int i = 0; i < 60; ++i) {
    const PairStream<D>& stream = crowd.collector.stream();
    ASSERT_TRUE(crowd.collector.see(crowd.world, i, kNoLimit));
    const Ids ids = lastIds(stream);
    ASSERT_EQ(missing(crowd.world, ids), 0) << "step " << i;
    PairCollector<D> tight("crowd", crowd.kDt, -crowd.world.settings().margin);
    tight.see(crowd.world, i, kNoLimit);
    narrow += missing(crowd.world, lastIds(tight.stream()));
    Ids first, most = ids;
    for (const auto& [a, b] : ids) {
      if (a[2] == 0 && b[2] == 0) first.emplace(a, b);
    }
    if (!most.empty()) most.erase(most.begin());
    partless += missing(crowd.world, first), forgetful += missing(crowd.world, most);
    crowd.world.step(crowd.kDt);
  }
  test::expectCaught("PairCollector takes boxes that shrink by the margin", narrow == 0);
  test::expectCaught("PairCollector takes the first part of a compound alone", partless == 0);
  test::expectCaught("PairCollector forgets a pair", forgetful == 0);
}
TEST(PairStream, HoldsEveryNearPair2) { nobodyNearIsMissing<2>(); }
TEST(PairStream, HoldsEveryNearPair3) { nobodyNearIsMissing<3>(); }

/// Whether numbers and pairs of parts correspond one to one, and each pose is that of its parts. Names are user data.
template <int D, class NumberOf>
bool keepsNumbers(const NumberOf& numberOf) {
  using Name = std::array<std::uint64_t, 3>;  // user data of body, of shape; child
  std::map<std::pair<Name, Name>, std::uint32_t> byName;
  std::map<std::uint32_t, std::pair<Name, Name>> byNumber;
  Crowd<D> crowd;
  bool right = true;
  for (int i = 0; i < 100; ++i) {
    crowd.collector.see(crowd.world, i, kNoLimit);
    const PairStream<D>& stream = crowd.collector.stream();
    for (const auto& m : lastPairPoses(stream)) {
      const auto& p = stream.pairs[m.pair];
      const auto name = [&](const PartOfBody& part) {
        const std::uint64_t body = crowd.world.userData(crowd.world.handle(part.body));
        return Name{body, static_cast<std::uint64_t>(part.shape), static_cast<std::uint64_t>(part.part)};
      };
      const std::pair<Name, Name> names(name(p.a), name(p.b));
      const std::uint32_t number = numberOf(stream, m);
      right = right && byName.emplace(names, number).first->second == number;
      right = right && byNumber.emplace(number, names).first->second == names;
    }
    crowd.step();
  }
  EXPECT_GT(byName.size(), 10u);
  return right;
}
template <int D>
void pairsKeepTheirNumbers() {
  EXPECT_TRUE(keepsNumbers<D>([](const auto&, const auto& m) { return m.pair; }));
  std::map<std::array<std::int32_t, 6>, std::uint32_t> bySlot;
  const bool ofSlots = keepsNumbers<D>([&](const auto& stream, const auto& m) {
    const auto& p = stream.pairs[m.pair];
    const std::array key = {p.a.body, p.a.shape, p.a.part, p.b.body, p.b.shape, p.b.part};
    return bySlot.emplace(key, static_cast<std::uint32_t>(bySlot.size())).first->second;
  });
  test::expectCaught("PairStream takes a slot's next body for the last one", ofSlots);
  const bool byPlace = keepsNumbers<D>(
      [&](const auto& stream, const auto& m) { return static_cast<std::uint32_t>(&m - lastPairPoses(stream).data()); });
  test::expectCaught("PairStream numbers pairs anew in each step", byPlace);
}
TEST(PairStream, PairsKeepTheirNumbers2) { pairsKeepTheirNumbers<2>(); }
TEST(PairStream, PairsKeepTheirNumbers3) { pairsKeepTheirNumbers<3>(); }

TEST(PairStream, EndsBeforeItsLimit) {
  Crowd<3> crowd;
  std::size_t full = 0;
  for (int i = 0; i < 100 && full == 0; ++i) {
    crowd.world.step(crowd.kDt);
    const std::size_t had = crowd.collector.stream().pairPoses.size();
    if (!crowd.collector.see(crowd.world, i, 500)) full = had;
  }
  EXPECT_GT(full, 400u);
  EXPECT_LE(full, 500u);
  EXPECT_EQ(crowd.collector.stream().pairPoses.size(), full);
}

template <int D>
PairStream<D> crowdStream() {
  Crowd<D> crowd;
  for (int i = 0; i < 40; ++i) crowd.step();
  return crowd.collector.stream();
}

template <int D>
std::string written(const PairStream<D>& stream) {
  std::ostringstream out;
  writePairs<D>(out, stream);
  return out.str();
}

/// Distances of all queries, and their pairs.
template <int D>
bool asksTheSame(const PairStream<D>& a, const PairStream<D>& b) {
  if (a.scene != b.scene || a.dt != b.dt || a.margin != b.margin || a.pairPoses.size() != b.pairPoses.size())
    return false;
  const auto sameStep = [](const auto& x, const auto& y) { return x.step == y.step && x.pairPoses == y.pairPoses; };
  const auto samePair = [](const auto& x, const auto& y) { return x.a == y.a && x.b == y.b; };
  if (!std::equal(a.steps.begin(), a.steps.end(), b.steps.begin(), b.steps.end(), sameStep)) return false;
  if (!std::equal(a.pairs.begin(), a.pairs.end(), b.pairs.begin(), b.pairs.end(), samePair)) return false;
  const auto query = createStage<PairQuery<D>>({"gjk_epa", {}});
  const auto distance = [&](const PairView<D>& v) {
    return queryPair(*query, v.a, v.b, v.X_AB, QueryNeed::distance).distance;
  };
  for (std::size_t i = 0; i < a.pairPoses.size(); ++i) {
    const PairView<D> x = a.view(a.pairPoses[i]), y = b.view(b.pairPoses[i]);
    if (a.pairPoses[i].pair != b.pairPoses[i].pair || x.a.kind != y.a.kind || x.b.kind != y.b.kind) return false;
    // A rebuilt hull may have its corners in another order: the same distance up to rounding.
    if (std::abs(double(distance(x) - distance(y))) > 1e-9) return false;
  }
  return true;
}

template <int D>
void isReadAsWritten() {
  const PairStream<D> stream = crowdStream<D>();
  std::set<ShapeKind> kinds;
  for (const Shape<D>& s : stream.shapes) kinds.insert(s.kind());
  EXPECT_EQ(kinds.size(), D == 2 ? 6u : 8u) << "all but the segment, which has no mass";
  EXPECT_EQ(stream.shapes.size(), kinds.size() + 2) << "two boxes, two balls; a compound's parts are known";
  const PairStreamFile file = PairStreamFile::parse(written(stream), "p");
  ASSERT_EQ(file.dimension, D);
  EXPECT_TRUE(asksTheSame(file.of<D>(), stream));
  const PairStreamFile again = PairStreamFile::parse(written(file.of<D>()), "p");
  EXPECT_TRUE(asksTheSame(again.of<D>(), stream));
  const auto plant = [&](const char* what, const auto& change) {
    PairStream<D> planted = stream;
    change(planted);
    const PairStreamFile read = PairStreamFile::parse(written(planted), "p");
    test::expectCaught(std::string("a file of pairs ") + what, asksTheSame(read.of<D>(), stream));
  };
  plant("loses roundings", [](auto& s) {
    for (auto& shape : s.shapes) {
      if (shape.view().hull) shape = Shape<D>::polytope(std::span<const Vec<D>>(shape.view().hull->vertices));
    }
  });
  plant("keeps float", [](auto& s) {
    for (auto& m : s.pairPoses) m.X_AB.p = m.X_AB.p.template cast<float>().template cast<Real>().eval();
  });
  plant("turns poses back", [](auto& s) {
    for (auto& m : s.pairPoses) m.X_AB.q = m.X_AB.q.inverse();
  });
  plant("forgets which step it was", [](auto& s) {
    for (auto& step : s.steps) ++step.step;
  });
  plant("forgets whose parts they are", [](auto& s) {
    for (auto& p : s.pairs) p.a.generation = p.b.generation = 0;
  });
}
TEST(PairStreamFile, IsReadAsWritten2) { isReadAsWritten<2>(); }
TEST(PairStreamFile, IsReadAsWritten3) { isReadAsWritten<3>(); }

std::string refusal(const std::string& bytes) {
  try {
    PairStreamFile::parse(bytes, "p.pairs");
  } catch (const UserError& e) {
    const std::string said = e.what();
    EXPECT_EQ(said.find('\n'), said.npos) << said;
    return said;
  }
  return "";
}

TEST(PairStreamFile, DamageIsRefusedInOneLine) {
  const std::string good = written(crowdStream<2>());
  EXPECT_EQ(refusal(good), "");
  for (std::size_t n = 0; n < good.size(); n += 1 + good.size() / 200) {
    EXPECT_NE(refusal(good.substr(0, n)), "") << "cut after " << n << " bytes";
    std::string flipped = good;
    flipped[n] = static_cast<char>(flipped[n] ^ (1 << n % 8));
    EXPECT_NE(refusal(flipped), "") << "byte " << n;
  }
  EXPECT_NE(refusal(good + "x"), "");
}

// A file by another program, with a valid checksum.
TEST(PairStreamFile, NonsenseIsRefusedInOneLine) {
  const auto sign = [](std::string bytes) {
    const std::uint64_t sum = XXH64(bytes.data(), bytes.size(), 0);
    return bytes.append(reinterpret_cast<const char*>(&sum), sizeof sum);
  };
  const std::string header =
      "{\"format\": \"lpc pairs\", \"version\": 1, \"dimension\": 2, \"scene\": \"s\", \"dt\": 0.02, \"margin\": 0.02, "
      "\"steps\": [[4,1]], \"shapes\": [{\"kind\":\"sphere\",\"rounding\":1,\"sizes\":[]},"
      "{\"kind\":\"box\",\"rounding\":0,\"sizes\":[1,2]}], \"pairs\": [[0,5,0,0,0,1,6,1,0,0]]}\n";
  std::string pairPose(4, '\0');
  for (const double x : {1.0, 2.0, 0.6, 0.8}) pairPose.append(reinterpret_cast<const char*>(&x), sizeof x);
  const PairStreamFile file = PairStreamFile::parse(sign(header + pairPose), "p.pairs");
  ASSERT_EQ(file.in2.pairPoses.size(), 1u);
  EXPECT_EQ(file.in2.view(file.in2.pairPoses[0]).b.half, Vec<2>(1, 2));
  EXPECT_EQ(file.in2.pairPoses[0].X_AB.q.s, Real(0.8));
  EXPECT_EQ(file.in2.pairs[0].b.generation, 1u);
  const struct {
    std::string from, to;
    Parts parts;
  } cases[] = {
      {"lpc pairs", "lpc problems", {"p.pairs: not a file of pairs", "lpc record --pairs"}},
      {"\"version\": 1", "\"version\": 2", {"version is wrong; valid: 1"}},
      {"\"dimension\": 2", "\"dimension\": 4", {"dimension is wrong; valid: a whole number from 2 to 3"}},
      {"\"dimension\": 2", "\"dimension\": 3", {"shapes 1 is wrong; valid: a list of 3"}},
      {"\"scene\": \"s\"", "\"scene\": 7", {"scene is wrong; valid: a text"}},
      {"\"margin\": 0.02, ", "", {"the header lacks 'margin'"}},
      {"\"dt\": 0.02", "\"dt\": -1", {"dt is wrong; valid: 0 or more"}},
      {"[[4,1]]", "[[4,2]]", {"steps 0 is wrong; valid: a whole number from 0 to 1"}},
      {"[[4,1]]", "[[4,0]]", {"the number of bytes after the header is wrong"}},
      {"[[4,1]]", "[[4,0],[4,1]]", {"steps 1 is wrong; valid: a whole number from 5 to"}},
      {"[[4,1]]", "[4]", {"steps 0 is wrong; valid: a list of 2"}},
      {"\"box\"", "\"cylinder\"", {"shapes 1 is wrong; valid: a kind of this dimension"}},
      {"\"box\"", "\"bottle\"", {"p.pairs: shapes 1: ", "bottle"}},
      {"[1,2]", "[1,-2]", {"p.pairs: shapes 1: ", "-2"}},
      {"[1,2]", "[1,null]", {"shapes 1 is wrong; valid: a finite number"}},
      {"\"box\"", "\"polytope\"", {"shapes 1 lacks 'points'"}},
      {"[0,5,0,0,0,1", "[0,5,0,0,0,2", {"pairs 0 is wrong; valid: a whole number from 0 to 1"}},
      {"[0,5,0,0,0,1,6", "[1,5,0,0,0,0,6", {"pairs 0 is wrong; valid: as first shape the kind that comes first"}},
      {"[0,5,0", "[0,5", {"pairs 0 is wrong; valid: a list of 10"}},
      {"[0,5", "[0,-5", {"pairs 0 is wrong"}},
  };
  for (const auto& c : cases) {
    std::string bad = header;
    ASSERT_NE(bad.find(c.from), bad.npos) << c.from;
    expectParts(refusal(sign(bad.replace(bad.find(c.from), c.from.size(), c.to) + pairPose)), c.parts, c.to);
  }
  std::string other = pairPose, turned = pairPose, nowhere = pairPose;
  other[0] = 1, turned[4 + 3 * 8 + 6] = 0, nowhere[4 + 6] = nowhere[4 + 7] = 127;
  expectParts(refusal(sign(header + other)), {"the number of a pair in a step is wrong; valid: 0 to 0"}, "a pair");
  expectParts(refusal(sign(header + turned)), {"a pose is wrong"}, "a rotation");
  nowhere[4 + 6] = static_cast<char>(0xf0);
  expectParts(refusal(sign(header + nowhere)), {"a pose is wrong"}, "a place");
}

TEST(RecordPairs, WritesThoseOfSteps) {
  Workspace w;
  const std::string scene = "record vertical_stack --param n=4 --param gap=0 --pairs ";
  const test::Outcome some = w.lpc(scene + "p.pairs --steps 3,10:14");
  ASSERT_EQ(some.code, 0) << some.text;
  const PairStream<2> stream = PairStreamFile::load(w.path("p.pairs")).in2;
  std::vector<long> steps;
  for (const auto& s : stream.steps) {
    steps.push_back(s.step);
    EXPECT_EQ(s.pairPoses, 4u);
  }
  EXPECT_EQ(steps, (std::vector<long>{3, 10, 11, 12, 13, 14}));
  EXPECT_EQ(stream.scene, "vertical_stack");
  EXPECT_EQ(stream.pairs.size(), 4u);
  EXPECT_NE(some.text.find("6 steps, 24 pairs in total, 4 distinct pairs, 2 shapes\n"), std::string::npos) << some.text;
  EXPECT_EQ(test::filesIn(w).size(), 1u);

  // Any broadphase and generator that give the same trajectory give the same bytes.
  ASSERT_EQ(w.lpc(scene + "q.pairs --steps 3,10:14 --pipeline broadphase=naive").code, 0);
  EXPECT_EQ(readFile(w.path("q.pairs")), readFile(w.path("p.pairs")));

  w.write("t.toml",
          "name = \"t\"\nsummary = \"s\"\ndimensions = [3]\nsteps = 5\n[[body]]\n"
          "shapes = [{ kind = \"sphere\", radius = 1 }, { kind = \"sphere\", radius = 1 }]\n[[body]]\n"
          "position = [0, 1, 0]\nshapes = [{ kind = \"sphere\", radius = 1 }]\n");
  const test::Outcome all = w.lpc("record t.toml --pairs t.pairs");
  ASSERT_EQ(all.code, 0) << all.text;
  EXPECT_EQ(PairStreamFile::load(w.path("t.pairs")).in3.steps.size(), 5u);
}

TEST(RecordPairs, RefusesInOneLine) {
  Workspace w;
  w.write("s.toml",
          "name = \"t\"\nsummary = \"s\"\ndimensions = [2]\nsteps = 5\n[[body]]\n"
          "shapes = [{ kind = \"circle\", radius = 1 }]\n");
  const std::string p = " --pairs p.pairs";
  refused(w, "record vertical_stack --steps 3" + p + " --problems p.json", {"--pairs", "excludes", "--problems"});
  refused(w, "record vertical_stack --hardest 3" + p, {"--hardest", "excludes", "--pairs"});
  for (const char* steps : {"3:", ":3", "5:3", "x", "3x", "-3", "3:-4", "''", "99999999999", "1.5", "3:4:5"}) {
    refused(w, std::string("record vertical_stack --steps ") + steps + p, {"--steps"});
    refused(w, std::string("record vertical_stack --problems p.json --steps ") + steps, {"--steps"});
  }
  refused(w, "record s.toml" + p, {"no boxes of 's.toml' come near each other"});
  refused(w, "record s.toml --pairs s.toml", {"overwrite the scene s.toml"});
  refused(w, "record vertical_stack --steps 0:3 --pairs none/p.pairs", {"none/p.pairs: cannot be written"});
  refused(w, "record vertical_stack --steps 0:3 --pipeline engine=box2d" + p, {"an engine gives no access to"});
  refused(w, "record tumbler --steps 0:299" + p, {"have more than 1000000 pairs", "valid: fewer steps"});
}

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::pair_stream_test
