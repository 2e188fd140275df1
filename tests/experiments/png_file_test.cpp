// SPDX-License-Identifier: Zlib
// Pictures as files: a written file reads back equal, and a file that cannot be written completely is not written.
#include "experiments/film/png_file.h"

#include <gtest/gtest.h>
#include <png.h>
#include <sys/resource.h>

#include <csignal>
#include <filesystem>

#include "experiments/parse/toml_reader.h"
#include "experiments/trial/formats/output_file.h"
#include "framework/math/random.h"
#include "tests/experiments/workspace.h"

namespace lpc { inline namespace LPC_PRECISION { namespace png_file_test { namespace {

using namespace test;

constexpr int kWidth = 61, kHeight = 40;

// No two equal pixels, so that compression saves nothing: 7 kB.
std::vector<unsigned char> noise() {
  Random random(1);
  std::vector<unsigned char> out(3 * kWidth * kHeight);
  for (unsigned char& x : out) x = static_cast<unsigned char>(random.below(256));
  return out;
}

TEST(PngFile, IsReadAsItWasWritten) {
  const Workspace w;
  const std::string path = w.path("a.png");
  writePng(path, kWidth, kHeight, noise());
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  ASSERT_TRUE(png_image_begin_read_from_file(&image, path.c_str()));
  image.format = PNG_FORMAT_RGB;
  std::vector<unsigned char> read(PNG_IMAGE_SIZE(image));
  ASSERT_TRUE(png_image_finish_read(&image, nullptr, read.data(), 0, nullptr));
  EXPECT_EQ(image.width, static_cast<png_uint_32>(kWidth));
  EXPECT_EQ(read, noise());
}

// Limits the size of files, as a full disk does.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) : m_handler(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &m_before);
    const rlimit now{bytes, m_before.rlim_max};
    setrlimit(RLIMIT_FSIZE, &now);
  }
  ~FullDisk() {
    setrlimit(RLIMIT_FSIZE, &m_before);
    std::signal(SIGXFSZ, m_handler);
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;

 private:
  rlimit m_before{};
  void (*m_handler)(int);
};

std::string refusal(const std::string& path) {
  try {
    writePng(path, kWidth, kHeight, noise());
  } catch (const CannotWrite& e) {
    return e.what();
  }
  return "";
}

TEST(PngFile, IsWrittenCompletelyOrNotAtAll) {
  const Workspace w;
  EXPECT_EQ(refusal(w.path("nowhere/a.png")),
            w.path("nowhere/a.png") + ": cannot be written: No such file or directory");
  w.write("a.png", "what was there");
  {
    const FullDisk full(1000);
    EXPECT_EQ(refusal(w.path("a.png")), w.path("a.png") + ": cannot be written: File too large");
    EXPECT_EQ(refusal(w.path("b.png")), w.path("b.png") + ": cannot be written: File too large");
  }
  EXPECT_EQ(readFile(w.path("a.png")), "what was there");
  const std::filesystem::directory_iterator all(w.path(""));
  EXPECT_EQ(std::distance(begin(all), end(all)), 1) << "something half-written stayed";
}

}  // namespace
}}}  // namespace lpc::LPC_PRECISION::png_file_test
