// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/state/visitor.hpp"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

/// What an FMU's binding (`fmu.cpp`) and the FMI shell know of each other.
namespace mebots::fmu {

enum class Severity { info, warning, error };

/// The surroundings of one instance, as its model may use them.
class Host {
 public:
  virtual ~Host() = default;
  /// The unpacked archive's resources folder.
  virtual const std::filesystem::path& resources() const = 0;
  /// A message to the importing tool; `category` is one of the description's log categories.
  virtual void log(Severity severity, std::string_view category, std::string_view message) = 0;
};

/// One initialised instance: exists from the end of initialisation until reset or free.
/// It reads parameters and inputs from, and writes outputs to, the Variables that made it.
/// Throws mebots::Error for everything that a user can mend.
class Model {
 public:
  virtual ~Model() = default;
  /// Goes from start_ns to start_ns + duration_ns (> 0) with the inputs held.
  virtual void step(std::int64_t start_ns, std::int64_t duration_ns) = 0;
  /// Shows everything that is not in Variables: what states consist of, see mebots/state/visitor.hpp.
  virtual void visit(state::Visitor& v) = 0;
  /// Text of an `on_demand` String output, by its FMI name.
  virtual std::string on_demand_text(std::string_view /*name*/) const { return {}; }
};

/// Builds the tables that all instances of the FMU share. An FMU that has none does not define it. The shell calls it
/// before the first instance: a library whose memory is after a mission as it was before the first instance can run
/// the next mission of a study in the same process.
[[gnu::weak]] void prepare_shared_tables();

}  // namespace mebots::fmu
