// SPDX-License-Identifier: Apache-2.0
#include "devices/core/active_time.hpp"
#include "devices/core/kinds.hpp"
#include "devices/generic/random_numbers.hpp"
#include "devices/generic/uart_text.hpp"
#include "mebots/error.hpp"
#include "mebots/soc/device.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::soc {
namespace {

/// A FIFO of at most 255 bytes.
class ByteFifo {
 public:
  std::size_t size() const { return count_; }
  bool empty() const { return count_ == 0; }
  void clear() { count_ = 0; }
  /// The FIFO must not be full (255 bytes).
  void push(std::uint8_t byte) { bytes_[(first_ + count_++) % bytes_.size()] = byte; }
  /// Removes and returns the oldest byte. Returns 0 if the FIFO is empty.
  std::uint8_t pop() {
    if (count_ == 0) return 0;
    const auto byte = bytes_[first_];
    first_ = static_cast<std::uint8_t>((first_ + 1U) % bytes_.size());
    --count_;
    return byte;
  }

  void visit(state::Visitor& v) {
    v("bytes", bytes_);
    v("first", first_);
    v("count", count_);
  }

 private:
  std::array<std::uint8_t, 256> bytes_{};
  std::uint8_t first_ = 0;
  std::uint8_t count_ = 0;
};

/// Models a UART that is connected to a UART of another chip. A byte has a start bit, eight data bits, and one or two
/// stop bits.
///
/// Transmitter: a store to DATA puts a byte into the transmit FIFO. The line transmits bytes at BAUD. The text .sent
/// contains the bytes whose stop bits ended in this step.
///
/// Receiver: the text .received contains the bytes of the transmitter's previous step, with the time of each byte since
/// the start of that step. A byte arrives this time after the start of the receiver's step, and waits in the receive
/// FIFO for a load of DATA.
///
/// So a byte arrives one communication step after the end of its stop bit. If the transmitter steps before the receiver
/// (Gauss-Seidel), the byte arrives at the end of its stop bit.
///
/// The receiver samples the middle of each bit, timed from the start bit. A byte is garbled if the last sample, in the
/// stop bit, is off by half a bit or more. The device draws its active current while it transmits.
class Uart final : public Device {
 public:
  Uart(const BoardDevice& entry, ChipHost& host) : entry_(entry), host_(host), active_time_(entry) {
    for (const auto& variable : entry.variables) {
      if (auto* number = input(variable.name)) *number = variable.start;
    }
    check_settings();
  }

  bool load(std::uint32_t offset, Picoseconds now, std::uint32_t& value) override;
  bool load_is_quiet(std::uint32_t offset) const override { return offset != kData; }
  bool store(std::uint32_t offset, Picoseconds now, std::uint32_t value) override;
  void begin_step(Picoseconds now) override;
  void advance(Picoseconds now) override;
  Picoseconds next_event() const override { return std::min(sent_at_, next_arrival()); }
  bool interrupt() const override { return threshold_ != 0 && received_.size() >= threshold_; }
  double* input(std::string_view variable) override;
  std::string_view* text_input(std::string_view variable) override;
  const double* output(std::string_view variable) const override;
  const std::string* text_output(std::string_view variable) const override;
  double energy_j(Picoseconds now) const override { return active_time_.energy_j(now); }
  std::string_view state_name() const override { return active_time_.state_name(); }
  void program_ended() override { waiting_.clear(); }
  void visit(state::Visitor& v) override;

 private:
  static constexpr std::uint32_t kData = 0x0;
  static constexpr std::uint32_t kStatus = 0x4;
  static constexpr std::uint32_t kBaud = 0x8;
  static constexpr std::uint32_t kStopBits = 0xc;
  static constexpr std::uint32_t kThreshold = 0x10;
  static constexpr std::uint32_t kTransmits = 1U << 16;  // STATUS; bits 0 to 7: bytes received, 8 to 15: places to send
  static constexpr std::uint32_t kOverrun = 1U << 17;
  static constexpr std::uint32_t kDropped = 1U << 18;
  static constexpr std::uint32_t kGarbled = 1U << 19;
  static constexpr std::uint32_t kRefused = 1U << 20;
  static constexpr std::uint32_t kLeastBaud = 300;
  static constexpr std::uint32_t kMostBaud = 10'000'000;

