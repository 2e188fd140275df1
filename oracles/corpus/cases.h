// SPDX-License-Identifier: Zlib
// Corpora of hard inputs: a file of cases, in the format of docs/cases.md.
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

/// A shape of a case, converted to ours. Frames differ: a case's capsule has an axis or two end points, ours lies along
/// x, so the pose contains that rotation.
template <int D>
struct CaseShape {
  std::optional<Shape<D>> shape;  // empty: rejected
  Pose<D> X_WS;
  std::string refusal;  // why it is rejected, for instance "cylinder"
};

template <int D>
struct CaseGeometry {
  CaseShape<D> a, b;
  std::optional<Pose<D>> X_WBNudged = {};  // of a contacts case with faces at rest
  std::vector<Vec<D>> points;              // of a convex hull case
  Motion<D> motionB;                       // of a time of impact case; A does not move
  Pose<D> X_WBodyB;                        // B rotates about its origin
  Real duration = 0;                       // s
  BoxScript<D> script;                     // of a broadphase case

  /// Both shapes as `lpc verify` uses them; neither may be rejected.
  HardPair<D> pair() const;
};

/// The finding of a case written by `lpc verify`. Its poses are bit for bit the input of the method in this precision;
/// another build normalises the rotations.
struct CaseFinding {
  StageKind stage = StageKind::pairQuery;
  std::string precision, method;  // the method with its parameters
  std::string failure;            // the failure as in file names: wrong_distance
  double error = 0;               // relative to s; NaN when there is none
  std::uint64_t seed = 0;         // with the kinds of its shapes it named the pair when the finding was made
  int number = 0;
};

inline constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// The expected result, as far as the file states it. Which fields count depends on the query. 2D uses the first two
/// components.
struct CaseExpected {
  double distance = kUnknown;  // signed, m; NaN: not stated
  double tolerance = 0;        // accuracy of `distance` in the file (m)
  double measure = kUnknown;   // area or volume (m^D)
  double impact = kUnknown;    // s; infinite: they never touch; NaN: not stated
  bool degenerate = false;     // a hull that may be rejected
  std::vector<std::array<double, 3>> hullVertices;
  std::array<double, 3> center{kUnknown, kUnknown, kUnknown};
  std::vector<double> inertia;  // about the centre: one number in 2D, nine in 3D (row by row)
};

struct Case {
  std::string id, source, queryText;
  CaseQuery query = CaseQuery::unknown;
  std::string mistake = {};  // why the case cannot be read; empty: it was read, and the rest holds
  double density = 1;        // of a mass case, kg/m^D
  std::optional<CaseFinding> finding = {};
  std::variant<CaseGeometry<2>, CaseGeometry<3>> geometry;
  CaseExpected expected;
};

/// What to do with a case that does not match the schema. A case with a number beyond this precision is always kept.
enum class BrokenCases { refused, kept };

/// Reads a file of cases. Throws UserError that names the file, the case and the field when the file does not match the
/// schema; broken cases that are kept have a `mistake` instead. An unsupported shape or query is not an error: it is
/// read and later rejected.
std::vector<Case> readCases(const std::string& path, BrokenCases broken = BrokenCases::refused);
/// The same from a file's text; `path` is for messages.
std::vector<Case> parseCases(const std::string& text, const std::string& path,
                             BrokenCases broken = BrokenCases::refused);

}}  // namespace lpc::LPC_PRECISION
