// SPDX-License-Identifier: Zlib
// The few tolerances that belong to the world, not to one algorithm. All are multiples of one length.
#pragma once

#include "framework/math/space.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Penetration depth that contacts keep on purpose, so that resting contacts do not come and go (m). The 2009 engine
/// called it penetrationEpsilon. Larger: bodies visibly sink. Smaller: contacts flicker and lose their warm starts.
inline constexpr Real kLinearSlop = Real(0.005);

/// Shapes nearer than this get contacts before they touch (m). Larger: bodies interact at a distance when the solver
/// has no speculative bias. Smaller, down to zero: a resting contact vanishes whenever rounding separates it.
inline constexpr Real kContactMargin = 4 * kLinearSlop;

/// No bounce below this approach speed (m/s). The value is that of the 2009 engine. Larger: bodies do not bounce.
/// Smaller: resting bodies chatter.
inline constexpr Real kRestitutionThreshold = Real(0.2);

/// Allowed error of a unit vector's length (1). Larger: stretched shapes, false depths. Smaller: rounded unit vectors
/// are rejected.
inline constexpr Real kUnitTolerance = sizeof(Real) == 8 ? Real(1e-12) : Real(1e-5);

}}  // namespace lpc::LPC_PRECISION
