// SPDX-License-Identifier: Zlib
// A recording with the shapes of its bodies, and its frames as pictures.
#pragma once

#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "experiments/film/camera.h"
#include "experiments/film/picture.h"
#include "framework/scene/recording.h"
#include "framework/shape/shape.h"

namespace lpc { inline namespace LPC_PRECISION {

/// A rectangle of the image plane (m).
struct Viewport {
  Vec<2> lo = Vec<2>::Constant(std::numeric_limits<double>::infinity());
  Vec<2> hi = Vec<2>::Constant(-std::numeric_limits<double>::infinity());

  void take(const Vec<2>& lower, const Vec<2>& upper) { lo = lo.cwiseMin(lower), hi = hi.cwiseMax(upper); }
  void take(const Viewport& other) { take(other.lo, other.hi); }
  Vec<2> middle() const { return (lo + hi) / 2; }
  Vec<2> size() const { return hi - lo; }
  bool empty() const { return !(lo[0] <= hi[0]); }
};

/// A camera that sees all of it, with a small border.
template <int D>
Camera<D> cameraOf(const Viewport& viewport, double width);

/// One camera per frame, all of one scale and size, for the views of a film (Reel::views). They are equal unless the
/// way of the bodies is much longer than the largest view: then they follow the views.
template <int D>
std::vector<Camera<D>> camerasOf(const std::vector<Viewport>& views, double width);

template <int D>
class Reel {
 public:
  /// Throws UserError, with the path, if the file is not a recording of this dimension or has no frame.
  explicit Reel(const std::string& path);

  const std::vector<typename Recording<D>::Frame>& frames() const { return m_recording.frames; }
  bool torn() const { return m_recording.torn; }
  /// The region that each frame should show: moving bodies with their links, and the ground below their first
  /// positions. A body that flies off does not shrink the others to dots: none is followed farther from the median body
  /// than the size of the scene at the start, or `follow` (m). If nothing moves, the region of the static bodies.
  std::vector<Viewport> views(double follow = 10) const;
  /// One frame, with its step, its time and the recording's title.
  Picture picture(std::size_t frame, const Camera<D>& camera) const;

 private:
  struct Actor {
    BodyType type = BodyType::dynamic;
    std::vector<ShapePart<D>> parts;  // in the centre-of-mass frame
  };
  using Key = std::pair<std::int32_t, std::uint32_t>;  // slot, generation

  using Frame = typename Recording<D>::Frame;
  const Actor* actorOf(const typename Recording<D>::Body& body) const;
  /// Of a body at a finite pose, without planes, which are unbounded; empty if it is too far to be drawn.
  static Viewport boxOf(const Actor& actor, const Pose<D>& X_WC);
  /// The first boxes of all moving bodies, with the ground at most `reach` (m) below them.
  Viewport startOf(double reach) const;

  Recording<D> m_recording;
  std::map<Key, Actor> m_cast;
};

/// The point at which two runs diverge.
struct Divergence {
  std::size_t frame = 0;
  std::int64_t step = 0;
  std::string how;  // "body 3 is 0.0012 m apart"
};
/// The first frame in which a body is farther from its counterpart (slot and generation) than `tolerance` (m, and rad
/// of rotation), or has none.
template <int D>
std::optional<Divergence> divergenceOf(const Reel<D>& a, const Reel<D>& b, double tolerance);

}}  // namespace lpc::LPC_PRECISION
