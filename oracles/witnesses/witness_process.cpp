// SPDX-License-Identifier: Zlib
#include "oracles/witnesses/witness_process.h"

#include <fcntl.h>
#include <semaphore.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <ctime>
#include <limits>
#include <system_error>

#include "framework/math/check.h"
#include "framework/shape/curved_core.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

constexpr std::size_t kBlock = 1000;                // pairs per block
constexpr std::size_t kHullBytes = 8 << 20;         // initial space for their hulls
constexpr std::int64_t kBusyLimit = 500'000'000;    // ns of its own processor time on one pair: the child hangs
constexpr std::int64_t kIdleLimit = 3'000'000'000;  // ns of wall time, for a child that sleeps; a loaded machine does
                                                    // not count as a hang
constexpr int kVainStarts = 3;

// Both processes see the shared memory at the same address, so pointers into it are valid in both.
template <int D>
struct StoredHull;

template <>
struct StoredHull<2> {
  std::span<const Vec<2>> vertices, normals;

  void restore(Polytope<2>& hull) const {
    hull.vertices.assign(vertices.begin(), vertices.end());
    hull.normals.assign(normals.begin(), normals.end());
  }
};

template <>
struct StoredHull<3> {
  std::span<const Vec<3>> vertices;
  std::span<const Polytope<3>::Face> faces;
  std::span<const int> loop;

  void restore(Polytope<3>& hull) const {
    hull.vertices.assign(vertices.begin(), vertices.end());
    hull.faces.assign(faces.begin(), faces.end());
    hull.loop.assign(loop.begin(), loop.end());
  }
};

// A power of two, as a unit in which the larger shape is about 1; 1 for shapes without size.
template <int D>
Real unitFor(const PairView<D>& pair) {
  int exponent = 0;
  const Real size = std::max(boundingRadius(pair.a), boundingRadius(pair.b));
  if (std::isfinite(size)) std::frexp(size, &exponent);
  return std::ldexp(Real(1), exponent);
}

// hull: storage for the scaled hull.
template <int D>
void divide(ShapeView<D>& shape, Polytope<D>& hull, Real unit) {
  shape.radius /= unit, shape.half /= unit;
  if (!shape.hull) return;
  for (Vec<D>& v : hull.vertices) v /= unit;
  if constexpr (D == 3) {
    for (auto& face : hull.faces) face.offset /= unit;
  }
  shape.hull = &hull;
}

// The sizes of a curved core, from which the child builds it again.
template <int D>
struct StoredSizes {
  static constexpr std::size_t kMost = 8;
  std::array<Real, kMost> values{};
  std::size_t count = 0;

  explicit StoredSizes(const CurvedCore<D>* core = nullptr) {
    if (!core) return;
    LPC_ASSERT(core->sizes().size() <= kMost);
    count = core->sizes().size();
    std::copy(core->sizes().begin(), core->sizes().end(), values.begin());
  }
  std::shared_ptr<const CurvedCore<D>> restore(ShapeView<D>& shape, Real unit) const {
    if (!shape.curved) return nullptr;
    std::array<Real, kMost> scaled = values;
    for (Real& size : scaled) size /= unit;
    const auto core = curvedKind<D>(shape.kind).create({scaled.data(), count});
    shape.curved = core.get();
    return core;
  }
};

template <int D>
struct StoredPair {
  PairView<D> view;
  Real unit = 1;
  StoredHull<D> hullA, hullB;
  StoredSizes<D> sizesA, sizesB;
};

template <int D>
struct Block {
  sem_t asked, answered;
  // Pairs begun and pairs done, counted by the child; the parent corrects `done` when the child has died.
  std::atomic<int> begun = 0, done = 0;
  int count = 0;
  std::array<StoredPair<D>, kBlock> pairs;
  std::array<PairAnswer<D>, kBlock> answers;
  std::array<Ending, kBlock> endings{};
  std::array<std::int64_t, kBlock> nanoseconds{};
};
static_assert(std::atomic<int>::is_always_lock_free, "or it would not work between processes");

// Space for hulls, stored one after another.
struct HullSpace {
  std::byte* next;
  std::byte* end;

