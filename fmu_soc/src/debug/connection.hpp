// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace mebots::soc::debug {

/// Owns a file descriptor and closes it on destruction.
class Socket {
 public:
  Socket() = default;
  explicit Socket(int descriptor) : descriptor_(descriptor) {}
  Socket(Socket&& other) noexcept : descriptor_(other.release()) {}
  Socket& operator=(Socket&& other) noexcept;
  ~Socket();

  int descriptor() const { return descriptor_; }
  bool open() const { return descriptor_ >= 0; }
  int release();

 private:
  int descriptor_ = -1;
};

/// Accepts one debugger on this machine over TCP. Packets have the format of gdb's remote serial protocol. Source:
/// Debugging with GDB, appendix "GDB Remote Serial Protocol".
class Connection {
 public:
  /// Listens on 127.0.0.1. Port 0 selects a free port. Throws Error if the port cannot be opened.
  explicit Connection(int port);

  int port() const { return port_; }
  bool connected() const { return client_.open(); }
  /// Accepts a debugger. If `wait` is true, waits until a debugger connects. Returns true if a debugger has connected
  /// during this call.
  bool accept(bool wait);
  void disconnect() { client_ = Socket(); }

  /// Waits for the next packet and returns its unescaped content. Returns "\x03" for an interrupt, and nullopt if the
  /// debugger has disconnected.
  std::optional<std::string> receive();
  /// Sends a packet. If acknowledgements are on, waits for the acknowledgement. If no debugger is connected, has no
  /// effect.
  void send(std::string_view content);
  /// Rejects all further debuggers that wait for a connection, with a message to each of them.
  void refuse_others();
  /// Returns true if Ctrl-C or a packet has arrived, or if the debugger has disconnected. Does not wait.
  bool interrupted();
  /// After this call, packets are not acknowledged in either direction.
  void stop_acknowledging() { acknowledges_ = false; }

 private:
  std::optional<char> next_byte();
  bool read_more(int flags);
  bool write_all(std::string_view bytes);
  void wait_for_client();

  Socket listener_;
  Socket client_;
  int port_ = 0;
  bool acknowledges_ = true;
  std::string unread_;
  std::size_t read_ = 0;
};

}  // namespace mebots::soc::debug
