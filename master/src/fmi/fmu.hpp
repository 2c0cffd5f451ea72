// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fmi/call/foreign_call.hpp"
#include "fmi/fmu_functions.hpp"
#include "fmi/library_state.hpp"
#include "fmi/process/process_state.hpp"
#include "fmi/unpack_folder.hpp"
#include "mebots/modeldesc/array_elements.hpp"
#include "mebots/modeldesc/model_description.hpp"
#include "model/fmu_kind.hpp"

#include <atomic>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace mebots::master {

namespace windows {
class WindowsLibrary;
}

/// An FMU that is unpacked into a temporary folder. The shared library is loaded when it is first needed. The
/// destructor deletes the folder and unloads the library. It does not unload the library if a thread may still execute
/// its code.
class Fmu {
 public:
  /// Opens and unpacks an archive. If `wish` is empty, the kind is co-simulation or, if the FMU does not offer it,
  /// model exchange. Throws InputError if the file is not an FMU of FMI 1.0, 2.0 or 3.0.
  explicit Fmu(std::filesystem::path archive, std::optional<FmuKind> wish = {});
  /// Opens an FMU that another process has unpacked into `folder` and will delete.
  Fmu(std::filesystem::path archive, std::filesystem::path folder, std::optional<FmuKind> wish = {});
  ~Fmu();
  Fmu(const Fmu&) = delete;
  Fmu& operator=(const Fmu&) = delete;

  const std::filesystem::path& archive() const { return archive_; }
  const std::filesystem::path& folder() const { return folder_; }
  const modeldesc::ModelDescription& description() const { return description_; }
  /// Returns notices about the archive for the user.
  const std::vector<std::string>& notices() const { return notices_; }
  /// Returns the description of the FMU with these values of structural parameters. Each array (FMI 3.0) is replaced by
  /// its elements. Calls with the same values return the same object while it is in use. The result must not outlive
  /// the FMU.
  std::shared_ptr<const modeldesc::ModelDescription> model(const modeldesc::StructuralValues& values = {});
  /// Loads the shared library if it is not loaded. Throws InputError with the name of a missing library or function.
  void require_library();
  /// Returns the functions of the shared library, and loads it if necessary. `Functions` must match the FMU's version
  /// of FMI. Throws like require_library().
  template <typename Functions>
  const Functions& functions() {
    require_library();
    return std::get<Functions>(functions_);
  }
  /// Returns the kind of the FMU's instances. Throws InputError if the FMU does not offer the requested kind.
  FmuKind kind() const;
  /// Returns the path of the shared library for this platform. The file need not exist.
  std::filesystem::path library_file() const;
  /// True if the FMU has a library for 64-bit Windows and no library for this platform.
  bool is_for_windows_alone() const;
  /// True if the FMU is only for Windows and wine is available. Its library is loaded in a separate process.
  bool runs_under_wine() const;
  bool is_loaded() const { return library_ != nullptr || windows_library_ != nullptr; }
  /// Returns the `link_map` of the shared library; null if it is not loaded.
  const void* library() const { return library_; }
  /// Unloads the shared library before the destructor does. No instance may exist. Throws InputError if the library
  /// throws an exception.
  void unload();
  void keep_loaded() { kept_loaded_ = true; }
  /// True after an instance has returned the status fatal. No instance of this FMU may then be called.
  bool corrupted() const { return corrupted_; }
  void set_corrupted() { corrupted_ = true; }
  /// Returns the process-wide changes that the loading of the library caused. Further calls return an empty list.
  std::vector<std::string> take_changes_at_load() { return std::exchange(changes_at_load_, {}); }
  /// Returns the file descriptors that were open before the library was loaded. The FMU must not close them.
  const OpenFiles& files_of_others() const { return files_of_others_; }
  /// Counts a new instance. Returns true if calls to this instance must be checked for process-wide changes. Only the
  /// first few instances are checked, because a check takes as long as a thousand small calls. May be called from any
  /// thread.
  bool enter() {
    ++instances_;
    return watched_++ < kMostWatched;
  }
  /// Counts a freed instance. After the last one, returns the number of running threads that were started since the
  /// library was loaded; otherwise 0. May be called from any thread.
  std::size_t leave() { return --instances_ == 0 ? threads_left() : 0; }
  /// Returns the imported functions that change process-wide data, read from the files of the libraries.
  const LibraryImports& imports();
  /// Returns the reason why the FMU is not clean (see LibraryState) if it is known before the first instance exists: an
  /// imported function, or a static object that owns memory. Otherwise, returns nullopt.
  std::optional<std::string> uncleanliness();
  /// True if an instance was ever created in this process.
  bool used() const { return watched_ != 0; }
  /// Describes the difference between the memory of the libraries now and directly after loading; nullopt if there is
  /// none. No instance may exist.
  std::optional<std::string> difference() const;
  /// Returns the reason why the FMU computes with data outside of its instances' states; nullopt if it does not.
  std::optional<std::string> state_elsewhere();
  /// Sets the text that difference() returns. The text comes from the separate process in which the FMU runs.
  void set_difference_elsewhere(std::string text);

