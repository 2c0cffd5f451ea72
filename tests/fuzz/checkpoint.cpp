// SPDX-License-Identifier: Apache-2.0
//
// Reads any bytes after the hash of a checkpoint and of a saved run. The reader must throw Error, or return an object.
// The object is then written, read and written again: both times with the same bytes. The input may contain wrong
// sizes.
#include "run/checkpoint.hpp"

#include "mebots/error.hpp"
#include "mebots/state/save.hpp"
#include "require.hpp"

#include <algorithm>
#include <span>

namespace {

template <typename T>
void restore(std::span<const std::byte> bytes) {
  T value;
  try {
    mebots::state::restore(value, bytes);
  } catch (const mebots::Error&) {
    return;
  }
  const auto again = mebots::state::save(value);
  T other;
  mebots::state::restore(other, again);
  mebots::fuzz::require(mebots::state::save(other) == again, "what is written is what is read");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto bytes = std::as_bytes(std::span(data, size));
  restore<mebots::master::Checkpoint>(bytes);
  restore<mebots::master::SavedRun>(bytes);
  return 0;
}
