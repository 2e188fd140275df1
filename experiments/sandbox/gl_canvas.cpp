// SPDX-License-Identifier: Zlib
#include "experiments/sandbox/gl_canvas.h"

#include <epoxy/gl.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "framework/shape/curved_core.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

constexpr std::size_t kMostMeshes = 20000;  // then all are dropped: their bodies may be gone
constexpr float kHidden = 0.3f;             // visibility of lines and points behind a body
constexpr float kLineWidth = 1.2f;          // px, in 2D
constexpr unsigned char kGlass = 50;        // alpha
constexpr std::size_t kMostRays = 20000;    // per picture: some milliseconds
constexpr float kDash = 7;                  // px

constexpr const char* kVertexShader = R"(#version 330 core
layout(location = 0) in vec4 at;
layout(location = 1) in vec4 colour;
uniform mat4 view;
uniform float strength;
out vec4 tint;
void main() {
  gl_Position = view * vec4(at.xyz, 1.0);
  gl_PointSize = at.w;
  tint = vec4(colour.rgb, colour.a * strength);
})";
constexpr const char* kFlatShader = R"(#version 330 core
in vec4 tint;
out vec4 pixel;
void main() { pixel = tint; })";
// A separate shader: software GL runs all shaders slowly if one may discard pixels.
constexpr const char* kRoundShader = R"(#version 330 core
in vec4 tint;
out vec4 pixel;
void main() {
  if (length(gl_PointCoord - vec2(0.5)) > 0.5) discard;
  pixel = tint;
})";

unsigned shaderOf(unsigned kind, const char* text) {
  const unsigned shader = glCreateShader(kind);
  glShaderSource(shader, 1, &text, nullptr);
  glCompileShader(shader);
  int good = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &good);
  if (good) return shader;
  char why[512] = "";
  glGetShaderInfoLog(shader, sizeof why, nullptr, why);
  throw UserError("OpenGL refuses a shader: " + std::string(why, std::find(why, why + sizeof why, '\n')));
}

// Shading shows the shape of a body of one colour: surfaces that face up or towards the viewer are bright.
DrawColour shaded(const DrawColour& c, float light) {
  const auto of = [&](unsigned char x) {
    return static_cast<unsigned char>(std::clamp(static_cast<float>(x) * light, 0.0f, 255.0f));
  };
  return {of(c.red), of(c.green), of(c.blue), c.alpha};
}

}  // namespace

template <int D>
GlCanvas<D>::GlCanvas() {
  for (const auto& [program, text] : {std::pair(&m_flat, kFlatShader), std::pair(&m_round, kRoundShader)}) {
    program->name = glCreateProgram();
    for (const unsigned shader : {shaderOf(GL_VERTEX_SHADER, kVertexShader), shaderOf(GL_FRAGMENT_SHADER, text)}) {
      glAttachShader(program->name, shader);
      glDeleteShader(shader);
    }
    glLinkProgram(program->name);
    program->view = glGetUniformLocation(program->name, "view");
    program->strength = glGetUniformLocation(program->name, "strength");
  }
  glGenVertexArrays(1, &m_array);
  glGenBuffers(1, &m_vertices);
  glGenBuffers(1, &m_indices);
  glBindVertexArray(m_array);
  glBindBuffer(GL_ARRAY_BUFFER, m_vertices);
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, m_indices);
  glVertexAttribPointer(0, 4, GL_FLOAT, GL_FALSE, sizeof(Vertex), nullptr);
  glVertexAttribPointer(1, 4, GL_UNSIGNED_BYTE, GL_TRUE, sizeof(Vertex),
                        reinterpret_cast<const void*>(offsetof(Vertex, colour)));
  glEnableVertexAttribArray(0);
  glEnableVertexAttribArray(1);
  glBindVertexArray(0);
}

template <int D>
GlCanvas<D>::~GlCanvas() {
  glDeleteBuffers(1, &m_vertices);
  glDeleteBuffers(1, &m_indices);
  glDeleteVertexArrays(1, &m_array);
  glDeleteProgram(m_flat.name);
  glDeleteProgram(m_round.name);
}

