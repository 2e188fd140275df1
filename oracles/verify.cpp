// SPDX-License-Identifier: Zlib
#include "oracles/verify.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <limits>
#include <ostream>
#include <sstream>

#include "framework/stage_narrowphase.h"
#include "oracles/hard_pairs.h"
#include "oracles/referee.h"

namespace lpc::inline LPC_PRECISION {
namespace {

template <int D>
std::string listed(const Vec<D>& v) {
  std::ostringstream out;
  out << std::setprecision(std::numeric_limits<Real>::max_digits10) << '[';
  for (int k = 0; k < D; ++k) out << (k ? ", " : "") << v[k];
  return out.str() + "]";
}

template <int D>
std::string shapeText(const ShapeView<D>& s) {
  std::ostringstream out;
  out << std::setprecision(std::numeric_limits<Real>::max_digits10);
  switch (s.kind) {
    case ShapeKind::sphere:
      out << R"({"type": "sphere")";
      break;
    case ShapeKind::capsule:
      out << R"({"type": "capsule", "axis": "x", "half_length": )" << s.half[0];
      break;
    case ShapeKind::segment:
      out << R"({"type": "segment", "points": [)" << listed<D>(-s.half) << ", " << listed<D>(s.half) << ']';
      break;
    case ShapeKind::box:
      out << R"({"type": "box", "half_extents": )" << listed<D>(s.half);
      break;
    case ShapeKind::polytope:
      out << R"({"type": "convex", "points": [)";
      for (std::size_t i = 0; i < s.hull->vertices.size(); ++i)
        out << (i ? ", " : "") << listed<D>(s.hull->vertices[i]);
      out << ']';
      break;
  }
  if (s.radius > 0 || s.kind == ShapeKind::sphere) out << ", \"radius\": " << s.radius;
  return out.str() + "}";
}

std::string poseText(const Pose<2>& X) {
  std::ostringstream out;
  out << std::setprecision(std::numeric_limits<Real>::max_digits10);
  out << "{\"t\": " << listed<2>(X.p) << ", \"angle\": " << X.q.radians() << "}";
  return out.str();
}
std::string poseText(const Pose<3>& X) {
  std::ostringstream out;
  out << std::setprecision(std::numeric_limits<Real>::max_digits10);
  out << "{\"t\": " << listed<3>(X.p) << ", \"q_wxyz\": [" << X.q.w << ", " << X.q.x << ", " << X.q.y << ", " << X.q.z
      << "]}";
  return out.str();
}

// As a case of tests/regressions/*.json, so that it can be pasted there.
template <int D>
std::string caseText(const HardPair<D>& pair, const PairAnswer<D>& answer, const RefereeAnswer<D>& truth) {
  std::ostringstream out;
  out << std::setprecision(std::numeric_limits<double>::max_digits10);
  out << "{\"dim\": " << D << ", \"query\": \"signed_distance\", \"note\": \"" << pair.family
      << "\", \"shapeA\": " << shapeText<D>(pair.a.view()) << ", \"poseA\": " << poseText(Pose<D>{})
      << ", \"shapeB\": " << shapeText<D>(pair.b.view()) << ", \"poseB\": " << poseText(pair.X_AB)
      << ", \"answer\": " << answer.distance << ", \"status\": \"" << queryStatusName(answer.status)
      << "\", \"expected\": {\"signed_distance\": " << truth.interval().middle() << "}}";
  return out.str();
}

template <int D>
struct Known {
  HardPair<D> pair;
  RefereeAnswer<D> truth;
  double size;
};

template <int D>
void judge(const Known<D>& known, const PairAnswer<D>& answer, VerifyRow& row, std::vector<double>& errors) {
  const Interval truth = known.truth.interval();
  ++row.asked;
  if (!known.truth.decided) {
    ++row.undecided;
    return;
  }
  bool shown = false;
  double error = 0;
  const bool value = std::isfinite(answer.distance) && answer.normal.allFinite();
  if (answer.status == QueryStatus::refused) {
    ++row.refused;
  } else if (answer.status == QueryStatus::failed || !value) {
    ++row.failed;
    shown = true, error = std::numeric_limits<double>::infinity();
  } else {
    const double tolerance = verifyTolerance() * known.size, phi = answer.distance;
    if ((phi < 0 && truth.lo > tolerance) || (phi >= 0 && truth.hi < -tolerance)) ++row.wrongSide, shown = true;
    // A witness that is `degenerate` knows the side and no value (libccd of shapes that are apart).
    if (row.role == Role::competitor || answer.status != QueryStatus::degenerate) {
      error = truth.distanceTo(phi);
      if (!answer.normal.isZero(0)) {
        // The normal is judged by the separation along it, which is all that a normal is for.
        const Vecd<D> n = answer.normal.template cast<double>();
        const Interval along = separationAlong<D>(known.pair.a.view(), {}, known.pair.b.view(), known.pair.X_AB, n);
        error = std::max(error, truth.lo - along.hi);
      }
      error /= known.size;
      errors.push_back(error);
      if (error > verifyTolerance()) ++row.disagreements, shown = true;
    }
  }
  if (shown && (row.worst.empty() || error > row.maxError)) row.worst = caseText<D>(known.pair, answer, known.truth);
  if (std::isfinite(error)) row.maxError = std::max(row.maxError, error);
}

template <int D>
void verifyKinds(ShapeKind a, ShapeKind b, const VerifyOptions& options, const std::vector<Spec>& methods,
                 std::vector<VerifyRow>& rows) {
  std::vector<Known<D>> known;
  for (int i = 0; i < options.pairs; ++i) {
    Known<D> k{hardPair<D>(a, b, options.scale, options.seed, i), {}, 0};
    const ShapeView<D>&va = k.pair.a.view(), &vb = k.pair.b.view();
    k.truth = referee<D>(va, {}, vb, k.pair.X_AB);
    k.size = errorScale<D>(va, {}, vb, k.pair.X_AB, k.truth.interval().middle());
    known.push_back(std::move(k));
  }
  const auto batch = std::make_unique<PairBatch<D>>();
  const auto answers = std::make_unique<PairAnswers<D>>();
  for (const Spec& spec : methods) {
    VerifyRow row{.a = a, .b = b, .method = spec.text()};
    row.role = Registry::instance().find(StageKind::pairQuery, D, spec.name).info.role;
    const auto method = createStage<PairQuery<D>>(spec);
    row.supported = method->supports(a, b);
    std::vector<double> errors;
    Work work;
    for (std::size_t begin = 0; row.supported && begin < known.size(); begin += PairBatch<D>::kCapacity) {
      const std::size_t end = std::min(known.size(), begin + PairBatch<D>::kCapacity);
      batch->clear(a, b);
      for (std::size_t i = begin; i < end; ++i) {
        batch->add(known[i].pair.a.view(), known[i].pair.b.view(), known[i].pair.X_AB);
      }
      method->query(*batch, Need::witnesses, *answers, {}, work);
      for (std::size_t i = begin; i < end; ++i) judge(known[i], answers->get(static_cast<int>(i - begin)), row, errors);
    }
    std::sort(errors.begin(), errors.end());
    if (!errors.empty()) row.medianError = errors[errors.size() / 2];
    rows.push_back(std::move(row));
  }
}

template <int D>
std::vector<VerifyRow> verifyIn(const VerifyOptions& options) {
  std::vector<Spec> methods;
  for (const std::string& text : options.methods) methods.push_back(Spec::parse(text));
  if (methods.empty()) {
    for (const Registered* r : Registry::instance().list(StageKind::pairQuery, D))
      methods.push_back({r->info.name, {}});
  }
  std::vector<VerifyRow> rows;
  for (int a = 0; a < kShapeKinds; ++a) {
    for (int b = a; b < kShapeKinds; ++b) {
      const auto kindA = static_cast<ShapeKind>(a), kindB = static_cast<ShapeKind>(b);
      if (D == 3 && (kindA == ShapeKind::segment || kindB == ShapeKind::segment)) continue;  // exist in 2D only
      verifyKinds<D>(kindA, kindB, options, methods, rows);
    }
  }
  return rows;
}

bool isFault(const VerifyRow& r) {
  return r.role == Role::competitor && r.supported && r.refused + r.failed + r.wrongSide + r.disagreements > 0;
}

}  // namespace

double verifyTolerance() { return sizeof(Real) == 8 ? 1e-12 : 1e-5; }

std::vector<VerifyRow> verifyPairs(const VerifyOptions& options) {
  if (options.dimension == 2) return verifyIn<2>(options);
  if (options.dimension == 3) return verifyIn<3>(options);
  throw UserError("verify: the dimension is " + std::to_string(options.dimension) + "; valid: 2, 3");
}

int printVerification(const std::vector<VerifyRow>& rows, std::ostream& out) {
  const auto kinds = [](const VerifyRow& r) {
    return std::string(shapeKindName(r.a)) + " " + std::string(shapeKindName(r.b));
  };
  out << std::left << std::setw(19) << "shapes" << std::setw(14) << "method" << std::right;
  for (const char* head : {"asked", "refused", "failed", "wrong side", "disagree"}) out << std::setw(11) << head;
  out << std::setw(12) << "max error" << std::setw(12) << "median"
      << "\n";
  int faults = 0;
  for (const VerifyRow& r : rows) {
    out << std::left << std::setw(19) << kinds(r) << std::setw(14) << r.method << std::right;
    if (!r.supported) {
      out << "    not its kinds\n";
      continue;
    }
    for (const int n : {r.asked, r.refused, r.failed, r.wrongSide, r.disagreements}) out << std::setw(11) << n;
    out << std::setprecision(1) << std::scientific << std::setw(12) << r.maxError << std::setw(12) << r.medianError
        << std::defaultfloat << (isFault(r) ? "  WRONG" : "") << (r.role == Role::competitor ? "" : "  (witness)");
    if (r.undecided > 0) out << "  " << r.undecided << " undecided";
    out << "\n";
    faults += isFault(r);
  }
  bool first = true;
  for (const VerifyRow& r : rows) {
    if (r.worst.empty()) continue;
    if (first) out << "\nworst cases, to paste into a file of cases (lpc verify --cases FILE):\n";
    first = false;
    out << r.method << " " << kinds(r) << ": " << r.worst << "\n";
  }
  return faults;
}

}  // namespace lpc::inline LPC_PRECISION
