// SPDX-License-Identifier: Zlib
#include "experiments/sandbox/puppet.h"

#include <SDL2/SDL.h>

#include <algorithm>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "experiments/sandbox/app.h"
#include "experiments/trial/formats/output_file.h"
#include "framework/math/check.h"
#include "framework/math/names.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

using nlohmann::json;

std::string joined(const std::vector<std::string>& words) {
  std::string out;
  for (const std::string& w : words) out += (out.empty() ? "" : " ") + w;
  return out;
}

// The script has checked it.
double number(const std::string& word) { return std::strtod(word.c_str(), nullptr); }

void push(SDL_Event event) { SDL_PushEvent(&event); }

void pushKey(const std::string& name, bool down, InputScript& script) {
  const SDL_Keycode code = SDL_GetKeyFromName(name.c_str());
  if (code == SDLK_UNKNOWN) script.fail("unknown key '" + name + "'; valid: names such as p, F1, Return, Left Ctrl");
  for (const auto& [key, flag] : {std::pair(SDLK_LCTRL, KMOD_LCTRL), std::pair(SDLK_LSHIFT, KMOD_LSHIFT)}) {
    if (code == key)
      SDL_SetModState(static_cast<SDL_Keymod>(down ? SDL_GetModState() | flag : SDL_GetModState() & ~flag));
  }
  SDL_Event event{};
  event.type = down ? SDL_KEYDOWN : SDL_KEYUP;
  event.key.keysym.mod = static_cast<Uint16>(SDL_GetModState());
  event.key.keysym.sym = code, event.key.keysym.scancode = SDL_GetScancodeFromKey(code);
  event.key.state = down ? SDL_PRESSED : SDL_RELEASED;
  event.key.repeat = script.holdKey(code, down);  // like a key that is held down
  push(event);
}

int buttonNamed(const std::string& name, const InputScript& script) {
  if (name == "left") return SDL_BUTTON_LEFT;
  if (name == "right") return SDL_BUTTON_RIGHT;
  if (name == "middle") return SDL_BUTTON_MIDDLE;
  script.fail("unknown button '" + name + "'; valid: left, right, middle");
}

template <class A>
void moveMouse(A& app, const Vec<2>& to) {
  app.window.holdMouse(to);
  SDL_Event event{};
  event.type = SDL_MOUSEMOTION;
  event.motion.x = static_cast<int>(to[0]), event.motion.y = static_cast<int>(to[1]);
  push(event);
}

template <class A>
void pushButton(A& app, int button, bool down) {
  app.window.holdButton(button, down);
  SDL_Event event{};
  event.type = down ? SDL_MOUSEBUTTONDOWN : SDL_MOUSEBUTTONUP;
  event.button.button = static_cast<Uint8>(button);
  event.button.x = static_cast<int>(app.window.heldMouse()[0]),
  event.button.y = static_cast<int>(app.window.heldMouse()[1]);
  push(event);
}

