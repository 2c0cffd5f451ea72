// SPDX-License-Identifier: Apache-2.0
#include "elf/elf.hpp"

#include "mebots/elf_bytes.hpp"

#include <cxxabi.h>
#include <fmt/core.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <utility>

namespace mebots::soc {
namespace {

/// Reads a LEB128 number, and removes it from `bytes`. Returns nullopt at the end of the bytes.
std::optional<std::uint32_t> take_number(std::span<const std::uint8_t>& bytes) {
  std::uint32_t value = 0;
  for (unsigned shift = 0; !bytes.empty() && shift < 32; shift += 7) {
    const auto byte = bytes.front();
    bytes = bytes.subspan(1);
    value |= (byte & 0x7fU) << shift;
    if ((byte & 0x80U) == 0) return value;
  }
  return std::nullopt;
}

std::string take_text(std::span<const std::uint8_t>& bytes) {
  const auto end = std::ranges::find(bytes, std::uint8_t{0});
  const std::string text(bytes.begin(), end);
  bytes = bytes.subspan(std::min(bytes.size(), text.size() + 1));
  return text;
}

}  // namespace

std::string architecture_in(std::span<const std::uint8_t> attributes) {
  constexpr std::uint8_t kVersion = 'A';
  constexpr std::size_t kLength = 4;
  constexpr std::uint32_t kWholeFile = 1;
  constexpr std::uint32_t kArchitecture = 5;
  auto bytes = attributes;
  if (bytes.size() < 1 + kLength || bytes.front() != kVersion) return {};
  bytes = bytes.subspan(1 + kLength);
  if (take_text(bytes) != "riscv" || take_number(bytes) != kWholeFile || bytes.size() < kLength) return {};
  bytes = bytes.subspan(kLength);
  while (const auto tag = take_number(bytes)) {
    const bool is_text = *tag % 2 == 1;
    if (is_text) {
      auto text = take_text(bytes);
      if (*tag == kArchitecture) return text;
    } else if (!take_number(bytes)) {
      break;
    }
  }
  return {};
}

namespace {

constexpr std::uint32_t kMaxFileSize = 1U << 30;

struct FileHeader {
  std::uint8_t ident[16];
  std::uint16_t type, machine;
  std::uint32_t version, entry, program_offset, section_offset, flags;
  std::uint16_t header_size, program_size, program_count, section_size, section_count, name_index;
};
static_assert(sizeof(FileHeader) == 52);

struct ProgramHeader {
  std::uint32_t type, offset, virtual_address, physical_address, file_size, memory_size, flags, align;
};

struct SectionHeader {
  std::uint32_t name, type, flags, address, offset, size, link, info, align, entry_size;
};

struct SymbolEntry {
  std::uint32_t name, value, size;
  std::uint8_t info, other;
  std::uint16_t section;
};

constexpr std::uint64_t kAddressSpace = 0x1'0000'0000;
constexpr std::uint16_t kExecutable = 2;
constexpr std::uint16_t kRiscv = 243;
constexpr std::uint32_t kLoad = 1;
constexpr std::uint32_t kProgramBits = 1;
constexpr std::uint32_t kSymbolTable = 2;
constexpr std::uint32_t kAttributes = 0x70000003;
constexpr std::uint32_t kCompressed = 0x800;
constexpr std::uint16_t kUndefined = 0;
constexpr unsigned kFunction = 2;
constexpr std::uint32_t kFarthestFromLabel = 0x10000;
constexpr std::uint32_t kFloatAbi = 0x6;
constexpr std::uint32_t kSingleFloatAbi = 0x2;
constexpr std::uint32_t kEmbeddedAbi = 0x8;

FileHeader checked_header(const ElfBytes& file) {
  const auto ident = file.part(0, 16, "the ELF header");
  if (!file.has_magic()) {
    file.fail("not an ELF file; give the linked firmware (.elf), not a .bin or .hex");
  }
  if (ident[4] != 1) file.fail("a 64-bit ELF file; the core has 32 bits: compile with -march=rv32imc -mabi=ilp32");
  if (ident[5] != 1) file.fail("a big-endian ELF file; the core is little-endian");
  const auto header = file.get<FileHeader>(0, "the ELF header");
  if (header.machine != kRiscv) {
    file.fail(fmt::format("an ELF file for machine {}; the core is RISC-V (243)", header.machine));
  }
  if (header.type != kExecutable) {
    file.fail(fmt::format("an ELF file of type {}; the core needs a linked executable (2)", header.type));
  }
  if ((header.flags & kFloatAbi & ~kSingleFloatAbi) != 0) {
    file.fail(
        "compiled for double-precision floating-point registers, which no core has: compile with -mabi=ilp32f or "
        "-mabi=ilp32");
  }
  if (header.program_count != 0 && header.program_size != sizeof(ProgramHeader)) {
    file.fail(fmt::format("program headers of {} bytes instead of {}", header.program_size, sizeof(ProgramHeader)));
  }
  return header;
}

void require_room(const ElfBytes& file, unsigned number, std::string_view which, std::uint32_t address,
                  std::uint64_t size) {
  if (address + size <= kAddressSpace) return;
  file.fail(fmt::format("segment {} with {} bytes at its {} address 0x{:08x} passes the end of the address space",
                        number, size, which, address));
}

/// Throws Error if two segments load the same byte of memory. Run addresses of segments may overlap (overlays).
void require_apart(const ElfBytes& file, std::vector<ElfSegment> segments) {
  std::erase_if(segments, [](const ElfSegment& segment) { return segment.bytes.empty(); });
  std::ranges::sort(segments, {}, &ElfSegment::load_address);
  for (std::size_t i = 1; i < segments.size(); ++i) {
    const auto& before = segments[i - 1];
    if (segments[i].load_address >= before.load_address + std::uint64_t{before.bytes.size()}) continue;
    file.fail(
        fmt::format("segments overlap at their load addresses 0x{:08x} and 0x{:08x}; look at AT> in the linker "
                    "script",
                    before.load_address, segments[i].load_address));
  }
}

std::vector<ElfSegment> read_segments(const ElfBytes& file, const FileHeader& header) {
  std::vector<ElfSegment> segments;
  for (unsigned i = 0; i < header.program_count; ++i) {
    const auto program = file.get<ProgramHeader>(header.program_offset + std::uint64_t{i} * sizeof(ProgramHeader),
                                                 fmt::format("program header {}", i));
    if (program.type != kLoad || program.memory_size == 0) continue;
    if (program.file_size > program.memory_size) {
      file.fail(fmt::format("segment {} has {} bytes in the file but {} in memory", i, program.file_size,
                            program.memory_size));
    }
    require_room(file, i, "load", program.physical_address, program.file_size);
    require_room(file, i, "run", program.virtual_address, program.memory_size);
    const auto bytes = file.part(program.offset, program.file_size, fmt::format("segment {}", i));
    segments.push_back(
        {program.physical_address, program.virtual_address, {bytes.begin(), bytes.end()}, program.memory_size});
  }
  if (segments.empty()) file.fail("no segment to load; link the program before running it");
  require_apart(file, segments);
  return segments;
}

/// Returns the address of the first instruction. If the entry point is a run address at which no bytes are loaded,
/// returns the corresponding load address, as QEMU does.
std::uint32_t loaded_entry(const ElfBytes& file, std::uint32_t entry, const std::vector<ElfSegment>& segments) {
  if (entry % 2 != 0) file.fail(fmt::format("entry point 0x{:08x} is odd", entry));
  const auto holds = [&](std::uint32_t address, const ElfSegment& segment) {
    return entry >= address && entry - address < segment.bytes.size();
  };
  for (const auto& segment : segments) {
    if (holds(segment.load_address, segment)) return entry;
  }
  for (const auto& segment : segments) {
    if (!holds(segment.run_address, segment)) continue;
    const std::uint32_t loaded = entry - segment.run_address + segment.load_address;
    if (loaded % 2 != 0)
      file.fail(fmt::format("entry point 0x{:08x} is loaded at the odd address 0x{:08x}", entry, loaded));
    return loaded;
  }
  file.fail(fmt::format("entry point 0x{:08x} lies in none of its segments", entry));
}

/// Returns true for psABI mapping symbols, which separate code and data, and for .L labels of the compiler.
bool is_unnamed(std::string_view name) {
  return name.starts_with("$x") || name.starts_with("$d") || name.starts_with(".L");
}

std::vector<SectionHeader> read_sections(const ElfBytes& file, const FileHeader& header) {
  std::vector<SectionHeader> sections;
  if (header.section_count == 0) return sections;
  if (header.section_size != sizeof(SectionHeader)) {
    file.fail(fmt::format("section headers of {} bytes instead of {}", header.section_size, sizeof(SectionHeader)));
  }
  file.part(header.section_offset, std::uint64_t{header.section_count} * sizeof(SectionHeader), "the section headers");
  for (std::uint32_t i = 0; i < header.section_count; ++i) {
    sections.push_back(file.get<SectionHeader>(header.section_offset + std::uint64_t{i} * sizeof(SectionHeader),
                                               fmt::format("section header {}", i)));
  }
  return sections;
}

/// Reads the symbols of the symbol table. A file has at most one. `names` receives the storage of the symbols' names.
std::vector<ElfSymbol> read_symbols(const ElfBytes& file, std::span<const SectionHeader> sections,
                                    std::shared_ptr<const std::string>& names) {
  std::vector<ElfSymbol> symbols;
  const auto section = std::ranges::find(sections, kSymbolTable, &SectionHeader::type);
  if (section == sections.end()) return symbols;
  if (section->link >= sections.size())
    file.fail(fmt::format("the symbol table refers to section {}, which does not exist", section->link));
  const auto& strings_header = sections[section->link];
  const auto strings = file.part(strings_header.offset, strings_header.size, "the symbol names");
  const auto table = file.part(section->offset, section->size, "the symbol table");
  names = std::make_shared<const std::string>(strings.begin(), strings.end());
  const std::string_view text = *names;
  std::vector<std::size_t>
      ends;  // ends of the names; a search for the end of each name would be too slow for a hostile file
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\0') ends.push_back(i);
  }
  ends.push_back(text.size());
  for (std::size_t at = 0; at + sizeof(SymbolEntry) <= table.size(); at += sizeof(SymbolEntry)) {
    SymbolEntry entry;
    std::memcpy(&entry, table.data() + at, sizeof entry);
    const auto type = entry.info & 0xfU;
    if (entry.name == 0 || entry.section == kUndefined || type > kFunction)
      continue;  // also skips names of sections and files
    if (entry.name >= text.size())
      file.fail(fmt::format("the name of symbol {} is outside of the string table", at / sizeof entry));
    const auto end = *std::lower_bound(ends.begin(), ends.end(), entry.name);
    const auto name = text.substr(entry.name, end - entry.name);
    if (!name.empty() && !is_unnamed(name)) {
      symbols.push_back({name, entry.value, entry.size, type == kFunction});
    }
  }
  std::stable_sort(symbols.begin(), symbols.end(), [](const auto& a, const auto& b) { return a.address < b.address; });
  return symbols;
}

std::string read_architecture(const ElfBytes& file, std::span<const SectionHeader> sections) {
  const auto section = std::ranges::find(sections, kAttributes, &SectionHeader::type);
  if (section == sections.end() || !file.has(section->offset, section->size)) return {};
  return architecture_in(file.part(section->offset, section->size, "the attributes"));
}

/// Reads the line numbers, which are only used in messages. Ignores sections that are damaged or compressed.
std::shared_ptr<const LineSections> read_lines(const ElfBytes& file, const FileHeader& header,
                                               std::span<const SectionHeader> sections) {
  auto lines = std::make_shared<LineSections>();
  if (header.name_index >= sections.size()) return lines;
  const auto bytes_of = [&](const SectionHeader& section) {
    const bool whole = section.type == kProgramBits && (section.flags & kCompressed) == 0;
    return whole && file.has(section.offset, section.size) ? file.part(section.offset, section.size, "a section")
                                                           : std::span<const std::uint8_t>();
  };
  const auto& names_header = sections[header.name_index];
  if (!file.has(names_header.offset, names_header.size)) return lines;
  const auto names = file.part(names_header.offset, names_header.size, "the section names");
  const auto is = [&](const SectionHeader& section, std::string_view name) {  // includes the final zero
    return section.name < names.size() && names.size() - section.name > name.size() &&
           std::ranges::equal(names.subspan(section.name, name.size() + 1), std::string(name) + '\0', {},
                              [](std::uint8_t c) { return static_cast<char>(c); });
  };
  for (const auto& section : sections) {
    for (const auto& [name, target] : {std::pair{".debug_line", &lines->line},
                                       {".debug_line_str", &lines->line_string},
                                       {".debug_str", &lines->string}}) {
      if (!is(section, name)) continue;
      const auto bytes = bytes_of(section);
      target->assign(bytes.begin(), bytes.end());
    }
  }
  return lines;
}

}  // namespace

