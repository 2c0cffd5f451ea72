// SPDX-License-Identifier: Apache-2.0
#include "record/sink/csv_sink.hpp"
#include "record/sink/hdf5_sink.hpp"
#include "record/sink/hdf5_tables.hpp"
#include "test_system.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <hdf5.h>
#include <sys/resource.h>

#include <bit>
#include <cmath>
#include <csignal>
#include <cstring>

namespace mebots::master {
namespace {

using test::TestRun;

constexpr const char* kRecordedSystem = R"({"step": 0.001, "stop_time": 9, "instances": {
    "a": {"fmu": "PROBE", "parameters": {"gain": -0.9, "offset": 0.3, "string_in": "ä, \"b\"\nc"}},
    "b": {"fmu": "PROBE", "parameters": {"gain": 0.8}}},
  "connections": [{"from": "a.real_out", "to": "b.real_in"}, {"from": "b.real_out", "to": "a.real_in"}],
  "record": {"variables": ["a.*"], "texts": true}})";

template <typename T>
std::vector<T> dataset(const std::filesystem::path& file, const char* name, hid_t type) {
  const auto opened = H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  const auto set = H5Dopen2(opened, name, H5P_DEFAULT);
  const auto space = H5Dget_space(set);
  std::vector<T> values(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
  H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
  H5Sclose(space);
  H5Dclose(set);
  H5Fclose(opened);
  return values;
}

/// Adds a sink to the recorder of the run. The result is valid during the lifetime of the recorder.
Hdf5Sink& add_sink(TestRun& run, const std::filesystem::path& file) {
  auto sink = std::make_unique<Hdf5Sink>(run.recorder->columns(), file);
  auto& added = *sink;
  run.recorder->add(std::move(sink));
  return added;
}

TEST(Hdf5, HoldsTheBitsOfTheCsv) {
  TestRun run(kRecordedSystem);
  const auto file = run.folder.path() / "results.h5";
  auto& sink = add_sink(run, file);
  run.to_end();
  run.csv();
  sink.close();
  EXPECT_EQ(dataset<double>(file, "/time", H5T_NATIVE_DOUBLE), run.column("time"));
  EXPECT_EQ(dataset<double>(file, "/a/real_out", H5T_NATIVE_DOUBLE), run.column("a.real_out"));
  EXPECT_EQ(dataset<double>(file, "/a/integral", H5T_NATIVE_DOUBLE), run.column("a.integral"));
  EXPECT_EQ(dataset<double>(file, "/a/steps", H5T_NATIVE_DOUBLE), run.column("a.steps"));
  EXPECT_EQ(dataset<double>(file, "/a/boolean_out", H5T_NATIVE_DOUBLE), run.column("a.boolean_out"));
  EXPECT_EQ(run.column("a.steps").size(), 9001u);
}

TEST(Hdf5, IsMadeAnewFromACsv) {
  TestRun run(kRecordedSystem);
  const auto straight = run.folder.path() / "straight.h5";
  const auto copied = run.folder.path() / "copied.h5";
  auto& sink = add_sink(run, straight);
  run.to_end();
  const auto bytes = run.csv().size();
  sink.close();
  {
    Hdf5Sink copy(run.recorder->columns(), copied);
    copy_csv_rows(run.file->path(), bytes, run.recorder->columns(), copy);
  }
  for (const auto* name : {"/time", "/a/real_out", "/a/integral", "/a/steps", "/a/boolean_out"}) {
    EXPECT_EQ(dataset<double>(copied, name, H5T_NATIVE_DOUBLE), dataset<double>(straight, name, H5T_NATIVE_DOUBLE));
  }
  const auto type = H5Tcopy(H5T_C_S1);
  H5Tset_size(type, H5T_VARIABLE);
  H5Tset_cset(type, H5T_CSET_UTF8);
  const auto texts = dataset<char*>(copied, "/a/string_out", type);
  H5Tclose(type);
  ASSERT_EQ(texts.size(), 9001u);
  EXPECT_STREQ(texts.back(), "ä, \"b\"\nc!");
  for (auto* text : texts) std::free(text);  // NOLINT(cppcoreguidelines-no-malloc): HDF5 made them
}

TEST(Hdf5, GoesBackToASavedState) {
  TestRun straight(kRecordedSystem);
  const auto one = straight.folder.path() / "one.h5";
  auto& straight_sink = add_sink(straight, one);
  straight.to_end();
  straight.csv();
  straight_sink.close();

  TestRun run(kRecordedSystem);
  const auto two = run.folder.path() / "two.h5";
  auto& sink = add_sink(run, two);
  run.initialize();
  for (int i = 0; i < 1000; ++i) run.simulation().step();
  const auto state = run.simulation().save_state();
  for (int i = 0; i < 5000; ++i) run.simulation().step();
  run.simulation().restore_state(state);
  while (run.simulation().step()) {
  }
  run.csv();
  sink.close();
  EXPECT_EQ(dataset<double>(two, "/a/real_out", H5T_NATIVE_DOUBLE),
            dataset<double>(one, "/a/real_out", H5T_NATIVE_DOUBLE));
}

/// Limits the size of files that this process writes, like a full disk. Further writes fail with EFBIG.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  rlimit before_{};
  void (*handler_)(int);
};

