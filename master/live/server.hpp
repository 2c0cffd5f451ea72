// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "live_run.hpp"

#include <string>

namespace mebots::live {

/// Serves a browser on 127.0.0.1, in threads of its own. Each request has a deadline (connection.hpp); the destructor
/// ends within a second, whatever clients do.
class LiveRun::Server {
 public:
  /// What the page requests. Each is called in one of the server's threads and may throw; the page shows the text of an
  /// InputError.
  struct Answers {
    std::function<std::string()> page;
    std::function<std::string(const Known& known)> data;
    std::function<std::string(const std::string& order)> control;
    std::function<std::string(const std::string& variable, const std::string& value)> set;
  };

  /// Throws InputError if the port is not free.
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

}  // namespace mebots::live
