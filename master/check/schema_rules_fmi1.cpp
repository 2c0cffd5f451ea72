// SPDX-License-Identifier: Apache-2.0
#include "schema_rules.hpp"

namespace mebots::check {
namespace {

// The grammars of FMI 1.0 for co-simulation (section 4) and for model exchange (section 3), derived from the text of
// the standards.
constexpr RuleRow kFmi1Rows[] = {
    {"fmiModelDescription",
     "fmiVersion! modelName! modelIdentifier! guid! description author version generationTool "
     "generationDateAndTime:date variableNamingConvention:naming numberOfContinuousStates:count! "
     "numberOfEventIndicators:count!",
     "UnitDefinitions? TypeDefinitions? DefaultExperiment? VendorAnnotations? ModelVariables? Implementation?"},

    {"UnitDefinitions", "", "BaseUnit*"},
    {"BaseUnit", "unit!", "DisplayUnitDefinition*"},
    {"DisplayUnitDefinition", "displayUnit! gain:number offset:number", ""},

    {"TypeDefinitions", "", "Type*"},
    {"Type", "name! description", "| RealType? IntegerType? BooleanType? StringType? EnumerationType?"},
    {"RealType", "quantity unit displayUnit relativeQuantity:flag min:number max:number nominal:number", ""},
    {"IntegerType", "quantity min:whole max:whole", ""},
    {"BooleanType", "", ""},
    {"StringType", "", ""},
    {"EnumerationType", "quantity min:whole max:whole", "Item+"},
    {"Item", "name! description", ""},

    {"DefaultExperiment", "startTime:number stopTime:number tolerance:number", ""},
    {"VendorAnnotations", "", "Tool*"},
    {"Tool", "name!", "Annotation*"},
    {"Annotation", "name! value!", ""},

    {"ModelVariables", "", "ScalarVariable*"},
    {"ScalarVariable",
     "name! valueReference:count! description variability:variability1 causality:causality1 alias:alias1",
     "| Real? Integer? Boolean? String? Enumeration? DirectDependency?"},
    {"Real",
     "declaredType quantity unit displayUnit relativeQuantity:flag min:number max:number nominal:number start:number "
     "fixed:flag",
     ""},
    {"Integer", "declaredType quantity min:whole max:whole start:whole fixed:flag", ""},
    {"Boolean", "declaredType start:flag fixed:flag", ""},
    {"String", "declaredType start fixed:flag", ""},
    {"Enumeration", "declaredType! quantity min:whole max:whole start:whole fixed:flag", ""},
    {"DirectDependency", "", "Name*"},
    {"Name", "", ""},

    {"Implementation", "", "CoSimulation_StandAlone? CoSimulation_Tool?"},
    {"CoSimulation_StandAlone", "", "Capabilities"},
    {"CoSimulation_Tool", "", "Capabilities Model"},
    {"Capabilities",
     "canHandleVariableCommunicationStepSize:flag canHandleEvents:flag canRejectSteps:flag canInterpolateInputs:flag "
     "maxOutputDerivativeOrder:count canRunAsynchronuously:flag canSignalEvents:flag "
     "canBeInstantiatedOnlyOncePerProcess:flag canNotUseMemoryManagementFunctions:flag",
     ""},
    {"Model", "entryPoint! manualStart:flag! type!", "File*"},
    {"File", "file!", ""},
};

}  // namespace

std::span<const RuleRow> fmi1_rule_rows() {
  return kFmi1Rows;
}

}  // namespace mebots::check
