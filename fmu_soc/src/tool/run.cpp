// SPDX-License-Identifier: Apache-2.0
#include "tool/run.hpp"

#include "board/board_file.hpp"
#include "observe/session.hpp"
#include "observe/text_file.hpp"
#include "tool/host_services.hpp"
#include "tool/report.hpp"

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

/// How far a run without a limit goes before it looks whether anything can still happen.
constexpr std::uint64_t kSlice = 1U << 26;
/// The same where power over time is wanted: a point in every millisecond at 100 MHz, at least.
constexpr std::uint64_t kFineSlice = 100'000;

bool has_kind(const BoardDescription& board, std::string_view kind) {
  return std::ranges::find(board.devices, kind, &BoardDevice::kind) != board.devices.end();
}

/// Which has a flash and a camera.
constexpr std::string_view kFlashKind = "gap8_udma";

/// Nothing where this is not a regular file that can be read.
std::optional<std::string> bytes_of(const std::string& path) {
  std::error_code error;
  std::ifstream file(path, std::ios::binary);
  if (!file || !std::filesystem::is_regular_file(path, error)) return std::nullopt;
  return std::string(std::istreambuf_iterator<char>(file), {});
}

std::vector<std::uint8_t> read_flash(const std::string& path) {
  const auto bytes = bytes_of(path);
  if (!bytes) throw Error(fmt::format("--flash {}: this is not a file that can be read", path));
  return {bytes->begin(), bytes->end()};
}

/// The most active cycles that a core has behind it.
std::uint64_t busiest_cycles(const Soc& soc) {
  const auto* cluster = soc.cluster();
  return std::max(soc.hart().counters().cycles, cluster == nullptr ? 0 : cluster->longest_cycles());
}

/// Ends the run before the fabric controller's instruction after the last one.
class InstructionLimit final : public Observer {
 public:
  explicit InstructionLimit(std::uint64_t last) : last_(last) {}
  bool before(const Hart& hart) override { return hart.counters().instructions < last_; }

 private:
  std::uint64_t last_;
};

/// Runs in pieces, because every instruction takes a cycle or more: with N instructions left, N cycles are safe. The
/// limit counts the fabric controller's instructions.
void run_instructions(Soc& soc, observe::Session& session, std::optional<std::uint64_t> limit, std::uint64_t slice) {
  const auto& counters = soc.hart().counters();
  std::optional<InstructionLimit> last;
  while (soc.running()) {
    const auto before = busiest_cycles(soc);
    const auto cluster_lead = before - counters.cycles;
    auto piece = slice;
    if (limit && !last) {
      const auto left = *limit - counters.instructions;
      if (left == 0) return;
      if (left > cluster_lead) {
        piece = std::min(slice, left - cluster_lead);
      } else {
        session.add(last.emplace(*limit));  // cycles cannot tell any more
      }
    }
    soc.run_cycles(before + piece);
    if (busiest_cycles(soc) == before) break;  // asleep for good
    if (!limit && soc.spins()) break;
  }
  if (last) session.remove(*last);
}

std::optional<std::uint32_t> tohost_of(const Soc& soc) {
  const auto address = soc.program().symbol("tohost");
  if (!address) return std::nullopt;
  std::uint32_t value = 0;
  soc.memory().read(*address, {reinterpret_cast<std::uint8_t*>(&value), sizeof value});
  return value;
}

/// The hart that a message of the end is about: the fabric controller, or the core at which a debugger ended the run.
unsigned last_hart(const Soc& soc) {
  const auto* cluster = soc.cluster();
  return cluster == nullptr ? kFabricControllerHart : hart_of_core(cluster->core_stopped_by_observer());
}

std::string missing_end_text(const Soc& soc, const Options& options) {
  const auto number = last_hart(soc);
  const auto pc = soc.hart(number).pc();
  const auto function = soc.program().where(pc);
  const auto whose = number == kFabricControllerHart ? "" : fmt::format("cluster core {}, ", core_of_hart(number));
  const auto place =
      fmt::format("{}pc 0x{:08x} in {}", whose, pc, function.empty() ? "no function of the program" : function);
  const bool at_limit = options.max_instructions && soc.hart().counters().instructions == *options.max_instructions;
  if (soc.end() == End::stopped && !at_limit) return fmt::format("stopped by the debugger at {}", place);
  if (soc.hart().sleeping()) return fmt::format("the core sleeps at {} and nothing is left that could wake it", place);
  auto text = options.max_instructions
                  ? fmt::format("limit of {} instructions reached at {}", *options.max_instructions, place)
                  : fmt::format("endless loop at {}", place);
  if (soc.spins()) {
    text += ", an endless jump to itself: no enabled interrupt can end it";
    if (!soc.program().symbol("tohost")) text += "; the program has no symbol tohost to end by";
  }
  if (const auto exception = soc.unfinished_exception_text(); !exception.empty()) {
    text += fmt::format("; no handler has returned since {}", exception);
  }
  return text;
}

