// SPDX-License-Identifier: Zlib
// Planted witnesses that hang, abort, throw and return wrong numbers: each ending is recorded for its pair, and the
// other pairs are answered.
#include "oracles/witnesses/witness_process.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <stdexcept>
#include <thread>

namespace lpc { inline namespace LPC_PRECISION { namespace witness_process_test { namespace {

enum class Fault { throws, throwsInPlace, aborts, segfaults, exits, spins, sleeps, nan, infiniteNormal, prints };

// Answers the pair at (x, 0, 0) with -x and the normal x, but misbehaves at chosen places.
class Planted final : public IsolatedWitness<3> {
 public:
  std::map<int, Fault> faults;

  bool supports(ShapeKind, ShapeKind) const override { return true; }

 private:
  void place(const PairView<3>& pair) override {
    m_x = pair.X_AB.p[0];
    if (is(Fault::throwsInPlace)) throw std::logic_error("planted");
  }
  PairAnswer<3> measure() override {
    if (is(Fault::throws)) throw 42;
    if (is(Fault::aborts)) std::abort();
    if (is(Fault::segfaults)) raise(SIGSEGV);
    if (is(Fault::exits)) std::_Exit(0);
    for (volatile int turns = 0; is(Fault::spins);) turns = turns + 1;
    while (is(Fault::sleeps)) sleep(1);
    if (is(Fault::prints)) std::cout << "planted" << std::endl, std::cerr << "planted" << std::endl;
    PairAnswer<3> answer;
    answer.status = QueryStatus::converged;
    answer.distance = is(Fault::nan) ? std::numeric_limits<Real>::quiet_NaN() : -m_x;
    answer.normal = Vec<3>::Unit(0);
    if (is(Fault::infiniteNormal)) answer.normal[1] = std::numeric_limits<Real>::infinity();
    return answer;
  }
  bool is(Fault fault) const {
    const auto found = faults.find(static_cast<int>(m_x));
    return found != faults.end() && found->second == fault;
  }

  Real m_x = 0;
};

std::vector<PairView<3>> pairsInARow(int count) {
  std::vector<PairView<3>> pairs(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) pairs[static_cast<std::size_t>(i)].X_AB.p = Vec<3>(Real(i), 0, 0);
  return pairs;
}

void expectBooked(Planted& witness, int count, const std::map<int, Ending>& expected) {
  std::vector<PairAnswer<3>> answers(static_cast<std::size_t>(count));
  witness.ask(pairsInARow(count), answers);
  ASSERT_EQ(witness.endings().size(), answers.size());
  for (int i = 0; i < count; ++i) {
    const auto found = expected.find(i);
    const Ending want = found == expected.end() ? Ending::answered : found->second;
    const auto k = static_cast<std::size_t>(i);
    EXPECT_EQ(endingName(witness.endings()[k]), endingName(want)) << "pair " << i;
    EXPECT_EQ(answers[k].status, want == Ending::answered ? QueryStatus::converged : QueryStatus::failed) << i;
    if (want == Ending::answered) {
      EXPECT_EQ(answers[k].distance, Real(-i));
    }
  }
  EXPECT_GT(witness.nanoseconds(), 0);
}

// Also around the ends of blocks of 1,000, and twice in a row.
TEST(WitnessProcess, EachEndingIsRecordedForItsPair) {
  Planted witness;
  witness.faults = {{0, Fault::aborts},
                    {1, Fault::throws},
                    {2, Fault::nan},
                    {17, Fault::spins},
                    {700, Fault::segfaults},
                    {701, Fault::segfaults},
                    {999, Fault::aborts},
                    {1000, Fault::exits},
                    {1001, Fault::throwsInPlace},
                    {1999, Fault::spins},
                    {2000, Fault::infiniteNormal},
                    {2001, Fault::sleeps},
                    {2499, Fault::aborts}};
  expectBooked(witness, 2500,
               {{0, Ending::crashed},
                {1, Ending::threw},
                {2, Ending::notFinite},
                {17, Ending::hung},
                {700, Ending::crashed},
                {701, Ending::crashed},
                {999, Ending::crashed},
                {1000, Ending::crashed},
                {1001, Ending::threw},
                {1999, Ending::hung},
                {2000, Ending::notFinite},
                {2001, Ending::hung},
                {2499, Ending::crashed}});
}

TEST(WitnessProcess, BlocksOfAnyLengthAreAnswered) {
  Planted witness;
  for (const int count : {1, 2, 999, 1000, 1001, 2000, 3}) expectBooked(witness, count, {});
}

// Through the stage's interface, on a batch longer than a block.
TEST(WitnessProcess, BatchesAreAnswered) {
  Planted witness;
  witness.faults = {{3, Fault::throws}, {1023, Fault::aborts}};
  const std::vector<PairView<3>> pairs = pairsInARow(1024);
  std::vector<PairAnswer<3>> answers(pairs.size());
  WorkDone work;
  witness.query(pairs, QueryNeed::closestPoints, answers, {}, work);
  EXPECT_EQ(work[WorkCount::pairQueries], 1024u);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const bool planted = i == 3 || i == 1023;
    EXPECT_EQ(answers[i].status, planted ? QueryStatus::failed : QueryStatus::converged) << i;
    if (!planted) {
      EXPECT_EQ(answers[i].distance, -static_cast<Real>(i));
    }
  }
  EXPECT_EQ(witness.endings()[3], Ending::threw);
  EXPECT_EQ(witness.endings()[1023], Ending::crashed);
}

// Sums of all numbers of a pair, weighted by their position: one of the lengths, which the child process gets in
// another unit, and one of the rest.
struct Fingerprint {
  Real lengths = 0, rest = 0, weight = 1;

