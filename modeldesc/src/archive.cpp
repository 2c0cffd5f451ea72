// SPDX-License-Identifier: Apache-2.0
#include "mebots/modeldesc/archive.hpp"

#include "mebots/error.hpp"
#include "mebots/file_kind.hpp"
#include "mebots/modeldesc/archive_reader.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zip.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <utility>

namespace mebots::modeldesc {
namespace {

namespace fs = std::filesystem;

void make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error)
    throw Error(ErrorCode::file_unwritable,
                fmt::format("{}: the folder cannot be created: {}", folder.string(), error.message()));
}

[[noreturn]] void cannot_write(const fs::path& file) {
  throw Error(ErrorCode::file_unwritable,
              fmt::format("{}: cannot be written: {}", file.string(), std::strerror(errno)));
}

/// Writes a new file. Faster than a stream for an archive with many small files.
class NewFile {
 public:
  explicit NewFile(const fs::path& path) : path_(&path) {
    constexpr mode_t kReadableByAll = 0666;
    descriptor_ = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, kReadableByAll);
    if (descriptor_ < 0) cannot_write(path);
  }
  ~NewFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;

  void write(std::string_view bytes) const {
    while (!bytes.empty()) {
      const auto count = ::write(descriptor_, bytes.data(), bytes.size());
      if (count < 0 && errno == EINTR) continue;
      if (count < 0) cannot_write(*path_);
      bytes.remove_prefix(static_cast<std::size_t>(count));
    }
  }
  /// Ignores EINTR, because Linux closes the descriptor even if a signal interrupts close().
  void close() {
    if (::close(std::exchange(descriptor_, -1)) != 0 && errno != EINTR) cannot_write(*path_);
  }

 private:
  const fs::path* path_;
  int descriptor_ = -1;
};

void write_entry(const ArchiveReader& archive, const ArchiveReader::Entry& entry, const fs::path& target) {
  NewFile out(target);
  archive.read(entry, [&](std::string_view part) { out.write(part); });
  out.close();
}

ZipHandle create_archive(const fs::path& path) {
  int code = 0;
  ZipHandle archive(zip_open(path.c_str(), ZIP_CREATE | ZIP_TRUNCATE, &code));
  if (archive) return archive;
  zip_error_t error;
  zip_error_init_with_code(&error, code);
  const std::string text = zip_error_strerror(&error);
  zip_error_fini(&error);
  throw Error(ErrorCode::file_unwritable, fmt::format("{}: {}; the archive cannot be written", path.string(), text));
}

}  // namespace

std::vector<std::string> unpack(const fs::path& archive, const fs::path& folder, const UnpackLimits& limits) {
  const ArchiveReader reader(open_zip(archive), archive.string(), limits);
  make_folder(folder);
  std::string made;  // the previous entry's folder; the next entry often has the same
  for (const auto& entry : reader.entries()) {
    if (auto parent = entry.name.substr(0, entry.name.rfind('/') + 1); parent != made) {
      make_folder(folder / parent);
      made = std::move(parent);
    }
    if (!entry.is_folder) write_entry(reader, entry, folder / entry.name);
  }
  std::vector<std::string> notices;
  if (reader.backslashes() > 0) {
    notices.push_back(
        fmt::format("{}: backslashes in the names of its entries ({} of them) are read as slashes; the zip format "
                    "knows slashes only",
                    archive.string(), reader.backslashes()));
  }
  if (reader.repeated() > 0) {
    notices.push_back(fmt::format("{}: {} of its entries repeat another entry with the same bytes, and are ignored",
                                  archive.string(), reader.repeated()));
  }
  return notices;
}

std::string why_missing(const fs::path& folder, const std::string& name) {
  const auto lower = [](std::string text) {
    std::ranges::transform(text, text.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return text;
  };
  std::string found;  // the shortest path, so that the result does not depend on the order of directory entries
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file() || lower(entry.path().filename().string()) != lower(name)) continue;
    const auto path = entry.path().lexically_relative(folder).generic_string();
    if (found.empty() || std::pair(path.size(), path) < std::pair(found.size(), found)) found = path;
  }
  if (found.empty()) return fmt::format("it contains no {}", name);
  if (const auto top = fs::path(found).parent_path(); !top.empty()) {
    return fmt::format(
        "{} must be at the root of the archive, but is \"{}\"; pack the content of the folder "
        "\"{}\", not the folder: `cd {} && zip -r NEW.fmu *`",
        name, found, top.generic_string(), top.generic_string());
  }
  return fmt::format("its \"{}\" must be called \"{}\", with these capitals; rename it and pack the archive again",
                     found, name);
}

void pack(const fs::path& archive, std::vector<PackedFile> files) {
  std::ranges::sort(files, {}, &PackedFile::entry);
  const auto twice = std::ranges::adjacent_find(files, {}, &PackedFile::entry);
  if (twice != files.end())
    throw Error(ErrorCode::duplicate_name,
                fmt::format("{}: both {} and {} would become the entry {}", archive.string(), twice->source.string(),
                            std::next(twice)->source.string(), twice->entry));
  ZipHandle zip = create_archive(archive);
  for (const PackedFile& file : files) {
    const auto fail = [&] {
      throw Error(ErrorCode::file_unwritable, fmt::format("{}: {} cannot be added as {}: {}", archive.string(),
                                                          file.source.string(), file.entry, zip_strerror(zip.get())));
    };
    if (!is_file(file.source))
      throw Error(ErrorCode::file_not_found,
                  fmt::format("{}: {} is missing, or is not a file", archive.string(), file.source.string()));
    zip_source_t* source = zip_source_file(zip.get(), file.source.c_str(), 0, -1);
    if (source == nullptr) fail();
    const zip_int64_t added = zip_file_add(zip.get(), file.entry.c_str(), source, ZIP_FL_ENC_UTF_8);
    if (added < 0) {
      zip_source_free(source);
      fail();
    }
    const auto index = static_cast<zip_uint64_t>(added);
    // Makes the archive reproducible with fixed permissions and a fixed date: 1 January 1980, the first day that zip
    // can represent.
    constexpr zip_uint16_t kDosTime = 0;
    constexpr zip_uint16_t kDosDate = (1U << 5) | 1U;
    constexpr zip_uint32_t kMode = (S_IFREG | 0644U);
    if (zip_file_set_dostime(zip.get(), index, kDosTime, kDosDate, 0) != 0) fail();
    if (zip_file_set_external_attributes(zip.get(), index, 0, ZIP_OPSYS_UNIX, kMode << 16) != 0) fail();
    if (zip_set_file_compression(zip.get(), index, ZIP_CM_DEFLATE, 9) != 0) fail();
  }
  if (zip_close(zip.get()) != 0)
    throw Error(ErrorCode::file_unwritable,
                fmt::format("{}: cannot be written: {}", archive.string(), zip_strerror(zip.get())));
  (void)zip.release();  // closed
}

}  // namespace mebots::modeldesc
