// SPDX-License-Identifier: Apache-2.0
// Tests the shell's interface of FMI 3.0 as an importing tool uses it: unpacks an FMU, loads it with dlopen, and calls
// its C functions.
#include "mebots/fmi3/functions.hpp"
#include "mebots/modeldesc/archive.hpp"
#include "mebots/modeldesc/elf_library.hpp"
#include "mebots/text_file.hpp"

#include <dlfcn.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <pugixml.hpp>

#include <map>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace mebots::test {
namespace {

using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

/// Unpacks and loads an FMU of tests/fmus for FMI 3.0.
class Fmu3 {
 public:
  Fmu3(const char* archive, const char* identifier) : folder_("fmi3 f\xC3\xBCr tests") {
    modeldesc::unpack(fmt::format(MEBOTS_BINARY_DIR "/test_fmus/{}.fmu", archive), folder_.path());
    binary_ = folder_.path() / fmt::format("binaries/x86_64-linux/{}.so", identifier);
    handle_ = dlopen(binary_.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (handle_ == nullptr) throw std::runtime_error(dlerror());
    pugi::xml_document xml;
    xml.load_file((folder_.path() / "modelDescription.xml").c_str());
    token_ = xml.document_element().attribute("instantiationToken").value();
    for (const auto variable : xml.document_element().child("ModelVariables").children())
      references_[variable.attribute("name").value()] = variable.attribute("valueReference").as_uint();
  }

  static const Fmu3& bank() {
    static const Fmu3 fmu("bank", "bank");
    return fmu;
  }
  static const Fmu3& lag() {
    static const Fmu3 fmu("lag_fmi3", "lag");
    return fmu;
  }

  template <typename Function>
  Function* find(const char* name) const {
    void* const found = dlsym(handle_, name);
    if (found == nullptr) throw std::runtime_error(fmt::format("{} is not exported", name));
    return reinterpret_cast<Function*>(found);
  }
  const std::filesystem::path& binary() const { return binary_; }
  const std::filesystem::path& folder() const { return folder_.path(); }
  const std::string& token() const { return token_; }
  fmi3ValueReference reference(const std::string& name) const { return references_.at(name); }

 private:
  modeldesc::TemporaryFolder folder_;
  std::filesystem::path binary_;
  void* handle_;
  std::string token_;
  std::map<std::string, fmi3ValueReference> references_;
};

#define CALL(fmu, name) (fmu).find<decltype(name)>(#name)

/// Owns an instance, and records its logged messages.
class Instance3 {
 public:
  explicit Instance3(const Fmu3& fmu, bool event_mode = false) : fmu_(fmu) {
    const auto resources = (fmu.folder() / "resources" / "").string();
    handle_ = CALL(fmu, fmi3InstantiateCoSimulation)("one", fmu.token().c_str(), resources.c_str(), false, false,
                                                     event_mode, false, nullptr, 0, this, &Instance3::log, nullptr);
  }
  ~Instance3() { CALL(fmu_, fmi3FreeInstance)(handle_); }
  Instance3(const Instance3&) = delete;
  Instance3& operator=(const Instance3&) = delete;

  fmi3Instance handle() const { return handle_; }
  const std::string& last_message() const { return last_message_; }

  void start() {
    ASSERT_EQ(CALL(fmu_, fmi3EnterInitializationMode)(handle_, false, 0, 0, false, 0), fmi3OK) << last_message_;
    ASSERT_EQ(CALL(fmu_, fmi3ExitInitializationMode)(handle_), fmi3OK) << last_message_;
  }
  fmi3Status step(double point_s, double step_s) {
    fmi3Boolean event = true;
    fmi3Boolean terminate = true;
    fmi3Boolean early = true;
    double last_s = -1;
    const auto status = CALL(fmu_, fmi3DoStep)(handle_, point_s, step_s, true, &event, &terminate, &early, &last_s);
    if (status == fmi3OK) {
      EXPECT_FALSE(event || terminate || early);
      EXPECT_EQ(last_s, point_s + step_s);
    }
    return status;
  }

