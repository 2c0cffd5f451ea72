// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "config/json_node.hpp"
#include "config/system_description.hpp"

/// The sections of a config, one reader each. A reader finds what stands before its own key in the table of
/// config_reader.cpp already in `system`. All throw InputError with the place of what is wrong.
namespace mebots::master::config {

void read_text(const JsonNode& node, SystemDescription& system);
void read_step(const JsonNode& node, SystemDescription& system);
void read_instances(const JsonNode& node, SystemDescription& system);
void read_stop_time(const JsonNode& node, SystemDescription& system);
void read_connections(const JsonNode& node, SystemDescription& system);
void read_scenario(const JsonNode& node, SystemDescription& system);
/// The whole of a scenario file: `text` and `scenario`.
void read_scenario_file(const JsonNode& root, SystemDescription& system);
void read_algorithm(const JsonNode& node, SystemDescription& system);
void read_stop_when(const JsonNode& node, SystemDescription& system);
void read_outcomes(const JsonNode& node, SystemDescription& system);
void read_summary(const JsonNode& node, SystemDescription& system);
void read_record(const JsonNode& node, SystemDescription& system);
void read_pictures(const JsonNode& node, SystemDescription& system);
void read_log(const JsonNode& node, SystemDescription& system);
void read_threads(const JsonNode& node, SystemDescription& system);

}  // namespace mebots::master::config
