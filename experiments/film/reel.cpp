// SPDX-License-Identifier: Zlib
#include "experiments/film/reel.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <limits>

#include "experiments/film/picture_draw.h"
#include "framework/draw/draw_simulation.h"
#include "framework/math/check.h"
#include "framework/shape/curved_core.h"
#include "framework/shape/support_map.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

constexpr double kFarthest = 1e100;  // m: no picture shows larger sizes or distances

// For each part the recording has the arguments of its factory; for a curved kind the half extents, the first of which
// are its sizes. A plugin's kind is drawn as its box, since its sizes may mean anything.
template <int D>
Shape<D> shapeOf(const typename Recording<D>::NewBody::Part& p) {
  switch (coreClass(p.kind)) {
    case CoreClass::point:
      return Shape<D>::sphere(p.radius);
    case CoreClass::segment:
      return p.kind == ShapeKind::segment ? Shape<D>::segment(p.half[0]) : Shape<D>::capsule(p.half[0], p.radius);
    case CoreClass::box:
      return Shape<D>::box(p.half, p.radius);
    case CoreClass::hull:
      return Shape<D>::ofCorners(p.kind, p.vertices, p.radius);
    case CoreClass::curved:
      if (p.kind == ShapeKind::custom) return Shape<D>::box(p.half, p.radius);
      return Shape<D>::curved(p.kind, {p.half.data(), std::min<std::size_t>(D, curvedKind<D>(p.kind).sizes.size())},
                              p.radius);
    case CoreClass::plane:
      break;
  }
  return Shape<D>::plane();
}

double angleOf(const Rot<2>& q) { return std::abs(q.radians()); }
double angleOf(const Rot<3>& q) { return 2 * std::atan2(std::hypot(q.x, q.y, q.z), std::abs(q.w)); }

template <int D>
Real farthest(const Shape<D>& shape, const Pose<D>& X_WS, const Vec<D>& d_W) {
  return d_W.dot(X_WS.p) + supportValue(shape.view(), X_WS.q.inverse() * d_W);
}

// A convex part of a static body: a plane, or its box.
template <int D>
struct Ground {
  Ground(const Shape<D>& shape, const Pose<D>& X_WS) : isPlane(shape.isPlane()), p(X_WS.p) {
    normal = X_WS.q * Vec<D>(Vec<D>::UnitY());
    for (int d = 0; d < D && !isPlane; ++d) {
      lo[d] = -farthest<D>(shape, X_WS, -Vec<D>::Unit(d)), hi[d] = farthest<D>(shape, X_WS, Vec<D>::Unit(d));
    }
  }
  // Infinite where there is none.
  Real topBelow(const Vec<D>& q) const {
    constexpr Real kNone = -std::numeric_limits<Real>::infinity();
    if (isPlane) return normal[1] > 0 ? q[1] - normal.dot(q - p) / normal[1] : kNone;
    for (int d = 0; d < D; ++d) {
      if (d != 1 && !(lo[d] <= q[d] && q[d] <= hi[d])) return kNone;
    }
    return hi[1];
  }

  bool isPlane;
  Vec<D> p, normal, lo = Vec<D>::Zero(), hi = lo;
};

}  // namespace

template <int D>
Reel<D>::Reel(const std::string& path) try {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw UserError("cannot be read");
  m_recording = Recording<D>::read(in);
  if (m_recording.frames.empty()) throw UserError("the recording has no frames");
  for (const auto& frame : m_recording.frames) {
    for (const auto& newBody : frame.newBodies) {
      Actor& actor = m_cast[{newBody.slot, newBody.generation}];
      actor.type = newBody.type;
      for (const auto& part : newBody.parts) actor.parts.push_back({shapeOf<D>(part), part.X_CS});
    }
  }
} catch (const UserError& e) {
  throw UserError(path + ": " + e.what());
}

template <int D>
auto Reel<D>::actorOf(const typename Recording<D>::Body& body) const -> const Actor* {
  const auto actor = m_cast.find({body.slot, body.generation});
  return actor == m_cast.end() || !isPlace(body.X_WC) ? nullptr : &actor->second;
}

template <int D>
Viewport Reel<D>::boxOf(const Actor& actor, const Pose<D>& X_WC) {
  const Camera<D> camera;
  Viewport out;
  for (const ShapePart<D>& part : actor.parts) {
    if (part.shape.isPlane()) continue;
    const Pose<D> X_WS = X_WC * part.X_SP;
    const Vec<2> hi(farthest<D>(part.shape, X_WS, camera.right), farthest<D>(part.shape, X_WS, camera.up));
    const Vec<2> lo(-farthest<D>(part.shape, X_WS, -camera.right), -farthest<D>(part.shape, X_WS, -camera.up));
    if ((lo.cwiseAbs().cwiseMax(hi.cwiseAbs()).array() < kFarthest).all()) out.take(lo, hi);
  }
  return out;
}

