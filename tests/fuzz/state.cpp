// SPDX-License-Identifier: Apache-2.0
//
// Reads any bytes after the checksum of an FMU's state. fmi2DeSerializeFMUstate and fmi2SetFMUstate must reject the
// bytes, or the instance must continue from the state. The model has one member of each kind that a state can contain.
#include "mebots/fmi2/functions.hpp"
#include "mebots/fmu/definition.hpp"
#include "mebots/state/bytes.hpp"
#include "mebots/state/save.hpp"
#include "require.hpp"

#include <array>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace {

using namespace mebots;

struct Variables {
  double gain = 1;
  double u = 0;
  double y = 0;
  std::string text;
};

enum class Mode : std::uint8_t { calm, wild };

class Kept final : public fmu::Model {
 public:
  explicit Kept(Variables& variables) : variables_(&variables) {}
  void step(std::int64_t /*start_ns*/, std::int64_t duration_ns) override {
    past_.push_back(variables_->u);
    if (past_.size() > kLongest) past_.erase(past_.begin());
    sums_.resize(3);
    sums_[1] += 1e-9 * static_cast<double>(duration_ns);
    last_ = past_.size();
    variables_->y = variables_->gain * sums_[1] + static_cast<double>(counts_[2]);
    if (word_.size() < kLongest) word_ += mode_ == Mode::wild ? '!' : '.';
    variables_->text = word_;
  }
  void visit(state::Visitor& v) override {
    v("past", past_);
    v("sums", sums_);
    v("counts", counts_);
    v("last", last_);
    v("word", word_);
    v("mode", mode_);
  }

 private:
  static constexpr std::size_t kLongest = 8;
  Variables* variables_;
  std::vector<double> past_;
  std::vector<double> sums_{0, 0, 0};
  std::array<std::int32_t, 4> counts_{};
  std::optional<std::uint64_t> last_;
  std::string word_;
  Mode mode_ = Mode::calm;
};

constexpr double kAny = std::numeric_limits<double>::infinity();
constexpr std::array kVariables = {
    fmu::Variable{"gain",
                  fmu::Type::real,
                  fmu::Causality::parameter,
                  fmu::Variability::fixed,
                  offsetof(Variables, gain),
                  -kAny,
                  kAny,
                  "",
                  {},
                  false},
    fmu::Variable{"u",
                  fmu::Type::real,
                  fmu::Causality::input,
                  fmu::Variability::continuous,
                  offsetof(Variables, u),
                  -kAny,
                  kAny,
                  "",
                  {},
                  false},
    fmu::Variable{"y",
                  fmu::Type::real,
                  fmu::Causality::output,
                  fmu::Variability::continuous,
                  offsetof(Variables, y),
                  -kAny,
                  kAny,
                  "",
                  {},
                  false},
    fmu::Variable{"text",
                  fmu::Type::string,
                  fmu::Causality::output,
                  fmu::Variability::discrete,
                  offsetof(Variables, text),
                  -kAny,
                  kAny,
                  "",
                  {},
                  false},
};

}  // namespace

namespace mebots::fmu {

const Definition kDefinition = {"kept",
                                "{fuzz}",
                                "",
                                kVariables,
                                {},
                                [] { return std::static_pointer_cast<void>(std::make_shared<Variables>()); },
                                [](void* variables, Host&, std::int64_t) -> std::unique_ptr<Model> {
                                  return std::make_unique<Kept>(*static_cast<Variables*>(variables));
                                }};

}  // namespace mebots::fmu

namespace {

void say_nothing(fmi2ComponentEnvironment, fmi2String, fmi2Status, fmi2String, fmi2String, ...) {}

fmi2Component started() {
  static const fmi2CallbackFunctions callbacks{&say_nothing, &std::calloc, &std::free, nullptr, nullptr};
  auto* const instance =
      fmi2Instantiate("it", fmi2CoSimulation, "{fuzz}", "file:///tmp", &callbacks, fmi2False, fmi2False);
  fmi2SetupExperiment(instance, fmi2False, 0, 0, fmi2False, 0);
  fmi2EnterInitializationMode(instance);
  fmi2ExitInitializationMode(instance);
  fuzz::require(fmi2DoStep(instance, 0, 1, fmi2True) == fmi2OK, "it steps");
  return instance;
}

/// Returns the header of a state of this build, up to the checksum.
std::vector<std::byte> header() {
  auto* const instance = started();
  fmi2FMUstate state = nullptr;
  fmi2GetFMUstate(instance, &state);
  std::size_t size = 0;
  fmi2SerializedFMUstateSize(instance, state, &size);
  std::vector<std::byte> bytes(size);
  fmi2SerializeFMUstate(instance, state, reinterpret_cast<fmi2Byte*>(bytes.data()), size);
  fmi2FreeFMUstate(instance, &state);
  fmi2FreeInstance(instance);
  state::Reader reader(bytes);
  reader.get<std::uint64_t>();
  reader.get<std::uint32_t>();
  std::string skipped;
  reader.get(skipped);
  reader.get(skipped);
  reader.get<std::uint64_t>();
  reader.get<std::uint64_t>();
  std::vector<std::byte> payload;
  reader.get(payload);
  bytes.resize(size - payload.size() - 2 * sizeof(std::uint64_t));
  return bytes;
}

std::vector<std::byte> with_checksum(std::span<const std::byte> payload) {
  static const auto front = header();
  std::uint64_t hash = 0;
  std::memcpy(&hash, front.data() + front.size() - sizeof hash, sizeof hash);  // of the layout
  hash ^= 0xCBF2'9CE4'8422'2325;
  for (const auto byte : payload) hash = (hash ^ static_cast<std::uint64_t>(byte)) * 0x0000'0100'0000'01B3;
  state::Writer writer;
  writer.append(front.data(), front.size());
  writer.put(hash);
  writer.put(std::vector<std::byte>(payload.begin(), payload.end()));
  return writer.take();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto bytes = with_checksum(std::as_bytes(std::span(data, size)));
  static auto* const instance = started();
  fmi2FMUstate before = nullptr;
  fmi2GetFMUstate(instance, &before);
  fmi2FMUstate state = nullptr;
  const auto status =
      fmi2DeSerializeFMUstate(instance, reinterpret_cast<const fmi2Byte*>(bytes.data()), bytes.size(), &state);
  if (status == fmi2OK) {
    if (fmi2SetFMUstate(instance, state) == fmi2OK) {
      const fmi2ValueReference reference = 2;
      double y = 0;
      fmi2GetReal(instance, &reference, 1, &y);
      fmi2DoStep(instance, 1, 1, fmi2True);
    }
    fmi2FreeFMUstate(instance, &state);
  }
  fuzz::require(status == fmi2OK || status == fmi2Error, "a bad state is an error, and the instance lives on");
  fuzz::require(fmi2SetFMUstate(instance, before) == fmi2OK, "the instance can be set back");
  fmi2FreeFMUstate(instance, &before);
  return 0;
}
