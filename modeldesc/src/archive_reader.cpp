// SPDX-License-Identifier: Apache-2.0
#include "mebots/modeldesc/archive_reader.hpp"
#include "mebots/assert.hpp"

#include "mebots/error.hpp"
#include "mebots/file_kind.hpp"

#include <fmt/format.h>
#include <sys/stat.h>
#include <zip.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <unordered_map>
#include <utility>

namespace mebots::modeldesc {
namespace {

namespace fs = std::filesystem;

struct CloseFile {
  void operator()(zip_file_t* file) const { zip_fclose(file); }
};
using ArchiveFile = std::unique_ptr<zip_file_t, CloseFile>;

/// Returns the kind of archive that begins with these bytes, such as "a RAR archive"; empty if the kind is unknown.
std::string_view other_archive(std::string_view bytes) {
  using namespace std::string_view_literals;
  constexpr std::pair<std::string_view, std::string_view> kKinds[] = {{"7z\xbc\xaf\x27\x1c"sv, "a 7-Zip archive"},
                                                                      {"\xfd\x37zXZ\0"sv, "an xz archive"},
                                                                      {"\x1f\x8b"sv, "a gzip archive"},
                                                                      {"BZh"sv, "a bzip2 archive"},
                                                                      {"\x28\xb5\x2f\xfd"sv, "a Zstandard archive"},
                                                                      {"Rar!\x1a\x07"sv, "a RAR archive"},
                                                                      {"\x5d\0\0"sv, "an LZMA archive"}};
  for (const auto& [start, kind] : kKinds) {
    if (bytes.starts_with(start)) return kind;
  }
  return {};
}

/// Reports that an archive cannot be opened. `start` contains the first bytes of the file.
[[noreturn]] void cannot_open(std::string_view name, std::string_view reason, std::string_view start) {
  if (const auto kind = other_archive(start); !kind.empty()) {
    throw Error(ErrorCode::archive_damaged,
                fmt::format("{}: this is {}, but FMUs and SSPs are zip archives; unpack it and pack its content with "
                            "`zip -r NEW.fmu *`",
                            name, kind));
  }
  throw Error(ErrorCode::archive_damaged,
              fmt::format("{}: {}; an FMU is a zip archive; was it copied completely?", name, reason));
}

std::string first_bytes(const fs::path& file) {
  std::string bytes(8, '\0');
  std::ifstream stream(file, std::ios::binary);
  stream.read(bytes.data(), std::ssize(bytes));
  bytes.resize(static_cast<std::size_t>(stream.gcount()));
  return bytes;
}

std::string compression_name(std::uint16_t method) {
  switch (method) {
    case ZIP_CM_DEFLATE64:
      return "Deflate64";
    case ZIP_CM_BZIP2:
      return "BZIP2";
    case ZIP_CM_LZMA:
      return "LZMA";
    case ZIP_CM_XZ:
      return "XZ";
    case ZIP_CM_PPMD:
      return "PPMd";
    case 93:  // libzip 1.7 does not name it
      return "Zstandard";
    default:
      return fmt::format("method {}", method);
  }
}

class ZipError {
 public:
  ZipError() { zip_error_init(&error_); }
  explicit ZipError(int code) { zip_error_init_with_code(&error_, code); }
  ~ZipError() { zip_error_fini(&error_); }
  ZipError(const ZipError&) = delete;
  ZipError& operator=(const ZipError&) = delete;

  zip_error_t* get() { return &error_; }
  const char* text() { return zip_error_strerror(&error_); }

