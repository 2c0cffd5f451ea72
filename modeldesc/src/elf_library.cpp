// SPDX-License-Identifier: Apache-2.0
#include "mebots/modeldesc/elf_library.hpp"

#include "mebots/elf_bytes.hpp"

#include <elf.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <link.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <map>
#include <span>
#include <string_view>
#include <utility>

namespace mebots::modeldesc {
namespace {

class Mapping {
 public:
  explicit Mapping(const std::filesystem::path& file) {
    const int descriptor = open(file.c_str(), O_RDONLY | O_CLOEXEC);
    struct stat status {};
    if (descriptor < 0 || fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode)) {
      if (descriptor >= 0) close(descriptor);
      throw Error(ErrorCode::file_unreadable, fmt::format("{}: cannot be opened", file.string()));
    }
    size_ = static_cast<std::size_t>(status.st_size);
    if (size_ > 0) data_ = mmap(nullptr, size_, PROT_READ, MAP_PRIVATE, descriptor, 0);
    close(descriptor);
    if (data_ == MAP_FAILED) throw Error(ErrorCode::file_unreadable, fmt::format("{}: cannot be read", file.string()));
  }
  ~Mapping() {
    if (data_ != nullptr) munmap(data_, size_);
  }
  Mapping(const Mapping&) = delete;
  Mapping& operator=(const Mapping&) = delete;

  std::span<const std::uint8_t> bytes() const { return {static_cast<const std::uint8_t*>(data_), size_}; }

 private:
  void* data_ = nullptr;
  std::size_t size_ = 0;
};

/// A loadable segment. `address` is relative to the library's load address.
struct Segment {
  std::uint64_t address;
  std::string_view bytes;
  bool writable;
};

/// Reads ELF structures from a file or from memory, with bounds checks.
class ElfImage {
 public:
  /// `name` is the library's name in errors. `base` is the load address, which the loader adds to pointers of the
  /// dynamic section.
  ElfImage(std::string name, std::uint64_t base) : name_(std::move(name)), base_(base) {}

  void add(Segment segment) { segments_.push_back(segment); }
  template <typename Entry>
  void set_dynamic(std::uint64_t address) {
    for (;; address += sizeof(Entry)) {
      const auto entry = at<Entry>(address);
      if (entry.d_tag == DT_NULL) return;
      if (entry.d_tag == DT_NEEDED || entry.d_tag == DT_SONAME || entry.d_tag == DT_RPATH || entry.d_tag == DT_RUNPATH)
        names_.emplace_back(entry.d_tag, entry.d_un.d_val);
      else
        values_[entry.d_tag] = entry.d_un.d_val;
    }
  }

  [[noreturn]] void fail(std::string_view what) const {
    throw Error(ErrorCode::fmu_inconsistent, fmt::format("{}: {}", name_, what));
  }

  void read_names(ElfLibrary& library) const {
    for (const auto& [tag, value] : names_) {
      if (tag == DT_SONAME) library.soname = string(value);
      if (tag == DT_NEEDED) library.needed.push_back(string(value));
      if (tag == DT_RPATH) library.rpath = parts(string(value));
      if (tag == DT_RUNPATH) library.runpath = parts(string(value));
    }
    library.symbolic = values_.contains(DT_SYMBOLIC) || (value(DT_FLAGS) & DF_SYMBOLIC) != 0;
  }

  /// Returns the versions of symbols that the library requires from other libraries. The table has the same layout in
  /// 32-bit files.
  std::vector<std::string> needed_versions() const {
    std::size_t most = 0;  // each row of the table has 16 bytes
    for (const auto& segment : segments_) most += segment.bytes.size() / sizeof(Elf64_Vernaux);
    std::vector<std::string> versions;
    auto place = pointer(DT_VERNEED);
    for (std::uint64_t i = 0; i < value(DT_VERNEEDNUM); ++i) {
      const auto library = at<Elf64_Verneed>(place);
      auto place_of_name = place + library.vn_aux;
      for (std::uint32_t k = 0; k < library.vn_cnt; ++k) {
        const auto version = at<Elf64_Vernaux>(place_of_name);
        if (versions.size() == most) fail("its table of needed versions is damaged: its rows overlap");
        versions.push_back(string(version.vna_name));
        if (version.vna_next == 0) break;
        place_of_name += version.vna_next;
      }
      if (library.vn_next == 0) break;
      place += library.vn_next;
    }
    return versions;
  }

