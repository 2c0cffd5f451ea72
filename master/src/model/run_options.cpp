// SPDX-License-Identifier: Apache-2.0
#include "mebots/run_options.hpp"

#include "mebots/run_state.hpp"
#include "mebots/state/visitor.hpp"

#include <array>
#include <cstddef>

namespace mebots {

void UntypedText::visit(state::Visitor& v) {
  v("text", text);
}

void Setting::visit(state::Visitor& v) {
  v("variable", variable);
  v("value", value);
  v("place", place);
}

void RunOptions::visit(state::Visitor& v) {
  v("out", out);
  v("in_memory", in_memory);
  v("settings", settings);
  v("scenarios", scenarios);
  v("inputs", inputs);
  v("stop_time_s", stop_time_s);
  v("step_s", step_s);
  v("record", record);
  v("isolate", isolate);
  v("statistics", statistics);
  v("checkpoint_every_s", checkpoint_every_s);
  v("draws_calibration", draws_calibration);
}

namespace {

// Names in the order of the enumerations.
constexpr std::array<std::string_view, 5> kStates = {"open", "ready", "running", "ended", "failed"};
constexpr std::array<std::string_view, 6> kReasons = {"stop_time",   "stop_condition", "terminated",
                                                      "interrupted", "closed",         "failed"};
static_assert(kStates.size() == static_cast<std::size_t>(RunState::failed) + 1);
static_assert(kReasons.size() == static_cast<std::size_t>(EndReason::failed) + 1);

}  // namespace

std::string_view name_of(RunState state) {
  return kStates[static_cast<std::size_t>(state)];
}

std::string_view name_of(EndReason reason) {
  return kReasons[static_cast<std::size_t>(reason)];
}

}  // namespace mebots