  template <typename T, typename Function>
  fmi3Status set(Function* function, const std::string& name, std::vector<T> values) {
    const auto reference = fmu_.reference(name);
    return function(handle_, &reference, 1, values.data(), values.size());
  }
  fmi3Status set_numbers(const std::string& name, const std::vector<double>& values) {
    return set(CALL(fmu_, fmi3SetFloat64), name, values);
  }
  std::vector<double> numbers(const std::string& name, std::size_t count) {
    const auto reference = fmu_.reference(name);
    std::vector<double> values(count);
    EXPECT_EQ(CALL(fmu_, fmi3GetFloat64)(handle_, &reference, 1, values.data(), count), fmi3OK) << last_message_;
    return values;
  }
  std::string text(const std::string& name) {
    const auto reference = fmu_.reference(name);
    fmi3String value = "";
    EXPECT_EQ(CALL(fmu_, fmi3GetString)(handle_, &reference, 1, &value, 1), fmi3OK) << last_message_;
    return value;
  }
  /// Sets an array of type Binary. Frees the memory of the bytes after the call.
  fmi3Status set_binaries(const std::string& name, const std::vector<std::string>& texts) {
    const auto reference = fmu_.reference(name);
    std::vector<std::vector<std::uint8_t>> copies;
    std::vector<fmi3Binary> values;
    std::vector<std::size_t> sizes;
    for (const auto& text : texts) {
      copies.emplace_back(text.begin(), text.end());
      values.push_back(copies.back().data());
      sizes.push_back(text.size());
    }
    return CALL(fmu_, fmi3SetBinary)(handle_, &reference, 1, sizes.data(), values.data(), values.size());
  }
  std::vector<std::string> binaries(const std::string& name, std::size_t count) {
    const auto reference = fmu_.reference(name);
    std::vector<fmi3Binary> values(count);
    std::vector<std::size_t> sizes(count);
    EXPECT_EQ(CALL(fmu_, fmi3GetBinary)(handle_, &reference, 1, sizes.data(), values.data(), count), fmi3OK)
        << last_message_;
    std::vector<std::string> texts;
    for (std::size_t i = 0; i < count; ++i)
      texts.emplace_back(reinterpret_cast<const char*>(values[i]), values[i] == nullptr ? 0 : sizes[i]);
    return texts;
  }
  void set_lines(std::uint64_t count) {
    ASSERT_EQ(CALL(fmu_, fmi3EnterConfigurationMode)(handle_), fmi3OK) << last_message_;
    ASSERT_EQ(set<std::uint64_t>(CALL(fmu_, fmi3SetUInt64), "lines", {count}), fmi3OK) << last_message_;
    ASSERT_EQ(CALL(fmu_, fmi3ExitConfigurationMode)(handle_), fmi3OK) << last_message_;
  }
  std::vector<std::uint8_t> serialized() {
    fmi3FMUState state = nullptr;
    std::size_t size = 0;
    EXPECT_EQ(CALL(fmu_, fmi3GetFMUState)(handle_, &state), fmi3OK) << last_message_;
    EXPECT_EQ(CALL(fmu_, fmi3SerializedFMUStateSize)(handle_, state, &size), fmi3OK) << last_message_;
    std::vector<std::uint8_t> bytes(size);
    EXPECT_EQ(CALL(fmu_, fmi3SerializeFMUState)(handle_, state, bytes.data(), size), fmi3OK) << last_message_;
    EXPECT_EQ(CALL(fmu_, fmi3FreeFMUState)(handle_, &state), fmi3OK);
    return bytes;
  }
  fmi3Status restore(std::span<const std::uint8_t> bytes) {
    fmi3FMUState state = nullptr;
    const auto read = CALL(fmu_, fmi3DeserializeFMUState)(handle_, bytes.data(), bytes.size(), &state);
    if (read != fmi3OK) return read;
    const auto status = CALL(fmu_, fmi3SetFMUState)(handle_, state);
    EXPECT_EQ(CALL(fmu_, fmi3FreeFMUState)(handle_, &state), fmi3OK);
    return status;
  }

