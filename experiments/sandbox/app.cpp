// SPDX-License-Identifier: Zlib
#include "experiments/sandbox/app.h"

#include <SDL2/SDL.h>
#include <imgui.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "experiments/film/png_file.h"
#include "experiments/runner/locations.h"
#include "experiments/sandbox/action_script.h"
#include "experiments/sandbox/competitor_colours.h"
#include "experiments/sandbox/competitor_label.h"
#include "experiments/sandbox/equal_cost.h"
#include "experiments/sandbox/look_at_all.h"
#include "experiments/sandbox/panels.h"
#include "experiments/sandbox/puppet.h"
#include "experiments/trial/formats/output_file.h"
#include "experiments/trial/scene/saved_scene.h"
#include "framework/math/check.h"
#include "framework/math/names.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

constexpr const char* kSaved = "sandbox.toml";  // F1 and F2
constexpr Real kTurn = Real(0.0872664626);      // rad, five degrees a notch
constexpr double kToldAfter = 0.3,
                 kPatience = 10;  // s: a progress message after this time; a step back may take this long
// Limits per picture: as many steps as the largest time scale needs; a slower simulation is shown slower.
constexpr int kMostSteps = 4;
constexpr double kMostTime = 4.0 / 60, kMostSeconds = 0.1;  // s, of the world's and of the wall clock's time

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

}  // namespace

std::span<const PanelInfo> panelInfos() {
  static constexpr PanelInfo kPanels[] = {
      {"Scene", &Panels::scene}, {"Stages", &Panels::stages},   {"Layers", &Panels::layers}, {"Step", &Panels::step},
      {"Body", &Panels::body},   {"Compare", &Panels::compare}, {"Pair", &Panels::pair},     {"Keys", &Panels::help}};
  return kPanels;
}

void Marks::last(const std::string& name) {
  const ImVec2 lo = ImGui::GetItemRectMin(), hi = ImGui::GetItemRectMax();
  m_places[name] = Vec<2>((lo.x + hi.x) / 2, (lo.y + hi.y) / 2);
}

Vec<2> Marks::at(const std::string& name) const {
  if (const auto it = m_places.find(name); it != m_places.end()) return it->second;
  std::vector<std::string> names;
  for (const auto& [known, place] : m_places) names.push_back(known);
  throw UserError("unknown panel or button '" + name + "'" + validNames(names, name));
}

template <int D>
App<D>::App(Window& w, const Opening& o, const SceneFile& f)
    : window(w), opening(o), file(f), session(specOf<D>(f, o), o.pipelines), hand(session, camera) {
  camera.resize(window.width(), window.height());
  lookAtAll(camera, session.world());
  panels.step = o.plots;
  session.measure(panels.step);
  session.keepFrames(!o.profile.empty());
  for (long i = 0; i < o.steps && !session.fallen(); ++i) session.step();
  paused = o.steps > 0;
  hand.setPaused(paused);
  say(o.say.empty() ? file.name() + ": " + file.summary() : o.say);
}

template <int D>
void App<D>::say(std::string text) {
  message = std::move(text);
}

template <int D>
void App<D>::act(const std::function<void()>& what) {
  try {
    what();
  } catch (const UserError& e) {
    say(oneLine(e.what()));
  }
}

template <int D>
bool App<D>::frame(InputScript* script) {
  m_scripted = script != nullptr;
  if (script) playOrder(*this, *script);
  for (SDL_Event event; window.poll(event);) handle(event);
  for (const std::string& path : window.takeDropped()) {
    act([&] {
      if (!std::filesystem::is_regular_file(path)) throw UserError("'" + path + "' is not a file; valid: a scene file");
      open(path);
    });
  }
  advance();
  draw();
  if (imageSequence && !paused) {
    char name[48];
    std::snprintf(name, sizeof name, "sandbox_%05ld.png", images + 1);
    act([&] {
      imageSequence = false;  // if one picture cannot be written, the others cannot either
      savePicture(name);
      imageSequence = true, ++images;
    });
  }
  if (later) act(std::exchange(later, nullptr));
  return !closed && !m_next;
}

