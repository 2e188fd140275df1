// SPDX-License-Identifier: Zlib
#include "experiments/sandbox/window.h"

#include <SDL2/SDL.h>
#include <backends/imgui_impl_opengl3.h>
#include <backends/imgui_impl_sdl.h>
#include <epoxy/gl.h>
#include <imgui.h>

#include <algorithm>
#include <cstdlib>
#include <iterator>
#include <utility>

#ifdef LPC_SANITIZED
#include <dlfcn.h>
#include <link.h>
#endif

namespace lpc { inline namespace LPC_PRECISION {
namespace {

constexpr float kBackground[] = {247 / 255.0f, 247 / 255.0f, 245 / 255.0f};  // that of films

#ifdef LPC_SANITIZED
// A driver is unloaded with the last window. Its cached memory then appears as a leak of an unknown module, so drivers
// stay loaded.
void keepDrivers() {
  const auto keep = [](dl_phdr_info* module, std::size_t, void*) {
    const std::string name = module->dlpi_name;
    const bool driver = name.find("_dri.so") != name.npos || name.find("libGL") != name.npos;
    if (driver) dlopen(name.c_str(), RTLD_LAZY | RTLD_NOLOAD | RTLD_NODELETE);
    return 0;
  };
  dl_iterate_phdr(keep, nullptr);
}
#else
void keepDrivers() {}
#endif

[[noreturn]] void noWindow(const std::string& lack, const std::string& valid) {
  throw UserError("no window: " + lack + "SDL says '" + SDL_GetError() + "'; valid: " + valid);
}

}  // namespace

Window::Window(const char* title, int width, int height) : m_width(width), m_height(height) {
  SDL_SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");  // Ctrl-C belongs to the program
  // By default SDL may choose an offscreen driver. SDL_VIDEODRIVER of the environment takes precedence.
  SDL_SetHint(SDL_HINT_VIDEODRIVER, std::getenv("WAYLAND_DISPLAY") ? "x11,wayland" : "x11");
  if (SDL_InitSubSystem(SDL_INIT_VIDEO) != 0) noWindow("", "a display, such as DISPLAY=:0");
  try {
    SDL_GL_SetAttribute(SDL_GL_CONTEXT_MAJOR_VERSION, 3);
    SDL_GL_SetAttribute(SDL_GL_CONTEXT_MINOR_VERSION, 3);
    SDL_GL_SetAttribute(SDL_GL_CONTEXT_PROFILE_MASK, SDL_GL_CONTEXT_PROFILE_CORE);
    m_window = SDL_CreateWindow(title, SDL_WINDOWPOS_UNDEFINED, SDL_WINDOWPOS_UNDEFINED, width, height,
                                SDL_WINDOW_OPENGL | SDL_WINDOW_RESIZABLE);
    if (m_window) m_context = SDL_GL_CreateContext(m_window);
    if (!m_context || epoxy_gl_version() < 33) {
      noWindow("it needs OpenGL 3.3, ", "a driver that has it, or LIBGL_ALWAYS_SOFTWARE=1");
    }
    keepDrivers();
    SDL_GL_SetSwapInterval(0);  // no vsync: a hidden display may never answer
    ImGui::CreateContext();
    ImGui::StyleColorsLight();             // competitors have the colours of charts, which are for paper
    ImGui::GetIO().IniFilename = nullptr;  // writes no settings file
    ImGui_ImplSDL2_InitForOpenGL(m_window, m_context);
    ImGui_ImplOpenGL3_Init("#version 330 core");
    glGenFramebuffers(1, &m_frame);
    glGenRenderbuffers(1, &m_colours);
    glGenRenderbuffers(1, &m_depths);
    fit();
  } catch (...) {
    close();
    throw;
  }
}

Window::~Window() { close(); }

void Window::close() {
  if (m_frame) {
    glDeleteRenderbuffers(1, &m_depths);
    glDeleteRenderbuffers(1, &m_colours);
    glDeleteFramebuffers(1, &m_frame);
    ImGui_ImplOpenGL3_Shutdown();
    ImGui_ImplSDL2_Shutdown();
    ImGui::DestroyContext();
  }
  if (m_context) SDL_GL_DeleteContext(m_context);
  if (m_window) SDL_DestroyWindow(m_window);
  SDL_QuitSubSystem(SDL_INIT_VIDEO);
}

void Window::fit() {
  SDL_GetWindowSize(m_window, &m_width, &m_height);
  glBindRenderbuffer(GL_RENDERBUFFER, m_colours);
  glRenderbufferStorage(GL_RENDERBUFFER, GL_RGB8, m_width, m_height);
  glBindRenderbuffer(GL_RENDERBUFFER, m_depths);
  glRenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT24, m_width, m_height);
  glBindFramebuffer(GL_FRAMEBUFFER, m_frame);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, m_colours);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, m_depths);
}