std::string ElfSymbol::shown() const {
  std::string plain(name);
  if (!plain.starts_with("_Z")) return plain;
  int status = 0;
  const std::unique_ptr<char, decltype(&std::free)> text(abi::__cxa_demangle(plain.c_str(), nullptr, nullptr, &status),
                                                         &std::free);
  return status == 0 ? std::string(text.get()) : plain;
}

Elf Elf::parse(std::span<const std::uint8_t> bytes, const std::string& origin) {
  const ElfBytes file(bytes, origin, ErrorCode::unspecified);
  const auto header = checked_header(file);
  if ((header.flags & kEmbeddedAbi) != 0) file.fail("compiled for RV32E; compile with -march=rv32imc -mabi=ilp32");
  Elf elf;
  elf.origin_ = origin;
  elf.uses_float_registers_ = (header.flags & kFloatAbi) == kSingleFloatAbi;
  elf.segments_ = read_segments(file, header);
  elf.entry_ = loaded_entry(file, header.entry, elf.segments_);
  const auto sections = read_sections(file, header);
  elf.symbols_ = read_symbols(file, sections, elf.names_);
  elf.lines_ = read_lines(file, header, sections);
  elf.architecture_ = read_architecture(file, sections);
  return elf;
}

Elf Elf::read(const std::filesystem::path& path) {
  std::error_code code;
  if (!std::filesystem::exists(path, code)) {
    throw Error(fmt::format("{}: no such file; give the path of a linked RISC-V program", path.string()));
  }
  if (!std::filesystem::is_regular_file(path, code)) {
    throw Error(fmt::format("{}: is not a regular file; give the path of a linked RISC-V program", path.string()));
  }
  const auto size = std::filesystem::file_size(path, code);
  if (code || size > kMaxFileSize)
    throw Error(fmt::format("{}: larger than 1 GiB, not a program for this core", path.string()));
  std::ifstream stream(path, std::ios::binary);
  const std::vector<char> text{std::istreambuf_iterator<char>(stream), {}};
  if (!stream) throw Error(fmt::format("{}: cannot be read", path.string()));
  return parse({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}, path.string());
}

