// SPDX-License-Identifier: Apache-2.0
// An FMU of FMI 3.0 for model exchange: an integrator x' = slope + drive with clocks.
//
// At each tick of the periodic clock `sample`, `control` is set to -gain measured. Each time x has risen by another
// 0.3, `crossed` ticks, `crossing_time` is set, and the countdown `echo` of `delay` starts. When `tap` ticks, `heard`
// is added to `sum`. With `endless`, an echo starts another echo without delay.
//
// The FMU returns fmi3Error for calls that the standard does not permit: clocks outside of event mode, and clocked
// variables while their clocks do not tick.
#include "fmi3_states.hpp"

namespace {

enum Clock : fmi3ValueReference { kSample = 1, kEcho, kCrossed, kTap };
enum Variable : fmi3ValueReference {
  kX = 10,
  kDerX,
  kDrive,
  kSlope,
  kGain,
  kMeasured,
  kControl,
  kCrossingTime,
  kHeard,
  kSum,
  kEchoTime,
  kDelay,
  kDistance
};

struct Sampler {
  double time = 0;
  double x = 0;
  double drive = 0;
  double slope = 0;
  double gain = 2;
  double measured = 0;
  double heard = 0;
  double sum = 0;
  double echo_time = 0;
  double delay = 0.02;
  double level = 0.3;
  double interval = 0;
  bool endless = false;
  bool in_initialization = false;
  bool in_event = false;
  bool sample = false;  // true while the clock ticks
  bool echo = false;
  bool crossed = false;
  bool tap = false;
  bool starts_echo = false;  // true if the interval of `echo` has changed

  bool get(fmi3ValueReference reference, double& value) const {
    switch (reference) {
      case kX:
        value = x;
        return true;
      case kDerX:
        value = slope + drive;
        return true;
      case kControl:
        value = -gain * measured;
        return sample;
      case kCrossingTime:
        value = time;
        return crossed;
      case kSum:
        value = sum;
        return true;
      case kEchoTime:
        value = echo_time;
        return true;
      case kDistance:
        value = x - level;
        return true;
      default:
        return false;
    }
  }
  bool set(fmi3ValueReference reference, double value) {
    switch (reference) {
      case kX:
        x = value;
        return true;
      case kDrive:
        drive = value;
        return true;
      case kSlope:
        slope = value;
        return true;
      case kGain:
        gain = value;
        return true;
      case kMeasured:
        measured = value;
        return sample;
      case kHeard:
        heard = value;
        return tap;
      case kDelay:
        delay = value;
        return true;
      default:
        return false;
    }
  }
};

Sampler& of(fmi3Instance instance) {
  return *static_cast<Sampler*>(instance);
}

fmi3Status only_if(bool allowed) {
  return allowed ? fmi3OK : fmi3Error;
}

}  // namespace

fmi3Instance fmi3InstantiateModelExchange(fmi3String, fmi3String, fmi3String, fmi3Boolean, fmi3Boolean,
                                          fmi3InstanceEnvironment, fmi3LogMessageCallback) {
  return new Sampler;
}

void fmi3FreeInstance(fmi3Instance instance) {
  delete &of(instance);
}

fmi3Status fmi3EnterInitializationMode(fmi3Instance instance, fmi3Boolean, fmi3Float64, fmi3Float64 start, fmi3Boolean,
                                       fmi3Float64) {
  of(instance).time = start;
  of(instance).in_initialization = true;
  return fmi3OK;
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance instance) {
  of(instance).in_initialization = false;
  of(instance).in_event = true;
  return fmi3OK;
}

fmi3Status fmi3EnterEventMode(fmi3Instance instance) {
  auto& sampler = of(instance);
  sampler.in_event = true;
  sampler.crossed = sampler.x >= sampler.level;
  return fmi3OK;
}

fmi3Status fmi3EnterContinuousTimeMode(fmi3Instance instance) {
  of(instance).in_event = false;
  return fmi3OK;
}

fmi3Status fmi3GetFloat64(fmi3Instance instance, const fmi3ValueReference references[], std::size_t count,
                          fmi3Float64 values[], std::size_t) {
  bool allowed = true;
  for (std::size_t i = 0; i < count; ++i) allowed &= of(instance).get(references[i], values[i]);
  return only_if(allowed);
}

