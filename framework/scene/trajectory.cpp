// SPDX-License-Identifier: Zlib
#include "framework/scene/trajectory.h"

#include <charconv>
#include <cmath>
#include <ostream>
#include <string>
#include <vector>

namespace lpc { inline namespace LPC_PRECISION {
namespace {

template <int D>
constexpr const char* kColumns = D == 2 ? "step,time,body,generation,x,y,angle,vx,vy,omega,awake"
                                        : "step,time,body,generation,x,y,z,qw,qx,qy,qz,vx,vy,vz,wx,wy,wz,awake";

std::string quoted(std::string columns) {
  for (std::size_t at = 0; (at = columns.find(',', at)) != std::string::npos; at += 3) columns.replace(at, 1, "\",\"");
  return '"' + columns + '"';
}

template <class Number>
void put(std::string& row, Number x, TrajectoryFormat format) {
  if (!row.empty()) row += ',';
  if (format == TrajectoryFormat::asJson && !std::isfinite(double(x))) {
    row += "null";
    return;
  }
  char text[40];
  row.append(text, std::to_chars(text, text + sizeof text, x).ptr);
}

std::vector<Real> stateOf(const Pose<2>& X, const Motion<2>& m) {
  return {X.p[0], X.p[1], Real(X.q.radians()), m.v[0], m.v[1], m.w[0]};
}
std::vector<Real> stateOf(const Pose<3>& X, const Motion<3>& m) {
  return {X.p[0], X.p[1], X.p[2], X.q.w, X.q.x, X.q.y, X.q.z, m.v[0], m.v[1], m.v[2], m.w[0], m.w[1], m.w[2]};
}

}  // namespace

template <int D>
TrajectoryWriter<D>::TrajectoryWriter(std::ostream& out, TrajectoryFormat format) : m_out(out), m_format(format) {
  switch (format) {
    case TrajectoryFormat::asCsv:
      m_out << kColumns<D> << '\n';
      return;
    case TrajectoryFormat::asJson:
      m_out << "{\"dimension\":" << D << ",\"columns\":[" << quoted(kColumns<D>) << "],\"rows\":[";
      return;
  }
}

template <int D>
void TrajectoryWriter<D>::frame(const Simulation<D>& world) {
  const Bodies<D>& b = world.bodies();
  std::string row;
  for (std::size_t i = 0; i < b.pose.size(); ++i) {
    if (!b.used[i]) continue;
    row.clear();
    put(row, world.stepCount(), m_format), put(row, world.time(), m_format), put(row, i, m_format);
    put(row, b.generation[i], m_format);
    for (const Real x : stateOf(b.pose[i], b.motion[i])) put(row, x, m_format);
    put(row, int(b.awake[i]), m_format);
    switch (m_format) {
      case TrajectoryFormat::asCsv:
        m_out << row << '\n';
        break;
      case TrajectoryFormat::asJson:
        m_out << (m_first ? "\n[" : ",\n[") << row << ']';
        break;
    }
    m_first = false;
  }
}

template <int D>
void TrajectoryWriter<D>::finish() {
  if (m_format == TrajectoryFormat::asJson) m_out << "\n]}\n";
}

template class TrajectoryWriter<2>;
template class TrajectoryWriter<3>;

}}  // namespace lpc::LPC_PRECISION
