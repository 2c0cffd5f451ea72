// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "slave/slave.hpp"

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace mebots::master {

/// The state of an instance that belongs to a group. Contains the states of its FMU and of its slave. For the first
/// member of the group, it also contains the state of the group.
struct MemberState final : SlaveState {
  std::unique_ptr<SlaveState> inner;
  std::vector<std::byte> own;
  std::vector<std::byte> group;
};

/// These functions convert a state to bytes and back. `inner` must be the slave whose state is `state.inner`.
std::vector<std::byte> serialize_member(Slave& inner, const MemberState& state);
std::unique_ptr<MemberState> deserialize_member(Slave& inner, std::span<const std::byte> bytes);

}  // namespace mebots::master
