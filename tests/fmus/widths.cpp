// SPDX-License-Identifier: Apache-2.0
// An FMU of FMI 3.0 with inputs of five types of numbers. Each output `*_out` is equal to its input.
#include "mebots/fmi3/functions.hpp"

namespace {

struct Widths {
  fmi3Float64 wide = 0;
  fmi3Float32 single = 0;
  fmi3Int64 whole = 0;
  fmi3UInt8 byte = 0;
  fmi3UInt64 huge = 18446744073709551615U;
};

template <typename Value>
fmi3Status get(Value Widths::*member, fmi3Instance instance, std::size_t count, Value values[]) {
  for (std::size_t i = 0; i < count; ++i) values[i] = static_cast<Widths*>(instance)->*member;
  return fmi3OK;
}

template <typename Value>
fmi3Status set(Value Widths::*member, fmi3Instance instance, std::size_t count, const Value values[]) {
  for (std::size_t i = 0; i < count; ++i) static_cast<Widths*>(instance)->*member = values[i];
  return fmi3OK;
}

}  // namespace

fmi3Instance fmi3InstantiateCoSimulation(fmi3String, fmi3String, fmi3String, fmi3Boolean, fmi3Boolean, fmi3Boolean,
                                         fmi3Boolean, const fmi3ValueReference[], std::size_t, fmi3InstanceEnvironment,
                                         fmi3LogMessageCallback, fmi3IntermediateUpdateCallback) {
  return new Widths;
}

void fmi3FreeInstance(fmi3Instance instance) {
  delete static_cast<Widths*>(instance);
}

fmi3Status fmi3EnterInitializationMode(fmi3Instance, fmi3Boolean, fmi3Float64, fmi3Float64, fmi3Boolean, fmi3Float64) {
  return fmi3OK;
}

fmi3Status fmi3DoStep(fmi3Instance, fmi3Float64, fmi3Float64, fmi3Boolean, fmi3Boolean* event, fmi3Boolean* terminate,
                      fmi3Boolean* early, fmi3Float64*) {
  *event = *terminate = *early = false;
  return fmi3OK;
}

#define MEBOTS_ACCESS(Name, Type, member)                                                                             \
  fmi3Status fmi3Get##Name(fmi3Instance instance, const fmi3ValueReference[], std::size_t count, Type values[],       \
                           std::size_t) {                                                                             \
    return get(&Widths::member, instance, count, values);                                                             \
  }                                                                                                                   \
  fmi3Status fmi3Set##Name(fmi3Instance instance, const fmi3ValueReference[], std::size_t count, const Type values[], \
                           std::size_t) {                                                                             \
    return set(&Widths::member, instance, count, values);                                                             \
  }

MEBOTS_ACCESS(Float64, fmi3Float64, wide)
MEBOTS_ACCESS(Float32, fmi3Float32, single)
MEBOTS_ACCESS(Int64, fmi3Int64, whole)
MEBOTS_ACCESS(UInt8, fmi3UInt8, byte)
MEBOTS_ACCESS(UInt64, fmi3UInt64, huge)
