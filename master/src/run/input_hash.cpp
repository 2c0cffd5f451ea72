// SPDX-License-Identifier: Apache-2.0
#include "run/input_hash.hpp"

#include "base/sha256.hpp"
#include "mebots/file_kind.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>

namespace mebots::master {
namespace {

/// Returns all files below a folder in sorted order.
std::vector<std::filesystem::path> files_of(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (is_file(entry.path())) files.push_back(entry.path());
  }
  std::ranges::sort(files);
  return files;
}

/// True if a String parameter names a folder that `mebots deploy` wrote. Other values may equal the name of a folder by
/// chance.
bool names_network(const std::string& variable, const std::string& text) {
  return variable == "network" && is_file(std::filesystem::path(text) / "network.json");
}

/// Returns the files that String parameters name. Relative paths start at the working folder, as in an FMU.
std::map<std::string, std::filesystem::path> named_files(const SystemDescription& system) {
  std::map<std::string, std::filesystem::path> files;
  for (const auto& instance : system.instances) {
    std::map<std::string, const std::string*> texts;  // last value of each parameter
    for (const auto& assignment : instance.parameters) {
      const auto* text = std::get_if<std::string>(&assignment.value);
      if (const auto* typed = std::get_if<UntypedText>(&assignment.value)) text = &typed->text;
      texts[assignment.variable] = text;
    }
    for (const auto& [variable, text] : texts) {
      if (text == nullptr) continue;
      const auto name = instance.name + "." + variable;
      if (is_file(*text)) files[name] = *text;
      if (!names_network(variable, *text)) continue;
      for (const auto& file : files_of(*text)) files[name + " " + file.lexically_relative(*text).string()] = file;
    }
  }
  return files;
}

}  // namespace

InputHash hash_inputs(const SystemDescription& system, std::span<const std::string> overrides) {
  InputHash hash;
  hash.config = sha256(system.source);
  std::map<std::filesystem::path, std::string> known;  // caches hashes, because instances may share an FMU
  auto lines = fmt::format("config {}\n", hash.config);
  for (const auto& instance : system.instances) {
    auto& digest = known[instance.fmu_path];
    if (digest.empty()) digest = sha256_of_file(instance.fmu_path);
    hash.fmus.emplace_back(instance.name, digest);
    lines += fmt::format("fmu {} {}\n", instance.name, digest);
  }
  for (const auto& [name, file] : named_files(system)) {
    hash.files.emplace_back(name, sha256_of_file(file));
    lines += fmt::format("file {} {}\n", name, hash.files.back().second);
  }
  const auto add_signals = [&](const std::string& name, const SignalFileDescription& file) {
    hash.files.emplace_back(name, sha256_of_file(file.path));
    lines += fmt::format("file {} {}\n", name, hash.files.back().second);
  };
  for (std::size_t i = 0; i < system.inputs.size(); ++i) {
    add_signals(fmt::format("inputs/{} {}", i, system.inputs[i].file.name), system.inputs[i].file);
  }
  for (std::size_t i = 0; i < system.scenario.size(); ++i) {
    const auto& file = system.scenario[i].file;
    if (file) add_signals(fmt::format("scenario/{} {}", i, file->name), *file);
  }
  for (const auto& change : overrides) lines += fmt::format("change {}\n", change);
  hash.all = sha256(lines);
  hash.lines = std::move(lines);
  return hash;
}

}  // namespace mebots::master
