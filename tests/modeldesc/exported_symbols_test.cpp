// SPDX-License-Identifier: Apache-2.0
#include "lag_fmu.hpp"
#include "mebots/modeldesc/elf_library.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <string>
#include <vector>

namespace mebots::test {
namespace {

TEST(Fmu, ExportsAllFunctionsOfCoSimulationAndNothingElse) {
  std::vector<std::string> expected;
  fmi2::for_each_function([&](const char* name, auto, fmi2::Need need) {
    if (need != fmi2::Need::to_integrate) expected.emplace_back(name);
  });
  EXPECT_THAT(modeldesc::read_elf_library(LagFmu::get().binary()).exports(),
              testing::UnorderedElementsAreArray(expected));
}

TEST(ElfLibrary, ListsWhatTheFmuTakesFromOthers) {
  const auto library = modeldesc::read_elf_library(LagFmu::get().binary());
  EXPECT_THAT(library.imports(), testing::Contains("memcpy"));
  EXPECT_THAT(library.imports(), testing::Not(testing::Contains(testing::StartsWith("fmi2"))));
  EXPECT_THAT(library.needed, testing::Contains("libc.so.6"));
}

TEST(ElfLibrary, MemoryHoldsWhatTheFileHolds) {
  const auto file = LagFmu::get().binary();
  const auto loaded = modeldesc::loaded_libraries(modeldesc::UniqueSymbols::skip);
  EXPECT_THAT(loaded, testing::Contains(testing::Field(&modeldesc::LoadedLibrary::file, file)));
  EXPECT_THAT(loaded, testing::Contains(testing::Field(&modeldesc::LoadedLibrary::soname, "libc.so.6")));
}

TEST(ElfLibrary, ReadsUniqueSymbolsFromFileAndFromMemory) {
  const auto loaded = modeldesc::loaded_libraries(modeldesc::UniqueSymbols::read);
  const auto runtime = std::ranges::find(loaded, "libstdc++.so.6", &modeldesc::LoadedLibrary::soname);
  ASSERT_NE(runtime, loaded.end());
  const auto in_file = modeldesc::read_elf_library(runtime->file);
  std::vector<std::string> from_file;
  for (const auto& symbol : in_file.symbols) {
    if (symbol.unique) from_file.push_back(symbol.name);
  }
  std::vector<std::string> from_memory;
  for (const auto& symbol : runtime->unique) from_memory.push_back(symbol.name);
  EXPECT_THAT(from_memory, testing::Contains("_ZNSt7collateIcE2idE"));
  EXPECT_EQ(from_memory, from_file);
}

TEST(ElfLibrary, FindsSymbolsThatTheLoaderLooksUp) {
  const auto library = modeldesc::read_elf_library(LagFmu::get().binary());
  const auto found = std::ranges::find(library.symbols, "memcpy", &modeldesc::ElfSymbol::name);
  ASSERT_NE(found, library.symbols.end());
  EXPECT_TRUE(found->bound);
  EXPECT_FALSE(found->defined);
}

}  // namespace
}  // namespace mebots::test
