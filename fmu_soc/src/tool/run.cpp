// SPDX-License-Identifier: Apache-2.0
#include "tool/run.hpp"

#include "board/board_file.hpp"
#include "observe/session.hpp"
#include "observe/text_file.hpp"
#include "tool/control.hpp"
#include "tool/host_console.hpp"
#include "tool/host_services.hpp"
#include "tool/page.hpp"
#include "tool/report.hpp"
#include "tool/state_file.hpp"

#include "devices/gap8/himax.hpp"
#include "hart/csr_numbers.hpp"
#include "mebots/error.hpp"
#include "soc/soc.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace mebots::soc::tool {
namespace {

/// Cycles after which a run without a limit checks whether the program can still make progress.
constexpr std::uint64_t kSlice = 1U << 26;
/// Replaces kSlice if power over time is recorded: at 100 MHz, at least one point per millisecond.
constexpr std::uint64_t kFineSlice = 100'000;
/// Cycles between two saved states of a debugged run.
constexpr std::uint64_t kDebugSlice = 500'000;

bool has_kind(const BoardDescription& board, std::string_view kind) {
  return std::ranges::find(board.devices, kind, &BoardDevice::kind) != board.devices.end();
}

constexpr std::string_view kFlashKind = "gap8_udma";

/// Returns the bytes of a file, or nullopt if it is not a readable regular file.
std::optional<std::string> bytes_of(const std::string& path) {
  std::error_code error;
  std::ifstream file(path, std::ios::binary);
  if (!file || !std::filesystem::is_regular_file(path, error)) return std::nullopt;
  return std::string(std::istreambuf_iterator<char>(file), {});
}

std::vector<std::uint8_t> read_flash(const std::string& path) {
  const auto bytes = bytes_of(path);
  if (!bytes) throw Error(fmt::format("--flash {}: this is not a readable file", path));
  return {bytes->begin(), bytes->end()};
}

/// Returns the greatest number of active cycles of a core.
std::uint64_t busiest_cycles(const Soc& soc) {
  const auto* cluster = soc.cluster();
  return std::max(soc.hart().counters().cycles, cluster == nullptr ? 0 : cluster->longest_cycles());
}

/// Ends the run before the fabric controller executes more than the permitted number of instructions.
class InstructionLimit final : public Observer {
 public:
  explicit InstructionLimit(std::uint64_t last) : last_(last) {}
  bool before(const Hart& hart) override { return hart.counters().instructions < last_; }

 private:
  std::uint64_t last_;
};

struct Limits {
  std::optional<std::uint64_t> instructions;
  std::optional<Picoseconds> time;
  std::optional<Picoseconds> wall_time;
};

enum class Reached : std::uint8_t { none, instructions, time, wall_time };

/// Runs the chip in pieces up to a limit of the fabric controller's instructions. Every instruction takes at least one
/// cycle. Therefore, with N instructions left, a piece of N cycles does not exceed the limit.
class LimitedRun {
 public:
  /// @param spin_cycles  the run ends after this many cycles in an endless loop
  LimitedRun(Soc& soc, observe::Session& session, const Limits& limits, std::uint64_t slice, std::uint64_t spin_cycles)
      : soc_(soc),
        session_(session),
        limits_(limits),
        spin_cycles_(spin_cycles),
        slice_(limits.wall_time ? std::min(slice, kShortSlice) : slice) {}

  Reached run() {
    auto reached = Reached::none;
    while (reached == Reached::none && (soc_.running() || session_.rewind())) {
      session_.checkpoint();
      const auto before = busiest_cycles(soc_);
      reached = run_piece(before);
      if (busiest_cycles(soc_) == before && soc_.sleeps_for_good()) break;
      const bool spins = soc_.spins();
      spun_cycles_ = spins ? spun_cycles_ + slice_ : 0;
      if (!limits_.instructions && spins && spun_cycles_ >= spin_cycles_) break;
    }
    if (last_) session_.remove(*last_);
    return reached;
  }

