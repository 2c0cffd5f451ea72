// SPDX-License-Identifier: Apache-2.0
#include "new_fmu.hpp"

#include "mebots/error.hpp"

#include <fmt/format.h>

#include <fstream>
#include <iterator>

namespace mebots::new_fmu {
namespace {

namespace fs = std::filesystem;
using modeldesc::Field;

std::string limits(const Field& field) {
  if (field.min && field.max) return fmt::format("{} to {}", *field.min, *field.max);
  if (field.min) return fmt::format("at least {}", *field.min);
  return field.max ? fmt::format("at most {}", *field.max) : "";
}

std::string read(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

void write(const fs::path& file, const std::string& text) {
  std::error_code failure;
  fs::create_directories(file.parent_path(), failure);
  if (failure)
    throw Error(ErrorCode::file_unwritable,
                fmt::format("{}: the folder cannot be created: {}", file.parent_path().string(), failure.message()));
  std::ofstream stream(file, std::ios::binary);
  stream << text;
  stream.close();
  if (!stream)
    throw Error(ErrorCode::file_unwritable,
                fmt::format("{}: cannot be written; check permissions and free space", file.string()));
}

}  // namespace

std::string readme(const Plan& plan) {
  const auto& d = *plan.description;
  std::string table;
  for (const Field& field : d.fields)
    table += fmt::format("| `{}` | {} | {} | {} | {} |\n", field.name, to_string(field.causality),
                         field.unit.empty() ? "" : fmt::format("{}", field.unit), limits(field), field.text);
  return fmt::format(
      R"(# {name}

{text}.

    cmake -S . -B build -DCMAKE_BUILD_TYPE=Release && cmake --build build && ctest --test-dir build
    mebots check build/fmus/{name}.fmu
    mebots test test/{name}.mebots-test.json

## Equations

Every Real output y follows the sum u of the Real inputs of its unit with one time constant T ({constant}):

    T dy/dt = u - y,  so for inputs held over h:  y(t + h) = u + (y(t) - u) exp(-h / T)

## Variables

`description.json` declares them; all else follows from it.

| name | causality | unit | limits | |
|---|---|---|---|---|
{table}
## Files

| file | what |
|---|---|
| `description.json` | the variables |
| `src/model.hpp`, `src/model.cpp` | the model, plain C++ |
| `src/fmu.cpp` | binds the model to FMI |
| `test/model_test.cpp` | its tests |
| `test/{name}.mebots-test.json` | tests of the FMU without C++, for `mebots test` and pytest |

To build outside of the MEbots tree, install MEbots (`cmake --install`) and add `-DCMAKE_PREFIX_PATH=<where>`.
)",
      fmt::arg("name", d.name), fmt::arg("text", d.text), fmt::arg("table", table),
      fmt::arg("constant", plan.time_constant == nullptr ? "1 s" : "`" + plan.time_constant->name + "`"));
}

std::string cmake_lists(const Plan& plan) {
  constexpr std::string_view kNote = "# One archive for each version of FMI; the second one's name ends in _fmi3.\n";
  // if the description states FMI versions, CMake reads them
  const bool chosen = !plan.description->fmi.empty();
  return fmt::format(R"(# SPDX-License-Identifier: Apache-2.0
# Builds alone, against an installed MEbots, and inside its tree by add_subdirectory().
cmake_minimum_required(VERSION 3.25)
if(NOT COMMAND mebots_add_fmu)
  project({name} LANGUAGES CXX)
  find_package(mebots REQUIRED)
  enable_testing()
endif()

{note}mebots_add_fmu({name} MODEL_SOURCES src/model.cpp{versions})

find_package(GTest)
if(GTest_FOUND)
  include(GoogleTest)
  add_executable({name}_test test/model_test.cpp)
  mebots_target({name}_test)
  target_link_libraries({name}_test PRIVATE {name}_model GTest::gtest_main)
  gtest_discover_tests({name}_test)
endif()
)",
                     fmt::arg("name", plan.description->name), fmt::arg("note", chosen ? "" : kNote),
                     fmt::arg("versions", chosen ? "" : " FMI 2 3"));
}

fs::path new_fmu(const fs::path& description_file, fs::path folder) {
  const auto description = modeldesc::read_description(description_file);
  if (folder.empty()) folder = description.name;
  std::error_code error;
  if (fs::exists(folder, error))
    throw Error(
        ErrorCode::file_unwritable,
        fmt::format("{}: this folder exists and is not overwritten; choose another one with --out", folder.string()));
  const Plan plan = make_plan(description);
  Files files = {{"description.json", read(description_file)},
                 {"CMakeLists.txt", cmake_lists(plan)},
                 {"README.md", readme(plan)},
                 {"src/model.hpp", model_header(plan)},
                 {"src/model.cpp", model_source(plan)},
                 {"src/fmu.cpp", binding_source(plan)},
                 {"test/model_test.cpp", test_source(plan)}};
  for (auto& file : case_files(plan)) files.push_back(std::move(file));
  for (const auto& [name, text] : files) write(folder / name, text);
  return folder;
}

}  // namespace mebots::new_fmu
