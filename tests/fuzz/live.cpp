// SPDX-License-Identifier: Apache-2.0
//
// Handles any bytes from a client of a live run. The server must answer or reject each request. Only requests with the
// token may reach the run.
#include "server.hpp"

#include "require.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string>

namespace {

using namespace mebots;

constexpr const char* kToken = "0123456789abcdef0123456789abcdef";
constexpr int kPort = 8080;

/// A client that has sent all its bytes, and accepts every answer.
class Client final : public httplib::Stream {
 public:
  Client(const std::uint8_t* data, std::size_t size) : data_(data), left_(size) {}

  bool is_readable() const override { return true; }
  bool is_writable() const override { return true; }
  ssize_t read(char* to, std::size_t size) override {
    const auto count = std::min(size, left_);
    std::memcpy(to, data_, count);
    data_ += count;
    left_ -= count;
    return static_cast<ssize_t>(count);
  }
  ssize_t write(const char* /*data*/, std::size_t size) override { return static_cast<ssize_t>(size); }
  void get_remote_ip_and_port(std::string& ip, int& port) const override { ip = "127.0.0.1", port = 0; }
  void get_local_ip_and_port(std::string& ip, int& port) const override { ip = "127.0.0.1", port = kPort; }
  socket_t socket() const override { return -1; }

 private:
  const std::uint8_t* data_;
  std::size_t left_;
};

bool has_token = false;

std::string answered() {
  fuzz::require(has_token, "a request without the token reached the run");
  return "answer";
}

live::RequestServer& server() {
  static auto& only = *[] {
    auto* const made = new live::RequestServer;
    live::LiveRun::Server::Answers answers;
    answers.page = [] { return answered(); };
    answers.data = [](const auto& /*known*/) { return live::LiveRun::Server::Answer{answered(), [] {}}; };
    answers.control = [](const auto& /*order*/) { return answered(); };
    answers.set = [](const auto& /*variable*/, const auto& /*value*/) { return answered(); };
    made->route(kToken, kPort, answers);
    return made;
  }();
  return only;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  has_token = std::string_view(reinterpret_cast<const char*>(data), size).find("0123456789") != std::string_view::npos;
  Client client(data, size);
  server().answer(client);
  return 0;
}
