// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "version.hpp"

#include <cstdint>
#include <string>
#include <string_view>

/// The state machines of co-simulation in FMI 2.0 (standard 2.0.4, section 4.2.4) and FMI 3.0 (3.0.2, sections 2.3 and
/// 4.2): the states in which a call of each function is legal.
namespace mebots::shell {

/// States of an instance, as bits. The states "step in progress" and "step canceled" are omitted, because a step always
/// finishes before its call returns.
enum class State : std::uint8_t {
  instantiated = 1 << 0,
  initialization = 1 << 1,
  step_complete = 1 << 2,  // FMI 3.0: step mode
  step_failed = 1 << 3,
  configuration = 1 << 4,  // FMI 3.0
  terminated = 1 << 5,
  error = 1 << 6,
  fatal = 1 << 7,
};

struct Function {
  std::string_view name;
  std::uint8_t legal_states;
};

/// Sets of states in which functions of FMI 2.0 and 3.0 are legal.
namespace legal {
inline constexpr std::uint8_t kInstantiated = 1 << 0;
inline constexpr std::uint8_t kInitialization = 1 << 1;
inline constexpr std::uint8_t kStepComplete = 1 << 2;
inline constexpr std::uint8_t kStepFailed = 1 << 3;
inline constexpr std::uint8_t kConfiguration = 1 << 4;
inline constexpr std::uint8_t kTerminated = 1 << 5;
inline constexpr std::uint8_t kError = 1 << 6;
inline constexpr std::uint8_t kAfterInitialization = kStepComplete | kStepFailed | kTerminated | kError;
inline constexpr std::uint8_t kAlive = kInstantiated | kInitialization | kConfiguration | kAfterInitialization;
}  // namespace legal

inline bool is_legal(const Function& function, State state) {
  return (function.legal_states & static_cast<std::uint8_t>(state)) != 0;
}

/// Explains why the call is illegal in this state, and which call the tool must make instead.
std::string illegal_call_text(const Function& function, State state, const Version& version);

}  // namespace mebots::shell
