// SPDX-License-Identifier: Apache-2.0
#include "mebots/modeldesc/archive.hpp"

#include "mebots/error.hpp"

#include <fmt/format.h>
#include <sys/stat.h>
#include <zip.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <memory>
#include <set>

namespace mebots::modeldesc {
namespace {

namespace fs = std::filesystem;

struct Discard {
  void operator()(zip_t* archive) const { zip_discard(archive); }
};
struct CloseFile {
  void operator()(zip_file_t* file) const { zip_fclose(file); }
};
using Archive = std::unique_ptr<zip_t, Discard>;
using ArchiveFile = std::unique_ptr<zip_file_t, CloseFile>;

Archive open_archive(const fs::path& path, int flags, std::string_view way_out) {
  int code = 0;
  zip_t* archive = zip_open(path.c_str(), flags, &code);
  if (archive == nullptr) {
    zip_error_t error;
    zip_error_init_with_code(&error, code);
    const std::string text = zip_error_strerror(&error);
    zip_error_fini(&error);
    throw Error(fmt::format("{}: {}; {}", path.string(), text, way_out));
  }
  return Archive(archive);
}

struct Entry {
  zip_uint64_t index = 0;
  std::string name;
  std::uint64_t size = 0;
  bool is_folder = false;
};

class Unpacker {
 public:
  Unpacker(const fs::path& archive, const UnpackLimits& limits) : path_(archive), limits_(limits) {
    if (!fs::exists(archive)) throw Error(fmt::format("{}: there is no such file", archive.string()));
    if (fs::is_directory(archive)) throw Error(fmt::format("{}: this is a folder, not an archive", archive.string()));
    archive_ = open_archive(archive, ZIP_RDONLY, "an FMU is a zip archive; was it copied completely?");
    read_entries();
  }

  void write_to(const fs::path& folder) {
    make_folder(folder);
    for (const Entry& entry : entries_) {
      const fs::path target = folder / entry.name;
      if (entry.is_folder) {
        make_folder(target);
        continue;
      }
      make_folder(target.parent_path());
      write_entry(entry, target);
    }
  }

 private:
  [[noreturn]] void refuse(std::string_view name, std::string_view why) const {
    throw Error(fmt::format("{}: the entry \"{}\" {}; the archive is refused", path_.string(), name, why));
  }

  void read_entries() {
    const zip_int64_t count = zip_get_num_entries(archive_.get(), 0);
    if (count < 0 || static_cast<std::uint64_t>(count) > limits_.entries)
      throw Error(fmt::format("{}: {} entries are more than the limit of {}", path_.string(), count, limits_.entries));
    std::set<std::string> names;
    std::uint64_t total = 0;
    for (zip_int64_t i = 0; i < count; ++i) {
      zip_stat_t stat;
      const auto index = static_cast<zip_uint64_t>(i);
      if (zip_stat_index(archive_.get(), index, 0, &stat) != 0)
        throw Error(fmt::format("{}: entry {}: {}", path_.string(), i, zip_strerror(archive_.get())));
      const Entry entry{index, stat.name, stat.size, std::string_view(stat.name).ends_with('/')};
      check_name(entry.name);
      check_kind(entry);
      if (!names.insert(fs::path(entry.name).lexically_normal()).second) refuse(entry.name, "is there twice");
      check_size(entry, stat.comp_size, total);
      entries_.push_back(entry);
    }
  }

  void check_name(std::string_view name) const {
    if (name.empty()) refuse(name, "has no name");
    if (name.find('\\') != std::string_view::npos) refuse(name, "has a backslash in its name");
    if (name.front() == '/') refuse(name, "is an absolute path");
    if (name.size() >= 2 && name[1] == ':') refuse(name, "starts with a drive letter");
    for (const fs::path& part : fs::path(name))
      if (part == "..") refuse(name, "would leave the target folder");
  }

  void check_kind(const Entry& entry) const {
    zip_uint8_t system = 0;
    zip_uint32_t attributes = 0;
    if (zip_file_get_external_attributes(archive_.get(), entry.index, 0, &system, &attributes) != 0) return;
    if (system != ZIP_OPSYS_UNIX && system != ZIP_OPSYS_OS_X) return;
    const auto kind = static_cast<mode_t>(attributes >> 16) & S_IFMT;
    if (kind == S_IFLNK) refuse(entry.name, "is a symbolic link");
    if (kind != 0 && kind != S_IFREG && kind != S_IFDIR) refuse(entry.name, "is neither file nor folder");
  }

