// SPDX-License-Identifier: Zlib
// Tolerances of times of impact that are not parameters, with unit, meaning and danger.
#pragma once

#include "framework/math/tolerances.h"

namespace lpc { inline namespace LPC_PRECISION { namespace continuous {

/// Default of the parameter `tolerance`: a gap of this fraction (1) of the pair's size is contact. Larger: times are
/// early by the time in which such a gap closes. Smaller: iterations end in the rounding of poses instead of in
/// contact.
inline constexpr Real kContactBand = sizeof(Real) == 8 ? Real(1e-10) : Real(1e-5);

/// A depth within this fraction (1) of the allowed depth has reached it. Larger: bodies stop early by the time that
/// such a depth takes. Smaller: many short steps towards it.
inline constexpr Real kAlmostThere = Real(0.01);

}}}  // namespace lpc::LPC_PRECISION::continuous
