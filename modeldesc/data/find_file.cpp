// SPDX-License-Identifier: Apache-2.0
#include "mebots/data/find_file.hpp"

#include "mebots/error.hpp"
#include "mebots/file_kind.hpp"
#include "mebots/nearest_names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

namespace mebots::data {

std::filesystem::path find_file(const std::filesystem::path& folder, std::string_view name, std::string_view variable) {
  const bool is_path = name.find('/') != std::string_view::npos || name.ends_with(".json");
  auto path = is_path ? std::filesystem::path(name) : folder / fmt::format("{}.json", name);
  if (!name.empty() && is_file(path)) return path;
  if (is_path) {
    throw Error(ErrorCode::file_not_found, fmt::format("{} = \"{}\": there is no such file", variable, name));
  }
  std::vector<std::string> known;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) {
    if (entry.path().extension() == ".json") known.push_back(entry.path().stem().string());
  }
  std::ranges::sort(known);
  throw Error(ErrorCode::unknown_name,
              fmt::format("{} = \"{}\": unknown name. {} The path of a .json file will do, too", variable, name,
                          suggest(name, known)));
}

}  // namespace mebots::data
