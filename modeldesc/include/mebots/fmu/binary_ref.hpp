// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

namespace mebots::fmu {

/// Refers to bytes that another object owns. Stores their address and size as three FMI Integers, as OSMP defines. The
/// reference is valid until the next step of the owner ends.
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

  /// Returns the bytes; empty if the pointer is null, or if the size is not positive.
  std::span<const std::uint8_t> bytes() const {
    const auto address =
        (static_cast<std::uint64_t>(static_cast<std::uint32_t>(base_hi)) << 32) | static_cast<std::uint32_t>(base_lo);
    if (address == 0 || size <= 0) return {};
    // OSMP transfers the pointer as two integers. NOLINTNEXTLINE(performance-no-int-to-ptr)
    const auto* data = reinterpret_cast<const std::uint8_t*>(static_cast<std::uintptr_t>(address));
    return {data, static_cast<std::size_t>(size)};
  }
};

}  // namespace mebots::fmu