  template <class T>
  static std::size_t bytes(const std::vector<T>& items) {
    static_assert(alignof(T) <= alignof(double));
    return (items.size() * sizeof(T) + alignof(double) - 1) / alignof(double) * alignof(double);
  }
  static std::size_t bytes(const Polytope<2>& hull) { return bytes(hull.vertices) + bytes(hull.normals); }
  static std::size_t bytes(const Polytope<3>& hull) {
    return bytes(hull.vertices) + bytes(hull.faces) + bytes(hull.loop);
  }
  template <int D>
  static std::size_t bytes(const PairView<D>& pair) {
    return (pair.a.hull ? bytes(*pair.a.hull) : 0) + (pair.b.hull ? bytes(*pair.b.hull) : 0);
  }
  template <class T>
  std::span<const T> put(const std::vector<T>& items) {
    T* const first = reinterpret_cast<T*>(next);
    std::uninitialized_copy(items.begin(), items.end(), first);
    next += bytes(items);
    return {first, items.size()};
  }
  StoredHull<2> put(const Polytope<2>* hull) {
    if (!hull) return {};
    return {put(hull->vertices), put(hull->normals)};
  }
  StoredHull<3> put(const Polytope<3>* hull) {
    if (!hull) return {};
    return {put(hull->vertices), put(hull->faces), put(hull->loop)};
  }
};

template <int D>
bool isFinite(const PairAnswer<D>& a) {
  return std::isfinite(a.distance) && a.normal.allFinite() && a.pA.allFinite() && a.pB.allFinite();
}

template <int D>
PairAnswer<D> failure() {
  PairAnswer<D> a;
  a.status = QueryStatus::failed;
  return a;
}

std::int64_t nanosecondsOf(clockid_t clock) {
  timespec t{};
  return clock_gettime(clock, &t) == 0 ? std::int64_t{1'000'000'000} * t.tv_sec + t.tv_nsec : 0;
}
std::int64_t processorTime(pid_t process) {
  clockid_t clock{};
  return clock_getcpuclockid(process, &clock) == 0 ? nanosecondsOf(clock) : 0;
}

}  // namespace

std::string_view endingName(Ending ending) {
  constexpr std::array<std::string_view, 5> kNames = {"answered", "not_finite", "threw", "crashed", "hung"};
  return kNames[static_cast<std::size_t>(ending)];
}

template <int D>
class IsolatedWitness<D>::Process {
 public:
  explicit Process(IsolatedWitness& witness) : m_witness(witness) {}
  ~Process() { release(); }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  void run(std::span<const PairView<D>> pairs, std::span<PairAnswer<D>> answers, std::span<Ending> endings,
           std::int64_t& nanoseconds) {
    if (m_owner != getpid()) release();  // in a forked copy of the witness: the child belongs to the original
    for (std::size_t begin = 0; begin < pairs.size();) {
      const std::size_t count = fill(pairs.subspan(begin));
      answerBlock();
      for (std::size_t i = 0; i < count; ++i) {
        answers[begin + i] = m_block->answers[i];
        endings[begin + i] = m_block->endings[i];
        nanoseconds += m_block->nanoseconds[i];
      }
      begin += count;
    }
  }

 private:
  // Puts as many pairs into the shared memory as fit: at least one.
  std::size_t fill(std::span<const PairView<D>> pairs) {
    const std::size_t first = HullSpace::bytes(pairs[0]);
    if (!m_block || first > m_hullBytes) {
      release();
      m_hullBytes = std::max(first, kHullBytes);
      map();
    }
    HullSpace space{reinterpret_cast<std::byte*>(m_block + 1), reinterpret_cast<std::byte*>(m_block + 1) + m_hullBytes};
    std::size_t count = 0;
    for (; count < pairs.size() && count < kBlock; ++count) {
      const PairView<D>& pair = pairs[count];
      const auto room = static_cast<std::size_t>(space.end - space.next);
      if (HullSpace::bytes(pair) > room) break;
      m_block->pairs[count] = {pair,
                               unitFor(pair),
                               space.put(pair.a.hull),
                               space.put(pair.b.hull),
                               StoredSizes<D>(pair.a.curved),
                               StoredSizes<D>(pair.b.curved)};
    }
    m_block->count = static_cast<int>(count);
    return count;
  }

