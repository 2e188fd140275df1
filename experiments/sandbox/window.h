// SPDX-License-Identifier: Zlib
// A window with OpenGL 3.3 and Dear ImGui. One at a time: ImGui has one context, and OpenGL a current one.
#pragma once

#include <SDL2/SDL_events.h>

#include <optional>
#include <string>
#include <vector>

#include "framework/draw/debug_draw.h"

namespace lpc { inline namespace LPC_PRECISION {

class Window {
 public:
  /// Throws UserError without a display or OpenGL 3.3.
  Window(const char* title, int width, int height);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  int width() const { return m_width; }
  int height() const { return m_height; }

  /// As if a user had dragged its border.
  void resize(int width, int height);
  void setTitle(const std::string& title);

  /// The next event, if there is one. ImGui and the list of dropped files have already received it.
  bool poll(SDL_Event& event);
  /// Whether the event belongs to ImGui only: a click on a panel, a key typed into a field.
  bool forPanels(const SDL_Event& event) const;
  /// Files that were dropped on the window since the last call.
  std::vector<std::string> takeDropped();

  /// Drawing and ImGui calls are allowed between these two. Everything is drawn into a framebuffer of our own, since
  /// the content of a window is undefined after it is shown.
  void beginFrame();
  /// Shows it, and waits for the time of the next frame.
  void endFrame();
  /// Largest number of frames per second; 0: unlimited.
  void limitFrames(int perSecond) { m_perSecond = perSecond; }

  /// s between pictures: by the clock, at most a quarter; one sixtieth while the mouse is held by a script.
  double secondsPerFrame() const { return m_seconds; }
  /// During the last second, by the clock.
  double picturesPerSecond() const { return m_rate; }
  /// From now on the mouse stays where it is put, and time advances with pictures: for scripts of input.
  void holdMouse(const Vec<2>& pixel) { m_held = pixel; }
  void holdButton(int button, bool down);
  Vec<2> heldMouse() const { return m_held.value_or(Vec<2>::Zero()); }

  struct Picture {
    int width = 0, height = 0;
    std::vector<unsigned char> rgb;  // row by row from the top
    DrawColour at(int x, int y) const;
  };
  /// The last finished frame.
  Picture screenshot() const;

 private:
  void fit();
  void close();

  SDL_Window* m_window = nullptr;
  void* m_context = nullptr;  // OpenGL's
  int m_width, m_height;
  unsigned m_frame = 0, m_colours = 0, m_depths = 0;  // the framebuffer and its attachments
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
