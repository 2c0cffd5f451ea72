// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cluster/peripherals.hpp"
#include "memory/bus.hpp"
#include "soc/device_set.hpp"
#include "soc/hardware.hpp"
#include "soc/program_host.hpp"
#include "soc/timeline.hpp"

#include <cstdint>
#include <functional>
#include <set>
#include <string>
#include <string_view>

namespace mebots::soc {

/// Handles accesses of GAP8's programs to registers that the board does not model. RI5CY of 2018 has no access faults:
/// a load returns some value (here 0), a store has no effect, and the program continues. Each address is reported once,
/// because it may explain a difference from the real chip. Not part of a saved state.
class UnmodelledRegisters {
 public:
  /// Returns true if GAP8 has peripherals at this address. Accesses to other addresses are faults.
  static bool are_at(std::uint32_t address);

  /// Returns the text that reports an access. `entry` is the device at the address; null = no device.
  std::string text(std::uint32_t address, bool stores, std::string_view function, const BoardDevice* entry) const;
  bool is_new(std::uint32_t address);

 private:
  std::set<std::uint32_t> warned_;
};

/// The bus of the fabric controller to devices of the SoC and to registers of the cluster.
///
/// An access to the cluster's registers, or to a device that sets power, must wait until the cluster has reached the
/// same time. The reply is then BusReply::Kind::later.
class SystemBus final : public Bus {
 public:
  using Report = std::function<void(std::string_view text)>;

  SystemBus(Hardware& hardware, Timeline& timeline, DeviceSet& devices, ProgramHost& program_host, Report report)
      : hardware_(hardware),
        timeline_(timeline),
        devices_(devices),
        program_host_(program_host),
        report_(std::move(report)) {}

  /// If `listens` is true, load_quietly() performs no loads, because a listener must be called after each access.
  void set_listening(bool listens) { listens_ = listens; }

  BusReply load(std::uint32_t address, std::uint64_t cycle) override;
  BusReply load_quietly(std::uint32_t address, std::uint64_t cycle, unsigned size) noexcept override;
  BusReply load_event(std::uint32_t address, std::uint64_t cycle) override;
  BusReply store(std::uint32_t address, std::uint64_t cycle, std::uint32_t value) override;
  BusReply load_narrow(std::uint32_t address, std::uint64_t cycle, unsigned size) override;
  BusReply store_narrow(std::uint32_t address, std::uint64_t cycle, std::uint32_t value, unsigned size) override;
  void interrupt_taken(unsigned line) override { devices_.acknowledge(line, hardware_.controller()); }
  bool watched(std::uint32_t /*address*/) override { return program_host_.command() != 0; }
  bool called_host(std::uint32_t cause) override;
  bool serves_environment_calls() const override { return program_host_.serves_environment_calls(); }

  /// Performs an access of a cluster core to a device of the SoC. The access takes place at `time`, or at the fabric
  /// controller's time if the fabric controller is awake and its time is later.
  BusReply from_cluster(const ClusterAccess& access, Picoseconds time);

 private:
  bool must_wait(std::uint32_t address, Picoseconds now) const;
  BusReply unmodelled(std::uint32_t address, bool stores, bool by_fabric_controller);

  Hardware& hardware_;
  Timeline& timeline_;
  DeviceSet& devices_;
  ProgramHost& program_host_;
  Report report_;
  UnmodelledRegisters unmodelled_;
  bool listens_ = false;
};

}  // namespace mebots::soc
