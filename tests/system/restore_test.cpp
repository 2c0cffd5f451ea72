// SPDX-License-Identifier: Apache-2.0
#include "missions.hpp"

#include "io/config/load_system.hpp"
#include "record/recorder.hpp"
#include "record/sink/csv_sink.hpp"
#include "record/sink/output_file.hpp"
#include "resolve/resolve.hpp"
#include "run/simulation.hpp"

#include <gtest/gtest.h>

#include <optional>

namespace mebots::system_test {
namespace {

class Silent final : public master::MessageSink {
 public:
  void message(const Message& /*message*/) override {}
};

/// Runs the easy mission in this process up to 5 s, which includes the take-off and the first pictures in flight.
class Mission {
 public:
  Mission(const std::filesystem::path& config, const std::filesystem::path& results)
      : system_(master::read_config(config)), file_(results) {
    master::set_stop_time(system_, 5'000'000'000, "this test");
    resolved_ = master::resolve(system_, library_);
    simulation_.emplace(resolved_, silent_);
    recorder_.emplace(resolved_, simulation_->ensemble());
    recorder_->add(std::make_unique<master::CsvSink>(recorder_->columns(), file_));
    simulation_->add(*recorder_);
    simulation_->initialize();
  }

  master::Simulation& simulation() { return *simulation_; }
  void step(int count) {
    for (int i = 0; i < count; ++i) simulation_->step();
  }
  void finish() {
    while (simulation_->step()) {
    }
    recorder_->flush();
    file_.close();
  }

 private:
  master::SystemDescription system_;
  master::FmuLibrary library_;
  master::ResolvedSystem resolved_;
  master::OutputFile file_;
  Silent silent_;
  std::optional<master::Simulation> simulation_;
  std::optional<master::Recorder> recorder_;
};

class Restore : public ::testing::Test {
 protected:
  Folder folder_;
  std::filesystem::path config_ = write(folder_ / "mission.json", shipped_config("gate_easy"));

  std::string straight() {
    Mission mission(config_, folder_ / "straight.csv");
    mission.finish();
    return read_file(folder_ / "straight.csv");
  }
};

TEST_F(Restore, RunThatGoesBackToItsSavedStateGivesTheBitsOfAStraightRun) {
  Mission mission(config_, folder_ / "restored.csv");
  mission.step(1250);  // simulates half of the time
  const auto state = mission.simulation().save_state();
  mission.step(700);
  mission.simulation().restore_state(state);
  mission.finish();
  EXPECT_TRUE(read_file(folder_ / "restored.csv") == straight());
}

TEST_F(Restore, StateAsBytesContinuesInNewInstancesWithTheSameBits) {
  std::vector<std::byte> bytes;
  {
    Mission first(config_, folder_ / "first.csv");
    first.step(1250);
    const auto state = first.simulation().save_state();
    bytes = first.simulation().serialize(state);
  }
  Mission second(config_, folder_ / "second.csv");
  second.step(1);
  const auto kept = second.simulation().save_state();  // enables the FMUs to restore an earlier state
  second.step(1259);  // the recorder truncates its file to the saved length, so it must be this long
  second.simulation().restore_state(second.simulation().deserialize(bytes));
  second.finish();
  EXPECT_TRUE(read_file(folder_ / "second.csv") == straight());
}

}  // namespace
}  // namespace mebots::system_test
