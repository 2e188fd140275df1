// SPDX-License-Identifier: Zlib
#include <lpc/plugin.h>

LPC_PLUGIN;
