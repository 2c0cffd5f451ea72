// SPDX-License-Identifier: Apache-2.0
#include "new_folder.hpp"

#include "base/installation.hpp"
#include "mebots/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <fstream>
#include <iterator>
#include <string_view>

namespace mebots::new_folder {
namespace {

namespace fs = std::filesystem;

std::string replaced(std::string text, const Words& words) {
  for (const auto& [word, meaning] : words) {
    for (auto at = text.find(word); at != std::string::npos; at = text.find(word, at + meaning.size())) {
      text.replace(at, word.size(), meaning);
    }
  }
  return text;
}

}  // namespace

std::string read_text(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  if (!stream) throw Error(ErrorCode::file_unreadable, fmt::format("{}: the file cannot be read", file.string()));
  return text;
}

Files read_template(const std::string& name, const Words& words) {
  const auto root = master::own_data("templates") / name;
  Files files;
  for (const auto& entry : fs::recursive_directory_iterator(root)) {
    if (!entry.is_regular_file()) continue;
    const auto inside = entry.path().lexically_relative(root);
    files.emplace_back(replaced(inside.string(), words), replaced(read_text(entry.path()), words));
  }
  std::ranges::sort(files);
  return files;
}

void require_name(const std::string& name) {
  constexpr std::array<std::string_view, 12> kTaken = {"auto", "board", "char", "double", "float", "fly",
                                                       "int",  "long",  "main", "run",    "short", "void"};
  const auto usable = [](char c) { return std::islower(static_cast<unsigned char>(c)) || std::isdigit(c) || c == '_'; };
  if (name.empty() || !std::islower(static_cast<unsigned char>(name.front())) || !std::ranges::all_of(name, usable)) {
    throw Error(
        ErrorCode::invalid_value,
        fmt::format("'{}' cannot name C functions and a build's targets; use lower-case letters, digits and _", name));
  }
  if (std::ranges::find(kTaken, name) != kTaken.end()) {
    throw Error(ErrorCode::duplicate_name, fmt::format("'{}' already has another meaning; choose another name", name));
  }
}

void write_folder(const fs::path& folder, const Files& files) {
  std::error_code error;
  if (fs::exists(folder, error)) {
    throw Error(
        ErrorCode::file_unwritable,
        fmt::format("{}: this folder exists and is not overwritten; choose another one with --out", folder.string()));
  }
  for (const auto& [name, text] : files) {
    const auto file = folder / name;
    fs::create_directories(file.parent_path(), error);
    std::ofstream stream(file, std::ios::binary);
    stream << text;
    stream.close();
    if (!stream) {
      throw Error(ErrorCode::file_unwritable,
                  fmt::format("{}: cannot be written; check permissions and free space", file.string()));
    }
  }
}

}  // namespace mebots::new_folder
