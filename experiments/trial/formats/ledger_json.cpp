// SPDX-License-Identifier: Zlib
#include "experiments/trial/formats/ledger_json.h"

#include <cmath>
#include <nlohmann/json.hpp>

namespace lpc { inline namespace LPC_PRECISION {

using nlohmann::json;

json toJson(const Verified& verified) {
  json ledger = json::array(), found = json::array();
  for (const auto& [k, e] : verified.ledger) {
    ledger.push_back({{"key", {k.stage, k.precision, k.dimension, k.kindA, k.kindB, k.axis, k.value, k.method}},
                      {"role", e.role},
                      {"tallies", e.tallies},
                      {"max_error", e.maxError},
                      {"ns", e.nanoseconds},
                      {"histogram", e.histogram},
                      {"worst", e.worst}});
  }
  for (const auto& [name, c] : verified.found) {
    found.push_back(
        {{"method", c.method}, {"failure", c.failure}, {"vertices", c.vertices}, {"size", c.size}, {"text", c.text}});
  }
  return {{"ledger", ledger}, {"found", found}};
}

Verified verifiedFromJson(const json& j) {
  Verified out;
  for (const json& row : j.at("ledger")) {
    const json& key = row.at("key");
    LedgerEntry& e = out.ledger[{.stage = key[0],
                                 .precision = key[1],
                                 .dimension = key[2],
                                 .kindA = key[3],
                                 .kindB = key[4],
                                 .axis = key[5],
                                 .value = key[6],
                                 .method = key[7]}];
    e.role = row.at("role"), e.tallies = row.at("tallies"), e.maxError = row.at("max_error");
    e.nanoseconds = row.at("ns"), e.histogram = row.at("histogram"), e.worst = row.at("worst");
  }
  for (const json& c : j.at("found")) {
    out.keep({c.at("method"), c.at("failure"), c.at("vertices"), c.at("size"), c.at("text")});
  }
  return out;
}

json caseRowsToJson(const std::vector<CaseResult>& rows) {
  json out = json::array();
  const auto number = [](double x) { return std::isinf(x) ? json(x > 0 ? "inf" : "-inf") : json(x); };
  for (const CaseResult& r : rows) {
    out.push_back({{"id", r.id},
                   {"method", r.method},
                   {"precision", r.precision},
                   {"unread", r.unread},
                   {"role", r.role},
                   {"side_alone", r.sideAlone},
                   {"verdict", r.verdict},
                   {"reason", r.reason},
                   {"numbers", {number(r.value), number(r.expected), number(r.error)}}});
    if (r.again) out.back()["again"] = *r.again;
  }
  return out;
}

std::vector<CaseResult> caseRowsFromJson(const json& j) {
  std::vector<CaseResult> out;
  for (const json& row : j) {
    const auto number = [&](std::size_t i) {  // null if not finite, and text if infinite
      const json& x = row.at("numbers")[i];
      return x.is_null() ? kUnknown : x.is_string() ? std::stod(x.get<std::string>()) : x.get<double>();
    };
    CaseResult& r = out.emplace_back(CaseResult{.id = row.at("id"),
                                                .method = row.at("method"),
                                                .precision = row.at("precision"),
                                                .role = row.at("role"),
                                                .verdict = row.at("verdict"),
                                                .reason = row.at("reason"),
                                                .value = number(0),
                                                .expected = number(1),
                                                .error = number(2),
                                                .sideAlone = row.at("side_alone"),
                                                .unread = row.at("unread")});
    if (row.contains("again")) r.again = row.at("again").get<bool>();
  }
  return out;
}

}}  // namespace lpc::LPC_PRECISION
