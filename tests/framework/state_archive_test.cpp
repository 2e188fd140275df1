// SPDX-License-Identifier: Zlib
// The bytes of a saved state, without a world. damaged_save_test.cpp tests which bytes a world rejects.
#include "framework/world/joint_table.h"
#include "framework/world/saved_state.h"
#include "tests/world_parts.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace state_archive_test { namespace {

template <class T>
struct StateArchiveTest : testing::Test {};
TYPED_TEST_SUITE(StateArchiveTest, BothDimensions);

template <int D>
SavedState<D> someState() {
  Inhabitants<D> in;
  JointTable<D> joints;
  in.ball(at<D>(0, 0)), in.ball(at<D>(3, 0)), in.ball(at<D>(6, 0));
  joints.add(pivot<D>({}, in.handle(1), at<D>(1, 0)), in.table);
  in.table.remove(0);
  in.table.touch(2);
  in.table.userForces[1].force = at<D>(1, 2);
  SavedState<D> s;
  s.settings = in.settings, s.settings.margin = Real(0.25);
  s.bodies = in.table.bodies, s.shapes = in.table.shapes, s.userForces = in.table.userForces;
  s.events = in.table.events, s.joints = joints.records;
  s.manifolds.resize(1), s.records.resize(2), s.forces.resize(1);
  s.manifolds[0].normal = at<D>(0, 1), s.records[1].partA = 5;
  s.time = Real(1.5), s.lastDt = Real(0.5), s.sinceContacts = Real(0.125), s.steps = 3;
  return s;
}

template <int D>
std::string bytesOf(const SavedState<D>& s) {
  std::ostringstream out;
  writeState<D>(out, s);
  return out.str();
}
template <int D>
SavedState<D> readFrom(const std::string& bytes) {
  std::istringstream in(bytes);
  return readState<D>(in);
}

TYPED_TEST(StateArchiveTest, BytesRoundTrip) {
  constexpr int D = TypeParam::D;
  const SavedState<D> s = someState<D>();
  const std::string bytes = bytesOf(s);
  const SavedState<D> is = readFrom<D>(bytes);
  EXPECT_EQ(bytesOf(is), bytes);
  EXPECT_EQ(is.settings.margin, s.settings.margin);
  EXPECT_EQ(is.bodies.generation, s.bodies.generation);
  EXPECT_EQ(is.bodies.pose[2].p, s.bodies.pose[2].p);
  EXPECT_EQ(is.userForces[1].force, s.userForces[1].force);
  EXPECT_TRUE(is.shapes[1].shape.same(s.shapes[1].shape));
  EXPECT_EQ(is.joints[0].spec, s.joints[0].spec);
  EXPECT_TRUE(is.joints[0].kind);
  EXPECT_FALSE(is.forces[0].kind);
  EXPECT_EQ(is.manifolds[0].normal, s.manifolds[0].normal);
  EXPECT_EQ(is.records[1].partA, 5);
  EXPECT_EQ(is.events.size(), s.events.size());
  EXPECT_EQ(is.steps, 3);
  std::istringstream in(bytes);
  EXPECT_EQ(savedKind(in).dimension, D);
}

TYPED_TEST(StateArchiveTest, OtherBytesAreRefused) {
  constexpr int D = TypeParam::D;
  const std::string bytes = bytesOf(someState<D>());
  for (std::size_t i = 0; i < bytes.size(); i += 7) {
    std::string damaged = bytes;
    damaged[i] = static_cast<char>(damaged[i] ^ 0x10);
    EXPECT_NE(refusalOf([&] { readFrom<D>(damaged); }), "") << i;
  }
  EXPECT_NE(refusalOf([&] { readFrom<D>(bytes.substr(0, bytes.size() - 1)); }), "");
  EXPECT_NE(refusalOf([&] { readFrom<5 - D>(bytes); }).find("2D"), std::string::npos);
}

}}}}}  // namespace lpc::LPC_PRECISION::test::state_archive_test
