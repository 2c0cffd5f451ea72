// SPDX-License-Identifier: Apache-2.0
// Source: Microsoft, "PE Format" (https://learn.microsoft.com/windows/win32/debug/pe-format).
#include "mebots/modeldesc/pe_library.hpp"

#include "mebots/error.hpp"
#include "mebots/text_file.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <cstring>
#include <string_view>
#include <utility>

namespace mebots::modeldesc {
namespace {

/// A section of the file. The `size` bytes from `offset` on are loaded at `address`.
struct Section {
  std::uint32_t address;
  std::uint32_t size;
  std::uint32_t offset;
};

/// Indices of data directories in the optional header.
enum class Directory : std::uint32_t { exports = 0, imports = 1, delayed_imports = 13 };

class PeFile {
 public:
  PeFile(std::string_view bytes, std::string name) : bytes_(bytes), name_(std::move(name)) {
    constexpr std::size_t kPlaceOfHeader = 0x3c;
    if (!bytes_.starts_with("MZ")) fail("is not a Windows DLL");
    header_ = get<std::uint32_t>(kPlaceOfHeader);
    if (get<std::uint32_t>(header_) != kSignature) fail("is not a Windows DLL");
    const auto sections = get<std::uint16_t>(header_ + 6);
    const auto optional_size = get<std::uint16_t>(header_ + 20);
    constexpr std::uint16_t kIsDll = 0x2000;
    if ((get<std::uint16_t>(header_ + 22) & kIsDll) == 0) fail("is a Windows program, not a DLL");
    is_64_bit_ = get<std::uint16_t>(header_ + kOptionalHeader) == kPe32Plus;
    const auto table = header_ + kOptionalHeader + optional_size;
    constexpr std::uint64_t kSectionBytes = 40;
    for (std::uint64_t i = 0; i < sections; ++i) {
      const auto at = table + i * kSectionBytes;
      sections_.push_back({get<std::uint32_t>(at + 12), get<std::uint32_t>(at + 16), get<std::uint32_t>(at + 20)});
    }
  }

  PeLibrary read() const {
    PeLibrary library;
    constexpr std::uint64_t kImportBytes = 20;
    constexpr std::uint64_t kDelayedBytes = 32;
    add_names(Directory::imports, kImportBytes, 12, library.needed);
    add_names(Directory::delayed_imports, kDelayedBytes, 4, library.needed);
    add_exports(library.exports);
    return library;
  }

 private:
  static constexpr std::uint32_t kSignature = 0x4550;  // the characters "PE" and two zeros
  static constexpr std::uint16_t kPe32Plus = 0x20b;
  static constexpr std::uint64_t kOptionalHeader = 24;

  [[noreturn]] void fail(std::string_view what) const {
    throw Error(ErrorCode::fmu_inconsistent, fmt::format("{}: {}", name_, what));
  }

  template <typename T>
  T get(std::uint64_t offset) const {
    T value;
    if (offset > bytes_.size() || bytes_.size() - offset < sizeof value) fail("is cut short");
    std::memcpy(&value, bytes_.data() + offset, sizeof value);
    return value;
  }

  /// Converts the address of a loaded byte to its offset in the file.
  std::uint64_t offset_of(std::uint32_t address) const {
    for (const auto& section : sections_) {
      if (address >= section.address && address - section.address < section.size)
        return std::uint64_t{section.offset} + (address - section.address);
    }
    fail("has a table outside of its sections");
  }

  std::string text_at(std::uint32_t address) const {
    const auto offset = offset_of(address);
    constexpr std::size_t kLongestName = 4096;
    const auto text = offset < bytes_.size() ? bytes_.substr(offset, kLongestName) : std::string_view();
    const auto end = text.find('\0');
    if (end == std::string_view::npos) fail("has a name without end");
    return std::string(text.substr(0, end));
  }

  /// Returns the address of a data directory; 0 if the file lacks the directory.
  std::uint32_t directory(Directory which) const {
    const auto counts = header_ + kOptionalHeader + (is_64_bit_ ? 108 : 92);
    const auto index = static_cast<std::uint32_t>(which);
    return index < get<std::uint32_t>(counts) ? get<std::uint32_t>(counts + 4 + std::uint64_t{8} * index) : 0;
  }

  /// Appends the names in a table of DLLs to `names`. Each row has `row_bytes` bytes. A row contains the address of a
  /// name at `name_offset`. The table ends with a row without a name.
  void add_names(Directory which, std::uint64_t row_bytes, std::uint64_t name_offset,
                 std::vector<std::string>& names) const {
    const auto address = directory(which);
    if (address == 0) return;
    for (auto row = offset_of(address);; row += row_bytes) {
      const auto name = get<std::uint32_t>(row + name_offset);
      if (name == 0) return;
      names.push_back(text_at(name));
    }
  }

  void add_exports(std::vector<std::string>& names) const {
    const auto address = directory(Directory::exports);
    if (address == 0) return;
    const auto table = offset_of(address);
    const auto count = get<std::uint32_t>(table + 24);
    if (count == 0) return;
    const auto list = offset_of(get<std::uint32_t>(table + 32));
    std::size_t characters = 0;
    for (std::uint64_t i = 0; i < count; ++i) {
      names.push_back(text_at(get<std::uint32_t>(list + 4 * i)));
      characters += names.back().size();
      if (characters > bytes_.size()) fail("its table of exports is damaged: its names overlap");
    }
  }

  std::string_view bytes_;
  std::string name_;
  std::uint64_t header_ = 0;
  bool is_64_bit_ = true;
  std::vector<Section> sections_;
};

}  // namespace

PeLibrary read_pe_library(const std::filesystem::path& file) {
  const auto bytes = text_of(file);
  return PeFile(bytes, file.string()).read();
}

}  // namespace mebots::modeldesc
