// SPDX-License-Identifier: Zlib
#include "tests/determinism/trace.h"

#include <algorithm>
#include <bit>
#include <cstdio>
#include <istream>
#include <ostream>
#include <sstream>
#include <type_traits>

namespace lpc { inline namespace LPC_PRECISION { namespace test {
namespace {

using Bits = std::conditional_t<sizeof(Real) == 8, std::uint64_t, std::uint32_t>;

std::string hex(Real x) {
  char text[20];
  std::snprintf(text, sizeof text, " %0*llx", 2 * static_cast<int>(sizeof(Real)),
                static_cast<unsigned long long>(std::bit_cast<Bits>(x)));
  return text;
}
template <class Numbers>
std::string hexAll(const Numbers& numbers) {
  std::string out;
  for (const Real x : numbers) out += hex(x);
  return out;
}
std::string hexRotation(const Rot<2>& q) { return hex(q.c) + hex(q.s); }
std::string hexRotation(const Rot<3>& q) { return hex(q.w) + hex(q.x) + hex(q.y) + hex(q.z); }

template <int D>
std::string pairName(const Manifold<D>& m) {
  return std::to_string(m.bodyA) + '-' + std::to_string(m.bodyB);
}

// The contacts of a step before the solver changes them.
template <int D>
struct ContactLines final : ContactListener<D> {
  std::vector<std::string> lines;

  bool begin(const World<D>&, const Manifold<D>& m) override { return persist(m); }
  bool persist(const World<D>&, const Manifold<D>& m) override { return persist(m); }
  bool persist(const Manifold<D>& m) {
    std::string line = "contacts " + pairName(m) + hexAll(m.normal);
    for (int i = 0; i < m.count; ++i) {
      const ContactPoint<D>& c = m.points[static_cast<std::size_t>(i)];
      line += hex(c.separation) + hexAll(c.localA) + hexAll(c.localB) + hexAll(c.impulse);
    }
    lines.push_back(line);
    return true;
  }
};

// All lines of one step, in the order of its stages.
template <int D>
std::vector<std::string> stepLines(World<D>& world, ContactLines<D>& contacts) {
  std::vector<std::string> lines;
  const Proxies<D>& proxies = world.proxies();
  for (ProxyId i = 0; i < proxies.size(); ++i) {
    if (proxies.isFree(i)) continue;
    const Aabb<D> box = proxies.box(i);
    lines.push_back("boxes " + std::to_string(proxies.body[static_cast<std::size_t>(i)]) + hexAll(box.lo) +
                    hexAll(box.hi));
  }
  lines.push_back("pairs all" + hex(static_cast<Real>(world.profiler().frame().pairs)));
  lines.insert(lines.end(), contacts.lines.begin(), contacts.lines.end());
  contacts.lines.clear();
  const Bodies<D>& bodies = world.bodies();
  const auto each = [&](const char* stage, const auto& numbers) {
    for (std::size_t i = 0; i < bodies.pose.size(); ++i) {
      if (bodies.used[i]) lines.push_back(stage + (' ' + std::to_string(i)) + numbers(i));
    }
  };
  each("sleep", [&](std::size_t i) { return hex(bodies.awake[i]) + hexAll(bodies.sleep[i]); });
  for (const Manifold<D>& m : world.manifolds()) {
    std::string line = "impulses " + pairName(m);
    for (int i = 0; i < m.count; ++i) line += hexAll(m.points[static_cast<std::size_t>(i)].impulse);
    lines.push_back(line);
  }
  for (const JointRecord<D>& j : world.joints()) {
    lines.push_back("impulses " + std::to_string(j.bodyA) + '-' + std::to_string(j.bodyB) + hexAll(j.impulse));
  }
  each("velocities", [&](std::size_t i) { return hexAll(bodies.motion[i].v) + hexAll(bodies.motion[i].w); });
  each("positions", [&](std::size_t i) { return hexAll(bodies.pose[i].p) + hexRotation(bodies.pose[i].q); });
  return lines;
}

// Calls take("scene step stage body numbers") until it returns false.
template <int D>
void traceScene(const PinnedScene<D>& scene, const std::function<bool(const std::string&)>& take) {
  ContactLines<D> contacts;
  play<D>(scene, &contacts, [&](World<D>& world) {
    const std::string start = scene.name + ' ' + std::to_string(world.stepCount() - 1) + ' ';
    for (const std::string& line : stepLines(world, contacts)) {
      if (!take(start + line)) return false;
    }
    return true;
  });
}

std::vector<std::string> words(const std::string& line) {
  std::istringstream in(line);
  std::vector<std::string> out;
  for (std::string word; in >> word;) out.push_back(word);
  return out;
}

std::string described(const std::string& bits) {
  char value[40];
  const auto pattern = static_cast<Bits>(std::stoull(bits, nullptr, 16));
  std::snprintf(value, sizeof value, " (%.17g)", double(std::bit_cast<Real>(pattern)));
  return bits + value;
}

constexpr std::size_t kNumbers = 4;  // words before the first bit pattern

Difference differenceOf(const std::string& here, const std::string& there) {
  const std::vector<std::string> a = words(here), b = words(there);
  Difference d{std::stoi(a[1]), a[2], a[3], ""};
  d.text = a[0] + ": the first difference is in step " + a[1] + ", stage " + a[2] + ", body " + a[3] + "\n";
  const bool sameSubject = a.size() == b.size() && std::equal(a.begin(), a.begin() + kNumbers, b.begin());
  if (!sameSubject) {
    d.text += "  here:  " + here + "\n  there: " + there + "\n";
    return d;
  }
  for (std::size_t i = kNumbers; i < a.size(); ++i) {
    if (a[i] == b[i]) continue;
    d.text +=
        "  number " + std::to_string(i - kNumbers) + ": " + described(a[i]) + " here, " + described(b[i]) + " there\n";
  }
  return d;
}

}  // namespace

template <int D>
void writeTrace(const PinnedScene<D>& scene, std::ostream& out) {
  traceScene<D>(scene, [&](const std::string& line) {
    out << line << '\n';
    return true;
  });
}

template <int D>
std::optional<Difference> firstDifference(const PinnedScene<D>& scene, std::istream& trace) {
  std::string there;
  const auto next = [&] {
    while (std::getline(trace, there)) {
      if (there.starts_with(scene.name + ' ')) return true;
    }
    return false;
  };
  std::optional<Difference> found;
  bool held = false;
  traceScene<D>(scene, [&](const std::string& here) {
    if (!next()) {
      if (held) found = differenceOf(here, scene.name + " ends here");
      return false;
    }
    held = true;
    if (here != there) found = differenceOf(here, there);
    return !found;
  });
  if (!held) throw UserError("the trace does not hold the scene " + scene.name);
  return found;
}

#define LPC_INSTANTIATE(D)                                           \
  template void writeTrace<D>(const PinnedScene<D>&, std::ostream&); \
  template std::optional<Difference> firstDifference<D>(const PinnedScene<D>&, std::istream&)
LPC_INSTANTIATE(2);
LPC_INSTANTIATE(3);
#undef LPC_INSTANTIATE

}}}  // namespace lpc::LPC_PRECISION::test
