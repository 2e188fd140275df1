// SPDX-License-Identifier: Zlib
// Algorithms register by name; no file includes them. At the end of an algorithm's file:
//
//   LPC_REGISTER(Broadphase, SortAndSweep, 2, 3);
//
// instantiates and registers SortAndSweep<2> and <3>. The class has a nested `Params`, a constructor from it, and
// `static AlgorithmInfo info()`.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "framework/math/indexed.h"
#include "framework/stage/params.h"

namespace lpc { inline namespace LPC_PRECISION {

enum class Guarantee { exact, conservative, approximate };
enum class AlgorithmRole { competitor, witness, referee, engine };

/// The friction law that a resolver solves. Two methods are compared by their own laws, and also by their common
/// reference, `coulomb`.
enum class FrictionLaw {
  unstated,   // the algorithm solves no contacts
  coulomb,    // |f| <= mu n, against the sliding velocity (maximum dissipation); sliding does not separate contacts
  convex,     // the same cone without De Saxce's correction: sliding contacts also lift
  pyramid,    // each tangent within mu n on its own
  facets,     // a cone of k facets, oriented by the method
  lagged,     // each tangent on its own, within mu n of the last step
  ofItsParts  // the law of the stage named in its parameters
};
std::string_view frictionLawName(FrictionLaw law);

/// A known failure of a method. `test` names the property test that shows the failure: this test must fail.
struct FailureMode {
  std::string when, symptom, test;
};

/// A parameter value that changes the law: {"friction", "box", FrictionLaw::lagged}.
struct FrictionChoice {
  std::string parameter, choice;
  FrictionLaw law;
};

struct AlgorithmInfo {
  std::string name;     // never changes, since result files contain it
  std::string summary;  // one line
  std::string paper;    // key in docs/references.bib; empty when there is none
  std::string complexity;
  Guarantee guarantee = Guarantee::exact;
  std::vector<FailureMode> failures = {};
  FrictionLaw friction = FrictionLaw::unstated;  // required for every solver and velocity resolver; with default
                                                 // parameters
  std::vector<FrictionChoice> otherFriction = {};
  std::string noEffort = {};  // why a solver, velocity or position resolver has no effort parameter
  bool matrixAlone = false;   // velocity resolver: can solve a GivenProblem, which has no bodies
  AlgorithmRole role = AlgorithmRole::competitor;
};

/// The friction law of a method with these parameters.
FrictionLaw frictionLaw(const AlgorithmInfo& info, const Spec& spec);

/// Base of all stages, so that the registry can hold any of them.
class Stage {
 public:
  virtual ~Stage() = default;
};

struct Registered {
  StageKind stage;
  int dimension;
  AlgorithmInfo info;
  std::vector<ParamInfo> params;
  std::string file;                                           // path of the source file as compiled
  std::function<std::unique_ptr<Stage>(const Spec&)> create;  // throws UserError for an invalid spec
  std::function<Spec(const Spec&)> canonical;                 // with every parameter written out, also of nested specs
};

class Registry {
 public:
  using Key = std::tuple<StageKind, int, std::string>;  // ordered, so that nothing depends on link order

  static Registry& instance();
  void add(Registered entry);  // a second algorithm of the same name aborts: a programming error
  const std::map<Key, Registered>& all() const { return m_all; }
  /// Finds an algorithm by name. Throws UserError with the valid names.
  const Registered& find(StageKind stage, int dimension, std::string_view name) const;
  /// The parameter of the algorithm with this name, in either dimension; null when the algorithm or the parameter does
  /// not exist. "effort" finds the first effort parameter, whatever its name.
  const ParamInfo* parameter(StageKind stage, const std::string& name, std::string_view parameter) const;
  std::vector<const Registered*> list(StageKind stage, int dimension) const;

