// SPDX-License-Identifier: Apache-2.0
#include "files.hpp"

#include "mebots/file_kind.hpp"
#include "mebots/input_error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <fstream>
#include <iterator>

namespace mebots::master::ssp {

bool FolderFiles::holds(const std::filesystem::path& path) const {
  return is_file(folder_ / path);
}

std::string FolderFiles::read(const std::filesystem::path& path) const {
  std::ifstream stream(folder_ / path, std::ios::binary);
  if (!stream) throw InputError(ErrorCode::file_not_found, fmt::format("{}: the file is missing", path.string()));
  std::string bytes{std::istreambuf_iterator<char>(stream), {}};
  bytes_read_ += bytes;
  return bytes;
}

namespace {

std::string percent_decoded(std::string_view uri) {
  std::string text;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    unsigned value = 0;
    if (uri[i] == '%' && i + 2 < uri.size()) {
      const auto* digits = uri.data() + i + 1;
      if (std::from_chars(digits, digits + 2, value, 16).ptr == digits + 2) {
        text += static_cast<char>(value);
        i += 2;
        continue;
      }
    }
    text += uri[i];
  }
  return text;
}

std::optional<std::string_view> query_value(std::string_view uri, std::string_view key) {
  const auto query = uri.find('?');
  if (query == std::string_view::npos) return std::nullopt;
  uri.remove_prefix(query + 1);
  while (!uri.empty()) {
    const auto pair = uri.substr(0, uri.find('&'));
    if (pair.starts_with(key) && pair.size() > key.size() && pair[key.size()] == '=') {
      return pair.substr(key.size() + 1);
    }
    uri.remove_prefix(std::min(uri.size(), pair.size() + 1));
  }
  return std::nullopt;
}

}  // namespace

std::optional<FileUri> parse_file_uri(std::string_view uri) {
  constexpr std::string_view kFile = "file://";
  FileUri result;
  for (const std::string_view proxy : {"proxyfmu://", "fmu-proxy://"}) {
    if (!uri.starts_with(proxy)) continue;
    const auto file = query_value(uri, "file");
    if (!file) return std::nullopt;
    result.by_proxy = uri.substr(proxy.size(), uri.find_first_of("/?", proxy.size()) - proxy.size());
    uri = *file;
  }
  if (uri.starts_with(kFile)) {
    uri.remove_prefix(kFile.size());
  } else if (uri.find("://") != std::string_view::npos) {
    return std::nullopt;
  }
  auto path = percent_decoded(uri);
  result.has_backslashes = path.find('\\') != std::string::npos;
  std::ranges::replace(path, '\\', '/');
  result.path = path;
  return result;
}

}  // namespace mebots::master::ssp
