// SPDX-License-Identifier: Apache-2.0
#include "mebots/modeldesc/platform.hpp"
#include "mebots/error.hpp"
#include "mebots/modeldesc/archive.hpp"
#include "mebots/modeldesc/merge_fmus.hpp"
#include "mebots/modeldesc/pe_library.hpp"
#include "mebots/modeldesc/system_libraries.hpp"
#include "pack_fmu.hpp"
#include "support/windows_dll.hpp"

#include <elf.h>
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>

namespace mebots::modeldesc {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ContainsRegex;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::SizeIs;

class PlatformTest : public testing::Test {
 protected:
  fs::path file(const std::string& name, const std::string& bytes) {
    const auto path = folder_.path() / name;
    fs::create_directories(path.parent_path());
    std::ofstream(path, std::ios::binary) << bytes;
    return path;
  }

  static std::string bytes_of(const fs::path& path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  }

  /// Returns the bytes of the test FMU's library, with this ELF machine in the header.
  std::string library_for(std::uint16_t machine) {
    auto bytes = bytes_of(MEBOTS_BINARY_DIR "/fmu_binaries/lag.so");
    bytes[offsetof(Elf64_Ehdr, e_machine)] = static_cast<char>(machine);
    return bytes;
  }

  /// Packs the test FMU with this library. Returns the path of the archive.
  fs::path packed(const std::string& name, const fs::path& library) {
    FmuParts parts;
    parts.description = MEBOTS_BINARY_DIR "/generated/lag/modelDescription.xml";
    parts.documentation = MEBOTS_BINARY_DIR "/generated/lag/index.html";
    parts.binary = library;
    const auto archive = folder_.path() / name;
    pack_fmu(archive, parts);
    return archive;
  }

