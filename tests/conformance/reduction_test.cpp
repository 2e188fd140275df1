// SPDX-License-Identifier: Zlib
// Selection of four contact points out of many: the duties of every rule, the area that each rule guarantees, and a
// comparison of the rules.
#include "algorithms/contacts/patch/reduction.h"

#include <gtest/gtest.h>

#include <functional>
#include <iomanip>

#include "tests/check_property.h"
#include "tests/contact_properties.h"

namespace lpc { inline namespace LPC_PRECISION { namespace test { namespace reduction_test { namespace reduction_test {

using namespace contacts;

constexpr Real kAlike = Real(1e-4);  // depths that differ by less count as equal (m)

struct NamedRule {
  std::string name;
  std::function<void(const Vec<3>&, std::vector<PatchPoint<3>>&)> reduce;
};
NamedRule ours(const std::string& name, Reduction rule) {
  return {name, [rule](const Vec<3>& n, std::vector<PatchPoint<3>>& points) { reducePatch(rule, n, kAlike, points); }};
}
const std::vector<NamedRule>& rules() {
  static const std::vector<NamedRule> all = {ours("spread", Reduction::spread), ours("area", Reduction::area),
                                             ours("extremes", Reduction::extremes),
                                             ours("deepest", Reduction::deepest)};
  return all;
}

// Corners of a flat, convex face at a random place; in one case of four with a few points inside.
struct FlatPatch {
  Vec<3> n, t1, t2;
  bool level = false;  // all are equally deep
  std::vector<PatchPoint<3>> points;

