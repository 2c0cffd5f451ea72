// SPDX-License-Identifier: Apache-2.0
#include "fmi/call/callbacks.hpp"

#include <sys/uio.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <string_view>

namespace mebots::master {
namespace {

constexpr std::size_t kPage = 4096;  // smallest page size
constexpr std::size_t kFirstPiece = 256;
constexpr int kWidest = 1000;
constexpr int kMostConversions = 100;

/// Copies `size` bytes of a single page. Returns false if they cannot be read.
bool copy_out(const char* from, char* to, std::size_t size) {
  const iovec local{to, size};
  const iovec remote{const_cast<char*>(from), size};
  if (process_vm_readv(getpid(), &local, 1, &remote, 1, 0) == static_cast<ssize_t>(size)) return true;
  if (errno == EFAULT || errno == ENOMEM) return false;
  std::memcpy(to, from, size);  // direct copy, because the system forbids the check
  return true;
}

/// The length modifier of a conversion, which determines the type of the argument.
enum class Length { usual, l, ll, z, j, t, L };

/// The arguments of a format. A struct can be passed by reference, but a va_list may be an array, which cannot.
struct Arguments {
  std::va_list list;
};

std::int64_t signed_argument(Arguments& arguments, Length length) {
  // NOLINTBEGIN(bugprone-branch-clone): types that are the same here may differ elsewhere
  switch (length) {
    case Length::l:
      return va_arg(arguments.list, long);
    case Length::ll:
      return va_arg(arguments.list, long long);
    case Length::z:
      return va_arg(arguments.list, ssize_t);
    case Length::j:
      return va_arg(arguments.list, std::intmax_t);
    case Length::t:
      return va_arg(arguments.list, std::ptrdiff_t);
    default:
      return va_arg(arguments.list, int);
  }
  // NOLINTEND(bugprone-branch-clone)
}

std::uint64_t unsigned_argument(Arguments& arguments, Length length) {
  return length == Length::usual || length == Length::L
             ? va_arg(arguments.list, unsigned)
             : static_cast<std::uint64_t>(signed_argument(arguments, length));
}

template <typename Value>
std::string printed(const std::string& form, Value value) {
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wformat-nonliteral"
#pragma GCC diagnostic ignored "-Wformat-security"
  const int length = std::snprintf(nullptr, 0, form.c_str(), value);
  if (length < 0) return {};
  std::string text(static_cast<std::size_t>(length), '\0');
  std::snprintf(text.data(), text.size() + 1, form.c_str(), value);
#pragma GCC diagnostic pop
  return text;
}

class Formatter {
 public:
  Formatter(std::string_view format, Arguments& arguments) : format_(format), arguments_(&arguments) {}

  std::string run() {
    for (int conversions = 0; at_ < format_.size() && text_.size() < kLongestText;) {
      const auto percent = std::min(format_.find('%', at_), format_.size());
      text_ += format_.substr(at_, percent - at_);
      at_ = percent;
      if (at_ == format_.size()) break;
      if (++conversions > kMostConversions || !convert()) {
        text_ += format_.substr(at_);
        break;
      }
    }
    text_.resize(std::min(text_.size(), kLongestText));
    return std::move(text_);
  }

 private:
  char peek(std::size_t at) const { return at < format_.size() ? format_[at] : '\0'; }

  /// Reads a width or precision at `at`, and moves `at` after it. Returns nullopt if the number is missing or negative.
  std::optional<int> number(std::size_t& at) {
    if (peek(at) == '*') {
      ++at;
      const int value = va_arg(arguments_->list, int);
      return value < 0 ? std::nullopt : std::optional(std::min(value, kWidest));
    }
    std::optional<int> value;
    for (; peek(at) >= '0' && peek(at) <= '9'; ++at)
      value = std::min(value.value_or(0) * 10 + (peek(at) - '0'), kWidest);
    return value;
  }

  static Length length_of(std::string_view modifier) {
    if (modifier == "l") return Length::l;
    if (modifier == "ll" || modifier == "q") return Length::ll;
    if (modifier == "z") return Length::z;
    if (modifier == "j") return Length::j;
    if (modifier == "t") return Length::t;
    return modifier == "L" ? Length::L : Length::usual;  // int for h and hh
  }

