// SPDX-License-Identifier: Zlib
#pragma once

#include <span>
#include <string>

#include "experiments/sandbox/deed.h"

namespace lpc::inline LPC_PRECISION {

/// What was done by hand as a director's script, as the first lane had it: `lpc run SCENE --script FILE` does the same.
/// `ofScene`: how many bodies ever come of the scene, which has no script of its own. Throws UserError for what a
/// script cannot say.
template <int D>
std::string scriptOf(std::span<const Deed<D>> deeds, int ofScene, const std::string& summary, long steps);

}  // namespace lpc::inline LPC_PRECISION
