// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace mebots::master {

/// The JSON schema (draft 2020-12) of a config, as configs/mebots-config.schema.json ships it.
std::string_view config_schema();

/// The keys that the reader knows: of a config, and of one of its instances.
std::vector<std::string> config_keys();
std::vector<std::string> instance_keys();

}  // namespace mebots::master
