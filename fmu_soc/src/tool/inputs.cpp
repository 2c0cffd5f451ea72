// SPDX-License-Identifier: Apache-2.0
#include "tool/run.hpp"

#include "mebots/error.hpp"
#include "mebots/png_file.hpp"

#include <fmt/core.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

namespace mebots::soc::tool {

namespace {

constexpr std::uint64_t kPage = 4096;
constexpr std::uint64_t kMiB = 1U << 20;
/// Address ranges that are farther apart get separate memories, such as flash and RAM of a chip.
constexpr std::uint64_t kFar = 64 * kMiB;
constexpr std::uint64_t kMost = 2048 * kMiB;
constexpr std::uint64_t kAddressSpace = std::uint64_t{1} << 32;
constexpr auto kNoBoard = "none";

struct Range {
  std::uint64_t begin = 0;
  std::uint64_t end = 0;
};

/// Returns the load addresses and the run addresses of the program's segments.
std::vector<Range> ranges_of(const Elf& program) {
  std::vector<Range> ranges;
  for (const auto& segment : program.segments()) {
    const std::uint64_t load = segment.load_address;
    const std::uint64_t run = segment.run_address;
    if (!segment.bytes.empty()) ranges.push_back({load, load + segment.bytes.size()});
    ranges.push_back({run, run + segment.size});
  }
  std::ranges::sort(ranges, {}, &Range::begin);
  return ranges;
}

std::vector<Range> merged(const std::vector<Range>& ranges) {
  std::vector<Range> groups;
  for (const auto& range : ranges) {
    if (groups.empty() || range.begin > groups.back().end + kFar) {
      groups.push_back(range);
    } else {
      groups.back().end = std::max(groups.back().end, range.end);
    }
  }
  return groups;
}

/// Rounds a range to pages, and adds space for heap and stack.
Range with_margin(const Range& range, std::uint64_t heap) {
  const auto begin = range.begin / kPage * kPage;
  const auto end = std::max(begin + 4 * kMiB, (range.end + heap + kPage - 1) / kPage * kPage);
  return {begin, std::min(end, kAddressSpace)};
}

}  // namespace

BoardDescription board_around(const Elf& program, std::uint64_t heap) {
  BoardDescription board;
  board.name = kNoBoard;
  std::uint64_t total = 0;
  const auto groups = merged(ranges_of(program));
  for (const auto& group : groups) {
    const auto range = with_margin(group, &group == &groups.back() ? heap : kMiB);
    BoardMemory ram;
    ram.name = fmt::format("ram{}", board.memories.empty() ? "" : std::to_string(board.memories.size() + 1));
    ram.base = static_cast<std::uint32_t>(range.begin);
    ram.size = static_cast<std::uint32_t>(std::min(range.end - range.begin, kMost));
    ram.leaks = false;  // the memory is not part of a real chip
    board.memories.push_back(ram);
    total += range.end - range.begin;
  }
  if (total > kMost) {
    throw Error(fmt::format("{}: its segments take {} MiB, more than {}: name a board", program.origin(), total / kMiB,
                            kMost / kMiB));
  }
  return board;
}

namespace {

[[noreturn]] void refuse_ram(const std::string& text, std::string_view why) {
  throw Error(fmt::format("--ram {}: {}; give an address and a size, such as 0x80000000:64M", text, why));
}

/// Parses a decimal or hexadecimal number with an optional suffix K, M or G. Returns nullopt for any other text.
std::optional<std::uint64_t> read_size(std::string_view text) {
  std::uint64_t unit = 1;
  constexpr std::string_view kSuffixes = "KMG";
  if (const auto suffix = text.empty() ? kSuffixes.npos : kSuffixes.find(text.back()); suffix != kSuffixes.npos) {
    unit = std::uint64_t{1} << 10 * (suffix + 1);
    text.remove_suffix(1);
  }
  const bool is_hexadecimal = text.starts_with("0x");
  if (is_hexadecimal) text.remove_prefix(2);
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, is_hexadecimal ? 16 : 10);
  if (error != std::errc() || end != text.data() + text.size() || value > kAddressSpace / unit) return std::nullopt;
  return value * unit;
}

}  // namespace

void add_ram(BoardDescription& board, const std::string& text) {
  const auto colon = text.find(':');
  const auto base = read_size(std::string_view(text).substr(0, colon));
  const auto size = colon == std::string::npos ? std::nullopt : read_size(std::string_view(text).substr(colon + 1));
  if (!base || !size) refuse_ram(text, "this is not a range of memory");
  if (*size == 0 || *size % 4 != 0 || *base % 4 != 0) refuse_ram(text, "address and size must be multiples of 4");
  if (*base + *size > kAddressSpace) refuse_ram(text, "this passes the end of the 32-bit address space");
  if (*size > kMost) refuse_ram(text, fmt::format("a memory has at most {} MiB", kMost / kMiB));
  for (const auto& device : board.devices) {
    if (device.is_on_bus() && *base < device.base + std::uint64_t{device.size()} && device.base < *base + *size) {
      refuse_ram(text, fmt::format("device {} of the board is at 0x{:08x}", device.name, device.base));
    }
  }
  const auto same = std::ranges::find(board.memories, static_cast<std::uint32_t>(*base), &BoardMemory::base);
  if (same != board.memories.end()) {
    same->size = static_cast<std::uint32_t>(*size);
    return;
  }
  BoardMemory ram;
  ram.name = fmt::format("ram_0x{:08x}", *base);
  ram.base = static_cast<std::uint32_t>(*base);
  ram.size = static_cast<std::uint32_t>(*size);
  ram.leaks = false;  // the memory is not part of a real chip
  board.memories.push_back(ram);
}

