// SPDX-License-Identifier: Apache-2.0
#include "lag_fmu.hpp"

#include <gmock/gmock.h>

#include <cstdint>
#include <functional>

namespace mebots::test {
namespace {

using testing::HasSubstr;

fmi2Component instantiate(std::vector<Message>& messages, const char* name, fmi2Type type, const char* guid,
                          const char* uri) {
  const fmi2CallbackFunctions callbacks = Lag::callbacks(messages);
  return library().instantiate(name, type, guid, uri, &callbacks, fmi2False, fmi2False);
}

void expect_refused(const char* name, fmi2Type type, const char* guid, const char* uri, const char* text) {
  std::vector<Message> messages;
  EXPECT_EQ(instantiate(messages, name, type, guid, uri), nullptr);
  ASSERT_EQ(messages.size(), 1U);
  EXPECT_EQ(messages[0].status, fmi2Error);
  EXPECT_THAT(messages[0].text, HasSubstr(text));
}

TEST(Shell, SaysWhichInterfaceItSpeaks) {
  EXPECT_STREQ(library().get_version(), "2.0");
  EXPECT_STREQ(library().get_types_platform(), "default");
}

TEST(Shell, RefusesAWrongGuidKindNameOrResourceLocation) {
  const std::string guid = LagFmu::get().description().guid;
  const std::string uri = LagFmu::get().resource_uri();
  expect_refused("a", fmi2CoSimulation, "{other}", uri.c_str(), "the GUID {other} differs from this library's ");
  expect_refused("a", fmi2CoSimulation, nullptr, uri.c_str(), "GUID (null)");
  expect_refused("a", fmi2ModelExchange, guid.c_str(), uri.c_str(), "only co-simulation");
  expect_refused("", fmi2CoSimulation, guid.c_str(), uri.c_str(), "instance name is missing");
  expect_refused(nullptr, fmi2CoSimulation, guid.c_str(), uri.c_str(), "instance name is missing");
  expect_refused("a", fmi2CoSimulation, guid.c_str(), nullptr, "is missing");
  expect_refused("a", fmi2CoSimulation, guid.c_str(), "/tmp/x", "does not start with file:");
  expect_refused("a", fmi2CoSimulation, guid.c_str(), "http://x/y", "does not start with file:");
  expect_refused("a", fmi2CoSimulation, guid.c_str(), "file://server/x", "names another machine");
  expect_refused("a", fmi2CoSimulation, guid.c_str(), "file:///tmp/%2", "without two hexadecimal digits");
  expect_refused("a", fmi2CoSimulation, guid.c_str(), "file:///tmp/%00", "null byte");
  EXPECT_EQ(library().instantiate("a", fmi2CoSimulation, guid.c_str(), uri.c_str(), nullptr, 0, 0), nullptr);
}

TEST(Shell, TakesEveryFormOfFileUri) {
  const std::string guid = LagFmu::get().description().guid;
  const std::string path = LagFmu::get().resource_uri().substr(7);
  for (const std::string& uri : {"file://" + path, "file:" + path, "file://localhost" + path, "FILE://" + path + "/"}) {
    std::vector<Message> messages;
    const fmi2Component component = instantiate(messages, "a", fmi2CoSimulation, guid.c_str(), uri.c_str());
    ASSERT_NE(component, nullptr) << uri;
    EXPECT_EQ(library().setup_experiment(component, 0, 0, 0, 0, 0), fmi2OK);
    EXPECT_EQ(library().enter_initialization_mode(component), fmi2OK);
    EXPECT_EQ(library().exit_initialization_mode(component), fmi2OK) << uri;  // the model reads a file in resources
    library().free_instance(component);
  }
}

/// A function of FMI 2.0 that takes an instance, and a call of it with correct arguments.
struct Call {
  const char* name;
  std::function<fmi2Status(fmi2Component)> call;
};

std::vector<Call> all_calls() {
  static const fmi2ValueReference u = LagFmu::get().reference("left.u");
  static const fmi2ValueReference steps = LagFmu::get().reference("steps");
  static const fmi2ValueReference trouble = LagFmu::get().reference("trouble");
  static const fmi2ValueReference enabled = LagFmu::get().reference("enabled");
  static const fmi2ValueReference note = LagFmu::get().reference("note");
  static double real = 0;
  static fmi2Integer integer = 0;
  static fmi2Boolean boolean = 0;
  static fmi2String text = "";
  static fmi2Status status = fmi2OK;
  const Library& f = library();
  return {
      {"fmi2SetDebugLogging", [&f](auto c) { return f.set_debug_logging(c, 0, 0, nullptr); }},
      {"fmi2SetupExperiment", [&f](auto c) { return f.setup_experiment(c, 0, 0, 0, 0, 0); }},
      {"fmi2EnterInitializationMode", [&f](auto c) { return f.enter_initialization_mode(c); }},
      {"fmi2ExitInitializationMode", [&f](auto c) { return f.exit_initialization_mode(c); }},
      {"fmi2Terminate", [&f](auto c) { return f.terminate(c); }},
      {"fmi2Reset", [&f](auto c) { return f.reset(c); }},
      {"fmi2GetReal", [&f](auto c) { return f.get_real(c, &u, 1, &real); }},
      {"fmi2GetInteger", [&f](auto c) { return f.get_integer(c, &steps, 1, &integer); }},
      {"fmi2GetBoolean", [&f](auto c) { return f.get_boolean(c, &enabled, 1, &boolean); }},
      {"fmi2GetString", [&f](auto c) { return f.get_string(c, &note, 1, &text); }},
      {"fmi2SetReal",
       [&f](auto c) {
         const double v = 0;
         return f.set_real(c, &u, 1, &v);
       }},
      {"fmi2SetInteger",
       [&f](auto c) {
         const int v = 0;
         return f.set_integer(c, &trouble, 1, &v);
       }},
      {"fmi2SetBoolean",
       [&f](auto c) {
         const int v = 1;
         return f.set_boolean(c, &enabled, 1, &v);
       }},
      {"fmi2SetString",
       [&f](auto c) {
         const char* v = "";
         return f.set_string(c, &note, 1, &v);
       }},
      {"fmi2GetFMUstate",
       [&f](auto c) {
         fmi2FMUstate state = nullptr;
         const fmi2Status result = f.get_fmu_state(c, &state);
         f.free_fmu_state(c, &state);
         return result;
       }},
      {"fmi2FreeFMUstate",
       [&f](auto c) {
         fmi2FMUstate state = nullptr;
         return f.free_fmu_state(c, &state);
       }},
      {"fmi2DoStep", [&f](auto c) { return f.do_step(c, 0, 0.1, 1); }},
      {"fmi2GetStatus", [&f](auto c) { return f.get_status(c, fmi2DoStepStatus, &status); }},
      {"fmi2GetRealStatus", [&f](auto c) { return f.get_real_status(c, fmi2LastSuccessfulTime, &real); }},
      {"fmi2GetBooleanStatus", [&f](auto c) { return f.get_boolean_status(c, fmi2Terminated, &boolean); }},
      {"fmi2GetStringStatus", [&f](auto c) { return f.get_string_status(c, fmi2PendingStatus, &text); }},
  };
}

/// True if FMI 2.0.4 (section 4.2.4) permits a function in a state. Does not use the shell's tables, so that
/// the test can check these tables.
bool is_legal(const std::string& name, const std::string& state) {
  if (name == "fmi2SetDebugLogging" || name == "fmi2Reset" || name.ends_with("FMUstate")) return true;
  if (name == "fmi2SetupExperiment") return state == "instantiated";
  if (name == "fmi2EnterInitializationMode") return state == "instantiated";
  if (name == "fmi2ExitInitializationMode") return state == "initialization mode";
  if (name == "fmi2Terminate" || name == "fmi2DoStep") return state == "step complete";
  if (name.ends_with("Status")) return state == "step complete" || state == "terminated";
  if (name.starts_with("fmi2Get")) return state != "instantiated";
  if (name.starts_with("fmi2Set"))
    return state == "instantiated" || state == "initialization mode" || state == "step complete";
  ADD_FAILURE() << name;
  return false;
}

void bring_into(Lag& lag, const std::string& state) {
  ASSERT_EQ(library().setup_experiment(lag.component(), 0, 0, 0, 0, 0), fmi2OK);
  if (state == "instantiated") return;
  ASSERT_EQ(library().enter_initialization_mode(lag.component()), fmi2OK);
  if (state == "initialization mode") return;
  ASSERT_EQ(library().exit_initialization_mode(lag.component()), fmi2OK);
  if (state == "step complete") return;
  if (state == "terminated") {
    ASSERT_EQ(library().terminate(lag.component()), fmi2OK);
    return;
  }
  ASSERT_EQ(lag.set_integer("trouble", 1), fmi2OK);
  ASSERT_EQ(lag.step(0, 0.1), fmi2Error);
}

TEST(Shell, AllowsInEachStateWhatTheStandardAllowsAndNothingElse) {
  for (const std::string state : {"instantiated", "initialization mode", "step complete", "terminated", "error"}) {
    for (const Call& call : all_calls()) {
      Lag lag;
      bring_into(lag, state);
      const fmi2Status status = call.call(lag.component());
      if (is_legal(call.name, state)) {
        EXPECT_EQ(status, fmi2OK) << call.name << " in " << state << ": " << lag.last_message();
      } else {
        EXPECT_EQ(status, fmi2Error) << call.name << " in " << state;
        EXPECT_THAT(lag.last_message(), HasSubstr(std::string(call.name) + ": not allowed in state '" + state + "'"));
      }
    }
  }
}

TEST(Shell, AnswersEveryFunctionWithoutAnInstance) {
  for (const Call& call : all_calls()) EXPECT_EQ(call.call(nullptr), fmi2Error) << call.name;
  library().free_instance(nullptr);
}

TEST(Shell, NeedsTheStartTimeBeforeInitialisation) {
  Lag lag;
  EXPECT_EQ(library().enter_initialization_mode(lag.component()), fmi2Error);
  EXPECT_THAT(lag.last_message(), HasSubstr("call fmi2SetupExperiment first"));
}

TEST(Shell, RefusesTimesThatAreNoTimes) {
  Lag lag;
  EXPECT_EQ(library().setup_experiment(lag.component(), 0, 0, std::nan(""), 0, 0), fmi2Error);
  EXPECT_EQ(library().setup_experiment(lag.component(), 0, 0, 1e30, 0, 0), fmi2Error);
  EXPECT_EQ(library().setup_experiment(lag.component(), 0, 0, 2, 1, 1), fmi2Error);
  EXPECT_THAT(lag.last_message(), HasSubstr("stopTime 1 s is before startTime 2 s"));
}

TEST(Shell, SaysWhatItDoesNotOffer) {
  Lag lag;
  lag.start();
  EXPECT_EQ(library().get_directional_derivative(lag.component(), nullptr, 0, nullptr, 0, nullptr, nullptr), fmi2Error);
  EXPECT_THAT(lag.last_message(), HasSubstr("providesDirectionalDerivative = false"));
  EXPECT_EQ(library().set_real_input_derivatives(lag.component(), nullptr, 0, nullptr, nullptr), fmi2Error);
  EXPECT_EQ(library().get_real_output_derivatives(lag.component(), nullptr, 0, nullptr, nullptr), fmi2Error);
  EXPECT_EQ(library().cancel_step(lag.component()), fmi2Error);
  fmi2Integer value = 0;
  EXPECT_EQ(library().get_integer_status(lag.component(), fmi2DoStepStatus, &value), fmi2Error);
  EXPECT_EQ(lag.step(0, 0.1), fmi2OK);  // none of the calls had an effect
}

TEST(Shell, AMendableErrorInAStepLeadsToStateErrorAndResetLeadsOut) {
  Lag lag;
  lag.start();
  ASSERT_EQ(lag.set_integer("trouble", 1), fmi2OK);
  EXPECT_EQ(lag.step(0, 0.1), fmi2Error);
  EXPECT_EQ(lag.messages().back().status, fmi2Error);
  EXPECT_EQ(lag.messages().back().category, "logStatusError");
  EXPECT_EQ(lag.last_message(), "fmi2DoStep: trouble is mendable: 100 % as asked; set it to none");
  EXPECT_EQ(lag.step(0, 0.1), fmi2Error);
  EXPECT_THAT(lag.last_message(), HasSubstr("not allowed in state 'error'"));
  ASSERT_EQ(library().reset(lag.component()), fmi2OK);
  lag.start();
  EXPECT_EQ(lag.step(0, 0.1), fmi2OK);
}

TEST(Shell, AnUnknownExceptionIsFatalAndOnlyFreeingIsLeft) {
  Lag lag;
  lag.start();
  ASSERT_EQ(lag.set_integer("trouble", 2), fmi2OK);
  EXPECT_EQ(lag.step(0, 0.1), fmi2Fatal);
  EXPECT_EQ(lag.messages().back().status, fmi2Fatal);
  for (const Call& call : all_calls()) EXPECT_EQ(call.call(lag.component()), fmi2Fatal) << call.name;
}

TEST(Shell, AParameterThatTheModelRefusesFailsInitialisationByName) {
  Lag lag;
  ASSERT_EQ(lag.set_string("label.file", "no such file"), fmi2OK);
  ASSERT_EQ(library().setup_experiment(lag.component(), 0, 0, 0, 0, 0), fmi2OK);
  ASSERT_EQ(library().enter_initialization_mode(lag.component()), fmi2OK);
  EXPECT_EQ(library().exit_initialization_mode(lag.component()), fmi2Error);
  EXPECT_THAT(lag.last_message(), HasSubstr("label.file"));
  EXPECT_THAT(lag.last_message(), HasSubstr("no such file cannot be read"));
}

TEST(Shell, LogsByCategoryButErrorsAlways) {
  Lag quiet("quiet");
  quiet.start();
  EXPECT_TRUE(quiet.messages().empty());
  EXPECT_EQ(quiet.step(5, 0.1), fmi2Error);
  EXPECT_EQ(quiet.messages().size(), 1U);

  Lag talking("talking", true);
  talking.start();
  ASSERT_EQ(talking.messages().size(), 1U);
  EXPECT_EQ(talking.messages()[0].instance, "talking");
  EXPECT_EQ(talking.messages()[0].category, "events");
  EXPECT_EQ(talking.messages()[0].text, "starts at 0 ns");

  Lag chosen("chosen");
  const char* category = "events";
  ASSERT_EQ(library().set_debug_logging(chosen.component(), 1, 1, &category), fmi2OK);
  chosen.start();
  EXPECT_EQ(chosen.messages().size(), 1U);
  ASSERT_EQ(library().set_debug_logging(chosen.component(), 0, 1, &category), fmi2OK);
  ASSERT_EQ(library().reset(chosen.component()), fmi2OK);
  chosen.start();
  EXPECT_EQ(chosen.messages().size(), 1U);

  category = "gossip";
  EXPECT_EQ(library().set_debug_logging(chosen.component(), 1, 1, &category), fmi2Error);
  EXPECT_THAT(chosen.last_message(), HasSubstr("unknown log category \"gossip\"; known are events"));
  EXPECT_EQ(library().set_debug_logging(chosen.component(), 1, 1, nullptr), fmi2Error);
}

}  // namespace
}  // namespace mebots::test
