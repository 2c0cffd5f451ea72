// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/execution.hpp"

#include <cstdint>
#include <limits>

namespace mebots::soc {

/// The answer of `wait_for_far` when it has done nothing.
inline constexpr std::uint64_t kNoRoom = std::numeric_limits<std::uint64_t>::max();

/// For translated code, of an access within a word of the second memory, which others use, too: takes its bank for the
/// instruction that starts in active cycle `cycle`, and counts the access. `offset`: from the memory's start. The
/// answer is how many cycles it waits, for the way and for the bank. kNoRoom: the rest of the block could lead further
/// than the banks of the first memory reach, where translated code does not look; the interpreter makes the access.
std::uint64_t wait_for_far(Execution& execution, std::uint64_t cycle, std::uint32_t offset) noexcept;

}  // namespace mebots::soc
