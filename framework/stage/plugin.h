// SPDX-License-Identifier: Zlib
// For algorithms outside of the source tree: build them as a shared library against lpc::lpc (or lpc::lpc_f32), put
//
//   LPC_PLUGIN;
//
// at file scope into one of its files, and run `lpc --plugin ./libmine.so ...`.
#pragma once

#include "framework/stage/registry.h"

#define LPC_VERSION_TEXT "0.2.0"
#define LPC_TEXT_OF_(x) #x
#define LPC_TEXT_OF(x) LPC_TEXT_OF_(x)

/// The properties that two builds must share: version, precision and compiler. `lpc` searches the file for the prefix
/// before loading it, because even the initialisers of a library of the other precision must not run.
#define LPC_ABI_TEXT "LPC-ABI|" LPC_VERSION_TEXT "|" LPC_TEXT_OF(LPC_PRECISION) "|" __VERSION__

#define LPC_PLUGIN                      \
  extern "C" const char* const lpc_abi; \
  extern "C" const char* const lpc_abi = LPC_ABI_TEXT
