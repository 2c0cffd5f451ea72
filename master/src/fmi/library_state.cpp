// SPDX-License-Identifier: Apache-2.0
#include "fmi/library_state.hpp"

#include "mebots/error.hpp"
#include "mebots/modeldesc/elf_library.hpp"
#include "mebots/modeldesc/platform.hpp"

#include <dlfcn.h>
#include <fmt/format.h>
#include <link.h>
#include <sys/uio.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstring>
#include <fstream>
#include <functional>
#include <set>
#include <sstream>
#include <string_view>

namespace mebots::master {
namespace {

namespace fs = std::filesystem;

/// System libraries that are not examined. process_functions() contains all of their functions that change process-wide
/// data.
constexpr auto kKnownLibraries = std::to_array<std::string_view>(
    {"libc.so.6", "libm.so.6", "libdl.so.2", "libpthread.so.0", "librt.so.1", "libgcc_s.so.1", "libstdc++.so.6",
     "ld-linux-x86-64.so.2", "ld-linux-aarch64.so.1"});

std::atomic<std::uint64_t> own_loads{0};

void for_each_object(const std::function<void(const dl_phdr_info&)>& visit) {
  dl_iterate_phdr(
      [](dl_phdr_info* info, std::size_t, void* data) {
        (*static_cast<const std::function<void(const dl_phdr_info&)>*>(data))(*info);
        return 0;
      },
      const_cast<std::function<void(const dl_phdr_info&)>*>(&visit));
}

std::uint64_t all_loads() {
  std::uint64_t loads = 0;
  for_each_object([&](const dl_phdr_info& info) { loads = info.dlpi_adds; });
  return loads;
}

/// Returns how many libraries were loaded, except by mebots itself.
std::uint64_t foreign_loads() {
  return all_loads() - own_loads.load();
}

/// Returns the address and size of the part of a library that is read-only after relocation.
std::pair<std::uintptr_t, std::size_t> read_only_part(const dl_phdr_info& info) {
  for (std::size_t i = 0; i < info.dlpi_phnum; ++i) {
    const auto& header = info.dlpi_phdr[i];
    if (header.p_type == PT_GNU_RELRO) return {info.dlpi_addr + header.p_vaddr, header.p_memsz};
  }
  return {0, 0};
}

bool is_elf_file(const fs::path& file) {
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored)) return false;
  std::array<char, SELFMAG> magic{};
  std::FILE* const stream = std::fopen(file.c_str(), "rbe");
  if (stream == nullptr) return false;
  const bool read = std::fread(magic.data(), 1, magic.size(), stream) == magic.size();
  std::fclose(stream);
  return read && std::memcmp(magic.data(), ELFMAG, SELFMAG) == 0;
}

struct Range {
  std::uintptr_t begin;
  std::uintptr_t end;
};

/// Returns the memory without a file: heap, stacks, and the zero-initialised parts of libraries.
std::vector<Range> anonymous_memory() {
  std::vector<Range> ranges;
  std::ifstream maps("/proc/self/maps");
  for (std::string line; std::getline(maps, line);) {
    std::istringstream words(line);
    Range range{};
    char dash = 0;
    std::string rights;
    std::string offset;
    std::string device;
    std::string inode;
    std::string name;
    words >> std::hex >> range.begin >> dash >> range.end >> rights >> offset >> device >> inode >> name;
    if (rights.starts_with("rw") && (name.empty() || name == "[heap]")) ranges.push_back(range);
  }
  return ranges;
}

std::vector<Range> memory_of_libraries() {
  std::vector<Range> ranges;
  for_each_object([&](const dl_phdr_info& info) {
    for (std::size_t i = 0; i < info.dlpi_phnum; ++i) {
      const auto& header = info.dlpi_phdr[i];
      const auto begin = info.dlpi_addr + header.p_vaddr;
      if (header.p_type == PT_LOAD) ranges.push_back({begin, begin + header.p_memsz});
    }
  });
  return ranges;
}

bool is_in(std::uintptr_t address, const std::vector<Range>& ranges) {
  return std::ranges::any_of(ranges,
                             [address](const Range& range) { return address >= range.begin && address < range.end; });
}

/// True for a pointer to the memory that GCC's C++ library reserves for exceptions. In the data of the library, this
/// pointer occurs twice, followed by the size of the memory. The memory is one free block, whose first word is also
/// this size.
bool is_exception_pool(std::span<const std::uintptr_t> words, std::size_t at) {
  const auto size_at = [&](std::size_t place) { return place < words.size() ? words[place] : 0; };
  // NOLINTNEXTLINE(performance-no-int-to-ptr): addresses of loaded libraries come as numbers
  const auto* const block = reinterpret_cast<const std::uintptr_t*>(words[at]);
  const bool first = size_at(at + 1) == words[at] && size_at(at + 2) != 0 && block[0] == size_at(at + 2);
  const bool second = at > 0 && words[at - 1] == words[at] && size_at(at + 1) != 0 && block[0] == size_at(at + 1);
  return first || second;
}

