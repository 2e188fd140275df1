// SPDX-License-Identifier: Zlib
#include "tests/draw.h"

#include <rapidcheck.h>

#include <numeric>

#include "tests/generators.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test {

int RapidCheckDraw::below(int n) { return *rc::gen::resize(rc::kNominalSize, rc::gen::inRange(0, n)); }

int growingNumber(int lo, int hi) { return *rc::gen::inRange(lo, hi); }

std::size_t drawIndex(std::size_t count) {
  std::vector<std::size_t> all(count);
  std::iota(all.begin(), all.end(), std::size_t{0});
  return *rc::gen::elementOf(all);
}

std::uint32_t drawSeed() { return *rc::gen::resize(rc::kNominalSize, rc::gen::arbitrary<std::uint32_t>()); }

DrawnValue drawValue(const std::function<DrawnValue(Draw&)>& body) {
  return *rc::gen::exec([body] {
    RapidCheckDraw draw;
    return body(draw);
  });
}

template std::vector<Vec<2>> drawPoints<2>(Draw&);
template std::vector<Vec<3>> drawPoints<3>(Draw&);
template Sketch<2> drawSketch<2>(Draw&, ShapeKind);
template Sketch<3> drawSketch<3>(Draw&, ShapeKind);
template Shape<2> drawShape<2>(Draw&);
template Shape<3> drawShape<3>(Draw&);
template Pose<2> drawPose<2>(Draw&, Real);
template Pose<3> drawPose<3>(Draw&, Real);
template ShapePairCase<2> drawShapePair<2>(Draw&);
template ShapePairCase<3> drawShapePair<3>(Draw&);
template std::ostream& operator<< <2>(std::ostream&, const ShapePairCase<2>&);
template std::ostream& operator<< <3>(std::ostream&, const ShapePairCase<3>&);
template class Gen<ShapePairCase<2>>;
template class Gen<ShapePairCase<3>>;
template class Gen<Shape<2>>;
template class Gen<Shape<3>>;
template class Gen<Pose<2>>;
template class Gen<Pose<3>>;
template class Gen<Vec<2>>;
template class Gen<Vec<3>>;

}}}  // namespace lpc::LPC_PRECISION::test

namespace lpc { inline namespace LPC_PRECISION {

template std::ostream& operator<< <2>(std::ostream&, const Shape<2>&);
template std::ostream& operator<< <3>(std::ostream&, const Shape<3>&);
template std::ostream& operator<< <2>(std::ostream&, const Pose<2>&);
template std::ostream& operator<< <3>(std::ostream&, const Pose<3>&);

}}  // namespace lpc::LPC_PRECISION
