// SPDX-License-Identifier: Zlib
// A window with OpenGL 3.3 and Dear ImGui in it, for as long as it lives. One at a time: ImGui has one context, OpenGL
// a current one.
#pragma once

#include <SDL2/SDL_events.h>

#include <optional>
#include <string>
#include <vector>

#include "framework/draw/debug_draw.h"

namespace lpc { inline namespace LPC_PRECISION {

class Window {
 public:
  /// Throws UserError where there is no display, or no OpenGL 3.3.
  Window(const char* title, int width, int height);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  int width() const { return m_width; }
  int height() const { return m_height; }

  /// As if a user had drawn at its edge.
  void resize(int width, int height);
  void setTitle(const std::string& title);

  /// The next thing that happened, if anything did. ImGui and the list of dropped files have heard of it already.
  bool poll(SDL_Event& event);
  /// Is it ImGui's alone: a click on a panel, a key typed into a field?
  bool forPanels(const SDL_Event& event) const;
  /// Files that were dropped on the window since the last call.
  std::vector<std::string> takeDropped();

  /// Whatever is drawn or asked of ImGui comes between these two. Everything is drawn into a picture of our own, since
  /// of a window nobody knows what has become of it when it has been shown.
  void beginFrame();
  /// Shows it, and waits until the next one may come.
  void endFrame();
  /// Frames per second at most; 0 is as many as there may be.
  void limitFrames(int perSecond) { m_perSecond = perSecond; }

  /// s between pictures: of the clock, at most a quarter; one sixtieth while the mouse is held.
  double secondsPerFrame() const { return m_seconds; }
  /// Of the last second, by the clock.
  double picturesPerSecond() const { return m_rate; }
  /// From now on the mouse is where it is put, and time goes by pictures: for scripts of input.
  void holdMouse(const Vec<2>& pixel) { m_held = pixel; }
  void holdButton(int button, bool down);
  Vec<2> heldMouse() const { return m_held.value_or(Vec<2>::Zero()); }

  struct Picture {
    int width = 0, height = 0;
    std::vector<unsigned char> rgb;  // row by row from the top
    DrawColour at(int x, int y) const;
  };
  /// The last frame that has ended.
  Picture screenshot() const;

 private:
  void fit();
  void close();

  SDL_Window* m_window = nullptr;
  void* m_context = nullptr;  // OpenGL's
  int m_width, m_height;
  unsigned m_frame = 0, m_colours = 0, m_depths = 0;  // the picture, and what it is made of
  int m_perSecond = 60;
  double m_seconds = 0;  // between the last two frames
  double m_rate = 0;     // frames a second
  int m_frames = 0;      // since m_counted
  std::uint64_t m_counted = 0;
  std::uint64_t m_last = 0;  // ticks of SDL's clock when the last frame was shown
  std::vector<std::string> m_dropped;
  std::optional<Vec<2>> m_held;
  bool m_down[3] = {false, false, false};  // ImGui's order: left, right, middle
};

}}  // namespace lpc::LPC_PRECISION
