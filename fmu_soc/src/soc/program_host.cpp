// SPDX-License-Identifier: Apache-2.0
#include "soc/program_host.hpp"

#include "hart/fetch.hpp"
#include "mebots/error.hpp"

#include <fmt/core.h>

#include <array>
#include <span>

namespace mebots::soc {
namespace {

constexpr unsigned kArgument0 = 10;
constexpr unsigned kArgument7 = 17;
constexpr std::uint32_t kCommandSize = 8;
constexpr std::uint64_t kPayload = 0xffff'ffff'ffff;

/// Returns true if the word `tohost` has an upper half. It has none if its symbol has a size of 4 bytes, or if another
/// symbol is at the address of the upper half.
bool has_upper_half(const Elf& program, std::uint32_t tohost) {
  for (const auto& symbol : program.symbols()) {
    if (symbol.address == tohost && symbol.size == 4) return false;
    if (symbol.address > tohost && symbol.address < tohost + kCommandSize) return false;
  }
  return true;
}

}  // namespace

void ProgramHost::watch(std::uint32_t address) {
  if (hardware_.memory().find(address, 4) == nullptr) {
    throw Error(
        fmt::format("{}: its symbol tohost is at 0x{:08x}, where the board has no memory", program_.origin(), address));
  }
  stop_word_ = address;
  has_upper_half_ = has_upper_half(program_, address) && hardware_.memory().find(address, kCommandSize) != nullptr;
  hardware_.memory().mark(address, has_upper_half_ ? kCommandSize : 4, Region::kWatch);
}

std::uint64_t ProgramHost::command() const {
  std::uint64_t command = 0;
  if (!stop_word_) return 0;
  hardware_.memory().read(*stop_word_,
                          {reinterpret_cast<std::uint8_t*>(&command), has_upper_half_ ? kCommandSize : 4U});
  return command;
}

bool ProgramHost::is_half_stored(std::uint64_t command) const {
  if (!has_upper_half_) return false;
  std::array<std::uint32_t, 32> x{};
  for (unsigned i = 0; i < x.size(); ++i) x[i] = hardware_.controller().reg(i);
  if (command >> 32 == 0)
    return upcoming_store(hardware_.memory(), hardware_.controller().pc(), x, *stop_word_ + 4).value_or(0) != 0;
  const bool has_lower_half = static_cast<std::uint32_t>(command) != 0;
  return !has_lower_half && upcoming_store(hardware_.memory(), hardware_.controller().pc(), x, *stop_word_).has_value();
}

/// The upper 8 bits of a command are the number of the device, the next 8 bits are the device's command, and the low 48
/// bits are the payload. Source: riscv-isa-sim, fesvr/device.h; fesvr/htif.cc for the reply.
bool ProgramHost::serve_command(std::uint64_t command) {
  const auto device = static_cast<unsigned>(command >> 56);
  const auto what = static_cast<unsigned>(command >> 48 & 0xffU);
  if (device == 0 && what == 0) {
    if ((command & 1U) != 0) return true;
    return calls_ != nullptr && serve_system_call(static_cast<std::uint32_t>(command));
  }
  if (calls_ == nullptr) return false;
  calls_->device_command(device, what, command & kPayload);
  clear_command();
  return false;
}

void ProgramHost::clear_command() {
  constexpr std::array<std::uint8_t, kCommandSize> kNone{};
  hardware_.poke(*stop_word_, std::span(kNone).first(has_upper_half_ ? kCommandSize : 4));
}

/// Executes a system call of the host-target interface (HTIF). `block` is the address of eight 64-bit words: the number
/// of the call and its arguments. The first word receives the result. Returns true if the call ends the program.
/// Source: riscv-isa-sim, fesvr/syscall.cc.
bool ProgramHost::serve_system_call(std::uint32_t block) {
  std::array<std::uint64_t, 8> words{};
  const auto bytes = std::span(reinterpret_cast<std::uint8_t*>(words.data()), sizeof words);
  if (!hardware_.memory().read(block, bytes)) return false;
  std::array<std::uint32_t, 7> arguments{};
  for (std::size_t i = 0; i < arguments.size(); ++i) arguments[i] = static_cast<std::uint32_t>(words[i + 1]);
  const auto reply = calls_->system_call(static_cast<std::uint32_t>(words[0]), arguments);
  const auto store = [this](std::uint32_t address, auto value) {
    hardware_.poke(address, {reinterpret_cast<const std::uint8_t*>(&value), sizeof value});
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

/// A semihosting call is an ebreak between two instructions without effect. Source: RISC-V Semihosting 1.0.
bool ProgramHost::serve_semihosting() {
  constexpr std::array<std::uint32_t, 3> kCall{0x01f01013, 0x00100073, 0x40705013};
  std::array<std::uint32_t, 3> words{};
  if (calls_ == nullptr) return false;
  if (!hardware_.memory().read(hardware_.controller().pc() - 4,
                               {reinterpret_cast<std::uint8_t*>(words.data()), sizeof words}))
    return false;
  if (words != kCall) return false;
  const auto reply =
      calls_->semihosting(hardware_.controller().reg(kArgument0), hardware_.controller().reg(kArgument0 + 1));
  hardware_.controller().set_reg(kArgument0, reply.value);
  exit_code_ = reply.exit_code;
  return true;
}

bool ProgramHost::serve_environment_call() {
  if (!serves_ecall_) return false;
  std::array<std::uint32_t, 6> arguments{};
  for (unsigned i = 0; i < arguments.size(); ++i) arguments[i] = hardware_.controller().reg(kArgument0 + i);
  const auto reply = calls_->environment_call(hardware_.controller().reg(kArgument7), arguments);
  hardware_.controller().set_reg(kArgument0, reply.value);
  exit_code_ = reply.exit_code;
  return true;
}

}  // namespace mebots::soc
