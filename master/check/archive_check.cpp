// SPDX-License-Identifier: Apache-2.0
#include "checks.hpp"

#include "mebots/modeldesc/archive_reader.hpp"

#include <fmt/format.h>
#include <sys/stat.h>
#include <zip.h>

#include <algorithm>
#include <map>
#include <set>

namespace mebots::check {
namespace {

namespace fs = std::filesystem;

std::string folded(std::string_view name) {
  std::string lower(name);
  std::ranges::transform(lower, lower.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return lower;
}

/// True for root entries of an archive that FMI 2.0.4, section 2.3, defines, and for the common name `licenses`.
bool is_known_top(std::string_view top) {
  constexpr std::string_view kKnown[] = {
      "modelDescription.xml", "model.png", "documentation", "licenses", "sources", "binaries", "resources", "extra",
      "terminalsAndIcons"};
  return std::ranges::find(kKnown, top) != std::end(kKnown);
}

class ArchiveCheck {
 public:
  ArchiveCheck(zip_t& archive, Findings findings) : archive_(&archive), findings_(findings) {}

  void run() {
    const auto count = zip_get_num_entries(archive_, 0);
    if (count == 0) findings_.error("the archive is empty", "pack modelDescription.xml and binaries");
    for (zip_int64_t i = 0; i < count; ++i) check_entry(static_cast<zip_uint64_t>(i));
    if (!has_description_)
      findings_.error(
          "modelDescription.xml is not at the root of the archive",
          nested_description_.empty()
              ? "pack the files, not the folder that contains them"
              : fmt::format("it is there as \"{}\": pack the contents of that folder, not the folder itself",
                            nested_description_));
    if (!has_binaries_ && !has_sources_)
      findings_.error("there is neither a binary nor a source", "put the shared library into binaries/<platform>");
    if (total_ > modeldesc::UnpackLimits{}.total_bytes)
      findings_.error(fmt::format("the archive unpacks to {} bytes", total_),
                      "remove files that the FMU does not read");
  }

 private:
  void check_entry(zip_uint64_t index) {
    zip_stat_t stat;
    if (zip_stat_index(archive_, index, ZIP_FL_ENC_RAW, &stat) != 0 || stat.name == nullptr) {
      findings_.error(fmt::format("entry {} cannot be read: {}", index, zip_strerror(archive_)), "pack the FMU again");
      return;
    }
    const std::string name = stat.name;
    check_name(name);
    check_kind(index, name);
    check_storage(stat, name);
    total_ += stat.size;
    const bool folder = name.ends_with('/');
    if (name == "modelDescription.xml") has_description_ = true;
    if (name.ends_with("/modelDescription.xml")) nested_description_ = name;
    if (!folder && name.starts_with("binaries/")) has_binaries_ = true;
    if (!folder && name.starts_with("sources/")) has_sources_ = true;
  }

  void check_name(const std::string& name) {
    const auto normal = modeldesc::normal_entry_name(name);
    const bool climbs = !normal;
    const auto& path = normal ? *normal : name;
    if (name.empty()) findings_.error("an entry has no name", "pack the FMU again");
    if (name.find('\\') != std::string::npos)
      findings_.error(fmt::format("\"{}\" has a backslash; zip requires forward slashes", name),
                      "pack with a tool that writes forward slashes");
    if (name.starts_with('/') || (name.size() >= 2 && name[1] == ':'))
      findings_.error(fmt::format("\"{}\" is an absolute path", name), "pack relative paths");
    if (climbs)
      findings_.error(fmt::format("\"{}\" would leave the folder it is unpacked to", name), "pack without \"..\"");
    if (std::ranges::any_of(name, [](unsigned char c) { return c < 0x20 || c == 0x7f; }))
      findings_.error(fmt::format("entry {} has a control character in its name", names_.size()), "rename the file");
    if (!names_.insert(path).second) {
      findings_.error(fmt::format("\"{}\" occurs twice", name), "pack each file once");
    } else {
      const auto [other, fresh] = folded_.emplace(folded(path), name);
      if (!fresh)
        findings_.at(Level::pedantic)
            .warning(fmt::format("\"{}\" and \"{}\" differ only in capitals", other->second, name),
                     "rename one: on Windows and macOS they are the same file");
    }
    const auto top = name.substr(0, name.find('/'));
    if (!climbs && tops_.insert(top).second && !is_known_top(top) && !top.empty())
      findings_.at(Level::pedantic)
          .warning(fmt::format("\"{}\" at the root of the archive is not part of an FMU in FMI 2.0", top),
                   "move it to resources, documentation or extra");
  }

  void check_kind(zip_uint64_t index, const std::string& name) {
    zip_uint8_t system = 0;
    zip_uint32_t attributes = 0;
    if (zip_file_get_external_attributes(archive_, index, 0, &system, &attributes) != 0) return;
    if (system != ZIP_OPSYS_UNIX && system != ZIP_OPSYS_OS_X) return;
    const auto kind = static_cast<mode_t>(attributes >> 16) & S_IFMT;
    if (kind == S_IFLNK) findings_.error(fmt::format("\"{}\" is a symbolic link", name), "pack the file it points to");
    if (kind != 0 && kind != S_IFLNK && kind != S_IFREG && kind != S_IFDIR)
      findings_.error(fmt::format("\"{}\" is neither a file nor a folder", name), "remove it");
  }

  void check_storage(const zip_stat_t& stat, const std::string& name) {
    constexpr zip_uint64_t kSmall = zip_uint64_t{16} << 20;
    const double ratio = modeldesc::UnpackLimits{}.ratio;
    if ((stat.valid & ZIP_STAT_COMP_METHOD) != 0 && stat.comp_method != ZIP_CM_STORE &&
        stat.comp_method != ZIP_CM_DEFLATE)
      findings_.error(fmt::format("\"{}\" is packed with method {}; FMI 2.0 allows \"stored\" and \"deflate\"", name,
                                  stat.comp_method),
                      "pack with deflate");
    if ((stat.valid & ZIP_STAT_ENCRYPTION_METHOD) != 0 && stat.encryption_method != ZIP_EM_NONE)
      findings_.error(fmt::format("\"{}\" is encrypted", name), "pack without a password");
    if (stat.size > kSmall && static_cast<double>(stat.size) > ratio * static_cast<double>(stat.comp_size))
      findings_.error(fmt::format("\"{}\" unpacks from {} bytes to {}: tools may refuse it as a zip bomb", name,
                                  stat.comp_size, stat.size),
                      "generate the file when it is needed, instead of packing it");
  }

  zip_t* archive_;
  Findings findings_;
  std::set<std::string> names_;
  std::set<std::string> tops_;
  std::map<std::string, std::string> folded_;
  std::string nested_description_;
  bool has_description_ = false;
  bool has_binaries_ = false;
  bool has_sources_ = false;
  std::uint64_t total_ = 0;
};

}  // namespace

void check_archive(zip& archive, Findings findings) {
  ArchiveCheck(archive, findings).run();
}

void check_archive(const fs::path& archive, Findings findings) {
  check_archive(*modeldesc::open_zip(archive), findings);
}

}  // namespace mebots::check
