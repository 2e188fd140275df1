// SPDX-License-Identifier: Zlib
#include "experiments/runner/verification.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <map>
#include <regex>
#include <set>

#include "experiments/runner/code_identity.h"
#include "experiments/runner/plugin_probe.h"
#include "experiments/runner/worker_pool.h"
#include "experiments/trial/formats/ledger_json.h"
#include "experiments/trial/formats/output_file.h"
#include "framework/math/check.h"
#include "framework/math/names.h"
#include "framework/stage/stage_narrowphase.h"
#include "oracles/verify/metamorphic.h"
#include "oracles/verify/verify.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using nlohmann::json;
using Clock = std::chrono::steady_clock;

// Starting a worker costs as much as some hundred pairs of our methods; witnesses are slow, and slower when they hang.
constexpr int kBlocksPerJob = 5, kBlocksPerSlowJob = 1;

/// A method as the ledger identifies it, and everything its verdicts depend on.
struct Method {
  LedgerMethod ledger;
  Spec spec;  // every parameter written out
  std::string code;
  AlgorithmRole role = AlgorithmRole::competitor;
};

/// The scope of one worker: one stage and dimension, and, except for broadphases, one pair of kinds.
struct Subject {
  StageKind stage;
  std::optional<std::pair<ShapeKind, ShapeKind>> kinds;
  std::vector<const Method*> methods;

  const LedgerMethod& front() const { return methods.front()->ledger; }
};

/// Consecutive blocks that the same methods lack. Its inputs go to one worker, and to several if a worker does not
/// return. It is recorded when all have answered.
struct VerifyJob {
  const Subject* subject = nullptr;
  std::vector<const Method*> methods;
  std::vector<VerifiedBlock> blocks;
  int count = 0;  // of inputs
  int open = 1;   // parts
  Verified verified = {};
};
struct Part {
  std::size_t job;
  int first, count;
  std::vector<const Method*> methods;
  std::string ended = {};  // how the worker ended that ran only this
};

template <int D>
bool supports(const Method& m, const Subject& s) {
  if (s.stage == StageKind::pairQuery)
    return createStage<PairQuery<D>>(m.spec)->supports(s.kinds->first, s.kinds->second);
  if (s.stage == StageKind::contacts)
    return createStage<ContactGenerator<D>>(m.spec)->supports(s.kinds->first, s.kinds->second);
  if (s.stage == StageKind::timeOfImpact)
    return createStage<TimeOfImpact<D>>(m.spec)->supports(s.kinds->first, s.kinds->second);
  return true;
}

/// Calls f(a, b) for all kinds a <= b of a dimension.
template <class F>
void forKinds(int dimension, const F& f) {
  for (int a = 0; a < kShapeKinds; ++a) {
    for (int b = a; b < kShapeKinds; ++b) {
      const auto kindA = static_cast<ShapeKind>(a), kindB = static_cast<ShapeKind>(b);
      if (kindExists(kindA, dimension) && kindExists(kindB, dimension)) f(kindA, kindB);
    }
  }
}

/// The methods and their subjects; complete before anything is run or written.
class Plan {
 public:
  explicit Plan(const VerificationOptions& options) : m_options(options) {
    findMethods();
    findSubjects();
    if (m_subjects.empty()) throw UserError("verify: no method has this role in these stages and dimensions");
  }
  Plan(const Plan&) = delete;  // subjects point to methods
  Plan& operator=(const Plan&) = delete;

  const std::vector<Method>& methods() const { return m_methods; }
  const std::vector<Subject>& subjects() const { return m_subjects; }

