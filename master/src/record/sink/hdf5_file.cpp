// SPDX-License-Identifier: Apache-2.0
#include "record/sink/hdf5_file.hpp"

#include "mebots/input_error.hpp"
#include "record/sink/output_file.hpp"

#include <fmt/format.h>

#include <algorithm>

#if __has_include(<H5FDdevelop.h>)
#include <H5FDdevelop.h>  // in HDF5 1.14, this header declares drivers
#endif
#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <map>
#include <span>
#include <utility>

namespace mebots::master::hdf5 {
namespace {

constexpr std::size_t kPageBytes = 4096;
using Page = std::array<std::byte, kPageBytes>;

/// The argument of H5Pset_driver() for this driver.
struct DriverInfo {
  int* error_number;
};

/// An open file of the driver. HDF5 uses the base class (H5FDpublic.h).
struct DriverFile : H5FD_t {
  int descriptor = -1;
  int* error_number = nullptr;
  haddr_t end_of_allocation = 0;
  haddr_t end_of_file = 0;
  std::map<haddr_t, Page> unwritten;  // pages written after the first error, by number
};

DriverFile& as_file(H5FD_t* file) {
  return *static_cast<DriverFile*>(file);
}
const DriverFile& as_file(const H5FD_t* file) {
  return *static_cast<const DriverFile*>(file);
}

/// Repeats `call` until `size` bytes are transferred, because a signal (EINTR) or a short transfer may interrupt a
/// call. Returns the number of transferred bytes. If it is less than `size`, errno states the error, or is 0 at the end
/// of the file.
template <typename Call>
std::size_t transfer_all(std::size_t size, Call call) {
  std::size_t done = 0;
  while (done < size) {
    errno = 0;
    const auto count = call(done);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) break;
    done += static_cast<std::size_t>(count);
  }
  return done;
}

/// Reads bytes from the disk. Bytes after the end of the file are zero. Returns false after an error.
bool read_disk(const DriverFile& file, haddr_t address, std::span<std::byte> bytes) {
  const auto count = transfer_all(bytes.size(), [&](std::size_t done) {
    return ::pread(file.descriptor, bytes.data() + done, bytes.size() - done, static_cast<off_t>(address + done));
  });
  const bool good = count == bytes.size() || errno == 0;
  std::ranges::fill(bytes.subspan(count), std::byte{0});
  return good;
}

/// Calls use(page, offset, part) for each page that overlaps with `bytes`. `offset` is the position of the part in the
/// page.
template <typename Byte, typename Use>
void for_each_page(haddr_t address, std::span<Byte> bytes, Use use) {
  while (!bytes.empty()) {
    const auto offset = static_cast<std::size_t>(address % kPageBytes);
    const auto count = std::min(bytes.size(), kPageBytes - offset);
    use(address / kPageBytes, offset, bytes.first(count));
    address += count;
    bytes = bytes.subspan(count);
  }
}

void keep_in_memory(DriverFile& file, haddr_t address, std::span<const std::byte> bytes) {
  for_each_page(address, bytes, [&](haddr_t number, std::size_t offset, std::span<const std::byte> part) {
    const auto [page, is_new] = file.unwritten.try_emplace(number);
    if (is_new) read_disk(file, number * kPageBytes, page->second);
    std::ranges::copy(part, page->second.begin() + static_cast<std::ptrdiff_t>(offset));
  });
}

H5FD_t* open_file(const char* name, unsigned, hid_t access, haddr_t) {
  const auto* info = static_cast<const DriverInfo*>(H5Pget_driver_info(access));
  constexpr int kReadableByAll = 0644;
  const int descriptor = ::open(name, O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, kReadableByAll);
  if (descriptor < 0) {
    *info->error_number = errno;
    return nullptr;
  }
  auto* file = new DriverFile{};  // NOLINT(cppcoreguidelines-owning-memory): HDF5 owns it until it calls close_file
  file->descriptor = descriptor;
  file->error_number = info->error_number;
  return file;
}

herr_t close_file(H5FD_t* file) {
  auto& self = as_file(file);
  // Some file systems report a full disk only at close().
  if (::close(self.descriptor) != 0 && errno != EINTR && *self.error_number == 0) *self.error_number = errno;
  delete &self;  // NOLINT(cppcoreguidelines-owning-memory): see open_file
  return 0;
}

herr_t query_features(const H5FD_t*, unsigned long* flags) {
  *flags = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_ACCUMULATE_METADATA | H5FD_FEAT_DATA_SIEVE |
           H5FD_FEAT_AGGREGATE_SMALLDATA | H5FD_FEAT_DEFAULT_VFD_COMPATIBLE;
  return 0;
}

haddr_t get_end_of_allocation(const H5FD_t* file, H5FD_mem_t) {
  return as_file(file).end_of_allocation;
}

herr_t set_end_of_allocation(H5FD_t* file, H5FD_mem_t, haddr_t address) {
  as_file(file).end_of_allocation = address;
  return 0;
}

haddr_t get_end_of_file(const H5FD_t* file, H5FD_mem_t) {
  return as_file(file).end_of_file;
}

herr_t read_bytes(H5FD_t* file, H5FD_mem_t, hid_t, haddr_t address, std::size_t size, void* buffer) {
  const auto& self = as_file(file);
  const std::span bytes(static_cast<std::byte*>(buffer), size);
  if (!read_disk(self, address, bytes)) {
    if (*self.error_number == 0) *self.error_number = errno;
    return -1;
  }
  for_each_page(address, bytes, [&](haddr_t number, std::size_t offset, std::span<std::byte> part) {
    const auto page = self.unwritten.find(number);
    if (page == self.unwritten.end()) return;
    std::copy_n(page->second.begin() + static_cast<std::ptrdiff_t>(offset), part.size(), part.begin());
  });
  return 0;
}

herr_t write_bytes(H5FD_t* file, H5FD_mem_t, hid_t, haddr_t address, std::size_t size, const void* buffer) {
  auto& self = as_file(file);
  const std::span bytes(static_cast<const std::byte*>(buffer), size);
  self.end_of_file = std::max(self.end_of_file, address + size);
  std::size_t done = 0;
  if (*self.error_number == 0) {
    done = transfer_all(size, [&](std::size_t start) {
      return ::pwrite(self.descriptor, bytes.data() + start, size - start, static_cast<off_t>(address + start));
    });
    if (done < size) *self.error_number = errno != 0 ? errno : EIO;
  }
  keep_in_memory(self, address + done, bytes.subspan(done));
  return 0;
}

/// Sets the length of the file to the length that HDF5 allocated.
herr_t set_length(H5FD_t* file, hid_t, hbool_t) {
  auto& self = as_file(file);
  if (self.end_of_file == self.end_of_allocation) return 0;
  self.end_of_file = self.end_of_allocation;
  if (*self.error_number != 0) return 0;
  int status = 0;
  do {
    status = ::ftruncate(self.descriptor, static_cast<off_t>(self.end_of_allocation));
  } while (status != 0 && errno == EINTR);
  if (status != 0) *self.error_number = errno;
  return 0;
}

/// Locks the file, so that other programs do not read an incomplete file.
herr_t lock_file(H5FD_t* file, hbool_t for_writing) {
  const int status = ::flock(as_file(file).descriptor, (for_writing ? LOCK_EX : LOCK_SH) | LOCK_NB);
  return status == 0 || errno == ENOSYS || errno == EOPNOTSUPP ? 0 : -1;
}

herr_t unlock_file(H5FD_t* file) {
  ::flock(as_file(file).descriptor, LOCK_UN);
  return 0;
}

H5FD_class_t make_driver_class() {
  H5FD_class_t driver{};
#ifdef H5FD_CLASS_VERSION
  driver.version = H5FD_CLASS_VERSION;
  constexpr H5FD_class_value_t kFirstValueForUsers = 256;
  driver.value = kFirstValueForUsers;
#endif
  driver.name = "mebots";
  driver.maxaddr = (haddr_t{1} << 63U) - 1;  // largest value of off_t
  driver.fc_degree = H5F_CLOSE_WEAK;
  driver.fapl_size = sizeof(DriverInfo);
  driver.open = &open_file;
  driver.close = &close_file;
  driver.query = &query_features;
  driver.get_eoa = &get_end_of_allocation;
  driver.set_eoa = &set_end_of_allocation;
  driver.get_eof = &get_end_of_file;
  driver.read = &read_bytes;
  driver.write = &write_bytes;
  driver.truncate = &set_length;
  driver.lock = &lock_file;
  driver.unlock = &unlock_file;
  constexpr std::array<H5FD_mem_t, H5FD_MEM_NTYPES> kFreeLists = H5FD_FLMAP_DICHOTOMY;
  std::ranges::copy(kFreeLists, driver.fl_map);
  return driver;
}

hid_t driver_id() {
  static const auto driver = make_driver_class();  // HDF5 stores a pointer to it
  static const auto id = H5FDregister(&driver);
  return id;
}

}  // namespace

