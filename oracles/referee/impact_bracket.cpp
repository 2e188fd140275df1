// SPDX-License-Identifier: Zlib
#include "oracles/referee/impact_bracket.h"

#include <algorithm>
#include <limits>
#include <sstream>

namespace lpc { inline namespace LPC_PRECISION {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kMostHalvings = 60;  // of an interval of times: then its ends are neighbours
constexpr int kMostLooks = 1000;   // queries of a pair: bodies that slide along each other within the band need more

/// Rounding of poses, in multiples of epsilon times their coordinates (1). Larger: intervals are wide. Smaller: an
/// interval misses the true time.
constexpr double kPoseRounding = 16;

constexpr double kAlmost = 1 - 1e-9;  // so that a bound holds after rounding, too
constexpr int kPlainLooks = 20;       // queries after which the search uses second derivatives: the closing is slow

template <int D>
struct Seen {
  RefereeAnswer<D> answer;
  double s = 0;     // m
  double band = 0;  // m
};

template <int D>
Seen<D> look(const MovingPair<D>& pair, double t) {
  const auto now = static_cast<Real>(t);
  const PairView<D> view = pair.at(now);
  Seen<D> seen;
  seen.answer = referee(view.a, Pose<D>{}, view.b, view.X_AB);
  seen.s =
      errorScale(view.a, pair.A.bodyAt(now) * pair.A.X_CS, view.b, pair.B.bodyAt(now) * pair.B.X_CS, seen.answer.lo);
  seen.band = kImpactBand * seen.s;
  return seen;
}

// Largest distance (m) of a point of the core from the centre of mass. A rounding is the same all around. A plane does
// not move.
template <int D>
double reach(const ShapeView<D>& shape, const ShapeMotion<D>& motion) {
  if (shape.core() == CoreClass::plane) return 0;
  return static_cast<double>(motion.X_CS.p.norm()) + static_cast<double>(boundingRadius(shape) - shape.radius);
}

// Upper bound of the speed (m/s) along n of the core's points relative to the centre of mass.
template <int D>
double turning(const ShapeView<D>& shape, const ShapeMotion<D>& motion, const Vecd<D>& n) {
  return static_cast<double>(cross(motion.motion.w, Vec<D>(n.template cast<Real>())).norm()) * reach(shape, motion);
}

template <int D>
Rot<D> rotationOfA(const MovingPair<D>& pair, double t) {
  return pair.A.bodyAt(static_cast<Real>(t)).q * pair.A.X_CS.q;
}

// Upper bound of the speed (m/s) at which the separation along n, a direction in A's frame at t, can decrease from t
// on.
template <int D>
double closingSpeed(const MovingPair<D>& pair, double t, const Vecd<D>& n) {
  const Vec<D> inWorld = rotationOfA(pair, t) * Vec<D>(n.template cast<Real>());
  const Vecd<D> u = inWorld.template cast<double>().normalized();
  const Vecd<D> v = (pair.A.motion.v - pair.B.motion.v).template cast<double>();
  return v.dot(u) + turning(pair.a, pair.A, u) + turning(pair.b, pair.B, u);
}

/// What a direction turns with.
enum class Held { world, a, b };

// Upper bound of the acceleration (m/s^2) of the cores' points from t to the end, in a frame that turns with `held`:
// seen from a turning body, the other one has the Coriolis and centrifugal accelerations as well.
template <int D>
double bend(const MovingPair<D>& pair, Held held, double t, double end) {
  const double a = static_cast<double>(pair.A.motion.w.norm()), b = static_cast<double>(pair.B.motion.w.norm());
  const double reachA = reach(pair.a, pair.A), reachB = reach(pair.b, pair.B);
  const double v = static_cast<double>((pair.A.motion.v - pair.B.motion.v).norm());
  const auto now = static_cast<Real>(t);
  const double apart = static_cast<double>((pair.A.bodyAt(now).p - pair.B.bodyAt(now).p).norm()) + v * (end - t);
  const auto seenFrom = [&](double w, double turn, double r) {
    return turn * turn * r + 2 * w * (v + turn * r) + 3 * w * w * (apart + r);
  };
  switch (held) {
    case Held::world:
      return a * a * reachA + b * b * reachB;
    case Held::a:
      return seenFrom(a, b, reachB);
    case Held::b:
      return seenFrom(b, a, reachA);
  }
  return kInfinity;
}

// Bound (m) of the rounding of the separation by that of the poses, at any time.
template <int D>
double poseRounding(const MovingPair<D>& pair, double s, double duration) {
  const auto path = [&](const ShapeView<D>& shape, const ShapeMotion<D>& m) {
    return duration * static_cast<double>(m.motion.v.norm() + m.motion.w.norm() * static_cast<Real>(reach(shape, m)));
  };
  return kPoseRounding * static_cast<double>(std::numeric_limits<Real>::epsilon()) *
         (s + path(pair.a, pair.A) + path(pair.b, pair.B));
}

// A lower bound of the separation at t along n, a direction that turns with `held`; or of phi where a shape is a plane,
// which separates along its own normal alone.
template <int D>
double apartAlong(const MovingPair<D>& pair, double t, Held held, const Vec<D>& n) {
  if (pair.a.core() == CoreClass::plane || pair.b.core() == CoreClass::plane) return look(pair, t).answer.lo;
  const PairView<D> view = pair.at(static_cast<Real>(t));
  Vec<D> inA = n;
  if (held == Held::world) inA = rotationOfA(pair, t).inverse() * n;
  if (held == Held::b) inA = view.X_AB.q * n;
  return separationAlong(view.a, Pose<D>{}, view.b, view.X_AB, Vecd<D>(inA.template cast<double>())).lo;
}

// A time up to which the shapes, which have a gap > 0 along n at t, are separated along n, which turns with `held`.
// From t to u the separation is at least the chord between its values, minus bend / 2 (s - t)(u - s) at s. So phi > 0
// up to u = t + sqrt(2 gap / bend) when the separation is positive at u, whatever its value.
template <int D>
double separatedUntil(const MovingPair<D>& pair, double t, Held held, const Vecd<D>& n, double gap, double rounding,
                      double end) {
  Vec<D> u = n.template cast<Real>();
  if (held == Held::world) u = rotationOfA(pair, t) * u;
  if (held == Held::b) u = pair.at(static_cast<Real>(t)).X_AB.q.inverse() * u;
  const double most = bend(pair, held, t, end), sure = most > 0 ? kAlmost * std::sqrt(2 * gap / most) : kInfinity;
  double lo = t, hi = std::min(end, t + sure);
  if (apartAlong(pair, hi, held, u) > rounding) return hi;
  for (int k = 0; k < kMostHalvings; ++k) {
    const double middle = lo + (hi - lo) / 2;
    if (!(middle > lo && middle < hi)) break;
    (apartAlong(pair, middle, held, u) > rounding ? lo : hi) = middle;
  }
  return lo;
}

// The latest of these times, for a direction that stays in the world or on one of the bodies: the normal of a face
// turns with it, and along another direction its far end would close fast.
template <int D>
double separatedUntil(const MovingPair<D>& pair, double t, const Vecd<D>& n, double gap, double rounding, double end) {
  double out = t;
  for (const Held held : {Held::world, Held::a, Held::b}) {
    out = std::max(out, separatedUntil(pair, t, held, n, gap, rounding, end));
  }
  return out;
}

}  // namespace

template <int D>
double impactError(const MovingPair<D>& pair, Real t) {
  const Seen<D> seen = look(pair, static_cast<double>(t));
  if (!seen.answer.decided) return std::numeric_limits<double>::quiet_NaN();
  const double phi = seen.answer.interval().middle();
  return (t > 0 ? std::abs(phi) : std::max(phi, 0.0)) / seen.s;
}

template <int D>
Interval firstTouch(const MovingPair<D>& pair, Real duration) {
  const double end = static_cast<double>(duration);
  double t = 0, rounding = 0;
  bool passed = false;  // phi > 0 up to the end
  for (int looks = 0; looks < kMostLooks; ++looks) {
    const Seen<D> seen = look(pair, t);
    rounding = poseRounding(pair, seen.s, end);
    const double gap = seen.answer.lo - rounding;
    if (!(gap > 0)) break;
    const double speed = closingSpeed(pair, t, seen.answer.normal);
    passed = t >= end || speed <= 0;
    if (passed) break;
    const double next =
        std::max(std::min(end, t + gap / speed), separatedUntil(pair, t, seen.answer.normal, gap, rounding, end));
    if (!(next > t)) break;
    t = next;
  }
  if (passed) return {kInfinity, kInfinity};
  Interval out{t, kInfinity};
  double before = t;
  for (double step = std::max(t, end) * std::numeric_limits<double>::epsilon(); before < end; step *= 2) {
    const double after = std::min(end, t + step);
    if (look(pair, after).answer.hi < -rounding) {
      out.hi = after;
      break;
    }
    before = after;
  }
  if (out.hi == kInfinity) return out;
  for (int k = 0; k < kMostHalvings; ++k) {
    const double middle = before + (out.hi - before) / 2;
    if (!(middle > before && middle < out.hi)) break;
    (look(pair, middle).answer.hi < -rounding ? out.hi : before) = middle;
  }
  return out;
}

template <int D>
ImpactBracket impactBracket(const MovingPair<D>& pair, Real duration) {
  const double end = static_cast<double>(duration);
  ImpactBracket out{true, end, kInfinity};
  bool near = false;
  double t = 0, stride = 0;
  for (int looks = 0; t <= end; ++looks) {
    const Seen<D> seen = look(pair, t);
    if (!std::isfinite(seen.answer.lo) || looks == kMostLooks) return {false, std::min(t, out.free), out.met};
    if (seen.answer.lo <= seen.band && !near) near = true, out.free = t;
    if (seen.answer.hi < -seen.band) {
      out.met = t;
      return out;
    }
    const double speed = closingSpeed(pair, t, seen.answer.normal);
    if (t >= end || (speed <= 0 && !near)) break;
    if (near) {  // nothing more can be proved: search for contact with growing steps
      stride = std::min(std::max(2 * stride, seen.band / std::max(std::abs(speed), seen.band)), end / 64);
    } else {
      stride = seen.answer.lo / speed;
      const double rounding = poseRounding(pair, seen.s, end), gap = seen.answer.lo - rounding;
      if (looks >= kPlainLooks && gap > 0) {
        stride = std::max(stride, separatedUntil(pair, t, seen.answer.normal, gap, rounding, end) - t);
      }
    }
    t = std::min(end, std::max(t + stride, std::nextafter(t, kInfinity)));
  }
  return out;
}

template <int D>
std::string impactFault(const MovingPair<D>& pair, Real duration, const TimeOfImpactAnswer<D>& answer,
                        const ImpactBracket& bracket) {
  std::ostringstream out;
  out.precision(17);
  const double t = static_cast<double>(answer.t), end = static_cast<double>(duration);
  const double rounding = 64 * static_cast<double>(std::numeric_limits<Real>::epsilon()) * end;
  if (answer.status == QueryStatus::failed || answer.status == QueryStatus::refused) {
    out << "no answer";
  } else if (!(t >= 0 && t <= end)) {
    out << "no time of the motion: " << t;
  } else if (!answer.hit && answer.status == QueryStatus::converged && (bracket.met < end || t < end)) {
    out << "missed: they are in each other at " << bracket.met;
  } else if (t > bracket.met + rounding) {
    out << "late: " << t << ", but they are in each other at " << bracket.met;
  } else if (answer.hit) {
    const Seen<D> seen = look(pair, t);
    const double phi = seen.answer.interval().middle();
    if (phi > seen.band || (phi < -seen.band && t > 0)) out << "no first contact at " << t << ": distance " << phi;
  }
  return out.str();
}

template ImpactBracket impactBracket(const MovingPair<2>&, Real);
template ImpactBracket impactBracket(const MovingPair<3>&, Real);
template Interval firstTouch(const MovingPair<2>&, Real);
template Interval firstTouch(const MovingPair<3>&, Real);
template double impactError(const MovingPair<2>&, Real);
template double impactError(const MovingPair<3>&, Real);
template std::string impactFault(const MovingPair<2>&, Real, const TimeOfImpactAnswer<2>&, const ImpactBracket&);
template std::string impactFault(const MovingPair<3>&, Real, const TimeOfImpactAnswer<3>&, const ImpactBracket&);

}}  // namespace lpc::LPC_PRECISION
