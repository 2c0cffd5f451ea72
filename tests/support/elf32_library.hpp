// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <elf.h>

#include <cstdint>
#include <string>
#include <vector>

namespace mebots::test {

/// Returns the bytes of a library for 32-bit x86 Linux without code or symbols. The library needs `libraries`, and a
/// symbol of `version` from the first of them. Its addresses are offsets in the file.
inline std::string elf32_library(const std::vector<std::string>& libraries, const std::string& version) {
  std::string strings(1, '\0');
  const auto text = [&](const std::string& value) {
    const auto offset = static_cast<Elf32_Word>(strings.size());
    strings += value + '\0';
    return offset;
  };
  std::vector<Elf32_Dyn> entries;
  const auto entry = [&](Elf32_Sword tag, Elf32_Word value) {
    Elf32_Dyn dynamic{};
    dynamic.d_tag = tag;
    dynamic.d_un.d_val = value;
    entries.push_back(dynamic);
  };
  for (const auto& library : libraries) entry(DT_NEEDED, text(library));
  const Elf32_Verneed need{1, 1, 1, sizeof(Elf32_Verneed), 0};
  const Elf32_Vernaux name{0, 0, 2, text(version), 0};
  const Elf32_Word needs = sizeof(Elf32_Ehdr) + 2 * sizeof(Elf32_Phdr);
  const Elf32_Word table = needs + sizeof need + sizeof name;
  const auto dynamic = static_cast<Elf32_Word>(table + strings.size());
  entry(DT_STRTAB, table);
  entry(DT_VERNEED, needs);
  entry(DT_VERNEEDNUM, 1);
  entry(DT_NULL, 0);
  const auto size_of_dynamic = static_cast<Elf32_Word>(entries.size() * sizeof(Elf32_Dyn));

  Elf32_Ehdr header{};
  const unsigned char ident[] = {0x7f, 'E', 'L', 'F', ELFCLASS32, ELFDATA2LSB, EV_CURRENT};
  for (std::size_t i = 0; i < sizeof ident; ++i) header.e_ident[i] = ident[i];
  header.e_type = ET_DYN;
  header.e_machine = EM_386;
  header.e_version = EV_CURRENT;
  header.e_phoff = sizeof header;
  header.e_ehsize = sizeof header;
  header.e_phentsize = sizeof(Elf32_Phdr);
  header.e_phnum = 2;
  const auto size = dynamic + size_of_dynamic;
  const Elf32_Phdr load{PT_LOAD, 0, 0, 0, size, size, PF_R, 1};
  const Elf32_Phdr list{PT_DYNAMIC, dynamic, dynamic, dynamic, size_of_dynamic, size_of_dynamic, PF_R, 4};

  std::string bytes;
  const auto put = [&](const auto& part) { bytes.append(reinterpret_cast<const char*>(&part), sizeof part); };
  put(header);
  put(load);
  put(list);
  put(need);
  put(name);
  bytes += strings;
  for (const auto& one : entries) put(one);
  return bytes;
}

}  // namespace mebots::test
