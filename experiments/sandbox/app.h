// SPDX-License-Identifier: Zlib
// The sandbox's window on one scene: what is shown, and what keys, menus and panels do.
#pragma once

#include <array>
#include <functional>
#include <map>
#include <string>

#include "experiments/sandbox/gl_canvas.h"
#include "experiments/sandbox/hand.h"
#include "experiments/sandbox/input_script.h"
#include "experiments/sandbox/opening.h"
#include "experiments/sandbox/pair_look.h"
#include "experiments/sandbox/session.h"
#include "experiments/sandbox/tiles.h"
#include "experiments/sandbox/window.h"
#include "framework/draw/draw_simulation.h"
#include "framework/math/random.h"

namespace lpc { inline namespace LPC_PRECISION {

/// What the world computes in, as the command line calls it.
inline constexpr const char* kPrecision = std::is_same_v<Real, float> ? "f32" : "f64";

/// Who is drawn, of several: all in one view in their own colours, or each in its own.
enum class Arrangement { overlaid, sideBySide };

/// Panels that can be opened and closed.
struct Panels {
  bool scene = false, stages = false, layers = false, step = false, body = false, compare = false, pair = false,
       help = false;
  std::map<std::string, int> places = {};  // of those that are open
};
struct PanelInfo {
  const char* name;
  bool Panels::*open;
};
std::span<const PanelInfo> panelInfos();

/// What stays when another dimension is shown.
struct Switches {
  DrawLayers layers;
  Panels panels;
  Arrangement arrangement = Arrangement::overlaid;
  bool paused = false;
  bool meteors = false, rain = false, showers = false;  // come by themselves while they are on
  double timeScale = 1;
  int verbosity = 1;
  bool imageSequence = false;
  long images = 0;  // that were written
};

/// What tells a competitor from the others.
struct LaneLook {
  std::string pipeline, label, title;
  DrawColour colour;
};

/// Places of the window that a script can click on by name: "World/Pause", "Scene/base".
class Marks {
 public:
  /// After an item of ImGui: where it is.
  void last(const std::string& name);
  void clear() { m_places.clear(); }
  /// Throws UserError with the names that are there.
  Vec<2> at(const std::string& name) const;
  const std::map<std::string, Vec<2>>& all() const { return m_places; }

 private:
  std::map<std::string, Vec<2>> m_places;
};

template <int D>
class App : public Switches {
 public:
  App(Window& window, const Opening& opening, const SceneFile& file);

  /// One picture, and the steps that are due; false: it was closed, or something else shall be shown.
  bool frame(InputScript* script);
  /// What is shown next; nothing: the window was closed.
  const std::optional<Opening>& next() const { return m_next; }

  // --- commands; a mistake of the user's is told in the window, and changes nothing ---------------------------------
  void open(const std::string& scene);  // path, name or number
  void reload();
  void clear();
  void step();
  void back();
  void save(), load(), saveScript(), screenshot();
  void spawnPolygon(), fireworks();
  void useTool(Tool tool, bool drawsStatic = false);
  void look();  // the whole scene fills the view
  void arrangeAs(Arrangement as);
  void zoom(Real factor);
  void otherDimension();
  void addLane(const std::string& pipeline);
  void takeOut(std::size_t lane);
  void toggleLog();
  void writeProfile(const std::string& path);
  /// The last picture, as PNG. Throws UserError for what cannot be written.
  void savePicture(const std::string& path) const;
  void say(std::string text);  // in the window's last line
  /// Does it; of a mistake it says why.
  void act(const std::function<void()>& what);

  // --- what is shown, open to panels ---------------------------------------------------------------------------------
  Window& window;
  Opening opening;
  SceneFile file;
  Session<D> session;
  ViewCamera<D> camera;
  Hand<D> hand;
  std::vector<Tile> views, titles;  // of the last picture: where each lane was seen, and above it, side by side
  int titleLines = 1;               // for a label
  const std::vector<LaneLook>& laneLooks();
  bool isSideBySide() const { return arrangement == Arrangement::sideBySide && session.lanes().size() > 1; }
  Marks marks;
  bool closed = false;
  bool logging = false;  // statistics of each step, into a file
  PairLook<D> pair;      // that the panel of this name looks into
  std::string pairQuery = "gjk_epa";
  int pairStep = 0;
  ViewCamera<D> pairCamera;
  bool equalCost = false;  // of competitors, while they run
  std::string message;
  double drawSeconds = 0, stepSeconds = 0;  // of the last picture and the last step
  std::function<void()> later;              // done when the picture is finished: what replaces the session

 private:
  void handle(const SDL_Event& event);
  void key(int code, bool down, bool again);
  void advance();
  void spawnDue();
  void bring(const char* script, const ParameterValues& given);
  void bringOne(const char* script, const Vec<D>& at);
  void burst(const Vec<D>& at);
  Opening playing() const;  // what is shown, from its beginning, by who plays it now
  void begin(const Opening& next, const SceneFile& loaded, Session<D> played);
  void showOther(Opening next, const SceneFile& loaded);
  void draw();
  void arrange();
  void lookInto(std::size_t lane);  // the camera into its view
  Vec<2> inFirstView(const Vec<2>& pixel);
  void drawOverlaid();
  void drawSideBySide();
  void drawHand();

  Real chance(Real lo, Real hi);

  GlCanvas<D> m_canvas;
  std::optional<Opening> m_next;
  std::vector<LaneLook> m_laneLooks;
  bool m_lookDue = true;              // at all, as soon as it is known how the window is divided
  int m_columns = 1;                  // of tiles
  std::array<int, 4> m_columnsFor{};  // what they were chosen for
  Random m_random{1};                 // the same hand, the same bodies
  double m_due = 0;                   // s of the world's time that are still to be stepped
  Vec<2> m_drag = Vec<2>::Zero();
  Vec<2> m_shift = Vec<2>::Zero();  // px, from where the mouse is to where the hand is, which works in the first view
  bool m_holding = false;           // the left button
  bool m_panning = false, m_orbiting = false;
  bool m_control = false, m_shiftKey = false;
  bool m_scripted = false;  // then the clock decides nothing
};

/// A thing that a user can ask for: in a menu, by a key, or both. The manual's table of keys is written from these.
template <int D>
struct Command {
  const char *menu, *name;
  int key;  // of SDL, 0: none
  const char* meaning;
  std::function<void(App<D>&)> run;
  std::function<bool(const App<D>&)> on = {};  // of a switch
  bool repeats = false;                        // while its key is held down
};
template <int D>
const std::vector<Command<D>>& commands();

template <int D>
void drawMenus(App<D>& app);
template <int D>
void drawPanels(App<D>& app);

/// Shows what is asked for until the window is closed. Throws UserError for what cannot be opened at first.
void show(Window& window, Opening opening, InputScript* script);

}}  // namespace lpc::LPC_PRECISION
