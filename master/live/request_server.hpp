// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "connection.hpp"
#include "server.hpp"

#include <httplib.h>

#include <string>

namespace mebots::live {

/// The HTTP server of a live run: routes, access and limits of its requests.
class RequestServer final : public httplib::Server {
 public:
  /// Answers requests below /TOKEN/ that name 127.0.0.1:PORT or localhost:PORT as host and, if a page sends them, as
  /// origin. Any other request gets status 403.
  void route(const std::string& token, int port, const LiveRun::Server::Answers& answers);

  /// Closes all connections and ends listen_after_bind(), whatever the clients do. From any thread.
  void end();
  /// Reads one request and answers it. Returns false if there is none, or no answer could be written.
  bool answer(httplib::Stream& stream);

 private:
  bool process_and_close_socket(socket_t socket) override;

  Connections connections_;
};

}  // namespace mebots::live
