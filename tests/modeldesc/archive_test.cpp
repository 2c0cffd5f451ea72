// SPDX-License-Identifier: Apache-2.0
#include "mebots/error.hpp"
#include "mebots/modeldesc/archive_reader.hpp"
#include "pack_fmu.hpp"

#include <gmock/gmock.h>
#include <sys/stat.h>
#include <zip.h>

#include <filesystem>
#include <fstream>
#include <iterator>

namespace mebots::modeldesc {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

std::string read_file(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

void write_file(const fs::path& file, const std::string& text) {
  fs::create_directories(file.parent_path());
  std::ofstream(file, std::ios::binary) << text;
}

class ArchiveTest : public testing::Test {
 protected:
  /// Returns an archive with an ordinary entry, followed by this entry. Uses libzip directly, which accepts any name.
  fs::path with_entry(const std::string& name, const std::string& content, mode_t kind = S_IFREG) {
    const fs::path file = folder_.path() / "evil.zip";
    fs::remove(file);
    int code = 0;
    zip_t* zip = zip_open(file.c_str(), ZIP_CREATE, &code);
    const auto add = [&](const std::string& entry, const std::string& bytes) {
      zip_source_t* source = zip_source_buffer(zip, bytes.data(), bytes.size(), 0);
      return static_cast<zip_uint64_t>(zip_file_add(zip, entry.c_str(), source, ZIP_FL_ENC_UTF_8));
    };
    const std::string honest = "honest";
    add("honest.txt", honest);
    const auto index = add(name, content);
    zip_file_set_external_attributes(zip, index, 0, ZIP_OPSYS_UNIX, (kind | 0777U) << 16);
    EXPECT_EQ(zip_close(zip), 0);
    return file;
  }

  void expect_refused(const fs::path& archive, const char* text, const UnpackLimits& limits = {}) {
    const fs::path target = folder_.path() / "target";
    fs::remove_all(target);
    try {
      unpack(archive, target, limits);
      ADD_FAILURE() << "was unpacked, expected: " << text;
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), HasSubstr(text));
      EXPECT_THAT(error.what(), HasSubstr(archive.filename().string()));
    }
    EXPECT_FALSE(fs::exists(target)) << "something was written before all entries were checked";
  }

  TemporaryFolder folder_{"archive"};
};

TEST_F(ArchiveTest, UnpacksTheSameBytes) {
  std::string large(3 << 20, '\0');
  for (std::size_t i = 0; i < large.size(); ++i) large[i] = static_cast<char>((i * i) >> 7);
  write_file(folder_.path() / "a", "text");
  write_file(folder_.path() / "b", large);
  write_file(folder_.path() / "c", "");
  const fs::path archive = folder_.path() / "x.fmu";
  pack(archive, {{"z/gr\xC3\xBC\xC3\x9F"
                  "e.txt",
                  folder_.path() / "a"},
                 {"b", folder_.path() / "b"},
                 {"deep/er/c", folder_.path() / "c"}});
  const fs::path out = folder_.path() / "out";
  unpack(archive, out);
  EXPECT_EQ(read_file(out / "z" /
                      "gr\xC3\xBC\xC3\x9F"
                      "e.txt"),
            "text");
  EXPECT_EQ(read_file(out / "b"), large);
  EXPECT_TRUE(fs::exists(out / "deep/er/c"));
}

TEST_F(ArchiveTest, TheSameFilesGiveTheSameBytesWhateverTheirDatesAndOrder) {
  write_file(folder_.path() / "a", "first");
  write_file(folder_.path() / "b", "second");
  const PackedFile a{"a", folder_.path() / "a"};
  const PackedFile b{"b", folder_.path() / "b"};
  pack(folder_.path() / "1.zip", {a, b});
  fs::last_write_time(folder_.path() / "a", fs::file_time_type::clock::now() - std::chrono::hours(24 * 400));
  fs::permissions(folder_.path() / "b", fs::perms::owner_all);
  pack(folder_.path() / "2.zip", {b, a});
  EXPECT_EQ(read_file(folder_.path() / "1.zip"), read_file(folder_.path() / "2.zip"));
}

TEST_F(ArchiveTest, PackReportsMissingAndDuplicateFiles) {
  write_file(folder_.path() / "a", "x");
  const fs::path archive = folder_.path() / "x.zip";
  EXPECT_THROW(pack(archive, {{"a", folder_.path() / "missing"}}), Error);
  EXPECT_THROW(pack(archive, {{"a", folder_.path() / "a"}, {"a", folder_.path() / "a"}}), Error);
  EXPECT_FALSE(fs::exists(archive));
  EXPECT_THROW(pack("/proc/nowhere/x.zip", {{"a", folder_.path() / "a"}}), Error);
}