  void step() { weight = weight < 2 ? weight + Real(0.125) : Real(1); }
  void addLength(Real x) { lengths += x * weight, step(); }
  void add(Real x) { rest += x * weight, step(); }
  void add(const ShapeView<3>& shape) {
    add(Real(static_cast<int>(shape.kind)));
    for (const Real x : {shape.radius, shape.half[0], shape.half[1], shape.half[2]}) addLength(x);
    if (!shape.hull) return;
    for (const Vec<3>& v : shape.hull->vertices) addLength(v[0]), addLength(v[1]), addLength(v[2]);
    for (const auto& f : shape.hull->faces) {
      addLength(f.offset);
      for (const Real x : {f.normal[0], f.normal[1], f.normal[2], Real(f.begin), Real(f.end)}) add(x);
    }
    for (const int i : shape.hull->loop) add(Real(i));
  }
  explicit Fingerprint(const PairView<3>& pair) {
    add(pair.a), add(pair.b);
    for (int k = 0; k < 3; ++k) addLength(pair.X_AB.p[k]);
    for (const Real x : {pair.X_AB.q.w, pair.X_AB.q.x, pair.X_AB.q.y, pair.X_AB.q.z}) add(x);
  }
};

class Fingerprints final : public IsolatedWitness<3> {
 public:
  bool supports(ShapeKind, ShapeKind) const override { return true; }

 private:
  void place(const PairView<3>& pair) override {
    const Fingerprint print(pair);
    m_answer.distance = print.lengths, m_answer.normal[0] = print.rest;
  }
  PairAnswer<3> measure() override { return m_answer; }

  PairAnswer<3> m_answer;
};

TEST(WitnessProcess, ShapesArriveWhole) {
  const std::vector<Vec<3>> points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, Real(1.25)}, {1, 1, Real(0.5)}};
  const Shape<3> hull = Shape<3>::polytope(points, Real(0.125)), box = Shape<3>::box({1, 2, 3}, Real(0.5)),
                 capsule = Shape<3>::capsule(2, Real(0.25));
  // Larger than the initial memory of a block, alone and 40 times: the memory grows, and the block is shortened.
  Polytope<3> huge, large;
  for (int i = 0; i < 500000; ++i)
    huge.vertices.emplace_back(Real(i % 7), Real(i % 11), Real(1)), huge.loop.push_back(i);
  large.vertices.assign(huge.vertices.begin(), huge.vertices.begin() + 20000);
  large.faces.push_back({Vec<3>::Unit(2), 1, 0, 3});
  const ShapeView<3> hugeView{ShapeKind::polytope, 0, Vec<3>::Zero(), &huge},
      largeView{ShapeKind::polytope, 0, Vec<3>::Zero(), &large};
  const Pose<3> X{{1, 2, 3}, Rot<3>{Real(0.5), Real(-0.5), Real(0.5), Real(0.5)}};
  std::vector<PairView<3>> pairs = {{hull.view(), box.view(), X}, {capsule.view(), hull.view(), X}};
  for (int i = 0; i < 40; ++i) pairs.push_back({largeView, i % 2 ? largeView : hull.view(), X});
  pairs.push_back({hugeView, hull.view(), X});
  pairs.push_back({hull.view(), hull.view(), X});
  std::vector<PairAnswer<3>> answers(pairs.size());
  Fingerprints witness;
  witness.ask(pairs, answers);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Fingerprint print(pairs[i]);
    EXPECT_EQ(answers[i].distance, print.lengths) << i;
    EXPECT_EQ(answers[i].normal[0], print.rest) << i;
  }
}

// Returns the distance from A to B and their positions, with the x axis of the frame as normal.
class Placed final : public IsolatedWitness<3> {
 public:
  using IsolatedWitness::IsolatedWitness;
  bool supports(ShapeKind, ShapeKind) const override { return true; }

