// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "face.hpp"
#include "legal.hpp"
#include "mebots/state/visitor.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace mebots::shell {

/// The object behind the handles of fmi2GetFMUstate and fmi3GetFMUState.
struct SavedState {
  State state = State::instantiated;
  bool experiment_is_set = false;
  bool model_is_stale = true;
  std::int64_t start_ns = 0;
  std::int64_t time_ns = 0;
  std::optional<std::int64_t> stop_ns;
  std::vector<std::byte> parameters;
  std::vector<std::byte> inputs;
  std::vector<std::byte> outputs;
  std::optional<std::vector<std::byte>> model;  // empty before the model exists
  std::uint64_t layout = 0;                     // hash of the model's layout, see mebots/state/layout.hpp; in the
                                                // header

  void visit(state::Visitor& v);
};

/// The FMU and the build to which a state belongs.
struct Owner {
  std::string_view model_identifier;
  std::string_view token_name;
  std::string_view token;
};

/// Serializes the state. The header identifies the FMU and the build in `owner`.
std::vector<std::byte> serialize(const Owner& owner, const SavedState& saved);

/// Reads a serialized state. Throws mebots::Error if the bytes are damaged or belong to another FMU or version. Does
/// not check the layout, because the instance may have no model yet. The restore checks it.
SavedState deserialize(const Owner& owner, std::span<const std::byte> bytes);

}  // namespace mebots::shell