  void check_size(const Entry& entry, std::uint64_t packed, std::uint64_t& total) const {
    constexpr std::uint64_t kSmall = std::uint64_t{16} << 20;
    if (entry.size > limits_.total_bytes - total)
      refuse(entry.name, fmt::format("takes the unpacked size over the limit of {} bytes", limits_.total_bytes));
    total += entry.size;
    if (entry.size > kSmall && static_cast<double>(entry.size) > limits_.ratio * static_cast<double>(packed))
      refuse(entry.name, fmt::format("unpacks {} bytes to {}, more than {} times", packed, entry.size, limits_.ratio));
  }

  static void make_folder(const fs::path& folder) {
    std::error_code error;
    fs::create_directories(folder, error);
    if (error) throw Error(fmt::format("{}: the folder cannot be made: {}", folder.string(), error.message()));
  }

  void write_entry(const Entry& entry, const fs::path& target) {
    const auto damaged = [&](std::string_view text) {
      throw Error(fmt::format("{}: the entry \"{}\" cannot be read: {}; was the file copied completely?",
                              path_.string(), entry.name, text));
    };
    const ArchiveFile file(zip_fopen_index(archive_.get(), entry.index, 0));
    if (!file) damaged(zip_strerror(archive_.get()));
    std::ofstream out(target, std::ios::binary | std::ios::trunc);
    std::array<char, 65536> buffer;  // NOLINT(cppcoreguidelines-pro-type-member-init): filled by zip_fread
    std::uint64_t written = 0;
    for (;;) {
      const zip_int64_t size = zip_fread(file.get(), buffer.data(), buffer.size());
      if (size < 0) damaged(zip_file_strerror(file.get()));
      if (size == 0) break;
      written += static_cast<std::uint64_t>(size);
      if (written > entry.size) damaged(fmt::format("it holds more than the {} bytes that it declares", entry.size));
      out.write(buffer.data(), size);
    }
    if (written != entry.size) damaged(fmt::format("{} of {} bytes are there", written, entry.size));
    out.close();
    if (!out) throw Error(fmt::format("{}: cannot be written; check permissions and free space", target.string()));
  }

  fs::path path_;
  UnpackLimits limits_;
  Archive archive_;
  std::vector<Entry> entries_;
};

}  // namespace

void unpack(const fs::path& archive, const fs::path& folder, const UnpackLimits& limits) {
  Unpacker(archive, limits).write_to(folder);
}

void pack(const fs::path& archive, std::vector<PackedFile> files) {
  std::ranges::sort(files, {}, &PackedFile::entry);
  const auto twice = std::ranges::adjacent_find(files, {}, &PackedFile::entry);
  if (twice != files.end())
    throw Error(fmt::format("{}: both {} and {} are to be the entry {}", archive.string(), twice->source.string(),
                            std::next(twice)->source.string(), twice->entry));
  Archive zip = open_archive(archive, ZIP_CREATE | ZIP_TRUNCATE, "the archive cannot be written");
  for (const PackedFile& file : files) {
    const auto fail = [&]() {
      throw Error(fmt::format("{}: {} cannot be added as {}: {}", archive.string(), file.source.string(), file.entry,
                              zip_strerror(zip.get())));
    };
    if (!fs::is_regular_file(file.source))
      throw Error(fmt::format("{}: {} is not there or no file", archive.string(), file.source.string()));
    zip_source_t* source = zip_source_file(zip.get(), file.source.c_str(), 0, -1);
    if (source == nullptr) fail();
    const zip_int64_t added = zip_file_add(zip.get(), file.entry.c_str(), source, ZIP_FL_ENC_UTF_8);
    if (added < 0) {
      zip_source_free(source);
      fail();
    }
    const auto index = static_cast<zip_uint64_t>(added);
    // The same files give the same archive: 1 January 1980, the first day that zip knows, and plain permissions.
    constexpr zip_uint16_t kDosTime = 0;
    constexpr zip_uint16_t kDosDate = (1U << 5) | 1U;
    constexpr zip_uint32_t kMode = (S_IFREG | 0644U);
    if (zip_file_set_dostime(zip.get(), index, kDosTime, kDosDate, 0) != 0) fail();
    if (zip_file_set_external_attributes(zip.get(), index, 0, ZIP_OPSYS_UNIX, kMode << 16) != 0) fail();
    if (zip_set_file_compression(zip.get(), index, ZIP_CM_DEFLATE, 9) != 0) fail();
  }
  if (zip_close(zip.get()) != 0)
    throw Error(fmt::format("{}: cannot be written: {}", archive.string(), zip_strerror(zip.get())));
  (void)zip.release();  // closed
}

}  // namespace mebots::modeldesc