  std::size_t depth() const { return static_cast<std::size_t>(depth_); }
  std::int64_t baud() const { return stored_baud_ != 0 ? stored_baud_ : static_cast<std::int64_t>(baud_after_reset_); }
  /// Returns the time of this number of bits, rounded to picoseconds.
  Picoseconds time_of(std::int64_t bits) const { return (bits * Picoseconds{1'000'000'000'000} + baud() / 2) / baud(); }
  Picoseconds next_arrival() const { return taken_ < arriving_.size() ? arriving_[taken_].end : kNever; }

  void check_settings() const;
  bool is_sound() const;
  std::uint32_t status() const;
  void transmit(std::uint8_t byte, Picoseconds now);
  void start_next(Picoseconds now);
  void end_transmission();
  void receive(UartByte byte);

  /// Calls `use` for each setting with four values: name, value, least value and greatest value.
  template <typename Use>
  void for_each_setting(Use use) const {
    use("baud", baud_after_reset_, kLeastBaud, kMostBaud);
    use("fifo_depth", depth_, 1, 255);
    use("error_rate", error_rate_, 0, 1);
  }

  /// Sets a flag for the firmware, and reports the device's first loss to the user.
  template <typename... Values>
  void lose(std::uint32_t flag, fmt::format_string<const Values&...> what, const Values&... values) {
    flags_ |= flag;
    if (complained_) return;
    complained_ = true;
    host_.complain(fmt::format("{}: {}; {}.bytes_lost counts all of them", entry_.name, fmt::format(what, values...),
                               entry_.name));
  }

