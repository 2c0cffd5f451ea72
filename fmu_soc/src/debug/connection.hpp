// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace mebots::soc::debug {

/// A closed file descriptor when it goes away.
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

/// One debugger at a time, over TCP on this machine only, in packets of gdb's remote serial protocol.
/// Source: Debugging with GDB, appendix "GDB Remote Serial Protocol".
class Connection {
 public:
  /// Listens on 127.0.0.1; port 0 takes a free one. Throws Error when the port cannot be had.
  explicit Connection(int port);

  int port() const { return port_; }
  bool connected() const { return client_.open(); }
  /// Takes a debugger that has called; with `wait`, waits for one. True when there is a new one.
  bool accept(bool wait);
  void disconnect() { client_ = Socket(); }

  /// The next packet's content, unescaped; nothing when the debugger has gone. "\x03" stands for an interrupt.
  std::optional<std::string> receive();
  /// Sends a packet and, unless told otherwise, waits until it is acknowledged. Nothing happens without a debugger.
  void send(std::string_view content);
  /// Tells those who call while a debugger is there that they must wait, and hangs up. Never waits when nobody calls.
  void refuse_others();
  /// True when an interrupt (Ctrl-C) has come, or the debugger has gone. Never waits.
  bool interrupted();
  /// From now on packets are not acknowledged.
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
