// SPDX-License-Identifier: Zlib
// For properties without random input: a planted bug must break them at once.
#pragma once

#include "tests/check_property.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test {

/// `holds`: what the property says of the planted bug. It enters the list of planted bugs as caught by its one case.
inline void expectCaught(const std::string& bug, bool holds) {
  EXPECT_FALSE(holds) << "the planted bug was not caught: " << bug;
  if (!holds) recordPlantedBug(bug, 1, 1);
}

}}}  // namespace lpc::LPC_PRECISION::test