template <int D>
void App<D>::handle(const SDL_Event& event) {
  const auto mouse = [](const auto& e) { return Vec<2>(e.x, e.y); };
  if (event.type == SDL_QUIT) closed = true;
  if (event.type == SDL_KEYUP || (event.type == SDL_KEYDOWN && !window.forPanels(event))) {
    key(event.key.keysym.sym, event.type == SDL_KEYDOWN, event.key.repeat != 0);
  }
  if (event.type == SDL_MOUSEMOTION) {
    const Vec<2> to = mouse(event.motion), by = to - m_drag;
    m_drag = to;
    if (m_panning) camera.pan(by[0], by[1]);
    if constexpr (D == 3) {
      if (m_orbiting) camera.orbit(by[0], by[1]);
    }
    act([&] { hand.move(inFirstView(to)); });
  }
  if (event.type == SDL_MOUSEBUTTONUP) {
    m_panning = m_orbiting = false;
    if (event.button.button == SDL_BUTTON_LEFT) {
      act([&] { hand.release(inFirstView(mouse(event.button))); });
      m_holding = false;
    }
  }
  if (window.forPanels(event)) return;
  if (event.type == SDL_MOUSEBUTTONDOWN) {
    m_drag = mouse(event.button);
    if (event.button.button == SDL_BUTTON_LEFT) {
      act([&] { hand.press(inFirstView(m_drag), m_shiftKey); });
      m_holding = true;
    }
    // The report pans with the right button; in 3D that button rotates the view, as in today's programs, unless shift
    // is down.
    const bool turns = D == 3 && event.button.button == SDL_BUTTON_RIGHT && !m_shiftKey;
    m_orbiting = turns, m_panning = event.button.button != SDL_BUTTON_LEFT && !turns;
  }
  if (event.type == SDL_MOUSEWHEEL) {
    const auto notches = static_cast<Real>(event.wheel.y);
    if (m_control) {
      act([&] { hand.turn(kTurn * notches); });
    } else {
      camera.zoom(std::pow(Real(1.15), notches), hand.cursor());
    }
  }
}

template <int D>
void App<D>::key(int code, bool down, bool again) {
  if (code == SDLK_LCTRL || code == SDLK_RCTRL) m_control = down;
  if (code == SDLK_LSHIFT || code == SDLK_RSHIFT) m_shiftKey = down;
  if (!down) return;
  for (const Command<D>& c : commands<D>()) {
    if (c.key == code && (c.repeats || !again)) return act([&] { c.run(*this); });
  }
}

template <int D>
void App<D>::advance() {
  if (paused || session.fallen()) return;
  const double dt = static_cast<double>(session.dt());
  m_due = std::min(m_due + window.secondsPerFrame() * timeScale, std::max(kMostSteps * dt, kMostTime));
  const double begun = now();
  // Never below zero: with a rounded dt the error would eventually add up to a step.
  for (int made = 0; m_due > dt * (1 - 1e-6) && !session.fallen(); m_due = std::max(m_due - dt, 0.0)) {
    if (made++ >= kMostSteps && !m_scripted && now() - begun > kMostSeconds) m_due = dt;  // the last
    step();
  }
  if (!session.fallen()) return;
  paused = true;  // shown as it fell, and can be stepped back
  hand.setPaused(true);
  say(session.competitors()[0].fallen);
}

template <int D>
void App<D>::step() {
  act([&] {
    hand.pull(m_control);
    spawnDue();
    session.measure(panels.step);
    session.step();
    if (equalCost) equaliseCost(session);
    const std::vector<Sample>& samples = session.competitors()[0].samples;
    stepSeconds = samples.empty() ? 0 : samples.back().seconds;
  });
}

