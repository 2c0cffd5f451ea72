// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "slave/slave.hpp"

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace mebots::master {

/// The state of an instance in a group: the state of its FMU and of its slave. The state of the first member also
/// contains the state of the group.
struct MemberState final : SlaveState {
  std::unique_ptr<SlaveState> inner;
  std::vector<std::byte> own;
  std::vector<std::byte> group;
};

/// `inner` must be the slave whose state is `state.inner`.
std::vector<std::byte> serialize_member(Slave& inner, const MemberState& state);
std::unique_ptr<MemberState> deserialize_member(Slave& inner, std::span<const std::byte> bytes);

}  // namespace mebots::master
