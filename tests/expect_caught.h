// SPDX-License-Identifier: Zlib
// For properties without random input: a planted bug must break them in the first case.
#pragma once

#include "tests/check_property.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test {

/// `holds`: whether the planted bug passes the property. If not, it enters the list of planted bugs as caught by case
/// 1.
inline void expectCaught(const std::string& bug, bool holds) {
  EXPECT_FALSE(holds) << "the planted bug was not caught: " << bug;
  if (!holds) recordPlantedBug(bug, 1, 1);
}

}}}  // namespace lpc::LPC_PRECISION::test
