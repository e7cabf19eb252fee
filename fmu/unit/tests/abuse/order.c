/* Every function in every state, against the tables of the standards (FMI 2.0.5, 4.2.4; FMI 3.0.2,
 * 2.3 and 4.2). */
#include <stdio.h>
#include <string.h>

#include "fmi.h"

/* What a function is to answer: k OK, d Discard, e Error. */
static void compare(char expected, int found, const char *function, const char *state) {
    int status = expected == 'k' ? OK : expected == 'd' ? DISCARD : ERROR;
    if (found != status) {
        printf("%s %s: status %d expected, %d found\n", function, state, status, found);
        failures++;
    }
}

static const char *const states2[] = {
    "when instantiated", "in initialization mode", "when a step is complete", "when a step has failed",
    "when terminated", "after an error"};

/* An instance in one of these states; `kept` is a state that it has kept when instantiated. */
static Handle reach2(int state, Handle *kept) {
    Handle c = new2(NULL);
    *kept = NULL;
    STATUS(OK, fmi2.GetFMUstate(c, kept));
    if (state == 0) return c;
    STATUS(OK, fmi2.SetupExperiment(c, 0, 0.0, 0.0, 0, 0.0));
    STATUS(OK, fmi2.EnterInitializationMode(c));
    if (state == 1) return c;
    STATUS(OK, fmi2.ExitInitializationMode(c));
    if (state == 3) STATUS(DISCARD, fmi2.DoStep(c, 0.0, 2 * PERIOD, 1));
    if (state == 4) STATUS(OK, fmi2.Terminate(c));
    if (state == 5) STATUS(ERROR, fmi2.ExitInitializationMode(c));
    return c;
}

typedef struct {
    Handle c, kept;
} At;

#define CALL(Name, ...) \
    static int call_##Name(At at) { return fmi2.Name(at.c, ##__VA_ARGS__); }
static const unsigned gyro = GYRO, mode_reference = MODE, valid = IMU_VALID, period = IMU_PERIOD;
static const double one = 1e-6, seconds = 1e7;
static double got;
static int got_integer;
static const char *got_text;
static size_t got_size;
static char bytes[65536];
static bool flag;
CALL(SetDebugLogging, 1, 0, NULL)
CALL(SetupExperiment, 0, 0.0, 0.0, 0, 0.0)
CALL(EnterInitializationMode)
CALL(ExitInitializationMode)
CALL(Terminate)
CALL(Reset)
CALL(GetReal, &gyro, 1, &got)
CALL(GetInteger, &mode_reference, 1, &got_integer)
CALL(GetBoolean, &valid, 1, &got_integer)
CALL(GetString, NULL, 0, &got_text)
CALL(SetReal, &gyro, 1, &one)
CALL(SetBoolean, &valid, 1, &got_integer)
CALL(SetString, NULL, 0, NULL)
CALL(SetFMUstate, at.kept)
CALL(SerializedFMUstateSize, at.kept, &got_size)
CALL(SerializeFMUstate, at.kept, bytes, sizeof bytes)
CALL(GetDirectionalDerivative, &gyro, 1, &gyro, 1, &one, &got)
CALL(SetRealInputDerivatives, &gyro, 1, &got_integer, &one)
CALL(GetRealOutputDerivatives, &gyro, 1, &got_integer, &got)
CALL(DoStep, 0.0, PERIOD, 1)
CALL(CancelStep)
CALL(GetStatus, 0, &got_integer)
CALL(GetRealStatus, 2, &got)
CALL(GetIntegerStatus, 0, &got_integer)
CALL(GetBooleanStatus, 3, &got_integer)
CALL(GetStringStatus, 1, &got_text)
CALL(EnterEventMode)
CALL(NewDiscreteStates, NULL)
CALL(EnterContinuousTimeMode)
CALL(CompletedIntegratorStep, 1, NULL, NULL)
CALL(SetTime, 0.0)
CALL(SetContinuousStates, NULL, 0)
CALL(GetDerivatives, NULL, 0)
CALL(GetEventIndicators, NULL, 0)
CALL(GetContinuousStates, NULL, 0)
CALL(GetNominalsOfContinuousStates, NULL, 0)

static int call_SetParameter(At at) { return fmi2.SetReal(at.c, &period, 1, &seconds); }
static int call_GetFMUstate(At at) {
    Handle state = NULL;
    return fmi2.GetFMUstate(at.c, &state);
}
static int call_FreeFMUstate(At at) {
    Handle state = at.kept;
    return fmi2.FreeFMUstate(at.c, &state);
}
static int call_DeSerializeFMUstate(At at) {
    Handle state = NULL;
    size_t size = 0;
    Handle other_kept, other = reach2(0, &other_kept);
    STATUS(OK, fmi2.SerializedFMUstateSize(other, other_kept, &size));
    EXPECT(size <= sizeof bytes);
    STATUS(OK, fmi2.SerializeFMUstate(other, other_kept, bytes, sizeof bytes));
    fmi2.FreeInstance(other);
    return fmi2.DeSerializeFMUstate(at.c, bytes, size, &state);
}

