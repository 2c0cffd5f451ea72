// SPDX-License-Identifier: Apache-2.0
#include "observe/text_file.hpp"

#include "mebots/error.hpp"

#include <cerrno>
#include <cstring>

namespace mebots::soc::observe {

TextFile::TextFile(std::string option, std::string path)
    : option_(std::move(option)), path_(std::move(path)), file_(std::fopen(path_.c_str(), "wb")) {
  if (file_ == nullptr) {
    throw Error(fmt::format("{} {}: cannot be written: {}", option_, path_, std::strerror(errno)));
  }
}

void TextFile::flush() {
  if (std::fwrite(buffer_.data(), 1, buffer_.size(), file_.get()) != buffer_.size()) failed_ = true;
  buffer_.clear();
}

void TextFile::close() {
  flush();
  if (std::fclose(file_.release()) != 0) failed_ = true;
  if (failed_) {
    throw Error(
        fmt::format("{} {}: could not be written to its end; is the disk full, or the limit of a file's size "
                    "(ulimit -f) reached?",
                    option_, path_));
  }
}

}  // namespace mebots::soc::observe