TEST_F(ArchiveTest, EntriesThatWouldLeaveTheFolderAreRefusedByName) {
  expect_refused(with_entry("../evil.txt", "x"), "the entry \"../evil.txt\" would leave the target folder");
  expect_refused(with_entry("a/../../evil.txt", "x"), "would leave the target folder");
  expect_refused(with_entry("a/..", "x"), "would leave the target folder");
  expect_refused(with_entry("/etc/evil", "x"), "the entry \"/etc/evil\" is an absolute path");
  expect_refused(with_entry("C:/evil", "x"), "drive letter");
  expect_refused(with_entry("..\\evil", "x"), "would leave the target folder");
  expect_refused(with_entry("a\\..\\..\\evil", "x"), "would leave the target folder");
  expect_refused(with_entry("\\evil", "x"), "is an absolute path");
  expect_refused(with_entry(".\\honest.txt", "x"), "occurs twice");
  expect_refused(with_entry("link", "/etc/passwd", S_IFLNK), "the entry \"link\" is a symbolic link");
  expect_refused(with_entry("pipe", "", S_IFIFO), "neither a file nor a folder");
  expect_refused(with_entry("./honest.txt", "x"), "occurs twice");
}

TEST(EntryName, LosesEmptyPartsAndDots) {
  EXPECT_EQ(normal_entry_name("a/b"), "a/b");
  EXPECT_EQ(normal_entry_name(".//a/./b//"), "a/b/");
  EXPECT_EQ(normal_entry_name("..a/b.."), "..a/b..");
  EXPECT_EQ(normal_entry_name("a/.."), std::nullopt);
  EXPECT_EQ(normal_entry_name("../a"), std::nullopt);
}

TEST_F(ArchiveTest, TwoSpellingsOfOneNameAreRefused) {
  expect_refused(with_entry("./honest.txt", "x"), "occurs twice");
}

TEST_F(ArchiveTest, AnEntryThatIsRepeatedWithTheSameBytesIsIgnoredWithANotice) {
  const fs::path out = folder_.path() / "repeated";
  const auto notices = unpack(with_entry("./honest.txt", "honest"), out);
  EXPECT_EQ(read_file(out / "honest.txt"), "honest");
  ASSERT_EQ(notices.size(), 1U);
  EXPECT_NE(notices[0].find("1 of its entries repeat another entry with the same bytes"), std::string::npos)
      << notices[0];
}

TEST_F(ArchiveTest, NamesThatOnlyLookDangerousPass) {
  for (const char* name : {"a..b", "..a/b", "...", "a/.hidden"}) {
    const fs::path out = folder_.path() / "fine";
    fs::remove_all(out);
    unpack(with_entry(name, "x"), out);
    EXPECT_EQ(read_file(out / name), "x") << name;
  }
}

TEST_F(ArchiveTest, BackslashesAreReadAsSlashesWithANotice) {
  const fs::path out = folder_.path() / "windows";
  const auto notices = unpack(with_entry("resources\\deep\\a.txt", "x"), out);
  EXPECT_EQ(read_file(out / "resources/deep/a.txt"), "x");
  ASSERT_EQ(notices.size(), 1U);
  EXPECT_NE(notices[0].find("backslashes in the names of its entries (1 of them)"), std::string::npos) << notices[0];
  EXPECT_TRUE(unpack(with_entry("resources/a.txt", "x"), folder_.path() / "linux").empty());
}

TEST_F(ArchiveTest, DecompressionBombsAreRefused) {
  const std::string zeros(20 << 20, '\0');
  expect_refused(with_entry("bomb", zeros), "more than 1000 times");
  expect_refused(with_entry("big", zeros), "above the limit of 1000000 bytes", {.total_bytes = 1'000'000});
  expect_refused(with_entry("one", "x"), "2 entries are more than the limit of 1", {.entries = 1});
}

TEST_F(ArchiveTest, BrokenArchivesGiveAClearError) {
  expect_refused(folder_.path() / "missing.fmu", "there is no such file");
  fs::create_directories(folder_.path() / "folder.fmu");
  expect_refused(folder_.path() / "folder.fmu", "this is a folder");
  write_file(folder_.path() / "text.fmu", "this is not an archive");
  expect_refused(folder_.path() / "text.fmu", "was it copied completely?");
  write_file(folder_.path() / "empty.fmu", "");
  expect_refused(folder_.path() / "empty.fmu", "was it copied completely?");
  const std::string whole = read_file(with_entry("a", std::string(5000, 'y')));
  for (const std::size_t size : {whole.size() - 1, whole.size() / 2, std::size_t{30}}) {
    write_file(folder_.path() / "cut.fmu", whole.substr(0, size));
    expect_refused(folder_.path() / "cut.fmu", "was it copied completely?");
  }
}

