// SPDX-License-Identifier: Apache-2.0
#include "tool/system_calls.hpp"

#include "hart/csr_numbers.hpp"
#include "mebots/error.hpp"

#include <fmt/core.h>

#include <fcntl.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string_view>
#include <utility>

namespace mebots::soc::tool {
namespace {

enum class Call : std::uint32_t {
  openat = SystemCalls::kOpenAt,
  close = 57,
  lseek = 62,
  read = 63,
  write = 64,
  writev = 66,
  fstat = 80,
  exit = 93,
  exit_group = 94,
  clock_gettime = 113,
  kill = 129,
  gettimeofday = 169,
  getpid = 172,
  brk = 214,
  clock_gettime64 = 403,
  open = 1024,
  unlink = 1026,
};

struct Name {
  std::uint32_t number;
  std::string_view name;
};

/// Names of system calls, for messages. The last call exists only in rv32emu (src/syscall.c).
constexpr auto kNames = std::to_array<Name>({
    {56, "openat"},
    {57, "close"},
    {62, "lseek"},
    {63, "read"},
    {64, "write"},
    {66, "writev"},
    {80, "fstat"},
    {93, "exit"},
    {94, "exit_group"},
    {113, "clock_gettime"},
    {129, "kill"},
    {169, "gettimeofday"},
    {172, "getpid"},
    {214, "brk"},
    {403, "clock_gettime64"},
    {1024, "open"},
    {1026, "unlink"},
    {17, "getcwd"},
    {23, "dup"},
    {24, "dup3"},
    {25, "fcntl"},
    {29, "ioctl"},
    {34, "mkdirat"},
    {35, "unlinkat"},
    {37, "linkat"},
    {46, "ftruncate"},
    {48, "faccessat"},
    {49, "chdir"},
    {59, "pipe2"},
    {61, "getdents64"},
    {65, "readv"},
    {67, "pread64"},
    {68, "pwrite64"},
    {78, "readlinkat"},
    {79, "fstatat"},
    {96, "set_tid_address"},
    {98, "futex"},
    {99, "set_robust_list"},
    {101, "nanosleep"},
    {115, "clock_nanosleep"},
    {124, "sched_yield"},
    {131, "tgkill"},
    {134, "rt_sigaction"},
    {135, "rt_sigprocmask"},
    {153, "times"},
    {160, "uname"},
    {165, "getrusage"},
    {174, "getuid"},
    {198, "socket"},
    {215, "munmap"},
    {216, "mremap"},
    {220, "clone"},
    {221, "execve"},
    {222, "mmap"},
    {226, "mprotect"},
    {260, "wait4"},
    {261, "prlimit64"},
    {278, "getrandom"},
    {291, "statx"},
    {422, "futex_time64"},
    {1025, "link"},
    {1030, "mkdir"},
    {1033, "access"},
    {1038, "stat"},
    {1039, "lstat"},
    {1062, "time"},
    {2011, "getmainvars"},
    {0xbeef, "draw_frame"},
    {0xc0de, "setup_queue"},
    {0xfeed, "submit_queue"},
    {0xbabe, "setup_audio"},
    {0xd00d, "control_audio"},
});

constexpr std::uint32_t kLongestText = 1U << 20;
constexpr std::uint32_t kMostParts = 1024;
constexpr std::uint64_t kPsPerSecond = 1'000'000'000'000;
constexpr std::uint64_t kMicroseconds = 1'000'000;
constexpr std::uint64_t kNanoseconds = 1'000'000'000;
constexpr std::uint32_t kAlignment = 16;  // alignment of the stack
constexpr unsigned kStackPointer = 2;
/// Maximum space for the stack. The stack gets a quarter of the RAM after the program, but at most Linux's default.
constexpr std::uint32_t kMostStack = 8U << 20;
/// Exit code of a program that a signal ended, minus the number of the signal.
constexpr std::uint32_t kSignalled = 128;

/// Values of open()'s flags in a program's C library. O_RDONLY, O_WRONLY and O_RDWR are the same on the host.
struct OpenFlags {
  std::uint32_t append, create, truncate, exclusive;

