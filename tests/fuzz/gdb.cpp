// SPDX-License-Identifier: Apache-2.0
//
// Any bytes from a debugger, over a socket: packets that are answered or refused, until it has said all, and no harm to
// the chip that it looks into. What the chip does afterwards is up to what was written into it.
#include "debug/gdb_server.hpp"

#include "require.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

namespace {

using namespace mebots;
using namespace mebots::soc;

constexpr std::uint32_t kRam = 0x80000000;

/// A program that goes round in one instruction: an ELF header, one segment, its code.
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

int connected_to(int port) {
  const int line = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  fuzz::require(connect(line, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0, "the server listens");
  const linger at_once{1, 0};  // thousands of lines a second would wait for their last packets
  setsockopt(line, SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once);
  return line;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t kLongest = 4096;  // fits into the socket: nobody reads what comes back
  auto& soc = chip();
  int port = 0;
  debug::GdbServer server(0, soc, debug::GdbServer::Kill::ends_run, [&](std::string_view text) {
    const auto colon = text.rfind(':');
    if (colon != std::string_view::npos && text.starts_with("waiting")) port = std::atoi(text.data() + colon + 1);
  });
  const int line = connected_to(port);
  fuzz::require(send(line, data, std::min(size, kLongest), MSG_NOSIGNAL) >= 0, "the debugger speaks");
  shutdown(line, SHUT_WR);
  server.hart(0).before(soc.hart(0));
  close(line);
  return 0;
}
