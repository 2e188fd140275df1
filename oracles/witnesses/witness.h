// SPDX-License-Identifier: Zlib
// External libraries behind PairQuery. Each runs in its own process, because on known inputs libraries throw, fail an
// assertion, crash or never return.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>

#include "framework/stage/stage_narrowphase.h"
#include "oracles/referee/pair_truth.h"
#include "oracles/witnesses/snippet.h"

namespace lpc { inline namespace LPC_PRECISION {

/// How one call of a witness ended. All except `answered` come with QueryStatus::failed.
enum class Ending : std::uint8_t { answered, notFinite, threw, crashed, hung };
std::string_view endingName(Ending ending);

/// Error bound of a witness, in |phi - phi_ref| / s with s as in `errorScale`. Of the answers with a value, 99 of 100
/// stay within `bar`, for random pairs of these kinds (a <= b) at 1 m, in double precision.
/// tests/properties/witness_test.cpp checks it from both sides. On the named families of hard pairs witnesses do worse.
struct ErrorBar {
  ShapeKind a, b;
  double bar;
};

template <int D>
class Witness : public PairQuery<D> {
 public:
  /// The pairs of kinds that the library really supports. All others, also with new kinds, are unsupported and never
  /// queried: some libraries silently return a wrong answer for unsupported kinds (FCL prints a warning and reports
  /// separation). So an adapter lists exactly the kinds that it handles.
  virtual std::span<const ErrorBar> errorBars() const { return {}; }
  /// Infinite when the witness has no value.
  double errorBar(ShapeKind a, ShapeKind b) const {
    for (const ErrorBar& e : errorBars()) {
      if (e.a == std::min(a, b) && e.b == std::max(a, b)) return e.bar;
    }
    return std::numeric_limits<double>::infinity();
  }
  /// True for a library that computes in float, even in f64 builds: its input is rounded first, so that it is judged by
  /// the tolerance of f32.
  virtual bool computesInFloat() const { return sizeof(Real) == sizeof(float); }
  bool supports(ShapeKind a, ShapeKind b) const override { return a <= b && std::isfinite(errorBar(a, b)); }
  /// Of the last batch, one per pair.
  virtual std::span<const Ending> endings() const = 0;
  /// Time inside the library for the last batch (ns), without communication with its process.
  virtual std::int64_t nanoseconds() const = 0;
  /// The query of this supported pair as a program; empty when the adapter cannot write one. Does not call the library.
  virtual std::optional<Question> question(const PairView<D>&) { return std::nullopt; }
};

/// pairTolerance() of the method; null: not a witness.
template <int D>
double verifyTolerance(const Witness<D>* witness = nullptr) {
  return witness ? pairTolerance(witness->computesInFloat()) : pairTolerance();
}

}}  // namespace lpc::LPC_PRECISION
