// SPDX-License-Identifier: Zlib
#include "framework/stage/plugin.h"

LPC_PLUGIN;
