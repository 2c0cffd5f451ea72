// SPDX-License-Identifier: Apache-2.0
#include "devices/core/kinds.hpp"
#include "devices/generic/console.hpp"
#include "mebots/soc/device.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

namespace mebots::soc {
namespace {

// Bits of registers. Source: National Semiconductor, PC16550D datasheet, 1995.
constexpr std::uint8_t kDataReady = 0x01;         // LSR
constexpr std::uint8_t kTransmitterEmpty = 0x60;  // LSR: holding register and shift register
constexpr std::uint8_t kReceiveEnable = 0x01;     // IER
constexpr std::uint8_t kTransmitEnable = 0x02;
constexpr std::uint8_t kModemEnable = 0x08;
constexpr std::uint8_t kFifoEnable = 0x01;  // FCR
constexpr std::uint8_t kFifoClearReceiver = 0x02;
constexpr std::uint8_t kDivisorAccess = 0x80;  // LCR
constexpr std::uint8_t kLoop = 0x10;           // MCR

/// Interrupt sources as IIR shows them, in order of priority.
enum class Source : std::uint8_t { receive = 0x04, timeout = 0x0c, transmit = 0x02, modem = 0x00, none = 0x01 };

/// Models a UART 16550A with one byte per register. Transmission takes no time, as in QEMU. Input arrives at one byte
/// per character time, and waits while the FIFO is full. Input starts when the program first reads LSR or RBR, or
/// enables the interrupt of received data.
class Uart16550 final : public Device {
 public:
  explicit Uart16550(ChipHost& host) : port_(host), lines_(host) {}

  bool load(std::uint32_t offset, Picoseconds now, std::uint32_t& value) override;
  bool store(std::uint32_t offset, Picoseconds now, std::uint32_t value) override;
  bool load_narrow(std::uint32_t offset, Picoseconds now, std::uint32_t& value, unsigned /*size*/) override {
    return load(offset, now, value);
  }
  bool store_narrow(std::uint32_t offset, Picoseconds now, std::uint32_t value, unsigned /*size*/) override {
    return store(offset, now, value);
  }
  bool load_is_quiet(std::uint32_t offset) const override;
  void advance(Picoseconds now) override;
  Picoseconds next_event() const override { return std::min(next_input_, timeout_at_); }
  bool interrupt() const override { return source() != Source::none; }
  void program_ended() override { lines_.program_ended(); }
  void visit(state::Visitor& v) override;

 private:
  enum Register : std::uint32_t { data = 0, ier = 1, iir = 2, lcr = 3, mcr = 4, lsr = 5, msr = 6, scratch = 7 };

  static constexpr std::size_t kDepth = 16;
  static constexpr std::int64_t kClockHz = 3'686'400;  // clock in QEMU's device tree
  static constexpr std::int64_t kPsPerSecond = 1'000'000'000'000;

  bool shows_divisor() const { return (lcr_ & kDivisorAccess) != 0; }
  bool has_fifo() const { return (fcr_ & kFifoEnable) != 0; }
  std::size_t room() const { return (has_fifo() ? kDepth : 1) - count_; }
  std::size_t trigger_level() const;
  Picoseconds character_time() const;
  Source source() const;
  std::uint8_t modem_lines() const;

  std::uint32_t take_received(Picoseconds now);
  std::uint32_t take_source();
  std::uint32_t take_modem_status();
  void receive(std::uint8_t byte, Picoseconds now);
  void transmit(std::uint8_t byte, Picoseconds now);
  void begin_input(Picoseconds now);
  void resume_input(Picoseconds now);
  void clear_received(Picoseconds now);
  void set_interrupts(std::uint8_t enabled, Picoseconds now);
  void set_fifo(std::uint8_t control, Picoseconds now);
  void set_modem(std::uint8_t control);