bool Window::poll(SDL_Event& event) {
  if (!SDL_PollEvent(&event)) return false;
  ImGui_ImplSDL2_ProcessEvent(&event);
  if (event.type == SDL_DROPFILE) {
    m_dropped.emplace_back(event.drop.file);
    SDL_free(event.drop.file);
    event.drop.file = nullptr;
  }
  return true;
}

bool Window::forPanels(const SDL_Event& event) const {
  const ImGuiIO& io = ImGui::GetIO();
  switch (event.type) {
    case SDL_MOUSEMOTION:
    case SDL_MOUSEBUTTONDOWN:
    case SDL_MOUSEBUTTONUP:
    case SDL_MOUSEWHEEL:
      return io.WantCaptureMouse;
    case SDL_KEYDOWN:
    case SDL_KEYUP:
    case SDL_TEXTINPUT:
      return io.WantCaptureKeyboard;
    default:
      return false;
  }
}

void Window::resize(int width, int height) { SDL_SetWindowSize(m_window, width, height); }

void Window::setTitle(const std::string& title) { SDL_SetWindowTitle(m_window, title.c_str()); }

std::vector<std::string> Window::takeDropped() { return std::exchange(m_dropped, {}); }

void Window::beginFrame() {
  int width = 0, height = 0;
  SDL_GetWindowSize(m_window, &width, &height);
  if (width != m_width || height != m_height) fit();
  glBindFramebuffer(GL_FRAMEBUFFER, m_frame);
  glClearColor(kBackground[0], kBackground[1], kBackground[2], 1);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplSDL2_NewFrame();
  if (m_held) {
    ImGuiIO& io = ImGui::GetIO();
    io.MousePos = ImVec2(static_cast<float>((*m_held)[0]), static_cast<float>((*m_held)[1]));
    std::copy(std::begin(m_down), std::end(m_down), io.MouseDown);
    io.DeltaTime = 1.0f / 60;
  }
  ImGui::NewFrame();
}

void Window::endFrame() {
  ImGui::Render();
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
  glBindFramebuffer(GL_READ_FRAMEBUFFER, m_frame);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
  glBlitFramebuffer(0, 0, m_width, m_height, 0, 0, m_width, m_height, GL_COLOR_BUFFER_BIT, GL_NEAREST);
  SDL_GL_SwapWindow(m_window);
  if (m_perSecond > 0) {
    const std::uint64_t frame = SDL_GetPerformanceFrequency() / static_cast<std::uint64_t>(m_perSecond);
    const std::uint64_t passed = SDL_GetPerformanceCounter() - m_last;
    if (passed < frame) SDL_Delay(static_cast<Uint32>(1000 * (frame - passed) / SDL_GetPerformanceFrequency()));
  }
  const std::uint64_t now = SDL_GetPerformanceCounter();
  m_seconds = std::min(static_cast<double>(now - m_last) / static_cast<double>(SDL_GetPerformanceFrequency()), 0.25);
  if (m_held) m_seconds = 1.0 / 60;
  m_last = now;
  const double counted = static_cast<double>(now - m_counted) / static_cast<double>(SDL_GetPerformanceFrequency());
  ++m_frames;
  if (counted < 1) return;
  m_rate = m_counted ? m_frames / counted : 0;
  m_frames = 0, m_counted = now;
}

void Window::holdButton(int button, bool down) {
  m_down[button == SDL_BUTTON_LEFT ? 0 : button == SDL_BUTTON_RIGHT ? 1 : 2] = down;
}

DrawColour Window::Picture::at(int x, int y) const {
  LPC_ASSERT(x >= 0 && x < width && y >= 0 && y < height);
  const unsigned char* pixel =
      rgb.data() + 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x));
  return {pixel[0], pixel[1], pixel[2]};
}

Window::Picture Window::screenshot() const {
  Picture picture{m_width, m_height, {}};
  const std::size_t row = 3 * static_cast<std::size_t>(m_width), rows = static_cast<std::size_t>(m_height);
  picture.rgb.resize(row * rows);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, m_frame);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  for (std::size_t y = 0; y < rows; ++y) {  // OpenGL's first row is the lowest
    glReadPixels(0, m_height - 1 - static_cast<int>(y), m_width, 1, GL_RGB, GL_UNSIGNED_BYTE,
                 picture.rgb.data() + y * row);
  }
  return picture;
}

}}  // namespace lpc::LPC_PRECISION
