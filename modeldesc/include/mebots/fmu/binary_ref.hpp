// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

namespace mebots::fmu {

/// A block of bytes that somebody else owns, as the OSMP triple of three FMI Integers carries it.
/// The owner keeps it valid until its next step ends.
struct BinaryRef {
  std::int32_t base_lo = 0;
  std::int32_t base_hi = 0;
  std::int32_t size = 0;

  static BinaryRef to(std::span<const std::uint8_t> bytes) {
    const auto address = reinterpret_cast<std::uintptr_t>(bytes.data());
    return {static_cast<std::int32_t>(static_cast<std::uint32_t>(address)),
            static_cast<std::int32_t>(static_cast<std::uint32_t>(static_cast<std::uint64_t>(address) >> 32)),
            static_cast<std::int32_t>(bytes.size())};
  }

  /// Empty when there is no buffer.
  std::span<const std::uint8_t> bytes() const {
    const auto address =
        (static_cast<std::uint64_t>(static_cast<std::uint32_t>(base_hi)) << 32) | static_cast<std::uint32_t>(base_lo);
    if (address == 0 || size <= 0) return {};
    // The pointer came as two integers: that is OSMP. NOLINTNEXTLINE(performance-no-int-to-ptr)
    const auto* data = reinterpret_cast<const std::uint8_t*>(static_cast<std::uintptr_t>(address));
    return {data, static_cast<std::size_t>(size)};
  }
};

}  // namespace mebots::fmu