// The window does not respond while an engine repeats its steps: its title shows the progress.
template <int D>
void App<D>::back() {
  paused = true;
  const double start = now();
  bool told = false;
  const auto progress = [&](std::size_t competitor, double part) {
    const double seconds = now() - start;
    told |= seconds > kToldAfter;
    if (told) {
      char text[96];
      std::snprintf(text, sizeof text, "LPC sandbox: step back, competitor %zu, %.0f %%", competitor + 1, 100 * part);
      window.setTitle(text);
    }
    return seconds < kPatience;
  };
  if (!session.back(progress)) say("no earlier step");
  if (told) window.setTitle("LPC sandbox");
  for (const auto& competitor : session.competitors()) {
    if (competitor.fallen.starts_with("step back cancelled")) say(competitor.fallen + "; R reloads the scene");
  }
  hand.setPaused(true);
}

template <int D>
void App<D>::look() {
  m_lookDue = true;
}

template <int D>
void App<D>::arrangeAs(Arrangement as) {
  if (as != arrangement) look();
  arrangement = as;
}

template <int D>
void App<D>::zoom(Real factor) {
  camera.zoom(factor, camera.center());
}

template <int D>
void App<D>::open(const std::string& scene) {
  Opening next = playing();
  next.scene = findToml("scenes", scene), next.script.clear();
  next.parameters.clear(), next.seed.reset(), next.dt.reset(), next.features.reset();
  const SceneFile loaded = SceneFile::load(next.scene);
  if (!loaded.has(D)) return showOther(next, loaded);
  Session<D> played(specOf<D>(loaded, next), next.pipelines);
  later = [this, next, loaded, played = std::make_shared<Session<D>>(std::move(played))] {
    begin(next, loaded, std::move(*played));
    look();
    say(file.name() + ": " + file.summary());
  };
}

template <int D>
void App<D>::reload() {
  const SceneFile loaded = SceneFile::load(opening.scene, opening.script);  // as it is now
  const Opening next = playing();
  Session<D> played(specOf<D>(loaded, next), next.pipelines);
  later = [this, next, loaded, played = std::make_shared<Session<D>>(std::move(played))] {
    begin(next, loaded, std::move(*played));
  };
}

template <int D>
void App<D>::begin(const Opening& next, const SceneFile& loaded, Session<D> played) {
  if (logging) toggleLog();  // of the former world
  hand.cancel(), hand.select({});
  opening = next, file = loaded, session = std::move(played);
  session.keepFrames(!opening.profile.empty());
}

template <int D>
Opening App<D>::playing() const {
  Opening out = opening;
  out.say.clear(), out.steps = 0;
  const auto& competitors = session.competitors();
  for (std::size_t i = 0; competitors.size() == out.pipelines.size() && i < competitors.size(); ++i) {
    out.pipelines[i] = competitors[i].pipeline;
  }
  return out;
}

template <int D>
void App<D>::showOther(Opening next, const SceneFile& loaded) {
  constexpr int kOther = 5 - D;
  next.dimension = kOther;
  static_cast<void>(
      Session<kOther>(specOf<kOther>(loaded, next), next.pipelines));  // rejects pipelines that cannot run
  m_next = next;
}

template <int D>
void App<D>::clear() {
  for (int body = 0; body < session.bodies(); ++body) {
    if (session.world().valid(session.handle(body))) session.perform(RemoveBody{body});
  }
  hand.select({});
}

template <int D>
void App<D>::save() {
  const auto world = session.ready();
  if (!world) throw UserError("the state of an engine cannot be saved; valid: a pipeline of LPC's stages");
  SavedScene saved(session.steps(), kSaved);
  saved.write(*world, session.scene(), session.competitors()[0].pipeline);
  saved.finish();
  say(std::string("saved as ") + kSaved);
}

template <int D>
void App<D>::load() {
  if (!std::filesystem::is_regular_file(kSaved)) {
    throw UserError(std::string("there is no ") + kSaved + " in this folder; valid: save a world first (F1)");
  }
  open(kSaved);
}

template <int D>
void App<D>::otherDimension() {
  constexpr int kOther = 5 - D;
  if (!file.has(kOther)) throw UserError(file.name() + " does not exist in " + std::to_string(kOther) + "D");
  showOther(playing(), SceneFile::load(opening.scene, opening.script));
}

