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

/// The open connections of a server. Limits their number. Its functions may be called from any thread.
class Connections {
 public:
  /// The maximum number of connections that are served at the same time.
  static constexpr std::size_t kMost = 32;

  /// Counts a connection that the server has accepted. If there are more than kMost, closes all connections whose
  /// request is incomplete.
  void accept();
  /// Must be called when a connection from accept() has ended.
  void finish() { --accepted_; }
  /// Closes all connections whose request is incomplete, and immediately closes each later connection. Answers that are
  /// being sent may take kLastAnswerTime at most.
  void close_all();
  /// Returns the time at which close_all() was called. Returns the largest time if it was not called.
  std::chrono::steady_clock::time_point closed_at() const { return closed_at_; }

 private:
  friend class Connection;

  bool is_crowded() const { return accepted_ > kMost; }

  std::mutex mutex_;
  std::set<Connection*> open_;
  std::atomic<std::size_t> accepted_{0};
  std::atomic<std::chrono::steady_clock::time_point> closed_at_{std::chrono::steady_clock::time_point::max()};
};

/// A connection to a client. A request must be complete within kRequestTime after its first byte, and must have at most
/// kRequestBytes. Therefore a client that sends one byte per second is disconnected. The first byte must arrive within
/// kIdleTime, because browsers connect before they send requests. The client must receive the answer within
/// kAnswerTime. If other connections wait, the whole request must arrive within kCrowdedTime. All functions except
/// shut_down() and is_reading() must be called by one thread.
class Connection final : public httplib::Stream {
 public:
  static constexpr std::chrono::milliseconds kIdleTime{30000};
  static constexpr std::chrono::milliseconds kRequestTime{2000};
  static constexpr std::chrono::milliseconds kCrowdedTime{100};
  static constexpr std::chrono::milliseconds kAnswerTime{10000};
  static constexpr std::chrono::milliseconds kLastAnswerTime{500};
  static constexpr std::size_t kRequestBytes = std::size_t{1} << 17;

  /// Takes ownership of the socket; the destructor closes it.
  Connection(Connections& all, int socket);
  ~Connection() override;
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  /// Waits for the first byte. Returns false if no byte arrives in time.
  bool begins_request();
  /// Marks the request as complete on the connection that the calling thread serves.
  static void complete_request();
  /// Sets a function for the connection that the calling thread serves. report_sent() calls this function.
  static void after_sending(std::function<void()> then);
  /// Must be called when the whole answer has been sent.
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

  /// True until the request is complete. May be called from any thread.
  bool is_reading() const { return is_reading_; }
  /// Closes the connection. If a thread is waiting for the client, its call returns immediately. May be called from any
  /// thread.
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
