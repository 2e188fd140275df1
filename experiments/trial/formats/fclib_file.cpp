// SPDX-License-Identifier: Zlib
#include "experiments/trial/formats/fclib_file.h"

#include <Eigen/Dense>
#include <cstdio>
#include <sstream>
#include <tuple>

#include "experiments/parse/toml_reader.h"
#include "experiments/trial/formats/fclib_library.h"
#include "experiments/trial/formats/library_process.h"
#include "experiments/trial/formats/problem_file.h"
#include "framework/problem/contact_problem.h"
#include "framework/stage/profiler.h"

namespace lpc { inline namespace LPC_PRECISION {

bool isHdf5(const std::string& bytes) { return bytes.starts_with("\x89HDF\r\n\x1a\n"); }

namespace {

using Sparse = Eigen::SparseMatrix<double>;
using Vector = Eigen::VectorXd;
using Triplets = std::vector<Eigen::Triplet<double>>;

constexpr double kSame = 1e-8;  // relative: rounding of the program that wrote the file
constexpr double kMeets =
    1e-6;  // fraction of a contact's distance from the centres: tolerance of the contact point of two bodies

Sparse matrixOf(int rows, std::size_t columns, const Triplets& entries) {
  Sparse out(rows, static_cast<Eigen::Index>(columns));
  out.setFromTriplets(entries.begin(), entries.end());
  return out;
}
Vector vectorOf(const std::vector<double>& x) {
  return Eigen::Map<const Vector>(x.data(), static_cast<Eigen::Index>(x.size()));
}

template <int D>
FclibProblem globalOf(FrozenProblem<D> problem) {
  constexpr int kDofs = D + kAngDim<D>;
  if (!problem.model.rotation) throw UserError("FCLIB cannot store a body without rotation");
  std::vector<double> mu;
  std::vector<std::size_t> firstPoint;        // first point of each manifold
  for (Manifold<D>& m : problem.manifolds) {  // FCLIB's contacts have all their tangents
    firstPoint.push_back(mu.size());
    for (int k = 0; k < m.count; ++k) mu.push_back(problem.model.friction ? double(m.friction) : 0.0);
    if (!(m.friction > 0)) m.friction = 1;
  }
  problem.model.friction = true;
  WorkDone work;
  Profiler profiler;
  ContactProblem<D> rows;
  const VelocityInput<D> in = problem.input(work, profiler);
  rows.set(in);
  const Bodies<D>& bodies = problem.bodies;
  std::vector<int> first(bodies.pose.size() + 1, -1);  // static bodies have none
  Triplets m, h, g;
  std::vector<double> v;
  for (std::size_t i = 0; i < bodies.pose.size(); ++i) {
    if (!(bodies.invMass[i] > 0) && bodies.invInertia[i].isZero(0)) continue;
    Eigen::Matrix<double, kAngDim<D>, kAngDim<D>> inertia = bodies.invInertia[i].template cast<double>();
    if (!(bodies.invMass[i] > 0) || !(inertia.determinant() > 0)) {
      throw UserError("FCLIB cannot store a body that is pinned or cannot rotate");
    }
    inertia = inertia.inverse().eval();
    const int at = first[i] = static_cast<int>(v.size());
    for (int k = 0; k < D; ++k) {
      m.emplace_back(at + k, at + k, 1 / double(bodies.invMass[i])), v.push_back(double(bodies.motion[i].v[k]));
    }
    for (int k = 0; k < kAngDim<D>; ++k) {
      for (int l = 0; l < kAngDim<D>; ++l) m.emplace_back(at + D + k, at + D + l, inertia(k, l));
      v.push_back(double(bodies.motion[i].w[k]));
    }
  }
  // u without impulses is H^T v + w: w contains whatever v does not give.
  std::vector<double> u, w, b, friction;
  rows.freeVelocities(in, u);
  for (int i = 0; i < rows.size(); ++i) {
    const ProblemRow<D>& row = rows.row(i);
    const bool contact = !row.ofJoint;
    if (!contact && !row.holds()) throw UserError("FCLIB cannot store limits, motors with a force limit, and springs");
    if (contact && row.law == ProblemLaw::interval) throw UserError("FCLIB cannot store a contact that cannot slide");
    std::vector<double>& rest = contact ? w : b;
    const int column = static_cast<int>(rest.size());
    double known = 0;
    const auto put = [&](std::int32_t body, double sign, const auto& arm) {
      const int at = first[static_cast<std::size_t>(body)];
      if (at < 0) return;
      Eigen::Matrix<double, kDofs, 1> pull;
      pull << sign * row.d, sign * arm;
      for (int k = 0; k < kDofs; ++k) {
        if (pull[k] != 0) (contact ? h : g).emplace_back(at + k, column, pull[k]);
        known += pull[k] * v[static_cast<std::size_t>(at + k)];
      }
    };
    put(row.a, -1, row.armA), put(row.b, 1, row.armB);
    rest.push_back(u[static_cast<std::size_t>(i)] - known);
    if (row.law != ProblemLaw::normal) continue;
    friction.push_back(mu[firstPoint[static_cast<std::size_t>(row.owner)] + static_cast<std::size_t>(row.number / D)]);
  }
  if (friction.empty()) throw UserError("FCLIB stores contact problems only, and this problem has no contact");
  FclibProblem out;
  const int dofs = static_cast<int>(v.size());
  out.dimension = D, out.m = matrixOf(dofs, v.size(), m);
  out.h = matrixOf(dofs, w.size(), h), out.g = matrixOf(dofs, b.size(), g);
  out.f = out.m * vectorOf(v), out.w = vectorOf(w), out.b = vectorOf(b), out.mu = vectorOf(friction);
  return out;
}

/// The bodies that columns of H or G act on, by index; -1 if there is only one.
template <int D>
std::pair<int, int> pulled(const Sparse& matrix, int from, int count) {
  std::pair<int, int> out(-1, -1);
  for (int column = from; column < from + count; ++column) {
    for (Sparse::InnerIterator x(matrix, column); x; ++x) {
      const int body = static_cast<int>(x.row()) / (D + kAngDim<D>);
      if (x.value() == 0 || body == out.first || body == out.second) continue;
      if (out.first >= 0) throw UserError("a row acts on more than two bodies");
      out.first = out.second, out.second = body;
      if (out.first > out.second) std::swap(out.first, out.second);
    }
  }
  return out;
}

/// Position of a contact point relative to a body's centre: r from turn = r x d, for D orthogonal directions.
inline Eigen::Vector2d armOf(const Eigen::Matrix2d& d, const Eigen::RowVector2d& turn) {
  const Eigen::RowVector2d t = turn * d.transpose();  // of the axes: r x e_x = -r_y, r x e_y = r_x
  return {t[1], -t[0]};
}
inline Eigen::Vector3d armOf(const Eigen::Matrix3d& d, const Eigen::Matrix3d& turn) {
  Eigen::Vector3d twice = Eigen::Vector3d::Zero();
  for (int k = 0; k < 3; ++k) twice += d.col(k).cross(turn.col(k));
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d is = (twice / 2).cross(d.col(k));
    if ((is - turn.col(k)).norm() > kSame * (1 + is.norm())) {
      throw UserError("the rotational part of a contact does not match a contact point in world axes");
    }
  }
  return twice / 2;
}

template <int D>
class RigidBodies {
 public:
  explicit RigidBodies(const FclibProblem& from) : m_from(from) {}