 private:
  std::map<Key, Registered> m_all;
};

/// Fills params from a spec. Throws UserError for an unknown name (with the valid ones) or a value out of range.
void readParams(const Spec& spec, const std::string& algorithm, const std::function<void(ParamVisitor&)>& visit);
std::vector<ParamInfo> describeParams(const std::function<void(ParamVisitor&)>& visit);
Spec canonicalSpec(const std::string& algorithm, int dimension, const std::function<void(ParamVisitor&)>& visit);

/// Creates a stage from its spec, for instance createStage<Broadphase<3>>(Spec::parse("uniform_grid{cell=2}")).
template <class S>
std::unique_ptr<S> createStage(const Spec& spec) {
  auto stage = Registry::instance().find(S::kStage, S::kDimension, spec.name).create(spec);
  return std::unique_ptr<S>(static_cast<S*>(stage.release()));
}

/// True for a stage of a world of this dimension: Broadphase<D> or a class derived from it, for instance.
template <class S, int D>
concept StageOfWorld = (S::kDimension == D) && isWorldStage(stageInfo(S::kStage));

/// One stage object for each stage of a world: registered algorithms, or objects of the user's own.
template <int D>
class StageSet {
 public:
  /// Creates the registered algorithms that the pipeline names. Throws UserError for an unknown algorithm or a wrong
  /// parameter.
  explicit StageSet(const Pipeline& pipeline) : m_pipeline(pipeline) {
    for (const StageKind kind : kWorldStages) create(kind);
  }
  /// Replaces one stage by an object of the user's own, whose class derives from Broadphase<D>, ContactGenerator<D>,
  /// ... and need not be registered. pipeline() and messages show it as `name`. Throws UserError for null.
  template <StageOfWorld<D> S>
  void set(std::unique_ptr<S> stage, std::string_view name = "own") {
    if (!stage) throw UserError(std::string(stageName(S::kStage)) + ": the stage object is null");
    m_stages[S::kStage] = std::move(stage);
    m_pipeline[S::kStage] = Spec{std::string(name), {}};
    m_own[S::kStage] = true;
  }
  /// True when set() has replaced this stage.
  bool isOwn(StageKind kind) const { return m_own[kind]; }
  const Pipeline& pipeline() const { return m_pipeline; }
  /// Creates the registered algorithms anew, without their internal state. The user's own objects stay.
  void renew() {
    for (const StageKind kind : kWorldStages) {
      if (!m_own[kind]) create(kind);
    }
  }
  /// Returns a stage object, for instance get<Broadphase<D>>().
  template <class S>
  S& get() const {
    static_assert(S::kDimension == D && isWorldStage(stageInfo(S::kStage)));
    return static_cast<S&>(*m_stages[S::kStage]);
  }

 private:
  void create(StageKind kind) {
    const Spec& spec = m_pipeline[kind];
    m_stages[kind] = Registry::instance().find(kind, D, spec.name).create(spec);
  }

  Pipeline m_pipeline;
  IndexedArray<bool, kStageKinds> m_own{};
  IndexedArray<std::unique_ptr<Stage>, kStageKinds> m_stages;  // by kind; null for kinds that are not stages of a world
};

/// The place of a method's effort parameter: the method itself, otherwise its first part, which solves the contacts.
struct EffortPlace {
  Spec* method;                // within the given spec
  const Registered* entry;     // of `method`
  const ParamInfo* parameter;  // nullptr: none
};
/// Finds the effort parameter of `spec`. Adds the part that has the parameter to `spec`, when the part was a default.
EffortPlace effortIn(StageKind stage, int dimension, Spec& spec);

/// The pipeline with every parameter of every stage written out, in a fixed order: the key of a result.
std::string canonicalText(const Pipeline& pipeline, int dimension);

/// Tells where to write `algorithm` of this stage in a pipeline: "velocity is a part of solver:
/// solver=split_solver{velocity=catto}". Empty for a stage of a world, which is written directly.
std::string placeInPipeline(const StageInfo& stage, const std::string& algorithm);

// Internal linkage: otherwise the linker would merge the registrars of two classes of one name in two files. A class
// template in an anonymous namespace, passed as a template argument, does not give the registrar internal linkage; a
// class would.
namespace {

template <template <int> class StageOf, template <int> class Algorithm, int... D>
class Registrar {
 public:
  explicit Registrar(const char* file) { (add<D>(file), ...); }

 private:
  template <int Dim>
  static void add(const char* file) {
    using A = Algorithm<Dim>;
    using Params = typename A::Params;
    const AlgorithmInfo info = A::info();
    const auto read = [name = info.name](const Spec& spec) {
      Params params;
      readParams(spec, name, [&](ParamVisitor& v) { params.visit(v); });
      return params;
    };
    Params defaults;
    Registry::instance().add(
        {StageOf<Dim>::kStage, Dim, info, describeParams([&](ParamVisitor& v) { defaults.visit(v); }), file,
         [read](const Spec& spec) -> std::unique_ptr<Stage> { return std::make_unique<A>(read(spec)); },
         [read, name = info.name](const Spec& spec) {
           Params params = read(spec);
           return canonicalSpec(name, Dim, [&](ParamVisitor& v) { params.visit(v); });
         }});
  }
};

}  // namespace

#define LPC_REGISTER(StageOf, Algorithm, ...) \
  static const ::lpc::Registrar<StageOf, Algorithm, __VA_ARGS__> registrar##Algorithm { __FILE__ }

}}  // namespace lpc::LPC_PRECISION
