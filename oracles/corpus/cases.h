// SPDX-License-Identifier: Zlib
// Corpora of hard inputs: a file of cases. The schema stands at the top of tests/regressions/hard_cases.json and, of
// what `lpc verify` found, found_cases.json beside it, so that corpora can be exchanged with others.
#pragma once

#include <array>
#include <limits>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "framework/problem/body.h"
#include "framework/shape/shape.h"
#include "framework/stage/registry.h"
#include "oracles/corpus/box_script.h"
#include "oracles/corpus/hard_pairs.h"

namespace lpc { inline namespace LPC_PRECISION {

enum class CaseQuery { signedDistance, contacts, broadphase, convexHull, massProperties, timeOfImpact, unknown };

/// A shape of a case as ours. Frames differ: a case's capsule has an axis or two end points, ours lies along x, so the
/// pose contains that turn.
template <int D>
struct CaseShape {
  std::optional<Shape<D>> shape;  // empty: refused
  Pose<D> X_WS;
  std::string refusal;  // why it is refused, for instance "cylinder"
};

template <int D>
struct CaseGeometry {
  CaseShape<D> a, b;
  std::optional<Pose<D>> X_WBNudged = {};  // of a contacts case of faces at rest
  std::vector<Vec<D>> points;              // of a convex hull case
  Motion<D> motionB;                       // of a time of impact case; A stands still
  Pose<D> X_WBodyB;                        // about whose origin B turns
  Real duration = 0;                       // s
  BoxScript<D> script;                     // of a broadphase case

  /// Both shapes as `lpc verify` asks them; neither may be refused.
  HardPair<D> pair() const;
};

/// Of a case that `lpc verify` wrote: what was wrong. Its poses are the bits that the method was asked in this
/// precision; another build normalises the rotations.
struct CaseFinding {
  StageKind stage = StageKind::pairQuery;
  std::string precision, method;  // the method with the parameters that it had
  std::string failure;            // as in names of files: wrong_distance
  double error = 0;               // over s; NaN where there is none
  std::uint64_t seed = 0;         // with the kinds of its shapes the name of the pair, on the day when it was found
  int number = 0;
};

inline constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// What must come out. Which fields count depends on the query; of hulls and masses only what the file states is
/// compared. 2D uses the first two components.
struct CaseExpected {
  double distance = 0;        // signed, m; NaN in a case with a finding whose referee had none
  double tolerance = 0;       // how well the file knows `distance` (m)
  double measure = kUnknown;  // area or volume (m^D)
  double impact = kUnknown;   // s; infinite: they never touch
  bool degenerate = false;    // a hull that may be refused
  std::vector<std::array<double, 3>> hullVertices;
  std::array<double, 3> center{kUnknown, kUnknown, kUnknown};
  std::vector<double> inertia;  // about the centre: one number in 2D, nine in 3D (row by row)
};

struct Case {
  std::string id, source, queryText;
  CaseQuery query = CaseQuery::unknown;
  double density = 1;  // of a mass case, kg/m^D
  std::optional<CaseFinding> finding = {};
  std::variant<CaseGeometry<2>, CaseGeometry<3>> geometry;
  CaseExpected expected;
};

/// Throws UserError that names the file, the case and the field when the file is not in the schema. A shape or query
/// that we lack is no error: it is read and later refused.
std::vector<Case> readCases(const std::string& path);
/// The same of a file's text; `path` is for messages.
std::vector<Case> parseCases(const std::string& text, const std::string& path);

}}  // namespace lpc::LPC_PRECISION
