// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

/// Lists the registers of GAP8's event units. Source: archi/eu/eu_v3.h of pulp-platform's and GreenWaves' archi
/// headers.
namespace mebots::soc::gap8_devices::event_unit_reg {

/// Offsets of the registers that each core has.
inline constexpr std::uint32_t kMask = 0x00;
inline constexpr std::uint32_t kMaskAnd = 0x04;  // a store clears these bits of the mask
inline constexpr std::uint32_t kMaskOr = 0x08;
inline constexpr std::uint32_t kMaskIrq = 0x0C;
inline constexpr std::uint32_t kMaskIrqAnd = 0x10;
inline constexpr std::uint32_t kMaskIrqOr = 0x14;
inline constexpr std::uint32_t kStatus = 0x18;
inline constexpr std::uint32_t kBuffer = 0x1C;
inline constexpr std::uint32_t kBufferMasked = 0x20;
inline constexpr std::uint32_t kBufferIrqMasked = 0x24;
inline constexpr std::uint32_t kBufferClear = 0x28;
inline constexpr std::uint32_t kSoftwareTargets = 0x2C;
inline constexpr std::uint32_t kSoftwareTargetsAnd = 0x30;
inline constexpr std::uint32_t kSoftwareTargetsOr = 0x34;
inline constexpr std::uint32_t kEventWait = 0x38;
inline constexpr std::uint32_t kEventWaitClear = 0x3C;
inline constexpr std::uint32_t kCoreBytes = 0x40;

/// Offsets of the registers that are only in the demultiplexed range of a core.
inline constexpr std::uint32_t kDispatch = 0x80;
inline constexpr std::uint32_t kDispatchTeam = 0x84;
inline constexpr std::uint32_t kMutex = 0xC0;
inline constexpr std::uint32_t kTriggerSoftwareEvent = 0x100;  // eight words, one for each software event
inline constexpr std::uint32_t kBarriers = 0x200;
inline constexpr std::uint32_t kShortEnd = 0x400;

/// Offsets of the registers that are only on the peripheral bus.
inline constexpr std::uint32_t kLongBarriers = 0x400;
inline constexpr std::uint32_t kLongSoftwareEvents = 0x600;
inline constexpr std::uint32_t kLongSocEvents = 0x700;

/// Software events have three blocks of registers: raise; raise and wait; raise, wait and clear.
inline constexpr std::uint32_t kTriggerBytes = 0x40;
inline constexpr std::uint32_t kSoftwareEvents = 8;

/// Offsets within the registers of a barrier.
inline constexpr std::uint32_t kBarrierBytes = 0x20;
inline constexpr std::uint32_t kBarrierTeam = 0x00;
inline constexpr std::uint32_t kBarrierArrived = 0x04;
inline constexpr std::uint32_t kBarrierSummary = 0x08;
inline constexpr std::uint32_t kBarrierTargets = 0x0C;
inline constexpr std::uint32_t kBarrierTrigger = 0x10;
inline constexpr std::uint32_t kBarrierTriggerSelf = 0x14;
inline constexpr std::uint32_t kBarrierTriggerWait = 0x18;
inline constexpr std::uint32_t kBarrierTriggerWaitClear = 0x1C;

}  // namespace mebots::soc::gap8_devices::event_unit_reg
