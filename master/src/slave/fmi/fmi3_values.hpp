// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/value_kind.hpp"
#include "slave/fmi/instance_calls.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

namespace mebots::master {

/// Gets and sets the variables of an FMI 3.0 instance. The master has one value reference for each element of an array,
/// but FMI 3.0 gets and sets whole arrays. The function calls for a list of value references are cached, because the
/// same lists occur at every communication point.
class Fmi3Values {
 public:
  /// In `model`, arrays must be replaced by their elements (see modeldesc::with_elements()). All arguments must outlive
  /// this object.
  Fmi3Values(InstanceCalls& calls, const Fmi3Functions& functions, const modeldesc::ModelDescription& model);

  void get(std::span<const ValueReference> references, std::span<double> values);
  /// Gets whole numbers and enumerations, or Booleans as 0 and 1, depending on `kind`.
  void get(ValueKind kind, std::span<const ValueReference> references, std::span<std::int64_t> values);
  /// Gets Strings or Binaries, depending on `kind`.
  void get(ValueKind kind, std::span<const ValueReference> references, std::span<std::string> values);

  void set(std::span<const ValueReference> references, std::span<const double> values);
  /// Gets or sets values. Returns false if the FMU discards the call.
  bool try_get(std::span<const ValueReference> references, std::span<double> values);
  bool try_set(std::span<const ValueReference> references, std::span<const double> values);
  void set(ValueKind kind, std::span<const ValueReference> references, std::span<const std::int64_t> values);
  void set(ValueKind kind, std::span<const ValueReference> references, std::span<const std::string> values);

  /// FMI 3.0 gets and sets whole arrays. `references` are the value references of the scalars and arrays in the FMU
  /// that contain the given variables. `value_count` is the number of values of these scalars and arrays. places[i] is
  /// the position of the i-th given variable among these values.
  struct Whole {
    std::vector<std::uint32_t> references = {};
    std::size_t value_count = 0;
    std::vector<std::size_t> places = {};
  };
  Whole whole(std::span<const ValueReference> references) const;

 private:
  /// The type and value reference of a scalar or array in the FMU, and the position of an element in it.
  struct Place {
    modeldesc::Type type = modeldesc::Type::real;
    std::uint32_t reference = 0;
    std::size_t index = 0;  // index of the element in the array
    std::size_t count = 1;  // number of elements of the array
    const modeldesc::Variable* variable = nullptr;
  };
  /// The index of a value in an FMU call, and its index in the caller's list.
  struct Move {
    std::size_t value;
    std::size_t slot;
  };
  /// A call of an FMU function that gets or sets variables.
  struct Call {
    modeldesc::Type type;
    std::vector<std::uint32_t> references;
    // The variable of each value of the call; null for an array element that the caller did not request.
    std::vector<const modeldesc::Variable*> variables;
    std::size_t value_count = 0;
    std::vector<Move> moves;
  };
  struct Plan {
    std::vector<ValueReference> references;
    std::vector<Call> calls;
  };

  /// The result of several calls. Contains the status and the name of the first function that returned neither OK nor
  /// Warning.
  struct CallResult {
    int status = InstanceCalls::kOk;
    const char* function = "";
  };

  const Plan& plan(ValueKind kind, std::span<const ValueReference> references);
  Plan make_plan(std::span<const ValueReference> references) const;
  template <typename Action>
  void with_functions(modeldesc::Type type, Action action);
  template <typename T>
  T* buffer(std::size_t count);
  void put_guard();
  void check_guard(const Call& call, const char* function) const;
  template <typename Value>
  CallResult get_numbers(const Plan& plan, std::span<Value> values);
  template <typename Value>
  CallResult set_numbers(const Plan& plan, std::span<const Value> values);
  CallResult get_reals(std::span<const ValueReference> references, std::span<double> values);
  bool is_done(CallResult result);
  void get_texts(const Call& call, std::span<std::string> values);
  void get_binaries(const Call& call, std::span<std::string> values);

  InstanceCalls* calls_;
  const Fmi3Functions* functions_;
  std::unordered_map<ValueReference, Place> places_;
  std::array<std::vector<Plan>, 6> plans_;  // indexed by kind
  std::vector<std::byte> buffer_;           // numbers of the current call, followed by guard bytes
  std::size_t guard_ = 0;                   // index of the first guard byte
};

}  // namespace mebots::master
