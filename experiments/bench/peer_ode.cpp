// SPDX-License-Identifier: Zlib
#include <ode/collision.h>
#include <ode/odeinit.h>

#include <array>

#include "experiments/bench/pair_peers.h"

namespace lpc { inline namespace LPC_PRECISION { namespace bench { namespace {

static_assert(sizeof(dReal) == sizeof(double), "Debian's ODE is in double precision");

class OdePairs final : public PairPeer {
 public:
  explicit OdePairs(const PairData<3>& data) {
    dInitODE2(0);
    for (std::size_t k = 0; k < data.a.size(); ++k) {
      m_geoms.push_back(make(data.a[k].view(), data.X_WA[k]));
      m_geoms.push_back(make(data.b[k].view(), data.X_WB[k]));
    }
  }
  ~OdePairs() override {
    for (dGeomID geom : m_geoms) dGeomDestroy(geom);
  }
  OdePairs(const OdePairs&) = delete;
  OdePairs& operator=(const OdePairs&) = delete;

  int run() override {
    int overlaps = 0;
    std::array<dContactGeom, 8> found;
    for (std::size_t k = 0; k < m_geoms.size(); k += 2) {
      overlaps +=
          dCollide(m_geoms[k], m_geoms[k + 1], static_cast<int>(found.size()), found.data(), sizeof found[0]) > 0;
    }
    return overlaps;
  }

 private:
  static dGeomID make(const ShapeView<3>& shape, const Pose<3>& X) {
    const bool capsule = shape.kind == ShapeKind::capsule;
    const Vec<3>& half = shape.half;
    const dGeomID geom = shape.kind == ShapeKind::sphere ? dCreateSphere(nullptr, shape.radius)
                         : capsule                       ? dCreateCapsule(nullptr, shape.radius, 2 * half[0])
                                                         : dCreateBox(nullptr, 2 * half[0], 2 * half[1], 2 * half[2]);
    const Mat<3> turn = X.q.matrix();
    dMatrix3 rows = {};
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j)
        rows[4 * i + (capsule ? (j + 2) % 3 : j)] = turn(i, j);  // capsules of ODE lie along z
    }
    dGeomSetPosition(geom, X.p[0], X.p[1], X.p[2]);
    dGeomSetRotation(geom, rows);
    return geom;
  }

  std::vector<dGeomID> m_geoms;
};

const PairPeerRegistrar ode({"peer_ode",
                             {ShapeKind::sphere, ShapeKind::capsule, ShapeKind::box},
                             [](const PairData<3>& data) { return std::make_unique<OdePairs>(data); }});

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::bench
