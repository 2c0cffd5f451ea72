// SPDX-License-Identifier: Apache-2.0
#include "mebots/modeldesc/merge_fmus.hpp"

#include "mebots/error.hpp"
#include "mebots/file_kind.hpp"
#include "mebots/modeldesc/archive.hpp"
#include "mebots/text_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace mebots::modeldesc {
namespace {

namespace fs = std::filesystem;

constexpr const char* kDescription = "modelDescription.xml";
constexpr const char* kBill = "documentation/sbom.spdx.json";

/// An unpacked archive: one build of the FMU.
class Build {
 public:
  explicit Build(const fs::path& archive) : archive_(archive), folder_("mebots-merge") {
    unpack(archive, folder_.path());
    if (!is_file(folder_.path() / kDescription))
      throw Error(ErrorCode::fmu_inconsistent, fmt::format("{}: this is not an FMU: {}", archive.string(),
                                                           why_missing(folder_.path(), kDescription)));
    for (const auto& entry : fs::recursive_directory_iterator(folder_.path()))
      if (entry.is_regular_file())
        files_.emplace(entry.path().lexically_relative(folder_.path()).generic_string(), entry.path());
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(folder_.path() / "binaries", ignored))
      platforms_.insert(entry.path().filename().string());
    if (platforms_.empty())
      throw Error(ErrorCode::fmu_inconsistent, fmt::format("{}: it has no binaries", archive.string()));
  }

  const fs::path& archive() const { return archive_; }
  const std::map<std::string, fs::path>& files() const { return files_; }
  const std::set<std::string>& platforms() const { return platforms_; }

 private:
  fs::path archive_;
  TemporaryFolder folder_;
  std::map<std::string, fs::path> files_;  // maps each entry of the archive to its unpacked file
  std::set<std::string> platforms_;
};

class Merge {
 public:
  void add(const Build& build) {
    for (const auto& platform : build.platforms()) {
      const auto [known, is_new] = platforms_.emplace(platform, build.archive());
      if (is_new) continue;
      throw Error(ErrorCode::duplicate_name, fmt::format("both {} and {} have binaries for {}; leave one of them out",
                                                         known->second.string(), build.archive().string(), platform));
    }
    refuse_other_entries(build);
    for (const auto& [entry, file] : build.files()) {
      const auto [known, is_new] = files_.emplace(entry_of(entry, build), Source{file, build.archive()});
      if (is_new || entry.starts_with("documentation/") || text_of(known->second.file) == text_of(file)) continue;
      throw Error(ErrorCode::fmu_inconsistent,
                  fmt::format("{} differs in {} and {}: they are not builds of the same FMU; build both from the same "
                              "sources",
                              entry, known->second.archive.string(), build.archive().string()));
    }
    is_first_ = false;
  }

  std::vector<PackedFile> files() const {
    std::vector<PackedFile> packed;
    for (const auto& [entry, source] : files_) packed.push_back({entry, source.file});
    return packed;
  }

 private:
  struct Source {
    fs::path file;
    fs::path archive;
  };

  /// The entries that all builds must have in common, and the first archive.
  struct Shared {
    std::set<std::string> entries;
    fs::path archive;
  };

  /// Compares the entries outside of binaries/ and documentation/ with the entries of the first build. Throws Error if
  /// they differ. For the first build, stores the entries.
  void refuse_other_entries(const Build& build) {
    std::set<std::string> entries;
    for (const auto& [entry, file] : build.files()) {
      if (!entry.starts_with("binaries/") && !entry.starts_with("documentation/")) entries.insert(entry);
    }
    if (is_first_) {
      shared_ = {std::move(entries), build.archive()};
      return;
    }
    std::vector<std::string> different;
    std::ranges::set_symmetric_difference(entries, shared_.entries, std::back_inserter(different));
    if (different.empty()) return;
    const auto& [with, without] = entries.contains(different.front()) ? std::pair{build.archive(), shared_.archive}
                                                                      : std::pair{shared_.archive, build.archive()};
    throw Error(ErrorCode::fmu_inconsistent,
                fmt::format("{} is in {}, but not in {}: they are not builds of the same FMU; build both from the same "
                            "sources",
                            different.front(), with.string(), without.string()));
  }

  std::string entry_of(const std::string& entry, const Build& build) const {
    if (is_first_ || entry != kBill) return entry;
    return fmt::format("documentation/sbom.{}.spdx.json", fmt::join(build.platforms(), "."));
  }

  bool is_first_ = true;
  Shared shared_;
  std::map<std::string, fs::path> platforms_;
  std::map<std::string, Source> files_;
};

}  // namespace

void merge_fmus(const std::vector<fs::path>& archives, const fs::path& target) {
  std::vector<Build> builds;  // unpacked before the target is written, because the target may be one of the archives
  builds.reserve(archives.size());
  Merge merge;
  for (const auto& archive : archives) merge.add(builds.emplace_back(archive));
  pack(target, merge.files());
}

}  // namespace mebots::modeldesc
