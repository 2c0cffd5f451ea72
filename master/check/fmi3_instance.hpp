// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fmi3_probes.hpp"

#include "mebots/error.hpp"
#include "mebots/fmi3/functions.hpp"

#include <dlfcn.h>

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace mebots::check {

/// Thrown if the FMU rejects a call that it must accept.
class Fmi3Refused : public Error {
 public:
  using Error::Error;
};

/// The loaded library of an FMU. Must be used only in a child process.
class Fmi3Library {
 public:
  /// Throws Fmi3Refused if the library cannot be loaded.
  Fmi3Library(const Fmi3Target& target, Witness& witness);

  const Fmi3Target& target() const { return target_; }
  Witness& witness() const { return witness_; }
  /// Returns the function with this name. Throws Fmi3Refused if the library lacks the function.
  template <typename Function>
  Function* find(const char* name) const {
    return reinterpret_cast<Function*>(address(name));
  }
  /// Step size and start time of a run [s].
  double step_s() const { return step_s_; }
  double start_s() const { return start_s_; }

 private:
  void* address(const char* name) const;

  const Fmi3Target& target_;
  Witness& witness_;
  void* handle_;
  double step_s_;
  double start_s_;
};

struct Fmi3Value {
  const Fmi3Declared* variable;
  std::string bytes;
};
using Fmi3Values = std::vector<Fmi3Value>;

/// An instance of the FMU, which the destructor frees. Reports each call to the witness, so that a crash report can
/// name it.
class Fmi3Instance {
 public:
  /// Creates an instance for co-simulation. Throws Fmi3Refused if instantiation fails.
  Fmi3Instance(const Fmi3Library& library, const char* name);
  ~Fmi3Instance();
  Fmi3Instance(const Fmi3Instance&) = delete;
  Fmi3Instance& operator=(const Fmi3Instance&) = delete;

  /// Calls a function with this instance as first argument. Throws Fmi3Refused unless it returns fmi3OK or fmi3Warning.
  template <typename Function, typename... Arguments>
  void call(const char* name, Arguments... arguments) {
    library_.witness().doing(name);
    require(name, library_.find<Function>(name)(handle_, arguments...));
  }
  void require(std::string_view name, fmi3Status status) const;

  void enter_initialization();
  void exit_initialization();
  /// Enters and exits initialization mode.
  void start();
  /// Performs the steps from `first` to `last` - 1, counted from 0.
  void run(int first, int last);
  void step(double time_s, double step_s);
  /// True if the FMU requested the end of the run in its last step.
  bool ended() const { return ended_; }
  /// Get and set numbers or Booleans. Integers are exact up to 2^53. Throw Error if the variable's type cannot
  /// represent a value.
  void set_numbers(const Fmi3Declared& variable, std::span<const double> values);
  std::vector<double> get_numbers(const Fmi3Declared& variable);
  /// Returns the values of all outputs except clocked outputs.
  Fmi3Values outputs();
  std::string serialized();
  void restore(const std::string& bytes);
  void reset();
  void terminate();

 private:
  std::string read(const Fmi3Declared& variable);
  static void log(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String category, fmi3String message);

  const Fmi3Library& library_;
  fmi3Instance handle_ = nullptr;
  bool ended_ = false;
  std::string last_message_;
};

#define MEBOTS_CALL(instance, function, ...) (instance).call<decltype(function)>(#function __VA_OPT__(, ) __VA_ARGS__)

}  // namespace mebots::check
