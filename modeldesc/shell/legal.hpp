// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

/// Which function may be called when: the state machine of FMI 2.0 co-simulation (standard 2.0.4, section 4.2.4).
namespace mebots::shell {

/// States of an instance, as bits. A step of ours never stays in progress, so that state is missing.
enum class State : std::uint8_t {
  instantiated = 1 << 0,
  initialization = 1 << 1,
  step_complete = 1 << 2,
  step_failed = 1 << 3,
  step_canceled = 1 << 4,
  terminated = 1 << 5,
  error = 1 << 6,
  fatal = 1 << 7,
};

struct Function {
  std::string_view name;
  std::uint8_t legal_states;
};

namespace legal {
inline constexpr std::uint8_t kInstantiated = 1 << 0;
inline constexpr std::uint8_t kInitialization = 1 << 1;
inline constexpr std::uint8_t kStepComplete = 1 << 2;
inline constexpr std::uint8_t kStepFailed = 1 << 3;
inline constexpr std::uint8_t kStepCanceled = 1 << 4;
inline constexpr std::uint8_t kTerminated = 1 << 5;
inline constexpr std::uint8_t kError = 1 << 6;
inline constexpr std::uint8_t kAfterInitialization = kStepComplete | kStepFailed | kStepCanceled | kTerminated | kError;
inline constexpr std::uint8_t kAlive = kInstantiated | kInitialization | kAfterInitialization;
inline constexpr std::uint8_t kStatus = kStepComplete | kStepFailed | kTerminated;
}  // namespace legal

/// The table. One row per function that takes an instance.
namespace function {
using namespace legal;
inline constexpr Function kSetDebugLogging{"fmi2SetDebugLogging", kAlive};
inline constexpr Function kSetupExperiment{"fmi2SetupExperiment", kInstantiated};
inline constexpr Function kEnterInitializationMode{"fmi2EnterInitializationMode", kInstantiated};
inline constexpr Function kExitInitializationMode{"fmi2ExitInitializationMode", kInitialization};
inline constexpr Function kTerminate{"fmi2Terminate", kStepComplete | kStepFailed};
inline constexpr Function kReset{"fmi2Reset", kAlive};
inline constexpr Function kGetReal{"fmi2GetReal", kInitialization | kAfterInitialization};
inline constexpr Function kGetInteger{"fmi2GetInteger", kInitialization | kAfterInitialization};
inline constexpr Function kGetBoolean{"fmi2GetBoolean", kInitialization | kAfterInitialization};
inline constexpr Function kGetString{"fmi2GetString", kInitialization | kAfterInitialization};
inline constexpr Function kSetReal{"fmi2SetReal", kInstantiated | kInitialization | kStepComplete};
inline constexpr Function kSetInteger{"fmi2SetInteger", kInstantiated | kInitialization | kStepComplete};
inline constexpr Function kSetBoolean{"fmi2SetBoolean", kInstantiated | kInitialization | kStepComplete};
inline constexpr Function kSetString{"fmi2SetString", kInstantiated | kInitialization | kStepComplete};
inline constexpr Function kGetFmuState{"fmi2GetFMUstate", kAlive};
inline constexpr Function kSetFmuState{"fmi2SetFMUstate", kAlive};
inline constexpr Function kFreeFmuState{"fmi2FreeFMUstate", kAlive};
inline constexpr Function kSerializedFmuStateSize{"fmi2SerializedFMUstateSize", kAlive};
inline constexpr Function kSerializeFmuState{"fmi2SerializeFMUstate", kAlive};
inline constexpr Function kDeSerializeFmuState{"fmi2DeSerializeFMUstate", kAlive};
inline constexpr Function kGetDirectionalDerivative{"fmi2GetDirectionalDerivative",
                                                    kInitialization | kAfterInitialization};
inline constexpr Function kSetRealInputDerivatives{"fmi2SetRealInputDerivatives",
                                                   kInstantiated | kInitialization | kStepComplete};
inline constexpr Function kGetRealOutputDerivatives{"fmi2GetRealOutputDerivatives", kAfterInitialization};
inline constexpr Function kDoStep{"fmi2DoStep", kStepComplete};
inline constexpr Function kCancelStep{"fmi2CancelStep", 0};
inline constexpr Function kGetStatus{"fmi2GetStatus", kStatus};
inline constexpr Function kGetRealStatus{"fmi2GetRealStatus", kStatus};
inline constexpr Function kGetIntegerStatus{"fmi2GetIntegerStatus", kStatus};
inline constexpr Function kGetBooleanStatus{"fmi2GetBooleanStatus", kStatus};
inline constexpr Function kGetStringStatus{"fmi2GetStringStatus", kStatus};
}  // namespace function

inline bool is_legal(const Function& function, State state) {
  return (function.legal_states & static_cast<std::uint8_t>(state)) != 0;
}

/// What is wrong with this call in this state, and what to call instead.
std::string illegal_call_text(const Function& function, State state);

}  // namespace mebots::shell
