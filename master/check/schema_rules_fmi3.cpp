// SPDX-License-Identifier: Apache-2.0
#include "schema_rules.hpp"

namespace mebots::check {
namespace {

// Attributes of all variables, of variables other than Clocks, and of floating-point variables; children of most
// variables.
#define MEBOTS_EACH                                                                       \
  "name! valueReference:count! description causality:causality3 variability:variability " \
  "canHandleMultipleSetPerTimeInstant:flag clocks:counts "
#define MEBOTS_VALUED MEBOTS_EACH "intermediateUpdate:flag previous:count declaredType initial:initial "
#define MEBOTS_FLOAT                                                                                     \
  "quantity unit displayUnit relativeQuantity:flag unbounded:flag min:number max:number nominal:number " \
  "start:numbers derivative:count reinit:flag"
#define MEBOTS_INSIDE "Annotations? Dimension* Alias*"

// The grammar of FMI 3.0.2, sections 2.2.3, 2.4 and 3 to 5, derived from the text of the standard.
constexpr RuleRow kFmi3Rows[] = {
    {"fmiModelDescription",
     "fmiVersion:fmi3! modelName! instantiationToken! description author version copyright license generationTool "
     "generationDateAndTime:date variableNamingConvention:naming",
     "ModelExchange? CoSimulation? ScheduledExecution? UnitDefinitions? TypeDefinitions? LogCategories? "
     "DefaultExperiment? ModelVariables ModelStructure Annotations?"},

    {"ModelExchange",
     "modelIdentifier! needsExecutionTool:flag canBeInstantiatedOnlyOncePerProcess:flag canGetAndSetFMUState:flag "
     "canSerializeFMUState:flag providesDirectionalDerivatives:flag providesAdjointDerivatives:flag "
     "providesPerElementDependencies:flag needsCompletedIntegratorStep:flag providesEvaluateDiscreteStates:flag",
     "Annotations?"},
    {"CoSimulation",
     "modelIdentifier! needsExecutionTool:flag canBeInstantiatedOnlyOncePerProcess:flag canGetAndSetFMUState:flag "
     "canSerializeFMUState:flag providesDirectionalDerivatives:flag providesAdjointDerivatives:flag "
     "providesPerElementDependencies:flag canHandleVariableCommunicationStepSize:flag fixedInternalStepSize:number "
     "maxOutputDerivativeOrder:count recommendedIntermediateInputSmoothness:whole providesIntermediateUpdate:flag "
     "mightReturnEarlyFromDoStep:flag canReturnEarlyAfterIntermediateUpdate:flag hasEventMode:flag "
     "providesEvaluateDiscreteStates:flag",
     "Annotations?"},
    {"ScheduledExecution",
     "modelIdentifier! needsExecutionTool:flag canBeInstantiatedOnlyOncePerProcess:flag canGetAndSetFMUState:flag "
     "canSerializeFMUState:flag providesDirectionalDerivatives:flag providesAdjointDerivatives:flag "
     "providesPerElementDependencies:flag",
     "Annotations?"},

    {"UnitDefinitions", "", "Unit+"},
    {"Unit", "name!", "BaseUnit? DisplayUnit* Annotations?"},
    {"BaseUnit", "kg:whole m:whole s:whole A:whole K:whole mol:whole cd:whole rad:whole factor:number offset:number",
     ""},
    {"DisplayUnit", "name! factor:number offset:number inverse:flag", "Annotations?"},

    {"TypeDefinitions", "",
     "& Float32Type=FloatType* Float64Type=FloatType* Int8Type* UInt8Type* Int16Type* UInt16Type* Int32Type* "
     "UInt32Type* Int64Type* UInt64Type* BooleanType=PlainType* StringType=PlainType* BinaryType* EnumerationType* "
     "ClockType*"},
    {"FloatType",
     "name! description quantity unit displayUnit relativeQuantity:flag unbounded:flag min:number max:number "
     "nominal:number",
     "Annotations?"},
    {"Int8Type", "name! description quantity min:int8 max:int8", "Annotations?"},
    {"UInt8Type", "name! description quantity min:uint8 max:uint8", "Annotations?"},
    {"Int16Type", "name! description quantity min:int16 max:int16", "Annotations?"},
    {"UInt16Type", "name! description quantity min:uint16 max:uint16", "Annotations?"},
    {"Int32Type", "name! description quantity min:whole max:whole", "Annotations?"},
    {"UInt32Type", "name! description quantity min:count max:count", "Annotations?"},
    {"Int64Type", "name! description quantity min:int64 max:int64", "Annotations?"},
    {"UInt64Type", "name! description quantity min:uint64 max:uint64", "Annotations?"},
    {"PlainType", "name! description", "Annotations?"},
    {"BinaryType", "name! description mimeType maxSize:uint64", "Annotations?"},
    {"EnumerationType", "name! description quantity min:int64 max:int64", "Annotations? Item+"},
    {"Item", "name! value:int64! description", "Annotations?"},
    {"ClockType",
     "name! description canBeDeactivated:flag priority:count intervalVariability:interval! intervalDecimal:number "
     "shiftDecimal:number supportsFraction:flag resolution:uint64 intervalCounter:uint64 shiftCounter:uint64",
     "Annotations?"},

    {"LogCategories", "", "Category+"},
    {"Category", "name! description", "Annotations?"},
    {"DefaultExperiment", "startTime:number stopTime:number tolerance:number stepSize:number", "Annotations?"},
    {"Annotations", "", "Annotation+"},
    {"Annotation", "type!", "..."},

    {"ModelVariables", "",
     "& Float32* Float64* Int8* UInt8* Int16* UInt16* Int32* UInt32* Int64* UInt64* Boolean* String* Binary* "
     "Enumeration* Clock*"},
    {"Float32", MEBOTS_VALUED MEBOTS_FLOAT, MEBOTS_INSIDE},
    {"Float64", MEBOTS_VALUED MEBOTS_FLOAT, MEBOTS_INSIDE},
    {"Int8", MEBOTS_VALUED "quantity min:int8 max:int8 start:int8s", MEBOTS_INSIDE},
    {"UInt8", MEBOTS_VALUED "quantity min:uint8 max:uint8 start:uint8s", MEBOTS_INSIDE},
    {"Int16", MEBOTS_VALUED "quantity min:int16 max:int16 start:int16s", MEBOTS_INSIDE},
    {"UInt16", MEBOTS_VALUED "quantity min:uint16 max:uint16 start:uint16s", MEBOTS_INSIDE},
    {"Int32", MEBOTS_VALUED "quantity min:whole max:whole start:wholes", MEBOTS_INSIDE},
    {"UInt32", MEBOTS_VALUED "quantity min:count max:count start:counts", MEBOTS_INSIDE},
    {"Int64", MEBOTS_VALUED "quantity min:int64 max:int64 start:int64s", MEBOTS_INSIDE},
    {"UInt64", MEBOTS_VALUED "quantity min:uint64 max:uint64 start:uint64s", MEBOTS_INSIDE},
    {"Boolean", MEBOTS_VALUED "start:flags", MEBOTS_INSIDE},
    {"String", MEBOTS_VALUED, "Annotations? Dimension* Start* Alias*"},
    {"Binary", MEBOTS_VALUED "mimeType maxSize:uint64", "Annotations? Dimension* Start=HexStart* Alias*"},
    {"Enumeration",
     MEBOTS_EACH "intermediateUpdate:flag previous:count declaredType! initial:initial quantity min:int64 max:int64 "
                 "start:int64s",
     MEBOTS_INSIDE},
    {"Clock",
     MEBOTS_EACH "declaredType canBeDeactivated:flag priority:count intervalVariability:interval! "
                 "intervalDecimal:number shiftDecimal:number supportsFraction:flag resolution:uint64 "
                 "intervalCounter:uint64 shiftCounter:uint64",
     "Annotations? Alias*"},
    {"Dimension", "start:uint64 valueReference:count", ""},
    {"Alias", "name! description displayUnit", ""},
    {"Start", "value", ""},
    {"HexStart", "value:hex", ""},

    {"ModelStructure", "",
     "Output=Unknown* ContinuousStateDerivative=Unknown* ClockedState=Unknown* InitialUnknown=Unknown* "
     "EventIndicator=Unknown*"},
    {"Unknown", "valueReference:count! dependencies:counts dependenciesKind:dependencies", "Annotations?"},

    {"fmiTerminalsAndIcons", "fmiVersion:fmi3!", "GraphicalRepresentation? Terminals? Annotations?"},
    {"GraphicalRepresentation", "", "CoordinateSystem? Icon? Annotations?"},
    {"CoordinateSystem", "x1:number! y1:number! x2:number! y2:number! suggestedScalingFactorTo_mm:number!", ""},
    {"Icon", "x1:number! y1:number! x2:number! y2:number!", ""},
    {"Terminals", "", "Terminal+"},
    {"Terminal", "name! matchingRule! terminalKind description",
     "TerminalMemberVariable* TerminalStreamMemberVariable* Terminal* TerminalGraphicalRepresentation? Annotations?"},
    {"TerminalMemberVariable", "variableName! memberName variableKind!", "Annotations?"},
    {"TerminalStreamMemberVariable",
     "inStreamMemberName! outStreamMemberName! inStreamVariableName! outStreamVariableName!", "Annotations?"},
    {"TerminalGraphicalRepresentation",
     "defaultConnectionColor defaultConnectionStrokeSize:number x1:number! y1:number! x2:number! y2:number! "
     "iconBaseName!",
     "Annotations?"},
};

#undef MEBOTS_EACH
#undef MEBOTS_VALUED
#undef MEBOTS_FLOAT
#undef MEBOTS_INSIDE

}  // namespace

std::span<const RuleRow> fmi3_rule_rows() {
  return kFmi3Rows;
}

}  // namespace mebots::check