 private:
  zip_error_t error_{};
};

}  // namespace

void DiscardZip::operator()(zip* archive) const {
  zip_discard(archive);
}

ZipHandle open_zip(const fs::path& archive) {
  if (!is_there(archive))
    throw Error(ErrorCode::file_not_found, fmt::format("{}: there is no such file", archive.string()));
  if (is_folder(archive))
    throw Error(ErrorCode::file_not_found, fmt::format("{}: this is a folder, not an archive", archive.string()));
  int code = 0;
  ZipHandle handle(zip_open(archive.c_str(), ZIP_RDONLY, &code));
  if (!handle) cannot_open(archive.string(), ZipError(code).text(), first_bytes(archive));
  return handle;
}

ZipHandle open_zip(std::string_view bytes, std::string_view name) {
  ZipError error;
  zip_source_t* source = zip_source_buffer_create(bytes.data(), bytes.size(), 0, error.get());
  if (source == nullptr) cannot_open(name, error.text(), {});
  ZipHandle handle(zip_open_from_source(source, ZIP_RDONLY, error.get()));
  if (handle) return handle;
  zip_source_free(source);
  cannot_open(name, error.text(), bytes);
}

std::optional<std::string> normal_entry_name(std::string_view name) {
  std::string normal;
  normal.reserve(name.size());
  while (!name.empty()) {
    const auto end = name.find('/');
    const auto part = name.substr(0, end);
    name.remove_prefix(end == std::string_view::npos ? name.size() : end + 1);
    if (part == "..") return std::nullopt;
    if (part.empty() || part == ".") continue;
    normal += part;
    if (end != std::string_view::npos) normal += '/';
  }
  return normal;
}

ArchiveReader::ArchiveReader(ZipHandle archive, std::string name, const UnpackLimits& limits)
    : archive_(std::move(archive)), name_(std::move(name)), limits_(limits) {
  const zip_int64_t count = zip_get_num_entries(archive_.get(), 0);
  if (count < 0 || static_cast<std::uint64_t>(count) > limits_.entries)
    throw Error(ErrorCode::archive_damaged,
                fmt::format("{}: {} entries are more than the limit of {}", name_, count, limits_.entries));
  std::unordered_map<std::string, std::size_t> places;  // of entries, by their normal names
  places.reserve(static_cast<std::size_t>(count));
  entries_.reserve(static_cast<std::size_t>(count));
  std::uint64_t total = 0;
  for (zip_int64_t i = 0; i < count; ++i) {
    zip_stat_t stat;
    const auto index = static_cast<zip_uint64_t>(i);
    if (zip_stat_index(archive_.get(), index, 0, &stat) != 0)
      throw Error(ErrorCode::archive_damaged, fmt::format("{}: entry {}: {}", name_, i, zip_strerror(archive_.get())));
    std::string entry_name = stat.name;
    std::ranges::replace(entry_name, '\\', '/');
    if (entry_name != stat.name) ++backslashes_;
    const bool is_folder = entry_name.ends_with('/');
    Entry entry{index, std::move(entry_name), stat.size, is_folder};
    auto normal = checked_name(entry.name);
    check_kind(entry);
    check_storage(entry);
    const auto [place, is_new] = places.emplace(std::move(normal), entries_.size());
    if (!is_new) {
      if (!is_same(entry, entries_[place->second])) refuse(entry.name, "occurs twice with different bytes");
      ++repeated_;
      continue;
    }
    check_size(entry, stat.comp_size, total);
    entries_.push_back(std::move(entry));
  }
}

void ArchiveReader::refuse(std::string_view name, std::string_view why) const {
  throw Error(ErrorCode::archive_damaged,
              fmt::format("{}: the entry \"{}\" {}; the archive is refused", name_, name, why));
}

std::string ArchiveReader::checked_name(std::string_view name) const {
  if (name.empty()) refuse(name, "has no name");
  if (name.front() == '/') refuse(name, "is an absolute path");
  if (name.size() >= 2 && name[1] == ':') refuse(name, "starts with a drive letter");
  auto normal = normal_entry_name(name);
  if (!normal) refuse(name, "would leave the target folder");
  return *std::move(normal);
}

void ArchiveReader::check_kind(const Entry& entry) const {
  zip_uint8_t system = 0;
  zip_uint32_t attributes = 0;
  if (zip_file_get_external_attributes(archive_.get(), entry.index, 0, &system, &attributes) != 0) return;
  if (system != ZIP_OPSYS_UNIX && system != ZIP_OPSYS_OS_X) return;
  const auto kind = static_cast<mode_t>(attributes >> 16) & S_IFMT;
  if (kind == S_IFLNK) refuse(entry.name, "is a symbolic link");
  if (kind != 0 && kind != S_IFREG && kind != S_IFDIR) refuse(entry.name, "is neither a file nor a folder");
}

void ArchiveReader::check_storage(const Entry& entry) const {
  zip_stat_t stat;
  if (zip_stat_index(archive_.get(), entry.index, 0, &stat) != 0) return;
  if ((stat.valid & ZIP_STAT_ENCRYPTION_METHOD) != 0 && stat.encryption_method != ZIP_EM_NONE)
    refuse(entry.name, "is encrypted; pack the archive again without a password");
  if ((stat.valid & ZIP_STAT_COMP_METHOD) == 0 || zip_compression_method_supported(stat.comp_method, 0) != 0) return;
  refuse(entry.name,
         fmt::format("is compressed with {}, which cannot be read; pack the archive again with Deflate, such as with "
                     "`zip -r` or `7z a -tzip -mm=Deflate`",
                     compression_name(stat.comp_method)));
}

/// True if both entries are folders, or files with the same size and checksum.
bool ArchiveReader::is_same(const Entry& entry, const Entry& other) const {
  if (entry.is_folder || other.is_folder) return entry.is_folder && other.is_folder;
  zip_stat_t one;
  zip_stat_t two;
  return zip_stat_index(archive_.get(), entry.index, 0, &one) == 0 &&
         zip_stat_index(archive_.get(), other.index, 0, &two) == 0 && (one.valid & two.valid & ZIP_STAT_CRC) != 0 &&
         one.crc == two.crc && one.size == two.size;
}

void ArchiveReader::check_size(const Entry& entry, std::uint64_t packed, std::uint64_t& total) const {
  constexpr std::uint64_t kSmall = std::uint64_t{16} << 20;
  MEBOTS_ASSERT(total <= limits_.total_bytes, "each entry was held to what is left");
  if (entry.size > limits_.total_bytes - total)
    refuse(entry.name, fmt::format("brings the unpacked size above the limit of {} bytes", limits_.total_bytes));
  total += entry.size;
  if (entry.size > kSmall && static_cast<double>(entry.size) > limits_.ratio * static_cast<double>(packed))
    refuse(entry.name, fmt::format("unpacks {} bytes to {}, more than {} times", packed, entry.size, limits_.ratio));
}

void ArchiveReader::read(const Entry& entry, const std::function<void(std::string_view)>& take) const {
  const auto damaged = [&](std::string_view text) {
    throw Error(ErrorCode::archive_damaged,
                fmt::format("{}: the entry \"{}\" cannot be read: {}; was the file copied completely?", name_,
                            entry.name, text));
  };
  const ArchiveFile file(zip_fopen_index(archive_.get(), entry.index, 0));
  if (!file) damaged(zip_strerror(archive_.get()));
  std::array<char, 65536> buffer;  // NOLINT(cppcoreguidelines-pro-type-member-init): filled by zip_fread
  std::uint64_t taken = 0;
  for (;;) {
    const zip_int64_t size = zip_fread(file.get(), buffer.data(), buffer.size());
    if (size < 0) damaged(zip_file_strerror(file.get()));
    if (size == 0) break;
    taken += static_cast<std::uint64_t>(size);
    if (taken > entry.size) damaged(fmt::format("it contains more than the {} bytes that it declares", entry.size));
    MEBOTS_ASSERT(static_cast<std::size_t>(size) <= buffer.size());
    take({buffer.data(), static_cast<std::size_t>(size)});
  }
  if (taken != entry.size) damaged(fmt::format("it has only {} of {} bytes", taken, entry.size));
}

}  // namespace mebots::modeldesc