/// Writes a column of `count` numbers that compress badly.
void write_rows(const std::filesystem::path& file, std::size_t count) {
  Hdf5Sink sink({{"a.value", "m", modeldesc::Type::real}}, file);
  RowBlock block;
  block.cells_per_row = 2;
  for (std::size_t i = 0; i < count; ++i) {
    block.cells.push_back(std::bit_cast<std::uint64_t>(static_cast<double>(i)));
    block.cells.push_back(std::bit_cast<std::uint64_t>(std::sin(static_cast<double>(i * i))));
  }
  sink.write(block);
  sink.close();
}

TEST(Hdf5, ADiskThatIsFullAtAnyByteIsReported) {
  const modeldesc::TemporaryFolder folder("mebots-test");
  constexpr std::size_t kRows = 20'000;
  const auto whole = folder.path() / "whole.h5";
  write_rows(whole, kRows);
  const auto size = std::filesystem::file_size(whole);
  ASSERT_GT(size, 100'000u);
  for (std::uintmax_t limit = 0; limit < size; limit += size / 37) {
    const auto file = folder.path() / fmt::format("{}.h5", limit);
    const FileSizeLimit full(limit);
    try {
      write_rows(file, kRows);
      FAIL() << "a limit of " << limit << " bytes was not reported";
    } catch (const Error& error) {
      EXPECT_THAT(error.what(),
                  testing::AllOf(testing::HasSubstr(file.string()), testing::HasSubstr("File too large")));
    }
  }
  const auto after = folder.path() / "after.h5";
  write_rows(after, kRows);
  EXPECT_EQ(test::read_file(after), test::read_file(whole));
  EXPECT_EQ(dataset<double>(after, "/time", H5T_NATIVE_DOUBLE).back(), static_cast<double>(kRows - 1));
}

TEST(Hdf5, ATableThatDoesNotFitOnTheDiskIsReported) {
  const modeldesc::TemporaryFolder folder("mebots-test");
  const std::vector<Table> tables{{"numbers", {{"value", "m", std::vector<double>(50'000, 0.5)}}}};
  for (const rlim_t limit : {0, 1'000, 100'000}) {
    const FileSizeLimit full(limit);
    EXPECT_THROW(write_hdf5(tables, folder.path() / "tables.h5"), Error) << limit;
  }
  write_hdf5(tables, folder.path() / "tables.h5");
  EXPECT_EQ(dataset<double>(folder.path() / "tables.h5", "/numbers/value", H5T_NATIVE_DOUBLE).size(), 50'000u);
}

}  // namespace
}  // namespace mebots::master
