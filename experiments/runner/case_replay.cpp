// SPDX-License-Identifier: Zlib
#include "experiments/runner/case_replay.h"

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
  std::string method;
};
using AllAsked = std::vector<Asked>;

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
      end.outcome = "crash", end.reason = "the worker's result cannot be read";
    }
    if (end.outcome == "ok") {
      rows.insert(rows.end(), told.begin(), told.end());
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
    for (const Asked& q : questions) task["questions"].push_back({q.number, q.method});
    // Half a second is allowed for a witness that hangs on a pair.
    const WorkerLimits limits{.seconds = 20 + 0.6 * static_cast<double>(questions.size())};
    m_pool.start(0, m_cases[questions.front().number].finding->precision, {{"cases", task}}, limits, -1);
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
      throw std::runtime_error(c.id + ", " + q.method + ": " + end.reason);
    }
    CaseResult row{.id = c.id, .method = q.method, .role = roleOf(c, q.method), .expected = c.expected.distance};
    row.verdict = hung ? CaseVerdict::hang : CaseVerdict::failed, row.reason = hung ? "hung" : "crashed";
    if (q.method == c.finding->method) row.again = c.finding->failure == row.reason;
    return row;
  }

  std::string m_file, m_path;  // as given, and absolute
  const std::vector<Case>& m_cases;
  WorkerPool m_pool;
};

}  // namespace

std::vector<CaseResult> replayFound(const std::string& path, const std::vector<Case>& cases,
                                    const std::vector<std::string>& plugins) {
  const InterruptGuard interrupts;
  Replay replay(path, cases, plugins);
  std::set<std::string> precisions;
  for (const Case& c : cases) {
    if (c.finding && precisions.insert(c.finding->precision).second) checkWorker(c.finding->precision, false);
  }
  std::vector<CaseResult> rows;
  AllAsked questions;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    if (!cases[i].finding) continue;
    if (!questions.empty() && cases[i].finding->precision != cases[questions.front().number].finding->precision) {
      replay.ask(std::exchange(questions, {}), rows);
    }
    for (const std::string& method : methodsToAsk(cases[i])) questions.push_back({i, method});
  }
  if (!questions.empty()) replay.ask(questions, rows);
  return rows;
}

}}  // namespace lpc::LPC_PRECISION