/* A letter for each of the states above. A setter of an input is allowed before initialization, too:
 * FMI 2.0 leaves it open whether inputs have a start value that counts there, and importers set it. */
#define ROW(Name, Letters) {#Name, call_##Name, Letters}
static const struct {
    const char *name;
    int (*call)(At);
    const char *expected;
} table2[] = {
    ROW(SetDebugLogging, "kkkkkk"),
    ROW(SetupExperiment, "keeeee"),
    ROW(EnterInitializationMode, "eeeeee"), /* without an experiment */
    ROW(ExitInitializationMode, "ekeeee"),
    ROW(Terminate, "eekkee"),
    ROW(Reset, "kkkkkk"),
    ROW(GetReal, "ekkkkk"),
    ROW(GetInteger, "ekkkkk"),
    ROW(GetBoolean, "ekkkkk"),
    ROW(GetString, "ekkkkk"),
    ROW(SetReal, "kkkeee"),
    ROW(SetBoolean, "kkkeee"),
    ROW(SetString, "kkkeee"),
    ROW(SetParameter, "kkeeee"),
    ROW(GetFMUstate, "kkkkkk"),
    ROW(SetFMUstate, "kkkkkk"),
    ROW(FreeFMUstate, "kkkkkk"),
    ROW(SerializedFMUstateSize, "kkkkkk"),
    ROW(SerializeFMUstate, "kkkkkk"),
    ROW(DeSerializeFMUstate, "kkkkkk"),
    ROW(GetDirectionalDerivative, "eeeeee"),
    ROW(SetRealInputDerivatives, "eeeeee"),
    ROW(GetRealOutputDerivatives, "eeeeee"),
    ROW(DoStep, "eekeee"),
    ROW(CancelStep, "eeeeee"),
    ROW(GetStatus, "eeddde"),
    ROW(GetRealStatus, "eekkke"),
    ROW(GetIntegerStatus, "eeddde"),
    ROW(GetBooleanStatus, "eekkke"),
    ROW(GetStringStatus, "eeddde"),
    ROW(EnterEventMode, "eeeeee"),
    ROW(NewDiscreteStates, "eeeeee"),
    ROW(EnterContinuousTimeMode, "eeeeee"),
    ROW(CompletedIntegratorStep, "eeeeee"),
    ROW(SetTime, "eeeeee"),
    ROW(SetContinuousStates, "eeeeee"),
    ROW(GetDerivatives, "eeeeee"),
    ROW(GetEventIndicators, "eeeeee"),
    ROW(GetContinuousStates, "eeeeee"),
    ROW(GetNominalsOfContinuousStates, "eeeeee"),
};

void abuse_order2(void) {
    for (size_t row = 0; row < sizeof table2 / sizeof *table2; row++) {
        for (int state = 0; state < 6; state++) {
            At at;
            at.c = reach2(state, &at.kept);
            got_integer = 0;
            int found = table2[row].call(at);
            compare(table2[row].expected[state], found, table2[row].name, states2[state]);
            /* After an error nothing but a kept state, a reset or the end leads on. */
            if (found == ERROR) {
                STATUS(ERROR, fmi2.DoStep(at.c, 0.0, PERIOD, 1));
                STATUS(OK, fmi2.SetFMUstate(at.c, at.kept));
                STATUS(OK, fmi2.SetupExperiment(at.c, 0, 0.0, 0.0, 0, 0.0));
            }
            fmi2.FreeInstance(at.c);
        }
    }
}

static const char *const states3[] = {
    "when instantiated", "in initialization mode", "in step mode", "in event mode", "when terminated",
    "after an error"};

static Handle reach3(int state, Handle *kept) {
    Handle i = new3(NULL, state == 3);
    *kept = NULL;
    STATUS(OK, fmi3.GetFMUState(i, kept));
    if (state == 0) return i;
    STATUS(OK, fmi3.EnterInitializationMode(i, false, 0.0, 0.0, false, 0.0));
    if (state == 1) return i;
    STATUS(OK, fmi3.ExitInitializationMode(i));
    if (state == 4) STATUS(OK, fmi3.Terminate(i));
    if (state == 5) STATUS(ERROR, fmi3.ExitInitializationMode(i));
    return i;
}

#define CALL3(Name, ...) \
    static int call3_##Name(At at) { return fmi3.Name(at.c, ##__VA_ARGS__); }
