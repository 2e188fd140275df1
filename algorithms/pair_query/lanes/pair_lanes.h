// SPDX-License-Identifier: Zlib
// Many pairs at once, one in each lane of the widest registers of this processor (Highway chooses at run time). The
// answers are those of closed_form.cpp and sat.cpp, bit for bit, whatever the registers.
#pragma once

#include <bit>
#include <cstdint>

#include "algorithms/pair_query/tolerances.h"
#include "framework/stage/params.h"
#include "framework/stage/stage_narrowphase.h"

namespace lpc { inline namespace LPC_PRECISION { namespace pair_query {

/// Whether a method uses SIMD lanes.
enum class LaneUse : std::uint8_t { automatic, scalar };
inline void visitLanes(ParamVisitor& v, LaneUse& lanes) {
  v.choice("lanes", lanes, {"auto", "scalar"}, "several pairs at once where there are many, or one after the other");
}

/// Fewer pairs than this are not worth it.
inline constexpr std::size_t kFewestLanePairs = 8;

/// The largest number of pairs per call: the number of bits that tell which are left.
inline constexpr std::size_t kMostLanePairs = 64;

/// Bit i of the result: pair i is left to the scalar code. All pairs are of the named kinds.
std::uint64_t ballsInLanes(std::span<const PairView<3>> pairs, std::span<PairAnswer<3>> answers);
std::uint64_t segmentsInLanes(std::span<const PairView<3>> pairs, QueryNeed need, std::span<PairAnswer<3>> answers,
                              WorkDone& work);
std::uint64_t boxesInLanes(std::span<const PairView<3>> pairs, QueryNeed need, std::span<PairAnswer<3>> answers,
                           WorkDone& work);

/// Answers pairs by `inLanes` (in 3D, if allowed and if there are enough of them), and the remaining ones by
/// `oneByOne`; a rare slow pair thus does not slow down the others.
template <int D, class InLanes, class OneByOne>
void forMostInLanes(LaneUse use, std::span<const PairView<D>> pairs, std::span<PairAnswer<D>> answers,
                    InLanes&& inLanes, OneByOne&& oneByOne) {
  if constexpr (D == 3) {
    if (use == LaneUse::automatic && pairs.size() >= kFewestLanePairs) {
      for (std::size_t begin = 0; begin < pairs.size(); begin += kMostLanePairs) {
        const std::size_t count = std::min(kMostLanePairs, pairs.size() - begin);
        std::uint64_t left = inLanes(pairs.subspan(begin, count), answers.subspan(begin, count));
        if (count < kMostLanePairs) left &= (std::uint64_t{1} << count) - 1;
        for (; left != 0; left &= left - 1) {
          const std::size_t i = begin + static_cast<std::size_t>(std::countr_zero(left));
          oneByOne(pairs.subspan(i, 1), answers.subspan(i, 1));
        }
      }
      return;
    }
  }
  oneByOne(pairs, answers);
}

}}}  // namespace lpc::LPC_PRECISION::pair_query
