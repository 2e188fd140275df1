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
  bool empty() const { return !(lo[0] <= hi[0]); }
};

/// A camera that sees all of it, with a small border.
template <int D>
Camera<D> cameraOf(const Viewport& viewport, double width);

template <int D>
class Reel {
 public:
  /// Throws UserError, with the path, if the file is not a recording of this dimension or has no frame.
  explicit Reel(const std::string& path);

  const std::vector<typename Recording<D>::Frame>& frames() const { return m_recording.frames; }
  bool torn() const { return m_recording.torn; }
  /// The region in which most moving bodies ever are. A body that flies off does not shrink the others to dots: no body
  /// is followed farther than the size of the first picture, or `follow` (m). If nothing moves, the region of the fixed
  /// bodies.
  Viewport viewport(double follow = 10) const;
  /// One frame, with its time.
  Picture picture(std::size_t frame, const Camera<D>& camera) const;

 private:
  struct Actor {
    BodyType type = BodyType::dynamic;
    std::vector<ShapePart<D>> parts;  // in the centre-of-mass frame
  };
  using Key = std::pair<std::int32_t, std::uint32_t>;  // slot, generation

  /// Without planes, which are unbounded.
  Viewport viewportOf(const typename Recording<D>::Frame& frame, bool fixedOnes) const;

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
