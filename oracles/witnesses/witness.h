// SPDX-License-Identifier: Zlib
// Other people's code behind PairQuery. It runs in a process of its own, because on known inputs it throws, aborts on
// its own assertions, faults or never returns.
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

/// How one call of a witness ended. All but `answered` come with QueryStatus::failed.
enum class Ending : std::uint8_t { answered, notFinite, threw, crashed, hung };
std::string_view endingName(Ending ending);

/// 99 of 100 answers with a value stay within `bar` (|phi - phi_ref| / s, s as in `errorScale`) on random pairs of
/// these kinds (a <= b) at 1 m, in double precision; tests/properties/witness_test.cpp holds it there from both sides.
/// On the named families of hard pairs witnesses do worse.
struct ErrorBar {
  ShapeKind a, b;
  double bar;
};

template <int D>
class Witness : public PairQuery<D> {
 public:
  /// The pairs of kinds that the library really answers. All others are unsupported, those of a kind that is new among
  /// them, and none is asked: some libraries pass over what they lack in silence (FCL prints a warning and calls the
  /// shapes apart). So an adapter names the kinds that stand here and no others.
  virtual std::span<const ErrorBar> errorBars() const { return {}; }
  /// Infinite where the witness has no value.
  double errorBar(ShapeKind a, ShapeKind b) const {
    for (const ErrorBar& e : errorBars()) {
      if (e.a == std::min(a, b) && e.b == std::max(a, b)) return e.bar;
    }
    return std::numeric_limits<double>::infinity();
  }
  /// Of a library in float, whatever it is asked in: its numbers are rounded before it sees them, so that it is judged
  /// by the tolerance of f32 in f64, too.
  virtual bool computesInFloat() const { return sizeof(Real) == sizeof(float); }
  bool supports(ShapeKind a, ShapeKind b) const override { return a <= b && std::isfinite(errorBar(a, b)); }
  /// Of the last batch, one per pair.
  virtual std::span<const Ending> endings() const = 0;
  /// Time inside the library for the last batch, without the way to its process and back (ns).
  virtual std::int64_t nanoseconds() const = 0;
  /// What `query` asks the library of this pair, which it supports; nothing where the adapter has no words for it. The
  /// library is not called.
  virtual std::optional<Question> question(const PairView<D>&) { return std::nullopt; }
};

/// pairTolerance() of the method that is asked; null: no witness.
template <int D>
double verifyTolerance(const Witness<D>* witness = nullptr) {
  return witness ? pairTolerance(witness->computesInFloat()) : pairTolerance();
}

}}  // namespace lpc::LPC_PRECISION
