// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fmi/process/process_functions.hpp"
#include "mebots/modeldesc/elf_library.hpp"

#include <link.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::master {

/// The functions that change process-wide data and that a list of libraries imports. They are read from ELF files.
struct LibraryImports {
  std::vector<const ProcessFunction*> functions;
  std::vector<std::string> unknown;  ///< names of needed libraries that are not in the FMU and not known to mebots
  bool opens_libraries = false;      ///< true if a library imports dlopen()
  ProcessReach reach = ProcessReach::nothing;

  /// Describes the imported functions, such as "it imports srand(), which changes random numbers"; nullopt if they do
  /// not change process-wide data.
  std::optional<std::string> reason() const;
};

/// A library exports this symbol if no instance depends on static memory that other instances or earlier steps have
/// changed. Its static memory may contain constants, data that all instances share, and the reference count of these
/// data.
inline constexpr std::string_view kKeepsNoState = "mebots_keeps_no_state_outside_instances";

/// Reads the imports of ELF files. A file that cannot be read counts as an unknown library.
LibraryImports read_imports(std::span<const std::filesystem::path> libraries);

/// Returns the ELF files of an unpacked FMU for this machine.
std::vector<std::filesystem::path> libraries_of(const std::filesystem::path& folder);

/// A copy of the memory of an FMU's libraries directly after loading. It contains all writable segments, and the
/// thread-local variables of the calling thread.
///
/// An FMU is clean if three conditions are met. Its libraries import no function that changes process-wide data. Its
/// static objects own no heap memory. After all instances were freed, the memory of its libraries is the same as
/// directly after loading. A run after clean FMUs starts like a run in a new process.
class LibraryState {
 public:
  /// Copies the memory of all loaded libraries in `folder`.
  explicit LibraryState(const std::filesystem::path& folder);

  const LibraryImports& imports() const { return imports_; }
  /// Describes static objects that own heap memory, such as "static objects of libgain.so.1 own memory, which a run may
  /// change". Returns nullopt if there are none, or if the library exports kKeepsNoState.
  const std::optional<std::string>& owned_memory() const { return owned_memory_; }
  /// Describes changed memory, such as "static variables of libgain.so.1 changed"; nullopt if no memory has changed. No
  /// instance may exist.
  std::optional<std::string> difference() const {
    return difference_in([](const Object&) { return true; });
  }
  /// Describes changed memory like difference(), but ignores libraries that export kKeepsNoState. Instances may exist.
  std::optional<std::string> difference_while_used() const {
    return difference_in([](const Object& object) { return !object.keeps_no_state; });
  }

 private:
  /// A copy of memory without its trailing zeros.
  struct Memory {
    std::uintptr_t address = 0;
    std::size_t size = 0;
    std::vector<std::byte> bytes;

    bool is_unchanged() const;
  };
  /// Thread-local variables. `fresh` is their content in a thread that has not used them.
  struct ThreadMemory {
    std::uintptr_t library = 0;  ///< load address of the library
    std::vector<std::byte> fresh;
  };
  struct Object {
    std::string name;
    bool keeps_no_state = false;
    std::vector<Memory> segments;
    std::optional<ThreadMemory> thread;
  };

  std::optional<std::string> difference_in(bool (*is_chosen)(const Object&)) const;
  class OwnedMemory;
  void add(const dl_phdr_info& info, const OwnedMemory& owned);
  static Object object_of(const dl_phdr_info& info);
  static Memory memory_at(std::uintptr_t address, std::size_t size);
  bool is_thread_unchanged(const ThreadMemory& memory) const;

  std::vector<Object> objects_;
  LibraryImports imports_;
  std::optional<std::string> owned_memory_;
  std::uint64_t loads_ = 0;
};

/// Must exist while mebots itself loads a library. Counts these libraries to distinguish them from those that FMUs
/// load.
class OwnLoad {
 public:
  OwnLoad();
  ~OwnLoad();
  OwnLoad(const OwnLoad&) = delete;
  OwnLoad& operator=(const OwnLoad&) = delete;

 private:
  std::uint64_t before_;
};

/// A library that this process would load together with an FMU.
struct NewLibrary {
  std::filesystem::path file;
  modeldesc::ElfLibrary elf;
};

/// The libraries and symbols that an FMU contains and needs, read from its ELF files.
struct LibraryNeeds {
  std::vector<NewLibrary> libraries;  ///< the FMU's own library is the first
  /// Files of the FMU; the key is the name by which the loader finds a library.
  std::map<std::string, std::filesystem::path> brought;
  std::set<std::string> names;             ///< names of all directly and indirectly needed libraries
  std::set<std::filesystem::path> shared;  ///< needed files that this process has already loaded
  bool loads_libraries = false;            ///< true if the FMU imports dlopen and may load any of its ELF files
  std::string interpreter;                 ///< "a Python interpreter" if the FMU contains one; otherwise empty

  /// Returns those of `texts` that occur in files of the FMU. A library that is loaded by name occurs in these files.
  std::set<std::string_view> mentioned(const std::vector<std::string_view>& texts) const;
};

/// Reads the library in `file` and all libraries that it needs. `folder` contains the unpacked FMU. `loaded` contains
/// the libraries of this process. Throws Error if a file is not a library.
LibraryNeeds read_library_needs(const std::filesystem::path& file, const std::filesystem::path& folder,
                                const std::vector<modeldesc::LoadedLibrary>& loaded);

/// True if `name` is the SONAME or file name of the library.
bool has_name(const modeldesc::LoadedLibrary& library, const std::string& name);

/// True for a part of the C library, which every process loads only once.
bool is_c_library(std::string_view name);

class Fmu;

struct Admission {
  bool loaded = false;
  bool certain = false;  ///< if it shared the process, it or another FMU would use a library or variable of another
                         ///< archive
  std::string reason;    ///< completes the sentence "b.fmu runs in its own process: ..."
};

enum class Risk { refuse, accept };

/// Loads an FMU's library into this process, unless it would share libraries or symbols with the program or with other
/// FMUs. Compares the ELF files of the FMU with the libraries of this process. If `risk` is Risk::accept, loads the
/// library unless the sharing is certain (Admission::certain). Throws InputError if the library cannot be loaded at
/// all. May be called from any thread.
Admission load_into_this_process(const std::shared_ptr<Fmu>& fmu, Risk risk);

}  // namespace mebots::master
