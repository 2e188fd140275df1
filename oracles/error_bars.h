// SPDX-License-Identifier: Zlib
// How far each witness may be off: measured, kept in one table, and held there from both sides by
// tests/properties/witness_test.cpp.
#pragma once

#include <string_view>

#include "framework/shape.h"

namespace lpc::inline LPC_PRECISION {

/// 99 of 100 answers with a value stay within this (|phi - phi_ref| / s, s as in `errorScale`) on random pairs of these
/// kinds at 1 m, in double precision; infinite where the witness has no value or is not in the table. On the named
/// families of hard pairs witnesses do worse.
double errorBar(std::string_view witness, ShapeKind a, ShapeKind b);

}  // namespace lpc::inline LPC_PRECISION