template <int D>
void App<D>::addCompetitor(const std::string& pipeline) {
  Opening next = playing();
  next.pipelines.push_back(pipeline);
  Session<D> played(specOf<D>(file, next), next.pipelines);  // rejects pipelines that cannot run
  opening.pipelines = next.pipelines;
  reload();
}

template <int D>
void App<D>::removeCompetitor(std::size_t competitor) {
  opening.pipelines = playing().pipelines;
  opening.pipelines.erase(opening.pipelines.begin() + static_cast<long>(competitor));
  reload();
}

template <int D>
void App<D>::toggleLog() {
  logging = !logging;
  if (!logging) writeProfile("sandbox_stats.csv");
  session.keepFrames(logging || !opening.profile.empty());
}

template <int D>
void App<D>::writeProfile(const std::string& path) {
  OutputFile out(path);
  session.world().profiler().writeCsv(out.stream());
  out.check(), out.finish();
  say("written: " + path);
}

template <int D>
void App<D>::saveScript() {
  constexpr const char* kPath = "sandbox_script.toml";
  const std::string text = "# " + runOf(opening, file, kPath) + "\n" +
                           scriptOf<D>(session.actions(), session.scene(), file, session.steps());
  // Proof that it is the same: a run of the script in the same scene ends in the same bits.
  std::ifstream scene(file.path(), std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(scene), {}};
  const SceneFile scripted = SceneFile::parse(bytes, file.path(), text, kPath);
  Opening plain = opening;
  plain.features.reset();
  SceneSpec<D> spec = specOf<D>(scripted, plain);
  if (spec.saved.empty()) spec.settings.model = scripted.model();  // no joints if neither scene nor script needs them
  Session<D> again(std::move(spec), {opening.pipelines.front()});
  while (again.steps() < session.steps() && !again.fallen()) again.step();
  const bool same = again.world().hash() == session.world().hash();
  OutputFile out(kPath);
  out.stream() << text;
  out.finish();
  say(std::string("written: ") + kPath +
      (same ? ", and a replay ends bit for bit the same" : ", but a replay ends DIFFERENTLY from the shown world"));
}

template <int D>
void App<D>::screenshot() {
  later = [this] {
    savePicture("sandbox.png");
    say("written: sandbox.png");
  };
}

template <int D>
void App<D>::savePicture(const std::string& path) const {
  const Window::Picture shown = window.screenshot();
  writePng(path, shown.width, shown.height, shown.rgb);
}

template <int D>
void App<D>::useTool(Tool tool, bool drawsStatic) {
  hand.cancel();
  hand.tool = tool, hand.drawsStatic = drawsStatic;
}

template <int D>
void App<D>::draw() {
  const double start = now();
  window.beginFrame();
  marks.clear();
  if (panels.pair) lookIntoPair(*this);
  arrange();
  isSideBySide() ? drawSideBySide() : drawOverlaid();
  drawMenus(*this);
  drawPanels(*this);
  drawSeconds = now() - start;
  window.endFrame();
}

template class App<2>;
template class App<3>;

namespace {

template <int D>
std::optional<Opening> showOne(Window& window, const Opening& opening, const SceneFile& file, InputScript* script,
                               std::optional<Switches>& kept) {
  App<D> app(window, opening, file);
  if (kept) static_cast<Switches&>(app) = *kept, app.hand.setPaused(app.paused);
  while (app.frame(script)) {
  }
  kept = app;
  if (app.logging) app.toggleLog();
  if (!app.next() && !app.opening.profile.empty()) app.writeProfile(app.opening.profile);
  return app.next();
}

}  // namespace

void show(Window& window, Opening opening, InputScript* script) {
  std::optional<Switches> kept;
  for (std::optional<Opening> next = std::move(opening); next;) {
    const SceneFile file = SceneFile::load(next->scene, next->script);
    next = next->dimension == 2 ? showOne<2>(window, *next, file, script, kept)
                                : showOne<3>(window, *next, file, script, kept);
  }
}

}}  // namespace lpc::LPC_PRECISION