fmi3Status fmi3SetFloat64(fmi3Instance instance, const fmi3ValueReference references[], std::size_t count,
                          const fmi3Float64 values[], std::size_t) {
  bool allowed = true;
  for (std::size_t i = 0; i < count; ++i) allowed &= of(instance).set(references[i], values[i]);
  return only_if(allowed);
}

fmi3Status fmi3SetBoolean(fmi3Instance instance, const fmi3ValueReference[], std::size_t, const fmi3Boolean values[],
                          std::size_t) {
  of(instance).endless = values[0];
  return fmi3OK;
}

fmi3Status fmi3GetClock(fmi3Instance instance, const fmi3ValueReference[], std::size_t, fmi3Clock values[]) {
  values[0] = of(instance).crossed;
  return only_if(of(instance).in_event);
}

fmi3Status fmi3SetClock(fmi3Instance instance, const fmi3ValueReference references[], std::size_t, const fmi3Clock[]) {
  auto& sampler = of(instance);
  (references[0] == kSample ? sampler.sample : references[0] == kEcho ? sampler.echo : sampler.tap) = true;
  return only_if(sampler.in_event);
}

fmi3Status fmi3GetIntervalDecimal(fmi3Instance instance, const fmi3ValueReference[], std::size_t,
                                  fmi3Float64 intervals[], fmi3IntervalQualifier qualifiers[]) {
  auto& sampler = of(instance);
  intervals[0] = sampler.interval;
  qualifiers[0] = sampler.starts_echo ? fmi3IntervalChanged : fmi3IntervalNotYetKnown;
  sampler.starts_echo = false;
  return only_if(sampler.in_event || sampler.in_initialization);
}

fmi3Status fmi3UpdateDiscreteStates(fmi3Instance instance, fmi3Boolean* need_update, fmi3Boolean* terminate,
                                    fmi3Boolean* nominals_changed, fmi3Boolean* states_changed,
                                    fmi3Boolean* next_event_defined, fmi3Float64*) {
  auto& sampler = of(instance);
  *need_update = *terminate = *nominals_changed = *states_changed = *next_event_defined = false;
  if (sampler.crossed || (sampler.echo && sampler.endless)) {
    sampler.starts_echo = true;
    sampler.interval = sampler.crossed ? sampler.delay : 0;
  }
  if (sampler.crossed) sampler.level += 0.3;
  if (sampler.echo) sampler.echo_time = sampler.time;
  if (sampler.tap) sampler.sum += sampler.heard;
  sampler.sample = sampler.echo = sampler.crossed = sampler.tap = false;
  return only_if(sampler.in_event);
}

fmi3Status fmi3SetTime(fmi3Instance instance, fmi3Float64 time) {
  of(instance).time = time;
  return fmi3OK;
}

fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance, std::size_t* count) {
  *count = 1;
  return fmi3OK;
}

fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance, std::size_t* count) {
  *count = 1;
  return fmi3OK;
}

fmi3Status fmi3GetContinuousStates(fmi3Instance instance, fmi3Float64 states[], std::size_t) {
  states[0] = of(instance).x;
  return fmi3OK;
}

fmi3Status fmi3SetContinuousStates(fmi3Instance instance, const fmi3Float64 states[], std::size_t) {
  of(instance).x = states[0];
  return fmi3OK;
}

fmi3Status fmi3GetContinuousStateDerivatives(fmi3Instance instance, fmi3Float64 derivatives[], std::size_t) {
  derivatives[0] = of(instance).slope + of(instance).drive;
  return fmi3OK;
}

fmi3Status fmi3GetNominalsOfContinuousStates(fmi3Instance, fmi3Float64 nominals[], std::size_t) {
  nominals[0] = 1;
  return fmi3OK;
}

fmi3Status fmi3GetEventIndicators(fmi3Instance instance, fmi3Float64 indicators[], std::size_t) {
  indicators[0] = of(instance).x - of(instance).level;
  return fmi3OK;
}

fmi3Status fmi3CompletedIntegratorStep(fmi3Instance, fmi3Boolean, fmi3Boolean* enter_event_mode,
                                       fmi3Boolean* terminate) {
  *enter_event_mode = *terminate = false;
  return fmi3OK;
}

FMI3_SAVED_STATES(Sampler)
