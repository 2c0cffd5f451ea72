// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "devices/core/attached_part.hpp"
#include "devices/gap8/hyper_flash.hpp"
#include "devices/gap8/udma_peripheral.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace mebots::soc::gap8_devices {

struct HyperBusParts {
  PartPort ram;
  PartPort flash;
  PartPort pads;
};

/// Models the HyperBus with a GAPuino's memories: 8 MiB of RAM, and flash. The flash begins at the address in field
/// MBR1 of register MEM_CFG4 (16 MiB after reset). A transfer takes 3 bus clocks for command and address, 12 for
/// latency, and one per two bytes (HyperBus specification: the fixed latency is twice 6 clocks). We assume that the bus
/// has half the clock of the SoC. Source of registers: archi/udma/udma_hyper_v1.h.
class UdmaHyperBus final : public UdmaPeripheral {
 public:
  static constexpr std::uint32_t kRamBytes = 8U << 20;  // RAM of the S71KS512S, the GAPuino's HyperBus memory
  static constexpr std::uint32_t kFlashBytes = HyperFlash::kBytes;

  /// `flash` is the initial content of the flash; all bytes after it are ones. `flash` must outlive this object.
  UdmaHyperBus(UdmaHost& host, std::span<const std::uint8_t> flash, std::uint32_t send_channel,
               const HyperBusParts& parts)
      : host_(host), flash_(flash), send_channel_(send_channel), parts_(parts) {}

  void set_flash(std::span<const std::uint8_t> image) { flash_.set_image(image); }

  Picoseconds end_time(const UdmaTransfer& transfer, Picoseconds start) override;
  void end(const UdmaTransfer& transfer) override;
  void cancel(const UdmaTransfer& transfer, Picoseconds now) override;
  void visit(state::Visitor& v) override {
    v("ram", ram_);
    v("flash", flash_);
  }

 private:
  bool is_of_flash(const UdmaTransfer& transfer) const { return transfer.outside >= flash_base(); }
  std::uint32_t flash_base() const;
  void move(const UdmaTransfer& transfer);
  void release(Picoseconds now, std::uint32_t bytes, bool of_flash);

  UdmaHost& host_;
  HyperFlash flash_;
  std::uint32_t send_channel_;
  HyperBusParts parts_;
  std::vector<std::uint8_t> ram_;    // contents up to the last byte that was written
  std::vector<std::uint8_t> bytes_;  // bytes of the present transfer; a member so that its memory is reused
};

}  // namespace mebots::soc::gap8_devices
