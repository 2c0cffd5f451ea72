// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace mebots::master {

/// A copy of the process's environment variables.
class EnvironmentVariables {
 public:
  static EnvironmentVariables now();

  /// Sets the process's variables to those of this copy. Returns one text per difference that it undid:
  /// "environment variable TZ became 'UTC' (put back)". Costs a comparison if nothing differs.
  std::vector<std::string> restore() const;

 private:
  struct Entry {
    const char* place;  // in the environment; never read
    std::string text;   // NAME=value
  };
  std::vector<Entry> entries_;
};

}  // namespace mebots::master
