// SPDX-License-Identifier: Zlib
#include "experiments/runner/pair_corpus.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "framework/math/check.h"
#include "oracles/corpus/cases.h"
#include "oracles/verify/verify.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kAbout[][2] = {
    {"format", "lpc pairs, version 1: also a file of cases for lpc verify --cases"},
    {"units", "metres; angles do not occur"},
    {"shapes",
     "around the origin of its own frame: sphere radius; capsule radius, half_length, axis x; segment points; box "
     "half_extents; convex points, of which it is the hull; cylinder radius, half_length, along x; cone radius, "
     "half_height, its "
     "tip at +x; ellipsoid half_x, half_y, half_z; half_space y <= 0. What lies around a core with corners is its "
     "radius, "
     "around a curved one its rounding"},
    {"pose", "world = R(q) * local + t, q as it stands: q_wxyz in 3D, cos_sin in 2D; A's is the identity"},
    {"sign", "signed_distance > 0 is a gap, < 0 minus the depth: the least way that parts the shapes"},
    {"interval", "[lo, hi] is proved to contain the signed distance of these numbers as they stand"},
    {"size", "what an error is measured by: largest extent + distance + largest coordinate"}};

class Writer {
 public:
  PairCorpus result() {
    m_out.text = "{\"schema\": " + schema() + ",\n\"count\": " + std::to_string(m_out.kept + m_out.drawn) +
                 ",\n\"cases\": [\n" + m_lines + "\n]}\n";
    return std::move(m_out);
  }
  template <int D>
  void add(const std::string& id, const std::string& source, const HardPair<D>& pair, long& count) {
    const PairTruth<D> truth = pairTruth(PairView<D>{pair.a.view(), pair.b.view(), pair.X_AB});
    if (!truth.answer.decided || !std::isfinite(truth.s)) {  // s of coordinates near the largest number
      ++m_out.undecided;
      return;
    }
    Json line = Json::parse(caseText<D>("", StageKind::pairQuery, pair, expectedText(truth.answer)));
    line["id"] = id, line["source"] = source;
    line["expected"]["interval"] = {truth.answer.lo, truth.answer.hi};
    line["expected"]["size"] = truth.s;
    m_lines += (m_lines.empty() ? "" : ",\n") + line.dump();
    ++count;
  }
  template <int D>
  void addKept(const Case& c, const CaseGeometry<D>& g) {
    const bool isPair = c.query == CaseQuery::signedDistance || c.query == CaseQuery::contacts;
    if (isPair && g.a.shape && g.b.shape) add<D>(c.id, c.source, g.pair(), m_out.kept);
  }
  template <int D>
  void addDrawn(std::uint64_t seed, long pairs) {
    for (int a = 0; a < kShapeKinds; ++a) {
      for (int b = a; b < kShapeKinds; ++b) {
        const auto kindA = static_cast<ShapeKind>(a), kindB = static_cast<ShapeKind>(b);
        if (!kindExists(kindA, D) || !kindExists(kindB, D) || (a == b && kindA == ShapeKind::plane)) continue;
        const std::string kinds = std::string(shapeKindName(kindA)) + "-" + std::string(shapeKindName(kindB));
        for (int i = 0; i < pairs; ++i) {
          add<D>(kinds + "-" + std::to_string(D) + "d-" + std::to_string(seed) + "-" + std::to_string(i), "lpc verify",
                 hardPair<D>(kindA, kindB, seed, i), m_out.drawn);
        }
      }
    }
  }

 private:
  static std::string schema() {
    Json about;
    for (const auto& [name, meaning] : kAbout) about[name] = meaning;
    return about.dump(2);
  }

  PairCorpus m_out;
  std::string m_lines;
};

constexpr const char* kRunner = R"py(#!/usr/bin/env python3
"""Counts a library's wrong answers. Fill in signed_distance, then: python3 run.py [pairs.json]"""
import json
import math
import pathlib
import sys

TOLERANCE = 1e-6  # allowed beyond the proved interval, as a share of the pair's size


def signed_distance(pair):
    """Of pair["shapeA"] at pair["poseA"] and pair["shapeB"] at pair["poseB"], in metres: a gap, or minus the depth.
    None where the library does not take these shapes, math.inf where it says "apart" and no more."""
    return None


def is_wrong(answer, lo, hi, allowed):
    if answer == math.inf:
        return hi < -allowed
    return not lo - allowed <= answer <= hi + allowed  # nor is NaN


def main(path):
    asked, passed, wrong = 0, 0, []
    for pair in json.loads(path.read_text())["cases"]:
        expected = pair["expected"]
        try:
            answer = signed_distance(pair)
        except Exception as error:
            print(f"{pair['id']}: {error!r}")
            answer = math.nan
        asked, passed = asked + 1, passed + (answer is None)
        if answer is not None and is_wrong(answer, *expected["interval"], TOLERANCE * expected["size"]):
            wrong.append(pair["id"])
            print(f"{pair['id']}: {answer}, and it lies in {expected['interval']}")
    print(f"{asked} pairs, {passed} not taken, {len(wrong)} wrong")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).with_name("pairs.json"))))
)py";

}  // namespace

PairCorpus pairCorpus(const PairCorpusOptions& options) {
  Writer writer;
  for (const Case& c : options.cases.empty() ? std::vector<Case>{} : readCases(options.cases)) {
    std::visit([&](const auto& g) { writer.addKept(c, g); }, c.geometry);
  }
  for (const int d : options.dimensions) {
    if (d == 2) writer.addDrawn<2>(options.seed, options.pairs);
    if (d == 3) writer.addDrawn<3>(options.seed, options.pairs);
  }
  return writer.result();
}

std::string pairCorpusRunner() { return kRunner; }

}}  // namespace lpc::LPC_PRECISION