  std::vector<ElfSymbol> symbols() const {
    const auto bound = bound_symbols();
    const auto count = std::max<std::uint64_t>(bound.size(), hashed_symbols());
    std::vector<ElfSymbol> symbols;
    for (std::uint64_t i = 1; i < count; ++i) {
      const auto entry = symbol(i);
      if (!is_shown(entry)) continue;
      auto read = to_symbol(entry);
      read.bound = i < bound.size() && bound[i];
      symbols.push_back(std::move(read));
    }
    return symbols;
  }

  std::vector<ElfSymbol> unique_symbols() const {
    std::vector<ElfSymbol> symbols;
    const auto count = hashed_symbols();
    for (std::uint64_t i = 1; i < count; ++i) {
      const auto entry = symbol(i);
      if (ELF64_ST_BIND(entry.st_info) == STB_GNU_UNIQUE && entry.st_shndx != SHN_UNDEF)
        symbols.push_back(to_symbol(entry));
    }
    return symbols;
  }

 private:
  std::uint64_t value(std::int64_t tag) const {
    const auto found = values_.find(tag);
    return found == values_.end() ? 0 : found->second;
  }
  /// Returns a pointer of the dynamic section, relative to the load address. glibc's loader has converted the pointers
  /// of most objects to absolute addresses, but not the pointers of the kernel's vDSO.
  std::uint64_t pointer(std::int64_t tag) const {
    const auto address = value(tag);
    return address >= base_ ? address - base_ : address;
  }

  static bool is_shown(const Elf64_Sym& symbol) {
    const auto binding = ELF64_ST_BIND(symbol.st_info);
    const auto visibility = ELF64_ST_VISIBILITY(symbol.st_other);
    return (binding == STB_GLOBAL || binding == STB_WEAK || binding == STB_GNU_UNIQUE) &&
           (visibility == STV_DEFAULT || visibility == STV_PROTECTED);
  }

  ElfSymbol to_symbol(const Elf64_Sym& symbol) const {
    ElfSymbol read;
    const auto binding = ELF64_ST_BIND(symbol.st_info);
    read.name = string(symbol.st_name);
    read.defined = symbol.st_shndx != SHN_UNDEF;
    read.weak = binding == STB_WEAK;
    read.unique = read.defined && binding == STB_GNU_UNIQUE;
    read.preemptible = read.defined && ELF64_ST_VISIBILITY(symbol.st_other) == STV_DEFAULT;
    if (read.unique && ELF64_ST_TYPE(symbol.st_info) != STT_TLS) read.constant = constant(symbol);
    return read;
  }

  std::string constant(const Elf64_Sym& symbol) const {
    for (const auto& segment : segments_) {
      if (segment.writable || symbol.st_value < segment.address) continue;
      const auto offset = symbol.st_value - segment.address;
      if (offset < segment.bytes.size() && symbol.st_size <= segment.bytes.size() - offset)
        return std::string(segment.bytes.substr(offset, symbol.st_size));
    }
    return {};
  }

  Elf64_Sym symbol(std::uint64_t index) const { return at<Elf64_Sym>(pointer(DT_SYMTAB) + index * sizeof(Elf64_Sym)); }

  /// Returns the number of dynamic symbols up to the last symbol in a hash table. Later symbols are undefined and are
  /// not counted.
  std::uint64_t hashed_symbols() const {
    if (values_.contains(DT_HASH)) return at<std::uint32_t>(pointer(DT_HASH) + sizeof(std::uint32_t));
    return values_.contains(DT_GNU_HASH) ? gnu_hashed_symbols(pointer(DT_GNU_HASH)) : 0;
  }

