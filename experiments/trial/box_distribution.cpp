// SPDX-License-Identifier: Zlib
#include "experiments/trial/box_distribution.h"

#include "framework/math/random.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

constexpr double kHalf = 0.5;  // half side of a box (m)

// Side of a room in which each of n unit boxes overlaps about one other: 2^D * n / side^D.
template <int D>
double sideFor(int n) {
  const double volume = static_cast<double>(n) * (D == 2 ? 4 : 8);
  if (D == 2) return std::sqrt(volume);
  double side = 1;
  while (side * side * side < volume) side *= 1.01;
  return side;
}

// Always drawn, also if unused: stored results depend on the random numbers that follow.
template <int D>
std::vector<Vec<D>> drawCenters(Random& random, double side) {
  std::vector<Vec<D>> centers(8);
  for (Vec<D>& c : centers) {
    for (int d = 0; d < D; ++d) c[d] = static_cast<Real>(random.uniform(-0.8, 0.8) * side / 2);
  }
  return centers;
}

// A position within `part` of a room of that side, and a velocity.
template <int D>
void drawOne(MovingBoxes<D>& boxes, Random& random, double side, double part) {
  Vec<D> p, v;
  for (int d = 0; d < D; ++d) {
    p[d] = static_cast<Real>(random.uniform(-1, 1) * side / 2 * part);
    v[d] = static_cast<Real>(random.uniform(-10, 10));
  }
  boxes.place.push_back(p), boxes.velocity.push_back(v);
}

template <int D>
MovingBoxes<D> everywhere(int n, double side, Random& random) {
  MovingBoxes<D> boxes;
  boxes.room = static_cast<Real>(side / 2);
  drawCenters<D>(random, side);
  for (int i = 0; i < n; ++i) drawOne(boxes, random, side, 1);
  boxes.half.assign(static_cast<std::size_t>(n), static_cast<Real>(kHalf));
  return boxes;
}

struct Uniform {
  static constexpr const char* kName = "uniform";
  static constexpr const char* kMeaning =
      "unit boxes placed uniformly, with equal density for every n: overlaps grow with n";
  void visit(ParamVisitor&) {}
  template <int D>
  MovingBoxes<D> make(int n, Random& random) const {
    return everywhere<D>(n, sideFor<D>(n), random);
  }
};

struct Cluster {
  static constexpr const char* kName = "cluster";
  static constexpr const char* kMeaning =
      "boxes of many sizes, nine of ten of them in clusters, so that no single cell size suits";
  int spread = 10;
  void visit(ParamVisitor& v) {
    v.integer("spread", spread, 1, 100, "side of a cluster, in hundredths of the room's side");
  }
  template <int D>
  MovingBoxes<D> make(int n, Random& random) const {
    MovingBoxes<D> boxes;
    const double side = sideFor<D>(n);
    boxes.room = static_cast<Real>(side / 2);
    const std::vector<Vec<D>> centers = drawCenters<D>(random, side);
    for (int i = 0; i < n; ++i) {
      const bool clustered = i % 10 != 0;
      drawOne(boxes, random, side, clustered ? spread / 100.0 : 1.0);
      if (clustered) {
        boxes.place.back() += centers[random.below(centers.size())];
        boxes.velocity.back() = Vec<D>(boxes.velocity.back() / 10);
      }
      boxes.half.push_back(static_cast<Real>(kHalf * random.uniform(0.2, 2)));
    }
    return boxes;
  }
};

struct Director2 {
  static constexpr const char* kName = "director_2";
  static constexpr const char* kMeaning = "room of fixed size that fills with boxes (director script 2 of 2009)";
  Real side = 80;
  void visit(ParamVisitor& v) { v.real("side", side, 1, Real(1e6), "m", "side of the room"); }
  template <int D>
  MovingBoxes<D> make(int n, Random& random) const {
    return everywhere<D>(n, static_cast<double>(side), random);
  }
};

// Below: layouts that are each the worst case of one kind of method.