  int to_host(std::uint32_t flags) const {
    const auto bit = [flags](std::uint32_t mask, int value) { return (flags & mask) != 0 ? value : 0; };
    return static_cast<int>(flags & 3U) | bit(append, O_APPEND) | bit(create, O_CREAT) | bit(truncate, O_TRUNC) |
           bit(exclusive, O_EXCL);
  }
};
constexpr OpenFlags kLinuxFlags{.append = 02000, .create = 0100, .truncate = 01000, .exclusive = 0200};
/// Values of newlib's sys/_default_fcntl.h, which newlib's _open() passes to call 1024 unchanged.
constexpr OpenFlags kNewlibFlags{.append = 0x8, .create = 0x200, .truncate = 0x400, .exclusive = 0x800};

std::uint32_t end_of(const Elf& program) {
  std::uint32_t end = 0;
  for (const auto& segment : program.segments()) end = std::max(end, segment.run_address + segment.size);
  return end;
}

}  // namespace

std::string_view system_call_name(std::uint32_t number) {
  const auto* const found = std::ranges::find(kNames, number, &Name::number);
  return found == kNames.end() ? std::string_view() : found->name;
}

/// Initialises the stack: the number of arguments, their addresses, a zero, an empty environment and an empty auxiliary
/// vector. The texts are above these values. Source: RISC-V ELF psABI 1.0; System V ABI, "Process initialization".
void SystemCalls::begin_program(const std::vector<std::string>& arguments) {
  const auto& program = soc_.program();
  least_break_ = (end_of(program) + kAlignment - 1) / kAlignment * kAlignment;
  const auto* ram = soc_.memory().find(least_break_, kAlignment);
  if (ram == nullptr) {
    throw Error(fmt::format("--user: {}: there is no memory after the program's end 0x{:08x} for heap and stack",
                            program.origin(), least_break_));
  }
  auto top = ram->base + (ram->size - kAlignment);
  std::vector<std::uint32_t> words{static_cast<std::uint32_t>(arguments.size())};
  for (const auto& text : arguments) {
    top -= static_cast<std::uint32_t>(text.size() + 1);
    words.push_back(top);
    soc_.poke(top, {reinterpret_cast<const std::uint8_t*>(text.c_str()), text.size() + 1});
  }
  words.insert(words.end(), 4, 0);
  const auto bytes = static_cast<std::uint32_t>(words.size() * sizeof words[0]);
  top = (top - bytes) / kAlignment * kAlignment;
  const auto space = ram->base + ram->size - least_break_;
  const auto stack = std::min(kMostStack, space / 4) + (ram->base + ram->size - top);
  if (space <= stack || !soc_.poke(top, {reinterpret_cast<const std::uint8_t*>(words.data()), bytes})) {
    throw Error(fmt::format("--user: {}: the arguments need more memory than there is after the program's end 0x{:08x}",
                            program.origin(), least_break_));
  }
  auto& hart = soc_.hart();
  hart.set_reg(kStackPointer, top);
  // An operating system switches the float registers on before a program starts.
  if (hart.code().blocks.extensions().has(Extension::f)) hart.set_csr(csr::kMstatus, csr::kFloatsOn);
  break_ = least_break_;
  most_break_ = ram->base + (ram->size - stack);
}

std::optional<std::string> SystemCalls::text_at(std::uint32_t address, std::uint32_t length) const {
  if (length > kLongestText) return std::nullopt;
  std::string text(length, '\0');
  if (!soc_.memory().read(address, {reinterpret_cast<std::uint8_t*>(text.data()), text.size()})) return std::nullopt;
  return text;
}

std::optional<std::string> SystemCalls::text_at(std::uint32_t address) const {
  std::string text;
  for (std::uint8_t byte = 0; text.size() < kLongestText; text += static_cast<char>(byte)) {
    if (!soc_.memory().read(address + static_cast<std::uint32_t>(text.size()), {&byte, 1})) return std::nullopt;
    if (byte == 0) return text;
  }
  return std::nullopt;
}

long SystemCalls::transfer(bool is_read, int file, std::uint32_t address, std::uint32_t count) {
  auto bytes = text_at(address, std::min(count, kLongestText));
  if (!bytes) return -EFAULT;
  if (!is_read) return files_.write(file, *bytes);
  const auto done = files_.read(file, *bytes);
  if (done > 0)
    soc_.poke(address, {reinterpret_cast<const std::uint8_t*>(bytes->data()), static_cast<std::size_t>(done)});
  return done;
}

std::uint64_t SystemCalls::time_in(std::uint64_t per_second) const {
  return static_cast<std::uint64_t>(soc_.core_time()) / (kPsPerSecond / per_second);
}

bool SystemCalls::poke(std::uint32_t address, std::span<const std::uint64_t> words) {
  return soc_.poke(address, {reinterpret_cast<const std::uint8_t*>(words.data()), words.size_bytes()});
}

long SystemCalls::open(std::uint32_t name, int flags) {
  const auto text = text_at(name);
  return text ? files_.open(*text, flags) : -EFAULT;
}

/// Serves writev. `parts` is the address of `count` pairs of address and length.
long SystemCalls::write_parts(int file, std::uint32_t parts, std::uint32_t count) {
  if (count > kMostParts) return -EINVAL;
  long total = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    std::array<std::uint32_t, 2> part{};
    if (!soc_.memory().read(parts + 8 * i, {reinterpret_cast<std::uint8_t*>(part.data()), sizeof part})) return -EFAULT;
    const auto done = transfer(false, file, part[0], part[1]);
    if (done < 0) return total > 0 ? total : done;
    total += done;
  }
  return total;
}