  /// Returns the number of dynamic symbols up to the last symbol in a GNU hash table. The table contains counts, a
  /// bloom filter, the first symbol of each bucket, and one word per symbol. The lowest bit of the word is 1 for the
  /// last symbol of a bucket.
  std::uint64_t gnu_hashed_symbols(std::uint64_t table) const {
    constexpr std::uint64_t kWord = sizeof(std::uint32_t);
    const auto word = [&](std::uint64_t i) { return std::uint64_t{at<std::uint32_t>(table + i * kWord)}; };
    const auto buckets = word(0);
    const auto first = word(1);
    const auto chains = 4 + 2 * word(2) + buckets;
    std::uint64_t last = 0;
    for (std::uint64_t i = 0; i < buckets; ++i) last = std::max(last, word(chains - buckets + i));
    if (last < first) return first;
    while ((word(chains + last - first) & 1) == 0) ++last;
    return last + 1;
  }

  /// Returns one element per symbol: true if a relocation refers to the symbol.
  std::vector<bool> bound_symbols() const {
    std::vector<bool> bound;
    const auto scan = [&](std::uint64_t address, std::uint64_t size) {
      for (std::uint64_t offset = 0; offset + sizeof(Elf64_Rela) <= size; offset += sizeof(Elf64_Rela)) {
        const auto index = ELF64_R_SYM(at<Elf64_Rela>(address + offset).r_info);
        if (index == 0) continue;
        if (index >= bound.size()) {
          static_cast<void>(symbol(index));  // throws if the index is outside the file, and so limits the vector's size
          bound.resize(index + 1);
        }
        bound[index] = true;
      }
    };
    scan(pointer(DT_RELA), value(DT_RELASZ));
    scan(pointer(DT_JMPREL), value(DT_PLTRELSZ));
    return bound;
  }

  /// Splits a search path at its colons.
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

  std::string_view from(std::uint64_t address) const {
    for (const auto& segment : segments_) {
      if (address >= segment.address && address - segment.address < segment.bytes.size())
        return segment.bytes.substr(address - segment.address);
    }
    fail("is cut short");
  }

  template <typename T>
  T at(std::uint64_t address) const {
    const auto bytes = from(address);
    if (bytes.size() < sizeof(T)) fail("is cut short");
    T value;
    std::memcpy(&value, bytes.data(), sizeof value);
    return value;
  }

  std::string string(std::uint64_t offset) const {
    const auto bytes = from(pointer(DT_STRTAB) + offset);
    const auto end = bytes.find('\0');
    if (end == std::string_view::npos) fail("is cut short");
    return std::string(bytes.substr(0, end));
  }

  std::string name_;
  std::uint64_t base_;
  std::vector<Segment> segments_;
  std::vector<std::pair<std::int64_t, std::uint64_t>> names_;
  std::map<std::int64_t, std::uint64_t> values_;
};

class ElfFile {
 public:
  explicit ElfFile(const std::filesystem::path& file)
      : mapping_(file), bytes_(mapping_.bytes(), file.string(), ErrorCode::fmu_inconsistent), image_(file.string(), 0) {
    if (!bytes_.has_magic()) bytes_.fail("is not an ELF file");
    const auto ident = bytes_.get<std::array<unsigned char, EI_NIDENT>>(0, "the ELF header");
    is_64_bit_ = ident[EI_CLASS] == ELFCLASS64;
    if ((!is_64_bit_ && ident[EI_CLASS] != ELFCLASS32) || ident[EI_DATA] != ELFDATA2LSB)
      bytes_.fail("is not a little-endian ELF file of 32 or 64 bits");
    if (is_64_bit_)
      read_file<Elf64_Ehdr, Elf64_Phdr, Elf64_Dyn>();
    else
      read_file<Elf32_Ehdr, Elf32_Phdr, Elf32_Dyn>();
  }

  ElfNeeds needs() const {
    ElfLibrary names;
    image_.read_names(names);
    return {names.needed, image_.needed_versions()};
  }

  ElfLibrary read() const {
    if (!is_64_bit_) bytes_.fail("is not a 64-bit ELF file");
    ElfLibrary library;
    library.machine = machine_;
    image_.read_names(library);
    library.symbols = image_.symbols();
    return library;
  }