  Vec<2> flat(const PatchPoint<3>& p) const { return {t1.dot(p.p2), t2.dot(p.p2)}; }
  std::vector<Vec<2>> flat(const std::vector<PatchPoint<3>>& some) const {
    std::vector<Vec<2>> out;
    for (const PatchPoint<3>& p : some) out.push_back(flat(p));
    return out;
  }
  friend std::ostream& operator<<(std::ostream& out, const FlatPatch& c) {
    out << "n = " << c.n.transpose() << '\n';
    for (const PatchPoint<3>& p : c.points) {
      out << "# feature " << p.feature << ", depth " << -p.separation << ", at " << c.flat(p).transpose() << '\n';
    }
    return out;
  }
};

FlatPatch drawPatch(Draw& draw) {
  FlatPatch c;
  c.n = drawDirection<3>(draw);
  const auto across = tangents(c.n);
  c.t1 = across.col(0), c.t2 = across.col(1);
  const int corners = 5 + draw.below(8), inside = draw.below(4) == 3 ? 1 + draw.below(3) : 0;
  const Real a = draw.real(0.1, 1), b = a * draw.real(0.05, 1), turned = Real(3.14159) * draw.signedUnit();
  const Real slope = draw.pick({Real(0), Real(1e-9), Real(1e-3), Real(0.02)}), towards = draw.real(0, 6.28);
  c.level = slope < Real(1e-6);
  const int shift = draw.below(corners + inside);
  for (int i = 0; i < corners + inside; ++i) {
    const Real angle = Real(6.283185307179586) * (Real(i) + Real(0.8) * draw.real(0, 1)) / Real(corners);
    const Real size = i < corners ? Real(1) : draw.real(0, 0.3);  // the smallest polygon has a larger inscribed circle
    const Real x = size * a * std::cos(angle), y = size * b * std::sin(angle);
    const Vec<2> p(std::cos(turned) * x - std::sin(turned) * y, std::sin(turned) * x + std::cos(turned) * y);
    const Real separation = slope * (std::cos(towards) * p[0] + std::sin(towards) * p[1]);
    const Vec<3> base = p[0] * c.t1 + p[1] * c.t2;
    const auto feature = static_cast<std::uint64_t>((i + shift) % (corners + inside));
    c.points.push_back({base, base + separation * c.n, separation, feature});
  }
  return c;
}

// Area of the convex hull, by monotone chains (m^2).
Real hullArea(std::vector<Vec<2>> points) {
  const auto less = [](const Vec<2>& p, const Vec<2>& q) { return p[0] < q[0] || (p[0] == q[0] && p[1] < q[1]); };
  std::sort(points.begin(), points.end(), less);
  Real twice = 0;
  for (const Real side : {Real(1), Real(-1)}) {
    std::vector<Vec<2>> chain;
    for (const Vec<2>& p : points) {
      while (chain.size() > 1) {
        const Vec<2> e = chain.back() - chain[chain.size() - 2], d = p - chain.back();
        if (side * (e[0] * d[1] - e[1] * d[0]) > 0) break;
        chain.pop_back();
      }
      chain.push_back(p);
    }
    for (std::size_t i = 1; i < chain.size(); ++i) {
      twice += side * (chain[i - 1][0] * chain[i][1] - chain[i - 1][1] * chain[i][0]);
    }
  }
  return twice / 2;
}

Real deepestAmong(const std::vector<PatchPoint<3>>& points) {
  Real least = std::numeric_limits<Real>::infinity();
  for (const PatchPoint<3>& p : points) least = std::min(least, p.separation);
  return least;
}

// --- properties ------------------------------------------------------------------------------------------------------

// One to four of the given points, unchanged, identified by their features, one of the deepest among them; independent
// of the order of the input.
void keepsFourOfThem(const NamedRule& rule) {
  const auto c = *Gen(drawPatch);
  auto kept = c.points, other = c.points;
  rule.reduce(c.n, kept);
  RC_ASSERT(!kept.empty() && kept.size() <= 4u);
  for (std::size_t i = 0; i < kept.size(); ++i) {
    if (i > 0) RC_ASSERT(kept[i - 1].feature < kept[i].feature);
    const auto isIt = [&](const PatchPoint<3>& p) {
      return p.feature == kept[i].feature && p.p1 == kept[i].p1 && p.p2 == kept[i].p2 &&
             p.separation == kept[i].separation;
    };
    RC_ASSERT(std::any_of(c.points.begin(), c.points.end(), isIt));
  }
  RC_ASSERT(deepestAmong(kept) <= deepestAmong(c.points) + kAlike);
  std::reverse(other.begin(), other.end());
  std::rotate(other.begin(), other.begin() + 2, other.end());
  rule.reduce(c.n, other);
  RC_ASSERT(other.size() == kept.size());
  for (std::size_t i = 0; i < kept.size(); ++i) RC_ASSERT(other[i].feature == kept[i].feature);
}

// Four points and fewer are all kept, in order.
void leavesFour(const NamedRule& rule) {
  const auto c = *Gen(drawPatch);
  std::vector<PatchPoint<3>> few(c.points.begin(), c.points.begin() + static_cast<int>(1 + drawIndex(4)));
  const auto before = few;
  rule.reduce(c.n, few);
  RC_ASSERT(few.size() == before.size());
  for (std::size_t i = 0; i < few.size(); ++i) RC_ASSERT(few[i].feature == before[i].feature);
}

// Beyond `share` of the area, points narrower than the tolerance may be lost.
void keepsShare(const NamedRule& rule, Real share, bool levelOnly) {
  const auto c = *Gen(drawPatch);
  if (levelOnly && !c.level) return;
  auto kept = c.points;
  rule.reduce(c.n, kept);
  const auto all = c.flat(c.points);
  Real longest = 0;
  for (const Vec<2>& p : all) longest = std::max(longest, 2 * p.norm());
  const Real whole = hullArea(all), left = hullArea(c.flat(kept));
  RC_LOG() << left / whole << " of the area\n";
  RC_ASSERT(left >= share * whole - 4 * kAlike * longest);
}

// A quarter by proof, 1/2 where both ends are free, each less the margin for ties: see reduction.h.
const Real kTies = std::pow(kClearGain, Real(-1.5)) - Real(0.01);

// --- planted rules ---------------------------------------------------------------------------------------------------

void sortBy(std::vector<PatchPoint<3>>& points, const std::function<Real(const PatchPoint<3>&)>& value) {
  std::sort(points.begin(), points.end(), [&](const auto& p, const auto& q) { return value(p) < value(q); });
}
void byFeature(std::vector<PatchPoint<3>>& points) {
  std::sort(points.begin(), points.end(), [](const auto& p, const auto& q) { return p.feature < q.feature; });
}
const NamedRule kFive{"five points", [](const Vec<3>&, std::vector<PatchPoint<3>>& points) {
                        byFeature(points);
                        points.resize(std::min<std::size_t>(points.size(), 5), points[0]);
                      }};
const NamedRule kShallowest{"the four shallowest", [](const Vec<3>&, std::vector<PatchPoint<3>>& points) {
                              sortBy(points, [](const auto& p) { return -p.separation; });
                              points.resize(std::min<std::size_t>(points.size(), 4), points[0]);
                              byFeature(points);
                            }};
const NamedRule kMiddle{"a point between two", [](const Vec<3>& n, std::vector<PatchPoint<3>>& points) {
                          reducePatch(Reduction::area, n, kAlike, points);
                          points[0].p2 = (points[0].p2 + points.back().p2) / 2;
                        }};
const NamedRule kAsTheyCome{"the first four", [](const Vec<3>&, std::vector<PatchPoint<3>>& points) {
                              sortBy(points, [](const auto& p) { return p.separation > 0 ? Real(1) : Real(0); });
                              points.resize(std::min<std::size_t>(points.size(), 4), points[0]);
                              byFeature(points);
                            }};
const NamedRule kAlways{"drops the last of four", [](const Vec<3>&, std::vector<PatchPoint<3>>& points) {
                          if (points.size() > 3) points.pop_back();
                        }};
// Far from the middle does not mean far from each other.
const NamedRule kFarFromMiddle{"far from the middle", [](const Vec<3>& n, std::vector<PatchPoint<3>>& points) {
                                 Vec<3> middle = Vec<3>::Zero();
                                 for (const auto& p : points) middle += p.p2 / Real(points.size());
                                 sortBy(points, [&](const auto& p) { return -(p.p2 - middle).cross(n).norm(); });
                                 points.resize(4, points[0]);
                               }};

TEST(Reduction, EveryRuleKeepsFourPoints) {
  for (const NamedRule& rule : rules()) {
    check(
        "keeps four of them " + rule.name, [&] { keepsFourOfThem(rule); }, 1000);
    check(
        "leaves four " + rule.name, [&] { leavesFour(rule); }, 200);
  }
  for (const NamedRule* bug : {&kFive, &kShallowest, &kMiddle, &kAsTheyCome}) {
    expectFalsified(
        bug->name, [&] { keepsFourOfThem(*bug); }, 1000);
  }
  expectFalsified(
      kAlways.name, [] { leavesFour(kAlways); }, 200);
}

TEST(Reduction, AreaIsKept) {
  check(
      "a quarter by area", [] { keepsShare(rules()[1], kTies / 4, false); }, 3000);
  check(
      "half by spread of a level patch", [] { keepsShare(rules()[0], kTies / 2, true); }, 3000);
  for (const NamedRule& bug : {kFarFromMiddle, rules()[2], rules()[3]}) {
    expectFalsified(
        "a quarter by " + bug.name, [&] { keepsShare(bug, kTies / 4, false); }, 3000);
    expectFalsified(
        "half by " + bug.name, [&] { keepsShare(bug, kTies / 2, true); }, 3000);
  }
}

// --- a table ---------------------------------------------------------------------------------------------------------

// The share of the patch's breadth on which a weight would tip the kept points, although all points together carry it:
// the largest over all directions (1).
Real lostLever(const std::vector<Vec<2>>& all, const std::vector<Vec<2>>& kept) {
  constexpr int kDirections = 64;
  const auto reach = [](const std::vector<Vec<2>>& points, const Vec<2>& u) {
    Real most = -std::numeric_limits<Real>::infinity();
    for (const Vec<2>& p : points) most = std::max(most, u.dot(p));
    return most;
  };
  Real lost = 0;
  for (int k = 0; k < kDirections; ++k) {
    const Real angle = Real(6.283185307179586) * Real(k) / kDirections;
    const Vec<2> u(std::cos(angle), std::sin(angle));
    lost = std::max(lost, (reach(all, u) - reach(kept, u)) / (reach(all, u) + reach(all, -u)));
  }
  return lost;
}

// The four points of largest area, by trying all.
NamedRule best() {
  return {"(best four)", [](const Vec<3>& n, std::vector<PatchPoint<3>>& points) {
            FlatPatch c;
            const auto across = tangents(n);
            c.n = n, c.t1 = across.col(0), c.t2 = across.col(1);
            const std::size_t m = points.size();
            Real most = -1;
            std::vector<PatchPoint<3>> found;
            for (std::size_t i = 0; i < m; ++i) {
              for (std::size_t j = i + 1; j < m; ++j) {
                for (std::size_t k = j + 1; k < m; ++k) {
                  for (std::size_t l = k + 1; l < m; ++l) {
                    const std::vector<PatchPoint<3>> four = {points[i], points[j], points[k], points[l]};
                    const Real area = hullArea(c.flat(four));
                    if (area > most) most = area, found = four;
                  }
                }
              }
            }
            points = found;
          }};
}

// The share of new contact points per step, for faces that slide by a millimetre and turn by a milliradian a step, with
// a tilt that jitters by a microradian.
Real churn(const std::string& reduction) {
  constexpr int kScenes = 60, kSteps = 40;
  const auto generator = createStage<ContactGenerator<3>>(Spec::parse("sat_clip{reduction=" + reduction + "}"));
  PlainDraw draw(11);
  long asked = 0, fresh = 0;
  for (int k = 0; k < kScenes; ++k) {
    const FaceContact<3> c = drawFaceContact<3>(draw);
    ContactScene<3> at = c.scene;
    std::vector<Manifold<3>> last;
    for (int i = 0; i < kSteps; ++i) {
      at.pose[1].p += Real(0.001) * (c.X_A.q * Vec<3>(Real(0.8), Real(0.6), 0));
      at.pose[1].q = turn(Ang<3>(c.X_A.q * Vec<3>(0, 0, Real(0.001)))) * at.pose[1].q;
      ContactScene<3> now = at;
      now.pose[1].q = turn(Ang<3>(Real(1e-6) * drawVector<3>(draw))) * now.pose[1].q;
      const auto found = now.run(*generator);
      if (!last.empty() && !found.empty()) {
        for (int j = 0; j < found[0].count; ++j) {
          const auto same = [&](const auto& p) {
            return p.feature == found[0].points[static_cast<std::size_t>(j)].feature;
          };
          ++asked;
          fresh += std::none_of(last[0].points.begin(), last[0].points.begin() + last[0].count, same);
        }
      }
      last = found;
    }
  }
  return Real(fresh) / Real(asked);
}

// No four points span more than the best, and those span at least 2/pi of any convex figure (Sas, 1939): this checks
// the measure of area. The printed numbers are not tested.
TEST(Reduction, RulesCompared) {
  const int patches = caseCount(1000);
  auto compared = rules();
  compared.push_back(best());
  std::cout << "rule         area kept: mean, least  lever lost: mean, most  new features per point and step\n";
  for (const NamedRule& rule : compared) {
    PlainDraw draw(5);
    Real sum = 0, least = 1, lostSum = 0, lostMost = 0;
    for (int i = 0; i < patches; ++i) {
      const FlatPatch c = drawPatch(draw);
      auto kept = c.points, mostOf = c.points;
      rule.reduce(c.n, kept);
      const auto all = c.flat(c.points), some = c.flat(kept);
      const Real share = hullArea(some) / hullArea(all), lost = lostLever(all, some);
      EXPECT_TRUE(lost >= 0 && lost <= 1 + Real(1e-6)) << rule.name << '\n' << c;
      sum += share, least = std::min(least, share), lostSum += lost, lostMost = std::max(lostMost, lost);
    }
    const bool isOurs = rule.name[0] != '(';
    if (!isOurs) {
      EXPECT_GE(least, 2 / Real(3.1416));
    }
    std::cout << std::left << std::setw(13) << rule.name << std::setprecision(3) << sum / Real(patches) << ' ' << least
              << "  " << lostSum / Real(patches) << ' ' << lostMost << "  "
              << (isOurs ? std::to_string(double(churn(rule.name))) : std::string("-")) << '\n';
  }
}

}  // namespace reduction_test
}}}}  // namespace lpc::LPC_PRECISION::test::reduction_test
