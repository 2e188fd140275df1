// SPDX-License-Identifier: Zlib
#pragma once

#include "framework/problem/body.h"

namespace lpc { inline namespace LPC_PRECISION {

inline constexpr BodyType kBodyTypes[] = {BodyType::dynamic, BodyType::fixed, BodyType::kinematic};

/// The name in scenes, scripts and messages.
constexpr const char* bodyTypeName(BodyType type) {
  switch (type) {
    case BodyType::fixed:
      return "fixed";
    case BodyType::kinematic:
      return "kinematic";
    case BodyType::dynamic:
      return "dynamic";
  }
  return "";
}

}}  // namespace lpc::LPC_PRECISION
