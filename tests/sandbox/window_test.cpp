// SPDX-License-Identifier: Zlib
// The window itself, and what a user's own program gets from it.
#include "experiments/sandbox/window.h"

#include <SDL2/SDL.h>
#include <gtest/gtest.h>
#include <imgui.h>

#include <cstdlib>

#include "experiments/sandbox/view.h"
#include "framework/world/world.h"
#include "tests/check_property.h"
#include "tests/sandbox/shown.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace window_test { namespace {

void push(SDL_Event event) { ASSERT_EQ(SDL_PushEvent(&event), 1); }
void pushKey(SDL_Keycode key) {
  SDL_Event event{};
  event.type = SDL_KEYDOWN;
  event.key.keysym.sym = key;
  push(event);
}

// Draws half of the window red.
void drawHalf(Window& window) {
  ViewCamera<2> camera;
  camera.resize(window.width(), window.height());
  GlCanvas<2> canvas;
  shown<2>(window, canvas, camera, [](DebugDraw<2>& draw) {
    Pose<2> X;
    X.p = {-1000, 0};
    draw.shape(Shape<2>::box({1000, 1000}).view(), X, {{220, 0, 0}, {220, 0, 0}});
  });
}

TEST(Window, ShowsWhatIsDrawn) {
  Window window("test", 300, 200);
  drawHalf(window);
  const auto picture = window.screenshot();
  EXPECT_TRUE(isRed(picture.at(20, 20)));
  EXPECT_TRUE(isPaper(picture.at(280, 20)));
  EXPECT_EQ(picture.width, 300);
  EXPECT_EQ(picture.height, 200);
}

TEST(Window, FollowsItsSize) {
  Window window("test", 300, 200);
  drawHalf(window);
  SDL_SetWindowSize(SDL_GetWindowFromID(1) ? SDL_GetWindowFromID(1) : SDL_GL_GetCurrentWindow(), 400, 260);
  for (SDL_Event event; window.poll(event);) {
  }
  drawHalf(window);  // with the camera of the previous size
  drawHalf(window);
  EXPECT_EQ(window.width(), 400);
  const auto picture = window.screenshot();
  EXPECT_EQ(picture.height, 260);
  EXPECT_TRUE(isRed(picture.at(190, 250)));
  EXPECT_TRUE(isPaper(picture.at(210, 250)));
}

TEST(Window, OneAfterAnother) {
  for (int k = 0; k < 3; ++k) {
    Window window("test", 100 + k, 100);
    drawHalf(window);
    EXPECT_TRUE(isRed(window.screenshot().at(20, 20))) << k;
  }
}

TEST(Window, TakesFilesAndSeparatesPanelInput) {
  Window window("test", 300, 200);
  SDL_Event drop{};
  drop.type = SDL_DROPFILE;
  drop.drop.file = SDL_strdup("scene.toml");
  push(drop);
  for (SDL_Event event; window.poll(event);) {
  }
  EXPECT_EQ(window.takeDropped(), std::vector<std::string>{"scene.toml"});
  EXPECT_TRUE(window.takeDropped().empty());

  SDL_Event click{};
  click.type = SDL_MOUSEBUTTONDOWN;
  bool over = false;
  for (const float x : {50.0f, 250.0f}) {
    for (int frame = 0; frame < 3; ++frame) {  // ImGui reports the previous frame
      window.beginFrame();
      ImGui::SetNextWindowPos({0, 0});
      ImGui::SetNextWindowSize({100, 200});
      ImGui::Begin("panel");
      ImGui::End();
      ImGui::GetIO().MousePos = {x, 100};
      window.endFrame();
    }
    ImGui::GetIO().MousePos = {x, 100};
    ImGui::NewFrame();
    ImGui::EndFrame();
    over = window.forPanels(click);
    EXPECT_EQ(over, x < 100) << x;
  }
}

// Opens a window in its own process, because a driver is chosen once per process; prints the error.
[[noreturn]] void openAs(const char* name, const char* value) {
  value ? setenv(name, value, 1) : unsetenv(name);
  try {
    Window window("test", 100, 100);
  } catch (const UserError& e) {
    std::fprintf(stderr, "said: %s\n", e.what());
    std::_Exit(2);
  }
  std::_Exit(0);
}
TEST(Window, SaysInOneLineWhyThereIsNone) {
  testing::GTEST_FLAG(death_test_style) = "threadsafe";
  EXPECT_EXIT(openAs("DISPLAY", nullptr), testing::ExitedWithCode(2),
              "^said: no window: SDL says 'x11 not available'; valid: a display, such as DISPLAY=:0\n$");
  EXPECT_EXIT(openAs("DISPLAY", "here"), testing::ExitedWithCode(2),
              "^said: no window: SDL says [^\n]*; valid: [^\n]*\n$");
  EXPECT_EXIT(openAs("MESA_GL_VERSION_OVERRIDE", "3.0"), testing::ExitedWithCode(2),
              "^said: no window: it needs OpenGL 3.3, SDL says [^\n]*; valid: [^\n]*LIBGL_ALWAYS_SOFTWARE=1\n$");
}

template <int D>
void viewed() {
  World<D> world(Pipeline::parse("solver=split_solver"));
  BodyDef<D> ball;
  ball.shapes = {{.shape = Shape<D>::sphere(1)}};
  world.add(ball);
  ASSERT_EQ(SDL_InitSubSystem(SDL_INIT_EVENTS), 0);
  for (const SDL_Keycode key : {SDLK_p, SDLK_SPACE, SDLK_RIGHT, SDLK_f, SDLK_ESCAPE}) pushKey(key);
  view(world, Real(1) / 60);
  EXPECT_EQ(world.stepCount(), 2);
  SDL_QuitSubSystem(SDL_INIT_EVENTS);
  EXPECT_THROW(view(world, Real(0)), UserError);
}
TEST(View, StepsWhenItIsToldTo) {
  viewed<2>();
  viewed<3>();
}

}  // namespace
}}}}  // namespace lpc::LPC_PRECISION::test::window_test
