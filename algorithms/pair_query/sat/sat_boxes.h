// SPDX-License-Identifier: Zlib
#pragma once

#include <type_traits>

#include "algorithms/pair_query/sat/sat_boxes2.h"
#include "algorithms/pair_query/sat/sat_boxes3.h"

namespace lpc { inline namespace LPC_PRECISION { namespace pair_query {

template <int D, class Watch = NoWatch>
using SatBoxes = std::conditional_t<D == 2, SatBoxes2<Watch>, SatBoxes3<Watch>>;

}}}  // namespace lpc::LPC_PRECISION::pair_query
