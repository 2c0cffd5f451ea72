// SPDX-License-Identifier: Apache-2.0
#include "command.hpp"

#include "config/config_schema.hpp"

#include <cstdio>

namespace mebots::app {

void add_schema(CLI::App& app, Action& action) {
  auto* command = app.add_subcommand("schema", "Print the JSON schema of a config");
  command->footer(
      help_footer({"0 printed", "1 standard output is closed or full"}, {"mebots schema > mebots-config.schema.json"}));
  command->callback([&action] {
    action = [] {
      const auto schema = master::config_schema();
      return std::fwrite(schema.data(), 1, schema.size(), stdout) == schema.size() ? 0 : 1;
    };
  });
}

}  // namespace mebots::app
