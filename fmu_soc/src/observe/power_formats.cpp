// SPDX-License-Identifier: Apache-2.0
#include "observe/power_formats.hpp"

#include "observe/text_file.hpp"

#include "mebots/error.hpp"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>

namespace mebots::soc::observe {
namespace {

constexpr double kNothingYet = std::numeric_limits<double>::quiet_NaN();

/// Writes trace events: the states of each track as slices of one thread, and values as counters.
class PerfettoWriter final : public PowerWriter {
 public:
  PerfettoWriter(const std::string& option, const std::string& path, std::vector<std::string> tracks,
                 std::vector<std::string> channels)
      : file_(option, path),
        channels_(std::move(channels)),
        open_(tracks.size()),
        last_(channels_.size(), kNothingYet) {
    file_.put("{\"displayTimeUnit\":\"ns\",\"traceEvents\":[\n");
    file_.put(R"({"ph":"M","pid":1,"name":"process_name","args":{"name":"chip"}})");
    for (std::size_t i = 0; i < tracks.size(); ++i) {
      file_.print(",\n{{\"ph\":\"M\",\"pid\":1,\"tid\":{},\"name\":\"thread_name\",\"args\":{{\"name\":{}}}}}", i + 1,
                  nlohmann::json(tracks[i]).dump());
    }
  }

  void state(Picoseconds time, std::size_t track, std::string_view name) override {
    close(time, track);
    open_[track] = {time, std::string(name)};
  }

  void value(Picoseconds time, std::size_t channel, double value) override {
    if (last_[channel] == value) return;
    last_[channel] = value;
    file_.put(",\n{\"ph\":\"C\",\"pid\":1,\"ts\":");
    put_microseconds(time);
    file_.print(",\"name\":\"{}\",\"args\":{{\"value\":{:.9g}}}}}", channels_[channel], value);
  }

  void finish(Picoseconds time) override {
    for (std::size_t i = 0; i < open_.size(); ++i) close(time, i);
    file_.put("\n]}\n");
    file_.close();
  }

 private:
  struct Open {
    Picoseconds since = 0;
    std::string name;
  };

  void close(Picoseconds time, std::size_t track) {
    const auto& slice = open_[track];
    if (slice.name.empty()) return;
    file_.print(",\n{{\"ph\":\"X\",\"pid\":1,\"tid\":{},\"ts\":", track + 1);
    put_microseconds(slice.since);
    file_.put(",\"dur\":");
    put_microseconds(time - slice.since);
    file_.print(",\"name\":{}}}", nlohmann::json(slice.name).dump());
  }

  void put_microseconds(Picoseconds time) { file_.print("{}.{:06}", time / 1'000'000, time % 1'000'000); }

  TextFile file_;
  std::vector<std::string> channels_;
  std::vector<Open> open_;
  std::vector<double> last_;
};

/// Writes a value change dump: states as string variables, and values as reals.
class VcdWriter final : public PowerWriter {
 public:
  VcdWriter(const std::string& option, const std::string& path, const std::vector<std::string>& tracks,
            const std::vector<std::string>& channels)
      : file_(option, path), tracks_(tracks.size()), last_(channels.size(), kNothingYet) {
    file_.put("$timescale 1ps $end\n$scope module chip $end\n");
    for (std::size_t i = 0; i < tracks.size(); ++i) {
      file_.print("$var string 1 {} {} $end\n", code(i), identifier(tracks[i]));
    }
    for (std::size_t i = 0; i < channels.size(); ++i) {
      file_.print("$var real 64 {} {} $end\n", code(tracks_ + i), identifier(channels[i]));
    }
    file_.put("$upscope $end\n$enddefinitions $end\n");
  }

  void state(Picoseconds time, std::size_t track, std::string_view name) override {
    at(time);
    file_.print("s{} {}\n", identifier(std::string(name)), code(track));
  }

  void value(Picoseconds time, std::size_t channel, double value) override {
    if (last_[channel] == value) return;
    last_[channel] = value;
    at(time);
    file_.print("r{:.9g} {}\n", value, code(tracks_ + channel));
  }

  void finish(Picoseconds time) override {
    at(time);
    file_.close();
  }

 private:
  static std::string code(std::size_t index) { return fmt::format("v{}", index); }

  /// Replaces spaces in names and string values, because a space separates fields in this format.
  static std::string identifier(std::string text) {
    std::replace_if(
        text.begin(), text.end(), [](char c) { return std::isspace(static_cast<unsigned char>(c)) != 0; }, '_');
    return text;
  }

  void at(Picoseconds time) {
    if (time == time_) return;
    time_ = time;
    file_.print("#{}\n", time);
  }

  TextFile file_;
  std::size_t tracks_;
  std::vector<double> last_;
  Picoseconds time_ = -1;
};

}  // namespace

std::unique_ptr<PowerWriter> make_power_writer(const std::string& option, const std::string& path,
                                               std::vector<std::string> tracks, std::vector<std::string> channels) {
  const auto ending = std::filesystem::path(path).extension();
  if (ending == ".json") {
    return std::make_unique<PerfettoWriter>(option, path, std::move(tracks), std::move(channels));
  }
  if (ending == ".vcd") return std::make_unique<VcdWriter>(option, path, tracks, channels);
  throw Error(fmt::format("{} {}: the name must end in .json (for Perfetto) or in .vcd (for GTKWave)", option, path));
}

}  // namespace mebots::soc::observe