 private:
  void findMethods() {
    std::vector<Spec> given;
    std::vector<bool> known;
    for (const std::string& text : m_options.methods) given.push_back(Spec::parse(text)), known.push_back(false);
    for (const StageKind stage : m_options.stages) {
      for (const int d : m_options.dimensions) {
        for (const Registered* r : Registry::instance().list(stage, d)) {
          for (const Spec& spec : given.empty() ? specsToVerify(*r) : std::vector<Spec>{}) add(*r, spec);
          for (std::size_t i = 0; i < given.size(); ++i) {
            if (given[i].name == r->info.name) add(*r, given[i]), known[i] = true;
          }
        }
      }
    }
    for (std::size_t i = 0; i < given.size(); ++i) {
      if (known[i]) continue;
      const std::string& name = given[i].name;
      throw UserError("unknown method '" + name + "' to verify" + validNames(methodNames(), name));
    }
  }
  void add(const Registered& r, const Spec& spec) {
    if (m_options.role && r.info.role != *m_options.role) return;
    const Spec whole = r.canonical(spec);
    requireConstructor(r, [&] {
      r.create(whole);
      const Method probe{{}, whole, {}, r.info.role};
      forKinds(r.dimension, [&](ShapeKind a, ShapeKind b) {
        const Subject s{r.stage, std::pair(a, b), {}};
        r.dimension == 2 ? supports<2>(probe, s) : supports<3>(probe, s);
      });
    });
    json code = codeHashes(r.stage, whole, r.dimension);
    code["core"] = coreHash(), code["oracles"] = oraclesHash();
    if (r.stage == StageKind::velocity) {  // the references for their answers
      for (const Spec& other : convergedResolvers(r.dimension)) code.update(codeHashes(r.stage, other, r.dimension));
    }
    for (const std::string& precision : m_options.precisions) {
      const LedgerMethod ledger{std::string(stageName(r.stage)), precision, r.dimension, spec.text()};
      m_methods.push_back({ledger, whole, hexHash(code.dump()), r.info.role});
    }
  }
  std::vector<std::string> methodNames() const {
    std::set<std::string> names;
    for (const StageKind stage : m_options.stages) {
      for (const int d : m_options.dimensions) {
        for (const Registered* r : Registry::instance().list(stage, d)) names.insert(r->info.name);
      }
    }
    return {names.begin(), names.end()};
  }

  void findSubjects() {
    for (const std::string& precision : m_options.precisions) {
      for (const StageKind stage : m_options.stages) {
        for (const int d : m_options.dimensions) addSubjects(precision, stage, d);
      }
    }
  }
  void addSubjects(const std::string& precision, StageKind stage, int dimension) {
    if (stage == StageKind::broadphase || stage == StageKind::velocity) {
      addSubject(precision, dimension, {stage, std::nullopt, {}});
      return;
    }
    forKinds(dimension, [&](ShapeKind a, ShapeKind b) {
      addSubject(precision, dimension, {stage, std::pair(a, b), {}});
    });
  }
  void addSubject(const std::string& precision, int dimension, Subject s) {
    for (const Method& m : m_methods) {
      const LedgerMethod& l = m.ledger;
      if (l.stage != stageName(s.stage) || l.precision != precision || l.dimension != dimension) continue;
      if (dimension == 2 ? supports<2>(m, s) : supports<3>(m, s)) s.methods.push_back(&m);
    }
    if (!s.methods.empty()) m_subjects.push_back(std::move(s));
  }

  const VerificationOptions& m_options;
  std::vector<Method> m_methods;
  std::vector<Subject> m_subjects;
};

class Verification {
 public:
  Verification(const VerificationOptions& options, Store& store)
      : m_options(options),
        m_store(store),
        m_plan(options),
        m_subjects(m_plan.subjects()),
        m_pool(options.plugins),
        m_tty(isatty(STDERR_FILENO) == 1) {
    for (const Method& m : m_plan.methods()) {
      store.keepOnlyCode(m.ledger, m.code);
      if (m.role == AlgorithmRole::witness) m_blocksPerJob = kBlocksPerSlowJob;
    }
  }