  void answerBlock() {
    m_block->begun = m_block->done = 0;
    for (int vain = 0;;) {
      if (m_child < 0) start();
      sem_post(&m_block->asked);
      const Ending ending = watch();
      if (ending == Ending::answered) return;
      stop();
      // The child died before it began a pair (by a signal from outside, or with the thread that forked it). No pair is
      // at fault, so a new child gets the same block; at most kVainStarts times.
      if (m_block->begun <= m_block->done && ++vain < kVainStarts) continue;
      vain = 0;
      const int at = m_block->done++;
      m_block->begun.store(at + 1);
      const auto i = static_cast<std::size_t>(at);
      m_block->answers[i] = failure<D>(), m_block->endings[i] = ending, m_block->nanoseconds[i] = 0;
      if (at + 1 >= m_block->count) return;
    }
  }

  // How the block, or the current pair, ended.
  Ending watch() {
    int seen = -1;
    std::int64_t busy = 0, idle = 0;  // times when progress was last seen
    for (;;) {
      timespec until{};
      clock_gettime(CLOCK_MONOTONIC, &until);
      until.tv_nsec += 1'000'000;
      if (until.tv_nsec >= 1'000'000'000) until.tv_nsec -= 1'000'000'000, ++until.tv_sec;
      if (sem_clockwait(&m_block->answered, CLOCK_MONOTONIC, &until) == 0) return Ending::answered;
      if (waitpid(m_child, nullptr, WNOHANG) != 0) {
        m_child = -1;
        return Ending::crashed;
      }
      const int begun = m_block->begun;
      const std::int64_t busyNow = processorTime(m_child), idleNow = nanosecondsOf(CLOCK_MONOTONIC);
      if (begun != seen) {
        seen = begun, busy = busyNow, idle = idleNow;
      } else if (busyNow - busy > kBusyLimit || idleNow - idle > kIdleLimit) {
        return Ending::hung;
      }
    }
  }

  void start() {
    // A killed child may have left the semaphores in any state.
    sem_init(&m_block->asked, 1, 0);
    sem_init(&m_block->answered, 1, 0);
    m_child = fork();
    if (m_child < 0) throw std::system_error(errno, std::generic_category(), "cannot start a process for a witness");
    if (m_child == 0) serve();
  }

  [[noreturn]] void serve() {
    // The child dies with its parent, ignores Ctrl-C, writes nothing, and keeps none of the parent's files open.
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != m_owner) _exit(0);
    prctl(PR_SET_NAME, "lpc-witness");
    std::signal(SIGINT, SIG_IGN);
    std::signal(SIGTERM, SIG_IGN);
    const rlimit none{0, 0};
    setrlimit(RLIMIT_CORE, &none);
    const int nowhere = open("/dev/null", O_RDWR);
    for (int fd = 0; fd < 3; ++fd) dup2(nowhere, fd);
    close_range(3, ~0u, 0);

    Polytope<D> hullA, hullB;
    for (;;) {
      while (sem_wait(&m_block->asked) != 0) continue;
      for (int i = m_block->done; i < m_block->count; ++i) {
        m_block->begun.store(i + 1);
        answer(static_cast<std::size_t>(i), hullA, hullB);
        m_block->done.store(i + 1);
      }
      sem_post(&m_block->answered);
    }
  }

  void answer(std::size_t i, Polytope<D>& hullA, Polytope<D>& hullB) {
    using Clock = std::chrono::steady_clock;
    const StoredPair<D>& stored = m_block->pairs[i];
    PairView<D> pair = stored.view;
    stored.hullA.restore(hullA), stored.hullB.restore(hullB);
    divide(pair.a, hullA, stored.unit), divide(pair.b, hullB, stored.unit);
    const auto coreA = stored.sizesA.restore(pair.a, stored.unit), coreB = stored.sizesB.restore(pair.b, stored.unit);
    pair.X_AB.p /= stored.unit;
    PairAnswer<D> answer = failure<D>();
    Ending ending = Ending::threw;
    Clock::time_point before = Clock::now(), after = before;
    try {
      m_witness.place(pair);
      before = after = Clock::now();
      answer = m_witness.measure();
      after = Clock::now();
      if (m_witness.m_frame == PairFrame::world) {
        const Pose<D> X_AW = m_witness.placeOfA().inverse();
        answer.normal = X_AW.q * answer.normal, answer.pA = X_AW * answer.pA, answer.pB = X_AW * answer.pB;
      }
      answer.distance *= stored.unit, answer.pA *= stored.unit, answer.pB *= stored.unit;
      ending = isFinite(answer) ? Ending::answered : Ending::notFinite;
    } catch (...) {
      after = Clock::now();
    }
    m_block->answers[i] = ending == Ending::answered ? answer : failure<D>();
    m_block->endings[i] = ending;
    m_block->nanoseconds[i] = std::chrono::nanoseconds(after - before).count();
  }

