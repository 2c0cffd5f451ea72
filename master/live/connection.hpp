// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <httplib.h>

#include <atomic>
#include <chrono>
#include <cstddef>
#include <functional>
#include <mutex>
#include <set>
#include <string>

namespace mebots::live {

class Connection;

/// The open connections of a server. Limits their number. Thread-safe.
class Connections {
 public:
  static constexpr std::size_t kMost = 32;

  /// Counts an accepted connection. If there are more than kMost connections, closes all connections with an incomplete
  /// request.
  void accept();
  /// Must be called at the end of a connection that accept() counted.
  void finish() { --accepted_; }
  /// Closes all connections with an incomplete request, and closes later connections at once. Answers in progress have
  /// kLastAnswerTime to finish.
  void close_all();
  /// Returns the time of the close_all() call, or time_point::max() before this call.
  std::chrono::steady_clock::time_point closed_at() const { return closed_at_; }

 private:
  friend class Connection;

  bool is_crowded() const { return accepted_ > kMost; }

  std::mutex mutex_;
  std::set<Connection*> open_;
  std::atomic<std::size_t> accepted_{0};
  std::atomic<std::chrono::steady_clock::time_point> closed_at_{std::chrono::steady_clock::time_point::max()};
};

/// A connection to a client, with time limits. The first byte must arrive within kIdleTime, because browsers connect
/// before they send requests. The request must be complete within kRequestTime after its first byte, and has at most
/// kRequestBytes. With more than Connections::kMost connections, the whole request must arrive within kCrowdedTime. The
/// client must receive the answer within kAnswerTime. Only one thread may use a connection, except for shut_down() and
/// is_reading().
class Connection final : public httplib::Stream {
 public:
  static constexpr std::chrono::milliseconds kIdleTime{30000};
  static constexpr std::chrono::milliseconds kRequestTime{2000};
  static constexpr std::chrono::milliseconds kCrowdedTime{100};
  static constexpr std::chrono::milliseconds kAnswerTime{10000};
  static constexpr std::chrono::milliseconds kLastAnswerTime{500};
  static constexpr std::size_t kRequestBytes = std::size_t{1} << 17;

  /// Takes ownership of the socket.
  Connection(Connections& all, int socket);
  ~Connection() override;
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  /// Waits for the first byte of a request. Returns false if none arrives within kIdleTime. With more than
  /// Connections::kMost connections, waits only for kCrowdedTime.
  bool begins_request();
  /// Marks the request of the calling thread's connection as complete.
  static void complete_request();
  /// Sets the function that report_sent() calls on the calling thread's connection.
  static void after_sending(std::function<void()> then);
  /// Calls the function that after_sending() set. Must be called after the whole answer was sent.
  void report_sent() const {
    if (after_sending_) after_sending_();
  }

  bool is_readable() const override;
  bool is_writable() const override;
  ssize_t read(char* data, std::size_t size) override;
  ssize_t write(const char* data, std::size_t size) override;
  void get_remote_ip_and_port(std::string& ip, int& port) const override;
  void get_local_ip_and_port(std::string& ip, int& port) const override;
  socket_t socket() const override { return socket_; }

  /// True until the request is complete. Thread-safe.
  bool is_reading() const { return is_reading_; }
  /// Closes the connection. Calls that wait for the client return immediately. Thread-safe.
  void shut_down();

 private:
  using Clock = std::chrono::steady_clock;

  bool waits_for(short event, Clock::time_point until) const;
  bool is_too_late(Clock::time_point until) const;

  Connections* all_;
  int socket_;
  std::atomic<bool> is_reading_{true};
  Clock::time_point request_until_;
  Clock::time_point answer_until_{};
  std::function<void()> after_sending_;
  std::size_t bytes_left_ = kRequestBytes;
};

}  // namespace mebots::live
