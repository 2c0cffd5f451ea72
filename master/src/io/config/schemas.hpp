// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::master {

/// The JSON schema (draft 2020-12) of a kind of file, as configs/schemas/mebots-<kind>.schema.json ships it.
struct Schema {
  std::string_view kind;  // "config"
  std::string_view text;
};

/// One for each kind of file, in the order of the alphabet. Lives as long as the program.
std::span<const Schema> schemas();

/// The keys that the reader of configs knows: of a config, and of one of its instances.
std::vector<std::string> config_keys();
std::vector<std::string> instance_keys();

}  // namespace mebots::master
