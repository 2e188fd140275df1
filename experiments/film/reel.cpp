// SPDX-License-Identifier: Zlib
#include "experiments/film/reel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <limits>

#include "framework/check.h"
#include "framework/curved_core.h"
#include "framework/support_map.h"

namespace lpc::inline LPC_PRECISION {
namespace {

constexpr double kFarthest = 1e100;  // m: of what is larger or farther no picture has a size
constexpr double kPi = 3.14159265358979323846;
constexpr Colour kFixed{205, 205, 200}, kFixedEdge{120, 120, 115};
// Bodies take turns, so that neighbours are told apart.
constexpr std::array<Colour, 6> kColours = {
    {{102, 153, 204}, {238, 170, 85}, {119, 178, 119}, {204, 119, 136}, {160, 140, 200}, {190, 180, 100}}};

unsigned char shaded(unsigned char c, double light) {
  return static_cast<unsigned char>(std::clamp(std::lround(c * light), 0L, 255L));
}
Colour operator*(const Colour& c, double light) {
  return {shaded(c.red, light), shaded(c.green, light), shaded(c.blue, light)};
}

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

// The outline that the camera sees: what lies farthest in each direction of its plane.
template <int D>
std::vector<Vec<2>> outline(const ShapeView<D>& shape, const Pose<D>& X_WS, const Camera<D>& camera) {
  constexpr int kDirections = 48;
  std::vector<Vec<2>> corners;
  for (int i = 0; i < kDirections; ++i) {
    const double angle = 2 * kPi * (i + 0.37) / kDirections;  // along no axis, where two corners of a box tie
    const Vec<D> d_W = std::cos(angle) * camera.right + std::sin(angle) * camera.up;
    const Vec<2> at = camera.pixel(X_WS * coreSupport(shape, X_WS.q.inverse() * d_W) + shape.radius * d_W);
    if (corners.empty() || (corners.back() - at).norm() > 0.01) corners.push_back(at);
  }
  return corners;
}

// What of a plane is near the middle of the view.
template <int D>
std::vector<Vec<2>> planePatch(const Pose<D>& X_WS, const Camera<D>& camera) {
  const double reach = 2 * (camera.width + camera.height) / camera.scale;
  const Vec<D> middle_W = camera.middle[0] * camera.right + camera.middle[1] * camera.up;
  Vec<D> origin = X_WS.inverse() * middle_W;
  origin[1] = 0;
  std::vector<Vec<2>> corners;
  for (const auto& [x, other] : {std::pair(-1, 0), std::pair(1, 0), std::pair(1, 1), std::pair(-1, 1)}) {
    Vec<D> p = origin;
    p[0] += x * reach;
    if constexpr (D == 2) {
      p[1] -= other * reach;
    } else {
      p[2] += (other ? -1 : 1) * reach;
    }
    corners.push_back(camera.pixel(X_WS * p));
  }
  return corners;
}

void drawFaces(const ShapeView<2>& shape, const Pose<2>& X_WS, const Camera<2>& camera, const Colour&,
               const Colour& edge, std::vector<Patch>& out) {
  if (shape.core() != CoreClass::point) return;
  out.push_back(
      {{camera.pixel(X_WS.p), camera.pixel(X_WS * Vec<2>(shape.radius, 0))}, edge, edge});  // how it is turned
}

// The flat faces that look at the viewer, the brighter the more they look up.
void drawFaces(const ShapeView<3>& shape, const Pose<3>& X_WS, const Camera<3>& camera, const Colour& fill,
               const Colour& edge, std::vector<Patch>& out) {
  const auto face = [&](const Vec<3>& normal_S, const std::vector<Vec<3>>& corners_S) {
    const Vec<3> normal_W = X_WS.q * normal_S;
    if (normal_W.dot(camera.towards) <= 1e-9) return;
    Patch patch{{}, fill * (0.8 + 0.2 * normal_W[1] + 0.08 * normal_W[0]), edge};
    for (const Vec<3>& p : corners_S) patch.corners.push_back(camera.pixel(X_WS * (p + shape.radius * normal_S)));
    out.push_back(std::move(patch));
  };
  if (shape.core() == CoreClass::hull) {
    for (const auto& f : shape.hull->faces) {
      std::vector<Vec<3>> corners;
      for (int i = f.begin; i < f.end; ++i) {
        const int vertex = shape.hull->loop[static_cast<std::size_t>(i)];
        corners.push_back(shape.hull->vertices[static_cast<std::size_t>(vertex)]);
      }
      face(f.normal, corners);
    }
  } else if (shape.core() == CoreClass::box) {
    for (int axis = 0; axis < 3; ++axis) {
      for (const double side : {-1.0, 1.0}) {
        std::vector<Vec<3>> corners;
        for (const auto& [u, v] : {std::pair(-1, -1), std::pair(1, -1), std::pair(1, 1), std::pair(-1, 1)}) {
          Vec<3> p = side * shape.half;
          p[(axis + 1) % 3] = u * shape.half[(axis + 1) % 3], p[(axis + 2) % 3] = v * shape.half[(axis + 2) % 3];
          corners.push_back(p);
        }
        face(side * Vec<3>(Vec<3>::Unit(axis)), corners);
      }
    }
  }
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
Sight Reel<D>::sight(double follow) const {
  const Camera<D> camera;
  Sight first, all;
  for (const auto& frame : frames()) {
    Sight box;
    for (const auto& body : frame.bodies) {
      const auto actor = m_cast.find({body.slot, body.generation});
      if (actor == m_cast.end() || actor->second.type == BodyType::fixed || !finite(body.X_WC)) continue;
      for (const ShapePart<D>& part : actor->second.parts) {
        const Vec<2> at = camera.flat(body.X_WC * part.X_SP.p);
        const Vec<2> reach = Vec<2>::Constant(boundingRadius(part.shape.view()));
        if (((at.cwiseAbs() + reach).array() < kFarthest).all()) box.take(at - reach, at + reach);
      }
    }
    if (first.empty()) first = box;
    all.take(box.lo, box.hi);
  }
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
  struct Seen {
    bool moves;
    double depth;
    std::vector<Patch> patches;
  };
  std::vector<Seen> seen;
  for (const auto& body : frames()[index].bodies) {
    const auto actor = m_cast.find({body.slot, body.generation});
    if (actor == m_cast.end() || !finite(body.X_WC)) continue;
    const bool moves = actor->second.type != BodyType::fixed;
    const Colour fill =
        moves ? kColours[static_cast<std::size_t>(body.slot) % kColours.size()] * (body.awake ? 1 : 1.15) : kFixed;
    const Colour edge = moves ? fill * 0.55 : kFixedEdge;
    for (const ShapePart<D>& part : actor->second.parts) {
      const Pose<D> X_WS = body.X_WC * part.X_SP;
      Seen s{moves, X_WS.p.dot(camera.towards), {}};
      if (part.shape.isPlane()) {
        s.patches.push_back({planePatch(X_WS, camera), fill, edge});
      } else {
        s.patches.push_back({outline(part.shape.view(), X_WS, camera), fill, edge});
        drawFaces(part.shape.view(), X_WS, camera, fill, edge, s.patches);
      }
      seen.push_back(std::move(s));
    }
  }
  // From back to front by the middles, what never moves first: floors are too large to be told by their middles.
  std::stable_sort(seen.begin(), seen.end(),
                   [](const Seen& a, const Seen& b) { return a.moves != b.moves ? b.moves : a.depth < b.depth; });
  Picture out{camera.width, camera.height, {}, {}};
  for (Seen& s : seen) {
    for (Patch& p : s.patches) out.patches.push_back(std::move(p));
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
