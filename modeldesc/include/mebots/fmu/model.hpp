// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/state/visitor.hpp"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

/// The interface between an FMU's binding (`fmu.cpp`) and the FMI shell.
namespace mebots::fmu {

enum class Severity { info, warning, error };

/// The services of the shell that a model may use. Each instance has one object.
class Host {
 public:
  virtual ~Host() = default;
  /// Returns the resources folder of the unpacked archive.
  virtual const std::filesystem::path& resources() const = 0;
  /// Sends a message to the importing tool. `category` is one of the description's log categories.
  virtual void log(Severity severity, std::string_view category, std::string_view message) = 0;
};

/// The model of an initialised instance. It exists from the end of initialisation until the instance is reset or freed.
/// It reads parameters and inputs from the Variables that its constructor got, and writes outputs into them. Throws
/// mebots::Error for everything that a user can correct.
class Model {
 public:
  virtual ~Model() = default;
  /// Advances from start_ns to start_ns + duration_ns (> 0) with constant inputs.
  virtual void step(std::int64_t start_ns, std::int64_t duration_ns) = 0;
  /// Called once when the tool terminates the instance, for a last message to the log.
  virtual void terminate() {}
  /// Visits all state that is not in Variables. A saved state consists of these values. See mebots/state/visitor.hpp.
  virtual void visit(state::Visitor& v) = 0;
  /// Returns the text of an `on_demand` String output, by its FMI name.
  virtual std::string on_demand_text(std::string_view /*name*/) const { return {}; }
};

/// Builds the tables that all instances of the FMU share. The function is optional; the shell calls it before the first
/// instance is created. So after a mission, the library's memory is the same as before the first instance, and the next
/// mission of a study can run in the same process.
[[gnu::weak]] void prepare_shared_tables();

}  // namespace mebots::fmu
