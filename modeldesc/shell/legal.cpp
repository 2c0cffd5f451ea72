// SPDX-License-Identifier: Apache-2.0
#include "legal.hpp"

#include <fmt/format.h>

namespace mebots::shell {
namespace {

struct StateText {
  State state;
  std::string_view name;
  std::string_view way_out;
};

constexpr std::array<StateText, 8> kStates = {{
    {State::instantiated, "instantiated",
     "call fmi2SetupExperiment, fmi2EnterInitializationMode and fmi2ExitInitializationMode first"},
    {State::initialization, "initialization mode", "call fmi2ExitInitializationMode first, or fmi2Reset to start over"},
    {State::step_complete, "step complete", "go on with fmi2DoStep, or call fmi2Reset to start over"},
    {State::step_failed, "step failed", "call fmi2Reset to start over, or fmi2FreeInstance"},
    {State::step_canceled, "step canceled", "call fmi2Reset to start over, or fmi2FreeInstance"},
    {State::terminated, "terminated", "call fmi2Reset to start over, or fmi2FreeInstance"},
    {State::error, "error", "read the error before this one; then fmi2Reset, fmi2SetFMUstate or fmi2FreeInstance"},
    {State::fatal, "fatal", "this instance cannot be used any more"},
}};

}  // namespace

std::string illegal_call_text(const Function& function, State state) {
  std::string allowed;
  std::string_view now;
  std::string_view way_out;
  for (const StateText& text : kStates) {
    if (is_legal(function, text.state)) allowed += fmt::format("{}{}", allowed.empty() ? "" : ", ", text.name);
    if (text.state == state) {
      now = text.name;
      way_out = text.way_out;
    }
  }
  if (allowed.empty()) allowed = "no state: steps of this FMU are finished when fmi2DoStep returns";
  return fmt::format("not allowed in state '{}' (allowed in: {}); {}", now, allowed, way_out);
}

}  // namespace mebots::shell