struct CentreLine {
  static constexpr const char* kName = "centre_line";
  static constexpr const char* kMeaning = "every box crosses x = 0, the first dividing plane of region trees";
  void visit(ParamVisitor&) {}
  template <int D>
  MovingBoxes<D> make(int n, Random& random) const {
    // The rest of the room, sized so that a box overlaps about one other.
    MovingBoxes<D> boxes = everywhere<D>(n, D == 2 ? 2.0 * n : std::sqrt(4.0 * n), random);
    for (std::size_t i = 0; i < boxes.place.size(); ++i) {
      boxes.place[i][0] = static_cast<Real>(random.uniform(-0.8, 0.8) * kHalf);
      boxes.velocity[i][0] = 0;
    }
    return boxes;
  }
};

struct Towers {
  static constexpr const char* kName = "towers";
  static constexpr const char* kMeaning =
      "two distant towers: centres vary most along x, where all boxes of a tower overlap; worst case for sweeps";
  void visit(ParamVisitor&) {}
  template <int D>
  MovingBoxes<D> make(int n, Random& random) const {
    MovingBoxes<D> boxes = everywhere<D>(n, n, random);
    for (std::size_t i = 0; i < boxes.place.size(); ++i) {
      for (int d = 0; d < D; ++d) {
        if (d == 1) continue;
        boxes.place[i][d] = static_cast<Real>(random.uniform(-0.4, 0.4) * kHalf);
        boxes.velocity[i][d] = 0;
      }
      boxes.place[i][0] += static_cast<Real>(i % 2 ? n : -n);
    }
    return boxes;
  }
};

struct HugeGround {
  static constexpr const char* kName = "huge_ground";
  static constexpr const char* kMeaning = "uniform, plus one box as large as the room; worst case for uniform cells";
  void visit(ParamVisitor&) {}
  template <int D>
  MovingBoxes<D> make(int n, Random& random) const {
    MovingBoxes<D> boxes = everywhere<D>(n, sideFor<D>(n), random);
    boxes.place[0] = boxes.velocity[0] = Vec<D>::Zero();
    boxes.half[0] = boxes.room;
    return boxes;
  }
};

struct Outlier {
  static constexpr const char* kName = "outlier";
  static constexpr const char* kMeaning =
      "uniform, plus one very distant box; worst case for structures that span all boxes";
  int rooms = 1000;
  void visit(ParamVisitor& v) { v.integer("rooms", rooms, 1, 1000000, "distance of that box, in sides of the room"); }
  template <int D>
  MovingBoxes<D> make(int n, Random& random) const {
    const double side = sideFor<D>(n);
    MovingBoxes<D> boxes = everywhere<D>(n, side, random);
    boxes.place[0] = Vec<D>::Constant(static_cast<Real>(rooms * side));
    boxes.velocity[0] = Vec<D>::Zero();
    return boxes;
  }
};

struct BatchSpawn {
  static constexpr const char* kName = "batch_spawn";
  static constexpr const char* kMeaning =
      "all boxes appear in one step within a quarter of the room's side and fly apart";
  void visit(ParamVisitor&) {}
  template <int D>
  MovingBoxes<D> make(int n, Random& random) const {
    MovingBoxes<D> boxes = everywhere<D>(n, sideFor<D>(n), random);
    for (Vec<D>& p : boxes.place) p /= 4;
    return boxes;
  }
};

template <class E, int D>
MovingBoxes<D> make(const Spec& spec, int n, std::uint64_t seed) {
  Random random(seed);
  return readEntry<E>(spec).template make<D>(n, random);
}
template <class E>
BoxDistribution distributionEntry() {
  return {entryInfo<E>(), make<E, 2>, make<E, 3>};
}

}  // namespace

const std::vector<BoxDistribution>& boxDistributions() {
  static const std::vector<BoxDistribution> all = {distributionEntry<Uniform>(),   distributionEntry<Cluster>(),
                                                   distributionEntry<Director2>(), distributionEntry<CentreLine>(),
                                                   distributionEntry<Towers>(),    distributionEntry<HugeGround>(),
                                                   distributionEntry<Outlier>(),   distributionEntry<BatchSpawn>()};
  return all;
}

}}  // namespace lpc::LPC_PRECISION
