// SPDX-License-Identifier: Apache-2.0
#include "tool/state_file.hpp"

#include "devices/core/kind_library.hpp"

#include "mebots/error.hpp"
#include "mebots/state/layout.hpp"
#include "mebots/state/save.hpp"
#include "mebots/text_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <libdeflate.h>

#include <cstddef>
#include <filesystem>
#include <optional>
#include <set>
#include <span>
#include <system_error>

namespace mebots::soc::tool {
namespace {

constexpr std::string_view kFormat = "mebots-soc state 2";
constexpr auto kNone = "none";

std::string checksum_of(std::string_view bytes) {
  return fmt::format("{:08x}", libdeflate_crc32(0, bytes.data(), bytes.size()));
}

std::string checksum_of_file(const std::optional<std::string>& path) {
  return path ? checksum_of(text_of(*path)) : kNone;
}

/// Returns a checksum of the names and contents of a folder's files.
std::string checksum_of_folder(const std::optional<std::string>& folder) {
  if (!folder) return kNone;
  std::set<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(*folder)) {
    if (entry.is_regular_file()) files.insert(entry.path());
  }
  std::string all;
  for (const auto& file : files) all += fmt::format("{} {}\n", file.filename().string(), checksum_of(text_of(file)));
  return checksum_of(all);
}

std::string checksum_of_libraries(const Options& options, const BoardDescription& board) {
  const std::vector<std::filesystem::path> folders(options.device_folders.begin(), options.device_folders.end());
  std::string all;
  for (const auto& name : board.libraries) {
    all += fmt::format("{} {}\n", name, checksum_of(text_of(kind_library_file(board, name, folders))));
  }
  return checksum_of(all);
}

std::string_view take_line(std::string_view& text) {
  const auto end = text.find('\n');
  const auto line = text.substr(0, end);
  text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  return line;
}

}  // namespace

StateFile::StateFile(const Options& options, const Soc& soc) {
  const auto board = options.board ? std::optional(board_file(*options.board).string()) : std::nullopt;
  lines_ = {{"program", checksum_of_file(options.program)},
            {"--board", checksum_of_file(board)},
            {"--devices", checksum_of_libraries(options, soc.board())},
            {"--core", options.core.value_or(kNone)},
            {"--ram", fmt::format("{}", fmt::join(options.ram, " "))},
            {"--flash", checksum_of_file(options.flash)},
            {"--pictures", checksum_of_folder(options.pictures)},
            {"mebots-soc", checksum_of_file("/proc/self/exe")},
            {"layout", fmt::format("{:016x}", state::layout_of(soc))}};
}

void StateFile::load(const std::string& path, Soc& soc) const {
  const auto bytes = text_of(path);
  std::string_view rest = bytes;
  if (take_line(rest) != kFormat) {
    throw Error(fmt::format(
        "--load-state {}: this file does not begin with \"{}\"; give a file that --save-state wrote", path, kFormat));
  }
  for (const auto& [name, value] : lines_) {
    if (take_line(rest) == fmt::format("{} {}", name, value)) continue;
    throw Error(
        fmt::format("--load-state {}: the state was saved with another {}; give the same program, board and "
                    "inputs to the same build of mebots-soc, or save the state again",
                    path, name));
  }
  if (const auto checksum = take_line(rest); checksum != checksum_of(rest)) {
    throw Error(ErrorCode::state_damaged,
                fmt::format("--load-state {}: the file is damaged; save the state again", path));
  }
  try {
    state::restore(soc, std::as_bytes(std::span(rest)));
  } catch (const Error& error) {
    throw Error(error.code(), fmt::format("--load-state {}: {}", path, error.what()));
  }
}

void StateFile::save(observe::TextFile& file, const Soc& soc) const {
  if (!soc.running()) {
    file.close();
    std::error_code ignored;
    if (std::filesystem::is_regular_file(file.path(), ignored)) std::filesystem::remove(file.path(), ignored);
    const auto* reason = soc.end() == End::stopped
                             ? "the run was stopped at one core, in gdb or within a step of the cluster; end it with "
                               "--max-time"
                             : "the program has ended; end the run before, for example with --max-time";
    throw Error(fmt::format("--save-state {}: no state is saved, because {}", file.path(), reason));
  }
  file.print("{}\n", kFormat);
  for (const auto& [name, value] : lines_) file.print("{} {}\n", name, value);
  const auto state = state::save(soc);
  const std::string_view bytes(reinterpret_cast<const char*>(state.data()), state.size());
  file.print("{}\n", checksum_of(bytes));
  file.put(bytes);
  file.close();
}

}  // namespace mebots::soc::tool
