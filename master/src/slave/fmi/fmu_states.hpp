// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/fmi2/library.hpp"
#include "mebots/fmi3/library.hpp"
#include "slave/fmi/instance_calls.hpp"
#include "slave/slave.hpp"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

namespace mebots::master {

/// The names of the FMI functions and capability flags for states.
struct StateNames {
  const char* get;
  const char* set;
  const char* free;
  const char* size;
  const char* serialize;
  const char* deserialize;
  const char* can_save;
  const char* can_serialize;
};

inline constexpr StateNames kFmi2StateNames = {
    "fmi2GetFMUstate",       "fmi2SetFMUstate",         "fmi2FreeFMUstate",     "fmi2SerializedFMUstateSize",
    "fmi2SerializeFMUstate", "fmi2DeSerializeFMUstate", "canGetAndSetFMUstate", "canSerializeFMUstate"};

inline constexpr StateNames kFmi3StateNames = {
    "fmi3GetFMUState",       "fmi3SetFMUState",         "fmi3FreeFMUState",     "fmi3SerializedFMUStateSize",
    "fmi3SerializeFMUState", "fmi3DeserializeFMUState", "canGetAndSetFMUState", "canSerializeFMUState"};

/// Saves, restores and serializes the states of an instance. A function in `Functions` is null if the FMU's library
/// lacks it or the FMU does not declare the capability.
template <typename Functions>
class FmuStates {
 public:
  /// `calls`, `functions` and `names` must outlive this object.
  FmuStates(InstanceCalls& calls, const Functions& functions, const StateNames& names, bool can_save,
            bool can_serialize)
      : calls_(&calls), functions_(&functions), names_(&names), can_save_(can_save), can_serialize_(can_serialize) {}

  /// Returns true if no saved state exists. The caller must then pass noSetFMUStatePriorToCurrentPoint = true to the
  /// step that starts at `start_ns`. This permits the FMU to discard its data of earlier times.
  bool promise_at(std::int64_t start_ns) {
    if (kept_ != 0) return false;
    promised_ns_ = start_ns;
    return true;
  }

  /// For these functions, see Slave.
  std::unique_ptr<SlaveState> save();
  void restore(const SlaveState& state);
  std::vector<std::byte> serialize(const SlaveState& state);
  std::unique_ptr<SlaveState> deserialize(std::span<const std::byte> bytes);

 private:
  class State;

  void require_saving() const;
  void require_serialization(bool is_there) const;
  std::vector<std::byte> buffer(std::size_t size);
  void free_state(void** state) noexcept;

  InstanceCalls* calls_;
  const Functions* functions_;
  const StateNames* names_;
  bool can_save_;
  bool can_serialize_;
  int kept_ = 0;
  std::int64_t promised_ns_ = std::numeric_limits<std::int64_t>::min();
};

extern template class FmuStates<fmi2::Functions>;
extern template class FmuStates<fmi3::Functions>;

}  // namespace mebots::master
