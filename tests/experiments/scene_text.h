// SPDX-License-Identifier: Zlib
// Scenes as text, and the messages of their reader.
#pragma once

#include <gtest/gtest.h>

#include "experiments/trial/scene/scene_file.h"
#include "framework/math/check.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test {

using Parts = std::vector<std::string>;
struct BadScene {
  std::string text;
  Parts parts;
};

inline const std::string kHead = "name = \"t\"\nsummary = \"s\"\ndimensions = [2, 3]\n";  // lines 1 to 3
inline const std::string kBall = "shapes = [{ kind = \"circle\", radius = 1 }]\n";
inline const std::string kNamed = "[[body]]\nname = \"a\"\n" + kBall;  // lines 4 to 6 without a preceding block
inline const std::string kPivot = "[[joint]]\nkind = \"pivot\"\na = \"world\"\nb = \"a\"\nanchor = [0, 0]\n";

inline std::string placed(const std::string& expression) {
  return "[[body]]\nposition = [\"" + expression + "\", 0]\n" + kBall;
}

template <int D>
std::string messageOf(const std::string& text) {
  try {
    SceneFile::parse(kHead + text, "t.toml").build<D>({}, 1);
  } catch (const UserError& e) {
    return e.what();
  }
  return "no error";
}

template <int D>
void refused(const std::vector<BadScene>& cases) {
  for (const BadScene& c : cases) {
    const std::string message = messageOf<D>(c.text);
    for (const std::string& part : c.parts) {
      EXPECT_NE(message.find(part), message.npos) << c.text.substr(0, 400) << "\n" << message;
    }
    EXPECT_EQ(message.find('\n'), message.npos) << message;
    EXPECT_LT(message.size(), 1600u);
  }
}
inline void refused(const std::vector<BadScene>& cases) { refused<2>(cases), refused<3>(cases); }

}}}  // namespace lpc::LPC_PRECISION::test