TEST_F(ArchiveTest, CompressionThatCannotBeReadIsNamedWithTheWayOut) {
  const auto file = with_entry("a", std::string(5000, 'y'));
  for (const auto& [method, name] :
       {std::pair<char, const char*>{14, "LZMA"}, {95, "XZ"}, {98, "PPMd"}, {77, "method 77"}}) {
    auto bytes = read_file(file);
    for (const auto& [record, offset] : {std::pair<const char*, std::size_t>{"PK\3\4", 8}, {"PK\1\2", 10}}) {
      bytes[bytes.rfind(record) + offset] = method;  // the entry "a" has the last record of each kind
    }
    write_file(folder_.path() / "other.fmu", bytes);
    expect_refused(folder_.path() / "other.fmu", "the entry \"a\" is compressed with ");
    expect_refused(folder_.path() / "other.fmu", name);
    expect_refused(folder_.path() / "other.fmu", "pack the archive again with Deflate");
  }
}

TEST_F(ArchiveTest, ArchivesOfOtherKindsAreNamed) {
  for (const auto& [start, kind] : {std::pair<std::string, const char*>{"7z\xbc\xaf\x27\x1c", "a 7-Zip archive"},
                                    {std::string("\xfd\x37zXZ\0", 6), "an xz archive"},
                                    {"\x1f\x8b", "a gzip archive"},
                                    {std::string("\x5d\0\0", 3), "an LZMA archive"}}) {
    write_file(folder_.path() / "other.fmu", start + "content");
    expect_refused(folder_.path() / "other.fmu", kind);
    expect_refused(folder_.path() / "other.fmu", "are zip archives; unpack it and pack its content with `zip -r");
  }
}

TEST_F(ArchiveTest, ReportsTheReasonAndTheRemedyForAMissingFile) {
  const auto why = [&](const std::vector<std::string>& files) {
    const auto folder = folder_.path() / "unpacked";
    fs::remove_all(folder);
    fs::create_directories(folder);
    for (const auto& file : files) write_file(folder / file, "x");
    return why_missing(folder, "modelDescription.xml");
  };
  EXPECT_EQ(why({"readme.txt"}), "it contains no modelDescription.xml");
  EXPECT_THAT(why({"pump/modelDescription.xml", "pump/resources/deep/modelDescription.xml"}),
              HasSubstr("must be at the root of the archive, but is \"pump/modelDescription.xml\"; pack the "
                        "content of the folder \"pump\", not the folder"));
  EXPECT_THAT(why({"ModelDescription.XML", "pump/modelDescription.xml"}),
              HasSubstr("its \"ModelDescription.XML\" must be called \"modelDescription.xml\""));
}

TEST_F(ArchiveTest, DamagedContentIsNoticed) {
  std::string content(5000, ' ');
  for (std::size_t i = 0; i < content.size(); ++i) content[i] = static_cast<char>('a' + i * i % 23);
  std::string bytes = read_file(with_entry("a", content));
  // This byte is in the compressed content of the second entry. The archive's directory is at the end of the file.
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 0x55);
  write_file(folder_.path() / "damaged.fmu", bytes);
  try {
    unpack(folder_.path() / "damaged.fmu", folder_.path() / "out");
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("the entry \"a\" cannot be read"));
  }
}

TEST_F(ArchiveTest, TemporaryFoldersAreUniqueAndGoWithTheirOwner) {
  fs::path path;
  {
    TemporaryFolder one("same", folder_.path());
    TemporaryFolder two("same", folder_.path());
    EXPECT_NE(one.path(), two.path());
    path = one.path();
    write_file(path / "deep/file", "x");
    const TemporaryFolder moved = std::move(one);
    EXPECT_EQ(moved.path(), path);
    EXPECT_TRUE(fs::exists(path));
  }
  EXPECT_FALSE(fs::exists(path));
  EXPECT_THROW(TemporaryFolder("x", folder_.path() / "missing"), Error);
}

TEST_F(ArchiveTest, AnFmuWhoseLibrariesDoNotTravelAlongIsNotPacked) {
  FmuParts parts;
  parts.description = MEBOTS_BINARY_DIR "/generated/lag/modelDescription.xml";
  parts.documentation = MEBOTS_BINARY_DIR "/generated/lag/index.html";
  parts.binary = MEBOTS_BINARY_DIR "/fmu_binaries/lag.so";
  parts.libraries = {LIBZIP_LIBRARY};  // needs a compression library, which is not passed
  try {
    pack_fmu(folder_.path() / "x.fmu", parts);
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("which is not packed into the FMU; add it with --library"));
  }
  parts.libraries.clear();
  pack_fmu(folder_.path() / "x.fmu", parts);
  unpack(folder_.path() / "x.fmu", folder_.path() / "x");
  EXPECT_EQ(read_file(folder_.path() / "x/binaries/linux64/lag.so"), read_file(parts.binary));
}

}  // namespace
}  // namespace mebots::modeldesc
