// SPDX-License-Identifier: Zlib
// What draws into an OpenGL 3.3 window. All that is drawn is first collected, in metres less the camera's origin, as
// triangles, lines and points of colour, so that a picture takes a handful of draw calls however many bodies there are.
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

/// To be made and used while a Window lives, `end` within a frame of it: words are ImGui's.
template <int D>
class GlCanvas final : public DebugDraw<D> {
 public:
  GlCanvas();
  ~GlCanvas() override;
  GlCanvas(const GlCanvas&) = delete;
  GlCanvas& operator=(const GlCanvas&) = delete;

  void begin(const ViewCamera<D>& camera);
  /// From now on, until `begin`, outlines are dashed: their `part`-th of so many turns. Where outlines of several
  /// competitors lie on one another, all of their colours are seen so.
  void dash(int part, int turns) { m_part = part, m_turns = turns; }
  void point(const Vec<D>& p, double pixels, const DrawColour& colour) override;
  /// In 3D what is hidden of lines and points is seen faintly.
  void line(const Vec<D>& a, const Vec<D>& b, const DrawColour& colour) override;
  /// In 3D a solid that never moves is of glass while it hides one that does, or with nobody there what the camera
  /// looks at. Which do is known at the end: until then hulls of shapes stay where they are.
  void shape(const ShapeView<D>& shape, const Pose<D>& X_WS, const Look& look) override;
  void text(const Vec<D>& p, std::string_view text, const DrawColour& colour) override;
  /// Draws it all over what is there.
  void end();

 private:
  struct Vertex {
    float x, y, z, pixels;  // of a point, its size
    DrawColour colour;
  };
  struct Layer {
    std::vector<Vertex> vertices;
    std::vector<std::uint32_t> triangles;
    bool blends = false;  // one sees through something of it
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
  // All that a mesh depends on: kind, corners of a full turn, and the shape's numbers.
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
  // Under and over: in the plane what is fixed and what moves, with their edges; in space what hides others and what
  // one sees through.
  Layer m_under, m_over, m_edges, m_lines, m_points;
  std::vector<Word> m_words;
  std::vector<Wall> m_walls;     // in 3D
  std::vector<Vec<D>> m_bodies;  // middles of what moves
  std::map<MeshKey, ShapeMesh<D>> m_meshes;
  MeshKey m_key;            // of the one that is looked for
  ShapeMesh<D> m_fresh;     // not worth keeping
  Program m_flat, m_round;  // the second cuts points round
  unsigned m_array = 0, m_vertices = 0, m_indices = 0;
};

}}  // namespace lpc::LPC_PRECISION
