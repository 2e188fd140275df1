// SPDX-License-Identifier: Zlib
// The code of a plugin may throw anything, abort, exit or loop. The runner therefore tries it in a child process.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "framework/stage/registry.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Runs `work` in a child process, without output and with limits of time and memory. Returns how it failed, such as
/// "it dies of signal 6"; nothing when it ended. Throws the UserError that `work` throws.
std::optional<std::string> failureInChild(const std::function<void()>& work);

/// Creates the algorithm as a check of its parameters, in a child process once a plugin is loaded. Throws UserError
/// when the parameters are invalid. A constructor that fails otherwise is left to the worker of its trial, which
/// records how.
void checkConstructor(const Registered& entry, const Spec& spec);
/// For a single run, which has no time limit: throws UserError when a constructor failed in checkConstructor().
void requireCheckedConstructors();
/// Calls `use`, which creates the algorithm, first in a child process once a plugin is loaded. Throws UserError when
/// the parameters are invalid, or when it fails otherwise.
void requireConstructor(const Registered& entry, const std::function<void()>& use);

}}  // namespace lpc::LPC_PRECISION
