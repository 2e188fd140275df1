// SPDX-License-Identifier: Zlib
// Contact generators over several steps, each given the manifolds of the previous one. The properties of the first step
// must hold in later steps, whether a generator keeps points or not. In 3D also with each rule of reduction.
#include <gtest/gtest.h>

#include "tests/check_property.h"
#include "tests/contact_properties.h"
#include "tests/every_solver.h"
#include "tests/planted_bugs/contact_bugs.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace contact_history_test {
namespace contact_history_test {

// The competitors with their defaults; where four points are selected, also with each other rule.
enum class Rules { defaults, all };
template <int D>
std::vector<Spec> everyGenerator(Rules rules) {
  std::vector<Spec> out;
  for (const Registered* r : Registry::instance().list(StageKind::contacts, D)) {
    if (!competes(*r)) continue;
    out.push_back({r->info.name, {}});
    for (const ParamInfo& p : r->params) {
      for (const std::string& choice : p.choices) {
        if (D == 2 || rules == Rules::defaults || p.name != "reduction" || choice == p.defaultText) continue;
        out.push_back({r->info.name, {}});
        out.back().set(p.name, Spec{choice, {}});
      }
    }
  }
  return out;
}

template <int D, class Property>
void onEveryGenerator(const std::string& name, const Property& property, int cases, Rules rules = Rules::all) {
  for (const Spec& spec : everyGenerator<D>(rules)) {
    const Registered& entry = Registry::instance().find(StageKind::contacts, D, spec.name);
    const auto generator = createStage<ContactGenerator<D>>(spec);
    const auto run = [&] { property(*generator); };
    const std::string title = name + " " + spec.text() + " " + std::to_string(D) + "D";
    if (declares(entry, spec, name)) {
      expectFalsified(title + " must fail", run, cases);
    } else {
      check(title, run, cases);
    }
  }
}

template <int D, template <int> class Bug, class Property>
void catches(const std::string& name, const Property& property, int cases) {
  Bug<D> bug;
  expectFalsified(
      name + " " + std::to_string(D) + "D", [&] { property(bug); }, cases);
}

// A scene and the earlier poses of B.
template <int D>
struct History {
  ContactScene<D> scene;
  std::vector<Pose<D>> before;

