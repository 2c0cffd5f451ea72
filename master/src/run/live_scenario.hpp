// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::master {

inline constexpr std::string_view kLiveScenarioFile = "live_scenario.json";

/// The values that a user sets on the live page. The results folder stores them as a scenario file, which can repeat
/// the run. A resumed run sets the values after its checkpoint again.
class LiveScenario {
 public:
  struct Entry {
    std::string variable;
    double value = 0;
  };

  explicit LiveScenario(const std::filesystem::path& folder) : file_(folder / kLiveScenarioFile) {}

  /// Reads the file that the earlier process of this run wrote. The run resumes at `time_ns`. Skips earlier values,
  /// because the checkpoint contains their effects. Throws InputError if the file is invalid.
  void resume(std::int64_t time_ns);
  /// Adds a value and writes the file. Throws Error if writing fails.
  void add(std::string_view variable, const nlohmann::ordered_json& value, std::int64_t time_ns);
  /// True if due() has not yet returned all values that must be set again.
  bool is_pending() const { return done_ < entries_.size(); }
  /// Returns the values that must be set again at or before `time_ns`. Returns each value only once.
  std::vector<Entry> due(std::int64_t time_ns);

 private:
  std::filesystem::path file_;
  nlohmann::ordered_json entries_ = nlohmann::ordered_json::array();  // by time
  std::size_t done_ = 0;  // number of entries that this run has set or its checkpoint contains
};

}  // namespace mebots::master
