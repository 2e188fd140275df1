// SPDX-License-Identifier: Zlib
#include "experiments/runner/case_replay.h"

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <string_view>
#include <utility>

#include "experiments/runner/worker_pool.h"
#include "experiments/trial/formats/ledger_json.h"
#include "framework/math/check.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using nlohmann::json;

struct Asked {
  std::size_t number;  // of the case
  std::string method;  // empty: all, on a case without a finding
  std::string precision;
};
using AllAsked = std::vector<Asked>;

constexpr double kMostMethods = 30;  // that answer one query

class Replay {
 public:
  Replay(const std::string& path, const std::vector<Case>& cases, const std::vector<std::string>& plugins)
      : m_file(path), m_path(std::filesystem::absolute(path).string()), m_cases(cases), m_pool(plugins) {}

  // Asks one worker for all; if it does not return, one worker for each half.
  void ask(const AllAsked& questions, std::vector<CaseResult>& rows) {
    WorkerEnd end = run(questions);
    if (end.outcome == "unsupported") throw UserError(m_file + ": " + std::string(toldBy(end.reason)));
    std::vector<CaseResult> told;
    try {
      if (end.outcome == "ok") told = caseRowsFromJson(json::parse(end.output));
    } catch (const json::exception&) {
      end.outcome = "crash", end.reason = "the worker's result is unreadable";
    }
    if (end.outcome == "ok") {
      for (const CaseResult& row : told) {  // an unread case has one row, also if its questions went to two workers
        if (!row.unread || rows.empty() || !rows.back().unread || rows.back().id != row.id) rows.push_back(row);
      }
    } else if (questions.size() > 1) {
      const auto half = questions.begin() + static_cast<std::ptrdiff_t>(questions.size() / 2);
      ask({questions.begin(), half}, rows);
      ask({half, questions.end()}, rows);
    } else {
      rows.push_back(lost(questions.front(), end));
    }
  }

 private:
  // Strips the prefix of a worker's message.
  std::string_view toldBy(std::string_view reason) const {
    for (const std::string& start : {std::string("lpc: "), m_path + ": "}) {
      if (reason.starts_with(start)) reason.remove_prefix(start.size());
    }
    return reason;
  }

  WorkerEnd run(const AllAsked& questions) {
    json task = {{"file", m_path}, {"questions", json::array()}};
    double answers = 0;
    for (const Asked& q : questions) {
      task["questions"].push_back({q.number, q.method});
      answers += q.method.empty() ? kMostMethods : 1;
    }
    // Half a second is allowed for a witness that hangs on a pair.
    const WorkerLimits limits{.seconds = 20 + 0.6 * answers};
    m_pool.start(0, questions.front().precision, {{"cases", task}}, limits, -1);
    for (;;) {
      if (InterruptGuard::interrupted()) throw Interrupted();
      for (WorkerEnd& end : m_pool.ended()) return std::move(end);
    }
  }

  // Only a signal or a hang is a fault of the method; SIGKILL comes from the machine's memory limit.
  CaseResult lost(const Asked& q, const WorkerEnd& end) const {
    const Case& c = m_cases[q.number];
    const bool hung = end.outcome == "timeout", crashed = end.signal != 0 && end.signal != SIGKILL;
    if (q.method == "referee" || !(hung || crashed)) {
      throw std::runtime_error(c.id + (q.method.empty() ? "" : ", " + q.method) + ": " + end.reason);
    }
    CaseResult row{.id = c.id, .method = q.method, .precision = q.precision, .expected = c.expected.distance};
    row.verdict = hung ? CaseVerdict::hang : CaseVerdict::failed, row.reason = hung ? "hung" : "crashed";
    if (!c.finding) {
      row.method = "-";
      return row;
    }
    row.role = roleOf(c, q.method);
    if (q.method == c.finding->method) row.again = c.finding->failure == row.reason;
    return row;
  }

  std::string m_file, m_path;  // as given, and absolute
  const std::vector<Case>& m_cases;
  WorkerPool m_pool;
};

}  // namespace

std::vector<CaseResult> replayCases(const std::string& path, const std::vector<Case>& cases,
                                    const std::string& precision, const std::vector<std::string>& plugins) {
  const InterruptGuard interrupts;
  AllAsked all;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const Case& c = cases[i];
    if (!c.mistake.empty()) continue;
    if (!c.finding && !precision.empty()) all.push_back({i, "", precision});
    if (!c.finding) continue;
    for (const std::string& method : methodsToAsk(c)) all.push_back({i, method, c.finding->precision});
  }
  std::set<std::string> precisions;
  for (const Asked& q : all) {
    if (precisions.insert(q.precision).second) checkWorker(q.precision, false);
  }
  Replay replay(path, cases, plugins);
  std::vector<CaseResult> rows;
  for (auto at = all.begin(); at != all.end();) {
    const auto end = std::find_if(at, all.end(), [&](const Asked& q) { return q.precision != at->precision; });
    replay.ask({at, end}, rows);
    at = end;
  }
  return rows;
}

}}  // namespace lpc::LPC_PRECISION