/// Calls `visit` with copies of the blocks of a memory range, until `visit` returns false. Returns the result of the
/// last call. The kernel copies the blocks, because a sanitizer may forbid reading between the variables of an FMU.
bool for_each_block(std::uintptr_t address, std::size_t size,
                    const std::function<bool(std::span<const std::byte>)>& visit) {
  constexpr std::size_t kBlock = std::size_t{1} << 16;
  std::vector<std::byte> block(std::min(size, kBlock));
  for (std::size_t done = 0; done < size; done += block.size()) {
    block.resize(std::min(block.size(), size - done));
    const iovec to{block.data(), block.size()};
    // NOLINTNEXTLINE(performance-no-int-to-ptr): addresses of loaded libraries come as numbers
    const iovec from{reinterpret_cast<void*>(address + done), block.size()};
    if (process_vm_readv(getpid(), &to, 1, &from, 1, 0) != static_cast<ssize_t>(block.size()))
      std::memcpy(block.data(), from.iov_base, block.size());
    if (!visit(block)) return false;
  }
  return true;
}

/// True if all bytes are zero. The block is equal to itself shifted by one byte only if all bytes are equal.
bool is_zero(std::span<const std::byte> block) {
  return block.empty() ||
         (block[0] == std::byte{0} && std::memcmp(block.data(), block.data() + 1, block.size() - 1) == 0);
}

/// Returns the words of a memory range without trailing zeros.
std::vector<std::uintptr_t> words_of(std::span<const std::byte> bytes, std::uintptr_t address) {
  std::vector<std::uintptr_t> words;
  for (std::size_t at = -address % sizeof(std::uintptr_t); at < bytes.size(); at += sizeof(std::uintptr_t)) {
    const auto part = bytes.subspan(at, std::min(sizeof(std::uintptr_t), bytes.size() - at));
    std::uintptr_t word = 0;
    std::memcpy(&word, part.data(), part.size());
    words.push_back(word);
  }
  return words;
}

/// Returns the `link_map` of the library that contains this address.
const void* record_of(std::uintptr_t address) {
  Dl_info info{};
  void* record = nullptr;
  // NOLINTNEXTLINE(performance-no-int-to-ptr): addresses of loaded libraries come as numbers
  return dladdr1(reinterpret_cast<const void*>(address), &info, &record, RTLD_DL_LINKMAP) != 0 ? record : nullptr;
}

bool keeps_no_state(const fs::path& library) {
  try {
    const auto exports = modeldesc::read_elf_library(library).exports();
    return std::ranges::find(exports, kKeepsNoState) != exports.end();
  } catch (const Error&) {
    return false;
  }
}

}  // namespace

std::optional<std::string> LibraryImports::reason() const {
  if (!functions.empty()) {
    const auto& first = *functions.front();
    return fmt::format("it imports {}, which changes {}", readable_name(first), first.what);
  }
  if (!unknown.empty()) return fmt::format("it needs {}, which its archive does not contain", unknown.front());
  return std::nullopt;
}

LibraryImports read_imports(std::span<const fs::path> libraries) {
  LibraryImports imports;
  std::set<std::string> brought;
  std::set<std::string> needed;
  for (const auto& file : libraries) {
    try {
      const auto library = modeldesc::read_elf_library(file);
      brought.insert(file.filename());
      if (!library.soname.empty()) brought.insert(library.soname);
      needed.insert(library.needed.begin(), library.needed.end());
      for (const auto& name : library.imports()) {
        if (name == "dlopen" || name == "dlmopen") imports.opens_libraries = true;
        imports.reach = std::max(imports.reach, reach_of(name));
        const auto* const function = find_process_function(name);
        if (function != nullptr && std::ranges::find(imports.functions, function) == imports.functions.end())
          imports.functions.push_back(function);
      }
    } catch (const Error&) {
      imports.unknown.push_back(file.filename());
    }
  }
  for (const auto& name : needed) {
    if (!brought.contains(name) && std::ranges::find(kKnownLibraries, name) == kKnownLibraries.end())
      imports.unknown.push_back(name);
  }
  if (!imports.unknown.empty()) imports.reach = ProcessReach::everything;
  return imports;
}

std::vector<fs::path> libraries_of(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code ignored;
  const auto& platform = modeldesc::this_platform();
  const auto binaries = folder / "binaries";
  const std::set<fs::path> parts = {binaries / "linux64", binaries / platform.fmi2_folder,
                                    binaries / platform.fmi3_folder, folder / "resources"};
  for (const auto& part : parts) {
    for (const auto& entry : fs::recursive_directory_iterator(part, ignored)) {
      if (entry.path().filename().string().find(".so") != std::string::npos && is_elf_file(entry.path()))
        files.push_back(entry.path());
    }
  }
  std::ranges::sort(files);
  return files;
}

/// Finds pointers to memory that a library has allocated while it was loaded.
class LibraryState::OwnedMemory {
 public:
  OwnedMemory() : anonymous_(anonymous_memory()), libraries_(memory_of_libraries()) {}