template <int D>
Viewport Reel<D>::startOf(double reach) const {
  const Camera<D> camera;
  Viewport out;
  std::vector<Ground<D>> grounds;
  std::vector<Viewport> fixed;
  for (const Frame& frame : frames()) {
    if (frame.newBodies.empty()) continue;
    std::vector<Vec<D>> starts;
    for (const auto& body : frame.bodies) {
      const auto known = std::find_if(frame.newBodies.begin(), frame.newBodies.end(), [&](const auto& newBody) {
        return newBody.slot == body.slot && newBody.generation == body.generation;
      });
      const Actor* actor = known == frame.newBodies.end() ? nullptr : actorOf(body);
      if (!actor) continue;
      if (actor->type == BodyType::fixed) {
        for (const ShapePart<D>& part : actor->parts) grounds.emplace_back(part.shape, body.X_WC * part.X_SP);
        fixed.push_back(boxOf(*actor, body.X_WC));
      } else {
        out.take(boxOf(*actor, body.X_WC));
        starts.push_back(body.X_WC.p);
      }
    }
    for (const Vec<D>& p : starts) {
      Real highest = -std::numeric_limits<Real>::infinity();
      for (const Ground<D>& ground : grounds) {
        if (const Real y = ground.topBelow(p); y <= p[1]) highest = std::max(highest, y);
      }
      if (!(p[1] - highest <= reach)) continue;
      Vec<D> foot = p;
      foot[1] = highest;
      out.take(camera.flat(foot), camera.flat(foot));
    }
  }
  // Static bodies beside the moving ones, or all of them.
  const double beside = out.empty() ? std::numeric_limits<double>::infinity() : out.size().maxCoeff() / 2;
  const Viewport moving = out;
  for (const Viewport& box : fixed) {
    if (box.empty()) continue;
    const auto near = [&](const Vec<2>& lo, const Vec<2>& hi) {
      return ((lo - moving.lo).array() >= -beside).all() && ((moving.hi - hi).array() >= -beside).all();
    };
    if (moving.empty() || near(box.lo, box.hi)) out.take(box);
  }
  if (out.empty()) out.take({-1, -1}, {1, 1});
  return out;
}

template <int D>
std::vector<Viewport> Reel<D>::views(double follow) const {
  constexpr double kReach = 4;  // sizes of the start, to the ground
  const Viewport start = startOf(kReach * std::max(follow, startOf(0).size().maxCoeff()));
  const double far = std::max(follow, start.size().maxCoeff());
  const Camera<D> camera;
  std::vector<Viewport> out;
  for (const Frame& frame : frames()) {
    std::vector<Viewport> boxes;
    std::vector<double> x, y;
    for (const auto& body : frame.bodies) {
      const Actor* actor = actorOf(body);
      if (!actor || actor->type == BodyType::fixed) continue;
      const Viewport box = boxOf(*actor, body.X_WC);
      if (box.empty()) continue;
      boxes.push_back(box);
      x.push_back(box.middle()[0]), y.push_back(box.middle()[1]);
    }
    Viewport& view = out.emplace_back();
    if (boxes.empty()) {
      view = start;
      continue;
    }
    for (auto* all : {&x, &y}) std::nth_element(all->begin(), all->begin() + all->size() / 2, all->end());
    const Vec<2> median(x[x.size() / 2], y[y.size() / 2]);
    const auto seen = [&](const Vec<2>& p) { return (p - median).cwiseAbs().maxCoeff() <= far; };
    const auto way = [&](const Viewport& box) { return (box.middle() - median).squaredNorm(); };
    view = *std::min_element(boxes.begin(), boxes.end(), [&](const auto& a, const auto& b) { return way(a) < way(b); });
    for (const Viewport& box : boxes) {
      if (seen(box.middle())) view.take(box);
    }
    for (const Link<D>& link : frame.links) {
      for (const Vec<D>& p : {link.a, link.b}) {
        if (seen(camera.flat(p))) view.take(camera.flat(p), camera.flat(p));
      }
    }
    // The start, unless the bodies have left it.
    if (seen(start.middle())) view.take(start);
  }
  return out;
}
template <int D>
Camera<D> cameraOf(const Viewport& viewport, double width) {
  Camera<D> camera;
  const Vec<2> margin = Vec<2>::Constant(0.06 * (viewport.hi - viewport.lo).maxCoeff());
  const Vec<2> size = viewport.hi - viewport.lo + 2 * margin;
  camera.middle = (viewport.lo + viewport.hi) / 2;
  camera.width = width;
  camera.height = std::clamp(width * size[1] / size[0], 0.4 * width, 1.2 * width);
  camera.scale = std::min(camera.width / size[0], camera.height / size[1]);
  camera.height += camera.kBand;
  return camera;
}

