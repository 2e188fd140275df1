// SPDX-License-Identifier: Zlib
#include "experiments/sandbox/view.h"

#include <SDL2/SDL_keycode.h>
#include <SDL2/SDL_mouse.h>
#include <SDL2/SDL_timer.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "experiments/sandbox/gl_canvas.h"
#include "experiments/sandbox/look_at_all.h"
#include "experiments/sandbox/window.h"
#include "framework/draw/draw_simulation.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

void drag(ViewCamera<2>& camera, bool, Real dx, Real dy) { camera.pan(dx, dy); }
void drag(ViewCamera<3>& camera, bool turns, Real dx, Real dy) { turns ? camera.orbit(dx, dy) : camera.pan(dx, dy); }

template <int D>
void moveCamera(ViewCamera<D>& camera, const SDL_Event& event) {
  if (event.type == SDL_MOUSEMOTION && event.motion.state != 0) {
    drag(camera, event.motion.state & SDL_BUTTON_LMASK, Real(event.motion.xrel), Real(event.motion.yrel));
  } else if (event.type == SDL_MOUSEWHEEL) {
    camera.zoom(std::pow(Real(1.15), static_cast<Real>(event.wheel.y)),
                Vec<2>(Real(event.wheel.mouseX), Real(event.wheel.mouseY)));
  }
}

}  // namespace

template <int D>
void view(Simulation<D>& world, Real dt) {
  if (!(dt > 0)) throw UserError("view: a step of " + std::to_string(dt) + " s; valid: more than none");
  Window window("Large Polygon Collider", 1280, 800);
  GlCanvas<D> canvas;
  ViewCamera<D> camera;
  camera.resize(window.width(), window.height());
  lookAtAll(camera, world);
  const DrawLayers layers{.contacts = true, .joints = true};
  bool pause = false;
  Real owed = 0;  // s by which the world lags behind the clock
  for (std::uint64_t last = SDL_GetTicks64();;) {
    for (SDL_Event event; window.poll(event);) {
      if (event.type == SDL_QUIT) return;
      moveCamera(camera, event);
      if (event.type != SDL_KEYDOWN) continue;
      const SDL_Keycode key = event.key.keysym.sym;
      if (key == SDLK_ESCAPE) return;
      if (key == SDLK_p) pause = !pause;
      if (key == SDLK_f) lookAtAll(camera, world);
      if (key == SDLK_SPACE || key == SDLK_RIGHT) {
        pause = true;
        world.step(dt);
      }
    }
    const std::uint64_t now = SDL_GetTicks64();
    // If the world is slower than its clock, it is shown slower, and its window responds.
    owed = pause ? 0 : std::min(owed + Real(now - last) / 1000, std::max(dt, Real(0.1)));
    last = now;
    for (; owed >= dt; owed -= dt) world.step(dt);

    window.beginFrame();
    camera.resize(window.width(), window.height());
    canvas.begin(camera);
    drawSimulation(world, layers, canvas);
    canvas.end();
    window.endFrame();
  }
}

template void view(Simulation<2>&, Real);
template void view(Simulation<3>&, Real);

}}  // namespace lpc::LPC_PRECISION
