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

struct UdmaParts {
  HyperBusParts hyper_bus;
  PartPort camera;
};

/// Models GAP8's uDMA and its peripherals, with the connected parts of a GAPuino: RAM, flash, terminal, HM01B0 camera.
/// The peripherals are the masters of HyperBus, UART, I2C and SPI, and the camera interface. A store into a channel's
/// CFG with the enable bit starts or queues a transfer. At the end of a transfer, its bytes are copied, and the
/// channel's SoC event is raised. The camera is on both I2C buses: a GAPuino has it on the second one, a PULP-Shield on
/// the first.
///
/// The uDMA has the variables of its peripherals, and the parameter flash.image: the path of an image that replaces the
/// flash's initial content. If the path is empty, the image of the board is used.
///
/// A channel of another peripheral behaves as its entry in the board file describes. Source: archi/udma/udma_v2.h.
class Udma final : public Device {
 public:
  static constexpr std::uint32_t kFlashBytes = UdmaHyperBus::kFlashBytes;

  /// `flash` is the initial content of the flash; all bytes after it are ones. `flash` and `pictures` must outlive the
  /// uDMA.
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
  static constexpr std::size_t kLines = 12;  // number of queues: the two channels of the HyperBus share one

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

  std::string_view flash_path_;  // value of the parameter flash.image
  std::string loaded_;           // path of the image that the flash contains
  std::vector<std::uint8_t> flash_image_;
};

}  // namespace mebots::soc::gap8_devices
