// SPDX-License-Identifier: Zlib
#pragma once

#include <type_traits>

#include "algorithms/pair_query/core/touching_boxes2.h"
#include "algorithms/pair_query/core/touching_boxes3.h"

namespace lpc { inline namespace LPC_PRECISION { namespace pair_query {

template <int D>
using TouchingBoxes = std::conditional_t<D == 2, TouchingBoxes2, TouchingBoxes3>;

}}}  // namespace lpc::LPC_PRECISION::pair_query
