// SPDX-License-Identifier: Apache-2.0
#include "connection.hpp"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <utility>

namespace mebots::live {
namespace {

thread_local Connection* served = nullptr;

}  // namespace

void Connections::accept() {
  if (++accepted_ <= kMost) return;
  const std::lock_guard lock(mutex_);
  for (auto* connection : open_) {
    if (connection->is_reading()) connection->shut_down();
  }
}

void Connections::close_all() {
  const std::lock_guard lock(mutex_);
  closed_at_ = std::chrono::steady_clock::now();
  for (auto* connection : open_) {
    if (connection->is_reading()) connection->shut_down();
  }
}

Connection::Connection(Connections& all, int socket)
    : all_(&all), socket_(socket), request_until_(Clock::now() + (all.is_crowded() ? kCrowdedTime : kIdleTime)) {
  served = this;
  const std::lock_guard lock(all.mutex_);
  all.open_.insert(this);
  if (all.closed_at() != Clock::time_point::max()) shut_down();
}

Connection::~Connection() {
  served = nullptr;
  const std::lock_guard lock(all_->mutex_);
  all_->open_.erase(this);
  shut_down();
  close(socket_);
}

bool Connection::begins_request() {
  if (!is_readable()) return false;
  request_until_ = std::min(request_until_, Clock::now() + kRequestTime);
  return true;
}

void Connection::complete_request() {
  if (served != nullptr) served->is_reading_ = false;
}

void Connection::after_sending(std::function<void()> then) {
  if (served != nullptr) served->after_sending_ = std::move(then);
}

void Connection::shut_down() {
  ::shutdown(socket_, SHUT_RDWR);
}

bool Connection::is_too_late(Clock::time_point until) const {
  const auto now = Clock::now();
  const auto closed_at = all_->closed_at();
  return now >= until || (closed_at != Clock::time_point::max() && now >= closed_at + kLastAnswerTime);
}

bool Connection::waits_for(short event, Clock::time_point until) const {
  constexpr int kLookMs = 50;  // time between two checks of the clock
  while (!is_too_late(until)) {
    pollfd descriptor{socket_, event, 0};
    const int ready = poll(&descriptor, 1, kLookMs);
    if (ready > 0) return true;
    if (ready < 0 && errno != EINTR) return false;
  }
  return false;
}

bool Connection::is_readable() const {
  return waits_for(POLLIN, request_until_);
}

bool Connection::is_writable() const {
  return waits_for(POLLOUT, answer_until_ == Clock::time_point{} ? Clock::now() + kAnswerTime : answer_until_);
}

ssize_t Connection::read(char* data, std::size_t size) {
  size = std::min(size, bytes_left_);
  if (size == 0 || !is_readable()) return -1;
  const auto count = recv(socket_, data, size, 0);
  if (count > 0) bytes_left_ -= static_cast<std::size_t>(count);
  return count;
}

ssize_t Connection::write(const char* data, std::size_t size) {
  if (answer_until_ == Clock::time_point{}) answer_until_ = Clock::now() + kAnswerTime;
  if (!is_writable()) return -1;
  return send(socket_, data, size, MSG_NOSIGNAL | MSG_DONTWAIT);
}

void Connection::get_remote_ip_and_port(std::string& ip, int& port) const {
  ip = "127.0.0.1";  // the server listens only on this address
  port = 0;
}

void Connection::get_local_ip_and_port(std::string& ip, int& port) const {
  get_remote_ip_and_port(ip, port);
}

}  // namespace mebots::live