 private:
  void place(const PairView<3>& pair) override {
    m_answer.distance = (placeOfB(pair).p - placeOfA().p).norm();
    m_answer.pA = placeOfA().p, m_answer.pB = placeOfB(pair).p, m_answer.normal = Vec<3>::Unit(0);
  }
  PairAnswer<3> measure() override { return m_answer; }

  PairAnswer<3> m_answer;
};

TEST(WitnessProcess, WorldFrameDiffersFromOwnFrame) {
  const auto pairs = pairsInARow(3);
  std::vector<PairAnswer<3>> own(3), world(3);
  Placed(PairFrame::own).ask(pairs, own);
  Placed(PairFrame::world).ask(pairs, world);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(own[i].normal, Vec<3>(Vec<3>::Unit(0)));
    EXPECT_EQ(own[i].pB, pairs[i].X_AB.p);
    EXPECT_LT(std::abs(world[i].normal[0]), Real(0.9)) << "the world's x is not A's";
    EXPECT_NEAR(world[i].normal.norm(), 1, 1e-6);
    EXPECT_NEAR((world[i].pB - pairs[i].X_AB.p).norm(), 0, 1e-5) << i;  // transformed back to A's frame
    EXPECT_NEAR(world[i].pA.norm(), 0, 1e-5);
    EXPECT_NEAR(world[i].distance, own[i].distance, 1e-5);
  }
}

// Returns its process id.
class Named final : public IsolatedWitness<3> {
 public:
  bool supports(ShapeKind, ShapeKind) const override { return true; }
  pid_t process() {
    std::vector<PairAnswer<3>> answers(1);
    ask(pairsInARow(1), answers);
    EXPECT_EQ(endings()[0], Ending::answered);
    return static_cast<pid_t>(answers[0].distance);
  }

 private:
  void place(const PairView<3>&) override {}
  PairAnswer<3> measure() override {
    PairAnswer<3> answer;
    answer.status = QueryStatus::converged;
    answer.distance = static_cast<Real>(getpid());
    return answer;
  }
};

// 'R', 'S', 'Z' ...; 0 if there is no such process.
char stateOf(pid_t process) {
  std::ifstream in("/proc/" + std::to_string(process) + "/stat");
  std::string number, name;
  char state = 0;
  in >> number >> name >> state;
  return state;
}
std::size_t openFiles() {
  std::size_t count = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) ++count;
  return count;
}

TEST(WitnessProcess, OneProcessLivesAsLongAsItsWitness) {
  const std::size_t files = openFiles();
  auto witness = std::make_unique<Named>();
  const pid_t process = witness->process();
  EXPECT_NE(process, getpid());
  EXPECT_EQ(witness->process(), process);
  EXPECT_EQ(openFiles(), files);
  EXPECT_NE(stateOf(process), 0);
  witness.reset();
  EXPECT_EQ(stateOf(process), 0);  // not even a zombie
}

// A process killed while idle: no pair is at fault.
TEST(WitnessProcess, DyingIdleIsNoFaultOfAPair) {
  Named witness;
  const pid_t first = witness.process();
  kill(first, SIGKILL);
  EXPECT_NE(witness.process(), first);
  // The kernel also kills the process when the thread that forked it ends.
  Named threaded;
  pid_t second = 0;
  std::thread([&] { second = threaded.process(); }).join();
  EXPECT_NE(threaded.process(), 0);
}

TEST(WitnessProcess, AForkedCopyHasAProcessOfItsOwn) {
  Named witness;
  const pid_t first = witness.process(), child = fork();
  if (child == 0) {
    const pid_t own = witness.process();
    std::_Exit(own != first && own > 0 && stateOf(first) != 0 ? 0 : 1);
  }
  int status = -1;
  waitpid(child, &status, 0);
  EXPECT_EQ(status, 0);
  EXPECT_EQ(witness.process(), first);
}

TEST(WitnessProcess, ItDiesWithItsParent) {
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  const pid_t parent = fork();
  if (parent == 0) {
    Named witness;
    const pid_t process = witness.process();
    if (write(ends[1], &process, sizeof process) != sizeof process) std::_Exit(1);
    for (;;) pause();
  }
  pid_t process = 0;
  ASSERT_EQ(read(ends[0], &process, sizeof process), static_cast<ssize_t>(sizeof process));
  close(ends[0]), close(ends[1]);
  EXPECT_NE(stateOf(process), 0);
  kill(parent, SIGKILL);
  waitpid(parent, nullptr, 0);
  // The new parent may leave it as a zombie.
  while (stateOf(process) != 0 && stateOf(process) != 'Z') std::this_thread::yield();
}

TEST(WitnessProcess, OutputIsDiscarded) {
  ::testing::internal::CaptureStdout();
  ::testing::internal::CaptureStderr();
  Planted witness;
  witness.faults = {{1, Fault::prints}};
  expectBooked(witness, 3, {});
  EXPECT_EQ(::testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::witness_process_test