  FrozenProblem<D> problem() {
    if (m_from.m.rows() % kDofs != 0) throw UserError("the size of its matrices does not match rigid bodies");
    m_bodies = static_cast<int>(m_from.m.rows()) / kDofs;
    m_out.dt = m_out.lastDt = Real(1) / 60, m_out.model.restitution = false, m_out.position.rate = 1;
    for (int c = 0; c < m_from.mu.size(); ++c) m_touches.push_back(touch(c));
    place();
    for (int i = 0; i < m_bodies; ++i) addBody(i);
    for (const Touch& t : m_touches) addContact(t);
    addJoints();
    return std::move(m_out);
  }

 private:
  static constexpr int kDofs = D + kAngDim<D>;
  using Point = Eigen::Matrix<double, D, 1>;
  struct Touch {
    int a, b;  // -1: the ground
    Point rA, rB, n, slide;
    double mu, target;
  };

  static Vec<D> vec(const Point& p) { return p.template cast<Real>(); }

  Touch touch(int c) const {
    Touch t{};
    std::tie(t.a, t.b) = pulled<D>(m_from.h, D * c, D);
    if (t.b < 0) throw UserError("a contact acts on no body");
    using Block = Eigen::Matrix<double, kDofs, D>;
    const auto pull = [&](int body) {
      return Block(Eigen::MatrixXd(m_from.h.middleCols(D * c, D)).middleRows(body * kDofs, kDofs));
    };
    const Block onB = pull(t.b);
    const Eigen::Matrix<double, D, D> d = onB.template topRows<D>();
    if (!(d.transpose() * d).isIdentity(kSame)) throw UserError("the contact frame is not orthonormal");
    t.n = d.col(0), t.rB = armOf(d, onB.template bottomRows<kAngDim<D>>());
    t.mu = m_from.mu[c], t.target = -m_from.w[D * c];
    if (t.mu < 0) throw UserError("a coefficient of friction is negative");
    Point ground = m_from.w.segment(D * c, D);
    ground[0] = 0, t.slide = -d * ground;  // the ground's velocity
    if (t.a < 0) return t;
    const Block onA = -pull(t.a);
    if (!onA.template topRows<D>().isApprox(d, kSame))
      throw UserError("a contact's forces on its two bodies are not opposite");
    t.rA = armOf(d, onA.template bottomRows<kAngDim<D>>());
    if (t.slide.norm() > kSame) throw UserError("a contact has a tangential velocity term of its own");
    return t;
  }

