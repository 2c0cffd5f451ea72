// SPDX-License-Identifier: Apache-2.0
#include "lag_fmu.hpp"

#include <elf.h>
#include <gmock/gmock.h>

#include <cstring>
#include <fstream>
#include <iterator>

namespace mebots::test {
namespace {

template <typename T>
T at(const std::string& bytes, std::uint64_t offset) {
  T value;
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

/// Names that a shared library defines for others.
std::vector<std::string> exported_symbols(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  std::vector<std::string> names;
  const auto header = at<Elf64_Ehdr>(bytes, 0);
  const auto section = [&](std::size_t i) { return at<Elf64_Shdr>(bytes, header.e_shoff + i * header.e_shentsize); };
  for (std::size_t i = 0; i < header.e_shnum; ++i) {
    if (section(i).sh_type != SHT_DYNSYM) continue;
    const Elf64_Shdr strings = section(section(i).sh_link);
    for (std::uint64_t offset = 0; offset < section(i).sh_size; offset += sizeof(Elf64_Sym)) {
      const auto symbol = at<Elf64_Sym>(bytes, section(i).sh_offset + offset);
      if (symbol.st_shndx != SHN_UNDEF && ELF64_ST_BIND(symbol.st_info) != STB_LOCAL)
        names.emplace_back(bytes.c_str() + strings.sh_offset + symbol.st_name);
    }
  }
  return names;
}

TEST(Fmu, ExportsAllOfItsFmi2FunctionsAndNothingElse) {
  const auto names = exported_symbols(LagFmu::get().binary());
  EXPECT_EQ(names.size(), sizeof(Library) / sizeof(void*));
  EXPECT_THAT(names, testing::Each(testing::StartsWith("fmi2")));
}

}  // namespace
}  // namespace mebots::test
