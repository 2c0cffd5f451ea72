// SPDX-License-Identifier: Apache-2.0
// An FMU of FMI 3.0 for model exchange: `count` masses of 1 kg on springs. A force acts on each mass. The variables are
// arrays.
//
//   x[i]' = v[i],   v[i]' = -stiffness x[i] + force[i]
//
// A state event reverses the velocity of a mass at `wall`. `hits` counts the events. `hit_time`, a Float32, is the time
// of the last event. If x[1] is beyond `domain`, the evaluation of derivatives returns fmi3Discard.
#include "mebots/fmi3/functions.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <span>
#include <vector>

namespace {

enum Reference : fmi3ValueReference {
  kCount,
  kForce,
  kX,
  kV,
  kDerX,
  kDerV,
  kStiffness,
  kWall,
  kDomain,
  kHits,
  kHitTime,
  kDistance
};

struct Springs {
  double time = 0;
  std::vector<double> force, x, v;
  double stiffness = 1;
  double wall = 1e9;
  double domain = 1e9;
  std::int32_t hits = 0;
  float hit_time = 0;

  void resize(std::size_t count) {
    for (auto* values : {&force, &x, &v}) values->resize(count);
  }
  std::vector<double> accelerations() const {
    std::vector<double> result;
    for (std::size_t i = 0; i < x.size(); ++i) result.push_back(-stiffness * x[i] + force[i]);
    return result;
  }
  std::vector<double> distances() const {
    std::vector<double> result;
    for (const auto place : x) result.push_back(wall - place);
    return result;
  }
  std::vector<double> get(fmi3ValueReference reference) const {
    switch (reference) {
      case kForce:
        return force;
      case kX:
        return x;
      case kV:
      case kDerX:
        return v;
      case kDerV:
        return accelerations();
      case kStiffness:
        return {stiffness};
      case kWall:
        return {wall};
      case kDistance:
        return distances();
      default:
        return {domain};
    }
  }
  /// Sets an array from the first elements of `values`. Returns the number of used elements.
  std::size_t set(fmi3ValueReference reference, std::span<const double> values) {
    for (auto [array_reference, array] : {std::pair{kForce, &force}, {kX, &x}, {kV, &v}}) {
      if (array_reference != reference) continue;
      std::copy_n(values.begin(), array->size(), array->begin());
      return array->size();
    }
    (reference == kStiffness ? stiffness : reference == kWall ? wall : domain) = values[0];
    return 1;
  }
};

Springs& of(fmi3Instance instance) {
  return *static_cast<Springs*>(instance);
}

}  // namespace

fmi3Instance fmi3InstantiateModelExchange(fmi3String, fmi3String, fmi3String, fmi3Boolean, fmi3Boolean,
                                          fmi3InstanceEnvironment, fmi3LogMessageCallback) {
  auto* const springs = new Springs;
  springs->resize(1);
  springs->x[0] = 1;
  return springs;
}

void fmi3FreeInstance(fmi3Instance instance) {
  delete &of(instance);
}

fmi3Status fmi3SetUInt64(fmi3Instance instance, const fmi3ValueReference[], std::size_t, const fmi3UInt64 values[],
                         std::size_t) {
  of(instance).resize(values[0]);
  return fmi3OK;
}

fmi3Status fmi3EnterInitializationMode(fmi3Instance instance, fmi3Boolean, fmi3Float64, fmi3Float64 start, fmi3Boolean,
                                       fmi3Float64) {
  of(instance).time = start;
  return fmi3OK;
}

fmi3Status fmi3GetFloat64(fmi3Instance instance, const fmi3ValueReference references[], std::size_t count,
                          fmi3Float64 values[], std::size_t) {
  for (std::size_t i = 0; i < count; ++i) {
    const auto found = of(instance).get(references[i]);
    values = std::ranges::copy(found, values).out;
  }
  return fmi3OK;
}

fmi3Status fmi3SetFloat64(fmi3Instance instance, const fmi3ValueReference references[], std::size_t count,
                          const fmi3Float64 values[], std::size_t value_count) {
  std::span<const double> left(values, value_count);
  for (std::size_t i = 0; i < count; ++i) left = left.subspan(of(instance).set(references[i], left));
  return fmi3OK;
}

