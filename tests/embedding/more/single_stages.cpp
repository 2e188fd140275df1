// SPDX-License-Identifier: Zlib
// Single stages without a world: a broadphase on the caller's own boxes, and a pair query on two shapes.
#include <lpc/stage_broadphase.h>
#include <lpc/stage_narrowphase.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>

void singleStages() {
  lpc::Proxies<3> proxies;
  proxies.resize(3);
  for (int i = 0; i < 3; ++i) {
    const auto n = static_cast<std::size_t>(i);
    const lpc::Real x = i == 2 ? 5 : i * lpc::Real(0.8);  // the first two overlap
    proxies.setBox(i, {lpc::Vec<3>(x, 0, 0), lpc::Vec<3>(x + 1, 1, 1)});
    proxies.active[n] = 1, proxies.category[n] = 1, proxies.mask[n] = ~0u, proxies.body[n] = i;
  }
  const auto broadphase = lpc::createStage<lpc::Broadphase<3>>(lpc::Spec::parse("sort_and_sweep{axis=0}"));
  std::vector<lpc::ProxyId> all = {0, 1, 2};
  std::vector<lpc::ProxyPair> pairs;
  lpc::WorkDone work;
  broadphase->update(proxies, {all, {}, {}});
  broadphase->findPairs(proxies, pairs, work);

  const auto query = lpc::createStage<lpc::PairQuery<3>>(lpc::Spec::parse("gjk_epa"));
  const auto cube = lpc::Shape<3>::box({0.5, 0.5, 0.5});
  lpc::Pose<3> X_AB;
  X_AB.p = {0.8, 0, 0};
  const auto answer = lpc::queryPair(*query, cube.view(), cube.view(), X_AB);

  std::printf("%zu pair(s), distance %.3f m\n", pairs.size(), double(answer.distance));
  const bool right = pairs.size() == 1 && pairs[0].a == 0 && pairs[0].b == 1 && std::abs(answer.distance + 0.2) < 1e-12;
  if (!right) std::exit(1);
}
