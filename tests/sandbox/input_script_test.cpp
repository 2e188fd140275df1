// SPDX-License-Identifier: Zlib
// Which orders of an input file are valid: every order with numbers that are none, too large, missing and extra.
#include "experiments/sandbox/input_script.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "framework/math/check.h"
#include "tests/experiments/workspace.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace input_script_test { namespace {

// Empty if the script is valid.
std::string messageOf(const Workspace& w, const std::string& order) {
  w.write("s.txt", "wait 1\n" + order + "\n");
  try {
    const InputScript script(w.path("s.txt"));
    return "";
  } catch (const UserError& e) {
    return e.what();
  }
}

TEST(InputScript, RefusesNumbersOutOfRange) {
  const Workspace w;
  struct Numbers {
    const char *order, *valid;
    int count;
    bool whole;
  };
  const Numbers orders[] = {{"at", "1", 2, false},    {"at", "-2.5", 3, false}, {"pixel", "30.5", 2, false},
                            {"wheel", "-2", 1, true}, {"wait", "0", 1, true},   {"until", "90", 1, true},
                            {"size", "640", 2, true}};
  for (const Numbers& n : orders) {
    for (int bad = -1; bad < n.count; ++bad) {
      for (const char* word : {"nan", "-nan", "inf", "-inf", "1e30", "-1e30", "1x", "", "one", "1.5", "0x", "-1e9"}) {
        std::string order = n.order;
        for (int i = 0; i < n.count; ++i) order += std::string(" ") + (i == bad ? word : n.valid);
        if (bad >= 0 && std::string(word).empty() && n.count == 3) continue;  // two coordinates are valid
        const bool valid = bad < 0 || (std::string(word) == "1.5" && !n.whole);
        const std::string said = messageOf(w, order);
        EXPECT_EQ(said.empty(), valid) << order << ": " << said;
        if (valid) continue;
        EXPECT_NE(said.find("s.txt:2: '" + std::string(n.order) + "' has "), said.npos) << said;
        EXPECT_NE(said.find("; valid: "), said.npos) << said;
      }
    }
  }
}

TEST(InputScript, RefusesWhatAnOrderCannotDo) {
  const Workspace w;
  for (const char* bad :
       {"size 0 0",   "size 8001 600", "size 640",   "wait -1", "until -1",         "wheel", "wheel 1 2", "at 1",
        "at 1 2 3 4", "pixel 1",       "shot x.jpg", "shot",    "shot a.png b.png", "press", "quit now",  "key",
        "state",      "drop",          "type",       "on"}) {
    const std::string said = messageOf(w, bad);
    EXPECT_NE(said.find("; valid: "), said.npos) << bad << ": " << said;
  }
  for (const char* good : {"shot x.png", "state x.json", "quit", "key Left Ctrl", "on World/Pause", "press left"}) {
    EXPECT_EQ(messageOf(w, good), "") << good;
  }
}

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::input_script_test
