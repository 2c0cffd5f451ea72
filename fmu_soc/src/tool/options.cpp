// SPDX-License-Identifier: Apache-2.0
#include "tool/options.hpp"

#include "mebots/error.hpp"

#include <fmt/core.h>

#include <filesystem>
#include <string_view>
#include <system_error>
#include <vector>

namespace mebots::soc::tool {
namespace {

struct NamedFile {
  std::string_view option;
  std::string path;
};

bool same_file(const std::string& a, const std::string& b) {
  std::error_code ignored;
  if (std::filesystem::is_character_file(a, ignored)) return false;  // /dev/stdout may take everything
  return std::filesystem::equivalent(a, b, ignored) || std::filesystem::path(a).lexically_normal() == b;
}

}  // namespace

void check(const Options& options) {
  std::vector<NamedFile> inputs{{"the program", options.program}};
  if (options.board) inputs.push_back({"--board", *options.board});
  if (options.flash) inputs.push_back({"--flash", *options.flash});
  std::vector<NamedFile> outputs;
  const auto add = [&](std::string_view option, const std::optional<std::string>& path) {
    if (path) outputs.push_back({option, *path});
  };
  add("--signature", options.signature);
  add("--trace", options.trace);
  add("--profile", options.profile);
  add("--power-trace", options.power_trace);
  for (const auto* list : {&inputs, &outputs}) {
    for (const auto& file : *list) {
      if (file.path.empty()) throw Error(fmt::format("{} has an empty file name; give a path", file.option));
    }
  }
  for (const auto& folder : options.device_folders) {
    std::error_code ignored;
    if (!std::filesystem::is_directory(folder, ignored)) {
      throw Error(fmt::format("--devices {}: this is not a folder", folder));
    }
  }
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    for (const auto& input : inputs) {
      if (same_file(outputs[i].path, input.path)) {
        throw Error(fmt::format("{} {} is also {}; name another file to write", outputs[i].option, outputs[i].path,
                                input.option));
      }
    }
    for (std::size_t k = 0; k < i; ++k) {
      if (same_file(outputs[i].path, outputs[k].path)) {
        throw Error(fmt::format("{} and {} both name {}; give each a file of its own", outputs[k].option,
                                outputs[i].option, outputs[i].path));
      }
    }
  }
  if (options.trace_cycles && !options.trace) {
    throw Error("--trace-cycles adds a column to --trace FILE, which is not asked for");
  }
}

}  // namespace mebots::soc::tool
