// SPDX-License-Identifier: Zlib
// A saved world with a valid checksum is rejected, or it steps and can be saved.
#include <cstring>
#include <filesystem>
#include <fstream>

#include "tests/fuzz/damaged_world.h"
#include "tests/fuzz/target.h"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

namespace lpc { inline namespace LPC_PRECISION {

// The first byte chooses dimension and pipeline; the rest is the payload after the header.
void fuzz(std::string_view input) {
  if (input.empty()) return;
  const auto choice = static_cast<unsigned char>(input[0]);
  const char* pipeline = test::kDamagedPipelines[choice / 2 % test::kDamagedPipelines.size()];
  const std::string payload(input.substr(1));
  const test::Life life =
      choice % 2 ? test::livesOn<3>(payload, pipeline, false) : test::livesOn<2>(payload, pipeline, false);
  demand(life.fault.empty(), life.fault.c_str());
}

namespace {

template <int D>
void writeSeeds(const std::filesystem::path& folder) {
  for (std::size_t i = 0; i < test::kDamagedPipelines.size(); ++i) {
    const char choice = static_cast<char>(2 * i + (D == 3));
    std::ofstream(folder / (std::to_string(D) + "_" + std::to_string(i))) << choice << test::payloadOf<D>(i);
  }
}

}  // namespace
}}  // namespace lpc::LPC_PRECISION

// --seeds FOLDER writes the undamaged inputs and exits.
extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  if (*argc == 3 && std::string_view((*argv)[1]) == "--seeds") {
    lpc::writeSeeds<2>((*argv)[2]), lpc::writeSeeds<3>((*argv)[2]);
    std::exit(0);
  }
  return 0;
}

// Mostly writes an extreme value: a shift of the following bytes is rejected early.
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most, unsigned seed) {
  lpc::Random random(seed);
  if (size < 2 || random.below(5) == 0) return LLVMFuzzerMutate(data, size, most);
  std::string payload(reinterpret_cast<const char*>(data) + 1, size - 1);
  lpc::test::putEdge(payload, random);
  std::memcpy(data + 1, payload.data(), payload.size());
  return size;
}
