// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "connection.hpp"
#include "live_run.hpp"

#include <httplib.h>

#include <functional>
#include <string>

namespace mebots::live {

/// Serves browsers on 127.0.0.1 in separate threads. Requests have deadlines, so the destructor returns within a
/// second.
class LiveRun::Server {
 public:
  struct Answer {
    std::string body;
    std::function<void()> after_sending;  ///< called in a server thread after the whole answer was sent
  };

  /// The functions that answer requests. They run on the server's threads. If a function throws InputError, the page
  /// shows its text.
  struct Answers {
    std::function<std::string()> page;
    std::function<Answer(const Known& known)> data;
    std::function<std::string(const std::string& order)> control;
    std::function<std::string(const std::string& variable, const std::string& value)> set;
  };

  /// Throws InputError if the port is in use.
  Server(int port, const Answers& answers);
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  const std::string& address() const { return address_; }

 private:
  struct Sockets;

  std::string address_;
  std::unique_ptr<Sockets> sockets_;
};

/// The HTTP server of a live run. Defines routes, and limits access, size and duration of requests.
class RequestServer final : public httplib::Server {
 public:
  /// Defines the routes. Answers only requests with a path below /TOKEN/ and the host 127.0.0.1:PORT or localhost:PORT.
  /// If a request has an origin, the origin must also be one of these hosts. Other requests receive status 403.
  void route(const std::string& token, int port, const LiveRun::Server::Answers& answers);

  /// Closes all connections and makes listen_after_bind() return. Thread-safe.
  void end();
  /// Reads a request and answers it. Returns false if no request arrives, or if the answer cannot be written.
  bool answer(httplib::Stream& stream);

 private:
  bool process_and_close_socket(socket_t socket) override;

  Connections connections_;
};

}  // namespace mebots::live
