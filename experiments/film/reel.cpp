// SPDX-License-Identifier: Zlib
#include "experiments/film/reel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <limits>

#include "experiments/film/depth_order.h"
#include "experiments/film/shape_patches.h"
#include "framework/check.h"
#include "framework/curved_core.h"
#include "framework/support_map.h"

namespace lpc::inline LPC_PRECISION {
namespace {

constexpr double kFarthest = 1e100;  // m: of what is larger or farther no picture has a size
constexpr Colour kFixed{205, 205, 200}, kFixedEdge{120, 120, 115};
// Bodies take turns, so that neighbours are told apart.
constexpr std::array<Colour, 6> kColours = {
    {{102, 153, 204}, {238, 170, 85}, {119, 178, 119}, {204, 119, 136}, {160, 140, 200}, {190, 180, 100}}};

// The recording has of each part what its factory takes; of a curved kind the half extents, whose first ones are its
// sizes. A plugin's kind is drawn as its box: its sizes may be anything.
template <int D>
Shape<D> shapeOf(const typename Recording<D>::Arrival::Part& p) {
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

template <int D>
bool finite(const Pose<D>& X) {
  return X.p.allFinite() && (X.q * Vec<D>(Vec<D>::UnitX())).allFinite();
}

// A convex part of a body.
struct Drawn {
  bool moves;
  SeenPart seen;  // in 3D
  std::vector<Patch> patches;
};

// Its edges alone.
std::vector<Patch> ofGlass(const std::vector<Patch>& patches) {
  std::vector<Patch> out;
  for (const Patch& p : patches) {
    for (std::size_t i = 0; i < p.corners.size(); ++i) {
      out.push_back({{p.corners[i], p.corners[(i + 1) % p.corners.size()]}, p.edge, p.edge});
    }
  }
  return out;
}

// From back to front. In the plane nobody is behind another, and what moves is drawn last. In space what never moves
// may stand in front of what does, a wall or the ground of what fell through it: there it is of glass, since the bodies
// are what a film is about.
void putInOrder(std::vector<Drawn>& parts, int dimension) {
  if (dimension == 2) {
    std::stable_partition(parts.begin(), parts.end(), [](const Drawn& d) { return !d.moves; });
    return;
  }
  std::vector<SeenPart> seen;
  for (Drawn& d : parts) seen.push_back(std::move(d.seen));
  const DepthOrder order = depthOrder(seen);
  std::vector<bool> glass(parts.size(), false);
  for (const auto& [back, front] : order.covered) {
    if (parts[back].moves && !parts[front].moves) glass[front] = true;
  }
  std::vector<Drawn> sorted;
  for (const std::size_t i : order.backToFront) {
    if (glass[i]) parts[i].patches = ofGlass(parts[i].patches);
    sorted.push_back(std::move(parts[i]));
  }
  parts = std::move(sorted);
}

double angleOf(const Rot<2>& q) { return std::abs(q.radians()); }
double angleOf(const Rot<3>& q) { return 2 * std::atan2(std::hypot(q.x, q.y, q.z), std::abs(q.w)); }

}  // namespace

template <int D>
Reel<D>::Reel(const std::string& path) try {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw UserError("cannot be read");
  m_recording = Recording<D>::read(in);
  if (m_recording.frames.empty()) throw UserError("the recording has no frame");
  for (const auto& frame : m_recording.frames) {
    for (const auto& arrival : frame.arrivals) {
      Actor& actor = m_cast[{arrival.slot, arrival.generation}];
      actor.type = arrival.type;
      for (const auto& part : arrival.parts) actor.parts.push_back({shapeOf<D>(part), part.X_CS});
    }
  }
} catch (const UserError& e) {
  throw UserError(path + ": " + e.what());
}

template <int D>
Sight Reel<D>::sightOf(const typename Recording<D>::Frame& frame, bool fixedOnes) const {
  const Camera<D> camera;
  Sight out;
  for (const auto& body : frame.bodies) {
    const auto actor = m_cast.find({body.slot, body.generation});
    if (actor == m_cast.end() || (actor->second.type == BodyType::fixed) != fixedOnes || !finite(body.X_WC)) continue;
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
Sight Reel<D>::sight(double follow) const {
  Sight first, all;
  for (const auto& frame : frames()) {
    const Sight box = sightOf(frame, false);
    if (first.empty()) first = box;
    all.take(box.lo, box.hi);
  }
  if (all.empty()) first = all = sightOf(frames()[0], true);
  if (all.empty()) all.take({-1, -1}, {1, 1}), first = all;
  const Vec<2> limit = Vec<2>::Constant(std::max(follow, (first.hi - first.lo).maxCoeff()));
  return {all.lo.cwiseMax(first.lo - limit), all.hi.cwiseMin(first.hi + limit)};
}

template <int D>
Camera<D> cameraOf(const Sight& sight, double width) {
  Camera<D> camera;
  const Vec<2> margin = Vec<2>::Constant(0.06 * (sight.hi - sight.lo).maxCoeff());
  const Vec<2> size = sight.hi - sight.lo + 2 * margin;
  camera.middle = (sight.lo + sight.hi) / 2;
  camera.width = width;
  camera.height = std::clamp(width * size[1] / size[0], 0.4 * width, 1.2 * width);
  camera.scale = std::min(camera.width / size[0], camera.height / size[1]);
  camera.height += camera.kBand;
  return camera;
}

template <int D>
Picture Reel<D>::picture(std::size_t index, const Camera<D>& camera) const {
  std::vector<Patch> planes;  // behind all: one that stands in front would hide them
  std::vector<Drawn> parts;
  for (const auto& body : frames()[index].bodies) {
    const auto actor = m_cast.find({body.slot, body.generation});
    if (actor == m_cast.end() || !finite(body.X_WC)) continue;
    const bool moves = actor->second.type != BodyType::fixed;
    const Colour fill =
        moves ? kColours[static_cast<std::size_t>(body.slot) % kColours.size()] * (body.awake ? 1 : 1.15) : kFixed;
    const Colour edge = moves ? fill * 0.55 : kFixedEdge;
    for (const ShapePart<D>& part : actor->second.parts) {
      const Pose<D> X_WS = body.X_WC * part.X_SP;
      if (part.shape.isPlane()) {
        planes.push_back({planePatch(X_WS, camera), fill, edge});
      } else {
        parts.push_back({moves, {}, patchesOf(part.shape.view(), X_WS, camera, fill, edge)});
        if constexpr (D == 3) {
          parts.back().seen = {outlineOf(part.shape.view(), X_WS, camera), nearnessOf(part.shape.view(), X_WS, camera)};
        }
      }
    }
  }
  putInOrder(parts, D);
  Picture out{camera.width, camera.height, std::move(planes), {}};
  for (Drawn& d : parts) {
    for (Patch& p : d.patches) out.patches.push_back(std::move(p));
  }
  char text[64];
  std::snprintf(text, sizeof text, "step %lld, %.2f s", static_cast<long long>(frames()[index].step),
                frames()[index].time);
  out.labels.push_back({{6, 16}, text});
  return out;
}

template <int D>
std::optional<Parting> partingOf(const Reel<D>& a, const Reel<D>& b, double tolerance) {
  const std::size_t count = std::min(a.frames().size(), b.frames().size());
  for (std::size_t i = 0; i < count; ++i) {
    const auto &ours = a.frames()[i].bodies, &theirs = b.frames()[i].bodies;
    const auto step = a.frames()[i].step;
    if (ours.size() != theirs.size()) {
      return Parting{i, step,
                     "one has " + std::to_string(ours.size()) + " bodies, the other " + std::to_string(theirs.size())};
    }
    for (std::size_t k = 0; k < ours.size(); ++k) {
      const std::string who = "body " + std::to_string(std::min(ours[k].slot, theirs[k].slot));
      if (ours[k].slot != theirs[k].slot) return Parting{i, step, who + " is in one alone"};
      if (ours[k].generation != theirs[k].generation) return Parting{i, step, who + " is another one in each"};
      const double way = (ours[k].X_WC.p - theirs[k].X_WC.p).norm();
      const double turn = angleOf(ours[k].X_WC.q.inverse() * theirs[k].X_WC.q);
      char text[80];
      // Written so that NaN is apart.
      if (!(way <= tolerance)) {
        std::snprintf(text, sizeof text, " is %.3g m apart", way);
        return Parting{i, step, who + text};
      }
      if (!(turn <= tolerance)) {
        std::snprintf(text, sizeof text, " is turned by %.3g rad", turn);
        return Parting{i, step, who + text};
      }
    }
  }
  if (a.frames().size() == b.frames().size()) return std::nullopt;
  return Parting{count - 1, a.frames()[count - 1].step, "one goes on, the other ends"};
}

template Camera<2> cameraOf(const Sight&, double);
template Camera<3> cameraOf(const Sight&, double);
template class Reel<2>;
template class Reel<3>;
template std::optional<Parting> partingOf(const Reel<2>&, const Reel<2>&, double);
template std::optional<Parting> partingOf(const Reel<3>&, const Reel<3>&, double);

}  // namespace lpc::inline LPC_PRECISION
