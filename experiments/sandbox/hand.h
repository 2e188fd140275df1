// SPDX-License-Identifier: Zlib
// The mouse's actions on a session with the current tool. It uses the camera but no window, so tests can drive it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "experiments/sandbox/drawn_shape.h"
#include "experiments/sandbox/pick.h"
#include "experiments/sandbox/session.h"
#include "framework/draw/debug_draw.h"

namespace lpc { inline namespace LPC_PRECISION {

enum class Tool { grab, circle, box, capsule, polygon, compound, joint };
struct ToolInfo {
  Tool tool;
  const char* name;
  const char* meaning;
};
std::span<const ToolInfo> tools();

template <int D>
class Hand {
 public:
  Hand(Session<D>& session, ViewCamera<D>& camera) : m_session(session), m_camera(camera) {}

  // --- the left button; positions in pixels of the window -----------------------------------------------------------
  void press(const Vec<2>& pixel, bool addToSelection);
  void move(const Vec<2>& pixel);
  void release(const Vec<2>& pixel);
  /// Finishes a polygon or a compound, which becomes a body.
  void finish();
  /// Cancels drawing, dragging or joining.
  void cancel();
  /// Call before each step while running: the spring pulls; with `keepRotation` the body does not turn.
  void pull(bool keepRotation);
  /// Rotates the selected bodies as one by this angle (rad): about the held point, or else about their common centre of
  /// mass. Their motion about it turns with them, so that momentum and energy are kept, and joints between them fit as
  /// before. A body held by the spring turns alone.
  void turn(Real angle);
  /// While the world is paused, all selected bodies follow the cursor exactly; otherwise a spring pulls the held one.
  void setPaused(bool paused);

  // --- what keys and menus do to the selection, or to the body under the cursor when nothing is selected ------------
  void removeSelected();
  void makeStatic();  // and dynamic again
  void pin();         // and free again
  void merge();
  void splitByShape();
  void wake();

  Tool tool = Tool::grab;
  bool drawsStatic = false;     // drawn bodies are added as fixed ones
  std::string joint = "pivot";  // kind of new joints
  const std::vector<int>& selected() const { return m_selected; }
  void select(std::vector<int> bodies) { m_selected = std::move(bodies); }
  std::vector<int> chosen() const;  // the selected ones, or the one under the cursor
  const Vec<2>& cursor() const { return m_cursor; }

  bool drawing() const { return tool != Tool::grab && tool != Tool::joint; }
  /// The preview, the selection, the spring and the rectangle.
  void draw(DebugDraw<D>& out) const;
  /// The outlines of the selected bodies, at a competitor's poses.
  void drawSelected(std::size_t competitor, DebugDraw<D>& out) const;

 private:
  struct Placed {
    int body;
    Vec<D> p_PB;  // from the cursor's point, in world axes
  };
  struct Carried {
    int body;
    Vec<D> at;                   // p_B of the held point, in the body's frame
    Vec<D> target;               // of the cursor, in the world
    std::vector<Placed> placed;  // if paused: all that follow the cursor
  };
  struct FirstEnd {
    int body;  // -1: the world
    Vec<D> point;
  };

  Vec<D> target(const Vec<2>& pixel) const;
  std::vector<int> there(const std::vector<int>& bodies) const;  // without removed ones
  std::optional<BodyDef<D>> preview() const;
  void carry(const Vec<2>& pixel);
  void add(BodyDef<D> def);
  void join(const Vec<2>& pixel);
  Vec<2> planePoint(const Vec<2>& pixel) const;
  DrawingPlane<D> plane() const;

  Session<D>& m_session;
  ViewCamera<D>& m_camera;
  Vec<2> m_cursor = Vec<2>::Zero();
  bool m_paused = false;
  std::vector<int> m_selected;
  std::optional<Carried> m_carried;
  std::optional<Vec<2>> m_corner;        // of the selection rectangle
  std::vector<Vec<2>> m_points;          // of the drawing, on the plane
  std::optional<Vec<D>> m_planeThrough;  // of the drawing
  std::vector<BodyDef<D>> m_pieces;      // of a compound
  std::optional<FirstEnd> m_first;
};

}}  // namespace lpc::LPC_PRECISION
