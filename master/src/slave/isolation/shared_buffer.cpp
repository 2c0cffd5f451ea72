// SPDX-License-Identifier: Apache-2.0
#include "shared_buffer.hpp"

#include "mebots/assert.hpp"

#include <fmt/format.h>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <utility>

namespace mebots::master::isolation {
namespace {

constexpr std::size_t kFirstSize = 1 << 16;
/// The lowest descriptor of the master's buffers. Lower numbers are for the descriptors of a child process.
constexpr int kLowestDescriptor = 16;

[[noreturn]] void fail(const char* what) {
  throw Error(ErrorCode::system_failure,
              fmt::format("shared memory for an FMU's process: {}: {}", what, std::strerror(errno)));
}

}  // namespace

SharedBuffer::SharedBuffer(const char* name, std::size_t size) {
  const int made = memfd_create(name, MFD_CLOEXEC | MFD_ALLOW_SEALING);
  if (made < 0) fail("it cannot be created");
  descriptor_ = fcntl(made, F_DUPFD_CLOEXEC, kLowestDescriptor);
  ::close(made);
  if (descriptor_ < 0 || fcntl(descriptor_, F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_SEAL) != 0)
    fail("its size cannot be set");
  if (size > kFirstSize && ftruncate(descriptor_, static_cast<off_t>(size)) != 0) fail("it cannot grow");
  reserve(kFirstSize);
}

SharedBuffer::SharedBuffer(int descriptor) : descriptor_(descriptor) {
  fcntl(descriptor_, F_SETFD, FD_CLOEXEC);
  reserve(kFirstSize);
}

SharedBuffer::~SharedBuffer() {
  if (data_ != nullptr) munmap(data_, mapped_);
  if (descriptor_ >= 0) ::close(descriptor_);
}

void SharedBuffer::close_descriptor() {
  final_length_ = length();
  ::close(std::exchange(descriptor_, -1));
}

void SharedBuffer::reserve(std::size_t size) {
  if (size <= mapped_) return;
  MEBOTS_ASSERT(descriptor_ >= 0, "a buffer without its descriptor cannot grow");
  const auto wanted = std::bit_ceil(std::max(size, kFirstSize));
  if (length() < wanted && ftruncate(descriptor_, static_cast<off_t>(wanted)) != 0) fail("it cannot grow");
  map(wanted);
}

std::span<const std::byte> SharedBuffer::bytes(std::size_t size) {
  if (size > mapped_) {
    const auto there = length();
    if (there < size)
      throw DamagedMemory(
          "the shared memory between master and FMU process is damaged: it is shorter than its declared size");
    map(std::min(std::bit_ceil(size), there));  // the file may be larger than the buffer
  }
  return {data_, size};
}

std::size_t SharedBuffer::length() const {
  if (descriptor_ < 0) return final_length_;
  struct stat info {};
  if (fstat(descriptor_, &info) != 0) fail("its size cannot be read");
  return static_cast<std::size_t>(info.st_size);
}

void SharedBuffer::map(std::size_t size) {
  MEBOTS_ASSERT(size >= mapped_, "it never shrinks: the other side may look at the rest");
  void* const address = data_ == nullptr ? mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED, descriptor_, 0)
                                         : mremap(data_, mapped_, size, MREMAP_MAYMOVE);
  if (address == MAP_FAILED) fail("it cannot be mapped");
  data_ = static_cast<std::byte*>(address);
  mapped_ = size;
}

}  // namespace mebots::master::isolation
