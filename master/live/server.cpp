// SPDX-License-Identifier: Apache-2.0
#include "server.hpp"

#include "base/own_threads.hpp"
#include "mebots/data/csv.hpp"
#include "mebots/input_error.hpp"

#include <fmt/format.h>
#include <httplib.h>

#include <array>
#include <atomic>
#include <chrono>
#include <exception>
#include <random>
#include <thread>
#include <utility>

namespace mebots::live {
namespace {

constexpr const char* kLoopback = "127.0.0.1";
constexpr std::chrono::milliseconds kUntilItListens{1};  // between two looks

/// 128 bits of the system's own randomness.
std::string new_token() {
  std::random_device device;
  std::string token;
  for (int i = 0; i < 4; ++i) token += fmt::format("{:08x}", device());
  return token;
}

/// Compares in a time that does not tell how far two texts agree.
bool same(const std::string& a, const std::string& b) {
  if (a.size() != b.size()) return false;
  unsigned difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i) difference |= static_cast<unsigned char>(a[i] ^ b[i]);
  return difference == 0;
}

/// Another page's script may send requests to this port, but not under our name: a browser says which host it looked up
/// and which page asks.
bool is_ours(const httplib::Request& request, int port) {
  const auto local = [&](const std::string& name) {
    return name == fmt::format("127.0.0.1:{}", port) || name == fmt::format("localhost:{}", port);
  };
  if (!local(request.get_header_value("Host"))) return false;
  if (!request.has_header("Origin")) return true;
  const auto origin = request.get_header_value("Origin");
  constexpr std::string_view kScheme = "http://";
  return origin.starts_with(kScheme) && local(origin.substr(kScheme.size()));
}

/// A whole number that a request carries; 0 without one.
std::size_t count_of(const httplib::Request& request, const char* name) {
  if (!request.has_param(name)) return 0;
  const auto text = request.get_param_value(name);
  const auto count = data::csv_number<std::size_t>(text);
  if (!count) throw InputError(ErrorCode::invalid_argument, fmt::format("{} = '{}' is not a count", name, text));
  return *count;
}

void reply(httplib::Response& response, const char* type, const std::function<std::string()>& answer) {
  try {
    response.set_content(answer(), type);
  } catch (const InputError& error) {
    response.status = 400;
    response.set_content(error.what(), "text/plain; charset=utf-8");
  } catch (const std::exception& error) {
    response.status = 503;
    response.set_content(error.what(), "text/plain; charset=utf-8");
  }
}

}  // namespace

struct LiveRun::Server::Sockets {
  httplib::Server server;
  std::atomic<bool> has_ended{false};
  std::thread thread;
};

LiveRun::Server::Server(int port, Answers answers) : sockets_(std::make_unique<Sockets>()) {
  auto& server = sockets_->server;
  const auto token = new_token();
  const int bound = port == 0 ? server.bind_to_any_port(kLoopback) : (server.bind_to_port(kLoopback, port) ? port : -1);
  if (bound < 0) {
    throw InputError(
        ErrorCode::system_failure,
        fmt::format("--live: port {} of {} is not free; name another, or 0 for any free one", port, kLoopback));
  }
  address_ = fmt::format("http://{}:{}/{}/", kLoopback, bound, token);
  server.new_task_queue = [] { return new httplib::ThreadPool(4); };
  server.set_payload_max_length(1 << 16);
  server.set_default_headers(
      {{"Cache-Control", "no-store"}, {"X-Content-Type-Options", "nosniff"}, {"Referrer-Policy", "no-referrer"}});
  server.set_pre_routing_handler([token, bound](const httplib::Request& request, httplib::Response& response) {
    const bool knows = request.path.size() > token.size() + 1 && same(request.path.substr(1, token.size()), token) &&
                       request.path[token.size() + 1] == '/';
    if (knows && is_ours(request, bound)) return httplib::Server::HandlerResponse::Unhandled;
    response.status = 403;
    response.set_content("forbidden\n", "text/plain");
    return httplib::Server::HandlerResponse::Handled;
  });
  server.Get("/[0-9a-f]+/", [answers](const httplib::Request&, httplib::Response& response) {
    reply(response, "text/html; charset=utf-8", answers.page);
  });
  server.Get("/[0-9a-f]+/data", [answers](const httplib::Request& request, httplib::Response& response) {
    reply(response, "application/octet-stream", [&] {
      return answers.data({count_of(request, "rows"), count_of(request, "pictures"), count_of(request, "log")});
    });
  });
  server.Post("/[0-9a-f]+/control", [answers](const httplib::Request& request, httplib::Response& response) {
    reply(response, "application/json", [&] { return answers.control(request.get_param_value("order")); });
  });
  server.Post("/[0-9a-f]+/set", [answers](const httplib::Request& request, httplib::Response& response) {
    reply(response, "application/json",
          [&] { return answers.set(request.get_param_value("variable"), request.get_param_value("value")); });
  });
  sockets_->thread = std::thread([&server, &has_ended = sockets_->has_ended] {
    master::mark_own_family();
    server.listen_after_bind();
    has_ended = true;
  });
}

LiveRun::Server::~Server() {
  // A run may be over before the thread listens, and until then stop() does nothing: nobody would end the thread.
  while (!sockets_->server.is_running() && !sockets_->has_ended) std::this_thread::sleep_for(kUntilItListens);
  sockets_->server.stop();
  sockets_->thread.join();
}

}  // namespace mebots::live
