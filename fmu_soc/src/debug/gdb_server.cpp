// SPDX-License-Identifier: Apache-2.0
#include "debug/gdb_server.hpp"

#include "debug/hex.hpp"
#include "debug/target_description.hpp"
#include "hart/csr_numbers.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <utility>

namespace mebots::soc::debug {
namespace {

/// How many instructions pass between two looks for Ctrl-C or a new debugger.
constexpr std::uint32_t kPatience = 1U << 12;
constexpr std::string_view kError = "E01";
constexpr std::string_view kTrap = "T05";
constexpr std::string_view kInterrupted = "T02";
constexpr std::uint32_t kLongestRead = 1U << 16;

std::string fault_reply(std::uint32_t cause) {
  return cause == cause::kIllegalInstruction ? "T04" : cause == cause::kBreakpoint ? "T05" : "T0b";
}

}  // namespace

GdbServer::GdbServer(int port, Soc& soc, Kill kill, std::function<void(std::string_view)> announce)
    : soc_(soc), kill_(kill), connection_(port), announce_(std::move(announce)), stop_reply_(kTrap) {
  announce_(fmt::format("waiting for gdb: target remote 127.0.0.1:{}", connection_.port()));
}

bool GdbServer::meet_debugger() {
  if (!connection_.accept(awaited_)) return false;
  awaited_ = false;
  stepping_ = false;
  breakpoints_.clear();
  watches_.clear();
  watch_reply_.clear();
  return true;
}

bool GdbServer::before(Hart& hart) {
  const bool look = (++ticks_ & (kPatience - 1)) == 0;
  // NOLINTBEGIN(bugprone-branch-clone): the order of the questions is the rule
  if (!connection_.connected()) {
    if (!(awaited_ || look) || !meet_debugger()) return true;
    stop_reply_ = kTrap;
    held_ = true;  // gdb asks why by itself
  } else if (!watch_reply_.empty()) {
    stop_reply_ = std::exchange(watch_reply_, {});
  } else if (resumed_ && hart.pc() == resumed_pc_ && hart.counters().instructions == resumed_instructions_) {
    return true;
  } else if (stepping_) {
    stop_reply_ = kTrap;
  } else if (breakpoints_.contains(hart.pc())) {
    stop_reply_ = "T05swbreak:;";
  } else if (look && connection_.interrupted()) {
    stop_reply_ = kInterrupted;
  } else {
    return true;
  }
  // NOLINTEND(bugprone-branch-clone)
  const bool goes_on = serve() != Resume::end;
  resumed_ = true;
  resumed_pc_ = hart.pc();
  resumed_instructions_ = hart.counters().instructions;
  return goes_on;
}

void GdbServer::retired(const Hart& /*hart*/, const Retired& instruction) {
  const auto& access = instruction.access;
  if (watches_.empty() || access.size == 0) return;
  for (const auto& watch : watches_) {
    if (watch.kind == (access.store ? '3' : '2')) continue;
    if (access.address < std::uint64_t{watch.address} + watch.size &&
        watch.address < std::uint64_t{access.address} + access.size) {
      const auto* name = watch.kind == '2' ? "watch" : watch.kind == '3' ? "rwatch" : "awatch";
      watch_reply_ = fmt::format("T05{}:{:08x};", name, watch.address);
      return;
    }
  }
}

/// Answers gdb until it lets the program go on.
GdbServer::Resume GdbServer::serve() {
  if (!held_) connection_.send(stop_reply_);
  held_ = true;
  stepping_ = false;
  for (;;) {
    const auto packet = connection_.receive();
    if (!packet) break;  // gone: the run goes on without
    const auto resume = obey(*packet);
    if (resume == Resume::no) continue;
    held_ = false;
    stepping_ = resume == Resume::step;
    return resume;
  }
  held_ = false;
  return Resume::go_on;
}

/// Does what a packet says; anything but `no` ends the conversation for now.
GdbServer::Resume GdbServer::obey(const std::string& packet) {
  const auto go_on_at = [this](std::string_view text) {
    if (const auto address = parse_hex(text)) soc_.hart().set_pc(*address);
  };
  switch (packet.empty() ? '\0' : packet[0]) {
    case '\x03':
      return Resume::no;  // it stands already
    case 'c':
      go_on_at(std::string_view(packet).substr(1));
      return Resume::go_on;
    case 's':
      go_on_at(std::string_view(packet).substr(1));
      return Resume::step;
    case 'C':
      return Resume::go_on;
    case 'S':
      return Resume::step;
    case 'D':
      connection_.send("OK");
      connection_.disconnect();
      return Resume::go_on;
    case 'k':
      connection_.disconnect();
      return kill_ == Kill::ends_run ? Resume::end : Resume::go_on;
    default:
      break;
  }
  if (packet.starts_with("vCont;c") || packet.starts_with("vCont;C")) return Resume::go_on;
  if (packet.starts_with("vCont;s") || packet.starts_with("vCont;S")) return Resume::step;
  if (packet.starts_with("vKill")) {
    connection_.send("OK");
    connection_.disconnect();
    return kill_ == Kill::ends_run ? Resume::end : Resume::go_on;
  }
  connection_.send(answer(packet));
  if (packet == "QStartNoAckMode") connection_.stop_acknowledging();
  return Resume::no;
}

std::string GdbServer::answer(const std::string& packet) {
  const auto rest = std::string_view(packet).substr(packet.empty() ? 0 : 1);
  switch (packet.empty() ? '\0' : packet[0]) {
    case '?':
      return stop_reply_;
    case 'g':
      return read_registers();
    case 'G':
      for (unsigned i = 0; i <= kPcNumber && rest.size() >= 8UL * (i + 1); ++i) {
        const auto value = parse_little_endian(rest.substr(8UL * i, 8));
        if (!value || !write_register(i, *value)) return std::string(kError);
      }
      return "OK";
    case 'p': {
      const auto number = parse_hex(rest);
      return number ? read_register(*number) : std::string(kError);
    }
    case 'P': {
      const auto equals = std::min(rest.find('='), rest.size());
      const auto number = parse_hex(rest.substr(0, equals));
      const auto value = parse_little_endian(rest.substr(std::min(equals + 1, rest.size())));
      return number && value && write_register(*number, *value) ? "OK" : std::string(kError);
    }
    case 'm':
      return read_memory(rest);
    case 'M':
      return write_memory(rest, false);
    case 'X':
      return write_memory(rest, true);
    case 'Z':
      return change_point(rest, true);
    case 'z':
      return change_point(rest, false);
    case 'H':
    case 'T':
      return "OK";
    case 'q':
      return query(packet);
    default:
      break;
  }
  if (packet == "vCont?") return "vCont;c;C;s;S";
  if (packet == "QStartNoAckMode") return "OK";
  return {};  // not known here
}

std::string GdbServer::query(std::string_view text) {
  constexpr std::string_view kDescription = "qXfer:features:read:target.xml:";
  constexpr std::string_view kCommand = "qRcmd,";
  if (text.starts_with("qSupported")) {
    return "PacketSize=4000;qXfer:features:read+;QStartNoAckMode+;vContSupported+;swbreak+;hwbreak+";
  }
  if (text.starts_with(kDescription)) {
    const auto part = text.substr(kDescription.size());
    const auto comma = std::min(part.find(','), part.size());
    const auto offset = parse_hex(part.substr(0, comma));
    const auto length = parse_hex(part.substr(std::min(comma + 1, part.size())));
    if (!offset || !length) return std::string(kError);
    const auto whole = target_description();
    if (*offset >= whole.size()) return "l";
    const bool last = whole.size() - *offset <= *length;
    return (last ? "l" : "m") + whole.substr(*offset, *length);
  }
  if (text.starts_with(kCommand)) return to_hex(monitor(from_hex(text.substr(kCommand.size())).value_or("")));
  if (text == "qC") return "QC1";
  if (text == "qfThreadInfo") return "m1";
  if (text == "qsThreadInfo") return "l";
  if (text.starts_with("qAttached")) return kill_ == Kill::ends_run ? "0" : "1";
  if (text == "qOffsets") return "Text=0;Data=0;Bss=0";
  return {};
}

std::string GdbServer::monitor(std::string_view command) const {
  const auto& counters = soc_.hart().counters();
  if (command == "cycles") {
    return fmt::format("{} cycles, {} instructions\n", counters.cycles, counters.instructions);
  }
  if (command == "time") {
    return fmt::format("{:.9g} s, of it asleep {:.9g} s\n", static_cast<double>(soc_.core_time()) * 1e-12,
                       static_cast<double>(soc_.sleep_time()) * 1e-12);
  }
  if (command == "energy") {
    const auto energy = soc_.energy_at_core();
    auto text = fmt::format("total {:.9g} J\n", energy.total_j());
    for (const auto& component : energy.components()) {
      text += fmt::format("{} {:.9g} J\n", component.name, component.energy_j);
    }
    return text;
  }
  return "monitor commands: cycles, time, energy\n";
}

std::string GdbServer::read_registers() const {
  std::string text;
  for (unsigned i = 0; i <= kPcNumber; ++i) text += read_register(i);
  return text;
}

std::string GdbServer::read_register(unsigned number) const {
  const auto& hart = soc_.hart();
  if (number < kPcNumber) return little_endian(hart.reg(number));
  if (number == kPcNumber) return little_endian(hart.pc());
  std::uint32_t value = 0;
  if (number < kFirstCsrNumber || !hart.csr(number - kFirstCsrNumber, value)) return std::string(kError);
  return little_endian(value);
}

bool GdbServer::write_register(unsigned number, std::uint32_t value) {
  auto& hart = soc_.hart();
  if (number < kPcNumber) {
    hart.set_reg(number, value);
  } else if (number == kPcNumber) {
    if (value != hart.pc()) hart.set_pc(value);
  } else {
    return number >= kFirstCsrNumber && hart.set_csr(number - kFirstCsrNumber, value);
  }
  return true;
}

std::string GdbServer::read_memory(std::string_view text) const {
  const auto range = parse_range(text);
  if (!range || range->size > kLongestRead) return std::string(kError);
  std::string bytes(range->size, '\0');
  if (!soc_.memory().read(range->address, {reinterpret_cast<std::uint8_t*>(bytes.data()), bytes.size()})) {
    return std::string(kError);  // registers of devices too: reading one can change it
  }
  return to_hex(bytes);
}

std::string GdbServer::write_memory(std::string_view text, bool binary) {
  const auto colon = text.find(':');
  if (colon == std::string_view::npos) return std::string(kError);
  const auto range = parse_range(text.substr(0, colon));
  const auto content = text.substr(colon + 1);
  const auto bytes = binary ? std::optional<std::string>(content) : from_hex(content);
  if (!range || !bytes || bytes->size() != range->size) return std::string(kError);
  return soc_.poke(range->address, {reinterpret_cast<const std::uint8_t*>(bytes->data()), bytes->size()})
             ? "OK"
             : std::string(kError);
}

/// "0,1c000042,2": kind, address, size.
std::string GdbServer::change_point(std::string_view text, bool insert) {
  if (text.size() < 3 || text[1] != ',') return std::string(kError);
  const auto range = parse_range(text.substr(2));
  if (!range) return std::string(kError);
  if (text[0] == '0' || text[0] == '1') {
    if (insert) {
      breakpoints_.insert(range->address);
    } else {
      breakpoints_.erase(range->address);
    }
    return "OK";
  }
  if (text[0] > '4') return {};
  const Watch watch{range->address, range->size, text[0]};
  std::erase(watches_, watch);
  if (insert) watches_.push_back(watch);
  return "OK";
}

void GdbServer::finish(int exit_code) {
  if (std::exchange(ended_, true) || !connection_.connected()) return;
  if (soc_.end() == End::faulted) {
    stop_reply_ = fault_reply(soc_.hart().fault().cause);
    announce_(soc_.fault_text());
    serve();
  }
  if (connection_.connected()) connection_.send(fmt::format("W{:02x}", exit_code & 0xff));
}

}  // namespace mebots::soc::debug
