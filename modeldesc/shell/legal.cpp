// SPDX-License-Identifier: Apache-2.0
#include "legal.hpp"

#include <fmt/format.h>

#include <array>

namespace mebots::shell {
namespace {

/// Placeholders in the texts: {0} is the prefix of the version's functions, {1} the function that sets a state, {2} the
/// function that initialises.
struct StateText {
  State state;
  std::string_view name;  // empty: use the version's own name
  std::string_view way_out;
};

constexpr std::array<StateText, 8> kStates = {{
    {State::instantiated, "instantiated", "call {2} first"},
    {State::initialization, "initialization mode", "call {0}ExitInitializationMode first, or {0}Reset to start over"},
    {State::step_complete, "", "continue with {0}DoStep, or call {0}Reset to start over"},
    {State::step_failed, "step failed", "call {0}Reset to start over, or {0}FreeInstance"},
    {State::configuration, "configuration mode", "call {0}ExitConfigurationMode first"},
    {State::terminated, "terminated", "call {0}Reset to start over, or {0}FreeInstance"},
    {State::error, "error", "see the previous error; then {0}Reset, {1} or {0}FreeInstance"},
    {State::fatal, "fatal", "this instance can no longer be used"},
}};

}  // namespace

std::string illegal_call_text(const Function& function, State state, const Version& version) {
  std::string allowed;
  std::string_view now;
  std::string way_out;
  for (const StateText& text : kStates) {
    const std::string_view name = text.name.empty() ? version.step_state : text.name;
    if (is_legal(function, text.state)) allowed += fmt::format("{}{}", allowed.empty() ? "" : ", ", name);
    if (text.state != state) continue;
    now = name;
    way_out = fmt::format(fmt::runtime(text.way_out), version.prefix, version.set_state_function,
                          version.initialising_functions);
  }
  if (allowed.empty())
    allowed = fmt::format("no state: steps of this FMU are finished when {}DoStep returns", version.prefix);
  return fmt::format("not allowed in state '{}' (allowed in: {}); {}", now, allowed, way_out);
}

}  // namespace mebots::shell
