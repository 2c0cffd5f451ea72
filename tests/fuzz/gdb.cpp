// SPDX-License-Identifier: Apache-2.0
//
// Handles any bytes from a debugger. The server must answer or reject all packets without damage to the simulator. The
// behaviour of the chip is arbitrary, because the debugger may have written any values into it.
#include "debug/gdb_server.hpp"

#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>

namespace {

using namespace mebots;
using namespace mebots::soc;

constexpr std::uint32_t kRam = 0x80000000;

/// Returns a program that is a loop of one instruction. Its file consists of an ELF header, a segment and the code.
Elf round_and_round() {
  struct [[gnu::packed]] File {
    std::array<std::uint8_t, 16> magic{0x7f, 'E', 'L', 'F', 1, 1, 1};
    std::uint16_t type = 2, machine = 243;
    std::uint32_t version = 1, entry = kRam, segments_at = 52, sections_at = 0, flags = 0;
    std::uint16_t header_size = 52, segment_size = 32, segments = 1, section_size = 40, sections = 0, names = 0;
    std::uint32_t load = 1, offset = 84, address = kRam, physical = kRam, file_size = 4, memory_size = 4, access = 7,
                  align = 4;
    std::uint32_t code = 0x0000006f;
  };
  static const File file;
  return Elf::parse({reinterpret_cast<const std::uint8_t*>(&file), sizeof file}, "program");
}

Soc& chip() {
  static const auto board = read_board(MEBOTS_SOURCE_DIR "/configs/boards/ri5cy.json");
  static Soc soc(board, gap8(), Settings{}, round_and_round(), {[](std::string_view) {}, [](std::string_view) {}, {}});
  return soc;
}

/// The bytes that the debugger has not yet sent, and whether it has connected.
struct Debugger {
  std::string_view said;
  bool has_called = false;
};
Debugger debugger;

// Descriptors that are not open, so closing them has no effect.
constexpr int kListener = 1 << 28;
constexpr int kLine = kListener + 1;

}  // namespace

// The linker redirects the system calls of the server's connection to these functions (CMakeLists.txt).
// NOLINTBEGIN(bugprone-reserved-identifier,readability-identifier-naming): the linker's names
extern "C" {

int __wrap_socket(int, int, int) {
  return kListener;
}
int __wrap_setsockopt(int, int, int, const void*, socklen_t) {
  return 0;
}
int __wrap_bind(int, const sockaddr*, socklen_t) {
  return 0;
}
int __wrap_listen(int, int) {
  return 0;
}
int __wrap_getsockname(int, sockaddr*, socklen_t*) {
  return 0;
}
int __wrap_accept4(int, sockaddr*, socklen_t*, int) {
  debugger.has_called = true;
  return kLine;
}
int __wrap_poll(pollfd* wanted, nfds_t count, int) {
  int ready = 0;
  for (auto& one : std::span(wanted, count)) {
    one.revents = one.fd == kLine || !debugger.has_called ? one.events : short{0};
    if (one.revents != 0) ++ready;
  }
  return ready;
}
ssize_t __wrap_recv(int, void* buffer, size_t size, int flags) {
  const auto count = std::min(size, debugger.said.size());
  std::memcpy(buffer, debugger.said.data(), count);
  if ((flags & MSG_PEEK) == 0) debugger.said.remove_prefix(count);
  return static_cast<ssize_t>(count);
}
ssize_t __wrap_send(int, const void*, size_t size, int) {
  return static_cast<ssize_t>(size);
}
int __real_close(int);
int __wrap_close(int descriptor) {
  return descriptor >= kListener ? 0 : __real_close(descriptor);
}

}  // extern "C"
// NOLINTEND(bugprone-reserved-identifier,readability-identifier-naming)

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  auto& soc = chip();
  debugger = {{reinterpret_cast<const char*>(data), size}, false};
  debug::GdbServer server(0, soc, debug::GdbServer::Kill::ends_run, [](std::string_view) {});
  if (!server.hart(0).before(soc.hart(0))) return 0;
  // If a request continues the program, the server stops reading requests. It reads further requests when retired()
  // finds a step, a watchpoint or a breakpoint.
  Retired retired;
  retired.access = {kRam, sizeof(std::uint32_t), true};
  for (auto left = debugger.said.size() + 1; debugger.said.size() < left;) {
    left = debugger.said.size();
    server.hart(0).retired(soc.hart(0), retired);
  }
  return 0;
}