  static std::string error_of(const std::function<void()>& action) {
    try {
      action();
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  }

  TemporaryFolder folder_{"mebots-platform-test"};
};

TEST_F(PlatformTest, NamesTheFoldersOfFmi2AndFmi3ByTheHeader) {
  const auto& arm = platform_of(file("arm.so", library_for(EM_AARCH64)));
  EXPECT_EQ(arm.folder(false), "aarch64-linux");
  EXPECT_EQ(arm.folder(true), "aarch64-linux");
  const auto& linux64 = platform_of(file("x86.so", library_for(EM_X86_64)));
  EXPECT_EQ(linux64.folder(false), "linux64");
  EXPECT_EQ(linux64.folder(true), "x86_64-linux");
  const auto& windows = platform_of(file("x86.dll", test::windows_dll({}, {})));
  EXPECT_EQ(windows.folder(false), "win64");
  EXPECT_EQ(windows.folder(true), "x86_64-windows");
  EXPECT_TRUE(find_platforms(file("text.so", "text")).empty());
  EXPECT_THAT(error_of([&] { platform_of(folder_.path() / "text.so"); }), HasSubstr("is not a shared library"));
}

TEST_F(PlatformTest, PacksEachBinaryIntoTheFolderOfItsPlatform) {
  unpack(packed("arm.fmu", file("arm.so", library_for(EM_AARCH64))), folder_.path() / "arm");
  EXPECT_TRUE(fs::exists(folder_.path() / "arm/binaries/aarch64-linux/lag.so"));
  unpack(packed("win.fmu", file("win.dll", test::windows_dll({"KERNEL32.dll", "msvcrt.dll"}, {}))),
         folder_.path() / "win");
  EXPECT_TRUE(fs::exists(folder_.path() / "win/binaries/win64/lag.dll"));
  const auto needy = file("needy.dll", test::windows_dll({"libgcc_s_seh-1.dll"}, {}));
  EXPECT_THAT(error_of([&] { packed("needy.fmu", needy); }),
              HasSubstr("needs libgcc_s_seh-1.dll, which is not packed into the FMU"));
}

TEST_F(PlatformTest, ReadsLibrariesOfMacOs) {
  const std::string thin_32("\xce\xfa\xed\xfe\x07\0\0\0", 8);
  EXPECT_THAT(find_platforms(file("x86.dylib", thin_32)),
              ElementsAre(testing::Field(&Platform::fmi2_folder, "darwin32")));
  // Builds a universal library of macOS: the number of its platforms, and 20 bytes per platform. The reader uses only
  // the processor type in these bytes.
  const auto row = [](char processor) { return std::string("\1\0\0", 3) + processor + std::string(16, '\0'); };
  const auto universal = std::string("\xca\xfe\xba\xbe\0\0\0\2", 8) + row('\7') + row('\14');
  EXPECT_THAT(find_platforms(file("both.dylib", universal)),
              ElementsAre(testing::Field(&Platform::fmi3_folder, "x86_64-darwin"),
                          testing::Field(&Platform::fmi3_folder, "aarch64-darwin")));
  EXPECT_THAT(find_platforms(file("cut.dylib", universal.substr(0, 40))), SizeIs(1));
}

TEST_F(PlatformTest, FindsALibraryForThisMachineInFolderLinux64Too) {
  const auto own = file("fmu/binaries/linux64/lag.so", library_for(this_platform().machine)).parent_path();
  EXPECT_EQ(binaries_folder(folder_.path() / "fmu", false, "lag.so"), own);
}

TEST_F(PlatformTest, ReadsImportsAndExportsOfADll) {
  const auto library = read_pe_library(file("a.dll", test::windows_dll({"KERNEL32.dll", "other.dll"}, {"fmi2DoStep"})));
  EXPECT_THAT(library.needed, ElementsAre("KERNEL32.dll", "other.dll"));
  EXPECT_THAT(library.exports, ElementsAre("fmi2DoStep"));
  EXPECT_TRUE(is_part_of_windows("KERNEL32.dll"));
  EXPECT_TRUE(is_part_of_windows("api-ms-win-crt-runtime-l1-1-0.dll"));
  EXPECT_FALSE(is_part_of_windows("VCRUNTIME140.dll"));
}

TEST_F(PlatformTest, ReportsADllThatIsCutShortAtAnyByte) {
  const auto whole = test::windows_dll({"KERNEL32.dll"}, {"fmi2DoStep"});
  for (std::size_t size = 0; size < whole.size(); ++size)
    EXPECT_THROW(read_pe_library(file("cut.dll", whole.substr(0, size))), Error) << size;
}

TEST_F(PlatformTest, MergesBuildsIntoOneArchive) {
  const auto first = packed("lag.fmu", MEBOTS_BINARY_DIR "/fmu_binaries/lag.so");
  const auto windows = packed("windows.fmu", file("win.dll", test::windows_dll({}, {})));
  const auto arm = packed("arm.fmu", file("arm.so", library_for(EM_AARCH64)));
  const auto merged = folder_.path() / "merged.fmu";
  merge_fmus({first, windows, arm}, merged);
  unpack(merged, folder_.path() / "merged");
  const auto content = folder_.path() / "merged";
  EXPECT_EQ(bytes_of(content / "binaries/linux64/lag.so"), bytes_of(MEBOTS_BINARY_DIR "/fmu_binaries/lag.so"));
  EXPECT_EQ(bytes_of(content / "binaries/win64/lag.dll"), test::windows_dll({}, {}));
  EXPECT_EQ(bytes_of(content / "binaries/aarch64-linux/lag.so"), library_for(EM_AARCH64));
  EXPECT_TRUE(fs::exists(content / "documentation/sbom.spdx.json"));
  EXPECT_TRUE(fs::exists(content / "documentation/sbom.win64.spdx.json"));
  const auto expected = bytes_of(merged);
  merge_fmus({first, windows, arm}, first);  // the target is also an input
  EXPECT_EQ(bytes_of(first), expected);
}

TEST_F(PlatformTest, RefusesBuildsThatDoNotFitTogether) {
  const auto first = packed("lag.fmu", MEBOTS_BINARY_DIR "/fmu_binaries/lag.so");
  const auto out = folder_.path() / "out.fmu";
  EXPECT_THAT(error_of([&] { merge_fmus({first, first}, out); }), HasSubstr("have binaries for linux64"));
  const auto other = folder_.path() / "other.fmu";
  pack(other, {{"modelDescription.xml", file("other.xml", "<fmiModelDescription/>")},
               {"binaries/win64/lag.dll", file("other.dll", test::windows_dll({}, {}))}});
  EXPECT_THAT(error_of([&] {
                merge_fmus({first, other}, out);
              }),
              AllOf(HasSubstr("modelDescription.xml differs in"), HasSubstr("other.fmu")));
  const auto longer = folder_.path() / "longer.fmu";
  pack(longer, {{"modelDescription.xml", MEBOTS_BINARY_DIR "/generated/lag/modelDescription.xml"},
                {"resources/cell.json", file("cell.json", "{}")},
                {"binaries/win64/lag.dll", file("longer.dll", test::windows_dll({}, {}))}});
  EXPECT_THAT(error_of([&] {
                merge_fmus({first, longer}, out);
              }),
              ContainsRegex("resources/cell.json is in .*longer.fmu, but not in .*lag.fmu"));
  const auto empty = folder_.path() / "empty.fmu";
  pack(empty, {{"modelDescription.xml", file("empty.xml", "<fmiModelDescription/>")}});
  EXPECT_THAT(error_of([&] { merge_fmus({first, empty}, out); }), HasSubstr("empty.fmu: it has no binaries"));
  EXPECT_FALSE(fs::exists(out));
}

}  // namespace
}  // namespace mebots::modeldesc