 private:
  /// Length of a piece of the run if the host's time is limited.
  static constexpr std::uint64_t kShortSlice = 1U << 22;
  static constexpr Picoseconds kTimeSlice = 10'000'000'000;

  Reached run_piece(std::uint64_t before) {
    const auto& counters = soc_.hart().counters();
    auto piece = slice_;
    if (limits_.instructions && !last_) {
      const auto left = *limits_.instructions - counters.instructions;
      const auto cluster_lead = before - counters.cycles;
      if (left == 0) return Reached::instructions;
      if (left > cluster_lead) {
        piece = std::min(piece, left - cluster_lead);
      } else {
        // The busiest cluster core is at least `left` cycles ahead of the fabric controller. Therefore cycles cannot
        // limit the piece, and the observer counts instructions instead.
        session_.add(last_.emplace(*limits_.instructions));
      }
    }
    soc_.run_cycles(before + piece, piece_end());
    session_.stepped();
    if (limits_.time && soc_.running() && soc_.now() >= *limits_.time) return Reached::time;
    return limits_.wall_time && wall_time() >= *limits_.wall_time ? Reached::wall_time : Reached::none;
  }

  /// Returns the latest time at which the next piece of the run must end. This time also limits a piece in which all
  /// cores sleep.
  Picoseconds piece_end() const {
    const auto end = limits_.wall_time ? soc_.now() + kTimeSlice : Soc::kWithoutEnd;
    return limits_.time ? std::min(end, *limits_.time) : end;
  }

  Picoseconds wall_time() const {
    const std::chrono::nanoseconds passed = std::chrono::steady_clock::now() - start_;
    return passed.count() * kPsPerNs;
  }