template <int D>
std::vector<Camera<D>> camerasOf(const std::vector<Viewport>& views, double width) {
  constexpr double kLongWay = 12;  // times the largest view: bodies in a picture of all of it would be dots
  Viewport all;
  Vec<2> largest = Vec<2>::Zero();
  for (const Viewport& view : views) all.take(view), largest = largest.cwiseMax(view.size());
  const bool follows = all.size().maxCoeff() > kLongWay * largest.maxCoeff();
  const Camera<D> one = cameraOf<D>(follows ? Viewport{-largest, largest} : all, width);
  std::vector<Camera<D>> out(views.size(), one);
  for (std::size_t i = 0; follows && i < views.size(); ++i) out[i].middle = views[i].middle();
  return out;
}

template <int D>
Picture Reel<D>::picture(std::size_t index, const Camera<D>& camera) const {
  PictureDraw<D> draw(camera);
  for (const auto& body : frames()[index].bodies) {
    const Actor* actor = actorOf(body);
    if (!actor) continue;
    const Look look = bodyLook(static_cast<std::size_t>(body.slot), actor->type, body.awake);
    for (const ShapePart<D>& part : actor->parts) {
      draw.shape(part.shape.view(), body.X_WC * part.X_SP, look);
    }
  }
  for (const Link<D>& link : frames()[index].links) drawLink(link, std::nullopt, draw);
  Picture out = draw.picture();
  char text[64];
  std::snprintf(text, sizeof text, "step %lld, %.2f s", static_cast<long long>(frames()[index].step),
                frames()[index].time);
  out.labels.push_back({{6, 14}, text});
  if (!m_recording.title.empty()) out.labels.push_back({{6, 29}, m_recording.title});
  return out;
}

template <int D>
std::optional<Divergence> divergenceOf(const Reel<D>& a, const Reel<D>& b, double tolerance) {
  const std::size_t count = std::min(a.frames().size(), b.frames().size());
  for (std::size_t i = 0; i < count; ++i) {
    const auto &ours = a.frames()[i].bodies, &theirs = b.frames()[i].bodies;
    const auto step = a.frames()[i].step;
    if (ours.size() != theirs.size()) {
      return Divergence{
          i, step,
          "one run has " + std::to_string(ours.size()) + " bodies, the other " + std::to_string(theirs.size())};
    }
    for (std::size_t k = 0; k < ours.size(); ++k) {
      const std::string body = "body " + std::to_string(std::min(ours[k].slot, theirs[k].slot));
      if (ours[k].slot != theirs[k].slot) return Divergence{i, step, body + " exists in one run only"};
      if (ours[k].generation != theirs[k].generation)
        return Divergence{i, step, body + " is a different body in each run"};
      const double way = (ours[k].X_WC.p - theirs[k].X_WC.p).norm();
      const double turn = angleOf(ours[k].X_WC.q.inverse() * theirs[k].X_WC.q);
      char text[80];
      // Written so that NaN counts as apart.
      if (!(way <= tolerance)) {
        std::snprintf(text, sizeof text, " is %.3g m apart", way);
        return Divergence{i, step, body + text};
      }
      if (!(turn <= tolerance)) {
        std::snprintf(text, sizeof text, " is turned by %.3g rad", turn);
        return Divergence{i, step, body + text};
      }
    }
  }
  if (a.frames().size() == b.frames().size()) return std::nullopt;
  return Divergence{count - 1, a.frames()[count - 1].step, "one run continues, the other ends"};
}

template Camera<2> cameraOf(const Viewport&, double);
template std::vector<Camera<2>> camerasOf(const std::vector<Viewport>&, double);
template std::vector<Camera<3>> camerasOf(const std::vector<Viewport>&, double);
template Camera<3> cameraOf(const Viewport&, double);
template class Reel<2>;
template class Reel<3>;
template std::optional<Divergence> divergenceOf(const Reel<2>&, const Reel<2>&, double);
template std::optional<Divergence> divergenceOf(const Reel<3>&, const Reel<3>&, double);

}}  // namespace lpc::LPC_PRECISION