 private:
  template <typename Header, typename ProgramHeader, typename DynamicEntry>
  void read_file() {
    const auto header = bytes_.get<Header>(0, "the ELF header");
    if (header.e_type != ET_DYN) bytes_.fail("is not a shared library");
    machine_ = header.e_machine;
    std::vector<std::uint64_t> dynamic;
    for (std::uint64_t i = 0; i < header.e_phnum; ++i) {
      const auto segment = bytes_.get<ProgramHeader>(header.e_phoff + i * header.e_phentsize, "a program header");
      if (segment.p_type == PT_DYNAMIC) dynamic.push_back(segment.p_vaddr);
      if (segment.p_type != PT_LOAD || segment.p_filesz == 0) continue;
      const auto bytes = bytes_.part(segment.p_offset, segment.p_filesz, "a segment");
      image_.add({segment.p_vaddr,
                  {reinterpret_cast<const char*>(bytes.data()), bytes.size()},
                  (segment.p_flags & PF_W) != 0});
    }
    if (dynamic.empty()) bytes_.fail("has no dynamic section");
    image_.set_dynamic<DynamicEntry>(dynamic.front());
  }

  Mapping mapping_;
  ElfBytes bytes_;
  ElfImage image_;
  bool is_64_bit_ = false;
  std::uint16_t machine_ = 0;
};

LoadedLibrary read_loaded(const dl_phdr_info& info, UniqueSymbols unique) {
  ElfImage image(info.dlpi_name, info.dlpi_addr);
  const ElfW(Phdr)* dynamic = nullptr;
  for (std::size_t i = 0; i < info.dlpi_phnum; ++i) {
    const auto& segment = info.dlpi_phdr[i];
    if (segment.p_type == PT_DYNAMIC) dynamic = &segment;
    if (segment.p_type != PT_LOAD || (segment.p_flags & PF_R) == 0) continue;
    const auto* const bytes = reinterpret_cast<const char*>(info.dlpi_addr + segment.p_vaddr);  // NOLINT: its place
    image.add({segment.p_vaddr, {bytes, segment.p_memsz}, (segment.p_flags & PF_W) != 0});
  }
  LoadedLibrary loaded;
  loaded.file = info.dlpi_name;
  if (dynamic == nullptr) return loaded;
  image.set_dynamic<ElfW(Dyn)>(dynamic->p_vaddr);
  ElfLibrary names;
  image.read_names(names);
  loaded.soname = names.soname;
  loaded.needed = names.needed;
  if (unique == UniqueSymbols::read) loaded.unique = image.unique_symbols();
  return loaded;
}

std::vector<std::string> names_of(const std::vector<ElfSymbol>& symbols, bool defined) {
  std::vector<std::string> names;
  for (const auto& symbol : symbols) {
    if (symbol.defined == defined) names.push_back(symbol.name);
  }
  return names;
}

}  // namespace

std::vector<std::string> ElfLibrary::exports() const {
  return names_of(symbols, true);
}

std::vector<std::string> ElfLibrary::imports() const {
  return names_of(symbols, false);
}

ElfNeeds read_elf_needs(const std::filesystem::path& file) {
  return ElfFile(file).needs();
}

ElfLibrary read_elf_library(const std::filesystem::path& file) {
  return ElfFile(file).read();
}

std::vector<std::string> search_folders(const std::vector<std::string>& paths, const std::filesystem::path& file) {
  std::vector<std::string> folders;
  for (std::string path : paths) {
    for (const std::string_view name : {"${ORIGIN}", "$ORIGIN"}) {
      const auto origin = file.parent_path().string();
      for (auto at = path.find(name); at != std::string::npos; at = path.find(name, at + origin.size()))
        path.replace(at, name.size(), origin);
    }
    folders.push_back(path);
  }
  return folders;
}

std::vector<LoadedLibrary> loaded_libraries(UniqueSymbols unique) {
  std::vector<LoadedLibrary> libraries;
  auto take = [&](const dl_phdr_info& info) {
    try {
      libraries.push_back(read_loaded(info, unique));
    } catch (const Error&) {  // without readable tables, only the name is listed
      libraries.push_back({info.dlpi_name, {}, {}, {}});
    }
  };
  const auto visit = [](dl_phdr_info* info, std::size_t, void* taker) {
    (*static_cast<decltype(take)*>(taker))(*info);
    return 0;
  };
  dl_iterate_phdr(visit, &take);
  return libraries;
}

}  // namespace mebots::modeldesc
