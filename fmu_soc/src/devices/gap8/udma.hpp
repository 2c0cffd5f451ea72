// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "devices/gap8/himax.hpp"
#include "devices/gap8/udma_camera.hpp"
#include "devices/gap8/udma_hyperbus.hpp"
#include "devices/gap8/udma_i2c.hpp"
#include "devices/gap8/udma_peripheral.hpp"
#include "devices/gap8/udma_spim.hpp"
#include "devices/gap8/udma_uart.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::soc::gap8_devices {

/// What of the board consumes with the uDMA.
struct UdmaParts {
  HyperBusParts hyper_bus;
  PartPort camera;
};

/// GAP8's uDMA with the channels of its HyperBus, UART, I2C and SPI masters and camera interface, and what
/// a GAPuino has there: RAM, flash, a terminal, an HM01B0. A store into a channel's CFG with the enable bit starts a
/// transfer, or queues one behind that which runs; its end is the channel's SoC event. Bytes move when the transfer
/// ends. The camera listens at both I2C masters: a GAPuino has it at the second one, a PULP-Shield at the first.
///
/// Its variables are those of its peripherals, and flash.image, a parameter: the path of the image that the flash
/// begins with, in place of the one of its file; empty = that one.
///
/// Other peripherals' channels are as the entry describes them. Source: archi/udma/udma_v2.h.
class Udma final : public Device {
 public:
  static constexpr std::uint32_t kFlashBytes = UdmaHyperBus::kFlashBytes;

  /// `flash` holds the image that the flash begins with, all ones behind it; it must stay where it is, and the pictures
  /// as well.
  Udma(const BoardDevice& entry, DeviceHost& host, Signals& signals, std::span<const std::uint8_t> flash,
       const PictureRoll& pictures, std::function<double()> clock_hz, const UdmaParts& parts);

  bool load(std::uint32_t offset, Picoseconds now, std::uint32_t& value) override;
  bool store(std::uint32_t offset, Picoseconds now, std::uint32_t value) override;
  void advance(Picoseconds now) override;
  Picoseconds next_event() const override;
  double* input(std::string_view variable) override { return camera_.input(variable); }
  std::string_view* text_input(std::string_view variable) override {
    return variable == "flash.image" ? &flash_path_ : camera_.text_input(variable);
  }
  std::span<const std::uint8_t>* bytes_input(std::string_view variable) override {
    return camera_.bytes_input(variable);
  }
  const double* output(std::string_view variable) const override;
  void begin_step(Picoseconds now) override;
  bool takes_picture() const override { return camera_.takes_picture(); }
  void program_ended() override { uart_.program_ended(); }
  void visit(state::Visitor& v) override;

 private:
  struct Channel {
    std::uint32_t address = 0;
    std::uint32_t size = 0;

    void visit(state::Visitor& v) {
      v("address", address);
      v("size", size);
    }
  };
  using Queue = std::vector<UdmaTransfer>;

  static constexpr std::size_t kChannels = 13;
  static constexpr std::size_t kLines = 12;  // as many channels, but those of the HyperBus share one

  UdmaPeripheral& peripheral(std::size_t channel);
  std::size_t queued(std::size_t channel) const;
  void load_flash();
  void enqueue(std::size_t channel, Picoseconds now);
  void clear(std::size_t channel, Picoseconds now);
  void retry_waiting_transfers(Picoseconds now);

  UdmaHost host_;
  Himax sensor_;
  UdmaHyperBus hyper_bus_;
  UdmaUart uart_;
  std::array<UdmaI2c, 2> i2c_;
  std::array<UdmaSpim, 2> spim_;
  UdmaCamera camera_;
  std::array<Channel, kChannels> channels_;
  std::array<Queue, kLines> queues_;
  std::uint32_t outside_ = 0;

  std::string_view flash_path_;  // as it comes in
  std::string loaded_;           // whose image this is
  std::vector<std::uint8_t> flash_image_;
};

}  // namespace mebots::soc::gap8_devices
