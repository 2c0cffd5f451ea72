// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "live_run.hpp"

#include <string>

namespace mebots::live {

/// Answers a browser on 127.0.0.1, in threads of its own.
class LiveRun::Server {
 public:
  /// What the page may ask for. Each is called in one of the server's threads and may throw; the text of an InputError
  /// is shown to people.
  struct Answers {
    std::function<std::string()> page;
    std::function<std::string(const Known& known)> data;
    std::function<std::string(const std::string& order)> control;
    std::function<std::string(const std::string& variable, const std::string& value)> set;
  };

  /// Throws InputError when the port is taken.
  Server(int port, Answers answers);
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
