// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/state/visitor.hpp"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

namespace mebots::fmu {

enum class Severity { info, warning, error };

/// The services that the FMI shell (modeldesc/shell) offers to the model of an FMU (`fmu.cpp`). Each instance has its
/// own Host.
class Host {
 public:
  virtual ~Host() = default;
  /// Returns the resources folder of the unpacked archive.
  virtual const std::filesystem::path& resources() const = 0;
  /// Sends a message to the importing tool. `category` is one of the description's log categories.
  virtual void log(Severity severity, std::string_view category, std::string_view message) = 0;
};

/// The behaviour of an initialised instance. A model exists from the end of initialisation until the instance is reset
/// or freed. Its constructor receives the instance's Variables: the model reads parameters and inputs from them and
/// writes outputs into them. A model throws mebots::Error for errors that a user can correct.
class Model {
 public:
  virtual ~Model() = default;
  /// Advances from start_ns to start_ns + duration_ns. duration_ns is positive. The inputs are constant during the
  /// step.
  virtual void step(std::int64_t start_ns, std::int64_t duration_ns) = 0;
  /// Called once, when the importing tool terminates the instance. The model may log a last message.
  virtual void terminate() {}
  /// Visits the state of the model that is not in Variables. A saved state contains the visited values. See
  /// mebots/state/visitor.hpp.
  virtual void visit(state::Visitor& v) = 0;
  /// Returns the value of the `on_demand` String output with this FMI name.
  virtual std::string on_demand_text(std::string_view /*name*/) const { return {}; }
};

/// Builds the tables that all instances of the FMU share. Defining this function is optional. The FMI shell calls it
/// before it creates the first instance, so that the library's memory does not change during a mission. The next
/// mission of a study can then run in the same process.
[[gnu::weak]] void prepare_shared_tables();

}  // namespace mebots::fmu
