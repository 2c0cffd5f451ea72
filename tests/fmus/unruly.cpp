// SPDX-License-Identifier: Apache-2.0
// An FMU of FMI 3.0 with `n` outputs `y`. Each is the integral of 1. From the time `at` on, the FMU commits the fault
// with the number `fault`.
#include "fmi3_states.hpp"

#include <cmath>
#include <vector>

namespace {

enum Reference : fmi3ValueReference { kSize = 1, kFault, kAt, kY, kEvents, kBlob, kBulk };

enum class Fault : fmi3Int32 {
  none,
  early,       // returns in the middle of each step, because of an event
  stuck,       // returns at the start of a step, again and again
  past,        // returns at a time before the step
  future,      // returns at a time after the step
  no_time,     // returns at a time that is not a number
  endless,     // each event requires another update, without end
  growing,     // `blob` has twice as many bytes after each step
  huge,        // `bulk` reports a size of 2^31 bytes
  unreadable,  // `bulk` is at an address without memory
  more,        // writes one element of `y` too many
  fewer,       // expects one element of `y` fewer than `n`
};

struct State {
  fmi3UInt64 size = 2;
  Fault fault = Fault::none;
  double at = 0.5;
  double time = 0;
  double y = 0;
  fmi3Int32 events = 0;
  fmi3UInt64 bytes = 1024;  // size of `blob`

  bool faults() const { return time >= at; }
};

struct Unruly : State {
  std::vector<fmi3Byte> blob;
  fmi3InstanceEnvironment environment = nullptr;
  fmi3LogMessageCallback log = nullptr;
};

Unruly& of(fmi3Instance instance) {
  return *static_cast<Unruly*>(instance);
}

}  // namespace

fmi3Instance fmi3InstantiateCoSimulation(fmi3String, fmi3String, fmi3String, fmi3Boolean, fmi3Boolean, fmi3Boolean,
                                         fmi3Boolean, const fmi3ValueReference[], std::size_t,
                                         fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
                                         fmi3IntermediateUpdateCallback) {
  auto* const unruly = new Unruly;
  unruly->environment = environment;
  unruly->log = log;
  return unruly;
}

void fmi3FreeInstance(fmi3Instance instance) {
  delete &of(instance);
}

fmi3Status fmi3EnterInitializationMode(fmi3Instance instance, fmi3Boolean, fmi3Float64, fmi3Float64 start, fmi3Boolean,
                                       fmi3Float64) {
  of(instance).time = start;
  return fmi3OK;
}

fmi3Status fmi3EnterEventMode(fmi3Instance instance) {
  ++of(instance).events;
  return fmi3OK;
}

fmi3Status fmi3UpdateDiscreteStates(fmi3Instance instance, fmi3Boolean* need_update, fmi3Boolean* terminate,
                                    fmi3Boolean* nominals_changed, fmi3Boolean* states_changed,
                                    fmi3Boolean* next_event_defined, fmi3Float64*) {
  *need_update = of(instance).fault == Fault::endless && of(instance).faults();
  *terminate = *nominals_changed = *states_changed = *next_event_defined = false;
  return fmi3OK;
}

fmi3Status fmi3DoStep(fmi3Instance instance, fmi3Float64 start, fmi3Float64 step, fmi3Boolean, fmi3Boolean* event,
                      fmi3Boolean* terminate, fmi3Boolean* early, fmi3Float64* reached) {
  constexpr double kWholeStep = 0.075;  // shorter than the tests' step of 0.1 s
  auto& unruly = of(instance);
  unruly.time = start;
  *event = *terminate = *early = false;
  *reached = start + step;
  if (unruly.faults()) {
    *early = true;
    switch (unruly.fault) {
      case Fault::early:
        *event = *early = step > kWholeStep;
        if (*early) *reached = start + step / 2;
        break;
      case Fault::stuck:
        *reached = start;
        break;
      case Fault::past:
        *reached = start - step;
        break;
      case Fault::future:
        *reached = start + 2 * step;
        break;
      case Fault::no_time:
        *reached = std::nan("");
        break;
      case Fault::endless:
        *event = true;
        *early = false;
        break;
      case Fault::growing:
        unruly.bytes *= 2;
        [[fallthrough]];
      default:
        *early = false;
    }
  }
  if (*reached > start) unruly.y += *reached - start;
  unruly.time = *reached;
  return fmi3OK;
}

fmi3Status fmi3SetUInt64(fmi3Instance instance, const fmi3ValueReference[], std::size_t, const fmi3UInt64 values[],
                         std::size_t) {
  of(instance).size = values[0];
  return fmi3OK;
}

fmi3Status fmi3GetFloat64(fmi3Instance instance, const fmi3ValueReference references[], std::size_t count,
                          fmi3Float64 values[], std::size_t value_count) {
  auto& unruly = of(instance);
  if (count != 1 || references[0] != kY) return fmi3Error;
  const bool is_fewer = unruly.fault == Fault::fewer && unruly.faults();
  if (value_count != unruly.size - (is_fewer ? 1 : 0)) {
    unruly.log(unruly.environment, fmi3Error, "logStatusError", "y has another number of elements");
    return fmi3Error;
  }
  const bool is_more = unruly.fault == Fault::more && unruly.faults();
  for (std::size_t i = 0; i < value_count + (is_more ? 1 : 0); ++i) values[i] = unruly.y;
  return fmi3OK;
}

fmi3Status fmi3SetFloat64(fmi3Instance instance, const fmi3ValueReference[], std::size_t, const fmi3Float64 values[],
                          std::size_t) {
  of(instance).at = values[0];
  return fmi3OK;
}

fmi3Status fmi3GetInt32(fmi3Instance instance, const fmi3ValueReference[], std::size_t, fmi3Int32 values[],
                        std::size_t) {
  values[0] = of(instance).events;
  return fmi3OK;
}

fmi3Status fmi3SetInt32(fmi3Instance instance, const fmi3ValueReference[], std::size_t, const fmi3Int32 values[],
                        std::size_t) {
  of(instance).fault = static_cast<Fault>(values[0]);
  return fmi3OK;
}

fmi3Status fmi3GetBinary(fmi3Instance instance, const fmi3ValueReference references[], std::size_t count,
                         std::size_t sizes[], fmi3Binary values[], std::size_t) {
  auto& unruly = of(instance);
  unruly.blob.resize(unruly.bytes);
  for (std::size_t i = 0; i < count; ++i) {
    sizes[i] = unruly.bytes;
    values[i] = unruly.blob.data();
    if (references[i] != kBulk || !unruly.faults()) continue;
    if (unruly.fault == Fault::huge) sizes[i] = std::size_t{1} << 31;
    if (unruly.fault == Fault::unreadable) values[i] = reinterpret_cast<fmi3Binary>(std::uintptr_t{4096});
  }
  return fmi3OK;
}

FMI3_SAVED_STATES(State)
