// SPDX-License-Identifier: Zlib
// The tolerances of times of impact that are not parameters, with unit, meaning and danger.
#pragma once

#include "framework/math/tolerances.h"

namespace lpc { inline namespace LPC_PRECISION { namespace continuous {

/// Default of the parameter `tolerance`: a gap of this part (1) of the pair's size is contact. Larger: an answer is
/// early by the time that such a gap takes to close. Smaller: steps end in the rounding of poses and not in contact.
inline constexpr Real kContactBand = sizeof(Real) == 8 ? Real(1e-10) : Real(1e-5);

/// A depth that is short of the allowed one by this part (1) of it has reached it. Larger: bodies
/// are stopped early by the time that such a depth takes. Smaller: the last steps towards it are many.
inline constexpr Real kAlmostThere = Real(0.01);

}}}  // namespace lpc::LPC_PRECISION::continuous
