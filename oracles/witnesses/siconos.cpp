// SPDX-License-Identifier: Zlib
// Siconos (Acary and others), a witness for velocity problems: nonsmooth Gauss-Seidel with an exact solution of each
// contact; where that does not converge, also Newton's method (Alart-Curnier, in 3D) or Lemke's (in 2D). The answer
// with the smaller residual counts. It solves contacts only; equality rows and springs are eliminated first, and limits
// of joints are not supported. Each problem runs in its own process, because Siconos exits the process on unexpected
// input.
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <limits>
#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

#include "framework/problem/contact_problem.h"
#include "oracles/witnesses/pseudo_inverse.h"
#include "oracles/witnesses/thread_time.h"
#include "oracles/witnesses/witness_resolver.h"

#ifdef LPC_SICONOS
#include <siconos/numerics/FrictionContactProblem.h>
#include <siconos/numerics/Friction_cst.h>
#include <siconos/numerics/NonSmoothDrivers.h>
#include <siconos/numerics/NumericsMatrix.h>
#include <siconos/numerics/SolverOptions.h>
#endif

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

constexpr unsigned kMostSeconds = 20;  // limit for one problem

/// W r + q in the cones of mu, D rows for each contact.
struct Question {
  int dimension, contacts;
  Matrix w;
  Vector q, mu;
  double tolerance;
  int sweeps;
  double nanoseconds = 0;  // time of the driver
};

#ifdef LPC_SICONOS
template <class F>
F* found(const char* name) {
  static void* const library = dlopen(LPC_SICONOS, RTLD_NOW | RTLD_LOCAL);
  void* const at = library ? dlsym(library, name) : nullptr;
  if (!at) _exit(1);
  return reinterpret_cast<F*>(at);
}
#define LPC_OF_SICONOS(function) found<decltype(function)>(#function)

// A residual of at most this share of the largest velocity needs no second method. Siconos's own error measure, of all
// contacts together, may call a worse one solved.
constexpr double kSolved = 1e-9;

// Largest over all contacts of |projection on the cone of (w r - u') - w r|, w = W_ii, u' with De Saxce's term (m/s).
double residual(const Question& of, const Vector& r) {
  if (!r.allFinite()) return std::numeric_limits<double>::infinity();
  const Vector u = of.w * r + of.q;
  double worst = 0;
  for (Eigen::Index c = 0; c < of.contacts; ++c) {
    const Eigen::Index at = c * of.dimension, tangents = of.dimension - 1;
    const double w = of.w(at, at), mu = of.mu[c];
    Vector next = w * r.segment(at, of.dimension) - u.segment(at, of.dimension);
    next[0] -= mu * u.segment(at + 1, tangents).norm();
    const double along = next[0], aside = next.tail(tangents).norm();
    if (mu * aside <= -along) {
      next.setZero();
    } else if (aside > mu * along) {
      const double onto = (along + mu * aside) / (1 + mu * mu);
      next[0] = onto, next.tail(tangents) *= mu * onto / aside;
    }
    worst = std::max(worst, (next - w * r.segment(at, of.dimension)).cwiseAbs().maxCoeff());
  }
  return worst;
}

// Runs in the child. `r` has the impulses, the time (ns) and the number of methods that have ended: the second method
// may not return.
void answer(Question& of, double* r) {
  const Eigen::Index n = of.q.size();
  double least = std::numeric_limits<double>::infinity();
  const double before = threadNanoseconds();
  for (const int method : of.dimension == 2 ? std::array{SICONOS_FRICTION_2D_NSGS, SICONOS_FRICTION_2D_LEMKE}
                                            : std::array{SICONOS_FRICTION_3D_NSGS, SICONOS_FRICTION_3D_NSN_AC}) {
    Matrix w = of.w;  // a driver may change its input
    Vector q = of.q, mu = of.mu, x = Vector::Zero(n), u = Vector::Zero(n);
    auto* const matrix =
        LPC_OF_SICONOS(NM_create_from_data)(NM_DENSE, static_cast<int>(n), static_cast<int>(n), w.data());
    FrictionContactProblem problem{of.dimension, of.contacts, matrix, q.data(), mu.data()};
    SolverOptions* const options = LPC_OF_SICONOS(solver_options_create)(method);
    options->dparam[SICONOS_DPARAM_TOL] = of.tolerance, options->iparam[SICONOS_IPARAM_MAX_ITER] = of.sweeps;
    auto* const driver = of.dimension == 2 ? LPC_OF_SICONOS(fc2d_driver) : LPC_OF_SICONOS(fc3d_driver);
    driver(&problem, x.data(), u.data(), options);
    const double left = residual(of, x);
    if (left < least) least = left, Eigen::Map<Vector>(r, n) = x;
    r[n] = threadNanoseconds() - before, r[n + 1] += 1;
    if (least <= kSolved * of.q.cwiseAbs().maxCoeff()) break;
  }
}