template <int D>
void GlCanvas<D>::begin(const ViewCamera<D>& camera) {
  m_camera = camera;
  m_part = 0, m_turns = 1;
  for (Layer* layer : {&m_under, &m_over, &m_edges, &m_lines, &m_points}) {
    layer->vertices.clear();
    layer->triangles.clear();
    layer->blends = false;
  }
  m_words.clear(), m_walls.clear(), m_bodies.clear();
  if (m_meshes.size() > kMostMeshes) m_meshes.clear();
}

template <int D>
void GlCanvas<D>::point(const Vec<D>& p, double pixels, const DrawColour& colour) {
  const Point at = near(p);
  m_points.vertices.push_back({at[0], at[1], D == 3 ? at[D - 1] : 0, static_cast<float>(pixels), colour});
  m_points.blends |= colour.alpha < 255;
}

template <int D>
void GlCanvas<D>::line(const Vec<D>& a, const Vec<D>& b, const DrawColour& colour) {
  addLine(m_lines, near(a), near(b), colour);
}

template <int D>
void GlCanvas<D>::text(const Vec<D>& p, std::string_view text, const DrawColour& colour) {
  m_words.push_back({p, std::string(text), colour});
}

template <int D>
void GlCanvas<D>::shape(const ShapeView<D>& shape, const Pose<D>& X_WS, const Look& look) {
  if (shape.core() == CoreClass::plane) return plane(X_WS, look);
  if (D == 2 || look.outline) return addSolid(shape, X_WS, look);
  if (!look.moves) return m_walls.push_back({shape, X_WS, look});
  m_bodies.push_back(X_WS.p);
  addSolid(shape, X_WS, look);
}

// Not every wall is tested with every body: one that hides a body of a heap hides others of it.
template <int D>
void GlCanvas<D>::addWalls() {
  if constexpr (D == 3) {
    if (m_bodies.empty()) m_bodies.push_back(m_camera.origin());
    const Vec<3> eye = m_camera.eye();
    const std::size_t stride = 1 + m_walls.size() * m_bodies.size() / kMostRays;
    const auto hides = [&](const Wall& wall) {
      const Aabb<3> box = boundingBox(wall.shape, wall.X_WS);
      const Vec<3> middle = box.center() - eye;
      const Real reach = (box.hi - box.lo).norm() / 2;
      for (std::size_t i = 0; i < m_bodies.size(); i += stride) {
        const Vec<3> way = m_bodies[i] - eye;
        const Real far = way.norm();
        if (!(far > 0) || way.cross(middle).norm() > reach * far) continue;  // beside the wall
        if (rayEntry(wall.shape, wall.X_WS, eye, Vec<3>(way / far), far).t >= 0) return true;
      }
      return false;
    };
    for (const Wall& wall : m_walls) {
      Look look = wall.look;
      if (hides(wall)) look.fill.alpha = kGlass;
      addSolid(wall.shape, wall.X_WS, look);
    }
  }
  m_walls.clear(), m_bodies.clear();
}

template <int D>
void GlCanvas<D>::addSolid(const ShapeView<D>& shape, const Pose<D>& X_WS, const Look& look) {
  const ShapeMesh<D>& seen = mesh(shape, X_WS.p);
  if (!look.outline) addFill(seen, X_WS, look);
  addEdges(seen, X_WS, look);
}

template <int D>
const ShapeMesh<D>& GlCanvas<D>::mesh(const ShapeView<D>& shape, const Vec<D>& p) {
  if (shape.core() == CoreClass::hull && !(shape.radius > 0)) {  // cheaper than a lookup
    meshOf(shape, 4, m_fresh);
    return m_fresh;
  }
  // Accurate to two fifths of a pixel: a thousand small balls need not be a million triangles.
  const Real radius = shape.radius + (shape.core() == CoreClass::curved ? shape.half.maxCoeff() : 0);
  const Real wanted = Real(3.15) * std::sqrt(radius * m_camera.scaleAt(p) / Real(0.8));
  int round = 8;
  for (const int finer : {12, 16, 24, 32, 48}) {
    if (wanted > Real(round)) round = finer;
  }
  auto& [kind, turn, numbers] = m_key;
  kind = shape.kind, turn = round;
  numbers.assign({shape.radius});
  numbers.insert(numbers.end(), shape.half.begin(), shape.half.end());
  if (shape.core() == CoreClass::hull) {
    for (const Vec<D>& vertex : shape.hull->vertices) numbers.insert(numbers.end(), vertex.begin(), vertex.end());
  } else if (shape.core() == CoreClass::curved) {
    const auto sizes = shape.curved->sizes();
    numbers.insert(numbers.end(), sizes.begin(), sizes.end());
  }
  const auto [at, fresh] = m_meshes.try_emplace(m_key);
  if (fresh) meshOf(shape, round, at->second);
  return at->second;
}