static const unsigned latitude = LATITUDE;
static const uint64_t nanoseconds = 10000000;
static int64_t got_wide;
static uint64_t got_whole;
static double three[3];
static int kind;
static unsigned got_reference;
CALL3(SetDebugLogging, true, 0, NULL)
CALL3(EnterInitializationMode, false, 0.0, 0.0, false, 0.0)
CALL3(ExitInitializationMode)
CALL3(EnterEventMode)
CALL3(EnterStepMode)
CALL3(Terminate)
CALL3(Reset)
CALL3(GetFloat64, &gyro, 1, three, 3)
CALL3(SetFloat64, &gyro, 1, three, 3)
CALL3(GetInt64, &mode_reference, 1, &got_wide, 1)
CALL3(GetUInt64, &period, 1, &got_whole, 1)
CALL3(SetUInt64, &period, 1, &nanoseconds, 1)
CALL3(GetFloat32, NULL, 0, NULL, 0)
CALL3(SetFloat32, NULL, 0, NULL, 0)
CALL3(GetInt8, NULL, 0, NULL, 0)
CALL3(SetUInt8, NULL, 0, NULL, 0)
CALL3(GetInt16, NULL, 0, NULL, 0)
CALL3(SetUInt16, NULL, 0, NULL, 0)
CALL3(GetUInt32, NULL, 0, NULL, 0)
CALL3(GetString, NULL, 0, NULL, 0)
CALL3(SetString, NULL, 0, NULL, 0)
CALL3(GetBinary, NULL, 0, NULL, NULL, 0)
CALL3(SetBinary, NULL, 0, NULL, NULL, 0)
CALL3(GetClock, NULL, 0, NULL)
CALL3(SetClock, NULL, 0, NULL)
CALL3(GetIntervalDecimal, NULL, 0, NULL, NULL)
CALL3(GetIntervalFraction, NULL, 0, NULL, NULL, NULL)
CALL3(GetShiftDecimal, NULL, 0, NULL)
CALL3(GetShiftFraction, NULL, 0, NULL, NULL)
CALL3(SetIntervalDecimal, NULL, 0, NULL)
CALL3(SetIntervalFraction, NULL, 0, NULL, NULL)
CALL3(SetShiftDecimal, NULL, 0, NULL)
CALL3(SetShiftFraction, NULL, 0, NULL, NULL)
CALL3(GetNumberOfVariableDependencies, latitude, &got_size)
CALL3(GetVariableDependencies, latitude, &got_size, &got_reference, &got_size, &kind, 0)
CALL3(SetFMUState, at.kept)
CALL3(SerializedFMUStateSize, at.kept, &got_size)
CALL3(SerializeFMUState, at.kept, (uint8_t *)bytes, sizeof bytes)
CALL3(GetDirectionalDerivative, &gyro, 1, &gyro, 1, &one, 1, &got, 1)
CALL3(GetAdjointDerivative, &gyro, 1, &gyro, 1, &one, 1, &got, 1)
CALL3(EnterConfigurationMode)
CALL3(ExitConfigurationMode)
CALL3(EvaluateDiscreteStates)
CALL3(UpdateDiscreteStates, &flag, &flag, &flag, &flag, &flag, &got)
CALL3(EnterContinuousTimeMode)
CALL3(CompletedIntegratorStep, true, &flag, &flag)
CALL3(SetTime, 0.0)
CALL3(SetContinuousStates, NULL, 0)
CALL3(GetContinuousStateDerivatives, NULL, 0)
CALL3(GetEventIndicators, NULL, 0)
CALL3(GetContinuousStates, NULL, 0)
CALL3(GetNominalsOfContinuousStates, NULL, 0)
CALL3(GetNumberOfEventIndicators, &got_size)
CALL3(GetNumberOfContinuousStates, &got_size)
CALL3(GetOutputDerivatives, &gyro, 1, &kind, &got, 1)
CALL3(DoStep, 0.0, PERIOD, true, &flag, &flag, &flag, &got)
CALL3(ActivateModelPartition, gyro, 0.0)

static int call3_GetFMUState(At at) {
    Handle state = NULL;
    return fmi3.GetFMUState(at.c, &state);
}
static int call3_FreeFMUState(At at) {
    Handle state = at.kept;
    return fmi3.FreeFMUState(at.c, &state);
}
static int call3_DeserializeFMUState(At at) {
    Handle state = NULL;
    size_t size = 0;
    Handle other_kept, other = reach3(0, &other_kept);
    STATUS(OK, fmi3.SerializedFMUStateSize(other, other_kept, &size));
    STATUS(OK, fmi3.SerializeFMUState(other, other_kept, (uint8_t *)bytes, sizeof bytes));
    fmi3.FreeInstance(other);
    return fmi3.DeserializeFMUState(at.c, (uint8_t *)bytes, size, &state);
}

