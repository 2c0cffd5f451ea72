// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "run/run.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace mebots::app {

enum class JunitOutcome { passed, failure, error };

/// A test case of a JUnit file, which CI systems read.
struct JunitCase {
  std::string name;
  JunitOutcome outcome = JunitOutcome::passed;
  std::string message;  ///< reason why the case did not pass; empty if it passed
  double time_s = 0;
  std::string out;  ///< text of the element system-out; optional
};

/// Writes a JUnit file with one suite `classname`. Throws Error if the file cannot be written.
void write_junit(const std::filesystem::path& file, const std::string& classname, const std::vector<JunitCase>& cases);

/// Writes a JUnit file with the run as one test case. An outcome in `expected` passes; if `expected` is empty, every
/// outcome passes. Any other outcome, or an interrupt, is a failure. If `error` is not empty, the case has an error.
/// `run` is null if the run could not be opened. Throws Error if the file cannot be written.
void write_junit(const std::filesystem::path& file, const master::Run* run, const std::vector<std::string>& expected,
                 const std::string& error);

}  // namespace mebots::app
