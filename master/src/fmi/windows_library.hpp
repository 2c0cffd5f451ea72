// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fmi/fmu_functions.hpp"

#include <filesystem>
#include <memory>
#include <string>

namespace mebots::master::windows {

class Process;

/// An FMU's library for Windows, which runs in mebots-windows-host.exe under wine. Its functions() forward each call.
/// If its process ends, this process ends in the same way: by the signal that Linux sends for the structured exception,
/// or with the same exit code. So the master reports it like the end of an FMU for Linux. A process can have at most
/// one such library.
class WindowsLibrary {
 public:
  /// Starts wine, which keeps its settings in `settings`, a new folder, and loads the library. Throws InputError if the
  /// library cannot be loaded.
  WindowsLibrary(const LibraryOwner& owner, const std::filesystem::path& library,
                 const std::filesystem::path& settings);
  /// Unloads the library and waits for the process.
  ~WindowsLibrary();
  WindowsLibrary(const WindowsLibrary&) = delete;
  WindowsLibrary& operator=(const WindowsLibrary&) = delete;

  /// Returns the functions that the library exports; others are null.
  FmuFunctions functions() const { return functions_; }

 private:
  std::unique_ptr<Process> process_;
  FmuFunctions functions_;
};

}  // namespace mebots::master::windows