File::File(std::filesystem::path path) : path_(std::move(path)) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // prevents HDF5 from printing its error stack
  std::error_code ignored;
  if (std::filesystem::is_symlink(path_, ignored)) std::filesystem::remove(path_, ignored);
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), &H5Pclose);
  const DriverInfo info{&error_number_};
  H5Pset_driver(access, driver_id(), &info);
  id_ = H5Fcreate(path_.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access);
  if (id_ < 0) {
    const char* reason = error_number_ != 0 ? std::strerror(error_number_) : "HDF5 reports an error";
    throw InputError(
        ErrorCode::file_unwritable,
        fmt::format("{}: the file cannot be written: {}. Choose another folder with --out", path_.string(), reason));
  }
}

File::~File() {
  if (id_ >= 0) H5Fclose(id_);
}

void File::check() const {
  if (error_number_ != 0) fail();
}

void File::fail() const {
  if (error_number_ != 0) throw write_error(path_, error_number_);
  throw Error(ErrorCode::file_unwritable, fmt::format("{}: HDF5 could not write the file", path_.string()));
}

void File::close() {
  if (id_ < 0) return;
  const bool closed = H5Fclose(std::exchange(id_, H5I_INVALID_HID)) >= 0;
  if (closed && error_number_ == 0) return;
  std::error_code ignored;
  std::filesystem::remove(path_, ignored);
  fail();
}

std::mutex& library() {
  static std::mutex mutex;
  return mutex;
}

Handle text_type() {
  Handle type(H5Tcopy(H5T_C_S1), &H5Tclose);
  H5Tset_size(type, H5T_VARIABLE);
  H5Tset_cset(type, H5T_CSET_UTF8);
  return type;
}

bool put_attribute(hid_t object, const char* name, const std::string& text) {
  const Handle type = text_type();
  const Handle space(H5Screate(H5S_SCALAR), &H5Sclose);
  const Handle attribute(H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT), &H5Aclose);
  const char* content = text.c_str();
  return H5Awrite(attribute, type, &content) >= 0;
}

std::string without_slashes(std::string name) {
  std::replace(name.begin(), name.end(), '/', '|');
  return name;
}

}  // namespace mebots::master::hdf5
