// SPDX-License-Identifier: Apache-2.0
#include "slave/member_state.hpp"

#include "mebots/state/bytes.hpp"

namespace mebots::master {

std::vector<std::byte> serialize_member(Slave& inner, const MemberState& state) {
  state::Writer writer;
  writer.put(state.own);
  writer.put(state.group);
  writer.put(inner.serialize(*state.inner));
  return writer.take();
}

std::unique_ptr<MemberState> deserialize_member(Slave& inner, std::span<const std::byte> bytes) {
  state::Reader reader(bytes);
  auto state = std::make_unique<MemberState>();
  reader.get(state->own);
  reader.get(state->group);
  std::vector<std::byte> content;
  reader.get(content);
  state->inner = inner.deserialize(content);
  return state;
}

}  // namespace mebots::master