  void stop() {
    if (m_child > 0) {
      kill(m_child, SIGKILL);
      waitpid(m_child, nullptr, 0);
    }
    m_child = -1;
  }

  void map() {
    void* memory = mmap(nullptr, sizeof(Block<D>) + m_hullBytes, PROT_READ | PROT_WRITE,
                        MAP_SHARED | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (memory == MAP_FAILED)
      throw std::system_error(errno, std::generic_category(), "no memory for a witness's process");
    m_block = new (memory) Block<D>;
    m_owner = getpid();
  }

  void release() {
    if (m_owner == getpid()) stop();
    m_child = -1;
    if (m_block) munmap(m_block, sizeof(Block<D>) + m_hullBytes);
    m_block = nullptr;
  }

  IsolatedWitness& m_witness;
  Block<D>* m_block = nullptr;  // followed by m_hullBytes for hulls
  std::size_t m_hullBytes = 0;
  pid_t m_owner = -1, m_child = -1;
};

namespace {

// Not along any axis, and without round coordinates.
Pose<2> somewhere(Vec<2>) { return {{Real(1.7), Real(-2.3)}, Rot<2>::angle(Real(0.7))}; }
Pose<3> somewhere(Vec<3>) {
  return {{Real(1.7), Real(-2.3), Real(0.9)}, Rot<3>{Real(0.8), Real(0.3), Real(-0.4), Real(0.33)}.normalized()};
}

}  // namespace

template <int D>
IsolatedWitness<D>::IsolatedWitness(PairFrame frame)
    : m_frame(frame),
      m_X_WA(frame == PairFrame::own ? Pose<D>{} : somewhere(Vec<D>())),
      m_process(std::make_unique<Process>(*this)) {}
template <int D>
IsolatedWitness<D>::~IsolatedWitness() = default;

template <int D>
void IsolatedWitness<D>::query(std::span<const PairView<D>> pairs, QueryNeed, std::span<PairAnswer<D>> answers,
                               std::span<PairMemory>, WorkDone& work) {
  work[WorkCount::pairQueries] += pairs.size();
  ask(pairs, answers);
}

template <int D>
void IsolatedWitness<D>::ask(std::span<const PairView<D>> pairs, std::span<PairAnswer<D>> answers) {
  m_endings.assign(pairs.size(), Ending::answered);
  m_nanoseconds = 0;
  m_process->run(pairs, answers, m_endings, m_nanoseconds);
}

template <int D>
std::optional<Question> IsolatedWitness<D>::question(const PairView<D>& pair) {
  const Real unit = unitFor(pair);
  Question out{.snippet = {}, .unit = static_cast<double>(unit), .truth = {}};
  PairView<D> scaled = pair;
  Polytope<D> hullA, hullB;
  if (pair.a.hull) hullA = *pair.a.hull;
  if (pair.b.hull) hullB = *pair.b.hull;
  const StoredSizes<D> sizesA(pair.a.curved), sizesB(pair.b.curved);
  divide(scaled.a, hullA, unit), divide(scaled.b, hullB, unit);
  const auto coreA = sizesA.restore(scaled.a, unit), coreB = sizesB.restore(scaled.b, unit);
  scaled.X_AB.p /= unit;
  out.snippet = snippet(scaled);
  if (out.snippet.body.empty()) return std::nullopt;
  PairTruth<D> known = pairTruth<D>(scaled);
  if (m_frame == PairFrame::world) known.answer = referee<D>(scaled.a, placeOfA(), scaled.b, placeOfB(scaled));
  out.truth = {known.answer.decided, known.answer.lo, known.answer.hi},
  out.allowed = verifyTolerance<D>(this) * known.s;
  if (const double rounding = out.snippet.rounding; rounding > 0) {  // interval of the cores, rounded outwards
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    out.truth.lo = std::nextafter(out.truth.lo + rounding, -kInfinity);
    out.truth.hi = std::nextafter(out.truth.hi + rounding, kInfinity);
  }
  return out;
}

template class IsolatedWitness<2>;
template class IsolatedWitness<3>;

}}  // namespace lpc::LPC_PRECISION
