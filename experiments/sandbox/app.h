// SPDX-License-Identifier: Zlib
// The sandbox's window for one scene: what it shows, and the effect of keys, menus and panels.
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

/// The precision of the world, as named on the command line.
inline constexpr const char* kPrecision = std::is_same_v<Real, float> ? "f32" : "f64";

/// How several competitors are shown: all in one view in their own colours, or each in a view of its own.
enum class Arrangement { overlaid, sideBySide };

/// Which panels are open.
struct Panels {
  bool scene = false, stages = false, layers = false, step = false, body = false, compare = false, pair = false,
       help = false;
  std::map<std::string, int> places = {};  // of the open ones
};
struct PanelInfo {
  const char* name;
  bool Panels::*open;
};
std::span<const PanelInfo> panelInfos();

/// Switches that stay when the dimension changes.
struct Switches {
  DrawLayers layers;
  Panels panels;
  Arrangement arrangement = Arrangement::overlaid;
  bool paused = false;
  bool meteors = false, rain = false, showers = false;  // while on, they are added automatically
  double timeScale = 1;
  int verbosity = 1;
  bool imageSequence = false;
  long images = 0;  // number of pictures written
};

/// How a competitor is drawn.
struct CompetitorLook {
  std::string pipeline, label, title;
  DrawColour colour;
};

/// Named positions in the window for scripts of mouse clicks: "World/Pause", "Scene/base".
class Marks {
 public:
  /// Call after an item of ImGui: records its position.
  void last(const std::string& name);
  void clear() { m_places.clear(); }
  /// Throws UserError with the known names.
  Vec<2> at(const std::string& name) const;
  const std::map<std::string, Vec<2>>& all() const { return m_places; }

 private:
  std::map<std::string, Vec<2>> m_places;
};

template <int D>
class App : public Switches {
 public:
  App(Window& window, const Opening& opening, const SceneFile& file);

  /// Draws one picture and makes the steps that are due; false if the window was closed, or another scene shall be
  /// shown.
  bool frame(InputScript* script);
  /// What to show next; empty: the window was closed.
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
  void look();  // fits the whole scene into the view
  void arrangeAs(Arrangement as);
  void zoom(Real factor);
  void otherDimension();
  void addCompetitor(const std::string& pipeline);
  void removeCompetitor(std::size_t competitor);
  void toggleLog();
  void writeProfile(const std::string& path);
  /// Writes the last picture as PNG. Throws UserError if it cannot be written.
  void savePicture(const std::string& path) const;
  void say(std::string text);  // in the window's status line
  /// Runs an action; shows the message of a UserError.
  void act(const std::function<void()>& what);

  // --- what is shown, open to panels ---------------------------------------------------------------------------------
  Window& window;
  Opening opening;
  SceneFile file;
  Session<D> session;
  ViewCamera<D> camera;
  Hand<D> hand;
  std::vector<Tile> views,
      titles;          // of the last picture: the view of each competitor, and, side by side, its title above it
  int titleLines = 1;  // for a label
  const std::vector<CompetitorLook>& competitorLooks();
  bool isSideBySide() const { return arrangement == Arrangement::sideBySide && session.competitors().size() > 1; }
  Marks marks;
  bool closed = false;
  bool logging = false;  // writes statistics of each step to a file
  PairLook<D> pair;      // shown in the panel of this name
  std::string pairQuery = "gjk_epa";
  int pairStep = 0;
  ViewCamera<D> pairCamera;
  bool equalCost = false;  // between competitors, while they run
  std::string message;
  double drawSeconds = 0, stepSeconds = 0;  // of the last picture and the last step
  std::function<void()> later;              // runs after the picture: replaces the session

 private:
  void handle(const SDL_Event& event);
  void key(int code, bool down, bool again);
  void advance();
  void spawnDue();
  void bring(const char* script, const ParameterValues& given);
  void bringOne(const char* script, const Vec<D>& at);
  void burst(const Vec<D>& at);
  Opening playing() const;  // the present scene, from its beginning, with the present pipelines
  void begin(const Opening& next, const SceneFile& loaded, Session<D> played);
  void showOther(Opening next, const SceneFile& loaded);
  void draw();
  void arrange();
  void lookInto(std::size_t competitor);  // sets the camera to its view
  Vec<2> inFirstView(const Vec<2>& pixel);
  void drawOverlaid();
  void drawSideBySide();
  void drawHand();

  Real chance(Real lo, Real hi);

  GlCanvas<D> m_canvas;
  std::optional<Opening> m_next;
  std::vector<CompetitorLook> m_competitorLooks;
  bool m_lookDue = true;              // fit the scene, as soon as the division of the window is known
  int m_columns = 1;                  // of tiles
  std::array<int, 4> m_columnsFor{};  // the input of that choice
  Random m_random{1};                 // the same actions give the same bodies
  double m_due = 0;                   // s of the world's time still to be simulated
  Vec<2> m_drag = Vec<2>::Zero();
  Vec<2> m_shift = Vec<2>::Zero();  // px, from the mouse to the hand, which acts in the first view
  bool m_holding = false;           // the left button
  bool m_panning = false, m_orbiting = false;
  bool m_control = false, m_shiftKey = false;
  bool m_scripted = false;  // then the clock has no effect
};

/// A command of the user: in a menu, by a key, or both. The manual's table of keys is generated from these.
template <int D>
struct Command {
  const char *menu, *name;
  int key;  // of SDL, 0: none
  const char* meaning;
  std::function<void(App<D>&)> run;
  std::function<bool(const App<D>&)> on = {};  // state of a switch
  bool repeats = false;                        // repeats while its key is held down
};
template <int D>
const std::vector<Command<D>>& commands();

template <int D>
void drawMenus(App<D>& app);
template <int D>
void drawPanels(App<D>& app);

/// Shows scenes until the window is closed. Throws UserError if the first one cannot be opened.
void show(Window& window, Opening opening, InputScript* script);

}}  // namespace lpc::LPC_PRECISION
