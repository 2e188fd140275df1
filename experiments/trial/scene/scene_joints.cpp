// SPDX-License-Identifier: Zlib
#include <cmath>
#include <limits>

#include "experiments/trial/scene/scene_parsed.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

// Normalised; in 2D the components in the plane.
template <int D>
Vec<D> direction(TableReader& joint, SceneNumbers& numbers, const std::string& key, const toml::node& node) {
  const Vec<D> v = numbers.vector<D>(node);
  const std::string valid = "; valid: such as " + std::string(key == "axis" ? "[0, 0, 1]" : "[1, 0, 0]");
  // Shorter vectors lose digits when squared.
  if (!(v.squaredNorm() >= std::numeric_limits<Real>::min()))
    joint.fail(node, "'" + key + "' has no length" + (D == 2 ? " in the plane" : ""));
  if (!std::isfinite(v.norm())) joint.fail(node, "'" + key + "' is longer than numbers hold" + valid);
  return v.normalized();
}

// Shortest rotation from one unit vector to another; half a turn is about `spare`.
Rot<3> onto(const Vec<3>& from, const Vec<3>& to, const Vec<3>& spare) {
  const Real w = 1 + from.dot(to);
  const bool half = !(w > 8 * std::numeric_limits<Real>::epsilon());
  const Vec<3> v = half ? spare : cross(from, to);
  return half ? Rot<3>{0, v[0], v[1], v[2]} : Rot<3>{w, v[0], v[1], v[2]}.normalized();
}

// The frame's z is `axis`, its x is `along`. If one is missing, the shortest rotation to the other decides.
Rot<2> readFrame(TableReader& joint, SceneNumbers& numbers, const Rot<2>& none) {
  joint.find("axis");  // of 3D
  const toml::node* along = joint.find("along");
  if (!along) return none;
  const Vec<2> x = direction<2>(joint, numbers, "along", *along);
  return {x[0], x[1]};
}
Rot<3> readFrame(TableReader& joint, SceneNumbers& numbers, const Rot<3>& none) {
  const Vec<3> ex(1, 0, 0), ez(0, 0, 1);
  const toml::node *axis = joint.find("axis"), *along = joint.find("along");
  const Rot<3> q = axis ? onto(ez, direction<3>(joint, numbers, "axis", *axis), ex) : none;
  if (!along) return q;
  Vec<3> x = q.inverse() * direction<3>(joint, numbers, "along", *along);
  if (axis && !numbers.rehearsing()) {
    if (std::abs(x[2]) > Real(1e-5)) joint.fail(*along, "'along' is not at a right angle to 'axis'; valid: across it");
    x = Vec<3>(x[0], x[1], 0).normalized();
  }
  return q * onto(ex, x, ez);
}

constexpr const char* kChosen = "$joint";

Spec readChosen(TableReader& joint, const std::string& chosen) {
  if (chosen.empty()) joint.fail(joint.require("kind"), "there is no parameter 'joint' that holds a kind as text");
  if (const toml::node* given = joint.find("parameters")) {
    joint.fail(*given, "'parameters' of a kind that is chosen; valid: in the text of the parameter 'joint'");
  }
  return atBlock(joint, [&] { return Spec::parse(chosen); });
}

}  // namespace

template <int D>
JointDef<D> readJoint(TableReader& joint, SceneNumbers& numbers, const std::string& chosen) {
  JointDef<D> def;
  def.X_WJ.p = numbers.vector<D>(joint.require("anchor"));
  if (const toml::node* whole = joint.find("rotation")) {
    if (joint.find("axis") || joint.find("along")) {
      joint.fail(*whole, "'rotation' beside 'axis' or 'along'; valid: that, or those");
    }
    def.X_WJ.q = readRotation<D>(joint, numbers);
  } else {
    def.X_WJ.q = readFrame(joint, numbers, Rot<D>{});
  }
  if (const toml::node* node = joint.find("anchor_b")) def.X_WJb = Pose<D>{numbers.vector<D>(*node), def.X_WJ.q};
  def.collide = joint.flag("collide", false);
  if (const toml::node* node = joint.find("break_force")) def.breakForce = static_cast<Real>(numbers.number(*node));
  if (const toml::node* node = joint.find("break_torque")) def.breakTorque = static_cast<Real>(numbers.number(*node));
  const bool isChosen = joint.requireString("kind") == kChosen;
  def.kind = (isChosen ? readChosen(joint, chosen) : readKind(joint, numbers, StageKind::joint, D)).text();
  atBlock(joint, [&] {
    const Spec kind = Spec::parse(def.kind);
    return kindOf(StageKind::joint, kind.name, numbers, D).create(kind);
  });
  if (numbers.rehearsing()) return def;
  // Remaining errors are between the kind and the frames, except the forces at which a joint breaks.
  try {
    makeJoint<D>(def, {}, {});
  } catch (const UserError& e) {
    if (isChosen && def.breakForce > 0 && def.breakTorque > 0) {
      throw UnsupportedJoint(std::string("parameter 'joint': ") + e.what());
    }
    joint.fail(e.what());
  }
  return def;
}

template JointDef<2> readJoint(TableReader&, SceneNumbers&, const std::string&);
template JointDef<3> readJoint(TableReader&, SceneNumbers&, const std::string&);

}}  // namespace lpc::LPC_PRECISION
