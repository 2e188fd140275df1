// SPDX-License-Identifier: Zlib
#include "framework/plugin.h"

LPC_PLUGIN;
