// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <cstdio>
#include <memory>
#include <string>
#include <string_view>

namespace mebots::soc::observe {

/// Writes a text file during a run. Error messages name the option that requested the file.
class TextFile {
 public:
  /// Throws Error if the file cannot be written.
  TextFile(std::string option, std::string path);

  template <typename... Arguments>
  void print(fmt::format_string<Arguments...> text, Arguments&&... arguments) {
    fmt::format_to(fmt::appender(buffer_), text, std::forward<Arguments>(arguments)...);
    if (buffer_.size() > kFull) flush();
  }
  void put(std::string_view text) {
    buffer_.append(text);
    if (buffer_.size() > kFull) flush();
  }

  /// Throws Error if a part of the file could not be written.
  void close();

  const std::string& path() const { return path_; }

 private:
  static constexpr std::size_t kFull = 1U << 16;
  struct Closer {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  void flush();

  std::string option_;
  std::string path_;
  std::unique_ptr<std::FILE, Closer> file_;
  fmt::memory_buffer buffer_;
  bool failed_ = false;
};

}  // namespace mebots::soc::observe
