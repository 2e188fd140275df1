// SPDX-License-Identifier: Zlib
// Algorithms enter by name and nobody includes them. At the foot of an algorithm's one file:
//
//   LPC_REGISTER(Broadphase, SortAndSweep, 2, 3);
//
// which instantiates SortAndSweep<2> and <3> and files them. The class has a nested `Params`, a constructor from it,
// and `static AlgorithmInfo info()`.
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

/// What friction a resolver aims at. Two methods are compared by their own law, and by `coulomb` as the common one.
enum class FrictionLaw {
  unstated,   // the algorithm solves no contacts
  coulomb,    // |f| <= mu n, against the sliding velocity (maximum dissipation); contacts do not part by sliding
  convex,     // the same cone without De Saxce's correction: what slides also lifts
  pyramid,    // each tangent within mu n by itself
  facets,     // a cone of k facets, which lie where the method says
  lagged,     // each tangent by itself, within mu n of the last step
  ofItsParts  // that of the stage which its parameters name
};
std::string_view frictionLawName(FrictionLaw law);

/// A way in which a method is known to fail. The test named here is run and must fail.
struct FailureMode {
  std::string when, symptom, test;
};

/// A choice of a parameter that changes the law: {"friction", "box", FrictionLaw::lagged}.
struct FrictionChoice {
  std::string parameter, choice;
  FrictionLaw law;
};

struct AlgorithmInfo {
  std::string name;     // stable for ever: it stands in result files
  std::string summary;  // one line
  std::string paper;    // key in docs/references.bib; empty when there is none
  std::string complexity;
  Guarantee guarantee = Guarantee::exact;
  std::vector<FailureMode> failures = {};
  FrictionLaw friction = FrictionLaw::unstated;  // of every solver and velocity resolver, by its defaults
  std::vector<FrictionChoice> otherFriction = {};
  std::string noEffort = {};  // of a solver, velocity or position resolver without a parameter of effort: why
  bool matrixAlone = false;   // of a velocity resolver: it solves a GivenProblem, which has no bodies
  AlgorithmRole role = AlgorithmRole::competitor;
};

/// The law of a method with these parameters.
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
  std::string file;                                           // source path as compiled
  std::function<std::unique_ptr<Stage>(const Spec&)> create;  // throws UserError on a wrong spec
  std::function<Spec(const Spec&)> canonical;                 // every parameter written out, nested ones too
};

class Registry {
 public:
  using Key = std::tuple<StageKind, int, std::string>;  // ordered: nothing depends on link order

  static Registry& instance();
  void add(Registered entry);  // a second algorithm of the same name aborts: a programmer's mistake
  const std::map<Key, Registered>& all() const { return m_all; }
  /// Throws UserError with the valid names.
  const Registered& find(StageKind stage, int dimension, std::string_view name) const;
  /// Of the algorithm of that name, in either dimension; null where it has no parameter of this name, or is not there.
  /// "effort" is the first of this role, whatever its name.
  const ParamInfo* parameter(StageKind stage, const std::string& name, std::string_view parameter) const;
  std::vector<const Registered*> list(StageKind stage, int dimension) const;

 private:
  std::map<Key, Registered> m_all;
};

/// Fills params from a spec; throws UserError for an unknown name (listing the valid ones) or a value out of range.
void readParams(const Spec& spec, const std::string& algorithm, const std::function<void(ParamVisitor&)>& visit);
std::vector<ParamInfo> describeParams(const std::function<void(ParamVisitor&)>& visit);
Spec canonicalSpec(const std::string& algorithm, int dimension, const std::function<void(ParamVisitor&)>& visit);

/// A stage by its spec, for instance createStage<Broadphase<3>>(Spec::parse("uniform_grid{cell=2}")).
template <class S>
std::unique_ptr<S> createStage(const Spec& spec) {
  auto stage = Registry::instance().find(S::kStage, S::kDimension, spec.name).create(spec);
  return std::unique_ptr<S>(static_cast<S*>(stage.release()));
}

/// One algorithm per stage of a world. Throws UserError when the pipeline names an unknown one or a wrong parameter.
template <int D>
class StageSet {
 public:
  explicit StageSet(const Pipeline& pipeline) {
    for (const StageKind kind : kWorldStages) {
      const Spec& spec = pipeline[kind];
      m_stages[kind] = Registry::instance().find(kind, D, spec.name).create(spec);
    }
  }
  /// For instance get<Broadphase<D>>().
  template <class S>
  S& get() const {
    static_assert(S::kDimension == D && isWorldStage(stageInfo(S::kStage)));
    return static_cast<S&>(*m_stages[S::kStage]);
  }

 private:
  IndexedArray<std::unique_ptr<Stage>, kStageKinds> m_stages;  // by kind; null where it is no stage of a world
};

/// Where a method takes its effort: in a parameter of its own, else where the first of its parts does, which solves the
/// contacts.
struct EffortPlace {
  Spec* method;                // within the spec that was asked about
  const Registered* entry;     // of `method`
  const ParamInfo* parameter;  // nullptr: it has none
};
/// Writes out the part of `spec` that it takes.
EffortPlace effortIn(StageKind stage, int dimension, Spec& spec);

/// The pipeline with every parameter of every stage written out, in a fixed order: the key of a result.
std::string canonicalText(const Pipeline& pipeline, int dimension);

/// Where `algorithm` of this stage stands: "velocity is a part of solver: solver=split_solver{velocity=catto}". Empty
/// for a stage of a world, which stands in a pipeline as it is.
std::string placeInPipeline(const StageInfo& stage, const std::string& algorithm);

// Each file has its own, or two whose classes have one name would be one to the linker: a template as an argument does
// not make it local, as a type would.
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
