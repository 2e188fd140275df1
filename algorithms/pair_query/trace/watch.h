// SPDX-License-Identifier: Zlib
// Who looks at a search. A kernel says `watch([&](auto& t) { t.axis(...); })` where there is something to see. Nobody
// looks, by default: then what is in the braces is not even compiled, and the kernel is as it was. Else `t` is a Tracer
// (tracer.h).
#pragma once

#include "framework/math/space.h"

namespace lpc { inline namespace LPC_PRECISION { namespace pair_query {

struct NoWatch {
  template <class F>
  void operator()(F&&) const {}
};

}}}  // namespace lpc::LPC_PRECISION::pair_query