Vector ask(Question& of) {
  const auto bytes = static_cast<std::size_t>(of.q.size() + 2) * sizeof(double);
  void* const memory = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) throw std::system_error(errno, std::generic_category(), "no memory for Siconos's process");
  auto* const r = static_cast<double*>(memory);
  const pid_t parent = getpid(), child = fork();
  if (child == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) _exit(1);  // the parent died before the line above
    const int nowhere = open("/dev/null", O_RDWR);
    for (int fd = 0; fd < 3; ++fd) dup2(nowhere, fd);
    const rlimit none{0, 0};
    setrlimit(RLIMIT_CORE, &none);
    for (const int s : {SIGALRM, SIGABRT, SIGSEGV, SIGFPE}) std::signal(s, SIG_DFL);
    setenv("OPENBLAS_NUM_THREADS", "1", 1);
    alarm(kMostSeconds);
    answer(of, r);
    _exit(0);
  }
  int status = -1;
  while (child > 0 && waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  const Vector out = Eigen::Map<const Vector>(r, of.q.size());
  of.nanoseconds = r[of.q.size()];
  const bool ended = r[of.q.size() + 1] > 0;
  munmap(memory, bytes);
  if (!ended) throw std::runtime_error("Siconos's process did not end normally");
  if (!out.allFinite()) throw std::runtime_error("Siconos returned a value that is not finite");
  return out;
}
#else
Vector ask(Question&) { throw UserError("Siconos is not in this build; valid: a build with libsiconos-numerics-dev"); }
#endif

template <int D>
class Siconos final : public WitnessResolver<D> {
 public:
  struct Params {
    Real tolerance = Real(1e-12);
    int sweeps = 20000;
    void visit(ParamVisitor& v) {
      v.real("tolerance", tolerance, 0, 1, "1", "tolerance, by Siconos's own error measure", ParamRole::tolerance);
      v.integer("sweeps", sweeps, 1, 10000000, "largest number of passes of each method");
    }
  };
  explicit Siconos(const Params& params) : m_params(params) {}

  static AlgorithmInfo info() {
    return {.name = "siconos",
            .summary = "Siconos's nonsmooth Gauss-Seidel; where it does not converge, also its Newton or Lemke method",
            .paper = "",
            .complexity = "sweeps x contacts^2",
            .guarantee = Guarantee::approximate,
            .friction = FrictionLaw::coulomb,
            .noEffort = "it runs until its tolerance; `sweeps` is only a limit",
            .matrixAlone = true,
            .role = AlgorithmRole::witness};
  }

  double nanoseconds() const override { return m_nanoseconds; }

  void solve(const VelocityInput<D>& in) override {
    m_nanoseconds = -threadNanoseconds();
    m_problem.set(in);
    std::vector<double> free, x(static_cast<std::size_t>(m_problem.size()), 0.0);
    m_problem.freeVelocities(in, free);
    std::vector<std::int32_t> contacts, equalities;  // of a contact its normal row
    for (std::int32_t i = 0; i < m_problem.size(); ++i) {
      const ProblemRow<D>& row = m_problem.row(i);
      if (row.ofJoint && row.law == ProblemLaw::interval) {
        throw UserError("Siconos supports no joint limits and no motors with a force limit");
      }
      if (row.law == ProblemLaw::free) equalities.push_back(i);
      if (row.law == ProblemLaw::normal || row.law == ProblemLaw::interval) contacts.push_back(i);
    }
    if (!x.empty()) solveFor(contacts, equalities, free, x);
    m_problem.apply(in, x);
    m_nanoseconds += threadNanoseconds();
  }

