// SPDX-License-Identifier: Apache-2.0
#include "mebots/run_options.hpp"

#include "mebots/state/visitor.hpp"

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
}

}  // namespace mebots
