// SPDX-License-Identifier: Zlib
// Pairs of convex parts with near boxes, step by step: the input of a pair query in a world. docs/problems.md describes
// the file format.
#pragma once

#include <compare>
#include <iosfwd>
#include <map>
#include <string>
#include <vector>

#include "framework/stage/stage_narrowphase.h"
#include "framework/world/simulation.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Identifies a convex part across steps: the next body in a slot is a different one.
struct PartOfBody {
  std::int32_t body = 0;  // slot
  std::uint32_t generation = 0;
  std::int32_t shape = 0, part = 0;  // number among the body's shapes; among the shape's parts
  auto operator<=>(const PartOfBody&) const = default;
};

template <int D>
struct PairStream {
  /// Kind of a <= kind of b, the order of queries.
  struct Pair {
    PartOfBody a, b;
    std::uint32_t shapeA = 0, shapeB = 0;  // indices into `shapes`
  };
  struct PairPose {
    std::uint32_t pair = 0;  // index into `pairs`, the same in every step
    Pose<D> X_AB{};
  };
  struct Step {
    long step = 0;              // of the poses at the start of the step
    std::size_t pairPoses = 0;  // number of entries of this step; pairs ascend
  };

  std::string scene;
  double dt = 0, margin = 0;     // s; m: boxes nearer than this are near
  std::vector<Shape<D>> shapes;  // convex, each once
  std::vector<Pair> pairs;       // in order of first appearance
  std::vector<Step> steps;       // ascending
  std::vector<PairPose> pairPoses;

  PairView<D> view(const PairPose& m) const {
    const Pair& p = pairs[m.pair];
    return {shapes[p.shapeA].view(), shapes[p.shapeB].view(), m.X_AB};
  }
};

/// Fills a stream from a running simulation of any engine: it makes the boxes anew and queries a broadphase of its own.
template <int D>
class PairCollector {
 public:
  PairCollector(std::string scene, Real dt, Real margin);

  /// Appends the pairs that the coming step will query. Omits pairs of bodies that both sleep or do not move, and pairs
  /// with collision disabled by a joint. Returns false and appends nothing if the stream would exceed `most` entries.
  bool see(const Simulation<D>& simulation, long step, std::size_t most);
  const PairStream<D>& stream() const { return m_stream; }

 private:
  std::uint32_t shapeNumber(const Shape<D>& shape);

  PairStream<D> m_stream;
  std::map<std::vector<double>, std::uint32_t> m_shapeNumbers;  // by kind, sizes and points
  std::map<std::pair<PartOfBody, PartOfBody>, std::uint32_t> m_pairNumbers;
};

template <int D>
void writePairs(std::ostream& out, const PairStream<D>& stream);

/// The content of a file, in its dimension.
struct PairStreamFile {
  int dimension = 2;
  PairStream<2> in2;
  PairStream<3> in3;

  template <int D>
  const PairStream<D>& of() const {
    if constexpr (D == 2) {
      return in2;
    } else {
      return in3;
    }
  }
  /// Both throw UserError that says what is wrong.
  static PairStreamFile load(const std::string& path);
  static PairStreamFile parse(const std::string& bytes, const std::string& path);
};

}}  // namespace lpc::LPC_PRECISION