template <int D>
auto GlCanvas<D>::layerOf(const Look& look) -> Layer& {
  return (D == 2 ? look.moves : look.fill.alpha < 255) ? m_over : m_under;
}

template <int D>
void GlCanvas<D>::addFill(const ShapeMesh<D>& mesh, const Pose<D>& X_WS, const Look& look) {
  Layer& layer = layerOf(look);
  layer.blends |= look.fill.alpha < 255;
  const auto first = static_cast<std::uint32_t>(layer.vertices.size());
  const Eigen::Matrix<float, D, D> turn = X_WS.q.matrix().template cast<float>();
  const Point origin = near(X_WS.p);
  layer.vertices.resize(first + mesh.corners.size());
  Vertex* out = layer.vertices.data() + first;
  if constexpr (D == 2) {
    for (const Point& corner : mesh.corners) {
      const Point at = origin + turn * corner;
      *out++ = {at[0], at[1], 0, 0, look.fill};
    }
  } else {
    const Point light =
        turn.transpose() * (Vec<3>(Real(0.1), Real(0.2), 0) + Real(0.15) * m_camera.towards()).template cast<float>();
    for (std::size_t i = 0; i < mesh.corners.size(); ++i) {
      const Point at = origin + turn * mesh.corners[i];
      *out++ = {at[0], at[1], at[2], 0, shaded(look.fill, 0.75f + light.dot(mesh.normals[i]))};
    }
  }
  for (const std::uint32_t corner : mesh.triangles) layer.triangles.push_back(first + corner);
}

template <int D>
void GlCanvas<D>::addEdges(const ShapeMesh<D>& mesh, const Pose<D>& X_WS, const Look& look) {
  if (look.edge.alpha == 0) return;
  Layer& layer = D == 2 ? layerOf(look) : m_edges;
  const Eigen::Matrix<float, D, D> turn = X_WS.q.matrix().template cast<float>();
  const Point origin = near(X_WS.p);
  const bool dashed = look.outline && m_turns > 1;
  float walked = 0;
  for (std::size_t i = 0; i < mesh.ends.size(); i += 2) {
    const Point a = origin + turn * mesh.ends[i], b = origin + turn * mesh.ends[i + 1];
    if (dashed) {
      walked = addDashes(layer, a, b, look.edge, walked);
    } else {
      addLine(layer, a, b, look.edge);
    }
  }
}

// Dashes of an edge that begins after this many pixels of the outline; returns the number at its end.
template <int D>
float GlCanvas<D>::addDashes(Layer& layer, const Point& a, const Point& b, const DrawColour& colour, float walked) {
  const Point along = b - a;
  const float length =
      static_cast<float>(m_camera.scaleAt((a + b).template cast<Real>() / 2 + m_camera.origin())) * along.norm();
  const auto turns = static_cast<float>(m_turns);
  const float longest = 100 * kDash * turns;  // of an unbounded edge a hundred turns are visible
  if (!(length > 0) || length > longest) {
    addLine(layer, a, b, colour);
    return walked;
  }
  const float first = std::floor(walked / (kDash * turns)) * turns + static_cast<float>(m_part);
  for (float dash = first * kDash; dash < walked + length; dash += kDash * turns) {
    const float from = std::max((dash - walked) / length, 0.0f), to = std::min((dash + kDash - walked) / length, 1.0f);
    if (from < to) addLine(layer, a + from * along, a + to * along, colour);
  }
  return walked + length;
}

