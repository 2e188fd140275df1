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
void drawOne(Flock<D>& flock, Random& random, double side, double part) {
  Vec<D> p, v;
  for (int d = 0; d < D; ++d) {
    p[d] = static_cast<Real>(random.uniform(-1, 1) * side / 2 * part);
    v[d] = static_cast<Real>(random.uniform(-10, 10));
  }
  flock.place.push_back(p), flock.velocity.push_back(v);
}

template <int D>
Flock<D> everywhere(int n, double side, Random& random) {
  Flock<D> flock;
  flock.room = static_cast<Real>(side / 2);
  drawCenters<D>(random, side);
  for (int i = 0; i < n; ++i) drawOne(flock, random, side, 1);
  flock.half.assign(static_cast<std::size_t>(n), static_cast<Real>(kHalf));
  return flock;
}

struct Uniform {
  static constexpr const char* kName = "uniform";
  static constexpr const char* kMeaning = "unit boxes anywhere, as dense for every n: overlaps grow with n";
  void visit(ParamVisitor&) {}
  template <int D>
  Flock<D> make(int n, Random& random) const {
    return everywhere<D>(n, sideFor<D>(n), random);
  }
};

struct Cluster {
  static constexpr const char* kName = "cluster";
  static constexpr const char* kMeaning =
      "nine of ten boxes, of many sizes, around few centres: no one cell size serves";
  int spread = 10;
  void visit(ParamVisitor& v) { v.integer("spread", spread, 1, 100, "side of a cluster, in hundredths of the room's"); }
  template <int D>
  Flock<D> make(int n, Random& random) const {
    Flock<D> flock;
    const double side = sideFor<D>(n);
    flock.room = static_cast<Real>(side / 2);
    const std::vector<Vec<D>> centers = drawCenters<D>(random, side);
    for (int i = 0; i < n; ++i) {
      const bool clustered = i % 10 != 0;
      drawOne(flock, random, side, clustered ? spread / 100.0 : 1.0);
      if (clustered) {
        flock.place.back() += centers[random.below(centers.size())];
        flock.velocity.back() = Vec<D>(flock.velocity.back() / 10);
      }
      flock.half.push_back(static_cast<Real>(kHalf * random.uniform(0.2, 2)));
    }
    return flock;
  }
};

struct Director2 {
  static constexpr const char* kName = "director_2";
  static constexpr const char* kMeaning = "the room of the 2009 script, which stays as large while boxes come";
  Real side = 80;
  void visit(ParamVisitor& v) { v.real("side", side, 1, Real(1e6), "m", "of the room"); }
  template <int D>
  Flock<D> make(int n, Random& random) const {
    return everywhere<D>(n, static_cast<double>(side), random);
  }
};

// Below: layouts that are each the worst case of one kind of method.

struct CentreLine {
  static constexpr const char* kName = "centre_line";
  static constexpr const char* kMeaning =
      "every box lies across x = 0, the border on which trees of regions divide first";
  void visit(ParamVisitor&) {}
  template <int D>
  Flock<D> make(int n, Random& random) const {
    // The rest of the room, sized so that a box overlaps about one other.
    Flock<D> flock = everywhere<D>(n, D == 2 ? 2.0 * n : std::sqrt(4.0 * n), random);
    for (std::size_t i = 0; i < flock.place.size(); ++i) {
      flock.place[i][0] = static_cast<Real>(random.uniform(-0.8, 0.8) * kHalf);
      flock.velocity[i][0] = 0;
    }
    return flock;
  }
};

struct Towers {
  static constexpr const char* kName = "towers";
  static constexpr const char* kMeaning =
      "two towers so far apart that centres vary most along x, where all boxes of a tower overlap: against sweeps";
  void visit(ParamVisitor&) {}
  template <int D>
  Flock<D> make(int n, Random& random) const {
    Flock<D> flock = everywhere<D>(n, n, random);
    for (std::size_t i = 0; i < flock.place.size(); ++i) {
      for (int d = 0; d < D; ++d) {
        if (d == 1) continue;
        flock.place[i][d] = static_cast<Real>(random.uniform(-0.4, 0.4) * kHalf);
        flock.velocity[i][d] = 0;
      }
      flock.place[i][0] += static_cast<Real>(i % 2 ? n : -n);
    }
    return flock;
  }
};

struct HugeGround {
  static constexpr const char* kName = "huge_ground";
  static constexpr const char* kMeaning = "uniform, and one box as large as the room: against cells of one size";
  void visit(ParamVisitor&) {}
  template <int D>
  Flock<D> make(int n, Random& random) const {
    Flock<D> flock = everywhere<D>(n, sideFor<D>(n), random);
    flock.place[0] = flock.velocity[0] = Vec<D>::Zero();
    flock.half[0] = flock.room;
    return flock;
  }
};

struct Outlier {
  static constexpr const char* kName = "outlier";
  static constexpr const char* kMeaning = "uniform, and one box that got lost: against what spans all that there is";
  int rooms = 1000;
  void visit(ParamVisitor& v) { v.integer("rooms", rooms, 1, 1000000, "how far the box is, in sides of the room"); }
  template <int D>
  Flock<D> make(int n, Random& random) const {
    const double side = sideFor<D>(n);
    Flock<D> flock = everywhere<D>(n, side, random);
    flock.place[0] = Vec<D>::Constant(static_cast<Real>(rooms * side));
    flock.velocity[0] = Vec<D>::Zero();
    return flock;
  }
};

struct BatchSpawn {
  static constexpr const char* kName = "batch_spawn";
  static constexpr const char* kMeaning = "all boxes come at once into a quarter of the room's side and fly apart";
  void visit(ParamVisitor&) {}
  template <int D>
  Flock<D> make(int n, Random& random) const {
    Flock<D> flock = everywhere<D>(n, sideFor<D>(n), random);
    for (Vec<D>& p : flock.place) p /= 4;
    return flock;
  }
};

template <class E, int D>
Flock<D> make(const Spec& spec, int n, std::uint64_t seed) {
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