  // Positions bodies so that their contacts meet; the first of each connected group is at the origin.
  void place() {
    m_place.assign(static_cast<std::size_t>(m_bodies), Point::Zero());
    std::vector<std::vector<const Touch*>> of(m_place.size());
    for (const Touch& t : m_touches) {
      if (t.a >= 0) of[static_cast<std::size_t>(t.a)].push_back(&t), of[static_cast<std::size_t>(t.b)].push_back(&t);
    }
    std::vector<bool> placed(m_place.size(), false);
    for (int start = 0; start < m_bodies; ++start) {
      if (placed[static_cast<std::size_t>(start)]) continue;
      std::vector<int> queue = {start};
      placed[static_cast<std::size_t>(start)] = true;
      for (std::size_t i = 0; i < queue.size(); ++i) {
        const auto here = static_cast<std::size_t>(queue[i]);
        for (const Touch* t : of[here]) {
          const auto there = static_cast<std::size_t>(t->a + t->b - queue[i]);
          if (placed[there]) continue;
          m_place[there] = m_place[here] + (t->a == queue[i] ? t->rA - t->rB : t->rB - t->rA);
          placed[there] = true, queue.push_back(static_cast<int>(there));
        }
      }
    }
    for (const Touch& t : m_touches) {
      if (t.a < 0) continue;
      const Point gap = m_place[static_cast<std::size_t>(t.b)] + t.rB - m_place[static_cast<std::size_t>(t.a)] - t.rA;
      if (gap.norm() > kMeets * (1 + t.rA.norm() + t.rB.norm()))
        throw UserError("two bodies have no common contact point");
    }
  }

  void addBody(int i) {
    using Block = Eigen::Matrix<double, kDofs, kDofs>;
    const int at = i * kDofs;
    Block block = Block::Zero();
    for (int k = 0; k < kDofs; ++k) {
      for (Sparse::InnerIterator x(m_from.m, at + k); x; ++x) {
        if (x.value() == 0) continue;
        if (x.row() < at || x.row() >= at + kDofs) throw UserError("its mass matrix is not that of rigid bodies");
        block(x.row() - at, k) = x.value();
      }
    }
    Block expected = Block::Zero();
    expected.template topLeftCorner<D, D>() = block(0, 0) * Eigen::Matrix<double, D, D>::Identity();
    const Eigen::Matrix<double, kAngDim<D>, kAngDim<D>> inertia =
        block.template bottomRightCorner<kAngDim<D>, kAngDim<D>>();
    expected.template bottomRightCorner<kAngDim<D>, kAngDim<D>>() = (inertia + inertia.transpose()) / 2;
    const bool rigid = block(0, 0) > 0 && inertia.determinant() > 0 && block.isApprox(expected, kSame);
    if (!rigid) throw UserError("its mass matrix is not that of rigid bodies");
    const Eigen::Matrix<double, kDofs, 1> v = expected.inverse() * m_from.f.segment<kDofs>(at);
    Motion<D> motion;
    motion.v = v.template head<D>().template cast<Real>(),
    motion.w = v.template tail<kAngDim<D>>().template cast<Real>();
    m_out.addBody(BodyType::dynamic, true, vec(m_place[static_cast<std::size_t>(i)]),
                  static_cast<Real>(1 / block(0, 0)), Inertia<D>(inertia.inverse().template cast<Real>()), motion);
  }