  bool is_pointed_to_by(std::span<const std::uintptr_t> words, const void* own_record) const {
    for (std::size_t i = 0; i < words.size(); ++i) {
      if (words[i] == reinterpret_cast<std::uintptr_t>(own_record)) continue;  // the loader stores this pointer
      if (words[i] % alignof(std::max_align_t) != 0 || !is_in(words[i], anonymous_) || is_in(words[i], libraries_))
        continue;
      if (!is_exception_pool(words, i)) return true;
    }
    return false;
  }

 private:
  std::vector<Range> anonymous_;
  std::vector<Range> libraries_;
};

LibraryState::LibraryState(const fs::path& folder) : loads_(foreign_loads()) {
  const auto prefix = (folder / "").string();
  std::vector<fs::path> files;
  const OwnedMemory owned;
  for_each_object([&](const dl_phdr_info& info) {
    if (!std::string_view(info.dlpi_name).starts_with(prefix)) return;
    files.emplace_back(info.dlpi_name);
    add(info, owned);
  });
  imports_ = read_imports(files);
  if (imports_.opens_libraries) imports_ = read_imports(libraries_of(folder));
}

void LibraryState::add(const dl_phdr_info& info, const OwnedMemory& owned) {
  objects_.push_back(object_of(info));
  const auto& object = objects_.back();
  const auto owns = [&](const Memory& segment) {
    return owned.is_pointed_to_by(words_of(segment.bytes, segment.address), record_of(segment.address));
  };
  if (!owned_memory_ && !object.keeps_no_state && std::ranges::any_of(object.segments, owns))
    owned_memory_ = fmt::format("static objects of {} own memory, which a run may change", object.name);
}

LibraryState::Object LibraryState::object_of(const dl_phdr_info& info) {
  Object object;
  object.name = fs::path(info.dlpi_name).filename();
  object.keeps_no_state = keeps_no_state(info.dlpi_name);
  const auto [fixed, fixed_size] = read_only_part(info);
  for (std::size_t i = 0; i < info.dlpi_phnum; ++i) {
    const auto& header = info.dlpi_phdr[i];
    const auto begin = info.dlpi_addr + header.p_vaddr;
    if (header.p_type == PT_LOAD && (header.p_flags & PF_W) != 0) {
      // The part that is read-only after relocation (see read_only_part()) is at the start of the writable segment.
      const auto skipped = fixed == begin ? std::min<std::size_t>(fixed_size, header.p_memsz) : 0;
      object.segments.push_back(memory_at(begin + skipped, header.p_memsz - skipped));
    }
    if (header.p_type == PT_TLS && header.p_memsz > 0) {
      ThreadMemory memory{info.dlpi_addr, std::vector<std::byte>(header.p_memsz)};
      const bool exists = info.dlpi_tls_data != nullptr;
      // NOLINTNEXTLINE(performance-no-int-to-ptr): addresses of loaded libraries come as numbers
      std::memcpy(memory.fresh.data(), exists ? info.dlpi_tls_data : reinterpret_cast<const void*>(begin),
                  exists ? header.p_memsz : header.p_filesz);
      object.thread = std::move(memory);
    }
  }
  return object;
}

LibraryState::Memory LibraryState::memory_at(std::uintptr_t address, std::size_t size) {
  Memory memory{address, size, {}};
  for_each_block(address, size, [&](std::span<const std::byte> block) {
    memory.bytes.insert(memory.bytes.end(), block.begin(), block.end());
    return true;
  });
  const auto last =
      std::find_if(memory.bytes.rbegin(), memory.bytes.rend(), [](std::byte byte) { return byte != std::byte{0}; });
  memory.bytes.erase(last.base(), memory.bytes.end());
  memory.bytes.shrink_to_fit();
  return memory;
}

bool LibraryState::Memory::is_unchanged() const {
  std::span<const std::byte> before(bytes);
  return for_each_block(address, size, [&](std::span<const std::byte> block) {
    const auto known = std::min(block.size(), before.size());
    if (known > 0 && std::memcmp(block.data(), before.data(), known) != 0) return false;
    before = before.subspan(known);
    return is_zero(block.subspan(known));
  });
}

bool LibraryState::is_thread_unchanged(const ThreadMemory& memory) const {
  bool unchanged = true;
  for_each_object([&](const dl_phdr_info& info) {
    if (info.dlpi_addr != memory.library || info.dlpi_tls_data == nullptr) return;
    unchanged = std::memcmp(info.dlpi_tls_data, memory.fresh.data(), memory.fresh.size()) == 0;
  });
  return unchanged;
}

std::optional<std::string> LibraryState::difference_in(bool (*is_chosen)(const Object&)) const {
  for (const auto& object : objects_) {
    if (!is_chosen(object)) continue;
    if (!std::ranges::all_of(object.segments, &Memory::is_unchanged))
      return fmt::format("static variables of {} changed", object.name);
    if (object.thread && !is_thread_unchanged(*object.thread))
      return fmt::format("thread-local variables of {} changed", object.name);
  }
  if (imports_.opens_libraries && foreign_loads() != loads_)
    return "it may have opened a library that its archive does not contain";
  return std::nullopt;
}

OwnLoad::OwnLoad() : before_(all_loads()) {}

OwnLoad::~OwnLoad() {
  own_loads += all_loads() - before_;
}

}  // namespace mebots::master
