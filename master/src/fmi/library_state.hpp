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

/// Contains those functions which a list of libraries imports and which change the process. They are read from the ELF
/// files of the libraries.
struct LibraryImports {
  std::vector<const ProcessFunction*> functions;
  std::vector<std::string> unknown;  ///< names of needed libraries that are neither in the FMU nor known to mebots
  bool opens_libraries = false;      ///< true if a library imports dlopen()
  ProcessReach reach = ProcessReach::nothing;

  /// Returns a text such as "it imports srand(), which changes random numbers". Returns nullopt if the libraries do not
  /// change the process.
  std::optional<std::string> reason() const;
};

/// The symbol with which a library declares that no instance depends on static memory which another instance or an
/// earlier step has changed. The static memory of such a library contains only constants, data that existing instances
/// share, and the reference count of these data.
inline constexpr std::string_view kKeepsNoState = "mebots_keeps_no_state_outside_instances";

/// Reads the imports from the ELF files. A file that cannot be read counts as an unknown needed library.
LibraryImports read_imports(std::span<const std::filesystem::path> libraries);

/// Returns those ELF files of an unpacked FMU that are built for this machine.
std::vector<std::filesystem::path> libraries_of(const std::filesystem::path& folder);

/// A copy of the memory of an FMU's libraries directly after loading. Contains all writable segments of the libraries,
/// and the calling thread's copy of their thread-local variables.
///
/// An FMU is clean if three conditions are met. Its libraries import no function that changes the process. Their static
/// objects own no heap memory. After all instances were freed, the libraries' memory is the same as directly after
/// loading. After a run with clean FMUs, the next run in the process starts as in a new process.
class LibraryState {
 public:
  /// Copies the memory of the loaded libraries of this folder.
  explicit LibraryState(const std::filesystem::path& folder);

  const LibraryImports& imports() const { return imports_; }
  /// Returns a text such as "static objects of libgain.so.1 own memory, which a run may change". Returns nullopt if
  /// static objects own no memory, or if the library exports kKeepsNoState.
  const std::optional<std::string>& owned_memory() const { return owned_memory_; }
  /// Returns a text such as "static variables of libgain.so.1 changed". Returns nullopt if all memory is unchanged. No
  /// instance may exist.
  std::optional<std::string> difference() const {
    return difference_in([](const Object&) { return true; });
  }
  /// Compares like difference(), but ignores libraries that export kKeepsNoState. Instances may exist.
  std::optional<std::string> difference_while_used() const {
    return difference_in([](const Object& object) { return !object.keeps_no_state; });
  }

 private:
  /// A copy of bytes without the zeros at their end.
  struct Memory {
    std::uintptr_t address = 0;
    std::size_t size = 0;
    std::vector<std::byte> bytes;

    bool is_unchanged() const;
  };
  /// Thread-local variables. In a thread that has not used them yet, they have the content of `fresh`.
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

/// Counts the libraries that mebots itself loads, so that they can be distinguished from those that FMUs load. Must
/// exist while mebots loads a library.
class OwnLoad {
 public:
  OwnLoad();
  ~OwnLoad();
  OwnLoad(const OwnLoad&) = delete;
  OwnLoad& operator=(const OwnLoad&) = delete;

 private:
  std::uint64_t before_;
};

/// A library that the process would additionally load if it loaded an FMU.
struct NewLibrary {
  std::filesystem::path file;
  modeldesc::ElfLibrary elf;
};

/// Lists the libraries and symbols that an FMU contains and needs. They are read from its ELF files.
struct LibraryNeeds {
  std::vector<NewLibrary> libraries;  ///< the FMU's own library is the first
  /// Maps the name by which the loader finds a library to its file.
  std::map<std::string, std::filesystem::path> brought;
  std::set<std::string> names;             ///< names of all needed libraries, including indirectly needed ones
  std::set<std::filesystem::path> shared;  ///< files that the FMU needs and that the process has already loaded
  bool loads_libraries = false;            ///< true if the FMU imports dlopen, so that all ELF files in the FMU count
  std::string interpreter;                 ///< "a Python interpreter" if the FMU embeds one; otherwise empty

  /// Returns those of `texts` that occur in files of the FMU. If an FMU loads a library by name, its files contain this
  /// name.
  std::set<std::string_view> mentioned(const std::vector<std::string_view>& texts) const;
};

/// Reads the library in `file` and all libraries that it needs. `folder` contains the unpacked FMU; `loaded` lists the
/// libraries that the process has loaded. Throws Error if a file is not a library.
LibraryNeeds read_library_needs(const std::filesystem::path& file, const std::filesystem::path& folder,
                                const std::vector<modeldesc::LoadedLibrary>& loaded);

/// True if the loader can find the library by this name, which is its SONAME or the name of its file.
bool has_name(const modeldesc::LoadedLibrary& library, const std::string& name);

/// True if the library is part of the C library, which every process loads exactly once.
bool is_c_library(std::string_view name);

class Fmu;

/// States whether an FMU's library was loaded into this process, and why not.
struct Admission {
  bool loaded = false;
  bool certain = false;  ///< if it shared the process, it or another FMU would use a library or variable of another
                         ///< archive
  std::string reason;    ///< completes the sentence "b.fmu runs in its own process: ..."
};

enum class Risk { refuse, accept };

/// Loads an FMU's library into this process. Does not load it if the FMU's ELF files show that it would share libraries
/// or symbols with the program or with other FMUs. The result depends on the libraries that the process has already
/// loaded. If `risk` is Risk::accept, sharing that is merely possible does not prevent loading: see Admission::certain.
/// Throws InputError if the library cannot be loaded at all. May be called from any thread.
Admission load_into_this_process(const std::shared_ptr<Fmu>& fmu, Risk risk);

}  // namespace mebots::master
