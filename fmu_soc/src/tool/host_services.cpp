// SPDX-License-Identifier: Apache-2.0
#include "tool/host_services.hpp"

#include <fmt/core.h>

#include <fcntl.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <utility>

namespace mebots::soc::tool {
namespace {

/// Operation numbers. Source: "Semihosting for AArch32 and AArch64".
enum class Operation : std::uint32_t {
  open = 0x01,
  close = 0x02,
  write_character = 0x03,
  write_text = 0x04,
  write = 0x05,
  read = 0x06,
  read_character = 0x07,
  is_error = 0x08,
  is_terminal = 0x09,
  seek = 0x0a,
  length = 0x0c,
  remove = 0x0e,
  rename = 0x0f,
  clock = 0x10,
  time = 0x11,
  error_number = 0x13,
  command_line = 0x15,
  heap_info = 0x16,
  exit = 0x18,
  exit_extended = 0x20,
  elapsed = 0x30,
  tick_frequency = 0x31,
};

constexpr std::uint32_t kFailed = 0xffffffff;
constexpr std::uint32_t kEndOfInput = 0xffffffff;
constexpr std::uint32_t kApplicationExit = 0x20026;  // ADP_Stopped_ApplicationExit
constexpr std::uint64_t kCentiseconds = 100;
constexpr std::uint64_t kTicks = 1'000'000;

/// Flags of open() for each mode of SYS_OPEN. These are the modes of fopen(). Text and binary mode are the same.
constexpr std::array kModes{O_RDONLY,
                            O_RDWR,
                            O_WRONLY | O_CREAT | O_TRUNC,
                            O_RDWR | O_CREAT | O_TRUNC,
                            O_WRONLY | O_CREAT | O_APPEND,
                            O_RDWR | O_CREAT | O_APPEND};

}  // namespace

template <std::size_t Count>
std::optional<HostServices::Block> HostServices::words_at(std::uint32_t address) const {
  Block words{};
  static_assert(Count <= words.size());
  if (!soc_.memory().read(address, {reinterpret_cast<std::uint8_t*>(words.data()), Count * sizeof words[0]})) {
    return std::nullopt;
  }
  return words;
}

/// Returns `result`. If `result` is -errno, stores the error for SYS_ERRNO and returns -1 instead.
HostReply HostServices::answer(long result) {
  if (result >= 0) return {static_cast<std::uint32_t>(result)};
  errno_ = static_cast<int>(-result);
  return {kFailed};
}

HostReply HostServices::open(const Block& block) {
  const auto name = calls_.text_at(block[0], block[2]);
  if (!name) return answer(-EFAULT);
  const auto mode = block[1] / 2;  // the lowest bit selects binary mode
  if (mode >= kModes.size()) return answer(-EINVAL);
  return answer(files_.open(*name, kModes[mode]));
}

HostReply HostServices::write_text(std::uint32_t address) {
  const auto text = calls_.text_at(address);
  return text ? answer(files_.write(1, *text)) : answer(-EFAULT);
}

HostReply HostServices::command_line(std::uint32_t block_address) {
  const auto block = words_at<2>(block_address);
  if (!block || (*block)[1] <= program_.size()) return answer(-EFAULT);
  const auto size = static_cast<std::uint32_t>(program_.size());
  const bool good = soc_.poke((*block)[0], {reinterpret_cast<const std::uint8_t*>(program_.c_str()), size + 1}) &&
                    soc_.poke(block_address + 4, {reinterpret_cast<const std::uint8_t*>(&size), sizeof size});
  return answer(good ? 0 : -EFAULT);
}

HostReply HostServices::semihosting(std::uint32_t operation, std::uint32_t parameter) {
  const auto with = [&]<std::size_t Count>(std::integral_constant<std::size_t, Count>, auto serve) {
    const auto block = words_at<Count>(parameter);
    return block ? serve(*block) : answer(-EFAULT);
  };
  constexpr std::integral_constant<std::size_t, 1> kOne;
  constexpr std::integral_constant<std::size_t, 2> kTwo;
  constexpr std::integral_constant<std::size_t, 3> kThree;
  constexpr std::integral_constant<std::size_t, 4> kFour;
  switch (static_cast<Operation>(operation)) {
    case Operation::open:
      return with(kThree, [&](const Block& block) { return open(block); });
    case Operation::close:
      return with(kOne, [&](const Block& block) { return answer(files_.close(static_cast<int>(block[0]))); });
    case Operation::write_character:
      return with(kOne, [&](const Block& block) {
        const auto character = static_cast<char>(block[0]);
        return answer(files_.write(1, {&character, 1}));
      });
    case Operation::write_text:
      return write_text(parameter);
    case Operation::write:
    case Operation::read:
      // The reply is the number of bytes that were not transferred.
      return with(kThree, [&](const Block& block) -> HostReply {
        const bool is_read = operation == static_cast<std::uint32_t>(Operation::read);
        const auto done = calls_.transfer(is_read, static_cast<int>(block[0]), block[1], block[2]);
        if (done < 0) answer(done);
        return {block[2] - static_cast<std::uint32_t>(std::max(done, 0L))};
      });
    case Operation::read_character: {
      char character = 0;
      return {files_.read(0, {&character, 1}) == 1 ? static_cast<std::uint8_t>(character) : kEndOfInput};
    }
    case Operation::is_error:
      return with(kOne, [&](const Block& block) -> HostReply { return {block[0] >> 31}; });
    case Operation::is_terminal:
      return with(kOne, [&](const Block& block) -> HostReply {
        return {HostFiles::is_console(static_cast<int>(block[0])) ? 1U : 0U};
      });
    case Operation::seek:
      return with(kTwo, [&](const Block& block) {
        return answer(std::min(files_.seek(static_cast<int>(block[0]), static_cast<long>(block[1]), SEEK_SET), 0L));
      });
    case Operation::length:
      return with(kOne, [&](const Block& block) { return answer(files_.length(static_cast<int>(block[0]))); });
    case Operation::remove:
      return with(kTwo, [&](const Block& block) {
        const auto name = calls_.text_at(block[0], block[1]);
        return answer(name ? files_.remove(*name) : -EFAULT);
      });
    case Operation::rename:
      return with(kFour, [&](const Block& block) {
        const auto from = calls_.text_at(block[0], block[1]);
        const auto to = calls_.text_at(block[2], block[3]);
        return answer(from && to ? files_.rename(*from, *to) : -EFAULT);
      });
    case Operation::clock:
      return {static_cast<std::uint32_t>(calls_.time_in(kCentiseconds))};
    case Operation::time:
      return {static_cast<std::uint32_t>(calls_.time_in(1))};
    case Operation::error_number:
      return {static_cast<std::uint32_t>(errno_)};
    case Operation::command_line:
      return command_line(parameter);
    case Operation::heap_info:
      return answer(-ENOSYS);  // the linker script defines the heap
    case Operation::exit:
      return HostReply::exit(parameter == kApplicationExit ? 0 : 1);
    case Operation::exit_extended:
      return with(kTwo,
                  [&](const Block& block) { return HostReply::exit(block[0] == kApplicationExit ? block[1] : 1); });
    case Operation::elapsed: {
      const auto ticks = calls_.time_in(kTicks);
      const bool good = soc_.poke(parameter, {reinterpret_cast<const std::uint8_t*>(&ticks), sizeof ticks});
      return answer(good ? 0 : -EFAULT);
    }
    case Operation::tick_frequency:
      return {static_cast<std::uint32_t>(kTicks)};
  }
  return answer(-ENOSYS);
}

/// Serves a system call. An openat through `tohost` has an additional argument before the flags, the length of the
/// name. Source: riscv-isa-sim, fesvr/syscall.cc.
HostReply HostServices::system_call(std::uint32_t number, std::span<const std::uint32_t> arguments) {
  if (number == SystemCalls::kOpenAt) {
    return calls_.serve(number, std::array{arguments[0], arguments[1], arguments[3], arguments[4]});
  }
  return calls_.serve(number, arguments);
}

/// Executes a command. The device numbers are those of riscv-isa-sim (fesvr/htif.cc).
void HostServices::device_command(unsigned device, unsigned command, std::uint64_t payload) {
  constexpr unsigned kConsoleDevice = 1;
  constexpr unsigned kWriteCharacter = 1;
  if (device == kConsoleDevice && command == kWriteCharacter) {
    const auto character = static_cast<char>(payload);
    files_.write(1, {&character, 1});
    return;
  }
  calls_.report_once(fmt::format(
      "command {} to device {} through tohost is not supported; use device 0 (system calls), or command 1 of "
      "device 1 (write a character to the console)",
      command, device));
}

}  // namespace mebots::soc::tool