  void addContact(const Touch& t) {
    Manifold<D>& manifold = m_out.manifolds.emplace_back();
    manifold.bodyA = t.a, manifold.bodyB = t.b, manifold.count = 1;
    ContactPoint<D>& point = manifold.points[0];
    point.localB = vec(t.rB), point.localA = vec(t.rA);
    if (t.a < 0) {  // the ground is represented by a body at the point
      manifold.bodyA = m_out.bodies.size();
      const Point at = m_place[static_cast<std::size_t>(t.b)] + t.rB;
      Motion<D> motion;
      motion.v = vec(t.slide), motion.w.setZero();
      const bool still = t.slide.isZero(0);
      m_out.addBody(still ? BodyType::fixed : BodyType::kinematic, true, vec(at), 0, Inertia<D>::Zero(), motion);
    }
    manifold.normal = vec(t.n), manifold.friction = static_cast<Real>(t.mu);
    point.separation = static_cast<Real>(-t.target * double(m_out.dt));  // a gap if B may approach
    if (t.target >= 0) m_out.position.add(point.separation, static_cast<Real>(t.target));
    m_out.order.push_back(static_cast<int>(m_out.order.size()));
  }

  // Consecutive equality rows between the same two bodies form a joint.
  void addJoints() {
    JointRows<D> rows;
    std::pair<int, int> last(-1, -1);
    const auto close = [&] {
      if (rows.count > 0) m_out.addJoint(last.first, last.second, rows, {});
      rows = {};
    };
    for (int c = 0; c < m_from.g.cols(); ++c) {
      const std::pair<int, int> ends = pulled<D>(m_from.g, c, 1);
      if (ends.second < 0) throw UserError("an equality acts on no body");
      if (ends != last || rows.count == kDofs) close();
      last = ends;
      using Column = Eigen::Matrix<double, kDofs, 1>;
      const auto pull = [&](int body) { return Column(Vector(m_from.g.col(c)).template segment<kDofs>(body * kDofs)); };
      const Column onB = pull(ends.second);
      ConstraintRow<D>& row =
          rows.turn(Ang<D>(onB.template tail<kAngDim<D>>().template cast<Real>()), static_cast<Real>(m_from.b[c]));
      row.d = vec(onB.template head<D>()), row.angular = row.d.isZero(0), row.armA.setZero();
      if (ends.first < 0) continue;
      const Column onA = -pull(ends.first);
      row.armA = onA.template tail<kAngDim<D>>().template cast<Real>();
      if ((onA - onB).template head<D>().norm() > kSame * onB.norm()) {
        throw UserError("an equality's forces on its two bodies are not opposite");
      }
    }
    close();
  }