/// The program has taken all pictures, and nothing but one more could wake it.
bool has_seen_all(const Soc& soc, const Options& options) {
  return options.pictures && soc.hart().sleeping() && soc.devices().wait_for_picture();
}

int exit_code(const Soc& soc, std::optional<std::uint32_t> tohost) {
  if (soc.end() == End::host) return static_cast<int>(tohost.value_or(0) >> 1 & 0xffU);
  return soc.end() == End::exited ? soc.exit_code() & 0xff : kFaultOrLimit;
}

/// Says once what the core did otherwise than the program may expect.
void print_remarks(const Soc& soc, bool is_alone) {
  const auto& remarks = soc.hart().csr_remarks();
  const auto print = [](std::string_view text) {
    fmt::print(stderr, "mebots-soc: {}; --core rv32imc is a core without this rule\n", text);
  };
  if (remarks.moved_mtvec) {
    print(
        fmt::format("notice: the program wrote 0x{:08x} to mtvec; CV32E40P clears bits 7 to 2, so that handlers need "
                    ".balign 256{}",
                    *remarks.moved_mtvec, is_alone ? ". Without a board, traps entered the address written" : ""));
  }
  if (remarks.read_stopped_counter) {
    print(fmt::format("notice: the program read {}, which CV32E40P stops at reset: clear mcountinhibit first",
                      csr::name(*remarks.read_stopped_counter)));
  }
}

observe::Requests requests_of(const Options& options) {
  observe::Requests requests;
  requests.trace = options.trace;
  requests.trace_columns.cycles = options.trace_cycles;
  requests.profile = options.profile;
  requests.power_trace = options.power_trace;
  requests.gdb_port = options.gdb_port;
  requests.announce = [](std::string_view text) { fmt::print(stderr, "mebots-soc: {}\n", text); };
  return requests;
}

}  // namespace

int run(const Options& options) {
  const auto program = Elf::read(options.program);
  auto chip = gap8();
  BoardDescription board;
  if (options.board) {
    board = read_board(board_file(*options.board));
    chip = chip_of(board);
  } else {
    board = board_around(program);
    chip.timing.kind = CoreKind::cv32e40p;
  }
  if (options.core) set_core(board, *options.core);
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
  Listeners listeners;
  listeners.console = [](std::string_view line) { fmt::print("{}\n", line); };
  listeners.faults = [](std::string_view text) { fmt::print(stderr, "mebots-soc: {}\n", text); };
  Soc soc(board, chip, settings, program, listeners);
  if (const auto tohost = program.symbol("tohost")) soc.program_host().watch(*tohost);
  HostFiles files(options.host_files);
  HostServices services(soc, files, options.program);
  soc.program_host().serve(&services);
  std::optional<Signature> signature;
  if (options.signature) signature.emplace(*options.signature, soc);
  std::optional<observe::TextFile> json;
  if (options.json) json.emplace("--json", *options.json);
  observe::Session session(requests_of(options), soc);

  const auto start = std::chrono::steady_clock::now();
  run_instructions(soc, session, options.max_instructions, options.power_trace ? kFineSlice : kSlice);
  const auto host_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const auto tohost = tohost_of(soc);
  const auto code = has_seen_all(soc, options) ? 0 : exit_code(soc, tohost);
  const auto report = report_of(soc, host_s, tohost);
  print(report);
  if (json) {
    json->print("{}", json_text(report));
    json->close();
  }
  const bool is_reported = soc.end() == End::host || soc.end() == End::exited || soc.end() == End::faulted;
  if (code == kFaultOrLimit && !is_reported) fmt::print(stderr, "mebots-soc: {}\n", missing_end_text(soc, options));
  print_remarks(soc, !options.board);
  session.finish(code);
  if (signature) signature->write(soc);
  return code;
}

}  // namespace mebots::soc::tool