  VerificationSummary run() {
    const std::size_t workers = m_options.jobs > 0 ? static_cast<std::size_t>(m_options.jobs) : processors().size();
    while (!InterruptGuard::interrupted()) {
      while (m_pool.running() < std::max<std::size_t>(1, workers) && startNext()) {
      }
      if (m_pool.running() == 0) break;
      for (const WorkerEnd& end : m_pool.ended()) collect(end);
      progress(false);
    }
    m_pool.killAll();
    progress(true);
    m_summary.stopped = InterruptGuard::interrupted();
    return m_summary;
  }

 private:
  VerifiedBlock blockOf(const Subject& s, const Method& m, long block) const {
    json key = {{"stage", m.ledger.stage},
                {"precision", m.ledger.precision},
                {"method", m.spec.text()},
                {"dimension", m.ledger.dimension},
                {"label", m.ledger.method},
                {"seed", m_options.seed},
                {"size", m_blockSize},
                {"block", block},
                {"code", m.code}};
    if (m_options.metamorphic) key["relations"] = true;
    if (s.kinds) key["kinds"] = {shapeKindName(s.kinds->first), shapeKindName(s.kinds->second)};
    return {hexHash(key.dump()), m.ledger, m.code};
  }

  // The next part of a job with a lost worker, or of a new job; false if there is none.
  bool startNext() {
    if (m_again.empty() && !nextJob()) return false;
    const Part part = m_again.back();
    m_again.pop_back();
    const Subject& s = *m_jobs.at(part.job).subject;
    json task = {{"stage", s.front().stage}, {"dimension", s.front().dimension},
                 {"seed", m_options.seed},   {"first", part.first},
                 {"count", part.count},      {"methods", json::array()}};
    int witnesses = 0;
    for (const Method* m : part.methods) {
      task["methods"].push_back(m->ledger.method);
      witnesses += m->role == AlgorithmRole::witness;
    }
    if (s.kinds) task["kind_a"] = shapeKindName(s.kinds->first), task["kind_b"] = shapeKindName(s.kinds->second);
    if (m_options.metamorphic) task["relations"] = true;
    if (!part.ended.empty()) task["ended"] = part.ended;
    // Half a second is allowed for a witness that hangs on a pair, which is rare.
    const double asked = m_options.metamorphic ? 2.0 * kRelations : 1.0;  // of each pair
    const WorkerLimits limits{.seconds = 20 + part.count * asked * (0.02 + 0.1 * witnesses)};
    m_pool.start(m_started, s.front().precision, {{"verify", task}}, limits, -1);
    m_parts[m_started++] = part;
    return true;
  }

  // Iterates over rounds of blocks, and in each over all subjects, so that a stopped run has covered every subject.
  bool nextJob() {
    while (!InterruptGuard::interrupted()) {
      if (m_subject == m_subjects.size()) m_subject = 0, m_round += m_blocksPerJob, m_block = m_round;
      const bool timeIsOver = m_options.minutes > 0 && seconds() > 60 * m_options.minutes;
      const long blocks = (m_options.pairs + m_blockSize - 1) / m_blockSize;
      if (timeIsOver || (m_options.minutes <= 0 && m_round >= blocks)) return false;
      const long all = m_options.minutes > 0 ? std::numeric_limits<long>::max() : blocks;
      const long end = std::min(m_round + m_blocksPerJob, all);
      const Subject& s = m_subjects[m_subject];
      VerifyJob job{.subject = &s, .methods = {}, .blocks = {}};
      const long first = m_block;
      for (; m_block < end; ++m_block) {
        std::vector<const Method*> missing;
        std::vector<VerifiedBlock> blocksOfMissing;
        for (const Method* m : s.methods) {
          const VerifiedBlock block = blockOf(s, *m, m_block);
          if (m_store.isVerified(block.key)) continue;
          missing.push_back(m), blocksOfMissing.push_back(block);
        }
        if (m_block > first && missing != job.methods) break;
        job.methods = missing;
        job.blocks.insert(job.blocks.end(), blocksOfMissing.begin(), blocksOfMissing.end());
      }
      const auto count = static_cast<int>(m_block - first) * m_blockSize;
      if (m_block >= end) ++m_subject, m_block = m_round;
      if (job.methods.empty()) {
        m_summary.skipped += count;
        continue;
      }
      job.count = count;
      m_again.push_back({m_nextJob, static_cast<int>(first) * m_blockSize, count, job.methods, {}});
      m_jobs[m_nextJob++] = std::move(job);
      return true;
    }
    return false;
  }

