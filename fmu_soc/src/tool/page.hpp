// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/page_file.hpp"
#include "observe/session.hpp"
#include "observe/text_file.hpp"
#include "tool/power_course.hpp"
#include "tool/report.hpp"

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace mebots::soc::tool {

/// Owns a file in the folder for temporary files. The destructor deletes the file.
class ScratchFile {
 public:
  /// `ending` is the end of the file name, such as .json. Throws Error if the file cannot be created.
  explicit ScratchFile(std::string_view ending);
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;
  ~ScratchFile();
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

/// Writes the page of a run: energy of each part, counts, functions, and power over time. It uses the page of `mebots
/// report` and shows the chip in place of a system.
class RunPage {
 public:
  /// Throws Error if the file cannot be written, or if this installation has no pages. `profile` is the file of the
  /// profile that the user has requested, if any.
  RunPage(const std::string& path, const std::optional<std::string>& profile);

  /// Returns the path at which the profile must be written, in speedscope's format.
  const std::string& profile() const { return profile_ ? *profile_ : scratch_->path(); }

  /// Starts to record the chip, which must outlive the page.
  void follow(const Soc& soc, observe::Session& session);
  /// Adds a line that the program has printed to the page.
  void printed(std::string_view line);
  /// Adds a byte that the program has sent to a serial port.
  void sent(char byte);
  /// Writes the page. `outcome` describes how the program ended. The profile must be complete.
  void write(const ChipReport& report, const std::string& program, const std::string& outcome);

 private:
  PageParts parts_;
  observe::TextFile file_;
  std::optional<std::string> profile_;
  std::optional<ScratchFile> scratch_;
  const Soc* soc_ = nullptr;
  std::optional<PowerCourse> course_;
  std::string log_;
  std::string sent_;  // last line from the serial port, which is not complete yet
  std::size_t lines_ = 0;
};

}  // namespace mebots::soc::tool
