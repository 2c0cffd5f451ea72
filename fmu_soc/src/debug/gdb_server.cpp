// SPDX-License-Identifier: Apache-2.0
#include "debug/gdb_server.hpp"

#include "debug/target.hpp"
#include "hart/csr_numbers.hpp"
#include "soc/backtrace.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <utility>

namespace mebots::soc::debug {
namespace {

constexpr std::string_view kError = "E01";
constexpr std::string_view kContinue = "vCont;";
constexpr std::uint32_t kLongestRead = 1U << 16;

std::string_view fault_signal(std::uint32_t cause) {
  return cause == cause::kIllegalInstruction ? "T04" : cause == cause::kBreakpoint ? "T05" : "T0b";
}

}  // namespace

GdbServer::GdbServer(int port, Soc& soc, Kill kill, std::function<void(std::string_view)> announce, History* history)
    : soc_(soc), kill_(kill), connection_(port), announce_(std::move(announce)), threads_(soc), history_(history) {
  for (unsigned number = 0; number < soc.harts(); ++number) harts_.emplace_back(*this, number);
  announce_(fmt::format("waiting for gdb: target remote 127.0.0.1:{}", connection_.port()));
}

bool GdbServer::accept_debugger() {
  if (!connection_.accept(awaited_)) return false;
  awaited_ = false;
  stepping_.reset();
  only_hart_.reset();
  breakpoints_.clear();
  watches_.clear();
  return true;
}

/// Answers packets until gdb resumes the program.
GdbServer::Resume GdbServer::serve() {
  if (!answer_.empty()) {
    connection_.send(std::exchange(answer_, {}));
  } else if (!held_) {
    connection_.send(stop_reply_);
  }
  held_ = true;
  stepping_.reset();
  step_range_ = {};
  only_hart_.reset();
  for (;;) {
    const auto packet = connection_.receive();
    if (!packet) break;  // gdb has disconnected: the run continues
    const auto resume = obey(*packet);
    if (resume == Resume::no) continue;
    held_ = false;
    if (resume == Resume::rewind) {
      history_->reach(here_);
      history_->set_leaves(true);
    }
    if (resume == Resume::step) stepping_ = threads_.chosen();
    return resume;
  }
  held_ = false;
  return Resume::run;
}

/// Executes a packet. A result other than `no` ends serve().
GdbServer::Resume GdbServer::obey(const std::string& packet) {
  const auto resume_at = [this](std::string_view text) {
    if (const auto address = parse_hex(text)) write_register(kPcNumber, *address);
  };
  switch (packet.empty() ? '\0' : packet[0]) {
    case '\x03':
      return Resume::no;  // the program is already stopped
    case 'c':
      resume_at(std::string_view(packet).substr(1));
      return Resume::run;
    case 's':
      resume_at(std::string_view(packet).substr(1));
      return Resume::step;
    case 'C':
      return Resume::run;
    case 'S':
      return Resume::step;
    case 'b':
      if (history_ != nullptr && (packet == "bs" || packet == "bc")) return reverse(packet == "bs");
      break;
    case 'D':
      connection_.send("OK");
      connection_.disconnect();
      return Resume::run;
    case 'k':
      connection_.disconnect();
      return kill_ == Kill::ends_run ? Resume::end : Resume::run;
    default:
      break;
  }
  if (packet.starts_with(kContinue)) return resume(std::string_view(packet).substr(kContinue.size()));
  if (packet.starts_with("vKill")) {
    connection_.send("OK");
    connection_.disconnect();
    return kill_ == Kill::ends_run ? Resume::end : Resume::run;
  }
  constexpr std::string_view kCommand = "qRcmd,";
  if (packet.starts_with(kCommand)) {
    const auto command = from_hex(std::string_view(packet).substr(kCommand.size())).value_or("");
    const auto resume = history_ == nullptr ? std::nullopt : travel(command);
    if (resume) return *resume;
    connection_.send(to_hex(monitor(command)));
    return Resume::no;
  }
  connection_.send(answer(packet));
  if (packet == "QStartNoAckMode") connection_.stop_acknowledging();
  return Resume::no;
}

/// Resumes threads. "s:2;c": thread 2 makes a step, and all others continue. "r1c000042,1c00004c:2" runs thread 2 until
/// it leaves this range. After "s:2" or "c:2", gdb expects the other threads to stay stopped. This is impossible if the
/// resumed thread waits for them. Therefore the other threads also run, but their events are not reported.
GdbServer::Resume GdbServer::resume(std::string_view actions) {
  const auto step = actions.find_first_of("sSr");
  const auto begin = step == std::string_view::npos ? 0 : step;
  const auto action = actions.substr(begin, actions.find(';', begin) - begin);
  if (action.starts_with('r')) {
    const auto range = action.substr(1, action.find(':') - 1);
    const auto comma = std::min(range.find(','), range.size());
    const auto first = parse_hex(range.substr(0, comma));
    const auto end = parse_hex(range.substr(std::min(comma + 1, range.size())));
    if (first && end && *first < *end) step_range_ = {*first, *end - *first};
  }
  if (const auto colon = action.find(':'); colon != std::string_view::npos) {
    const auto text = action.substr(colon + 1);
    if (const auto number = threads_.parse(text)) threads_.choose(*number);
    if (action.size() == actions.size() && text != "-1") only_hart_ = threads_.chosen();
  }
  return step == std::string_view::npos ? Resume::run : Resume::step;
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
    case 'H': {
      const auto number = threads_.parse(rest.substr(std::min<std::size_t>(1, rest.size())));
      // "Hc" has no effect, because vCont selects the threads to resume.
      if (number && rest.starts_with('g')) threads_.choose(*number);
      return number ? "OK" : std::string(kError);
    }
    case 'T':
      return threads_.parse(rest) ? "OK" : std::string(kError);
    case 'q':
      return query(packet);
    default:
      break;
  }
  if (packet == "vCont?") return "vCont;c;C;s;S;r";
  if (packet == "QStartNoAckMode") return "OK";
  return {};  // unknown packet
}