  void collect(WorkerEnd end) {
    const Part part = m_parts.at(end.job);
    m_parts.erase(end.job);
    VerifyJob& job = m_jobs.at(part.job);
    if (end.outcome == "unsupported") throw UserError(end.reason);
    Verified verified;
    try {
      if (end.outcome == "ok") verified = verifiedFromJson(json::parse(end.output));
    } catch (const json::exception&) {
      end.outcome = "crash", end.reason = "the worker's result is unreadable";
    }
    if (end.outcome != "ok") {
      if (!part.ended.empty()) throw std::runtime_error("verify: " + end.reason);
      split(part, job, end.outcome == "timeout" ? "hung" : "crashed");
      return;
    }
    job.verified.add(verified);
    if (--job.open > 0) return;
    m_store.addVerified(job.blocks, job.verified);
    m_summary.asked += job.count;
    m_jobs.erase(part.job);
  }

  // Finds which method, then which input, is responsible. The others run again without them.
  void split(const Part& part, VerifyJob& job, const std::string& how) {
    if (part.methods.size() > 1) {
      for (const Method* m : part.methods) m_again.push_back({part.job, part.first, part.count, {m}, {}});
      job.open += static_cast<int>(part.methods.size()) - 1;
    } else if (part.count > 1) {
      const int half = part.count / 2;
      m_again.push_back({part.job, part.first, half, part.methods, {}});
      m_again.push_back({part.job, part.first + half, part.count - half, part.methods, {}});
      ++job.open;
    } else {
      m_again.push_back({part.job, part.first, part.count, part.methods, how});
    }
  }

  double seconds() const { return std::chrono::duration<double>(Clock::now() - m_start).count(); }

  void progress(bool last) {
    if (m_options.quiet) return;
    const double now = seconds();
    if (!last && now - m_shown < (m_tty ? 0.25 : 10)) return;
    m_shown = now;
    const double all = static_cast<double>(m_subjects.size()) *
                       static_cast<double>((m_options.pairs + m_blockSize - 1) / m_blockSize * m_blockSize);
    const double rest = all - static_cast<double>(m_summary.asked + m_summary.skipped);
    std::string left = "?";
    if (m_options.minutes > 0) {
      left = clockText(std::max(0.0, 60 * m_options.minutes - now));
    } else if (m_summary.asked > 0) {
      left = clockText(now / static_cast<double>(m_summary.asked) * std::max(0.0, rest));
    }
    std::fputs(
        fmt::format("{}verify: {} inputs tested, {} already in the store, {} elapsed, {} left{}", m_tty ? "\r" : "",
                    m_summary.asked, m_summary.skipped, clockText(now), left, m_tty && !last ? "   " : "\n")
            .c_str(),
        stderr);
    std::fflush(stderr);
  }

  const VerificationOptions& m_options;
  Store& m_store;
  Plan m_plan;
  const std::vector<Subject>& m_subjects;
  WorkerPool m_pool;
  bool m_tty;
  std::size_t m_subject = 0;
  const int m_blockSize = m_options.metamorphic ? kRelationsBlock : kVerifyBlock;
  long m_blocksPerJob = kBlocksPerJob, m_round = 0, m_block = 0;
  std::map<std::size_t, VerifyJob> m_jobs;
  std::map<std::size_t, Part> m_parts;  // running, by their index in the pool
  std::vector<Part> m_again;            // to be started
  std::size_t m_nextJob = 0, m_started = 0;
  VerificationSummary m_summary;
  Clock::time_point m_start = Clock::now();
  double m_shown = -60;
};

