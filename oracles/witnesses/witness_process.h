// SPDX-License-Identifier: Zlib
// A witness whose library runs in a process of its own, as long as the witness lives. Parent and child share one block
// of memory and no file descriptor, so that nothing leaks into other children. Pairs go in by blocks; the child notes
// which pair it has in hand before each call, and the parent watches that note: a crash, or no progress, is booked to
// that pair, and a new child goes on with the next one.
#pragma once

#include <memory>
#include <vector>

#include "oracles/witnesses/witness.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Where the library is shown a pair: A in its own frame, at the origin, or both somewhere in a world, turned and about
/// two sizes from its origin, as an engine would ask. Some (FCL) are right in the one and wrong in the other.
enum class PairFrame { own, world };
struct PairFrameParams {
  PairFrame frame = PairFrame::own;
  void visit(ParamVisitor& v) {
    v.choice("frame", frame, {"own", "world"},
             "where both shapes are shown: A's own frame, or turned and away from it");
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

  /// Any number of pairs, of any kinds that are supported. Fills `answers`, of the same length, and `endings`.
  void ask(std::span<const PairView<D>> pairs, std::span<PairAnswer<D>> answers);

 protected:
  // Poses in the frame that the library is shown, in the unit of `place`: the answer is given in it, too.
  const Pose<D>& placeOfA() const { return m_X_WA; }
  Pose<D> placeOfB(const PairView<D>& pair) const { return m_frame == PairFrame::own ? pair.X_AB : m_X_WA * pair.X_AB; }

  // Both run in the child and may throw, abort, fault or never return. The pair comes in a unit in which the larger
  // shape is about 1, and the answer is taken in that unit, because these libraries have absolute thresholds for shapes
  // of about a metre. The unit is a power of two: it costs no digit. A hull of 3D has vertices, faces and loop, but no
  // edges.
  virtual void place(const PairView<D>& pair) = 0;  // the pair in the library's own terms; not timed
  virtual PairAnswer<D> measure() = 0;              // the library's answer to it
  // Both of these as a program, of a pair in that unit; runs in the parent and calls nothing of the library.
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
