// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "run/run.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace mebots::app {

enum class JunitOutcome { passed, failure, error };

/// A test case in a JUnit file, which CI systems read.
struct JunitCase {
  std::string name;
  JunitOutcome outcome = JunitOutcome::passed;
  std::string message;  ///< why it did not pass; empty if it passed
  double time_s = 0;
  std::string out;  ///< text of the element system-out; may be empty
};

/// Writes a JUnit file that contains one suite, named `classname`, with these cases. Throws Error if the file cannot be
/// written.
void write_junit(const std::filesystem::path& file, const std::string& classname, const std::vector<JunitCase>& cases);

/// Writes a JUnit file that contains the run as one test case. The test case passes if the run ended with one of the
/// `expected` outcomes, or if `expected` is empty. If the run had another outcome or was interrupted, the test case
/// fails. If `error` is not empty, the test case has an error. `run` is null if the run could not be opened. Throws
/// Error if the file cannot be written.
void write_junit(const std::filesystem::path& file, const master::Run* run, const std::vector<std::string>& expected,
                 const std::string& error);

}  // namespace mebots::app