  ConsolePort& port_;
  Console lines_;  // used if the host's console accepts only whole lines
  std::uint8_t ier_ = 0;
  std::uint8_t fcr_ = 0;
  std::uint8_t lcr_ = 0;
  std::uint8_t mcr_ = 0;
  std::uint8_t scratch_ = 0;
  std::uint8_t modem_changes_ = 0;  // bits 3 to 0 of MSR
  std::uint16_t divisor_ = 12;      // QEMU's value after reset
  std::array<std::uint8_t, kDepth> received_{};
  std::uint8_t first_ = 0;  // index of the oldest byte
  std::uint8_t count_ = 0;
  bool transmit_pending_ = false;  // interrupt of an empty transmitter; cleared when IIR shows it
  bool timed_out_ = false;
  bool input_began_ = false;
  bool input_ended_ = false;
  Picoseconds next_input_ = kNever;
  Picoseconds timeout_at_ = kNever;
};

std::size_t Uart16550::trigger_level() const {
  static constexpr std::array<std::size_t, 4> kLevels{1, 4, 8, 14};
  return has_fifo() ? kLevels[fcr_ >> 6] : 1;
}

/// Returns the time of start bit, data bits, parity and stop bits. A bit takes 16 periods of the divided clock.
Picoseconds Uart16550::character_time() const {
  const auto data_bits = 5 + (lcr_ & 3);
  const auto bits = 1 + data_bits + (lcr_ >> 3 & 1) + 1 + (lcr_ >> 2 & 1);
  const auto clocks = std::int64_t{16} * bits * std::max<std::int64_t>(divisor_, 1);
  return clocks * (kPsPerSecond / 100) / (kClockHz / 100);
}

Source Uart16550::source() const {
  if ((ier_ & kReceiveEnable) != 0) {
    if (count_ >= trigger_level()) return Source::receive;
    if (timed_out_) return Source::timeout;
  }
  if ((ier_ & kTransmitEnable) != 0 && transmit_pending_) return Source::transmit;
  if ((ier_ & kModemEnable) != 0 && modem_changes_ != 0) return Source::modem;
  return Source::none;
}

/// Returns bits 7 to 4 of MSR: DCD, DSR and CTS of a connected terminal, or the outputs of MCR in a loop.
std::uint8_t Uart16550::modem_lines() const {
  if ((mcr_ & kLoop) == 0) return 0xb0;
  const unsigned out = mcr_;
  return static_cast<std::uint8_t>((out & 0x0cU) << 4 | (out & 2U) << 3 | (out & 1U) << 5);
}

void Uart16550::begin_input(Picoseconds now) {
  if (input_began_) return;
  input_began_ = true;
  resume_input(now);
}

/// Schedules the next input byte one character time later, unless a byte is already scheduled.
void Uart16550::resume_input(Picoseconds now) {
  if (input_began_ && !input_ended_ && next_input_ == kNever && room() != 0) next_input_ = now + character_time();
}

void Uart16550::advance(Picoseconds now) {
  if (now >= timeout_at_) {
    timed_out_ = count_ != 0;
    timeout_at_ = kNever;
  }
  if (now < next_input_) return;
  next_input_ = kNever;
  if (room() != 0 && (mcr_ & kLoop) == 0) {
    const auto byte = port_.read_console(now);
    if (byte >= 0) receive(static_cast<std::uint8_t>(byte), now);
    input_ended_ = byte == ConsolePort::kEnded;
  }
  resume_input(now);
}

/// Adds a received byte. If the FIFO is full, drops the byte, which happens only in loop-back mode.
void Uart16550::receive(std::uint8_t byte, Picoseconds now) {
  if (room() == 0) return;
  received_[(first_ + count_) % kDepth] = byte;
  ++count_;
  timed_out_ = false;
  timeout_at_ = has_fifo() ? now + 4 * character_time() : kNever;
}

std::uint32_t Uart16550::take_received(Picoseconds now) {
  begin_input(now);
  if (count_ == 0) return 0;
  const auto byte = received_[first_];
  first_ = static_cast<std::uint8_t>((first_ + 1U) % kDepth);
  --count_;
  timed_out_ = false;
  timeout_at_ = has_fifo() && count_ != 0 ? now + 4 * character_time() : kNever;
  resume_input(now);
  return byte;
}

void Uart16550::clear_received(Picoseconds now) {
  count_ = 0;
  timed_out_ = false;
  timeout_at_ = kNever;
  resume_input(now);
}

/// Returns IIR. If IIR shows the interrupt of an empty transmitter, clears this interrupt.
std::uint32_t Uart16550::take_source() {
  const auto shown = source();
  if (shown == Source::transmit) transmit_pending_ = false;
  return static_cast<std::uint32_t>(shown) | (has_fifo() ? 0xc0U : 0U);
}

std::uint32_t Uart16550::take_modem_status() {
  const auto status = modem_lines() | modem_changes_;
  modem_changes_ = 0;
  return static_cast<std::uint32_t>(status);
}

bool Uart16550::load(std::uint32_t offset, Picoseconds now, std::uint32_t& value) {
  switch (static_cast<Register>(offset)) {
    case data:
      value = shows_divisor() ? divisor_ & 0xffU : take_received(now);
      return true;
    case ier:
      value = shows_divisor() ? static_cast<std::uint32_t>(divisor_ >> 8) : ier_;
      return true;
    case iir:
      value = take_source();
      return true;
    case lcr:
      value = lcr_;
      return true;
    case mcr:
      value = mcr_;
      return true;
    case lsr:
      begin_input(now);
      value = static_cast<std::uint32_t>(kTransmitterEmpty | (count_ != 0 ? kDataReady : 0));
      return true;
    case msr:
      value = take_modem_status();
      return true;
    case scratch:
      value = scratch_;
      return true;
  }
  return false;
}

/// A load of LSR starts the input. Loads of RBR, IIR and MSR may change the interrupt line.
bool Uart16550::load_is_quiet(std::uint32_t offset) const {
  switch (static_cast<Register>(offset)) {
    case ier:
    case lcr:
    case mcr:
    case scratch:
      return true;
    case lsr:
      return input_began_;
    default:
      return false;
  }
}

void Uart16550::transmit(std::uint8_t byte, Picoseconds now) {
  transmit_pending_ = true;  // transmission takes no time
  if ((mcr_ & kLoop) != 0) {
    receive(byte, now);
  } else if (!port_.write_console(byte)) {
    lines_.put(byte, now);
  }
}

void Uart16550::set_interrupts(std::uint8_t enabled, Picoseconds now) {
  const auto turned_on = enabled & ~ier_;
  ier_ = enabled & 0x0fU;
  if ((turned_on & kTransmitEnable) != 0) transmit_pending_ = true;
  if ((ier_ & kReceiveEnable) != 0) begin_input(now);
}

/// Writes the FIFO control register. A change of the enable bit also clears the receive FIFO.
void Uart16550::set_fifo(std::uint8_t control, Picoseconds now) {
  const bool clears = ((control ^ fcr_) & kFifoEnable) != 0 || (control & kFifoClearReceiver) != 0;
  fcr_ = (control & kFifoEnable) != 0 ? control & 0xc9U : 0;
  if (clears) clear_received(now);
}

void Uart16550::set_modem(std::uint8_t control) {
  const auto before = modem_lines();
  mcr_ = control & 0x1fU;
  const auto changed = static_cast<std::uint8_t>(before ^ modem_lines());
  const auto fell = static_cast<std::uint8_t>(before & ~modem_lines());
  // The ring indicator (bit 6) reports its falling edge only.
  modem_changes_ |= static_cast<std::uint8_t>((changed & 0xb0U) >> 4 | (fell & 0x40U) >> 4);
}

bool Uart16550::store(std::uint32_t offset, Picoseconds now, std::uint32_t value) {
  const auto byte = static_cast<std::uint8_t>(value);
  switch (static_cast<Register>(offset)) {
    case data:
      if (shows_divisor()) {
        divisor_ = static_cast<std::uint16_t>((divisor_ & 0xff00U) | byte);
      } else {
        transmit(byte, now);
      }
      return true;
    case ier:
      if (shows_divisor()) {
        divisor_ = static_cast<std::uint16_t>((divisor_ & 0xffU) | unsigned{byte} << 8);
      } else {
        set_interrupts(byte, now);
      }
      return true;
    case iir:
      set_fifo(byte, now);
      return true;
    case lcr:
      lcr_ = byte;
      return true;
    case mcr:
      set_modem(byte);
      return true;
    case lsr:  // read only
    case msr:
      return true;
    case scratch:
      scratch_ = byte;
      return true;
  }
  return false;
}

void Uart16550::visit(state::Visitor& v) {
  v("ier", ier_);
  v("fcr", fcr_);
  v("lcr", lcr_);
  v("mcr", mcr_);
  v("scratch", scratch_);
  v("modem_changes", modem_changes_);
  v("divisor", divisor_);
  v("received", received_);
  v("first", first_);
  v("count", count_);
  v("transmit_pending", transmit_pending_);
  v("timed_out", timed_out_);
  v("input_began", input_began_);
  v("input_ended", input_ended_);
  v("next_input", next_input_);
  v("timeout_at", timeout_at_);
  v("lines", lines_);
  if (v.restores() && (first_ >= kDepth || count_ > kDepth)) {
    throw Error(ErrorCode::state_damaged, "a saved state is damaged: more received bytes than a UART holds");
  }
}

}  // namespace
}  // namespace mebots::soc

MEBOTS_CHIP_KIND(uart_16550, {}, [](const BoardDevice& /*entry*/, ChipHost& host) -> std::unique_ptr<Device> {
  return std::make_unique<Uart16550>(host);
})
