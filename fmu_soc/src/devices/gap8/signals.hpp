// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "devices/core/chip_host.hpp"
#include "mebots/soc/time.hpp"

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>

namespace mebots::soc::gap8_devices {

/// Numbers of the fabric controller's events; each number is a bit of its event unit. Source:
/// archi/chips/gap/properties.h of pulp-platform's and GreenWaves' archi headers.
inline constexpr unsigned kTimerLowEvent = 10;
inline constexpr unsigned kTimerHighEvent = 11;
inline constexpr unsigned kSocEvent = 27;

/// Numbers of the SoC's events, which enter the queue of kSocEvent. Source: as for the events above.
inline constexpr unsigned kClusterPowerChanged = 31;
inline constexpr unsigned kClusterClockChanged = 35;
inline constexpr unsigned kScuOk = 37;
inline constexpr unsigned kFirstSoftwareEvent = 48;
inline constexpr unsigned kReferenceClockEvent = 56;

inline constexpr std::int64_t kReferenceClockHz = 32768;

/// Connects GAP8's devices. The receiver of a signal sets the signal's function in its constructor. On a board without
/// the receiver, a signal has no effect.
struct Signals {
  std::function<void(unsigned event)> raise_fabric_event = [](unsigned) {};
  std::function<void(unsigned event, Picoseconds now)> raise_soc_event = [](unsigned, Picoseconds) {};
  /// Called before the fabric controller's clock changes. A receiver that replaces this function must also call the
  /// replaced function.
  std::function<void(Picoseconds now)> clock_changes = [](Picoseconds) {};
  /// Settings that the FLLs and the SoC control have requested; nullopt on boards without GAP8's power devices.
  std::optional<PowerSettings> power;
  std::optional<std::int32_t> exit_code;
  /// Number of cluster cores of this chip; not part of a saved state.
  unsigned cluster_cores = 0;

  void visit(state::Visitor& v) {
    v("power", power);
    v("exit_code", exit_code);
  }
};

/// Returns the number of rising edges of the reference clock from reset to `now`.
inline std::int64_t reference_edges(Picoseconds now) {
  const auto whole_s = now / 1'000'000'000'000;
  const auto rest_ps = now % 1'000'000'000'000;
  return whole_s * kReferenceClockHz + rest_ps * kReferenceClockHz / 1'000'000'000'000;
}
/// Returns the time at which the rising edge number `edge` of the reference clock occurs.
inline Picoseconds reference_edge_time(std::int64_t edge) {
  const auto whole_s = edge / kReferenceClockHz;
  if (whole_s >= kNever / 1'000'000'000'000) return kNever;
  const auto rest = edge % kReferenceClockHz;
  return whole_s * 1'000'000'000'000 + (rest * 1'000'000'000'000 + kReferenceClockHz - 1) / kReferenceClockHz;
}

/// Creates a device that uses Signals::power. The first such device sets the initial values.
template <typename T>
std::unique_ptr<Device> make_with_signals(const BoardDevice& entry, ChipHost& host) {
  if (!host.signals().power) host.signals().power = host.power_at_start();
  return std::make_unique<T>(entry, host, host.signals());
}

}  // namespace mebots::soc::gap8_devices