  /// Returns the floating-point environment that the library set while it was loaded; nullopt if it changed nothing.
  /// The environment of the thread was then restored.
  const std::optional<FloatEnvironment>& floats_at_load() const { return floats_at_load_; }
  /// Returns true on the first call. The caller must then report the floating-point environment of the FMU. May be
  /// called from any thread.
  bool claim_float_report() { return !floats_reported_.exchange(true); }
  /// Returns the `file:///` URI of the folder `resources`, for fmi2Instantiate.
  std::string resource_uri() const;
  /// Returns the `file:///` URI of the unpacked FMU, for fmiInstantiateSlave (FMI 1.0).
  std::string location_uri() const;
  /// Returns the path of the folder `resources` with a separator at the end, for FMI 3.0; an empty text if there is no
  /// such folder.
  std::string resource_path() const;

 private:
  static constexpr int kMostWatched = 32;

  void load();
  void load_under_wine();
  std::filesystem::path windows_library_file() const;
  std::size_t threads_left() const;

  std::filesystem::path archive_;
  std::optional<FmuKind> wish_;
  std::unique_ptr<UnpackFolder> own_folder_;  // null if another process has unpacked the FMU
  std::filesystem::path folder_;
  // Must be initialised before description_, because reading the description adds notices.
  std::vector<std::string> notices_;
  modeldesc::ModelDescription description_;
  void* library_ = nullptr;
  bool kept_loaded_ = false;
  bool corrupted_ = false;
  std::vector<std::string> changes_at_load_;
  OpenFiles files_of_others_;
  std::set<pid_t> threads_of_others_;
  std::atomic<int> instances_{0};
  std::atomic<int> watched_{0};  // number of all instances, including freed ones
  std::optional<FloatEnvironment> floats_at_load_;
  std::optional<LibraryState> at_load_;    // state of the libraries directly after loading
  std::optional<LibraryImports> imports_;  // imports of libraries that are not loaded
  mutable std::mutex elsewhere_mutex_;
  std::string difference_elsewhere_;
  std::atomic<bool> floats_reported_{false};
  FmuFunctions functions_;  // empty if the library is not loaded
  std::mutex models_mutex_;
  std::map<modeldesc::StructuralValues, std::weak_ptr<const modeldesc::ModelDescription>> models_;
  std::unique_ptr<windows::WindowsLibrary> windows_library_;  // replaces library_ if wine runs the FMU
};

/// Opens each archive once for all its instances and for all runs.
class FmuLibrary {
 public:
  /// Returns the FMU of an archive. Its content is that of the first call, even if the file has changed. After a fatal
  /// status, opens the archive again. Each kind of simulation has its own Fmu, because its library may differ.
  std::shared_ptr<Fmu> open(const std::filesystem::path& archive, std::optional<FmuKind> wish = {});
  /// Removes the FMUs that were used and are not clean. open() then unpacks and loads such an FMU again.
  void forget_changed();

 private:
  std::map<std::pair<std::filesystem::path, std::optional<FmuKind>>, std::shared_ptr<Fmu>> fmus_;
};

/// Returns the `file:///` URI of a path. Special characters are percent-encoded.
std::string file_uri(const std::filesystem::path& path);

}  // namespace mebots::master
