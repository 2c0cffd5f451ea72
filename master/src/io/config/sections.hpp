// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/data/node.hpp"
#include "model/system_description.hpp"

/// The sections of a config, one reader each. A reader finds what stands before its own key in the table of
/// config_reader.cpp already in `system`. They note what is wrong in the
/// node's document, and throw data::Mistakes where they cannot go on.
namespace mebots::master::config {

void read_text(const data::Node& node, SystemDescription& system);
void read_step(const data::Node& node, SystemDescription& system);
void read_instances(const data::Node& node, SystemDescription& system);
void read_start_time(const data::Node& node, SystemDescription& system);
void read_stop_time(const data::Node& node, SystemDescription& system);
void read_connections(const data::Node& node, SystemDescription& system);
void read_scenario(const data::Node& node, SystemDescription& system);
void read_inputs(const data::Node& node, SystemDescription& system);
/// The whole of a scenario file: `text` and `scenario`. Paths in it are relative to `folder`.
void read_scenario_file(const data::Node& root, SystemDescription& system, const std::filesystem::path& folder);
void read_algorithm(const data::Node& node, SystemDescription& system);
void read_stop_when(const data::Node& node, SystemDescription& system);
void read_outcomes(const data::Node& node, SystemDescription& system);
void read_summary(const data::Node& node, SystemDescription& system);
void read_record(const data::Node& node, SystemDescription& system);
void read_pictures(const data::Node& node, SystemDescription& system);
void read_view(const data::Node& node, SystemDescription& system);
void read_log(const data::Node& node, SystemDescription& system);
void read_coupling(const data::Node& node, SystemDescription& system);
void read_threads(const data::Node& node, SystemDescription& system);

}  // namespace mebots::master::config