  const BoardDevice& entry_;
  ChipHost& host_;
  ActiveTime active_time_;
  // Transmitter.
  ByteFifo waiting_;
  UartByte sending_;
  Picoseconds sent_at_ = kNever;
  Picoseconds step_began_ = 0;
  UartTextWriter sent_;
  // Receiver.
  UartText arrived_;                // a member only so that its memory is reused
  std::vector<UartByte> arriving_;  // sorted by `end`, which is the time since reset
  std::uint64_t taken_ = 0;         // number of bytes of arriving_ that have arrived
  std::uint64_t next_number_ = 0;   // number of the byte that the transmitter sends next
  ByteFifo received_;
  // Registers.
  std::uint32_t flags_ = 0;
  std::uint32_t stored_baud_ = 0;  // 0 = not stored since reset
  std::uint32_t stop_bits_ = 1;
  std::uint32_t threshold_ = 0;
  bool complained_ = false;
  // Variables.
  std::string_view received_text_;
  double baud_after_reset_ = 115200;
  double depth_ = 64;
  double error_rate_ = 0;
  double seed_ = 1;
  double bytes_sent_ = 0;
  double bytes_received_ = 0;
  double bytes_lost_ = 0;
  double bytes_garbled_ = 0;
};

double* Uart::input(std::string_view variable) {
  if (variable == entry_.name + ".baud") return &baud_after_reset_;
  if (variable == entry_.name + ".fifo_depth") return &depth_;
  if (variable == entry_.name + ".error_rate") return &error_rate_;
  if (variable == entry_.name + ".seed") return &seed_;
  return nullptr;
}

std::string_view* Uart::text_input(std::string_view variable) {
  return variable == entry_.name + ".received" ? &received_text_ : nullptr;
}

const double* Uart::output(std::string_view variable) const {
  if (variable == entry_.name + ".bytes_sent") return &bytes_sent_;
  if (variable == entry_.name + ".bytes_received") return &bytes_received_;
  if (variable == entry_.name + ".bytes_lost") return &bytes_lost_;
  if (variable == entry_.name + ".bytes_garbled") return &bytes_garbled_;
  return nullptr;
}

const std::string* Uart::text_output(std::string_view variable) const {
  return variable == entry_.name + ".sent" ? &sent_.text() : nullptr;
}

void Uart::check_settings() const {
  for_each_setting([&](std::string_view name, double value, double least, double most) {
    if (value >= least && value <= most) return;
    throw Error(
        ErrorCode::value_out_of_range,
        fmt::format("{}.{} = {} must be from {} to {}; change this parameter of the chip, or the variable's 'start' "
                    "in the board file",
                    entry_.name, name, value, least, most));
  });
}

/// Takes those bytes of the input text `received` that have not been taken before. If the transmitter's step is longer
/// than the receiver's, the text stays the same for several steps.
void Uart::begin_step(Picoseconds now) {
  check_settings();
  step_began_ = now;
  sent_.clear();
  read_uart_text(entry_.name + ".received", received_text_, arrived_);
  received_text_ = {};
  arriving_.erase(arriving_.begin(), arriving_.begin() + static_cast<std::ptrdiff_t>(taken_));
  taken_ = 0;
  auto number = arrived_.first;
  if (!arrived_.bytes.empty() && number > next_number_) {
    bytes_lost_ += static_cast<double>(number - next_number_);
    lose(0, "{} bytes of the sender never arrived; give this chip a step that is not longer than that of the sender",
         number - next_number_);
    next_number_ = number;
  }
  for (auto byte : arrived_.bytes) {
    if (number++ < next_number_) continue;
    byte.end += now;
    arriving_.push_back(byte);
    ++next_number_;
  }
}

void Uart::advance(Picoseconds now) {
  while (now >= next_event()) {
    if (sent_at_ <= next_arrival()) {
      end_transmission();
    } else {
      receive(arriving_[taken_++]);
    }
  }
}

void Uart::transmit(std::uint8_t byte, Picoseconds now) {
  if (waiting_.size() >= depth()) {
    bytes_lost_ += 1;
    lose(kDropped, "a byte was stored while the transmit FIFO of {} bytes was full, and is lost", depth());
    return;
  }
  waiting_.push(byte);
  if (sent_at_ == kNever) start_next(now);
}

void Uart::start_next(Picoseconds now) {
  active_time_.set(!waiting_.empty(), now);
  if (waiting_.empty()) {
    sent_at_ = kNever;
    return;
  }
  sending_ = {0, time_of(1), waiting_.pop()};
  sent_at_ = now + time_of(9 + stop_bits_);
}

void Uart::end_transmission() {
  sending_.end = sent_at_ - step_began_;
  sent_.add(static_cast<std::uint64_t>(bytes_sent_), sending_);
  bytes_sent_ += 1;
  start_next(sent_at_);
}

void Uart::receive(UartByte byte) {
  constexpr std::int64_t kHalfBitsToStop = 19;  // time from the start bit to the middle of the stop bit
  const auto number = static_cast<std::uint64_t>(bytes_received_);
  bytes_received_ += 1;
  const auto bit = time_of(1);
  if (std::abs(byte.bit - bit) * kHalfBitsToStop >= bit) {
    bytes_garbled_ += 1;
    flags_ |= kGarbled;
    return;
  }
  const auto random = random_state(static_cast<std::uint32_t>(static_cast<std::int32_t>(seed_)), number, 2);
  if (uniform_number(random) < error_rate_) {
    bytes_garbled_ += 1;
    byte.value ^= static_cast<std::uint8_t>(1U << static_cast<unsigned>(8 * uniform_number(random + kSplitMixStep)));
  }
  if (received_.size() >= depth()) {
    bytes_lost_ += 1;
    lose(kOverrun, "a byte arrived while the receive FIFO of {} bytes was full, and is lost", depth());
    return;
  }
  received_.push(byte.value);
}

std::uint32_t Uart::status() const {
  const auto places = depth() - std::min(depth(), waiting_.size());
  return static_cast<std::uint32_t>(received_.size() | places << 8) | flags_ | (sent_at_ != kNever ? kTransmits : 0);
}

bool Uart::load(std::uint32_t offset, Picoseconds /*now*/, std::uint32_t& value) {
  switch (offset) {
    case kData:
      value = received_.pop();
      return true;
    case kStatus:
      value = status();
      return true;
    case kBaud:
      value = static_cast<std::uint32_t>(baud());
      return true;
    case kStopBits:
      value = stop_bits_;
      return true;
    case kThreshold:
      value = threshold_;
      return true;
    default:
      return false;
  }
}

bool Uart::store(std::uint32_t offset, Picoseconds now, std::uint32_t value) {
  switch (offset) {
    case kData:
      transmit(static_cast<std::uint8_t>(value), now);
      return true;
    case kStatus:
      flags_ &= ~value;
      return true;
    case kBaud:
      if (value < kLeastBaud || value > kMostBaud) {
        flags_ |= kRefused;
      } else {
        stored_baud_ = value;
      }
      return true;
    case kStopBits:
      if (value != 1 && value != 2) {
        flags_ |= kRefused;
      } else {
        stop_bits_ = value;
      }
      return true;
    case kThreshold:
      threshold_ = value;
      return true;
    default:
      return false;
  }
}

/// Returns whether the values of a restored state are in their ranges, so that no calculation overflows.
bool Uart::is_sound() const {
  const auto within = [](auto value, decltype(value) least, decltype(value) most) {
    return value >= least && value <= most;
  };
  constexpr double kMostCount = 0x1p53;
  constexpr auto kSeeds = std::numeric_limits<std::int32_t>();
  bool settings = within(seed_, kSeeds.min(), kSeeds.max());
  for_each_setting([&](std::string_view, double value, double least, double most) {
    settings = settings && within(value, least, most);
  });
  const bool counts = within(bytes_sent_, 0, kMostCount) && within(bytes_received_, 0, kMostCount) &&
                      within(bytes_lost_, 0, kMostCount) && within(bytes_garbled_, 0, kMostCount);
  const bool registers = (stored_baud_ == 0 || within(stored_baud_, kLeastBaud, kMostBaud)) && within(stop_bits_, 1, 2);
  const bool times = sent_at_ >= 0 && step_began_ >= 0 && std::ranges::all_of(arriving_, [&](const UartByte& byte) {
                       return within(byte.bit, 1, kLongestUartBit);
                     });
  return settings && counts && registers && times && taken_ <= arriving_.size();
}

void Uart::visit(state::Visitor& v) {
  v("active_time", active_time_);
  v("waiting", waiting_);
  v("sending", sending_);
  v("sent_at", sent_at_);
  v("step_began", step_began_);
  v("sent", sent_);
  v("arriving", arriving_);
  v("taken", taken_);
  v("next_number", next_number_);
  v("received", received_);
  v("flags", flags_);
  v("stored_baud", stored_baud_);
  v("stop_bits", stop_bits_);
  v("threshold", threshold_);
  v("complained", complained_);
  v("baud_after_reset", baud_after_reset_);
  v("depth", depth_);
  v("error_rate", error_rate_);
  v("seed", seed_);
  v("bytes_sent", bytes_sent_);
  v("bytes_received", bytes_received_);
  v("bytes_lost", bytes_lost_);
  v("bytes_garbled", bytes_garbled_);
  if (v.restores() && !is_sound()) {
    throw Error(ErrorCode::state_damaged, "a saved state is damaged: a UART has a value out of its range");
  }
}

}  // namespace
}  // namespace mebots::soc

MEBOTS_CHIP_KIND(uart, {}, make_of_entry<Uart>)
