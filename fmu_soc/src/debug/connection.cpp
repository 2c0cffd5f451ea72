// SPDX-License-Identifier: Apache-2.0
#include "debug/connection.hpp"

#include "mebots/error.hpp"

#include <arpa/inet.h>
#include <fmt/core.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

namespace mebots::soc::debug {
namespace {

constexpr char kInterrupt = '\x03';
constexpr int kBacklog = 4;
constexpr std::size_t kLongestPacket = 1U << 20;

/// Maximum time in which a refused debugger must send its request and disconnect [ms].
constexpr int kRefusalMs = 1000;
/// Reply to the first packet of a refused debugger. gdb displays the text after "E.".
constexpr std::string_view kBusy =
    "E.another debugger is connected to this run: wait until it disconnects, and connect again";

/// Returns true if data can be read, or a connection can be accepted, within `timeout_ms`.
bool is_readable(const Socket& socket, int timeout_ms) {
  pollfd wanted{socket.descriptor(), POLLIN, 0};
  return ::poll(&wanted, 1, timeout_ms) > 0;
}

std::string framed(std::string_view escaped) {
  unsigned sum = 0;
  for (const char c : escaped) sum += static_cast<std::uint8_t>(c);
  return fmt::format("${}#{:02x}", escaped, sum & 0xffU);
}

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

}  // namespace

Socket& Socket::operator=(Socket&& other) noexcept {
  if (this != &other) {
    if (open()) ::close(descriptor_);
    descriptor_ = other.release();
  }
  return *this;
}

Socket::~Socket() {
  if (open()) ::close(descriptor_);
}

int Socket::release() {
  return std::exchange(descriptor_, -1);
}

Connection::Connection(int port) : listener_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
  const int yes = 1;
  ::setsockopt(listener_.descriptor(), SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  socklen_t size = sizeof address;
  auto* any = reinterpret_cast<sockaddr*>(&address);
  if (!listener_.open() || ::bind(listener_.descriptor(), any, size) != 0 ||
      ::listen(listener_.descriptor(), kBacklog) != 0 || ::getsockname(listener_.descriptor(), any, &size) != 0) {
    throw Error(fmt::format("gdb port {}: cannot listen on 127.0.0.1: {}; take another port, or 0 for a free one", port,
                            std::strerror(errno)));
  }
  port_ = ntohs(address.sin_port);
}

bool Connection::accept(bool wait) {
  int descriptor = -1;
  do {
    if (!wait && !is_readable(listener_, 0)) return false;
    descriptor = ::accept4(listener_.descriptor(), nullptr, nullptr, SOCK_CLOEXEC);
  } while (descriptor < 0 && errno == EINTR);
  if (descriptor < 0) return false;
  const int yes = 1;
  ::setsockopt(descriptor, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
  client_ = Socket(descriptor);
  acknowledges_ = true;
  unread_.clear();
  read_ = 0;
  return true;
}

std::optional<char> Connection::next_byte() {
  if (read_ == unread_.size()) {
    wait_for_client();
    if (!read_more(0)) return std::nullopt;
  }
  return unread_[read_++];
}

/// Returns false if no data has arrived, or if the debugger has disconnected.
bool Connection::read_more(int flags) {
  char buffer[4096];
  ssize_t count = 0;
  do {
    count = client_.open() ? ::recv(client_.descriptor(), buffer, sizeof buffer, flags) : 0;
  } while (count < 0 && errno == EINTR);
  if (count < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) return false;
  if (count <= 0) {
    disconnect();
    return false;
  }
  unread_.assign(buffer, static_cast<std::size_t>(count));
  read_ = 0;
  return true;
}

/// Waits for data from the debugger. During the wait, refuses other debuggers.
void Connection::wait_for_client() {
  while (client_.open()) {
    std::array<pollfd, 2> wanted{{{client_.descriptor(), POLLIN, 0}, {listener_.descriptor(), POLLIN, 0}}};
    if (::poll(wanted.data(), wanted.size(), -1) < 0 && errno != EINTR) return;
    if (wanted[0].revents != 0) return;
    if (wanted[1].revents != 0) refuse_others();
  }
}

void Connection::refuse_others() {
  while (is_readable(listener_, 0)) {
    const Socket caller(::accept4(listener_.descriptor(), nullptr, nullptr, SOCK_CLOEXEC));
    if (!caller.open()) return;
    char ignored[4096];
    if (!is_readable(caller, kRefusalMs) || ::recv(caller.descriptor(), ignored, sizeof ignored, 0) <= 0) continue;
    const auto answer = "+" + framed(kBusy);
    ::send(caller.descriptor(), answer.data(), answer.size(), MSG_NOSIGNAL);
    ::shutdown(caller.descriptor(), SHUT_WR);
    // Closing a connection with unread data may lose the reply.
    while (is_readable(caller, kRefusalMs) && ::recv(caller.descriptor(), ignored, sizeof ignored, 0) > 0) continue;
  }
}

std::optional<std::string> Connection::receive() {
  for (;;) {
    auto byte = next_byte();
    while (byte && *byte != '$' && *byte != kInterrupt) byte = next_byte();
    if (!byte) return std::nullopt;
    if (*byte == kInterrupt) return std::string(1, kInterrupt);
    std::string content;
    unsigned sum = 0;
    bool escaped = false;
    while ((byte = next_byte()) && *byte != '#' && content.size() < kLongestPacket) {
      sum += static_cast<std::uint8_t>(*byte);
      if (!escaped && *byte == '}') {
        escaped = true;
      } else {
        content += escaped ? static_cast<char>(*byte ^ 0x20) : *byte;
        escaped = false;
      }
    }
    const auto high = next_byte();
    const auto low = next_byte();
    if (!high || !low) return std::nullopt;
    const bool good = hex_digit(*high) * 16 + hex_digit(*low) == static_cast<int>(sum & 0xffU);
    if (acknowledges_ && !write_all(good ? "+" : "-")) return std::nullopt;
    if (good || !acknowledges_) return content;
  }
}

void Connection::send(std::string_view content) {
  std::string escaped;
  for (const char c : content) {
    const bool is_special = c == '$' || c == '#' || c == '}' || c == '*';
    if (is_special) escaped += '}';
    escaped += is_special ? static_cast<char>(c ^ 0x20) : c;
  }
  const auto packet = framed(escaped);
  // Sends the packet again if the debugger rejects it.
  while (write_all(packet) && acknowledges_) {
    auto answer = next_byte();
    while (answer && *answer != '+' && *answer != '-') answer = next_byte();
    if (!answer || *answer == '+') return;
  }
}

bool Connection::write_all(std::string_view bytes) {
  while (!bytes.empty()) {
    const auto count =
        client_.open() ? ::send(client_.descriptor(), bytes.data(), bytes.size(), MSG_NOSIGNAL) : ssize_t{0};
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) {
      disconnect();
      return false;
    }
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
  return true;
}

bool Connection::interrupted() {
  if (!client_.open()) return false;
  // The interrupt may have arrived together with the last packet, and may already be in the buffer.
  if (read_ == unread_.size() && !read_more(MSG_DONTWAIT)) return !client_.open();
  const char byte = unread_[read_];
  if (byte == kInterrupt || byte == '+') ++read_;
  return byte != '+';  // a packet has arrived during the run: stops, so that the packet can be answered
}

}  // namespace mebots::soc::debug
