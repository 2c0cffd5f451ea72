// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/state/visitor.hpp"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

/// Defines the interface between the code of an FMU (`fmu.cpp`) and the FMI shell (modeldesc/shell).
namespace mebots::fmu {

enum class Severity { info, warning, error };

/// Offers the services of the FMI shell to a model. Each instance has its own Host.
class Host {
 public:
  virtual ~Host() = default;
  /// Returns the resources folder of the unpacked archive.
  virtual const std::filesystem::path& resources() const = 0;
  /// Sends a message to the importing tool. `category` is one of the description's log categories.
  virtual void log(Severity severity, std::string_view category, std::string_view message) = 0;
};

/// Implements the behaviour of an initialised instance. A model exists from the end of initialisation until the
/// instance is reset or freed. A model reads parameters and inputs from the Variables that were passed to its
/// constructor, and writes outputs into them. A model throws mebots::Error for errors that a user can correct.
class Model {
 public:
  virtual ~Model() = default;
  /// Advances from start_ns to start_ns + duration_ns, where duration_ns > 0. The inputs are constant during the step.
  virtual void step(std::int64_t start_ns, std::int64_t duration_ns) = 0;
  /// Ends the simulation of this instance, for example with a last message to the log. The FMI shell calls it once,
  /// when the importing tool terminates the instance.
  virtual void terminate() {}
  /// Visits all state that is not in Variables. A saved state consists of these values. See mebots/state/visitor.hpp.
  virtual void visit(state::Visitor& v) = 0;
  /// Returns the value of an `on_demand` String output. `name` is the FMI name of the output.
  virtual std::string on_demand_text(std::string_view /*name*/) const { return {}; }
};

/// Builds the tables that all instances of the FMU share. The function is optional. The FMI shell calls it before the
/// first instance is created. Therefore the tables do not change the library's memory during a mission, and the next
/// mission of a study can run in the same process.
[[gnu::weak]] void prepare_shared_tables();

}  // namespace mebots::fmu
