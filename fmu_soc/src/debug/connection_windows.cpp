// SPDX-License-Identifier: Apache-2.0
// Reports that debuggers are not supported, because the connection is written for POSIX sockets.
#include "debug/connection.hpp"

#include "mebots/error.hpp"

namespace mebots::soc::debug {

Socket& Socket::operator=(Socket&& other) noexcept {
  descriptor_ = other.release();
  return *this;
}

Socket::~Socket() = default;

int Socket::release() {
  return -1;
}

Connection::Connection(int /*port*/) {
  throw Error("gdb cannot be connected on Windows; remove the parameter, or debug the firmware on Linux");
}

bool Connection::accept(bool /*wait*/) {
  return false;
}

std::optional<std::string> Connection::receive() {
  return std::nullopt;
}

void Connection::send(std::string_view /*content*/) {}

void Connection::refuse_others() {}

bool Connection::interrupted() {
  return false;
}

}  // namespace mebots::soc::debug