Picoseconds time_of(std::string_view option, const std::string& text) {
  double value = 0;
  const auto* last = text.data() + text.size();
  const auto [end, error] = std::from_chars(text.data(), last, value);
  const std::string_view unit(end, static_cast<std::size_t>(last - end));
  constexpr auto kUnits = std::to_array<std::pair<std::string_view, double>>(
      {{"", 1e12}, {"s", 1e12}, {"ms", 1e9}, {"us", 1e6}, {"ns", 1e3}});
  const auto* const found = std::ranges::find(kUnits, unit, &std::pair<std::string_view, double>::first);
  const auto time_ps = found == kUnits.end() ? 0 : value * found->second;
  if (error != std::errc() || !(time_ps >= 1) || time_ps > kLongestNs * 1e3) {
    throw Error(fmt::format("{} {}: this is not a time; give seconds, or a number with s, ms, us or ns, such as 2.5ms",
                            option, text));
  }
  return std::llround(time_ps);
}

std::vector<std::filesystem::path> own_folders(std::string_view name) {
  std::error_code error;
  const auto root = std::filesystem::read_symlink("/proc/self/exe", error).parent_path().parent_path();
  return {root / "share/mebots" / name, root / name};
}

std::vector<std::filesystem::path> own_boards() {
  std::error_code error;
  std::vector<std::filesystem::path> boards;
  for (const auto& folder : own_folders("configs/boards")) {
    for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
      if (entry.path().extension() == ".json") boards.push_back(entry.path());
    }
  }
  std::ranges::sort(boards);
  return boards;
}

std::filesystem::path board_file(const std::string& asked) {
  std::error_code error;
  if (std::filesystem::exists(asked, error) || asked.find_first_of("/.") != std::string::npos) return asked;
  std::vector<std::string> known;
  for (const auto& path : own_boards()) {
    known.push_back(path.stem().string());
    if (known.back() == asked) return path;
  }
  std::ranges::sort(known);
  // clang 14, which builds the fuzzers, does not accept std::ranges::unique() of libstdc++.
  known.erase(std::unique(known.begin(), known.end()), known.end());
  throw Error(
      fmt::format("--board {}: there is no such board or file. MEbots has the boards {}; name a board file of "
                  "your own by its path",
                  asked, fmt::join(known, ", ")));
}

namespace {

/// Maximum number of pixels of a picture. No camera has more pixels.
constexpr std::uint32_t kMostPixels = 1U << 24;

[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& why) {
  throw Error(fmt::format("--pictures: {}: {}", path.string(), why));
}

/// Reads the next number of a PGM header. Skips white space and comments.
std::uint32_t number_of_head(std::istream& file) {
  file >> std::ws;
  while (file.peek() == '#') {
    std::string comment;
    std::getline(file, comment);
    file >> std::ws;
  }
  std::uint32_t number = 0;
  file >> number;
  return number;
}

/// Reads a file of Netpbm's binary 8-bit greymap format.
GreyPicture read_pgm(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::string magic(2, '\0');
  file.read(magic.data(), 2);
  if (!file || magic != "P5") refuse(path, "this is not a binary PGM: it does not begin with P5");
  const auto width = number_of_head(file);
  const auto height = number_of_head(file);
  const auto most = number_of_head(file);
  if (!file || most != 255) refuse(path, "the header of a PGM with 255 grey levels is \"P5 WIDTH HEIGHT 255\"");
  if (std::uint64_t{width} * height > kMostPixels) {
    refuse(path, fmt::format("{} x {} pixels are too many", width, height));
  }
  file.get();
  GreyPicture picture{static_cast<int>(width), static_cast<int>(height),
                      std::vector<std::uint8_t>(std::size_t{width} * height)};
  file.read(reinterpret_cast<char*>(picture.grey.data()), static_cast<std::streamsize>(picture.grey.size()));
  if (!file) refuse(path, fmt::format("the file ends too early: it must have {} pixels", picture.grey.size()));
  return picture;
}

}  // namespace

std::vector<std::vector<std::uint8_t>> read_pictures(const std::filesystem::path& folder, std::uint32_t width,
                                                     std::uint32_t least_height) {
  std::error_code error;
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    const auto extension = entry.path().extension();
    if (extension == ".png" || extension == ".pgm") paths.push_back(entry.path());
  }
  if (error) refuse(folder, "this is not a readable folder");
  if (paths.empty()) refuse(folder, "there is no .png or .pgm file in this folder");
  std::ranges::sort(paths);
  std::vector<std::vector<std::uint8_t>> pictures;
  for (const auto& path : paths) {
    auto picture = path.extension() == ".png" ? read_png(path) : read_pgm(path);
    if (std::cmp_not_equal(picture.width, width) || std::cmp_less(picture.height, least_height)) {
      refuse(path, fmt::format("it has {} x {} pixels; the camera needs {} columns and at least {} rows", picture.width,
                               picture.height, width, least_height));
    }
    pictures.push_back(std::move(picture.grey));
  }
  return pictures;
}

}  // namespace mebots::soc::tool
