// SPDX-License-Identifier: Zlib
#include "experiments/sandbox/session.h"

#include <algorithm>
#include <chrono>
#include <sstream>

#include "experiments/trial/scene/simulation_of_scene.h"
#include "framework/math/check.h"
#include "framework/world/invariants.h"

namespace lpc { inline namespace LPC_PRECISION {
namespace {

constexpr long kKeepEvery = 30;                // steps: at most this many are repeated to go one back
constexpr long kAskEvery = 16;                 // steps of an engine between two calls
constexpr std::size_t kKeptBytes = 256 << 20;  // of one competitor; above it, every second state is dropped

}  // namespace

double medianTime(const std::vector<Sample>& samples) {
  std::vector<double> last;
  for (std::size_t i = samples.size() - std::min<std::size_t>(samples.size(), kTimedSteps); i < samples.size(); ++i) {
    last.push_back(samples[i].seconds);
  }
  if (last.empty()) return 0;
  std::nth_element(last.begin(), last.begin() + static_cast<long>(last.size() / 2), last.end());
  return last[last.size() / 2];
}

template <int D>
double timedStep(Simulation<D>& world, Real dt) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = Clock::now();
  world.step(dt);
  return std::chrono::duration<double>(Clock::now() - start).count();
}

template <int D>
Session<D>::Session(SceneSpec<D> scene, const std::vector<std::string>& pipelines, Stepper<D> stepper)
    : m_scene(std::move(scene)), m_stepper(std::move(stepper)) {
  m_competitors.resize(pipelines.size()), m_plays.resize(pipelines.size()), m_kept.resize(pipelines.size());
  for (std::size_t competitor = 0; competitor < pipelines.size(); ++competitor) {
    m_competitors[competitor].pipeline = pipelines[competitor];
    begin(competitor);
    keep(competitor);
  }
}

template <int D>
void Session<D>::begin(std::size_t competitor) {
  Competitor& l = m_competitors[competitor];
  l.world = simulationOf(l.pipeline, m_scene);
  l.fallen.clear(), l.since = 0;
  m_plays[competitor] = {std::make_unique<Director<D>>(m_scene), {}, 0, 0, false};
  m_plays[competitor].director->begin(*l.world);
}

template <int D>
void Session<D>::playOne(std::size_t competitor, const Action<D>& action) {
  BodyNumbers<D> numbers{*m_plays[competitor].director, m_plays[competitor].hand};
  play(action, static_cast<int>(competitor), *m_competitors[competitor].world, numbers);
  const auto* e = std::get_if<SetPipeline>(&action.what);
  if (e && e->competitor == static_cast<int>(competitor))
    m_competitors[competitor].pipeline = e->pipeline, m_competitors[competitor].since = action.step;
}

template <int D>
void Session<D>::playDue(std::size_t competitor) {
  Play& p = m_plays[competitor];
  for (; p.action < m_actions.size() && m_actions[p.action].step <= p.steps; ++p.action)
    playOne(competitor, m_actions[p.action]);
}

template <int D>
void Session<D>::step() {
  if (fallen()) return;
  for (std::size_t competitor = 0; competitor < m_competitors.size(); ++competitor) {
    if (m_competitors[competitor].fallen.empty()) stepCompetitor(competitor);
  }
  ++m_steps;
  for (std::size_t competitor = 1; competitor < m_competitors.size(); ++competitor) markError(competitor);
  for (std::size_t competitor = 0; competitor < m_competitors.size(); ++competitor) {
    if (m_steps % kKeepEvery == 0 && m_competitors[competitor].fallen.empty()) keep(competitor);
  }
}

// Events of the script and actions of the hand come right after the step, so that they are visible before the coming
// one. Actions of the scene that follow its events wait for the hand: written as a script, actions are events, too.
template <int D>
void Session<D>::stepCompetitor(std::size_t competitor) {
  Competitor& l = m_competitors[competitor];
  try {
    m_plays[competitor].director->finish(*l.world);
    const double seconds = m_stepper(*l.world, m_scene.dt);
    ++m_plays[competitor].steps;
    look(competitor, seconds);
    if (!l.fallen.empty()) return;
    m_plays[competitor].director->begin(*l.world);
    playDue(competitor);
  } catch (const std::exception& e) {  // an event that overflows, or a failed engine
    l.fallen = e.what();
  }
}

template <int D>
void Session<D>::look(std::size_t competitor, double seconds) {
  Competitor& l = m_competitors[competitor];
  Sample sample{.seconds = seconds};
  if (m_measure) {
    const Invariants<D> seen = invariants(*l.world);
    sample.energy = seen.kinetic + seen.potential, sample.penetration = seen.maxPenetration;
  }
  l.samples.resize(static_cast<std::size_t>(m_plays[competitor].steps - 1));
  l.samples.push_back(sample);
  if (stateIsFinite(*l.world)) return;
  l.fallen = "diverged at step " + std::to_string(m_plays[competitor].steps);
  const Bodies<D>& b = l.world->bodies();
  for (std::size_t i = 0; i < b.pose.size(); ++i) {
    if (b.used[i] && (!b.pose[i].p.allFinite() || !b.motion[i].v.allFinite() || !b.motion[i].w.allFinite())) {
      l.fallen += ": the position of body " + std::to_string(i) + " is not finite";
      return;
    }
  }
}

template <int D>
void Session<D>::markError(std::size_t competitor) {
  Competitor& l = m_competitors[competitor];
  if (!l.fallen.empty() || fallen()) return;
  const Simulation<D>& first = world();
  double worst = 0;
  for (int body = 0; body < bodies(); ++body) {
    const BodyHandle a = handle(body), b = handle(body, competitor);
    if (!first.valid(a) || !l.world->valid(b)) continue;
    worst = std::max<double>(worst, (first.pose(a).p - l.world->pose(b).p).norm());
  }
  l.samples.back().error = worst;
  if (worst > kParted && l.partedAt < 0) l.partedAt = m_steps;
}

template <int D>
void Session<D>::keep(std::size_t competitor) {
  const auto* world = dynamic_cast<const World<D>*>(m_competitors[competitor].world.get());
  if (!world) return;  // an engine restarts
  std::vector<Keyframe>& kept = m_kept[competitor];
  if (!kept.empty() && kept.back().step >= m_steps) return;
  std::ostringstream out;
  world->save(out);
  const Play& p = m_plays[competitor];
  kept.push_back({m_steps, m_competitors[competitor].since, m_competitors[competitor].pipeline, world->pipeline(),
                  out.str(), *p.director, p.hand, p.action});
  std::size_t bytes = 0;
  for (const Keyframe& k : kept) bytes += k.bytes.size();
  if (bytes <= kKeptBytes) return;
  for (std::size_t i = 1; i + 1 < kept.size(); ++i) kept.erase(kept.begin() + static_cast<long>(i));
}

template <int D>
std::unique_ptr<World<D>> Session<D>::ready() const {
  const auto* world = dynamic_cast<const World<D>*>(m_competitors[0].world.get());
  if (!world) return nullptr;
  std::stringstream bytes;
  world->save(bytes);
  auto out = std::make_unique<World<D>>(world->pipeline(), m_scene.settings);
  out->load(bytes);
  Director<D> rest = *m_plays[0].director;
  rest.finish(*out);
  return out;
}

template <int D>
void Session<D>::goTo(std::size_t competitor, long step, const ProgressCallback& progress) {
  Competitor& l = m_competitors[competitor];
  Play& p = m_plays[competitor];
  if (p.givenUp) return;
  const auto& kept = m_kept[competitor];
  const auto after = std::find_if(kept.begin(), kept.end(), [&](const Keyframe& k) { return k.step > step; });
  if (after == kept.begin()) {
    begin(competitor);
  } else {
    const Keyframe& from = *(after - 1);
    l.pipeline = from.pipeline, l.since = from.since, l.fallen.clear();
    auto world = std::make_unique<World<D>>(from.stages, m_scene.settings);
    std::istringstream in(from.bytes);
    world->load(in);
    l.world = std::move(world);
    p = {std::make_unique<Director<D>>(from.director), from.hand, from.action, from.step, false};
  }
  if (competitor == 0) keepFrames(m_keepFrames);
  try {
    playDue(competitor);
  } catch (const UserError& e) {  // rejected by this competitor only
    l.fallen = e.what();
  }
  const bool engine = after == kept.begin();
  for (long made = 0; l.fallen.empty() && p.steps < step; ++made) {
    if (engine && progress && made % kAskEvery == 0 && !progress(competitor, double(p.steps) / double(step))) {
      l.fallen = "step back cancelled while recomputing " + std::to_string(step) + " steps";
      p.givenUp = true;
      return;
    }
    stepCompetitor(competitor);
  }
}

template <int D>
bool Session<D>::back(const ProgressCallback& progress) {
  if (m_steps == 0) return false;
  --m_steps;
  for (std::size_t competitor = 0; competitor < m_competitors.size(); ++competitor) {
    Competitor& l = m_competitors[competitor];
    std::vector<Sample> samples = std::move(l.samples);  // errors and times are those of the first run
    goTo(competitor, m_steps, progress);
    samples.resize(std::min(samples.size(), static_cast<std::size_t>(m_steps)));
    l.samples = std::move(samples);
    if (l.partedAt > m_steps) l.partedAt = -1;
  }
  return true;
}

template <int D>
void Session<D>::keepFrames(bool keep) {
  m_keepFrames = keep;
  world().profiler().keepFrames(keep);
}

template <int D>
bool Session<D>::fallen() const {
  return !m_competitors[0].fallen.empty();
}

// For dragged bodies only the last positions count.
template <int D>
bool Session<D>::takenBack(const typename Action<D>::What& what) {
  const auto places = [](const SetBody<D>* set) { return set && !set->velocity && !set->angularVelocity; };
  const auto* now = std::get_if<SetBody<D>>(&what);
  if (!places(now)) return false;
  for (auto action = m_actions.rbegin(); action != m_actions.rend() && action->step == m_steps; ++action) {
    auto* last = std::get_if<SetBody<D>>(&action->what);
    if (!places(last)) return false;
    if (last->body != now->body) continue;
    if (now->position) last->position = now->position;
    if (now->rotation) last->rotation = now->rotation;
    return true;
  }
  return false;
}

template <int D>
void Session<D>::perform(typename Action<D>::What what) {
  if (fallen())
    throw UserError("the first competitor has failed: " + m_competitors[0].fallen + "; valid: one step back");
  const Action<D> action{m_steps, std::move(what)};
  playOne(0, action);
  std::erase_if(m_actions, [&](const Action<D>& d) { return d.step > m_steps; });
  for (auto& kept : m_kept) std::erase_if(kept, [&](const Keyframe& k) { return k.step > m_steps; });
  if (!takenBack(action.what)) m_actions.push_back(action);
  for (std::size_t competitor = 0; competitor < m_competitors.size(); ++competitor) {
    m_plays[competitor].action = m_actions.size();
    if (competitor == 0 || !m_competitors[competitor].fallen.empty()) continue;
    try {
      playOne(competitor, action);
    } catch (const UserError& e) {
      m_competitors[competitor].fallen = e.what();
    }
  }
}

template <int D>
int Session<D>::bodies() const {
  return static_cast<int>(m_scene.spawns.size() + m_plays[0].hand.size());
}

template <int D>
BodyHandle Session<D>::handle(int body, std::size_t competitor) const {
  const Play& p = m_plays[competitor];
  const auto ofScene = static_cast<int>(m_scene.spawns.size());
  if (body < ofScene) return p.director->body(body);
  const auto i = static_cast<std::size_t>(body - ofScene);
  return i < p.hand.size() ? p.hand[i] : BodyHandle{};
}

template <int D>
int Session<D>::bodyAt(std::int32_t slot, std::size_t competitor) const {
  for (int body = bodies() - 1; body >= 0; --body) {  // the last body of the slot
    if (const BodyHandle h = handle(body, competitor); h.slot == slot && world(competitor).valid(h)) return body;
  }
  return -1;
}

template double timedStep(Simulation<2>&, Real);
template double timedStep(Simulation<3>&, Real);
template class Session<2>;
template class Session<3>;

}}  // namespace lpc::LPC_PRECISION