 private:
  void solveFor(const std::vector<std::int32_t>& contacts, const std::vector<std::int32_t>& equalities,
                const std::vector<double>& free, std::vector<double>& x) {
    const auto n = static_cast<Eigen::Index>(D * contacts.size()), m = static_cast<Eigen::Index>(equalities.size());
    // Rows of the contacts, D each; tangents missing in a contact without friction are uncoupled and stay 0.
    std::vector<std::int32_t> rows(static_cast<std::size_t>(n), -1);
    Question of{.dimension = D,
                .contacts = static_cast<int>(contacts.size()),
                .w = Matrix::Zero(n, n),
                .q = Vector::Zero(n),
                .mu = Vector::Zero(n / D),
                .tolerance = double(m_params.tolerance),
                .sweeps = m_params.sweeps};
    for (std::size_t c = 0; c < contacts.size(); ++c) {
      const ProblemRow<D>& row = m_problem.row(contacts[c]);
      const bool rubs = row.law == ProblemLaw::normal;
      for (int k = 0; k < (rubs ? D : 1); ++k) rows[D * c + static_cast<std::size_t>(k)] = contacts[c] + k;
      of.mu[static_cast<Eigen::Index>(c)] = rubs ? row.friction : 0.0;
    }
    const auto entry = [&](std::int32_t i, std::int32_t j) {
      const ProblemRow<D>& row = m_problem.row(i);
      return i == j ? 1 / row.mass : m_problem.response(row, m_problem.row(j));
    };
    Matrix wce = Matrix::Zero(n, m), wee(m, m);
    Vector qe(m);
    for (Eigen::Index i = 0; i < n; ++i) {
      const std::int32_t row = rows[static_cast<std::size_t>(i)];
      if (row < 0) of.w(i, i) = of.w(i - i % D, i - i % D);
      if (row < 0) continue;
      of.q[i] = free[static_cast<std::size_t>(row)];
      for (Eigen::Index j = 0; j < n; ++j) {
        if (rows[static_cast<std::size_t>(j)] >= 0) of.w(i, j) = entry(row, rows[static_cast<std::size_t>(j)]);
      }
      for (Eigen::Index j = 0; j < m; ++j) wce(i, j) = entry(row, equalities[static_cast<std::size_t>(j)]);
    }
    for (Eigen::Index i = 0; i < m; ++i) {
      const std::int32_t row = equalities[static_cast<std::size_t>(i)];
      qe[i] = free[static_cast<std::size_t>(row)];
      for (Eigen::Index j = 0; j < m; ++j) wee(i, j) = entry(row, equalities[static_cast<std::size_t>(j)]);
    }
    const PseudoInverse inverse(wee);
    if (m > 0 && n > 0) of.w -= wce * inverse.solve(wce.transpose()), of.q -= wce * Vector(inverse.solve(qe));
    const double before = threadNanoseconds();
    const Vector r = n > 0 ? ask(of) : Vector(0);
    m_nanoseconds += of.nanoseconds - (threadNanoseconds() - before);
    for (Eigen::Index i = 0; i < n; ++i) {
      const std::int32_t row = rows[static_cast<std::size_t>(i)];
      if (row >= 0) x[static_cast<std::size_t>(row)] = r[i];
    }
    if (m == 0) return;
    const Vector lambda = -inverse.solve(qe + wce.transpose() * r);
    for (Eigen::Index i = 0; i < m; ++i) {
      x[static_cast<std::size_t>(equalities[static_cast<std::size_t>(i)])] = lambda[i];
    }
  }

  Params m_params;
  ContactProblem<D> m_problem;
  double m_nanoseconds = 0;
};

}  // namespace

LPC_REGISTER(VelocityResolver, Siconos, 2, 3);

}}  // namespace lpc::LPC_PRECISION
