// SPDX-License-Identifier: Apache-2.0
#include "server.hpp"

#include "base/own_threads.hpp"
#include "mebots/input_error.hpp"

#include <fmt/format.h>

#include <atomic>
#include <chrono>
#include <random>
#include <thread>

namespace mebots::live {
namespace {

constexpr const char* kLoopback = "127.0.0.1";
constexpr std::chrono::milliseconds kUntilItListens{1};  // time between two checks

/// Returns 128 random bits from the operating system as text.
std::string new_token() {
  std::random_device device;
  std::string token;
  for (int i = 0; i < 4; ++i) token += fmt::format("{:08x}", device());
  return token;
}

}  // namespace

struct LiveRun::Server::Sockets {
  RequestServer server;
  std::atomic<bool> has_ended{false};
  std::thread thread;
};

LiveRun::Server::Server(int port, const Answers& answers) : sockets_(std::make_unique<Sockets>()) {
  auto& server = sockets_->server;
  const auto token = new_token();
  const int bound = port == 0 ? server.bind_to_any_port(kLoopback) : (server.bind_to_port(kLoopback, port) ? port : -1);
  if (bound < 0) {
    throw InputError(
        ErrorCode::system_failure,
        fmt::format("--live: port {} of {} is not free; choose another one, or 0 for any free port", port, kLoopback));
  }
  address_ = fmt::format("http://{}:{}/{}/", kLoopback, bound, token);
  server.route(token, bound, answers);
  sockets_->thread = std::thread([&server, &has_ended = sockets_->has_ended] {
    master::mark_own_family();
    server.listen_after_bind();
    has_ended = true;
  });
}

LiveRun::Server::~Server() {
  // stop() has no effect before the server listens, and the thread would not end. Waits until the server listens or has
  // failed.
  while (!sockets_->server.is_running() && !sockets_->has_ended) std::this_thread::sleep_for(kUntilItListens);
  sockets_->server.end();
  sockets_->thread.join();
}

}  // namespace mebots::live
