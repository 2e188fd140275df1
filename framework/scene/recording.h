// SPDX-License-Identifier: Zlib
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "framework/world/links.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Poses over time, for viewing a run afterwards. Numbers are stored as double in both precisions.
template <int D>
struct Recording {
  struct Body {
    std::int32_t slot = 0;
    std::uint32_t generation = 0;
    std::uint8_t awake = 1;
    Pose<D> X_WC{};  // of the centre-of-mass frame
  };
  /// The convex parts of a body's shapes. They are stored once, in the frame of the recording in which the body first
  /// appears.
  struct NewBody {
    std::int32_t slot = 0;
    std::uint32_t generation = 0;
    BodyType type = BodyType::dynamic;
    struct Part {
      ShapeKind kind = ShapeKind::sphere;
      Real radius = 0;
      Vec<D> half = Vec<D>::Zero();
      Pose<D> X_CS{};
      std::vector<Vec<D>> vertices;  // polytope only
    };
    std::vector<Part> parts;
  };
  struct Frame {
    std::int64_t step = 0;
    double time = 0;  // s
    std::vector<NewBody> newBodies;
    std::vector<Body> bodies;  // all bodies in the world, by slot
    std::vector<Link<D>> links;
  };
  std::string title;  // printable ASCII
  std::vector<Frame> frames;
  bool torn = false;  // the bytes ended within a frame, which is dropped

  /// Reads a recording, also of the first format, which has neither title nor links. Throws UserError when the bytes
  /// are not a recording of this dimension.
  static Recording read(std::istream& in);
};

/// Returns 2 or 3 and leaves the stream position unchanged. Throws UserError when the bytes are not a recording.
int recordingDimension(std::istream& in);

template <int D>
class Recorder {
 public:
  /// Writes the header, with a title of printable ASCII. The stream must outlive the recorder.
  explicit Recorder(std::ostream& out, const std::string& title = {});
  /// Appends the current state.
  void frame(const Simulation<D>& world);

 private:
  std::ostream& m_out;
  std::vector<std::uint64_t> m_known;  // generation + 1 by slot; 0 = never written
};

}}  // namespace lpc::LPC_PRECISION
