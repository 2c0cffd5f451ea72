// SPDX-License-Identifier: Apache-2.0
#include "record/sink/csv_rows.hpp"
#include "record/sink/hdf5_sink.hpp"
#include "test_system.hpp"

#include <gmock/gmock.h>
#include <hdf5.h>

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

TEST(Hdf5, HoldsTheBitsOfTheCsv) {
  TestRun run(kRecordedSystem);
  const auto file = run.folder.path() / "results.h5";
  run.recorder->add(std::make_unique<Hdf5Sink>(run.recorder->columns(), file));
  run.to_end();
  run.csv();  // all rows are in the files
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
  run.recorder->add(std::make_unique<Hdf5Sink>(run.recorder->columns(), straight));
  run.to_end();
  const auto bytes = run.csv().size();
  {
    Hdf5Sink sink(run.recorder->columns(), copied);
    copy_csv_rows(run.file->path(), bytes, run.recorder->columns(), sink);
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
  straight.recorder->add(std::make_unique<Hdf5Sink>(straight.recorder->columns(), one));
  straight.to_end();
  straight.csv();

  TestRun run(kRecordedSystem);
  const auto two = run.folder.path() / "two.h5";
  run.recorder->add(std::make_unique<Hdf5Sink>(run.recorder->columns(), two));
  run.initialize();
  for (int i = 0; i < 1000; ++i) run.simulation().step();
  const auto state = run.simulation().save_state();
  for (int i = 0; i < 5000; ++i) run.simulation().step();
  run.simulation().restore_state(state);
  while (run.simulation().step()) {
  }
  run.csv();
  EXPECT_EQ(dataset<double>(two, "/a/real_out", H5T_NATIVE_DOUBLE),
            dataset<double>(one, "/a/real_out", H5T_NATIVE_DOUBLE));
}

}  // namespace
}  // namespace mebots::master
