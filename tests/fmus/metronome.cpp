// SPDX-License-Identifier: Apache-2.0
// An FMU of FMI 3.0 with clocks. `beat` ticks every 0.3 s from 0.15 s on. Each beat starts the countdown `echo` of
// `delay` s. At each echo, the output clock `tock` ticks, and `tock_time` is set to its time. At each tick of the input
// clock `tap`, `heard` is added to `sum`, and `taps` increases by 1. With `endless`, an echo starts another echo after
// 0 s.
#include "fmi3_states.hpp"

namespace {

enum Reference : fmi3ValueReference { kBeat = 1, kEcho, kTock, kTap };
enum Variable : fmi3ValueReference { kBeats = 10, kTockTime, kHeard, kSum, kTaps, kDelay, kEndless };

struct Metronome {
  double time = 0;
  double tock_time = 0;
  double heard = 0;
  double sum = 0;
  double delay = 0.02;
  std::int32_t beats = 0;
  std::int32_t taps = 0;
  bool endless = false;
  bool beat = false;
  bool echo = false;
  bool tap = false;
  bool starts_echo = false;  // true if the interval of `echo` has changed
  double interval = 0;

  double* real(fmi3ValueReference reference) {
    switch (reference) {
      case kTockTime:
        return &tock_time;
      case kHeard:
        return &heard;
      case kSum:
        return &sum;
      default:
        return &delay;
    }
  }
};

Metronome& of(fmi3Instance instance) {
  return *static_cast<Metronome*>(instance);
}

}  // namespace

fmi3Instance fmi3InstantiateCoSimulation(fmi3String, fmi3String, fmi3String, fmi3Boolean, fmi3Boolean, fmi3Boolean,
                                         fmi3Boolean, const fmi3ValueReference[], std::size_t, fmi3InstanceEnvironment,
                                         fmi3LogMessageCallback, fmi3IntermediateUpdateCallback) {
  return new Metronome;
}

void fmi3FreeInstance(fmi3Instance instance) {
  delete &of(instance);
}

fmi3Status fmi3EnterInitializationMode(fmi3Instance instance, fmi3Boolean, fmi3Float64, fmi3Float64 start, fmi3Boolean,
                                       fmi3Float64) {
  of(instance).time = start;
  return fmi3OK;
}

fmi3Status fmi3GetFloat64(fmi3Instance instance, const fmi3ValueReference references[], std::size_t count,
                          fmi3Float64 values[], std::size_t) {
  for (std::size_t i = 0; i < count; ++i) values[i] = *of(instance).real(references[i]);
  return fmi3OK;
}

fmi3Status fmi3SetFloat64(fmi3Instance instance, const fmi3ValueReference references[], std::size_t count,
                          const fmi3Float64 values[], std::size_t) {
  for (std::size_t i = 0; i < count; ++i) *of(instance).real(references[i]) = values[i];
  return fmi3OK;
}

fmi3Status fmi3GetInt32(fmi3Instance instance, const fmi3ValueReference references[], std::size_t count,
                        fmi3Int32 values[], std::size_t) {
  for (std::size_t i = 0; i < count; ++i) {
    values[i] = references[i] == kBeats ? of(instance).beats : of(instance).taps;
  }
  return fmi3OK;
}

fmi3Status fmi3SetBoolean(fmi3Instance instance, const fmi3ValueReference[], std::size_t, const fmi3Boolean values[],
                          std::size_t) {
  of(instance).endless = values[0];
  return fmi3OK;
}

fmi3Status fmi3GetClock(fmi3Instance instance, const fmi3ValueReference[], std::size_t count, fmi3Clock values[]) {
  auto& metronome = of(instance);
  for (std::size_t i = 0; i < count; ++i) values[i] = metronome.echo;
  return fmi3OK;
}

/// Handles the ticks of input clocks, which the importer sets.
fmi3Status fmi3SetClock(fmi3Instance instance, const fmi3ValueReference references[], std::size_t count,
                        const fmi3Clock[]) {
  auto& metronome = of(instance);
  for (std::size_t i = 0; i < count; ++i) {
    if (references[i] == kBeat) {
      metronome.beat = true;
      ++metronome.beats;
    } else if (references[i] == kEcho) {
      metronome.echo = true;
      metronome.tock_time = metronome.time;
    } else {
      metronome.tap = true;
    }
  }
  return fmi3OK;
}

fmi3Status fmi3GetIntervalDecimal(fmi3Instance instance, const fmi3ValueReference[], std::size_t,
                                  fmi3Float64 intervals[], fmi3IntervalQualifier qualifiers[]) {
  auto& metronome = of(instance);
  intervals[0] = metronome.interval;
  qualifiers[0] = metronome.starts_echo ? fmi3IntervalChanged : fmi3IntervalNotYetKnown;
  metronome.starts_echo = false;
  return fmi3OK;
}

fmi3Status fmi3UpdateDiscreteStates(fmi3Instance instance, fmi3Boolean* need_update, fmi3Boolean* terminate,
                                    fmi3Boolean* nominals_changed, fmi3Boolean* states_changed,
                                    fmi3Boolean* next_event_defined, fmi3Float64*) {
  auto& metronome = of(instance);
  *need_update = *terminate = *nominals_changed = *states_changed = *next_event_defined = false;
  if (metronome.beat || (metronome.echo && metronome.endless)) {
    metronome.starts_echo = true;
    metronome.interval = metronome.beat ? metronome.delay : 0;
  }
  if (metronome.tap) {
    metronome.sum += metronome.heard;
    ++metronome.taps;
  }
  metronome.beat = metronome.echo = metronome.tap = false;
  return fmi3OK;
}

fmi3Status fmi3DoStep(fmi3Instance instance, fmi3Float64 start, fmi3Float64 step, fmi3Boolean, fmi3Boolean* event,
                      fmi3Boolean* terminate, fmi3Boolean* early, fmi3Float64*) {
  of(instance).time = start + step;
  *event = *terminate = *early = false;
  return fmi3OK;
}

FMI3_SAVED_STATES(Metronome)
