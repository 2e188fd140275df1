// SPDX-License-Identifier: Zlib
// Observing a search. A kernel says `watch([&](auto& t) { t.axis(...); })` where a step may be recorded. By default
// there is no observer, and the lambda is not even compiled, so the kernel is unchanged. Otherwise `t` is a Tracer
// (tracer.h).
#pragma once

#include "framework/math/space.h"

namespace lpc { inline namespace LPC_PRECISION { namespace pair_query {

struct NoWatch {
  template <class F>
  void operator()(F&&) const {}
};

}}}  // namespace lpc::LPC_PRECISION::pair_query
