// SPDX-License-Identifier: Zlib
// Draws into an OpenGL 3.3 window. Drawing commands are collected first, in metres relative to the camera's origin, as
// coloured triangles, lines and points, so that a picture takes a few draw calls for any number of bodies.
#pragma once

#include <array>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "experiments/sandbox/shape_mesh.h"
#include "experiments/sandbox/view_camera.h"
#include "framework/draw/debug_draw.h"

namespace lpc { inline namespace LPC_PRECISION {

/// Created and used while a Window lives, `end` within one of its frames, because ImGui draws the text.
template <int D>
class GlCanvas final : public DebugDraw<D> {
 public:
  GlCanvas();
  ~GlCanvas() override;
  GlCanvas(const GlCanvas&) = delete;
  GlCanvas& operator=(const GlCanvas&) = delete;

  void begin(const ViewCamera<D>& camera);
  /// Outlines are dashed until the next `begin`: dash number `part` of `turns`. Coinciding outlines of several
  /// competitors thus show all their colours.
  void dash(int part, int turns) { m_part = part, m_turns = turns; }
  void point(const Vec<D>& p, double pixels, const DrawColour& colour) override;
  /// In 3D, hidden parts of lines and points are drawn faintly.
  void line(const Vec<D>& a, const Vec<D>& b, const DrawColour& colour) override;
  /// In 3D, a fixed solid is transparent while it hides a moving body or, without bodies, the camera's target. That is
  /// decided in `end`, and hulls of shapes must live until then.
  void shape(const ShapeView<D>& shape, const Pose<D>& X_WS, const Look& look) override;
  void text(const Vec<D>& p, std::string_view text, const DrawColour& colour) override;
  /// Draws everything over the present content.
  void end();

 private:
  struct Vertex {
    float x, y, z, pixels;  // of a point, its size
    DrawColour colour;
  };
  struct Layer {
    std::vector<Vertex> vertices;
    std::vector<std::uint32_t> triangles;
    bool blends = false;  // whether it contains something transparent
  };
  struct Program {
    unsigned name = 0;
    int view = -1, strength = -1;  // its uniforms
  };
  struct Word {
    Vec<D> p;
    std::string text;
    DrawColour colour;
  };
  struct Wall {
    ShapeView<D> shape;
    Pose<D> X_WS;
    Look look;
  };
  // The identity of a mesh: kind, corners of a full turn, and the shape's numbers.
  using MeshKey = std::tuple<ShapeKind, int, std::vector<Real>>;

  using Point = typename ShapeMesh<D>::Point;

  Point near(const Vec<D>& p) const { return (p - m_camera.origin()).template cast<float>(); }
  const ShapeMesh<D>& mesh(const ShapeView<D>& shape, const Vec<D>& p);
  void plane(const Pose<D>& X_WS, const Look& look);
  void addWalls();
  void addSolid(const ShapeView<D>& shape, const Pose<D>& X_WS, const Look& look);
  void addFill(const ShapeMesh<D>& mesh, const Pose<D>& X_WS, const Look& look);
  void addEdges(const ShapeMesh<D>& mesh, const Pose<D>& X_WS, const Look& look);
  void addLine(Layer& layer, const Point& a, const Point& b, const DrawColour& colour);
  float addDashes(Layer& layer, const Point& a, const Point& b, const DrawColour& colour, float walked);
  Layer& layerOf(const Look& look);
  void drawLayers();
  void use(const Program& program, const Layer& layer, float strength);
  void drawTriangles(const Layer& layer);
  void drawVertices(const Layer& layer, unsigned primitive, float strength);
  void drawWords();

  ViewCamera<D> m_camera;
  int m_part = 0, m_turns = 1;  // of dashes
  // Under and over: in 2D fixed and moving bodies, with their edges; in 3D opaque and transparent ones.
  Layer m_under, m_over, m_edges, m_lines, m_points;
  std::vector<Word> m_words;
  std::vector<Wall> m_walls;     // in 3D
  std::vector<Vec<D>> m_bodies;  // centres of moving bodies
  std::map<MeshKey, ShapeMesh<D>> m_meshes;
  MeshKey m_key;            // of the current lookup
  ShapeMesh<D> m_fresh;     // not worth caching
  Program m_flat, m_round;  // the second one cuts points round
  unsigned m_array = 0, m_vertices = 0, m_indices = 0;
};

}}  // namespace lpc::LPC_PRECISION
