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

/// Owns a temporary file, which the destructor deletes.
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

/// Writes the page of a run: energy of each part, counts, functions, and power over time. The page is that of `mebots
/// report`, and shows the chip in place of a system.
class RunPage {
 public:
  /// `profile` is the path of the profile that the user has requested, if any. Throws Error if the page cannot be
  /// written, or if this installation lacks the files of the page.
  RunPage(const std::string& path, const std::optional<std::string>& profile);

  /// Returns the path at which the profile must be written, in speedscope's format.
  const std::string& profile() const { return profile_ ? *profile_ : scratch_->path(); }

  /// Starts to record the chip, which must outlive the page.
  void follow(const Soc& soc, observe::Session& session);
  /// Adds a line of the program's output to the page.
  void printed(std::string_view line);
  /// Adds a byte of the program's serial output to the page.
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
  std::string sent_;  // last line of the serial output, not complete yet
  std::size_t lines_ = 0;
};

}  // namespace mebots::soc::tool
