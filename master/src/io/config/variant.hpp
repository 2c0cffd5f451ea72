// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/data/node.hpp"

#include <nlohmann/json.hpp>

#include <map>
#include <string>

/// A config that is another one with changes: `{"extends": "gate_hard.json", "changes": {...}}`. The changes are laid
/// over the other file as RFC 7396 (JSON merge patch) says: objects member by member, all else whole, null removes.
namespace mebots::master::config {

inline constexpr const char* kExtends = "extends";
inline constexpr const char* kChanges = "changes";

/// The name of the file that it extends, which lies beside it. Notes what is wrong with its own keys.
std::string read_variant(const data::Node& root);

/// Both in one; a `text` of its own takes the place of the other's.
nlohmann::ordered_json laid_over(nlohmann::ordered_json base, const nlohmann::ordered_json& variant);

/// Where each part of the whole was written, as data::Document wants it. `base`: the extended file's content.
std::map<std::string, std::string> places_of(const nlohmann::ordered_json& variant, const nlohmann::ordered_json& base);

}  // namespace mebots::master::config
