// SPDX-License-Identifier: Zlib
// The checks of the fuzz target of pair queries accept right answers and catch wrong ones.
#include "tests/fuzz/pair_fault.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>

namespace lpc { inline namespace LPC_PRECISION { namespace pair_fault_test { namespace {

template <int D>
void wrongAnswersAreSeen() {
  const Shape<D> a = Shape<D>::box(Vec<D>::Ones()), b = Shape<D>::sphere(Real(0.5));
  Pose<D> X_AB;
  X_AB.p[0] = 2;
  const auto query = createStage<PairQuery<D>>(Spec{"gjk_epa", {}});
  const PairAnswer<D> right = queryPair(*query, a.view(), b.view(), X_AB);
  const auto told = [&](const std::function<void(PairAnswer<D>&)>& plant) -> std::string {
    PairAnswer<D> answer = right;
    plant(answer);
    const char* fault = faultOf<D>(a.view(), b.view(), X_AB, answer);
    return fault ? fault : "";
  };
  constexpr const char* kAlong = "a distance that is not the one along its normal";
  EXPECT_EQ(told([](auto&) {}), "");
  EXPECT_EQ(told([](auto& r) { r.distance = std::numeric_limits<Real>::quiet_NaN(); }), "an answer that is not finite");
  EXPECT_EQ(told([](auto& r) { r.normal[1] = std::numeric_limits<Real>::infinity(); }), "an answer that is not finite");
  EXPECT_EQ(told([](auto& r) { r.normal *= Real(1 + 1e-9); }), "a normal that has not unit length");
  EXPECT_EQ(told([](auto& r) { r.normal = -r.normal; }), kAlong);
  EXPECT_EQ(told([](auto& r) { r.distance += Real(1e-10); }), kAlong);
  EXPECT_EQ(told([](auto& r) { r.distance = -r.distance; }), kAlong);
  EXPECT_EQ(told([](auto& r) { r.distance = 9, r.status = QueryStatus::iterationLimit; }), "");
}

TEST(PairFault, WrongAnswersAreSeen2) { wrongAnswersAreSeen<2>(); }
TEST(PairFault, WrongAnswersAreSeen3) { wrongAnswersAreSeen<3>(); }

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::pair_fault_test
