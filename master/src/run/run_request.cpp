// SPDX-License-Identifier: Apache-2.0
#include "run/run_request.hpp"

namespace mebots::master {
RunRequest with_absolute_paths(RunRequest request) {
  request.config = std::filesystem::absolute(request.config);
  for (auto& file : request.scenarios) file = std::filesystem::absolute(file);
  for (auto& file : request.inputs) file = std::filesystem::absolute(file);
  if (!request.folder.empty()) request.folder = std::filesystem::absolute(request.folder);
  return request;
}

void RunRequest::visit(state::Visitor& v) {
  v("config", config);
  v("settings", settings);
  v("scenarios", scenarios);
  v("inputs", inputs);
  v("stop_time_ns", stop_time_ns);
  v("step", step);
  v("record", record);
  v("folder", folder);
  v("in_memory", in_memory);
  v("isolate", isolate);
  v("statistics", statistics);
  v("checkpoint_every_ns", checkpoint_every_ns);
}

}  // namespace mebots::master
