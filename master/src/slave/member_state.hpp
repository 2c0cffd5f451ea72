// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "slave/slave.hpp"

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace mebots::master {

/// The state of an instance in a group: `inner` is the state of the wrapped slave, and `own` is that of the slave
/// itself. `group` is the state of the group, for the first member only.
struct MemberState final : SlaveState {
  std::unique_ptr<SlaveState> inner;
  std::vector<std::byte> own;
  std::vector<std::byte> group;
};

/// Converts a state to bytes and back. `inner` must be the slave of `state.inner`.
std::vector<std::byte> serialize_member(Slave& inner, const MemberState& state);
std::unique_ptr<MemberState> deserialize_member(Slave& inner, std::span<const std::byte> bytes);

}  // namespace mebots::master
