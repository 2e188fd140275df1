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
Viewport Reel<D>::viewportOf(const typename Recording<D>::Frame& frame, bool fixedOnes) const {
  const Camera<D> camera;
  Viewport out;
  for (const auto& body : frame.bodies) {
    const auto actor = m_cast.find({body.slot, body.generation});
    if (actor == m_cast.end() || (actor->second.type == BodyType::fixed) != fixedOnes || !isPlace(body.X_WC)) continue;
    for (const ShapePart<D>& part : actor->second.parts) {
      if (part.shape.isPlane()) continue;
      const Pose<D> X_WS = body.X_WC * part.X_SP;
      const auto farthest = [&](const Vec<D>& d_W) {
        return d_W.dot(X_WS.p) + supportValue(part.shape.view(), X_WS.q.inverse() * d_W);
      };
      const Vec<2> hi(farthest(camera.right), farthest(camera.up));
      const Vec<2> lo(-farthest(-camera.right), -farthest(-camera.up));
      if ((lo.cwiseAbs().cwiseMax(hi.cwiseAbs()).array() < kFarthest).all()) out.take(lo, hi);
    }
  }
  return out;
}

template <int D>
Viewport Reel<D>::viewport(double follow) const {
  Viewport first, all;
  for (const auto& frame : frames()) {
    const Viewport box = viewportOf(frame, false);
    if (first.empty()) first = box;
    all.take(box.lo, box.hi);
  }
  if (all.empty()) first = all = viewportOf(frames()[0], true);
  if (all.empty()) all.take({-1, -1}, {1, 1}), first = all;
  const Vec<2> limit = Vec<2>::Constant(std::max(follow, (first.hi - first.lo).maxCoeff()));
  return {all.lo.cwiseMax(first.lo - limit), all.hi.cwiseMin(first.hi + limit)};
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
Picture Reel<D>::picture(std::size_t index, const Camera<D>& camera) const {
  PictureDraw<D> draw(camera);
  for (const auto& body : frames()[index].bodies) {
    const auto actor = m_cast.find({body.slot, body.generation});
    if (actor == m_cast.end() || !isPlace(body.X_WC)) continue;
    const Look look = bodyLook(static_cast<std::size_t>(body.slot), actor->second.type, body.awake);
    for (const ShapePart<D>& part : actor->second.parts) {
      draw.shape(part.shape.view(), body.X_WC * part.X_SP, look);
    }
  }
  Picture out = draw.picture();
  char text[64];
  std::snprintf(text, sizeof text, "step %lld, %.2f s", static_cast<long long>(frames()[index].step),
                frames()[index].time);
  out.labels.push_back({{6, 16}, text});
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
template Camera<3> cameraOf(const Viewport&, double);
template class Reel<2>;
template class Reel<3>;
template std::optional<Divergence> divergenceOf(const Reel<2>&, const Reel<2>&, double);
template std::optional<Divergence> divergenceOf(const Reel<3>&, const Reel<3>&, double);

}}  // namespace lpc::LPC_PRECISION