/// Serves fstat. Sets only type and size of the file. Source: newlib, libgloss/riscv/kernel_stat.h.
long SystemCalls::status(int file, std::uint32_t address) {
  constexpr std::uint64_t kCharacterDevice = 0020620;
  constexpr std::uint64_t kRegularFile = 0100644;
  constexpr std::uint64_t kBlock = 1024;
  const auto length = files_.length(file);
  if (length < 0) return length;
  // The fields are: device and inode; mode and links; owner and group; device; padding; size; block size; blocks;
  // times.
  std::array<std::uint64_t, 13> words{};
  words[2] = (HostFiles::is_console(file) ? kCharacterDevice : kRegularFile) | std::uint64_t{1} << 32;
  words[6] = static_cast<std::uint64_t>(length);
  words[7] = kBlock;
  return poke(address, words) ? 0 : -EFAULT;
}

/// Serves brk. Returns the end of the heap, which is unchanged if the heap cannot end at `address`.
long SystemCalls::move_break(std::uint32_t address) {
  if (address >= least_break_ && address <= most_break_) break_ = address;
  return static_cast<long>(break_);
}

/// Stores the simulated time as two 64-bit words: seconds, and the remainder in units of 1 / `per_second`.
long SystemCalls::tell_time(std::uint32_t address, std::uint64_t per_second) {
  const auto time = time_in(per_second);
  return poke(address, std::array{time / per_second, time % per_second}) ? 0 : -EFAULT;
}

long SystemCalls::refuse(std::uint32_t number) {
  const auto name = system_call_name(number);
  report_once(fmt::format(
      "system call {}{} is not supported and returns ENOSYS: link the program with a C library that needs no "
      "operating system, such as newlib or picolibc",
      number, name.empty() ? "" : fmt::format(" ({})", name)));
  return -ENOSYS;
}

HostReply SystemCalls::serve(std::uint32_t number, std::span<const std::uint32_t> arguments) {
  const auto file = static_cast<int>(arguments[0]);
  const auto result = [](long value) -> HostReply { return {static_cast<std::uint32_t>(value)}; };
  switch (static_cast<Call>(number)) {
    case Call::openat:
      return result(open(arguments[1], kLinuxFlags.to_host(arguments[2])));
    case Call::open:
      return result(open(arguments[0], kNewlibFlags.to_host(arguments[1])));
    case Call::close:
      return result(files_.close(file));
    case Call::lseek:
      return result(files_.seek(file, static_cast<std::int32_t>(arguments[1]), static_cast<int>(arguments[2])));
    case Call::read:
      return result(transfer(true, file, arguments[1], arguments[2]));
    case Call::write:
      return result(transfer(false, file, arguments[1], arguments[2]));
    case Call::writev:
      return result(write_parts(file, arguments[1], arguments[2]));
    case Call::fstat:
      return result(status(file, arguments[1]));
    case Call::unlink: {
      const auto name = text_at(arguments[0]);
      return result(name ? files_.remove(*name) : -EFAULT);
    }
    case Call::exit:
    case Call::exit_group:
      return HostReply::exit(arguments[0]);
    case Call::kill:
      report_once(fmt::format("the program ended itself with signal {}", arguments[1]));
      return HostReply::exit(kSignalled + arguments[1]);
    case Call::getpid:
      return result(1);
    case Call::brk:
      return result(move_break(arguments[0]));
    case Call::gettimeofday:
      return result(tell_time(arguments[0], kMicroseconds));
    case Call::clock_gettime:
    case Call::clock_gettime64:
      return result(tell_time(arguments[1], kNanoseconds));
  }
  return result(refuse(number));
}

void SystemCalls::report_once(const std::string& request) {
  if (reported_.insert(request).second) fmt::print(stderr, "mebots-soc: {}\n", request);
}

}  // namespace mebots::soc::tool
