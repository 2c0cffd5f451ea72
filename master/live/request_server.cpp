// SPDX-License-Identifier: Apache-2.0
#include "server.hpp"

#include "mebots/data/csv.hpp"
#include "mebots/input_error.hpp"
#include "mebots/parsed_number.hpp"

#include <fmt/format.h>
#include <sys/socket.h>

#include <exception>
#include <string_view>
#include <utility>

namespace mebots::live {
namespace {

/// Maximum number of connections that wait for acceptance. With the library's default of 5, a few clients could delay a
/// browser by a second.
constexpr int kBacklog = 128;
constexpr std::size_t kLargestBody = std::size_t{1} << 16;

/// The threads of the server. Counts accepted connections in `Connections` even before a thread is free.
class Threads final : public httplib::TaskQueue {
 public:
  explicit Threads(Connections& connections) : connections_(&connections) {}

  void enqueue(std::function<void()> work) override {
    connections_->accept();
    pool_.enqueue([this, work = std::move(work)] {
      work();
      connections_->finish();
    });
  }
  void shutdown() override { pool_.shutdown(); }

 private:
  Connections* connections_;
  httplib::ThreadPool pool_{Connections::kMost};
};

/// Compares two texts of equal length in a time that does not depend on their content, so that the time reveals nothing
/// about a token.
bool same(const std::string& a, const std::string& b) {
  if (a.size() != b.size()) return false;
  unsigned difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i) difference |= static_cast<unsigned char>(a[i] ^ b[i]);
  return difference == 0;
}

/// True for requests of MEbots' own page. Scripts of other pages can also send requests to this port, but have another
/// host or origin.
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

/// Returns the value of a request parameter as a count, or 0 if it is missing.
std::size_t count_of(const httplib::Request& request, const char* name) {
  if (!request.has_param(name)) return 0;
  const auto text = request.get_param_value(name);
  const auto count = parsed_number<std::size_t>(text);
  if (!count) throw InputError(ErrorCode::invalid_argument, fmt::format("{} = '{}' is not a count", name, text));
  return *count;
}

void reply(httplib::Response& response, const char* type, const std::function<std::string()>& answer) {
  try {
    response.set_content(answer(), type);
  } catch (const InputError& error) {
    response.status = 400;
    response.set_content(error.what(), "text/plain; charset=utf-8");
  } catch (const NoAnswer& error) {
    response.status = 503;
    response.set_content(error.what(), "text/plain; charset=utf-8");
  } catch (const std::exception& error) {
    response.status = 500;
    response.set_content(error.what(), "text/plain; charset=utf-8");
  }
}

}  // namespace

void RequestServer::route(const std::string& token, int port, const LiveRun::Server::Answers& answers) {
  ::listen(svr_sock_, kBacklog);
  new_task_queue = [this] { return new Threads(connections_); };
  set_payload_max_length(kLargestBody);
  set_default_headers(
      {{"Cache-Control", "no-store"}, {"X-Content-Type-Options", "nosniff"}, {"Referrer-Policy", "no-referrer"}});
  set_pre_routing_handler([token, port](const httplib::Request& request, httplib::Response& response) {
    Connection::complete_request();
    const bool knows = request.path.size() > token.size() + 1 && same(request.path.substr(1, token.size()), token) &&
                       request.path[token.size() + 1] == '/';
    if (knows && is_ours(request, port)) return httplib::Server::HandlerResponse::Unhandled;
    response.status = 403;
    response.set_content("forbidden\n", "text/plain");
    return httplib::Server::HandlerResponse::Handled;
  });
  Get("/[0-9a-f]+/", [answers](const httplib::Request&, httplib::Response& response) {
    reply(response, "text/html; charset=utf-8", answers.page);
  });
  Get("/[0-9a-f]+/data", [answers](const httplib::Request& request, httplib::Response& response) {
    reply(response, "application/octet-stream", [&] {
      auto answer = answers.data({count_of(request, "rows"), count_of(request, "pictures"), count_of(request, "log"),
                                  request.get_param_value("page")});
      Connection::after_sending(std::move(answer.after_sending));
      return std::move(answer.body);
    });
  });
  Post("/[0-9a-f]+/control", [answers](const httplib::Request& request, httplib::Response& response) {
    reply(response, "application/json", [&] { return answers.control(request.get_param_value("order")); });
  });
  Post("/[0-9a-f]+/set", [answers](const httplib::Request& request, httplib::Response& response) {
    reply(response, "application/json",
          [&] { return answers.set(request.get_param_value("variable"), request.get_param_value("value")); });
  });
}

void RequestServer::end() {
  connections_.close_all();
  stop();
}

bool RequestServer::answer(httplib::Stream& stream) {
  bool is_closed = false;
  return process_request(stream, true, is_closed, nullptr);
}

bool RequestServer::process_and_close_socket(socket_t socket) {
  Connection connection(connections_, socket);
  if (!connection.begins_request() || !answer(connection)) return false;
  connection.report_sent();
  return true;
}

}  // namespace mebots::live
