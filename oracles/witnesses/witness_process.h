// SPDX-License-Identifier: Zlib
// A witness with its library in a separate process, which lives as long as the witness. Parent and child share one
// block of memory and no file descriptor, so that other children inherit nothing. Pairs are passed in blocks. The child
// notes the current pair before each call, and the parent watches this note. A crash, or no progress, is recorded for
// that pair, and a new child continues with the next one.
#pragma once

#include <memory>
#include <vector>

#include "oracles/witnesses/witness.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Frame in which the library gets a pair. `own`: A's own frame, with A at the origin. `world`: both are rotated and
/// about two sizes from the origin, as in an engine. Some libraries (FCL) are right in one and wrong in the other.
enum class PairFrame { own, world };
struct PairFrameParams {
  PairFrame frame = PairFrame::own;
  void visit(ParamVisitor& v) {
    v.choice("frame", frame, {"own", "world"},
             "frame of the query: A's own frame, or a rotated and translated world frame");
  }
};

template <int D>
class IsolatedWitness : public Witness<D> {
 public:
  explicit IsolatedWitness(PairFrame frame = PairFrame::own);
  ~IsolatedWitness() override;

  void query(std::span<const PairView<D>> pairs, QueryNeed need, std::span<PairAnswer<D>> answers,
             std::span<PairMemory> memory, WorkDone& work) final;
  std::span<const Ending> endings() const final { return m_endings; }
  std::int64_t nanoseconds() const final { return m_nanoseconds; }
  std::optional<Question> question(const PairView<D>& pair) final;

  /// Queries any number of pairs of supported kinds. Fills `answers`, of the same length, and `endings`.
  void ask(std::span<const PairView<D>> pairs, std::span<PairAnswer<D>> answers);

 protected:
  // Poses in the frame of the library's input, in the unit of `place`; the answer is in this frame and unit too.
  const Pose<D>& placeOfA() const { return m_X_WA; }
  Pose<D> placeOfB(const PairView<D>& pair) const { return m_frame == PairFrame::own ? pair.X_AB : m_X_WA * pair.X_AB; }

  // Both run in the child and may throw, abort, crash or never return. Pair and answer are in a unit in which the
  // larger shape is about 1, because these libraries have absolute thresholds for shapes of about a metre. The unit is
  // a power of two, which costs no digit. A 3D hull has vertices, faces and loop, but no edges.
  virtual void place(const PairView<D>& pair) = 0;  // converts the pair for the library; not timed
  virtual PairAnswer<D> measure() = 0;              // the library's answer
  // Both steps as a program, for a pair in this unit. Runs in the parent and does not call the library.
  virtual Snippet snippet(const PairView<D>&) const { return {}; }

 private:
  class Process;
  PairFrame m_frame;
  Pose<D> m_X_WA;
  std::unique_ptr<Process> m_process;
  std::vector<Ending> m_endings;
  std::int64_t m_nanoseconds = 0;
};

}}  // namespace lpc::LPC_PRECISION