  /// Formats the conversion at at_, and moves at_ after it. Returns false for an unknown conversion.
  bool convert() {
    auto at = at_ + 1;
    std::string form = "%";
    while (std::string_view("-+ #0").find(peek(at)) != std::string_view::npos && peek(at) != '\0' && form.size() < 6) {
      form += peek(at++);
    }
    const bool left = form.find('-') != std::string::npos;
    const auto width = number(at);
    if (width) form += std::to_string(*width);
    std::optional<int> precision;
    if (peek(at) == '.') {
      ++at;
      precision = number(at);
      if (!precision && peek(at - 1) == '.') precision = 0;
      if (precision) form += '.' + std::to_string(*precision);
    }
    const auto modifier_at = at;
    while (std::string_view("hlqjztL").find(peek(at)) != std::string_view::npos && peek(at) != '\0') ++at;
    const auto length = length_of(format_.substr(modifier_at, at - modifier_at));
    if (!put(form, length, peek(at), width.value_or(0), left, precision)) return false;
    at_ = at + 1;
    return true;
  }

  bool put(const std::string& form, Length length, char kind, int width, bool left, std::optional<int> precision) {
    switch (kind) {
      case 'd':
      case 'i':
        text_ += printed(form + "jd", static_cast<std::intmax_t>(signed_argument(*arguments_, length)));
        return true;
      case 'o':
      case 'u':
      case 'x':
      case 'X':
        text_ += printed(form + "j" + kind, static_cast<std::uintmax_t>(unsigned_argument(*arguments_, length)));
        return true;
      case 'a':
      case 'A':
      case 'e':
      case 'E':
      case 'f':
      case 'F':
      case 'g':
      case 'G':
        text_ += length == Length::L ? printed(form + "L" + kind, va_arg(arguments_->list, long double))
                                     : printed(form + kind, va_arg(arguments_->list, double));
        return true;
      case 'c':
        put_padded(std::string(1, static_cast<char>(va_arg(arguments_->list, int))), width, left);
        return true;
      case 's':
        put_string(length, width, left, precision);
        return true;
      case 'p':
        text_ += printed("%p", va_arg(arguments_->list, void*));
        return true;
      case 'n':  // %n would write to the address in the argument
        va_arg(arguments_->list, void*);
        text_ += "%n";
        return true;
      case '%':
        text_ += '%';
        return true;
      default:
        return false;
    }
  }

  void put_string(Length length, int width, bool left, std::optional<int> precision) {
    const auto* address = va_arg(arguments_->list, const char*);
    if (length == Length::l) {
      text_ += "(wide text)";
      return;
    }
    const auto most = precision ? static_cast<std::size_t>(*precision) : kLongestText;
    put_padded(read_text(address, most).value_or(address == nullptr ? "(null)" : "(unreadable)"), width, left);
  }

  void put_padded(std::string text, int width, bool left) {
    const auto missing =
        static_cast<std::size_t>(width) > text.size() ? static_cast<std::size_t>(width) - text.size() : 0;
    text.insert(left ? text.size() : 0, missing, ' ');
    text_ += text;
  }

  std::string_view format_;
  Arguments* arguments_;
  std::size_t at_ = 0;
  std::string text_;
};

}  // namespace

std::optional<std::string> read_text(const char* address, std::size_t most) {
  if (address == nullptr) return std::nullopt;
  std::string text;
  std::array<char, kPage> piece;
  auto wanted = kFirstPiece;
  while (text.size() < most) {
    const auto* from = address + text.size();
    const auto left_in_page = kPage - reinterpret_cast<std::uintptr_t>(from) % kPage;
    const auto size = std::min({wanted, left_in_page, most - text.size()});
    if (!copy_out(from, piece.data(), size)) return std::nullopt;
    auto* end = std::find(piece.data(), piece.data() + size, '\0');
    text.append(piece.data(), end);
    if (end != piece.data() + size) break;
    wanted = kPage;
  }
  return text;
}

bool is_readable(std::span<const std::uint8_t> bytes) {
  constexpr std::size_t kAtOnce = 64;
  std::array<iovec, kAtOnce> remote;
  std::array<char, kAtOnce> copies;
  for (std::size_t at = 0; at < bytes.size();) {
    std::size_t count = 0;
    for (; count < kAtOnce - 1 && at < bytes.size(); at += kPage) {
      remote[count++] = {const_cast<std::uint8_t*>(&bytes[at]), 1};
    }
    if (at >= bytes.size()) remote[count++] = {const_cast<std::uint8_t*>(&bytes.back()), 1};
    const iovec local{copies.data(), count};
    const auto copied = process_vm_readv(getpid(), &local, 1, remote.data(), count, 0);
    if (copied != static_cast<ssize_t>(count)) return copied < 0 && errno != EFAULT && errno != ENOMEM;
  }
  return true;
}

std::string format_text(const std::string& format, std::va_list arguments) {
  Arguments own;
  va_copy(own.list, arguments);
  auto text = Formatter(format, own).run();
  va_end(own.list);
  return text;
}

}  // namespace mebots::master