std::string GdbServer::query(std::string_view text) {
  constexpr std::string_view kDescription = "qXfer:features:read:target.xml:";
  constexpr std::string_view kThreadText = "qThreadExtraInfo,";
  if (text.starts_with("qSupported")) {
    return fmt::format("PacketSize=4000;qXfer:features:read+;QStartNoAckMode+;vContSupported+;swbreak+;hwbreak+{}",
                       history_ == nullptr ? "" : ";ReverseStep+;ReverseContinue+");
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
  if (text.starts_with(kThreadText)) {
    const auto number = threads_.parse(text.substr(kThreadText.size()));
    return number ? to_hex(threads_.describe(*number)) : std::string(kError);
  }
  if (text == "qC") return fmt::format("QC{:x}", threads_.chosen() + 1);
  if (text == "qfThreadInfo") return threads_.list();
  if (text == "qsThreadInfo") return "l";
  if (text.starts_with("qAttached")) return kill_ == Kill::ends_run ? "0" : "1";
  if (text == "qOffsets") return "Text=0;Data=0;Bss=0";
  return {};
}

std::string GdbServer::monitor(std::string_view command) const {
  const auto& counters = threads_.hart().counters();
  if (command == "cycles") {
    return fmt::format("{} cycles, {} instructions\n", counters.cycles, counters.instructions);
  }
  if (command == "time") {
    return fmt::format("{:.9g} s, asleep for {:.9g} s of them\n", static_cast<double>(threads_.time()) * 1e-12,
                       static_cast<double>(soc_.sleep_time()) * 1e-12);
  }
  if (command == "energy") {
    const auto energy = soc_.power().energy_at(threads_.time());
    auto text = fmt::format("total {:.9g} J\n", energy.total_j());
    for (const auto& component : energy.components()) {
      text += fmt::format("{} {:.9g} J\n", component.name, component.energy_j);
    }
    return text;
  }
  if (command == "callers") {
    constexpr unsigned kReturnAddress = 1;
    constexpr unsigned kStackPointer = 2;
    const auto& hart = threads_.hart();
    const auto callers = backtrace(soc_.program(), soc_.memory(), hart.reg(kReturnAddress), hart.reg(kStackPointer));
    const auto here = soc_.program().where(hart.pc());
    return fmt::format("{}{}{}\n", here.empty() ? fmt::format("0x{:08x}", hart.pc()) : here,
                       callers.empty() ? "" : " < ", callers);
  }
  return history_ == nullptr ? "monitor commands: callers, cycles, energy, time\n"
                             : "monitor commands: callers, cycles, energy, time, reset, save NAME, restore NAME\n";
}

std::string GdbServer::read_registers() const {
  std::string text;
  for (unsigned i = 0; i <= kPcNumber; ++i) text += read_register(i);
  return text;
}

std::string GdbServer::read_register(unsigned number) const {
  const auto& hart = threads_.hart();
  if (number < kPcNumber) return little_endian(hart.reg(number));
  if (number == kPcNumber) return little_endian(hart.pc());
  std::uint32_t value = 0;
  if (number < kFirstCsrNumber || !hart.csr(number - kFirstCsrNumber, value)) return std::string(kError);
  return little_endian(value);
}

bool GdbServer::write_register(unsigned number, std::uint32_t value) {
  auto& hart = threads_.hart();
  if (number < kPcNumber) {
    const auto before = hart.reg(number);
    hart.set_reg(number, value);
    if (hart.reg(number) == before) return true;
  } else if (number == kPcNumber) {
    if (value == hart.pc()) return true;
    if (threads_.chosen() != 0) return false;  // the pc of a cluster core cannot change in the middle of a block
    hart.set_pc(value);
  } else if (number < kFirstCsrNumber || !hart.set_csr(number - kFirstCsrNumber, value)) {
    return false;
  }
  end_history();
  return true;
}

/// Deletes the saved states after gdb has changed the chip. The positions that `monitor save` has named become
/// unreachable, because they belong to the run without this change.
void GdbServer::end_history() {
  if (history_ == nullptr) return;
  history_->cut();
  for (auto& [name, position] : names_) position = kUnreachable;
}

std::string GdbServer::read_memory(std::string_view text) const {
  const auto range = parse_range(text);
  if (!range || range->size > kLongestRead) return std::string(kError);
  std::string bytes(range->size, '\0');
  if (!soc_.memory().read(range->address, {reinterpret_cast<std::uint8_t*>(bytes.data()), bytes.size()})) {
    return std::string(kError);  // device registers cannot be read, because a read may change them
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
  std::string before(range->size, '\0');
  soc_.memory().read(range->address, {reinterpret_cast<std::uint8_t*>(before.data()), before.size()});
  if (!soc_.poke(range->address, {reinterpret_cast<const std::uint8_t*>(bytes->data()), bytes->size()})) {
    return std::string(kError);
  }
  if (before != *bytes) end_history();
  return "OK";
}

/// Sets or clears a breakpoint or watchpoint. The text "0,1c000042,2" contains kind, address and size.
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

void GdbServer::hold_at_fault() {
  if (std::exchange(ended_, true) || !connection_.connected()) return;
  const auto number = soc_.cluster() == nullptr ? kFabricControllerHart : hart_of_core(soc_.cluster()->faulted_core());
  stop(number, fault_signal(std::as_const(soc_).hart(number).fault().last.cause));
  announce_(soc_.fault_text());
  if (history_ != nullptr) here_ = history_->position();
  killed_ = serve() == Resume::end;
}

void GdbServer::finish(int exit_code) {
  if (soc_.end() == End::faulted) hold_at_fault();
  if (connection_.connected()) connection_.send(fmt::format("W{:02x}", exit_code & 0xff));
}

}  // namespace mebots::soc::debug