  std::vector<Manifold<D>> run(ContactGenerator<D>& generator) const {
    std::vector<Manifold<D>> last;
    for (const Pose<D>& X_WB : before) {
      ContactScene<D> at = scene;
      at.pose[1] = X_WB;
      last = at.run(generator, last);
    }
    return scene.run(generator, last);
  }
  friend std::ostream& operator<<(std::ostream& out, const History& h) {
    out << h.scene;
    for (const Pose<D>& X : h.before) out << "# B was at " << X << '\n';
    return out;
  }
};

// Any pair, or faces that rest on each other. Steps from a tenth of a millimetre to a decimetre, with turns of that
// order.
template <int D>
History<D> drawHistory(Draw& draw) {
  History<D> h{draw.coin() ? drawFaceContact<D>(draw).scene : drawScene<D>(draw), {}};
  const Real step = draw.pick({Real(1e-4), Real(1e-3), Real(0.01), Real(0.1)});
  for (int i = 1 + draw.below(6); i > 0; --i) {
    Pose<D> X = h.scene.pose[1];
    X.p += step * drawVector<D>(draw);
    Ang<D> v;
    for (int k = 0; k < kAngDim<D>; ++k) v[k] = step * draw.signedUnit();
    X.q = turn(v) * X.q;
    h.before.push_back(X);
  }
  if (draw.coin()) std::swap(h.scene.pose[1], h.before.back());  // the flat pose comes first, not last
  return h;
}

template <int D>
void staysWellFormed(ContactGenerator<D>& generator) {
  const auto h = *Gen(drawHistory<D>);
  isWellFormed(h.scene, h.run(generator));
}
template <int D>
void staysOnShapes(ContactGenerator<D>& generator) {
  const auto h = *Gen(drawHistory<D>);
  areOnShapes(h.scene, h.run(generator));
}
template <int D>
void depthStaysTrue(ContactGenerator<D>& generator) {
  const auto h = *Gen(drawHistory<D>);
  areTrulyDeep(h.scene, h.run(generator));
}

// The anchors of a point lie on one line along the normal. Exceptions: kept points may slide by a margin, and nearly
// parallel capsules touch in two points.
template <int D>
void anchorsStayTogether(ContactGenerator<D>& generator) {
  constexpr Real kLean = D == 2 ? Real(1e-4) : kNearlyParallel;
  const auto h = *Gen(drawHistory<D>);
  for (const Manifold<D>& m : h.run(generator)) {
    RC_LOG() << m;
    for (int i = 0; i < m.count; ++i) {
      const ContactPoint<D>& p = m.points[static_cast<std::size_t>(i)];
      const Vec<D> gap = h.scene.pose[1] * p.localB - h.scene.pose[0] * p.localA;
      RC_ASSERT((gap - gap.dot(m.normal) * m.normal).norm() <= kContactMargin + kLean * h.scene.extent());
    }
  }
}

// Bodies that do not move keep their points once a manifold has had time to fill. The points keep their feature
// numbers; otherwise impulses would be lost.
template <int D>
void restKeepsFeatures(ContactGenerator<D>& generator) {
  const auto h = *Gen(drawHistory<D>);
  auto last = h.run(generator);
  for (int i = 0; i < 2 * kManifoldPoints<D>; ++i) last = h.scene.run(generator, last);
  const auto again = h.scene.run(generator, last);
  RC_ASSERT(again.size() == last.size());
  if (last.empty()) return;
  RC_LOG() << last[0] << again[0];
  RC_ASSERT(again[0].count == last[0].count);
  for (std::size_t i = 0; i < static_cast<std::size_t>(last[0].count); ++i) {
    RC_ASSERT(again[0].points[i].feature == last[0].points[i].feature);
  }
}

// Faces rock on each other by two millirad in all directions. In 3D their points then span at least a quarter of the
// patch's area. In 2D they span its length but for the two ends, where a new point replaces an old one within two
// centimetres.
template <int D>
void rockingFacesSpanPatch(ContactGenerator<D>& generator) {
  constexpr int kSteps = 40;
  constexpr Real kRocks = Real(0.002), kGoldenAngle = Real(2.39996);  // rad
  const auto c = *Gen(drawFaceContact<D>);
  const auto start = *Gen([](Draw& draw) { return draw.real(0, 6.28); });
  if (isSliver(c)) return;
  History<D> h{c.scene, {}};
  for (int i = 0; i < kSteps; ++i) {
    const Real towards = start + kGoldenAngle * Real(i);
    Pose<D> X = c.scene.pose[1];
    Ang<D> v = Ang<D>::Constant(kRocks * std::cos(towards));
    if constexpr (D == 3) v = c.X_A.q * Vec<3>(v[0], kRocks * std::sin(towards), 0);
    X.q = turn(v) * X.q;
    h.before.push_back(X);
  }
  spanPatch<D>(c, h.run(generator), D == 2 ? 1 - 2 * kContactMargin / breadth(c.patch, 0) : Real(0.25));
}

// Faces that slide by five centimetres in each step also span the patch.
template <int D>
void fastFacesSpanPatch(ContactGenerator<D>& generator) {
  const auto c = *Gen(drawFaceContact<D>);
  if (isSliver(c)) return;
  Vec<D> way = Vec<D>::Zero();
  way[0] = D == 2 ? Real(1) : Real(0.8);
  if constexpr (D == 3) way[1] = Real(0.6);
  History<D> h{c.scene, {}};
  for (int i = 4; i > 0; --i) {
    Pose<D> X = c.scene.pose[1];
    X.p -= Real(0.05) * Real(i) * (c.X_A.q * way);
    h.before.push_back(X);
  }
  spanPatch<D>(c, h.run(generator), D == 2 ? Real(0.98) : Real(0.4));
}

TEST(Contacts, StayWellFormed) {
  onEveryGenerator<2>("Contacts.StayWellFormed", staysWellFormed<2>, 800);
  onEveryGenerator<3>("Contacts.StayWellFormed", staysWellFormed<3>, 800);
  catches<2, KeepsOldDepths>("old depths", staysWellFormed<2>, 800);
  catches<3, KeepsOldDepths>("old depths", staysWellFormed<3>, 800);
  catches<2, KeepsTheParted>("keeps what has parted", staysWellFormed<2>, 800);
  catches<3, KeepsTheParted>("keeps what has parted", staysWellFormed<3>, 800);
}

TEST(Contacts, StayOnTheShapes) {
  onEveryGenerator<2>("Contacts.StayOnTheShapes", staysOnShapes<2>, 200);
  onEveryGenerator<3>("Contacts.StayOnTheShapes", staysOnShapes<3>, 200);
  catches<2, PutsAnchorsTogether>("puts anchors together", staysOnShapes<2>, 200);
  catches<3, PutsAnchorsTogether>("puts anchors together", staysOnShapes<3>, 200);
}

TEST(Contacts, DepthStaysTrue) {
  onEveryGenerator<2>("Contacts.DepthStaysTrue", depthStaysTrue<2>, 300);
  onEveryGenerator<3>("Contacts.DepthStaysTrue", depthStaysTrue<3>, 300);
  catches<2, KeepsTheOldAlone>("keeps the old point alone", depthStaysTrue<2>, 300);
  catches<3, KeepsTheOldAlone>("keeps the old point alone", depthStaysTrue<3>, 300);
}

TEST(Contacts, AnchorsStayTogether) {
  onEveryGenerator<2>("Contacts.AnchorsStayTogether", anchorsStayTogether<2>, 300);
  onEveryGenerator<3>("Contacts.AnchorsStayTogether", anchorsStayTogether<3>, 300);
  catches<2, KeepsTheSlidden>("keeps what has slid", anchorsStayTogether<2>, 300);
  catches<3, KeepsTheSlidden>("keeps what has slid", anchorsStayTogether<3>, 300);
}

TEST(Contacts, RestKeepsFeatures) {
  onEveryGenerator<2>("Contacts.RestKeepsFeatures", restKeepsFeatures<2>, 200);
  onEveryGenerator<3>("Contacts.RestKeepsFeatures", restKeepsFeatures<3>, 200);
  catches<2, NumbersAnew>("new numbers in each step", restKeepsFeatures<2>, 200);
  catches<3, NumbersAnew>("new numbers in each step", restKeepsFeatures<3>, 200);
}

TEST(Contacts, RockingFacesSpanThePatch) {
  onEveryGenerator<2>("Contacts.RockingFacesSpanThePatch", rockingFacesSpanPatch<2>, 200);
  onEveryGenerator<3>("Contacts.RockingFacesSpanThePatch", rockingFacesSpanPatch<3>, 1000);
}

TEST(Contacts, FastFacesSpanThePatch) {
  onEveryGenerator<2>("Contacts.FastFacesSpanThePatch", fastFacesSpanPatch<2>, 200, Rules::defaults);
  onEveryGenerator<3>("Contacts.FastFacesSpanThePatch", fastFacesSpanPatch<3>, 200, Rules::defaults);
}

}  // namespace contact_history_test
}}}}  // namespace lpc::LPC_PRECISION::test::contact_history_test
