// SPDX-License-Identifier: Apache-2.0
// An FMU of FMI 3.0 for co-simulation that calls back in its steps: x[i]' = u[i], by ten midpoint steps. It requests
// the inputs at each midpoint, so it integrates linearly changing inputs exactly. `updates` counts the callbacks.
// Setting an input above `limit` returns fmi3Error.
#include "mebots/fmi3/functions.hpp"

#include <algorithm>
#include <array>

namespace {

enum Reference : fmi3ValueReference { kU = 1, kX, kUpdates, kLimit };

struct Follower {
  fmi3InstanceEnvironment environment = nullptr;
  fmi3IntermediateUpdateCallback update = nullptr;
  std::array<double, 2> u{};
  std::array<double, 2> x{};
  double limit = 1e9;
  std::int32_t updates = 0;
};

Follower& of(fmi3Instance instance) {
  return *static_cast<Follower*>(instance);
}

}  // namespace

fmi3Instance fmi3InstantiateCoSimulation(fmi3String, fmi3String, fmi3String, fmi3Boolean, fmi3Boolean, fmi3Boolean,
                                         fmi3Boolean, const fmi3ValueReference variables[], std::size_t count,
                                         fmi3InstanceEnvironment environment, fmi3LogMessageCallback,
                                         fmi3IntermediateUpdateCallback update) {
  auto* const follower = new Follower;
  follower->environment = environment;
  if (std::find(variables, variables + count, kU) != variables + count) follower->update = update;
  return follower;
}

void fmi3FreeInstance(fmi3Instance instance) {
  delete &of(instance);
}

fmi3Status fmi3EnterInitializationMode(fmi3Instance, fmi3Boolean, fmi3Float64, fmi3Float64, fmi3Boolean, fmi3Float64) {
  return fmi3OK;
}

fmi3Status fmi3GetFloat64(fmi3Instance instance, const fmi3ValueReference references[], std::size_t count,
                          fmi3Float64 values[], std::size_t) {
  const auto& follower = of(instance);
  for (std::size_t i = 0; i < count; ++i) {
    if (references[i] == kLimit) {
      *values++ = follower.limit;
    } else {
      values = std::ranges::copy(references[i] == kU ? follower.u : follower.x, values).out;
    }
  }
  return fmi3OK;
}

fmi3Status fmi3SetFloat64(fmi3Instance instance, const fmi3ValueReference references[], std::size_t count,
                          const fmi3Float64 values[], std::size_t) {
  auto& follower = of(instance);
  for (std::size_t i = 0; i < count; ++i) {
    if (references[i] == kLimit) {
      follower.limit = *values++;
      continue;
    }
    std::copy_n(values, follower.u.size(), follower.u.begin());
    values += follower.u.size();
    if (std::ranges::max(follower.u) > follower.limit) return fmi3Error;
  }
  return fmi3OK;
}

fmi3Status fmi3GetInt32(fmi3Instance instance, const fmi3ValueReference[], std::size_t, fmi3Int32 values[],
                        std::size_t) {
  values[0] = of(instance).updates;
  return fmi3OK;
}

fmi3Status fmi3DoStep(fmi3Instance instance, fmi3Float64 start, fmi3Float64 step, fmi3Boolean, fmi3Boolean* event,
                      fmi3Boolean* terminate, fmi3Boolean* early, fmi3Float64* reached) {
  constexpr int kParts = 10;
  auto& follower = of(instance);
  for (int part = 0; part < kParts; ++part) {
    if (follower.update != nullptr) {
      bool returns = true;
      double return_time = 0;
      follower.update(follower.environment, start + (part + 0.5) * step / kParts, true, true, false, false, &returns,
                      &return_time);
      ++follower.updates;
      if (returns) return fmi3Error;
    }
    for (std::size_t i = 0; i < follower.x.size(); ++i) follower.x[i] += follower.u[i] * step / kParts;
  }
  *event = *terminate = *early = false;
  *reached = start + step;
  return fmi3OK;
}
