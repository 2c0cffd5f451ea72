// SPDX-License-Identifier: Apache-2.0
#include "tool/control.hpp"

#include "devices/core/chip_host.hpp"
#include "mebots/error.hpp"

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <limits>
#include <string_view>
#include <vector>

namespace mebots::soc::tool {
namespace {

/// Simulated time between two checks whether the program has printed the text for which the command "run" waits.
constexpr std::int64_t kLookNs = 10'000;
/// Longest time of one command. A double cannot represent all nanoseconds of longer times.
constexpr double kLongestS = 1e6;
constexpr std::uint32_t kLongestRead = 1U << 20;

std::string hex(const std::vector<std::uint8_t>& bytes) {
  std::string text;
  for (const auto byte : bytes) text += fmt::format("{:02x}", byte);
  return text;
}

/// Throws Error unless the value is a 32-bit whole number. `what` describes the value in the message, such as "an
/// address".
std::uint32_t whole_number(std::string_view what, const nlohmann::ordered_json& value) {
  constexpr std::uint32_t kMost = std::numeric_limits<std::uint32_t>::max();
  if (!value.is_number_unsigned() || value.get<std::uint64_t>() > kMost) {
    throw Error(fmt::format("read: {} must be {}, a whole number from 0 to 0x{:x}", value.dump(), what, kMost));
  }
  return value.get<std::uint32_t>();
}

}  // namespace

int ControlledConsole::read_byte() {
  if (input_.empty()) return ConsolePort::kNothingYet;
  const auto byte = static_cast<std::uint8_t>(input_.front());
  input_.pop_front();
  return byte;
}

long ControlledConsole::read(std::span<char> into) {
  if (input_.empty() && !into.empty()) return -EAGAIN;
  const auto count = static_cast<std::ptrdiff_t>(std::min(into.size(), input_.size()));
  std::copy_n(input_.begin(), count, into.begin());
  input_.erase(input_.begin(), input_.begin() + count);
  return count;
}

void Control::serve() {
  for (std::string line; std::getline(std::cin, line);) {
    fmt::print("{}\n", answer(line));
    std::fflush(stdout);
  }
}

std::string Control::answer(const std::string& line) {
  Json reply;
  try {
    reply = obey(Json::parse(line));
  } catch (const std::exception& error) {
    reply = {{"error", error.what()}};
  }
  return reply.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Control::Json Control::obey(const Json& command) {
  if (!command.is_object() || command.empty()) throw Error("a command is an object such as {\"run\": 0.001}");
  const auto first = command.begin();
  const auto& name = first.key();
  const auto& value = first.value();
  if (name == "run") return run(command);
  if (name == "read") return read(command);
  if (name == "get") return get(value.get<std::string>());
  if (name == "set") return set(value.get<std::string>(), command.at("value").get<double>());
  if (name == "report") return {{"report", Json::parse(report_())}};
  if (name == "send") {
    console_.send(value.get<std::string>());
    return state();
  }
  throw Error(fmt::format("unknown command {}; there are run, send, read, get, set and report", name));
}

/// Executes the command {"run": seconds, "until": text}. The run ends early if the program ends or prints the text.
/// Output in earlier replies does not count.
Control::Json Control::run(const Json& command) {
  const auto duration = command.at("run").get<double>();
  if (!(duration >= 0 && duration <= kLongestS)) {
    throw Error(fmt::format("run {}: a time is between 0 and {} s", duration, kLongestS));
  }
  const auto until = command.value("until", std::string());
  const auto found = [&] { return !until.empty() && console_.printed().find(until, told_) != std::string::npos; };
  auto now = soc_.now() / kPsPerNs;
  const auto end = now + static_cast<std::int64_t>(std::llround(duration * 1e9));
  while (now < end && soc_.running() && !found()) {
    now = std::min(now + kLookNs, end);
    soc_.begin_step();
    soc_.advance(now);
    session_.stepped();
  }
  auto reply = state();
  if (!until.empty()) {
    reply["found"] = found();
    const auto at = console_.printed().find(until, told_);
    const auto stop = found() ? at + until.size() : console_.printed().size();
    reply["console"] = console_.printed().substr(told_, stop - told_);
    told_ = stop;
  } else {
    reply["console"] = console_.printed().substr(told_);
    told_ = console_.printed().size();
  }
  return reply;
}

Control::Json Control::state() const {
  Json reply = {{"time_s", static_cast<double>(soc_.now()) * 1e-12}, {"running", soc_.running()}};
  if (soc_.end() == End::exited) reply["exit_code"] = soc_.exit_code();
  if (soc_.end() == End::host) reply["exit_code"] = host_code_();
  if (const auto fault = soc_.fault_text(); !fault.empty()) reply["fault"] = fault;
  return reply;
}

std::uint32_t Control::address_of(const Json& place) const {
  if (place.is_number()) return whole_number("an address", place);
  const auto name = place.get<std::string>();
  const auto address = soc_.program().symbol(name);
  if (!address) throw Error(fmt::format("{} has no symbol {}", soc_.program().origin(), name));
  return *address;
}

/// Executes the command {"read": symbol or address, "size": bytes}. Without a size, reads the size of the symbol, or 4
/// bytes at an address without a symbol.
Control::Json Control::read(const Json& command) const {
  const auto address = address_of(command.at("read"));
  const auto& symbols = soc_.program().symbols();
  const auto symbol = std::ranges::find_if(
      symbols, [address](const auto& known) { return known.address == address && known.size != 0; });
  const auto known = symbol == symbols.end() ? 4 : symbol->size;
  const auto size = command.contains("size") ? whole_number("a size", command.at("size")) : known;
  if (size > kLongestRead) throw Error(fmt::format("read of {} bytes: at most {} at once", size, kLongestRead));
  std::vector<std::uint8_t> bytes(size);
  if (!soc_.memory().read(address, bytes)) {
    throw Error(fmt::format("read of {} bytes at 0x{:08x}: no memory there", size, address));
  }
  return {{"bytes", hex(bytes)}};
}

Control::Json Control::get(const std::string& name) const {
  const auto* output = soc_.devices().output(name);
  if (output == nullptr) output = soc_.devices().input(name);
  if (output == nullptr) throw Error(fmt::format("board {} has no variable {}", soc_.board().name, name));
  return {{"value", *output}};
}

Control::Json Control::set(const std::string& name, double value) {
  auto* input = soc_.devices().input(name);
  if (input == nullptr) throw Error(fmt::format("board {} has no input {}", soc_.board().name, name));
  *input = value;
  soc_.begin_step();
  return state();
}

}  // namespace mebots::soc::tool