bool contains(const auto& list, const auto& value) { return std::find(list.begin(), list.end(), value) != list.end(); }

}  // namespace

std::vector<Spec> specsToVerify(const Registered& method) {
  std::vector<Spec> out = {{method.info.name, {}}};
  if (method.stage == StageKind::velocity) {
    if (method.info.role == AlgorithmRole::witness) return out;
    out = convergedResolvers(method.dimension);
    std::erase_if(out, [&](const Spec& spec) { return spec.name != method.info.name; });
    return out;
  }
  if (method.info.role != AlgorithmRole::witness) return out;
  for (const ParamInfo& p : method.params) {
    if (p.role != ParamRole::tolerance) continue;
    out.push_back(out.front());
    out.back().set(p.name, {fmt::format("{}", p.range->lo), {}});
  }
  for (const ParamInfo& p : method.params) {  // and where an engine would call it
    if (p.name != "frame" || !contains(p.choices, "world")) continue;
    out.push_back(out.front());
    out.back().set(p.name, {"world", {}});
  }
  return out;
}

void checkVerification(const VerificationOptions& options) {
  static_cast<void>(Plan(options));  // which rejects invalid ones
  for (const std::string& precision : options.precisions) checkWorker(precision, false);
}

VerificationSummary runVerification(const VerificationOptions& options, Store& store) {
  const InterruptGuard interrupts;
  return Verification(options, store).run();
}

Ledger ledgerOf(const VerificationOptions& options, Store& store) {
  std::vector<std::string> stages, methods;
  for (const StageKind stage : options.stages) stages.emplace_back(stageName(stage));
  for (const std::string& text : options.methods) methods.push_back(Spec::parse(text).text());
  Ledger out;
  for (const auto& [key, entry] : store.ledger()) {
    const bool asked = contains(stages, key.stage) && contains(options.precisions, key.precision) &&
                       contains(options.dimensions, key.dimension) &&
                       (methods.empty() || contains(methods, key.method)) &&
                       (!options.role || entry.role == *options.role);
    if (asked) out[key] = entry;
  }
  return out;
}

namespace {

// Files of an earlier store with this name would show failures that this store does not have. Other files belong to the
// user.
void removeOthers(const std::filesystem::path& folder, const std::set<std::string>& written) {
  static const std::regex ours(".+-[a-z_]+-[23]d-f(32|64)\\.json");
  std::vector<std::filesystem::path> stale;
  std::error_code ignored;
  for (std::filesystem::directory_iterator file(folder, ignored), end; file != end; file.increment(ignored)) {
    const std::string name = file->path().filename().string();
    if (!written.count(name) && std::regex_match(name, ours)) stale.push_back(file->path());
  }
  for (const auto& path : stale) std::filesystem::remove(path, ignored);
}

}  // namespace

std::vector<std::string> writeFoundCases(Store& store, const std::string& storePath) {
  namespace fs = std::filesystem;
  const fs::path folder = storePath + ".found";
  std::vector<std::string> out;
  std::set<std::string> written;
  const auto write = [&](const std::string& what, const std::map<std::string, std::string>& cases) {
    for (const auto& [name, text] : cases) {
      fs::create_directories(folder);
      const fs::path path = folder / (name + ".json");
      OutputFile file(path.string());
      file.stream() << "{\"schema\": {}, \"count\": 1, \"cases\": [\n" << text << "\n]}\n";
      file.finish();
      written.insert(path.filename().string());
      const bool again = text.find("\"again\": false") == std::string::npos;
      out.push_back(what + (again ? "" : ", which did not fail when repeated alone") + ": " + path.string());
    }
  };
  write("simplest pair of this failure", store.foundCases());
  write("worst pair of this method", store.worstCases());
  removeOthers(folder, written);
  return out;
}

}}  // namespace lpc::LPC_PRECISION
