// SPDX-License-Identifier: Apache-2.0
#include "mebots/modeldesc/elf_library.hpp"

#include "mebots/error.hpp"

#include <elf.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string_view>

namespace mebots::modeldesc {
namespace {

/// Bounds-checked reading of the structures in <elf.h>.
class ElfFile {
 public:
  explicit ElfFile(const std::filesystem::path& file) : name_(file.string()) {
    std::ifstream stream(file, std::ios::binary);
    if (!stream) throw Error(ErrorCode::file_unreadable, fmt::format("{}: cannot be opened", name_));
    bytes_.assign(std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>());
    if (!std::string_view(bytes_).starts_with(ELFMAG)) fail("is not an ELF file");
    header_ = at<Elf64_Ehdr>(0);
    if (header_.e_ident[EI_CLASS] != ELFCLASS64 || header_.e_ident[EI_DATA] != ELFDATA2LSB)
      fail("is no 64-bit little-endian ELF file");
    if (header_.e_type != ET_DYN) fail("is not a shared library");
  }

  ElfLibrary read() const {
    ElfLibrary library;
    library.machine = header_.e_machine;
    bool dynamic = false;
    for (std::size_t i = 0; i < header_.e_shnum; ++i) {
      const auto section = section_header(i);
      if (section.sh_type == SHT_DYNSYM) read_symbols(section, library);
      if (section.sh_type != SHT_DYNAMIC || dynamic) continue;
      dynamic = true;
      read_dynamic(section, library);
    }
    if (!dynamic) fail("has no dynamic section");
    return library;
  }

 private:
  [[noreturn]] void fail(std::string_view what) const {
    throw Error(ErrorCode::fmu_inconsistent, fmt::format("{}: {}", name_, what));
  }

  void read_dynamic(const Elf64_Shdr& section, ElfLibrary& library) const {
    const Elf64_Shdr strings = section_header(section.sh_link);
    for (std::uint64_t offset = 0; offset < section.sh_size; offset += sizeof(Elf64_Dyn)) {
      const auto entry = at<Elf64_Dyn>(section.sh_offset + offset);
      if (entry.d_tag == DT_NULL) break;
      const auto word = [&] { return text(strings.sh_offset + entry.d_un.d_val); };
      if (entry.d_tag == DT_SONAME) library.soname = word();
      if (entry.d_tag == DT_NEEDED) library.needed.push_back(word());
      if (entry.d_tag == DT_RPATH) library.rpath = parts(word());
      if (entry.d_tag == DT_RUNPATH) library.runpath = parts(word());
    }
  }

  void read_symbols(const Elf64_Shdr& section, ElfLibrary& library) const {
    const Elf64_Shdr strings = section_header(section.sh_link);
    for (std::uint64_t offset = 0; offset < section.sh_size; offset += sizeof(Elf64_Sym)) {
      const auto symbol = at<Elf64_Sym>(section.sh_offset + offset);
      const auto binding = ELF64_ST_BIND(symbol.st_info);
      const auto visibility = ELF64_ST_VISIBILITY(symbol.st_other);
      const bool shown = (binding == STB_GLOBAL || binding == STB_WEAK || binding == STB_GNU_UNIQUE) &&
                         (visibility == STV_DEFAULT || visibility == STV_PROTECTED);
      if (shown && symbol.st_shndx != SHN_UNDEF) library.exports.push_back(text(strings.sh_offset + symbol.st_name));
    }
  }

  /// A search path taken apart at its colons.
  static std::vector<std::string> parts(const std::string& path) {
    std::vector<std::string> found;
    std::size_t at = 0;
    while (at <= path.size()) {
      const auto end = std::min(path.find(':', at), path.size());
      if (end > at) found.push_back(path.substr(at, end - at));
      at = end + 1;
    }
    return found;
  }

  template <typename T>
  T at(std::uint64_t offset) const {
    if (offset > bytes_.size() || bytes_.size() - offset < sizeof(T)) fail("is cut short");
    T value;
    std::memcpy(&value, bytes_.data() + offset, sizeof value);
    return value;
  }

  Elf64_Shdr section_header(std::size_t index) const {
    return at<Elf64_Shdr>(header_.e_shoff + index * std::uint64_t{header_.e_shentsize});
  }

  std::string text(std::uint64_t offset) const {
    const auto end = bytes_.find('\0', offset);
    if (offset >= bytes_.size() || end == std::string::npos) fail("is cut short");
    return bytes_.substr(offset, end - offset);
  }

  std::string name_;
  std::string bytes_;
  Elf64_Ehdr header_{};
};

}  // namespace

ElfLibrary read_elf_library(const std::filesystem::path& file) {
  return ElfFile(file).read();
}

}  // namespace mebots::modeldesc
