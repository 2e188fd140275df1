// SPDX-License-Identifier: Zlib
// Plays a script of keys and mouse: each order becomes the event that a user would cause.
#pragma once

#include "experiments/sandbox/input_script.h"

namespace lpc { inline namespace LPC_PRECISION {

template <int D>
class App;

/// Plays the next order; call once per picture. Throws UserError, with file and line, if an order cannot be executed.
template <int D>
void playOrder(App<D>& app, InputScript& script);

}}  // namespace lpc::LPC_PRECISION