  Soc& soc_;
  observe::Session& session_;
  Limits limits_;
  std::uint64_t spin_cycles_;
  std::uint64_t spun_cycles_ = 0;
  std::uint64_t slice_;
  std::optional<InstructionLimit> last_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

std::optional<std::uint32_t> tohost_of(const Soc& soc) {
  const auto address = soc.program().symbol("tohost");
  if (!address) return std::nullopt;
  std::uint32_t value = 0;
  soc.memory().read(*address, {reinterpret_cast<std::uint8_t*>(&value), sizeof value});
  return value;
}

/// Returns the hart to name in a message about the end of the run: the core at which a debugger ended the run, or else
/// the fabric controller.
unsigned last_hart(const Soc& soc) {
  const auto* cluster = soc.cluster();
  return cluster == nullptr ? kFabricControllerHart : hart_of_core(cluster->core_stopped_by_observer());
}

bool has_reported_end(const Soc& soc) {
  return soc.end() == End::host || soc.end() == End::exited || soc.end() == End::faulted;
}

/// Returns the reason why the run stopped before the program ended.
std::string reason_text(const Soc& soc, const Options& options, Reached reached) {
  switch (reached) {
    case Reached::instructions:
      return fmt::format("limit of {} instructions reached", *options.max_instructions);
    case Reached::time:
      return fmt::format("limit of {} of simulated time reached (--max-time)", *options.max_time);
    case Reached::wall_time:
      return fmt::format("limit of {} of wall time reached (--timeout)", *options.timeout);
    case Reached::none:
      break;
  }
  if (soc.hart().sleeping()) return "the core sleeps, and no event can wake it";
  return "endless loop";
}

std::string missing_end_text(const Soc& soc, const Options& options, Reached reached) {
  const auto number = last_hart(soc);
  const auto pc = soc.hart(number).pc();
  const auto function = soc.program().where(pc);
  const auto whose = number == kFabricControllerHart ? "" : fmt::format("cluster core {}, ", core_of_hart(number));
  const auto place =
      fmt::format("{}pc 0x{:08x} in {}", whose, pc, function.empty() ? "no function of the program" : function);
  const bool at_limit = options.max_instructions && soc.hart().counters().instructions == *options.max_instructions;
  if (at_limit) reached = Reached::instructions;
  if (soc.end() == End::stopped && !at_limit) return fmt::format("stopped by the debugger at {}", place);
  auto text = fmt::format("{} at {}", reason_text(soc, options, reached), place);
  if (soc.spins()) {
    text += ", an endless jump to itself: no enabled interrupt can end it";
    if (!soc.program().symbol("tohost")) text += "; the program cannot end itself, because it has no symbol tohost";
  }
  if (const auto exception = soc.unfinished_exception_text(); !exception.empty()) {
    text += fmt::format("; no handler has returned since {}", exception);
  }
  return text;
}

std::string outcome_text(const Soc& soc, const Options& options, Reached reached, int code) {
  if (soc.end() == End::faulted) return "fault: " + soc.fault_text();
  return code == kFaultOrLimit && !has_reported_end(soc) ? missing_end_text(soc, options, reached)
                                                         : fmt::format("exit {}", code);
}

/// Returns true if the program has received all pictures and waits for another picture.
bool has_seen_all(const Soc& soc, const Options& options) {
  return options.pictures && soc.hart().sleeping() && soc.devices().wait_for_picture();
}

int exit_code(const Soc& soc, std::optional<std::uint32_t> tohost) {
  if (soc.end() == End::host) return static_cast<int>(tohost.value_or(0) >> 1 & 0xffU);
  return soc.end() == End::exited ? soc.exit_code() & 0xff : kFaultOrLimit;
}

/// Prints each behaviour of the core that the program may not expect.
void print_remarks(const Soc& soc, bool is_alone) {
  const auto& remarks = soc.hart().csr_remarks();
  const auto print = [](std::string_view text) {
    fmt::print(stderr, "mebots-soc: {}; --core rv32imc is a core without this rule\n", text);
  };
  if (remarks.moved_mtvec) {
    print(fmt::format(
        "notice: the program wrote 0x{:08x} to mtvec; CV32E40P clears bits 7 to 2, so that handlers need "
        ".balign 256{}",
        *remarks.moved_mtvec, is_alone ? ". Without a board, traps enter the address that was written" : ""));
  }
  if (remarks.read_stopped_counter) {
    print(fmt::format("notice: the program read {}, which CV32E40P stops at reset: clear mcountinhibit first",
                      csr::name(*remarks.read_stopped_counter)));
  }
}

observe::Requests requests_of(const Options& options, const std::optional<RunPage>& page) {
  observe::Requests requests;
  requests.trace = options.trace;
  requests.trace_columns.cycles = options.trace_cycles;
  requests.profile = page ? page->profile() : options.profile;
  requests.power_trace = options.power_trace;
  requests.cycle_stack = options.report.has_value();
  requests.coverage = options.coverage;
  requests.pipeline = options.pipeline;
  requests.pipeline_hart = options.pipeline_hart;
  requests.gdb_port = options.gdb_port;
  requests.announce = [](std::string_view text) { fmt::print(stderr, "mebots-soc: {}\n", text); };
  return requests;
}

/// Size of heap and stack for a program that uses system calls. The host provides memory only for accessed pages.
constexpr std::uint64_t kUserHeap = std::uint64_t{128} << 20;
constexpr std::uint64_t kHeap = std::uint64_t{1} << 20;

BoardDescription board_of(const Options& options, const Elf& program) {
  BoardDescription board;
  if (options.board) {
    board = read_board(board_file(*options.board));
  } else if (options.ram.empty()) {
    board = board_around(program, options.user ? kUserHeap : kHeap);
  } else {
    board.name = "none";
  }
  for (const auto& ram : options.ram) add_ram(board, ram);
  // A program for an operating system expects that counters run, but CV32E40P stops them at reset.
  if (!options.board && options.user) set_core(board, "rv32imc");
  if (options.core) set_core(board, *options.core);
  return board;
}

HostConsole::Kind console_kind(const Options& options) {
  if (options.console) return *options.console == "pty" ? HostConsole::Kind::pty : HostConsole::Kind::stdio;
  return options.user ? HostConsole::Kind::lines : HostConsole::Kind::output;
}

/// Returns true if gdb can return to earlier instructions. Returns false if the program may change files of the host,
/// because these changes cannot be undone. Also returns false if there are other observers, whose files would contain
/// repeated instructions.
bool is_reversible(const Options& options, const observe::Requests& requests) {
  return requests.gdb_port && !options.user && !options.host_files && !options.page && !requests.writes();
}

/// Returns the receivers of the chip's messages. `page` and `history` may be empty, and must outlive the listeners.
Listeners listeners_of(HostConsole& console, std::optional<RunPage>& page, std::optional<debug::History>& history,
                       const Options& options) {
  Listeners listeners;
  listeners.console = [&console, &page](std::string_view line) {
    console.write(std::string(line) + '\n');
    if (page) page->printed(line);
  };
  listeners.faults = [&history](std::string_view text) {
    if (!history || !history->repeats()) fmt::print(stderr, "mebots-soc: {}\n", text);
  };
  listeners.console_byte = [&console, &page](std::uint8_t byte) {
    const auto character = static_cast<char>(byte);
    console.write({&character, 1});
    if (page) page->sent(character);
  };
  if (options.console) {
    listeners.console_input = [&console, &history](Picoseconds now, bool waits) {
      const auto read = [&] { return console.read_byte(now, waits); };
      return history ? history->input(read) : read();
    };
  }
  return listeners;
}

Listeners listeners_of(ControlledConsole& console) {
  Listeners listeners;
  listeners.console = [&console](std::string_view line) { console.write(std::string(line) + '\n'); };
  listeners.faults = [](std::string_view text) { fmt::print(stderr, "mebots-soc: {}\n", text); };
  listeners.console_byte = [&console](std::uint8_t byte) {
    const auto character = static_cast<char>(byte);
    console.write({&character, 1});
  };
  listeners.console_input = [&console](Picoseconds /*now*/, bool /*waits*/) { return console.read_byte(); };
  return listeners;
}

void write_reports(const ChipReport& report, std::optional<observe::TextFile>& json,
                   std::optional<observe::TextFile>& long_report, const observe::Session& session) {
  if (json) {
    json->put(json_text(report));
    json->close();
  }
  if (long_report) {
    long_report->put(json_text(report, *session.cycle_stack()));
    long_report->close();
  }
}

Limits limits_of(const Options& options) {
  Limits limits;
  limits.instructions = options.max_instructions;
  if (options.max_time) limits.time = time_of("--max-time", *options.max_time);
  if (options.timeout) limits.wall_time = time_of("--timeout", *options.timeout);
  return limits;
}

/// Restores a saved state. Throws Error if this state already exceeds a limit of the run.
void load_state(const std::string& path, const StateFile& file, Soc& soc, const Limits& limits) {
  file.load(path, soc);
  const auto instructions = soc.hart().counters().instructions;
  if (limits.instructions && instructions > *limits.instructions) {
    throw Error(fmt::format("--max-instructions {}: the state of --load-state {} is after instruction {}",
                            *limits.instructions, path, instructions));
  }
  if (limits.time && soc.now() > *limits.time) {
    throw Error(fmt::format("--max-time {} s: the state of --load-state {} is later, at {} s",
                            static_cast<double>(*limits.time) / kPsPerS, path,
                            static_cast<double>(soc.now()) / kPsPerS));
  }
}

}  // namespace

int run(const Options& options) {
  const auto program = Elf::read(options.program);
  const auto limits = limits_of(options);
  const auto board = board_of(options, program);
  auto chip = options.board ? chip_of(board) : gap8();
  if (!options.board) chip.timing.kind = CoreKind::cv32e40p;
  require_own_chip(options.program, board);
  Settings settings;
  settings.translate = !options.interpret;
  settings.keeps_written_mtvec = !options.board;
  for (const auto& folder : options.device_folders) settings.library_folders.emplace_back(folder);
  if (options.flash) {
    settings.flash = read_flash(*options.flash);
    if (!has_kind(board, kFlashKind)) {
      throw Error(fmt::format("--flash {}: board {} has no device of kind {}, which has the flash", *options.flash,
                              board.name, kFlashKind));
    }
  }
  if (options.pictures) {
    settings.pictures =
        read_pictures(*options.pictures, gap8_devices::Himax::kWidth, gap8_devices::Himax::kWindowHeight);
    if (!has_kind(board, kFlashKind)) {
      throw Error(fmt::format("--pictures {}: board {} has no device of kind {}, which has the camera",
                              *options.pictures, board.name, kFlashKind));
    }
  }
  std::optional<RunPage> page;
  if (options.page) page.emplace(*options.page, options.profile);
  auto requests = requests_of(options, page);
  std::optional<debug::History> history;
  if (is_reversible(options, requests)) history.emplace();
  HostConsole console(console_kind(options));
  if (history) console.mute_while([&history] { return history->repeats(); });
  ControlledConsole controlled;
  Soc soc(board, chip, settings, program,
          options.control ? listeners_of(controlled) : listeners_of(console, page, history, options));
  if (const auto tohost = program.symbol("tohost")) soc.program_host().watch(*tohost);
  std::optional<StateFile> state_file;
  if (options.load_state || options.save_state) state_file.emplace(options, soc);
  if (options.load_state) load_state(*options.load_state, *state_file, soc, limits);
  HostFiles files(options.host_files, options.control ? static_cast<Console&>(controlled) : console);
  HostServices services(soc, files, options.program);
  soc.program_host().serve(&services, options.user);
  if (options.user) services.begin_program(options.program, options.arguments);
  std::optional<Signature> signature;
  if (options.signature) signature.emplace(*options.signature, soc);
  std::optional<observe::TextFile> json;
  if (options.json) json.emplace("--json", *options.json);
  std::optional<observe::TextFile> long_report;
  if (options.report) long_report.emplace("--report", *options.report);
  std::optional<observe::TextFile> saved_state;
  if (options.save_state) saved_state.emplace("--save-state", *options.save_state);
  if (history) requests.history = &*history;
  observe::Session session(requests, soc);
  if (page) page->follow(soc, session);

  const auto start = std::chrono::steady_clock::now();
  const auto report_now = [&soc, start, first = soc.instructions()] {
    const std::chrono::duration<double, std::micro> passed = std::chrono::steady_clock::now() - start;
    return report_of(soc, static_cast<double>(soc.instructions() - first) / passed.count(), tohost_of(soc));
  };
  if (options.control) {
    const auto host_code = [&soc] { return exit_code(soc, tohost_of(soc)); };
    Control(
        soc, session, controlled, [&] { return json_text(report_now()); }, host_code)
        .serve();
    const auto code = has_reported_end(soc) ? exit_code(soc, tohost_of(soc)) : 0;
    session.finish(code);
    write_reports(report_now(), json, long_report, session);
    return code;
  }
  const auto slice = options.power_trace || page ? kFineSlice : history ? kDebugSlice : kSlice;
  const auto reached = LimitedRun(soc, session, limits, slice, history ? kSlice : 0).run();
  const auto report = report_now();
  const auto code = has_seen_all(soc, options) ? 0 : exit_code(soc, report.tohost);
  console.end_line();
  print(report);
  if (code == kFaultOrLimit && !has_reported_end(soc)) {
    fmt::print(stderr, "mebots-soc: {}\n", missing_end_text(soc, options, reached));
  }
  if (const auto advice = advice_after_fault(soc, options); !advice.empty()) {
    fmt::print(stderr, "mebots-soc: {}\n", advice);
  }
  print_remarks(soc, !options.board);
  session.finish(code);
  write_reports(report, json, long_report, session);
  if (page) page->write(report, options.program, outcome_text(soc, options, reached, code));
  if (signature) signature->write(soc);
  if (saved_state) state_file->save(*saved_state, soc);
  return code;
}

}  // namespace mebots::soc::tool