// In 2D a strip of any width, in 3D a line of OpenGL.
template <int D>
void GlCanvas<D>::addLine(Layer& layer, const Point& a, const Point& b, const DrawColour& colour) {
  layer.blends |= colour.alpha < 255;
  if constexpr (D == 2) {
    const Point along = b - a;
    const float length = along.norm();
    if (!(length > 0)) return;
    const Point aside = kLineWidth / 2 / static_cast<float>(m_camera.scaleAt({})) / length * Point(-along[1], along[0]);
    const auto first = static_cast<std::uint32_t>(layer.vertices.size());
    for (const Point& p : {Point(a - aside), Point(b - aside), Point(b + aside), Point(a + aside)}) {
      layer.vertices.push_back({p[0], p[1], 0, 0, colour});
    }
    for (const std::uint32_t corner : {0, 1, 2, 0, 2, 3}) layer.triangles.push_back(first + corner);
  } else {
    for (const Point* p : {&a, &b}) layer.vertices.push_back({(*p)[0], (*p)[1], (*p)[2], 0, colour});
  }
}

// The visible part. In 3D, lines at powers of ten show the scale.
template <int D>
void GlCanvas<D>::plane(const Pose<D>& X_WS, const Look& look) {
  Vec<D> middle = X_WS.inverse() * m_camera.origin();
  ShapeMesh<D> patch;
  patch.triangles = {0, 1, 2, 0, 2, 3};
  if constexpr (D == 2) {
    const Real reach = Real(2 * (m_camera.width() + m_camera.height())) / m_camera.scaleAt({});
    const Real left = middle[0] - reach, right = middle[0] + reach, bottom = std::min<Real>(middle[1], 0) - reach;
    for (const Vec<2>& p : {Vec<2>(left, bottom), Vec<2>(right, bottom), Vec<2>(right, 0), Vec<2>(left, 0)}) {
      patch.corners.push_back(p.template cast<float>());
    }
    patch.ends = {patch.corners[2], patch.corners[3]};
  } else {
    const Real step = std::pow(Real(10), std::floor(std::log10(m_camera.distance() / 2)));
    const auto on = [](Real x, Real z) { return ShapeMesh<3>::Point(static_cast<float>(x), 0, static_cast<float>(z)); };
    // A single face of that size would have inaccurate depths near the viewer, and lines on it would flicker.
    for (const Real size : {10 * m_camera.distance(), m_camera.farthest()}) {
      for (const auto& [x, z] : {std::pair(-1, -1), std::pair(-1, 1), std::pair(1, 1), std::pair(1, -1)}) {
        patch.corners.push_back(on(middle[0] + Real(x) * size, middle[2] + Real(z) * size));
        patch.normals.push_back(ShapeMesh<3>::Point::UnitY());
      }
    }
    for (std::uint32_t k = 0; k < 4; ++k) {
      const std::uint32_t next = (k + 1) % 4;
      patch.triangles.insert(patch.triangles.end(), {k, k + 4, next + 4, k, next + 4, next});
    }
    constexpr int kLines = 25;  // on each side of the middle
    const Real x0 = std::round(middle[0] / step) * step, z0 = std::round(middle[2] / step) * step;
    const Real reach = kLines * step;
    for (int k = -kLines; k <= kLines; ++k) {
      const Real aside = Real(k) * step;
      for (const Real end : {-reach, reach}) patch.ends.push_back(on(x0 + aside, z0 + end));
      for (const Real end : {-reach, reach}) patch.ends.push_back(on(x0 + end, z0 + aside));
    }
  }
  if (!look.outline) addFill(patch, X_WS, look);
  Look faint = look;
  if (D == 3) faint.edge.alpha = static_cast<unsigned char>(look.edge.alpha / 3);
  addEdges(patch, X_WS, faint);
}

template <int D>
void GlCanvas<D>::use(const Program& program, const Layer& layer, float strength) {
  glUseProgram(program.name);
  glUniformMatrix4fv(program.view, 1, GL_FALSE, m_camera.matrix().data());
  glUniform1f(program.strength, strength);
  (layer.blends || strength < 1 ? glEnable : glDisable)(GL_BLEND);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(layer.vertices.size() * sizeof(Vertex)), layer.vertices.data(),
               GL_STREAM_DRAW);
}