 private:
  static void log(fmi3InstanceEnvironment environment, fmi3Status /*status*/, fmi3String /*category*/,
                  fmi3String message) {
    static_cast<Instance3*>(environment)->last_message_ = message;
  }

  const Fmu3& fmu_;
  fmi3Instance handle_;
  std::string last_message_;
};

TEST(Fmi3Shell, ExportsAllOfItsFmi3FunctionsAndNothingElse) {
  const auto header = text_of(MEBOTS_SOURCE_DIR "/modeldesc/include/mebots/fmi3/functions.hpp");
  const auto names = modeldesc::read_elf_library(Fmu3::bank().binary()).exports();
  EXPECT_THAT(names, Each(StartsWith("fmi3")));
  EXPECT_THAT(names, testing::SizeIs(75));
  for (const auto& name : names) {
    const bool is_number = header.find(name.substr(0, std::string("fmi3Get").size()) + "##name") != std::string::npos;
    EXPECT_TRUE(header.find(name + "(") != std::string::npos || is_number) << name;
  }
  EXPECT_STREQ(CALL(Fmu3::bank(), fmi3GetVersion)(), "3.0");
}

TEST(Fmi3Shell, ReadsAndSetsArraysAsAWhole) {
  Instance3 bank(Fmu3::bank());
  ASSERT_EQ(bank.set_numbers("line.u", {1, 2}), fmi3OK) << bank.last_message();
  bank.start();
  EXPECT_THAT(bank.numbers("line.y", 2), ElementsAre(0, 10));
  ASSERT_EQ(bank.step(0, 0.5), fmi3OK) << bank.last_message();
  EXPECT_THAT(bank.numbers("line.y", 2), ElementsAre(0.5, 11));
  EXPECT_THAT(bank.numbers("time", 1), ElementsAre(0.5));
  EXPECT_EQ(bank.text("labels"), "a b");
  EXPECT_EQ(bank.set_numbers("line.u", {1}), fmi3Error);
  EXPECT_THAT(bank.last_message(), HasSubstr("1 values for variables of 2 elements together"));
}

TEST(Fmi3Shell, AStructuralParameterChangesTheSizeOfArrays) {
  Instance3 bank(Fmu3::bank());
  EXPECT_EQ(bank.set<std::uint64_t>(CALL(Fmu3::bank(), fmi3SetUInt64), "lines", {3}), fmi3Error);
  EXPECT_THAT(bank.last_message(), HasSubstr("call fmi3EnterConfigurationMode before you set it"));
  bank.set_lines(4);
  ASSERT_EQ(bank.set_numbers("line.u", {1, 1, 1, 1}), fmi3OK) << bank.last_message();
  bank.start();
  ASSERT_EQ(bank.step(0, 1), fmi3OK) << bank.last_message();
  EXPECT_THAT(bank.numbers("line.y", 4), ElementsAre(1, 11, 21, 31));
  EXPECT_EQ(bank.text("labels"), "a b c d");
}

TEST(Fmi3Shell, AnArrayMayHaveNoElements) {
  Instance3 bank(Fmu3::bank());
  bank.set_lines(0);
  bank.start();
  EXPECT_THAT(bank.numbers("line.y", 0), ElementsAre());
  EXPECT_EQ(bank.text("labels"), "");
}

TEST(Fmi3Shell, ConfigurationModeSetsStructuralParametersOnlyAndChecksThem) {
  const Fmu3& fmu = Fmu3::bank();
  Instance3 bank(fmu);
  ASSERT_EQ(CALL(fmu, fmi3EnterConfigurationMode)(bank.handle()), fmi3OK);
  EXPECT_EQ(bank.set_numbers("line.initial", {1, 2}), fmi3Error);
  EXPECT_THAT(bank.last_message(), HasSubstr("leave configuration mode before you set it"));
  EXPECT_EQ(bank.set<std::uint64_t>(CALL(fmu, fmi3SetUInt64), "lines", {5}), fmi3Error);
  EXPECT_THAT(bank.last_message(), HasSubstr("lines = 5 is above its maximum of 4"));
  EXPECT_EQ(bank.set<std::uint64_t>(CALL(fmu, fmi3SetUInt64), "lines", {~std::uint64_t{0}}), fmi3Error);
  EXPECT_THAT(bank.last_message(), HasSubstr("this variable holds numbers of 32 bits"));
  EXPECT_EQ(bank.step(0, 1), fmi3Error);
  EXPECT_THAT(bank.last_message(), HasSubstr("not allowed in state 'configuration mode'"));
  Instance3 lag(Fmu3::lag());
  EXPECT_EQ(CALL(Fmu3::lag(), fmi3EnterConfigurationMode)(lag.handle()), fmi3Error);
  EXPECT_THAT(lag.last_message(), HasSubstr("has no structural parameter"));
}

TEST(Fmi3Shell, KeepsACopyOfBinariesAndSavesIt) {
  Instance3 bank(Fmu3::bank());
  bank.start();
  ASSERT_EQ(bank.set_binaries("line.message", {"abc", "defgh"}), fmi3OK) << bank.last_message();
  const auto saved = bank.serialized();
  ASSERT_EQ(bank.step(0, 0.5), fmi3OK) << bank.last_message();
  EXPECT_THAT(bank.binaries("line.echo", 2), ElementsAre("abc", "defgh"));
  const auto after_step = bank.serialized();

  Instance3 other(Fmu3::bank());
  ASSERT_EQ(other.restore(saved), fmi3OK) << other.last_message();
  EXPECT_THAT(other.binaries("line.message", 2), ElementsAre("abc", "defgh"));
  ASSERT_EQ(other.step(0, 0.5), fmi3OK) << other.last_message();
  EXPECT_EQ(other.serialized(), after_step);
  ASSERT_EQ(bank.restore(saved), fmi3OK) << bank.last_message();
  EXPECT_EQ(bank.serialized(), saved);
  EXPECT_THAT(bank.binaries("line.echo", 2), ElementsAre("", ""));
}

TEST(Fmi3Shell, ReadsEnumerationsAsInt64AndBooleansAsBytes) {
  const Fmu3& fmu = Fmu3::bank();
  Instance3 bank(fmu);
  ASSERT_EQ(bank.set<std::int64_t>(CALL(fmu, fmi3SetInt64), "line.mode", {0, 1}), fmi3OK) << bank.last_message();
  EXPECT_EQ(bank.set<std::int64_t>(CALL(fmu, fmi3SetInt64), "line.mode", {0, 2}), fmi3Error);
  EXPECT_THAT(bank.last_message(), HasSubstr("is not one of its values (0 = hold, 1 = integrate)"));
  EXPECT_EQ(bank.set<std::int32_t>(CALL(fmu, fmi3SetInt32), "line.mode", {0, 1}), fmi3Error);
  EXPECT_THAT(bank.last_message(), HasSubstr("of type Int64, not Int32; use the functions for Int64"));
  ASSERT_EQ(bank.set_numbers("line.u", {3, 0}), fmi3OK);
  bank.start();
  ASSERT_EQ(bank.step(0, 1), fmi3OK);
  EXPECT_THAT(bank.numbers("line.y", 2), ElementsAre(0, 10));
  const auto reference = fmu.reference("line.moving");
  std::array<fmi3Boolean, 2> moving{};
  ASSERT_EQ(CALL(fmu, fmi3GetBoolean)(bank.handle(), &reference, 1, moving.data(), 2), fmi3OK);
  EXPECT_THAT(moving, ElementsAre(true, false));
}

TEST(Fmi3Shell, ReadsStartValuesBeforeInitialisationButNoOutputs) {
  Instance3 bank(Fmu3::bank());
  EXPECT_THAT(bank.numbers("line.initial", 2), ElementsAre(0, 10));
  const auto reference = Fmu3::bank().reference("line.y");
  std::array<double, 2> values{};
  EXPECT_EQ(CALL(Fmu3::bank(), fmi3GetFloat64)(bank.handle(), &reference, 1, values.data(), 2), fmi3Error);
  EXPECT_THAT(bank.last_message(), HasSubstr("has no value yet: fmi3EnterInitializationMode comes first"));
}

TEST(Fmi3Shell, RefusesWhatItDoesNotOfferWithAReason) {
  const Fmu3& fmu = Fmu3::bank();
  EXPECT_EQ(Instance3(fmu, true).handle(), nullptr);
  EXPECT_THAT(Instance3(fmu, true).last_message(), HasSubstr("hasEventMode = false"));
  Instance3 bank(fmu);
  bank.start();
  std::size_t count = 0;
  EXPECT_EQ(CALL(fmu, fmi3GetNumberOfContinuousStates)(bank.handle(), &count), fmi3Error);
  EXPECT_THAT(bank.last_message(), HasSubstr("fmi3GetNumberOfContinuousStates: this is for model exchange"));
  EXPECT_EQ(CALL(fmu, fmi3GetNumberOfVariableDependencies)(bank.handle(), 0, &count), fmi3Error);
  EXPECT_THAT(bank.last_message(), HasSubstr("providesPerElementDependencies = false"));
  EXPECT_EQ(CALL(fmu, fmi3EnterEventMode)(bank.handle()), fmi3Error);
  EXPECT_EQ(CALL(fmu, fmi3ActivateModelPartition)(bank.handle(), 0, 0), fmi3Error);
  const fmi3ValueReference wrong = 1000;
  fmi3Clock clock = false;
  EXPECT_EQ(CALL(fmu, fmi3GetClock)(bank.handle(), &wrong, 1, &clock), fmi3Error);
  EXPECT_THAT(bank.last_message(), HasSubstr("no variable with the value reference 1000"));
  EXPECT_EQ(bank.step(0, 0.5), fmi3OK) << "a refused call changes nothing";
}

TEST(Fmi3Shell, StatesOfTheTwinOfFmi2AreRefused) {
  Instance3 lag(Fmu3::lag());
  lag.start();
  auto bytes = lag.serialized();
  const auto token = Fmu3::lag().token();
  const auto at = std::ranges::search(bytes, token);
  ASSERT_FALSE(at.empty());
  at.front() = '[';
  EXPECT_EQ(lag.restore(bytes), fmi3Error);
  EXPECT_THAT(lag.last_message(), HasSubstr("the state belongs to lag with instantiation token"));
}

TEST(Fmi3Shell, DoublesTheMarkOfValueReferencesInMessages) {
  Instance3 lag(Fmu3::lag());
  const auto reference = Fmu3::lag().reference("label.file");
  fmi3String value = "no#file";
  ASSERT_EQ(CALL(Fmu3::lag(), fmi3SetString)(lag.handle(), &reference, 1, &value, 1), fmi3OK);
  ASSERT_EQ(CALL(Fmu3::lag(), fmi3EnterInitializationMode)(lag.handle(), false, 0, 0, false, 0), fmi3OK);
  EXPECT_EQ(CALL(Fmu3::lag(), fmi3ExitInitializationMode)(lag.handle()), fmi3Error);
  EXPECT_THAT(lag.last_message(), HasSubstr("no##file cannot be read"));
  EXPECT_EQ(CALL(Fmu3::lag(), fmi3Reset)(lag.handle()), fmi3OK);
  lag.start();
}

}  // namespace
}  // namespace mebots::test