  const FclibProblem& m_from;
  int m_bodies = 0;
  std::vector<Touch> m_touches;
  std::vector<Point> m_place;
  FrozenProblem<D> m_out;
};

/// Rows of contacts in W, those of equalities in V and R.
template <int D>
FclibLocal localOf(const GivenProblem& given) {
  const auto n = static_cast<int>(D * given.friction.size()), m = given.size() - n;
  Triplets w, v, r;
  for (int j = 0; j < given.size(); ++j) {
    given.eachOf(j, [&](int i, double x) {
      if (i < n && j < n) w.emplace_back(i, j, x);
      if (i < n && j >= n) v.emplace_back(i, j - n, x);
      if (i >= n && j >= n) r.emplace_back(i - n, j - n, x);
    });
  }
  const Vector u = vectorOf(given.velocity);
  const auto columns = static_cast<std::size_t>(m);
  return {D,
          matrixOf(n, static_cast<std::size_t>(n), w),
          matrixOf(n, columns, v),
          matrixOf(m, columns, r),
          u.head(n),
          u.tail(m),
          vectorOf(given.friction)};
}

template <int D>
FrozenProblem<D> asProblem(const FclibProblem& from) {
  return RigidBodies<D>(from).problem();
}

template <int D>
FrozenProblem<D> asProblem(const FclibLocal& from) {
  const auto n = static_cast<int>(from.w.rows()), m = static_cast<int>(from.v.cols());
  Triplets entries;
  const auto put = [&](const Sparse& matrix, int row, int column, bool turned) {
    for (int k = 0; k < matrix.outerSize(); ++k) {
      for (Sparse::InnerIterator x(matrix, k); x; ++x) {
        const int i = row + static_cast<int>(x.row()), j = column + static_cast<int>(x.col());
        turned ? entries.emplace_back(j, i, x.value()) : entries.emplace_back(i, j, x.value());
      }
    }
  };
  put(from.w, 0, 0, false), put(from.v, 0, n, false), put(from.v, 0, n, true), put(from.r, n, n, false);
  const Sparse whole = matrixOf(n + m, static_cast<std::size_t>(n + m), entries), turned = whole.transpose();
  for (int j = 0; j < whole.cols(); ++j) {
    for (Sparse::InnerIterator x(whole, j); x; ++x) {
      const double scale = std::sqrt(std::abs(whole.coeff(j, j) * whole.coeff(x.row(), x.row())));
      if (std::abs(x.value() - turned.coeff(x.row(), j)) > kSame * scale)
        throw UserError("its W or R is not symmetric");
    }
  }
  if (from.mu.size() > 0 && from.mu.minCoeff() < 0) throw UserError("a coefficient of friction is negative");
  if (whole.diagonal().minCoeff() < 0) throw UserError("its W or R is negative on the diagonal");
  GivenProblem given;
  given.friction.assign(from.mu.begin(), from.mu.end());
  given.velocity.assign(from.q.begin(), from.q.end());
  given.velocity.insert(given.velocity.end(), from.s.begin(), from.s.end());
  given.impulse.assign(given.velocity.size(), 0);
  const Sparse halves = (whole + turned) / 2;  // symmetric to the last bit, as sweeps and factorisations expect
  for (int j = 0; j < halves.cols(); ++j) {
    for (Sparse::InnerIterator x(halves, j); x; ++x) {
      given.row.push_back(static_cast<std::int32_t>(x.row())), given.value.push_back(x.value());
    }
    given.start.push_back(static_cast<std::int32_t>(given.row.size()));
  }
  FrozenProblem<D> out;
  out.given = std::move(given);
  return out;
}

template <class Form>
std::string textOf(const Form& from) {
  std::ostringstream out;
  if (from.dimension == 2) {
    writeProblems<2>(out, {{"fclib", 0, asProblem<2>(from)}});
  } else {
    writeProblems<3>(out, {{"fclib", 0, asProblem<3>(from)}});
  }
  return out.str();
}

}  // namespace

template <int D>
std::string fclibBytes(const FrozenProblem<D>& problem, const std::string& path) {
  std::variant<FclibProblem, FclibLocal> from;
  try {
    if (problem.given) {
      from = localOf<D>(*problem.given);
    } else {
      from = globalOf(problem);
    }
  } catch (const UserError& e) {
    throw UserError(path + ": " + e.what() + "; valid: a file that ends in .json");
  }
  const std::string beside = path + ".fclib";
  std::remove(beside.c_str());  // the library would append to an existing file
  std::string bytes;
  try {
    inItsProcess("FCLIB", path, [&] {
      std::visit([&](auto& form) { writeFclibHere(beside, form); }, from);
      return std::string();
    });
    bytes = readFile(beside);
  } catch (const UserError&) {
    std::remove(beside.c_str());
    throw;
  }
  std::remove(beside.c_str());
  return bytes;
}
template std::string fclibBytes(const FrozenProblem<2>&, const std::string&);
template std::string fclibBytes(const FrozenProblem<3>&, const std::string&);

std::string fclibAsProblems(const std::string& path) {
  try {
    return inItsProcess("FCLIB", path,
                        [&] { return std::visit([](const auto& from) { return textOf(from); }, readFclibHere(path)); });
  } catch (const UserError& e) {
    const std::string said = e.what();
    const bool advised = said.find("; valid: ") != said.npos;
    throw UserError(said +
                    (advised ? "" : "; valid: FCLIB's global form, of rigid bodies, or its local form, W, q and mu"));
  }
}

}}  // namespace lpc::LPC_PRECISION
