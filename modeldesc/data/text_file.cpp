// SPDX-License-Identifier: Apache-2.0
#include "mebots/text_file.hpp"

#include "mebots/data/find_file.hpp"
#include "mebots/error.hpp"
#include "mebots/file_kind.hpp"
#include "mebots/nearest_names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace mebots {

std::string text_of(const std::filesystem::path& path) {
  const auto refuse = [&](ErrorCode code, std::string_view why) {
    throw Error(code, fmt::format("{}: cannot be read: {}", path.string(), why));
  };
  std::error_code failure;
  const auto status = std::filesystem::status(path, failure);
  if (status.type() == std::filesystem::file_type::not_found) {
    refuse(ErrorCode::file_not_found, "there is no such file");
  }
  if (std::filesystem::is_directory(status)) refuse(ErrorCode::file_unreadable, "it is a folder");
  if (std::filesystem::is_character_file(status) || std::filesystem::is_block_file(status)) {
    refuse(ErrorCode::file_unreadable, "it is a device");
  }
  errno = 0;
  std::ifstream stream(path, std::ios::binary);
  if (!stream) refuse(ErrorCode::file_unreadable, std::generic_category().message(errno));
  std::string text;
  std::vector<char> block(1 << 16);
  while (stream.read(block.data(), static_cast<std::streamsize>(block.size())) || stream.gcount() > 0) {
    text.append(block.data(), static_cast<std::size_t>(stream.gcount()));
  }
  if (stream.bad()) refuse(ErrorCode::file_unreadable, "its storage device reports an error");
  return text;
}

}  // namespace mebots

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
              fmt::format("{} = \"{}\": unknown name. {} The path of a .json file is possible, too", variable, name,
                          suggest(name, known)));
}

}  // namespace mebots::data
