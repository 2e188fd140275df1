// SPDX-License-Identifier: Zlib
#include "oracles/referee/impact_bracket.h"

#include <algorithm>
#include <limits>
#include <sstream>

namespace lpc { inline namespace LPC_PRECISION {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kMostLooks = 1000;  // queries of a pair: bodies that slide along each other within the band need more

template <int D>
struct Seen {
  RefereeAnswer<D> answer;
  double band = 0;  // m
};

template <int D>
Seen<D> look(const MovingPair<D>& pair, double t) {
  const auto now = static_cast<Real>(t);
  const PairView<D> view = pair.at(now);
  Seen<D> seen;
  seen.answer = referee(view.a, Pose<D>{}, view.b, view.X_AB);
  seen.band = kImpactBand * errorScale(view.a, pair.A.bodyAt(now) * pair.A.X_CS, view.b,
                                       pair.B.bodyAt(now) * pair.B.X_CS, seen.answer.lo);
  return seen;
}

// Upper bound of the speed (m/s) along n of the shape's points relative to the centre of mass.
template <int D>
double turning(const ShapeView<D>& shape, const ShapeMotion<D>& motion, const Vecd<D>& n) {
  if (shape.core() == CoreClass::plane) return 0;
  const double reach = static_cast<double>(motion.X_CS.p.norm()) + static_cast<double>(boundingRadius(shape));
  return static_cast<double>(cross(motion.motion.w, Vec<D>(n.template cast<Real>())).norm()) * reach;
}

// Upper bound of the speed (m/s) at which the separation along n, a direction in A's frame at t, can decrease from t
// on.
template <int D>
double closingSpeed(const MovingPair<D>& pair, double t, const Vecd<D>& n) {
  const Vec<D> inWorld = pair.A.bodyAt(static_cast<Real>(t)).q * (pair.A.X_CS.q * Vec<D>(n.template cast<Real>()));
  const Vecd<D> u = inWorld.template cast<double>().normalized();
  const Vecd<D> v = (pair.A.motion.v - pair.B.motion.v).template cast<double>();
  return v.dot(u) + turning(pair.a, pair.A, u) + turning(pair.b, pair.B, u);
}

}  // namespace

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
template std::string impactFault(const MovingPair<2>&, Real, const TimeOfImpactAnswer<2>&, const ImpactBracket&);
template std::string impactFault(const MovingPair<3>&, Real, const TimeOfImpactAnswer<3>&, const ImpactBracket&);

}}  // namespace lpc::LPC_PRECISION