#define ROW3(Name, Letters) {#Name, call3_##Name, Letters}
static const struct {
    const char *name;
    int (*call)(At);
    const char *expected;
} table3[] = {
    ROW3(SetDebugLogging, "kkkkkk"),
    ROW3(EnterInitializationMode, "keeeee"),
    ROW3(ExitInitializationMode, "ekeeee"),
    ROW3(EnterEventMode, "eeeeee"), /* step mode without events */
    ROW3(EnterStepMode, "eeekee"),
    ROW3(Terminate, "eekkee"),
    ROW3(Reset, "kkkkkk"),
    ROW3(GetFloat64, "kkkkkk"),
    ROW3(SetFloat64, "kkkkee"),
    ROW3(GetInt64, "kkkkkk"),
    ROW3(GetUInt64, "kkkkkk"),
    ROW3(SetUInt64, "kkeeee"),
    ROW3(GetFloat32, "kkkkkk"),
    ROW3(SetFloat32, "kkkkee"),
    ROW3(GetInt8, "kkkkkk"),
    ROW3(SetUInt8, "kkkkee"),
    ROW3(GetInt16, "kkkkkk"),
    ROW3(SetUInt16, "kkkkee"),
    ROW3(GetUInt32, "kkkkkk"),
    ROW3(GetString, "kkkkkk"),
    ROW3(SetString, "kkkkee"),
    ROW3(GetBinary, "kkkkkk"),
    ROW3(SetBinary, "kkkkee"),
    ROW3(GetClock, "ekekee"),
    ROW3(SetClock, "ekekee"),
    ROW3(GetIntervalDecimal, "ekekee"),
    ROW3(GetIntervalFraction, "ekekee"),
    ROW3(GetShiftDecimal, "ekekee"),
    ROW3(GetShiftFraction, "ekekee"),
    ROW3(SetIntervalDecimal, "ekekee"),
    ROW3(SetIntervalFraction, "ekekee"),
    ROW3(SetShiftDecimal, "ekekee"),
    ROW3(SetShiftFraction, "ekekee"),
    ROW3(GetNumberOfVariableDependencies, "kkkkkk"),
    ROW3(GetVariableDependencies, "kkkkkk"),
    ROW3(GetFMUState, "kkkkkk"),
    ROW3(SetFMUState, "kkkkkk"),
    ROW3(FreeFMUState, "kkkkkk"),
    ROW3(SerializedFMUStateSize, "kkkkkk"),
    ROW3(SerializeFMUState, "kkkkkk"),
    ROW3(DeserializeFMUState, "kkkkkk"),
    ROW3(GetDirectionalDerivative, "eeeeee"),
    ROW3(GetAdjointDerivative, "eeeeee"),
    ROW3(EnterConfigurationMode, "eeeeee"),
    ROW3(ExitConfigurationMode, "eeeeee"),
    ROW3(EvaluateDiscreteStates, "eeekee"),
    ROW3(UpdateDiscreteStates, "eeekee"),
    ROW3(EnterContinuousTimeMode, "eeeeee"),
    ROW3(CompletedIntegratorStep, "eeeeee"),
    ROW3(SetTime, "eeeeee"),
    ROW3(SetContinuousStates, "eeeeee"),
    ROW3(GetContinuousStateDerivatives, "eeeeee"),
    ROW3(GetEventIndicators, "eeeeee"),
    ROW3(GetContinuousStates, "eeeeee"),
    ROW3(GetNominalsOfContinuousStates, "eeeeee"),
    ROW3(GetNumberOfEventIndicators, "eeeeee"),
    ROW3(GetNumberOfContinuousStates, "eeeeee"),
    ROW3(GetOutputDerivatives, "eeeeee"),
    ROW3(DoStep, "eekeee"),
    ROW3(ActivateModelPartition, "eeeeee"),
};

void abuse_order3(void) {
    for (size_t row = 0; row < sizeof table3 / sizeof *table3; row++) {
        for (int state = 0; state < 6; state++) {
            At at;
            at.c = reach3(state, &at.kept);
            kind = 1;
            int found = table3[row].call(at);
            compare(table3[row].expected[state], found, table3[row].name, states3[state]);
            if (found == ERROR) {
                STATUS(ERROR, fmi3.ExitInitializationMode(at.c));
                STATUS(OK, fmi3.Reset(at.c));
                STATUS(OK, fmi3.EnterInitializationMode(at.c, false, 0.0, 0.0, false, 0.0));
            }
            fmi3.FreeInstance(at.c);
        }
    }
    /* Event mode, there and back. */
    Handle i = new3(NULL, true);
    start3(i, true);
    STATUS(OK, fmi3.EnterEventMode(i));
    STATUS(OK, set_sample3(i, 1));
    STATUS(ERROR, fmi3.UpdateDiscreteStates(i, NULL, NULL, NULL, NULL, NULL, NULL));
    fmi3.FreeInstance(i);
}
