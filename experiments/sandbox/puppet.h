// SPDX-License-Identifier: Zlib
// Plays a script of keys and mouse: each order comes as the event that a user's would be.
#pragma once

#include "experiments/sandbox/input_script.h"

namespace lpc { inline namespace LPC_PRECISION {

template <int D>
class App;

/// The next order, once a picture. Throws UserError, with file and line, for one that cannot be followed.
template <int D>
void playOrder(App<D>& app, InputScript& script);

}}  // namespace lpc::LPC_PRECISION
