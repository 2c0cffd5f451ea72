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

/// An FMU archive unpacked into a folder of its own, which goes with this object: description at once,
/// shared library when first asked for. The library's code goes too, unless a thread may still run in it.
class Fmu {
 public:
  /// `wish` is the kind of its instances; if absent, co-simulation if the FMU offers it. Throws InputError for anything
  /// that is not an FMU of version 1.0, 2.0 or 3.0.
  explicit Fmu(std::filesystem::path archive, std::optional<FmuKind> wish = {});
  /// One that another process has unpacked into `folder`, and will remove.
  Fmu(std::filesystem::path archive, std::filesystem::path folder);
  ~Fmu();
  Fmu(const Fmu&) = delete;
  Fmu& operator=(const Fmu&) = delete;

  const std::filesystem::path& archive() const { return archive_; }
  /// Where it is unpacked.
  const std::filesystem::path& folder() const { return folder_; }
  const modeldesc::ModelDescription& description() const { return description_; }
  /// Notices for the user about the archive.
  const std::vector<std::string>& notices() const { return notices_; }
  /// The description with each array of FMI 3.0 replaced by its elements, for these values of structural parameters.
  /// The same object for the same values, for as long as anybody keeps it. Must not outlive the FMU.
  std::shared_ptr<const modeldesc::ModelDescription> model(const modeldesc::StructuralValues& values = {});
  /// Loads the shared library; no effect the second time. Throws InputError naming the library or function that is
  /// missing.
  void require_library();
  /// The functions of the FMU's library. `Functions` is the table of its version. As require_library().
  template <typename Functions>
  const Functions& functions() {
    require_library();
    return std::get<Functions>(functions_);
  }
  /// The kind of its instances. Throws InputError if the FMU does not offer the wished one.
  FmuKind kind() const;
  /// The shared library for this platform, whether it is there or not.
  std::filesystem::path library_file() const;
  bool is_loaded() const { return library_ != nullptr; }
  /// Unloads the shared library, for good; the destructor does it otherwise. No instance may live. Throws InputError
  /// for an exception that the library throws.
  void unload();
  /// The shared library stays loaded until the process ends.
  void keep_loaded() { kept_loaded_ = true; }
  /// After a fatal status no instance of this FMU may be called any more.
  bool corrupted() const { return corrupted_; }
  void set_corrupted() { corrupted_ = true; }
  /// What loading the library changed in this process, as ProcessState has it; to whoever asks first.
  std::vector<std::string> take_changes_at_load() { return std::exchange(changes_at_load_, {}); }
  /// The descriptors that were open before its library was loaded: it may close any other.
  const OpenFiles& files_of_others() const { return files_of_others_; }
  /// An instance begins. True for the first of them, whose calls are watched one by one for changes of the process: a
  /// look costs as much as a thousand small calls. From any thread.
  bool enter() {
    ++instances_;
    return watched_++ < kMostWatched;
  }
  /// An instance is gone. The number of threads that were started since its library was loaded and still run, when it
  /// was the last one; else 0. From any thread.
  std::size_t leave() { return --instances_ == 0 ? threads_left() : 0; }
  /// The functions by which its libraries change the process, read from their files.
  const LibraryImports& imports();
  /// Why it is not clean, as far as its libraries show before the first instance; nothing if they look clean.
  std::optional<std::string> uncleanliness();
  /// True once an instance was made in this process.
  bool used() const { return watched_ != 0; }
  /// Why the next instance would not find the libraries as directly after they were loaded; nothing if it would. No
  /// instance may live.
  std::optional<std::string> difference() const;
  /// Why the state of an instance is not all that the FMU computes with; nothing if it is.
  std::optional<std::string> state_elsewhere();
  /// Notes what difference() or state_elsewhere() returned in the process where the FMU runs.
  void set_difference_elsewhere(std::string text);

  /// What loading the library made of the thread's floating-point environment, which was put back; nothing where it
  /// left it alone.
  const std::optional<FloatEnvironment>& floats_at_load() const { return floats_at_load_; }
  /// Whether nobody told of this FMU's floating-point environment before. From any thread.
  bool first_to_tell_of_floats() { return !told_of_floats_.exchange(true); }
  /// Where the FMU finds its files, as fmi2Instantiate wants it: a `file:///` URI.
  std::string resource_uri() const;
  /// The folder where the FMU is unpacked, as fmiInstantiateSlave (FMI 1.0) wants it: a `file:///` URI.
  std::string location_uri() const;
  /// The same as fmi3Instantiate... wants it: a path that ends with a separator; empty if the FMU has no such folder.
  std::string resource_path() const;

 private:
  static constexpr int kMostWatched = 32;

  void load();
  std::size_t threads_left() const;

  std::filesystem::path archive_;
  std::optional<FmuKind> wish_;
  std::unique_ptr<UnpackFolder> own_folder_;  // null when another process unpacked it
  std::filesystem::path folder_;
  std::vector<std::string> notices_;  // before the description, whose reading fills them
  modeldesc::ModelDescription description_;
  void* library_ = nullptr;
  bool kept_loaded_ = false;
  bool corrupted_ = false;
  std::vector<std::string> changes_at_load_;
  OpenFiles files_of_others_;
  std::set<pid_t> threads_of_others_;
  std::atomic<int> instances_{0};
  std::atomic<int> watched_{0};  // instances so far, the gone ones too
  std::optional<FloatEnvironment> floats_at_load_;
  std::optional<LibraryState> at_load_;    // of libraries that are loaded
  std::optional<LibraryImports> imports_;  // of libraries that are not
  mutable std::mutex elsewhere_mutex_;
  std::string difference_elsewhere_;
  std::atomic<bool> told_of_floats_{false};
  FmuFunctions functions_;  // empty: not loaded
  std::mutex models_mutex_;
  std::map<modeldesc::StructuralValues, std::weak_ptr<const modeldesc::ModelDescription>> models_;
};

/// Opens each archive once, however many instances come from it, in however many runs one after the other.
class FmuLibrary {
 public:
  /// As it was when it was opened first, whatever became of the file since; anew after a fatal status. The two kinds of
  /// one archive may have different libraries, so they are two FMUs.
  std::shared_ptr<Fmu> open(const std::filesystem::path& archive, std::optional<FmuKind> wish = {});
  /// Forgets the FMUs that were used and are not clean: open() unpacks and loads them again.
  void forget_changed();

 private:
  std::map<std::pair<std::filesystem::path, std::optional<FmuKind>>, std::shared_ptr<Fmu>> fmus_;
};

/// A path as a `file:///` URI, everything unusual percent-encoded.
std::string file_uri(const std::filesystem::path& path);

}  // namespace mebots::master
