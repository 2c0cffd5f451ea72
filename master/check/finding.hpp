// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "platform_list.hpp"

#include <algorithm>
#include <cstddef>
#include <deque>
#include <string>
#include <string_view>
#include <vector>

/// Defines the findings of `mebots check` as plain data.
namespace mebots::check {

/// An error violates the standard or makes the FMU unusable; a warning describes a problem for some tools or users.
enum class Severity { error, warning };

/// The strictness of a check. Each level also reports the findings of the previous levels.
enum class Level {
  interoperable,  ///< problems that keep other tools from running the FMU, or that affect them
  standard,       ///< requirements of FMI
  pedantic        ///< good practice beyond FMI: rejection of illegal calls, hidden symbols, accuracy
};

/// The parts of a check. Checks run and are shown in this order.
enum class Group { archive, description, binaries, behaviour };

struct Finding {
  Group group = Group::archive;
  Severity severity = Severity::error;
  Level level = Level::standard;  ///< the lowest level at which the finding is reported
  std::string text;               ///< describes the problem and its place
  std::string way_out;            ///< describes the remedy
};

/// One checked property of an FMU, and its findings.
struct Check {
  Group group = Group::archive;
  Level level = Level::standard;  ///< the level of all findings that have no higher level of their own
  std::string name;     ///< a statement that is true if nothing was found, such as "reset equals a fresh instance"
  std::string skipped;  ///< why the property was not checked; empty if it was checked
  std::vector<Finding> findings;
};

struct Report {
  std::string fmu;
  std::string summary;  ///< "FMI 2.0 co-simulation, 54 variables"; empty if the description cannot be read
  Level level = Level::standard;
  std::size_t hidden_findings = 0;  ///< number of findings whose level is higher than `level`
  std::vector<PlatformNeeds> platforms;
  std::deque<Check> checks;  // a deque, because references to its elements must stay valid while other checks are added

  std::size_t count(Severity severity) const;
  bool clean() const { return count(Severity::error) == 0 && count(Severity::warning) == 0; }
};

std::string_view to_string(Severity severity);
std::string_view to_string(Group group);
std::string_view to_string(Level level);
/// Returns the names of the levels; the least strict level is first.
std::vector<std::string> level_names();
/// Returns the level with this name. Throws mebots::Error if no level has this name.
Level level_named(std::string_view name);

/// Adds findings to one check.
class Findings {
 public:
  Findings(Check& check) : check_(&check), level_(check.level) {}  // NOLINT(google-explicit-constructor)

  /// Returns a collector for the same check. Its level is the higher one of `level` and the current level.
  Findings at(Level level) const {
    Findings other = *this;
    other.level_ = std::max(level_, level);
    return other;
  }
  void error(std::string text, std::string way_out) { add(Severity::error, std::move(text), std::move(way_out)); }
  void warning(std::string text, std::string way_out) { add(Severity::warning, std::move(text), std::move(way_out)); }
  void add(Severity severity, std::string text, std::string way_out) {
    check_->findings.push_back({check_->group, severity, level_, std::move(text), std::move(way_out)});
  }
  bool any() const { return !check_->findings.empty(); }

 private:
  Check* check_;
  Level level_;
};

}  // namespace mebots::check
