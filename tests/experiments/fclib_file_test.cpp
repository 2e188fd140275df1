// SPDX-License-Identifier: Zlib
// Velocity problems through FCLIB files: the same W, q, mu and equalities, and so the same velocities. Damaged or
// foreign files are rejected with a one-line message.
#include "experiments/trial/formats/fclib_file.h"

#include <cstring>
#include <fstream>
#include <limits>

#include "experiments/parse/toml_reader.h"
#include "experiments/trial/formats/fclib_library.h"
#include "experiments/trial/formats/library_process.h"
#include "experiments/trial/formats/problem_file.h"
#include "framework/problem/contact_problem.h"
#include "framework/stage/profiler.h"
#include "tests/expect_caught.h"
#include "tests/experiments/refused.h"
#include "tests/small_worlds.h"

namespace lpc { inline namespace LPC_PRECISION { namespace fclib_file_test { namespace {

using test::expectParts;
using test::refused;
using test::Workspace;

template <int D>
struct Freezer final : VelocityWatcher<D> {
  FrozenProblem<D> frozen;
  void see(const VelocityInput<D>& in) override { frozen = freeze(in, defaultGravity<D>()); }
};

/// A heap that falls on a moving ground, with a pendulum: contacts that slide, stick, open and bounce.
template <int D>
FrozenProblem<D> heapProblem() {
  World<D> world(Pipeline::parse("solver=split_solver{position=baumgarte}"));
  test::addHeap(world, 8, 3);
  Freezer<D> freezer;
  world.watch(&freezer);
  for (int i = 0; i < 60; ++i) world.step(Real(1) / 60);
  for (std::int32_t i = 0; i < freezer.frozen.bodies.size(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (freezer.frozen.bodies.type[k] != BodyType::fixed) continue;
    freezer.frozen.bodies.type[k] = BodyType::kinematic;
    freezer.frozen.bodies.motion[k].v = Vec<D>::Unit(0) / 4;
  }
  return freezer.frozen;
}

std::string messageOf(const std::string& bytes, const std::string& path) {
  std::ofstream(path, std::ios::binary) << bytes;
  try {
    ProblemFile::load(path);
  } catch (const UserError& e) {
    return e.what();
  }
  return "";
}

/// False if this build lacks FCLIB.
bool isThere(const FrozenProblem<2>& problem, const Workspace& w) {
  try {
    return !fclibBytes<2>(problem, w.path("probe")).empty();
  } catch (const UserError& e) {
    EXPECT_NE(std::string(e.what()).find("has no FCLIB; valid: a build with libfclib-dev"), std::string::npos)
        << e.what();
    return false;
  }
}

/// What defines a problem: normals and equality rows, which do not depend on the choice of tangents, and the solution.
struct Essence {
  std::vector<double> w, q, mu, velocity;

  double differs(const Essence& other) const {
    double most = 0;
    const auto compare = [&](const std::vector<double>& a, const std::vector<double>& b) {
      if (a.size() != b.size()) most = std::numeric_limits<double>::infinity();
      for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) most = std::max(most, std::abs(a[i] - b[i]));
    };
    compare(w, other.w), compare(q, other.q), compare(mu, other.mu), compare(velocity, other.velocity);
    return most;
  }
};

/// A resolver's input and its rows.
template <int D>
struct Asked {
  WorkDone work;
  Profiler profiler;
  VelocityInput<D> in;
  ContactProblem<D> rows;
  std::vector<double> u;
  explicit Asked(FrozenProblem<D>& problem) : in(problem.input(work, profiler)) {
    rows.set(in), rows.freeVelocities(in, u);
  }
};

template <int D>
Essence essenceOf(FrozenProblem<D> problem) {
  for (Manifold<D>& m : problem.manifolds) {
    for (ContactPoint<D>& c : m.points) c.impulse.fill(0);
  }
  for (JointRecord<D>& j : problem.joints) j.impulse.fill(0);
  const Asked<D> asked(problem);
  const ContactProblem<D>& rows = asked.rows;
  const std::vector<double>& u = asked.u;
  std::vector<std::int32_t> which;
  Essence out;
  for (std::int32_t i = 0; i < rows.size(); ++i) {
    if (rows.row(i).law == ProblemLaw::tangent) continue;
    which.push_back(i), out.q.push_back(u[static_cast<std::size_t>(i)]), out.mu.push_back(rows.row(i).friction);
  }
  rows.assemble(which, out.w);
  createStage<VelocityResolver<D>>(Spec::parse("proximal_newton{tolerance=1e-13}"))->solve(asked.in);
  for (std::size_t i = 0; i < problem.bodies.motion.size(); ++i) {
    if (problem.bodies.type[i] != BodyType::dynamic) continue;
    for (int k = 0; k < D; ++k) out.velocity.push_back(double(problem.bodies.motion[i].v[k]));
  }
  return out;
}

template <int D>
void roundTrip() {
  const FrozenProblem<D> problem = heapProblem<D>();
  ASSERT_GT(problem.points(), 5);
  ASSERT_EQ(problem.joints.size(), 1u);
  Workspace w;
  if (!isThere(heapProblem<2>(), w)) GTEST_SKIP() << "FCLIB is absent";
  std::ofstream(w.path("heap.hdf5"), std::ios::binary) << fclibBytes<D>(problem, w.path("heap.hdf5"));
  const ProblemFile file = ProblemFile::load(w.path("heap.hdf5"));
  ASSERT_EQ(file.dimension, D);
  ASSERT_EQ(file.size(), 1u);
  const FrozenProblem<D>& read = file.of<D>()[0].problem;
  const Essence expected = essenceOf(problem);
  EXPECT_LT(essenceOf(read).differs(expected), 1e-7);
  const auto plant = [&](const char* what, const auto& change) {
    FrozenProblem<D> planted = read;
    change(planted);
    test::expectCaught(std::string("FCLIB loses ") + what, essenceOf(planted).differs(expected) < 1e-7);
  };
  plant("friction", [](auto& p) { p.manifolds[0].friction += Real(0.01); });
  plant("a joint", [](auto& p) { p.joints.clear(); });
  plant("what is wanted", [](auto& p) { p.position = {}; });
  plant("the ground's velocity", [](auto& p) {
    for (std::size_t i = 0; i < p.bodies.motion.size(); ++i) {
      if (p.bodies.type[i] == BodyType::kinematic) p.bodies.motion[i] = {};
    }
  });
}
TEST(FclibFile, HoldsTheSameProblem2) { roundTrip<2>(); }
TEST(FclibFile, HoldsTheSameProblem3) { roundTrip<3>(); }

TEST(FclibFile, RefusesInOneLine) {
  FrozenProblem<2> problem = heapProblem<2>();
  problem.manifolds[0].friction = Real(0.37251);  // a number that occurs nowhere else
  Workspace w;
  if (!isThere(problem, w)) GTEST_SKIP() << "FCLIB is absent";
  const std::string path = w.path("p.hdf5"), good = fclibBytes<2>(problem, path);
  EXPECT_EQ(messageOf(good, path), "");
  const auto changed = [&](const std::string& from, const std::string& to) {
    std::string out = good;
    const std::size_t at = out.find(from);
    EXPECT_NE(at, out.npos) << from;
    return out.replace(at, from.size(), to);
  };
  const auto bytesOf = [](auto x) {
    std::string out(sizeof x, '\0');
    std::memcpy(out.data(), &x, sizeof x);
    return out;
  };
  const double mu = double(problem.manifolds[0].friction), nan = std::numeric_limits<double>::quiet_NaN();
  const auto points = static_cast<std::uint64_t>(problem.points());
  const struct {
    std::string bytes;
    test::Parts parts;
  } cases[] = {
      {"", {"not a file of problems"}},
      {"mass,velocity\n1,2\n", {"not a file of problems"}},
      {good.substr(0, 8), {"it is damaged", "FCLIB's global form"}},
      {good.substr(0, good.size() / 2), {"it is damaged"}},
      {changed("fclib_global", "other_global"), {"it contains no FCLIB problem", "valid: "}},
      {changed("fclib_global", std::string("fclib_local\0", 12)), {"the list is missing: /fclib_local/W/m"}},
      {changed(bytesOf(mu), bytesOf(nan)), {"mu is not finite"}},
      {changed(bytesOf(mu), bytesOf(-mu)), {"friction is negative"}},
  };
  for (const auto& c : cases) {
    const std::string said = messageOf(c.bytes, path);
    expectParts(said, c.parts, std::to_string(c.bytes.size()) + " bytes");
    expectParts(said, {path}, said);
    EXPECT_EQ(said.find('\n'), said.npos) << said;
  }
  // The length of any list: libfclib would read past the end.
  const std::string length = bytesOf(points), shorter = bytesOf(points - 1);
  bool refusedForIt = false;
  for (std::size_t at = good.find(length); at != good.npos && !refusedForIt; at = good.find(length, at + 1)) {
    const std::string said = messageOf(std::string(good).replace(at, length.size(), shorter), path);
    refusedForIt = said.find("its vectors/mu has " + std::to_string(points - 1)) != said.npos;
  }
  EXPECT_TRUE(refusedForIt);
  // Any changed byte: rejected with a one-line message, or still a problem.
  int wrong = 0;
  for (std::size_t at = 8; at < good.size(); at += good.size() / 40) {
    std::string flipped = good;
    flipped[at] = static_cast<char>(~flipped[at]);
    const std::string said = messageOf(flipped, path);
    EXPECT_EQ(said.find('\n'), said.npos) << said;
    wrong += !said.empty();
  }
  EXPECT_GT(wrong, 5);
}

TEST(FclibFile, ReportsWhatItCannotHold) {
  const FrozenProblem<2> problem = heapProblem<2>();
  Workspace w;
  if (!isThere(problem, w)) GTEST_SKIP() << "FCLIB is absent";
  const auto said = [&](const char* what, const auto& change) {
    FrozenProblem<2> other = problem;
    change(other);
    try {
      fclibBytes<2>(other, w.path("p.hdf5"));
      ADD_FAILURE() << what;
    } catch (const UserError& e) {
      expectParts(e.what(), {"p.hdf5: FCLIB cannot store ", what, "; valid: a file that ends in .json"}, what);
    }
  };
  const auto row = [](auto& p, const auto& change) {
    JointRows<2> rows = dynamic_cast<const FrozenRows<2>&>(*p.joints[0].kind).stored();
    change(rows.row[0]);
    p.joints[0].kind = std::make_shared<FrozenRows<2>>(rows);
  };
  said("limits", [&](auto& p) { row(p, [](auto& r) { r.lo = -1, r.hi = 1; }); });
  said("springs", [&](auto& p) { row(p, [](auto& r) { r.law = RowLaw::spring, r.stiffness = 10, r.damping = 1; }); });
  said("without rotation", [](auto& p) { p.model.rotation = false; });
  said("pinned", [](auto& p) {
    for (std::size_t i = 0; i < p.bodies.invMass.size(); ++i) {
      if (p.bodies.type[i] == BodyType::dynamic) p.bodies.invMass[i] = 0;
    }
  });
}

/// The local form of a heap: rows of the contacts in W, rows of its joint in V and R.
template <int D>
FclibLocal localOf(FrozenProblem<D> problem) {
  for (Manifold<D>& m : problem.manifolds) m.friction = std::max(m.friction, Real(0.1));  // so that all have tangents
  const Asked<D> asked(problem);
  const ContactProblem<D>& rows = asked.rows;
  const std::vector<double>& u = asked.u;
  std::vector<int> contacts, joints;
  FclibLocal out;
  std::vector<double> mu;
  for (int i = 0; i < rows.size(); ++i) {
    (rows.row(i).ofJoint ? joints : contacts).push_back(i);
    if (rows.row(i).law == ProblemLaw::normal) mu.push_back(rows.row(i).friction);
  }
  const auto part = [&](const std::vector<int>& of, const std::vector<int>& by) {
    Eigen::MatrixXd w(of.size(), by.size());
    for (Eigen::Index i = 0; i < w.rows(); ++i) {
      for (Eigen::Index j = 0; j < w.cols(); ++j) {
        w(i, j) = rows.response(rows.row(of[static_cast<std::size_t>(i)]), rows.row(by[static_cast<std::size_t>(j)]));
      }
    }
    return Eigen::SparseMatrix<double>(w.sparseView());
  };
  const auto list = [&](const std::vector<int>& of) {
    Eigen::VectorXd v(of.size());
    for (Eigen::Index i = 0; i < v.size(); ++i) v[i] = u[static_cast<std::size_t>(of[static_cast<std::size_t>(i)])];
    return v;
  };
  out.dimension = D, out.w = part(contacts, contacts), out.v = part(contacts, joints), out.r = part(joints, joints);
  out.q = list(contacts), out.s = list(joints);
  out.mu = Eigen::Map<const Eigen::VectorXd>(mu.data(), static_cast<Eigen::Index>(mu.size()));
  return out;
}

std::string localBytes(FclibLocal local, const Workspace& w) {
  const std::string path = w.path("local.hdf5");
  std::remove(path.c_str());
  inItsProcess("FCLIB", path, [&] { return writeFclibHere(path, local), std::string(); });
  return readFile(path);
}

// Only W, q and mu: the numbers as written, in LPC's order, and a problem that matrix methods solve.
template <int D>
void localRoundTrip() {
  Workspace w;
  if (!isThere(heapProblem<2>(), w)) GTEST_SKIP() << "FCLIB is absent";
  const FclibLocal local = localOf(heapProblem<D>());
  ASSERT_GT(local.mu.size(), 5);
  ASSERT_GT(local.v.cols(), 0);
  localBytes(local, w);
  const ProblemFile file = ProblemFile::load(w.path("local.hdf5"));
  ASSERT_EQ(file.dimension, D);
  FrozenProblem<D> read = file.of<D>().at(0).problem;
  const GivenProblem& given = read.given.value();
  const auto n = static_cast<std::int32_t>(local.w.rows());
  ASSERT_EQ(given.size(), n + static_cast<std::int32_t>(local.v.cols()));
  double most = 0;
  for (std::int32_t i = 0; i < given.size(); ++i) {
    for (std::int32_t j = 0; j < given.size(); ++j) {
      const double is = i < n ? (j < n ? local.w.coeff(i, j) : local.v.coeff(i, j - n))
                              : (j < n ? local.v.coeff(j, i - n) : local.r.coeff(i - n, j - n));
      most = std::max(most, std::abs(given.at(i, j) - is));
    }
    const auto at = static_cast<std::size_t>(i);
    most = std::max(most, std::abs(given.velocity[at] - (i < n ? local.q[i] : local.s[i - n])));
    if (i < local.mu.size()) most = std::max(most, std::abs(given.friction[at] - local.mu[i]));
  }
  EXPECT_LT(most, 1e-12);
  std::ofstream(w.path("again.hdf5"), std::ios::binary) << fclibBytes<D>(read, w.path("again.hdf5"));
  const GivenProblem twice = ProblemFile::load(w.path("again.hdf5")).of<D>().at(0).problem.given.value();
  EXPECT_TRUE(twice.value == given.value && twice.row == given.row && twice.start == given.start);
  EXPECT_TRUE(twice.velocity == given.velocity && twice.friction == given.friction);
  Asked<D> asked(read);
  std::vector<double> x;
  createStage<VelocityResolver<D>>(Spec::parse("admm{iterations=2000,max_rows=1000}"))->solve(asked.in);
  asked.rows.impulses(asked.in, x);
  EXPECT_LT(asked.rows.naturalMap(x, asked.u).natural, 1e-6);
  for (std::int32_t i = n; i < given.size(); ++i) EXPECT_NEAR(given.velocity[static_cast<std::size_t>(i)], 0, 1e-6);
}
TEST(FclibFile, HoldsAMatrixAlone2) { localRoundTrip<2>(); }
TEST(FclibFile, HoldsAMatrixAlone3) { localRoundTrip<3>(); }

TEST(FclibFile, RefusesAMatrixInOneLine) {
  Workspace w;
  if (!isThere(heapProblem<2>(), w)) GTEST_SKIP() << "FCLIB is absent";
  const FclibLocal good = localOf(heapProblem<2>());
  const auto refuses = [&](const test::Parts& parts, const auto& change) {
    FclibLocal bad = good;
    change(bad);
    const std::string said = messageOf(localBytes(bad, w), w.path("p.hdf5"));
    expectParts(said, parts, said);
    EXPECT_EQ(said.find('\n'), said.npos) << said;
  };
  EXPECT_EQ(messageOf(localBytes(good, w), w.path("p.hdf5")), "");
  refuses({"p.hdf5, problems 0, matrix, velocity ", "for a row without moving bodies"}, [](auto& p) { p.r.setZero(); });
  refuses({"its W or R is not symmetric"}, [](auto& p) { p.w.coeffRef(0, 1) += 1; });
  refuses({"negative on the diagonal"}, [](auto& p) { p.w.coeffRef(0, 0) = -1; });
  refuses({"friction is negative"}, [](auto& p) { p.mu[0] = -1; });
  refuses({"a number of its q is not finite"}, [](auto& p) { p.q[0] = std::nan(""); });
  refuses({"the sizes of its matrices do not match"},
          [](auto& p) { p.r = Eigen::SparseMatrix<double>(p.r.rows(), p.r.cols() + 1); });
  // A method that applies impulses to bodies says that it does not take matrices, and has a row in the result.
  localBytes(good, w);
  w.write("s.toml",
          "summary = \"s\"\nkind = \"problems\"\n[axes]\nproblems = \"local.hdf5\"\nvelocity = \"*\"\n"
          "start = \"cold\"\niterations = 3\n");
  const test::Outcome swept = w.lpc("sweep s.toml --store s.db");
  EXPECT_EQ(swept.code, 0) << swept.text;
  const auto count = [&](const std::string& where) {
    return test::ask(w.path("s.db"), "SELECT COUNT(*) FROM trial WHERE " + where);
  };
  std::size_t able = 0, all = 0;
  for (const Registered* r : Registry::instance().list(StageKind::velocity, 2)) {
    if (r->info.role != AlgorithmRole::competitor) continue;
    ++all, able += r->info.matrixAlone;
  }
  EXPECT_EQ(count("outcome='ok'"), std::to_string(able));
  EXPECT_EQ(count("outcome='unsupported' AND reason LIKE '%needs bodies%'"), std::to_string(all - able));
}

TEST(FclibFile, IsRecordedAndSwept) {
  Workspace w;
  if (!isThere(heapProblem<2>(), w)) GTEST_SKIP() << "FCLIB is absent";
  const std::string scene = "record vertical_stack --param n=3 --param gap=0 --problems t.hdf5";
  refused(w, scene + " --steps 3,20", {"t.hdf5: an FCLIB file holds one problem; valid: one step"});
  refused(w, scene + " --hardest 2", {"t.hdf5: an FCLIB file holds one problem"});
  refused(w, "record vertical_stack --steps 3 --problems none/t.hdf5", {"none/t.hdf5: cannot be written"});
  const auto before = test::filesIn(w);
  const test::Outcome recorded = w.lpc(scene + " --steps 20");
  ASSERT_EQ(recorded.code, 0) << recorded.text;
  EXPECT_EQ(test::filesIn(w).size(), before.size() + 1);
  w.write("s.toml",
          "summary = \"s\"\nkind = \"problems\"\n[axes]\nproblems = \"t.hdf5\"\nvelocity = [\"catto\", \"admm\"]\n"
          "start = \"cold\"\niterations = 3\n");
  const test::Outcome swept = w.lpc("sweep s.toml --store s.db");
  EXPECT_EQ(swept.code, 0) << swept.text;
  EXPECT_EQ(test::ask(w.path("s.db"), "SELECT COUNT(*) FROM trial WHERE outcome='ok'"), "2");
  const std::string cut = readFile(w.path("t.hdf5")).substr(0, 3000);
  std::ofstream(w.path("t.hdf5"), std::ios::binary) << cut;
  refused(w, "sweep s.toml --store none.db", {"t.hdf5: it is damaged; valid: "});
}

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::fclib_file_test
