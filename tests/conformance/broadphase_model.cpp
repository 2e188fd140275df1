// SPDX-License-Identifier: Zlib
#include "tests/conformance/broadphase_model.h"

#include <rapidcheck.h>

namespace lpc { inline namespace LPC_PRECISION { namespace test {

std::vector<Command> drawCommands() {
  return *rc::Gen<std::vector<Command>>([](const rc::Random& source, int size) {
    Random random(rc::Random(source).next());
    static constexpr std::array<std::pair<Command::Kind, int>, 10> weights = {{{Command::add, 600},
                                                                               {Command::remove, 200},
                                                                               {Command::move, 900},
                                                                               {Command::teleport, 200},
                                                                               {Command::refilter, 200},
                                                                               {Command::sleepOrWake, 300},
                                                                               {Command::lose, 5},
                                                                               {Command::update, 200},
                                                                               {Command::spawnMany, 3},
                                                                               {Command::clear, 1}}};
    int total = 0;
    for (const auto& w : weights) total += w.second;
    std::vector<Command> list(random.below(static_cast<std::uint64_t>(std::min(4000, 80 * size)) + 1));
    for (Command& c : list) {
      auto at = static_cast<int>(random.below(static_cast<std::uint64_t>(total)));
      for (const auto& [kind, weight] : weights) {
        c.kind = kind;
        if ((at -= weight) < 0) break;
      }
      c.bits = random.next();
    }
    return rc::shrinkable::shrinkRecur(
        std::move(list), [](const std::vector<Command>& longer) { return rc::shrink::removeChunks(longer); });
  });
}

}}}  // namespace lpc::LPC_PRECISION::test