// Prints the window's content for programs.
template <int D>
json stateOf(App<D>& app) {
  json out = {{"scene", app.file.name()},
              {"dimension", D},
              {"precision", kPrecision},
              {"step", app.session.steps()},
              {"paused", app.paused},
              {"message", app.message},
              {"draw_ms", 1e3 * app.drawSeconds},
              {"step_ms", 1e3 * app.stepSeconds},
              {"gravity", app.session.world().settings().gravity[1]},
              {"selected", app.hand.selected()},
              {"bodies", json::array()},
              {"lanes", json::array()},
              {"joints", 0},
              {"deeds", app.session.actions().size()}};
  for (std::size_t i = 0; i < app.session.competitors().size(); ++i) {
    const auto& competitor = app.session.competitors()[i];
    char hash[20];
    std::snprintf(hash, sizeof hash, "%016llx", static_cast<unsigned long long>(competitor.world->hash()));
    out["lanes"].push_back({{"pipeline", competitor.pipeline},
                            {"hash", hash},
                            {"fallen", competitor.fallen},
                            {"parted_at", competitor.partedAt},
                            {"error", competitor.samples.empty() ? 0.0 : competitor.samples.back().error},
                            {"step_ms", 1e3 * medianTime(competitor.samples)},
                            {"bodies", json::array()}});
    json& seen = out["lanes"].back();
    const CompetitorLook& look = app.competitorLooks()[i];
    seen["title"] = look.title, seen["colour"] = {look.colour.red, look.colour.green, look.colour.blue};
    const Tile view = i < app.views.size() ? app.views[i] : Tile{0, 0, app.window.width(), app.window.height()};
    seen["view"] = {view.left, view.top, view.width, view.height};
    if (i < app.titles.size()) {
      const Tile& head = app.titles[i];
      seen["head"] = {head.left, head.top, head.width, head.height};
    }
    ViewCamera<D> camera = app.camera;
    camera.resize(view.width, view.height, view.left, view.top);
    for (int body = 0; body < app.session.bodies(); ++body) {
      const BodyHandle h = app.session.handle(body, i);
      if (!competitor.world->valid(h)) continue;
      const Vec<2> at = camera.toPixel(competitor.world->bodies().pose[static_cast<std::size_t>(h.slot)].p);
      seen["bodies"].push_back({at[0], at[1]});
    }
  }
  const Simulation<D>& world = app.session.world();
  for (const JointRecord<D>& j : world.joints()) out["joints"] = out["joints"].get<int>() + (j.kind != nullptr);
  for (int body = 0; body < app.session.bodies(); ++body) {
    const BodyHandle h = app.session.handle(body);
    if (!world.valid(h)) continue;
    const auto i = static_cast<std::size_t>(h.slot);
    const Vec<2> at = app.camera.toPixel(world.bodies().pose[i].p);
    json one = {{"body", body},
                {"pixel", {at[0], at[1]}},
                {"p", json::array()},
                {"awake", world.bodies().awake[i] != 0},
                {"type", static_cast<int>(world.bodies().type[i])},
                {"pinned", world.bodies().pinned[i] != 0}};
    for (int d = 0; d < D; ++d) one["p"].push_back(world.bodies().pose[i].p[d]);
    out["bodies"].push_back(one);
  }
  out["contacts"] = json::array();
  if (const auto contacts = world.contacts()) {
    for (const Manifold<D>& m : *contacts) {
      for (int i = 0; i < m.count; ++i) {
        const Vec<2> at = app.camera.toPixel(world.bodies().pose[static_cast<std::size_t>(m.bodyA)] *
                                             m.points[static_cast<std::size_t>(i)].localA);
        out["contacts"].push_back({at[0], at[1]});
      }
    }
  }
  for (const Command<D>& c : commands<D>()) {
    out["commands"].push_back({{"menu", c.menu},
                               {"name", c.name},
                               {"key", c.key ? SDL_GetKeyName(c.key) : ""},
                               {"meaning", c.meaning},
                               {"on", c.on && c.on(app)}});
  }
  if (const PairTrace<D>* trace = app.pair.trace()) {
    out["pair"] = {{"steps", trace->steps.size()}, {"step", app.pairStep}, {"made", app.pair.made()}};
  }
  out["pictures_per_second"] = app.window.picturesPerSecond();
  for (const auto& [name, at] : app.marks.all()) out["marks"][name] = {at[0], at[1]};
  return out;
}

}  // namespace

template <int D>
void playOrder(App<D>& app, InputScript& script) {
  const InputOrder* order = script.next();
  if (!order) return;
  const auto& words = order->words;
  const auto is = [&](const char* name) { return order->name == name; };
  if (is("wait")) {
    if (!script.waited(static_cast<long>(number(words[0])))) return;
  } else if (is("until")) {
    if (!app.session.fallen() && app.session.steps() < static_cast<long>(number(words[0]))) return;
  } else if (is("key")) {
    pushKey(joined(words), true, script), pushKey(joined(words), false, script);
  } else if (is("down") || is("up")) {
    pushKey(joined(words), is("down"), script);
  } else if (is("at")) {
    if (words.size() > D) script.fail("'at' has 3 arguments; valid: 2 in a 2D scene");
    Vec<D> p = Vec<D>::Zero();
    for (std::size_t i = 0; i < words.size(); ++i) {
      p[static_cast<int>(i)] = static_cast<Real>(number(words[i]));
    }
    moveMouse(app, app.camera.toPixel(p));
  } else if (is("pixel")) {
    moveMouse(app, Vec<2>(number(words[0]), number(words[1])));
  } else if (is("on")) {
    try {
      moveMouse(app, app.marks.at(joined(words)));
    } catch (const UserError& e) {
      script.fail(e.what());
    }
  } else if (is("press") || is("release")) {
    pushButton(app, buttonNamed(words[0], script), is("press"));
  } else if (is("wheel")) {
    SDL_Event event{};
    event.type = SDL_MOUSEWHEEL, event.wheel.y = static_cast<Sint32>(number(words[0]));
    push(event);
  } else if (is("type")) {
    SDL_Event event{};
    event.type = SDL_TEXTINPUT;
    std::snprintf(event.text.text, sizeof event.text.text, "%s", joined(words).c_str());
    push(event);
  } else if (is("shot")) {
    app.savePicture(words[0]);
  } else if (is("state")) {
    OutputFile out(words[0]);
    out.stream() << stateOf(app).dump(1) << '\n';
    out.finish();
  } else if (is("size")) {
    app.window.resize(static_cast<int>(number(words[0])), static_cast<int>(number(words[1])));
  } else if (is("drop")) {
    SDL_Event event{};
    event.type = SDL_DROPFILE, event.drop.file = SDL_strdup(words[0].c_str());
    push(event);
  } else {
    app.closed = true;  // quit
  }
  script.done();
}

template void playOrder(App<2>&, InputScript&);
template void playOrder(App<3>&, InputScript&);

}}  // namespace lpc::LPC_PRECISION