fmi3Status fmi3GetFloat32(fmi3Instance instance, const fmi3ValueReference[], std::size_t, fmi3Float32 values[],
                          std::size_t) {
  values[0] = of(instance).hit_time;
  return fmi3OK;
}

fmi3Status fmi3GetInt32(fmi3Instance instance, const fmi3ValueReference[], std::size_t, fmi3Int32 values[],
                        std::size_t) {
  values[0] = of(instance).hits;
  return fmi3OK;
}

fmi3Status fmi3SetTime(fmi3Instance instance, fmi3Float64 time) {
  of(instance).time = time;
  return fmi3OK;
}

fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance instance, std::size_t* count) {
  *count = 2 * of(instance).x.size();
  return fmi3OK;
}

fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance instance, std::size_t* count) {
  *count = of(instance).x.size();
  return fmi3OK;
}

fmi3Status fmi3GetContinuousStates(fmi3Instance instance, fmi3Float64 states[], std::size_t) {
  std::ranges::copy(of(instance).v, std::ranges::copy(of(instance).x, states).out);
  return fmi3OK;
}

fmi3Status fmi3SetContinuousStates(fmi3Instance instance, const fmi3Float64 states[], std::size_t) {
  auto& springs = of(instance);
  std::copy_n(states, springs.x.size(), springs.x.begin());
  std::copy_n(states + springs.x.size(), springs.v.size(), springs.v.begin());
  return fmi3OK;
}

fmi3Status fmi3GetContinuousStateDerivatives(fmi3Instance instance, fmi3Float64 derivatives[], std::size_t) {
  const auto& springs = of(instance);
  if (springs.x[0] > springs.domain) return fmi3Discard;
  std::ranges::copy(springs.accelerations(), std::ranges::copy(springs.v, derivatives).out);
  return fmi3OK;
}

/// Each known and unknown is a whole array.
fmi3Status fmi3GetDirectionalDerivative(fmi3Instance instance, const fmi3ValueReference unknowns[],
                                        std::size_t unknown_count, const fmi3ValueReference knowns[],
                                        std::size_t known_count, const fmi3Float64 seeds[], std::size_t,
                                        fmi3Float64 changes[], std::size_t) {
  Springs change = of(instance);
  for (auto* values : {&change.force, &change.x, &change.v}) std::ranges::fill(*values, 0.0);
  change.wall = 0;
  for (std::size_t i = 0; i < known_count; ++i) seeds += change.set(knowns[i], {seeds, change.x.size()});
  for (std::size_t i = 0; i < unknown_count; ++i) changes = std::ranges::copy(change.get(unknowns[i]), changes).out;
  return fmi3OK;
}

fmi3Status fmi3GetNominalsOfContinuousStates(fmi3Instance, fmi3Float64 nominals[], std::size_t count) {
  std::fill_n(nominals, count, 1.0);
  return fmi3OK;
}

fmi3Status fmi3GetEventIndicators(fmi3Instance instance, fmi3Float64 indicators[], std::size_t) {
  std::ranges::copy(of(instance).distances(), indicators);
  return fmi3OK;
}

fmi3Status fmi3CompletedIntegratorStep(fmi3Instance, fmi3Boolean, fmi3Boolean* enter_event_mode,
                                       fmi3Boolean* terminate) {
  *enter_event_mode = *terminate = false;
  return fmi3OK;
}

fmi3Status fmi3UpdateDiscreteStates(fmi3Instance instance, fmi3Boolean* need_update, fmi3Boolean* terminate,
                                    fmi3Boolean* nominals_changed, fmi3Boolean* states_changed,
                                    fmi3Boolean* next_event_defined, fmi3Float64*) {
  auto& springs = of(instance);
  *need_update = *terminate = *nominals_changed = *states_changed = *next_event_defined = false;
  for (std::size_t i = 0; i < springs.x.size(); ++i) {
    if (springs.x[i] < springs.wall || springs.v[i] <= 0) continue;
    springs.v[i] = -springs.v[i];
    ++springs.hits;
    springs.hit_time = static_cast<float>(springs.time);
    *states_changed = true;
  }
  return fmi3OK;
}
