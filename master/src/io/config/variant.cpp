// SPDX-License-Identifier: Apache-2.0
#include "io/config/load_system.hpp"

#include "mebots/data/object.hpp"

#include <fmt/format.h>

#include <filesystem>

namespace mebots::master::config {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kText = "text";

/// Reads a file name without folders. Rejects other paths, because a config in another folder may contain paths
/// relative to its folder.
std::string name_beside(const data::Node& node) {
  auto name = node.readable_text();
  if (std::filesystem::path(name).has_parent_path()) {
    node.fail(ErrorCode::invalid_value, fmt::format("\"{}\" is a path; name a config in the folder of this one", name));
  }
  return name;
}

/// Stores "changes" as the place of each value in `change`, so that errors about the value refer to the changes. `base`
/// is the value that `change` changes, or null. For an object that the base does not contain, also stores the place of
/// the object itself, because a key may be missing in it.
void mark(const Json& change, const Json* base, const Json::json_pointer& at,
          std::map<std::string, std::string>& places) {
  const bool goes_into = base != nullptr && base->is_object();
  if (!change.is_object() || !goes_into) places[at.to_string()] = kChanges;
  if (!change.is_object()) return;
  for (const auto& [key, value] : change.items()) {
    const bool is_known = goes_into && base->contains(key);
    mark(value, is_known ? &base->at(key) : nullptr, at / key, places);
  }
}

}  // namespace

std::string read_variant(const data::Node& root) {
  data::Object object(root);
  std::string base;
  object.comment("$schema");
  object.comment(kText);
  object.read(kExtends, base, &name_beside);
  object.visit(kChanges, [](const data::Node& changes) { static_cast<void>(changes.members()); });
  object.finish();
  return base;
}

Json merged(Json base, const Json& variant) {
  base.merge_patch(variant.at(kChanges));
  if (const auto text = variant.find(kText); text != variant.end()) base[kText] = *text;
  return base;
}

std::map<std::string, std::string> places_of(const Json& variant, const Json& base) {
  std::map<std::string, std::string> places;
  places[""] = fmt::format("extends {}", variant.at(kExtends).get<std::string>());
  mark(variant.at(kChanges), &base, Json::json_pointer(), places);
  return places;
}

}  // namespace mebots::master::config
