// SPDX-License-Identifier: Apache-2.0
//
// A program's calls to the machine that it is simulated on, and the word by which it ends.
#include "hart/look_ahead.hpp"
#include "soc/soc.hpp"

#include <fmt/core.h>

#include <array>
#include <span>

namespace mebots::soc {
namespace {

constexpr unsigned kArgument0 = 10;
constexpr std::uint32_t kCommandSize = 8;
constexpr std::uint64_t kPayload = 0xffff'ffff'ffff;

/// False if tohost is a single word: its size is 4, or another symbol is in its upper half.
bool has_upper_half(const Elf& program, std::uint32_t tohost) {
  for (const auto& symbol : program.symbols()) {
    if (symbol.address == tohost && symbol.size == 4) return false;
    if (symbol.address > tohost && symbol.address < tohost + kCommandSize) return false;
  }
  return true;
}

}  // namespace

void Soc::stop_when_stored(std::uint32_t address) {
  if (memory_.find(address, 4) == nullptr) {
    throw Error(fmt::format("{}: its symbol tohost is at 0x{:08x}, where there is no memory to watch",
                            program_.origin(), address));
  }
  stop_word_ = address;
  has_upper_half_ = has_upper_half(program_, address) && memory_.find(address, kCommandSize) != nullptr;
  memory_.mark(address, has_upper_half_ ? kCommandSize : 4, Region::kWatch);
}

std::uint64_t Soc::command_to_host() const {
  std::uint64_t command = 0;
  if (!stop_word_) return 0;
  memory_.read(*stop_word_, {reinterpret_cast<std::uint8_t*>(&command), has_upper_half_ ? kCommandSize : 4U});
  return command;
}

/// The fabric controller stops after such a store, and serve_command() looks at it.
bool Soc::watched(std::uint32_t /*address*/) {
  return command_to_host() != 0;
}

/// A core of the cluster does not stop for what it stores.
bool Soc::watched_by_cluster() {
  return command_to_host() != 0 && serve_command(command_to_host());
}

/// A 32-bit core stores the halves of a command one after the other, in either order. True if the other half is about
/// to be stored and makes it another command.
bool Soc::is_half_stored(std::uint64_t command) const {
  if (!has_upper_half_) return false;
  std::array<std::uint32_t, 32> x{};
  for (unsigned i = 0; i < x.size(); ++i) x[i] = hart_.reg(i);
  if (command >> 32 == 0) return upcoming_store(memory_, hart_.pc(), x, *stop_word_ + 4).value_or(0) != 0;
  const bool has_lower_half = static_cast<std::uint32_t>(command) != 0;
  return !has_lower_half && upcoming_store(memory_, hart_.pc(), x, *stop_word_).has_value();
}

/// True: the program ends. A command has its device in the upper 8 bits, then 8 bits of what the device is to do, and
/// 48 bits for it. Source: riscv-isa-sim, fesvr/device.h, and fesvr/htif.cc for the answer.
bool Soc::serve_command(std::uint64_t command) {
  const auto device = static_cast<unsigned>(command >> 56);
  const auto what = static_cast<unsigned>(command >> 48 & 0xffU);
  if (device == 0 && what == 0) {
    if ((command & 1U) != 0) return true;
    return host_calls_ != nullptr && serve_system_call(static_cast<std::uint32_t>(command));
  }
  if (host_calls_ == nullptr) return false;
  host_calls_->device_command(device, what, command & kPayload);
  clear_command();
  return false;
}

void Soc::clear_command() {
  constexpr std::array<std::uint8_t, kCommandSize> kNone{};
  poke(*stop_word_, std::span(kNone).first(has_upper_half_ ? kCommandSize : 4));
}

/// Of the HTIF, device 0: eight 64-bit words at `block`, number and arguments, of which the first takes the result.
/// True: the program ends. Source: riscv-isa-sim, fesvr/syscall.cc.
bool Soc::serve_system_call(std::uint32_t block) {
  std::array<std::uint64_t, 8> words{};
  const auto bytes = std::span(reinterpret_cast<std::uint8_t*>(words.data()), sizeof words);
  if (!memory_.read(block, bytes)) return false;
  std::array<std::uint32_t, 7> arguments{};
  for (std::size_t i = 0; i < arguments.size(); ++i) arguments[i] = static_cast<std::uint32_t>(words[i + 1]);
  const auto reply = host_calls_->system_call(static_cast<std::uint32_t>(words[0]), arguments);
  const auto store = [this](std::uint32_t address, auto value) {
    poke(address, {reinterpret_cast<const std::uint8_t*>(&value), sizeof value});
  };
  if (reply.exit_code) {
    store(*stop_word_, *reply.exit_code << 1 | 1U);
    return true;
  }
  store(block, static_cast<std::uint64_t>(std::int64_t{static_cast<std::int32_t>(reply.value)}));
  clear_command();
  if (const auto from_host = program_.symbol("fromhost")) store(*from_host, std::uint32_t{1});
  return false;
}

/// An ebreak between two instructions that do nothing else. Source: RISC-V Semihosting 1.0.
bool Soc::called_host() {
  constexpr std::array<std::uint32_t, 3> kCall{0x01f01013, 0x00100073, 0x40705013};
  std::array<std::uint32_t, 3> words{};
  if (host_calls_ == nullptr) return false;
  if (!memory_.read(hart_.pc() - 4, {reinterpret_cast<std::uint8_t*>(words.data()), sizeof words})) return false;
  if (words != kCall) return false;
  const auto reply = host_calls_->semihosting(hart_.reg(kArgument0), hart_.reg(kArgument0 + 1));
  hart_.set_reg(kArgument0, reply.value);
  host_exit_ = reply.exit_code;
  return true;
}

}  // namespace mebots::soc
