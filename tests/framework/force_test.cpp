// SPDX-License-Identifier: Zlib
// Inertia, which moves bodies besides contacts. tests/conformance/force_kinds_test.cpp tests forces.
#include <gtest/gtest.h>

#include "tests/check_property.h"
#include "tests/draw.h"
#include "tests/planted_bugs/force_bugs.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace force_test { namespace {

// The angular momentum of a rotated body is the rotated angular momentum.
void turnsWithItsBody(Inertia<3> (*turned)(const Rot<3>&, const Inertia<3>&)) {
  RapidCheckDraw draw;
  Inertia<3> inertia = Inertia<3>::Zero();
  for (int k = 0; k < 3; ++k) inertia(k, k) = draw.real(0.5, 2);
  inertia = rotateInertia(drawRotation<3>(draw), inertia);  // not always diagonal
  const Rot<3> q = drawRotation<3>(draw);
  const Ang<3> w = drawVector<3>(draw);
  const Ang<3> error = turned(q, inertia) * (q * w) - q * Ang<3>(inertia * w);
  RC_ASSERT(error.norm() <= 64 * kEps);
}

TEST(Inertia, TurnsWithItsBody) {
  check("inertia turns with its body", [] { turnsWithItsBody(rotateInertia); });
  expectFalsified(
      "inertia turned back", [] { turnsWithItsBody(inertiaTurnedBack); }, 100);
  expectFalsified(
      "inertia not turned", [] { turnsWithItsBody(inertiaNotTurned); }, 100);
}

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::force_test
