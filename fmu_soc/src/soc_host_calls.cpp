// SPDX-License-Identifier: Apache-2.0
//
// A program's calls to the machine that it is simulated on, and the word by which it ends.
#include "soc.hpp"

#include <fmt/core.h>

#include <array>
#include <span>

namespace mebots::soc {
namespace {

constexpr unsigned kArgument0 = 10;

}  // namespace

void Soc::stop_when_stored(std::uint32_t address) {
  if (memory_.find(address, 4) == nullptr) {
    throw Error(fmt::format("{}: its symbol tohost is at 0x{:08x}, where there is no memory to watch",
                            program_.origin(), address));
  }
  stop_word_ = address;
  memory_.mark(address, 4, Region::kWatch);
}

bool Soc::watched(std::uint32_t /*address*/) {
  std::uint32_t word = 0;
  if (!stop_word_ || !memory_.read(*stop_word_, {reinterpret_cast<std::uint8_t*>(&word), sizeof word})) return false;
  if ((word & 1U) != 0) return true;
  return word != 0 && host_calls_ != nullptr && serve_system_call(word);
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
  store(*stop_word_, std::uint32_t{0});
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