template <int D>
void GlCanvas<D>::drawTriangles(const Layer& layer) {
  if (layer.triangles.empty()) return;
  use(m_flat, layer, 1);
  glBufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(layer.triangles.size() * sizeof(std::uint32_t)),
               layer.triangles.data(), GL_STREAM_DRAW);
  glDrawElements(GL_TRIANGLES, static_cast<int>(layer.triangles.size()), GL_UNSIGNED_INT, nullptr);
}

template <int D>
void GlCanvas<D>::drawVertices(const Layer& layer, unsigned primitive, float strength) {
  if (layer.vertices.empty()) return;
  use(primitive == GL_POINTS ? m_round : m_flat, layer, strength);
  glDrawArrays(primitive, 0, static_cast<int>(layer.vertices.size()));
}

template <int D>
void GlCanvas<D>::drawLayers() {
  if constexpr (D == 2) {
    for (const Layer* layer : {&m_under, &m_over, &m_lines}) drawTriangles(*layer);
    drawVertices(m_points, GL_POINTS, 1);
  } else {
    glEnable(GL_DEPTH_TEST);
    glEnable(GL_CULL_FACE);
    glEnable(GL_POLYGON_OFFSET_FILL);  // edges lie in front of their faces
    glPolygonOffset(1, 1);
    glDepthFunc(GL_LEQUAL);
    drawTriangles(m_under);
    drawVertices(m_edges, GL_LINES, 1);
    glDepthMask(GL_FALSE);
    drawTriangles(m_over);
    for (const auto& [order, strength] : {std::pair(GL_LEQUAL, 1.0f), std::pair(GL_GREATER, kHidden)}) {
      glDepthFunc(static_cast<GLenum>(order));
      drawVertices(m_lines, GL_LINES, strength);
      drawVertices(m_points, GL_POINTS, strength);
    }
    glDepthMask(GL_TRUE);
    for (const GLenum used : {GL_DEPTH_TEST, GL_CULL_FACE, GL_POLYGON_OFFSET_FILL}) glDisable(used);
  }
}

template <int D>
void GlCanvas<D>::drawWords() {
  const ImVec2 corner(static_cast<float>(m_camera.left()), static_cast<float>(m_camera.top()));
  const ImVec2 end(corner.x + static_cast<float>(m_camera.width()), corner.y + static_cast<float>(m_camera.height()));
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  list.PushClipRect(corner, end, true);
  for (const Word& word : m_words) {
    const Eigen::Vector2f at = m_camera.toPixel(word.p).template cast<float>();
    if (!(at[0] < end.x && at[1] > corner.y && at[1] - ImGui::GetFontSize() < end.y)) continue;
    const DrawColour& c = word.colour;
    list.AddText({std::round(at[0]), std::round(at[1] - ImGui::GetFont()->Ascent)},
                 IM_COL32(c.red, c.green, c.blue, c.alpha), word.text.data(), word.text.data() + word.text.size());
  }
  list.PopClipRect();
}

template <int D>
void GlCanvas<D>::end() {
  addWalls();
  const int windowHeight = static_cast<int>(ImGui::GetIO().DisplaySize.y);
  const int bottom = windowHeight - m_camera.top() - m_camera.height();
  glViewport(m_camera.left(), bottom, m_camera.width(), m_camera.height());
  glScissor(m_camera.left(), bottom, m_camera.width(), m_camera.height());
  glEnable(GL_SCISSOR_TEST);
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  glEnable(GL_PROGRAM_POINT_SIZE);
  glBindVertexArray(m_array);
  glBindBuffer(GL_ARRAY_BUFFER, m_vertices);
  drawLayers();
  glBindVertexArray(0);
  glUseProgram(0);
  for (const GLenum used : {GL_SCISSOR_TEST, GL_BLEND, GL_PROGRAM_POINT_SIZE}) glDisable(used);
  drawWords();
}

template class GlCanvas<2>;
template class GlCanvas<3>;

}}  // namespace lpc::LPC_PRECISION