std::optional<std::uint32_t> Elf::symbol(std::string_view name) const {
  const auto found =
      std::find_if(symbols_.begin(), symbols_.end(), [&](const auto& symbol) { return symbol.name == name; });
  if (found == symbols_.end()) return std::nullopt;
  return found->address;
}

const ElfSymbol* Elf::covering(std::uint32_t address) const {
  const auto after = std::upper_bound(symbols_.begin(), symbols_.end(), address,
                                      [](std::uint32_t value, const auto& symbol) { return value < symbol.address; });
  // Labels in assembly code have no size. A label extends to the next function, or to the next symbol that has a size.
  const ElfSymbol* label = nullptr;
  bool labels_end = false;
  for (auto at = after; at != symbols_.begin();) {
    const auto& symbol = *--at;
    const auto distance = address - symbol.address;
    if (symbol.size != 0) {
      if (distance < symbol.size) return &symbol;
      labels_end = true;
    } else if (!labels_end && distance < kFarthestFromLabel) {
      if (symbol.function) return &symbol;
      if (label == nullptr) label = &symbol;
    }
  }
  return label;
}

std::string Elf::where(std::uint32_t address) const {
  return name_of(address, address);
}

std::vector<LineRange> Elf::line_ranges() const {
  return lines_ ? all_lines(*lines_) : std::vector<LineRange>();
}

std::string Elf::where_called(std::uint32_t return_address) const {
  return name_of(return_address, return_address - 1);
}

std::string Elf::name_of(std::uint32_t address, std::uint32_t line_of) const {
  const auto* symbol = covering(address);
  if (symbol == nullptr) return {};
  auto text = symbol->shown();
  if (symbol->address != address) text += fmt::format("+0x{:x}", address - symbol->address);
  if (const auto line = lines_ ? find_line(*lines_, line_of) : std::nullopt) text += fmt::format(" ({})", line->text());
  return text;
}

}  // namespace mebots::soc
