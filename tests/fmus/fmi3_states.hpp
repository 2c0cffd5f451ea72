// SPDX-License-Identifier: Apache-2.0
// Saved states of FMI 3.0 for test FMUs.
#pragma once

#include "mebots/fmi3/functions.hpp"

#include <cstring>
#include <memory>

/// Defines the functions for saved states. A saved state is a copy of a `State`. of(instance) must return a reference
/// to a State, or to a class derived from it.
#define FMI3_SAVED_STATES(State)                                                                                    \
  fmi3Status fmi3GetFMUState(fmi3Instance instance, fmi3FMUState* state) {                                          \
    *state = new State(of(instance));                                                                               \
    return fmi3OK;                                                                                                  \
  }                                                                                                                 \
  fmi3Status fmi3SetFMUState(fmi3Instance instance, fmi3FMUState state) {                                           \
    static_cast<State&>(of(instance)) = *static_cast<State*>(state);                                                \
    return fmi3OK;                                                                                                  \
  }                                                                                                                 \
  fmi3Status fmi3FreeFMUState(fmi3Instance, fmi3FMUState* state) {                                                  \
    delete static_cast<State*>(*state);                                                                             \
    *state = nullptr;                                                                                               \
    return fmi3OK;                                                                                                  \
  }                                                                                                                 \
  fmi3Status fmi3SerializedFMUStateSize(fmi3Instance, fmi3FMUState, std::size_t* size) {                            \
    *size = sizeof(State);                                                                                          \
    return fmi3OK;                                                                                                  \
  }                                                                                                                 \
  fmi3Status fmi3SerializeFMUState(fmi3Instance, fmi3FMUState state, fmi3Byte bytes[], std::size_t size) {          \
    std::memcpy(bytes, state, size);                                                                                \
    return fmi3OK;                                                                                                  \
  }                                                                                                                 \
  fmi3Status fmi3DeserializeFMUState(fmi3Instance, const fmi3Byte bytes[], std::size_t size, fmi3FMUState* state) { \
    auto* const saved = std::make_unique<State>().release();                                                        \
    std::memcpy(static_cast<void*>(saved), bytes, size);                                                            \
    *state = saved;                                                                                                 \
    return fmi3OK;                                                                                                  \
  }
