// SPDX-License-Identifier: Apache-2.0
#include "io/config/load_system.hpp"

#include "base/input_text.hpp"
#include "base/sha256.hpp"
#include "io/config/sections.hpp"
#include "mebots/data/document.hpp"
#include "mebots/file_kind.hpp"
#include "mebots/input_error.hpp"

#include <fmt/format.h>

namespace mebots::master {
namespace {

constexpr auto kSsd = "SystemStructure.ssd";
constexpr auto kOsp = "OspSystemStructure.xml";

}  // namespace

SystemFile find_system(const std::filesystem::path& path) {
  if (is_folder(path)) {
    if (is_there(path / kSsd)) return {path / kSsd, SystemForm::ssd};
    if (is_there(path / kOsp)) return {path / kOsp, SystemForm::osp};
    throw InputError(
        ErrorCode::file_not_found,
        fmt::format("{}: this folder contains neither {} nor {}; name a config (.json), an FMU (.fmu), an SSP (.ssp, "
                    ".ssd, or its folder), or an {}",
                    path.string(), kSsd, kOsp, kOsp));
  }
  const auto ending = path.extension();
  if (ending == ".fmu") return {path, SystemForm::fmu};
  if (ending == ".ssp") return {path, SystemForm::ssp};
  if (ending == ".ssd") return {path, SystemForm::ssd};
  if (ending == ".xml") return {path, SystemForm::osp};
  return {path, SystemForm::config};
}

bool may_be_system(const std::filesystem::path& path) {
  const auto ending = path.extension();
  return is_folder(path) || ending == ".json" || ending == ".ssp" || ending == ".ssd" || ending == ".xml";
}

std::string system_name(const std::filesystem::path& path) {
  const auto whole = std::filesystem::absolute(path).lexically_normal();
  const bool folder = !whole.has_filename() || is_folder(whole);
  if (folder) return (whole.has_filename() ? whole : whole.parent_path()).filename().string();
  if (whole.filename() == kSsd || whole.filename() == kOsp) return whole.parent_path().filename().string();
  return whole.stem().string();
}

std::string apply_scenario(SystemDescription& system, const std::filesystem::path& file) {
  const auto text = input_text(file);
  auto changed = system;  // so that a mistake leaves `system` unchanged
  refused_as_input([&] {
    data::Document(text, file.string()).read([&](const data::Node& root) {
      config::read_scenario_file(root, changed, std::filesystem::absolute(file).parent_path());
    });
  });
  system = std::move(changed);
  return fmt::format("scenario {} {}", file.filename().string(), sha256(text));
}

}  // namespace mebots::master
