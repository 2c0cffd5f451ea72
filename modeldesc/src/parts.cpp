// SPDX-License-Identifier: Apache-2.0
#include "pack_fmu.hpp"

#include "mebots/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>

namespace mebots::modeldesc {
namespace {

constexpr std::array kRelations = {"linked", "bundled", "needed"};

std::vector<std::string> fields_of(const std::string& line) {
  std::vector<std::string> fields;
  std::size_t at = 0;
  for (auto end = line.find('|'); end != std::string::npos; end = line.find('|', at)) {
    fields.push_back(line.substr(at, end - at));
    at = end + 1;
  }
  fields.push_back(line.substr(at));
  return fields;
}

}  // namespace

std::vector<Part> read_parts(const std::filesystem::path& file) {
  std::ifstream stream(file);
  if (!stream) throw Error(ErrorCode::file_not_found, fmt::format("{}: this file cannot be read", file.string()));
  std::vector<Part> parts;
  int number = 0;
  for (std::string line; std::getline(stream, line);) {
    ++number;
    const auto fields = fields_of(line);
    constexpr std::size_t kFields = 6;
    if (fields.size() != kFields || std::ranges::find(kRelations, fields[0]) == kRelations.end() || fields[1].empty())
      throw Error(
          ErrorCode::syntax_error,
          fmt::format("{}:{}: a part has six fields, separated by '|': relation (linked, bundled or needed), name, "
                      "version, licence, package URL, licence text: {}",
                      file.string(), number, line));
    parts.push_back({fields[0], fields[1], fields[2], fields[3], fields[4], fields[5]});
  }
  return parts;
}

}  // namespace mebots::modeldesc
