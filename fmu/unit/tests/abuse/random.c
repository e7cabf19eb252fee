/* Calls in random order with arguments from a chest of good and bad ones. No answer is foreseen but
 * that there is one, that no instance dies, and that a reset makes all good again. */
#include <math.h>
#include <string.h>

#include "fmi.h"

static uint64_t dice = 20260101;
#define PICK(list) ((list)[next_random(&dice) % (sizeof(list) / sizeof *(list))])

static const double numbers[] = {
    0.0, -0.0, PERIOD, 1e-6, -1e-6, 1.0, 2.0, 1e9, 5e6, -1.0, NAN, INFINITY, -INFINITY, 1e300, 5e-324,
    4294967296.0, 9007199254740993.0, 0.5};
static const int integers[] = {0, 1, 2, 3, -1, 7, 65535, 65536, INT32_MAX, INT32_MIN};
static const size_t sizes[] = {0, 1, 2, 3, 4, 8, 9, SLOTS, SLOTS + 1, SIZE_MAX, SIZE_MAX / 8};

static unsigned reference(void) {
    static const unsigned all[] = {
        0, GYRO, GYRO + 1, ACCELEROMETER, IMU_VALID, IMU_STATUS, IMU_SEQUENCE, REFERENCE_KIND,
        REFERENCE_VELOCITY, MODE, LATITUDE, PARAMETERS, IMU_PERIOD, SITE_LATITUDE, ALIGNMENT_METHOD,
        ALIGNMENT_DURATION, SLOTS - 1, SLOTS, UINT32_MAX};
    return next_random(&dice) % 3 ? PICK(all) : next_random(&dice) % SLOTS;
}

/* Status of one random call. */
static int random2(Handle c, Handle *states, double *time) {
    unsigned references[8];
    double reals[8];
    int wholes[8];
    char bytes[64] = {0};
    const char *texts[2] = {"logAll", "logNonsense"};
    size_t size = PICK(sizes);
    for (int n = 0; n < 8; n++) {
        references[n] = reference();
        reals[n] = PICK(numbers);
        wholes[n] = PICK(integers);
    }
    size_t few = next_random(&dice) % 9;
    /* Sizes beyond the arrays are refused at a glance; those between would be a lie. */
    size_t count = size > SLOTS ? size : few;
    const unsigned *vr = next_random(&dice) % 16 ? references : NULL;
    int slot = next_random(&dice) % 4;
    switch (next_random(&dice) % 32) {
    case 0: return fmi2.SetupExperiment(c, 0, 0.0, 0.0, 0, reals[0]);
    case 1: return fmi2.EnterInitializationMode(c);
    case 2: return fmi2.ExitInitializationMode(c);
    case 3: return next_random(&dice) % 8 ? OK : fmi2.Terminate(c);
    case 4: *time = 0.0; return fmi2.Reset(c);
    case 5: case 6: return fmi2.GetReal(c, vr, count, vr ? reals : NULL);
    case 7: return fmi2.GetInteger(c, vr, count, wholes);
    case 8: return fmi2.GetBoolean(c, vr, count, wholes);
    case 9: case 10: return fmi2.SetReal(c, vr, count, reals);
    case 11: return fmi2.SetInteger(c, vr, count, wholes);
    case 12: return fmi2.SetBoolean(c, vr, count, wholes);
    case 13: return fmi2.GetString(c, vr, count, NULL);
    case 14: return fmi2.GetFMUstate(c, &states[slot]);
    case 15: return fmi2.SetFMUstate(c, states[slot]);
    case 16: return fmi2.FreeFMUstate(c, &states[slot]);
    case 17: return fmi2.SerializedFMUstateSize(c, states[slot], &size);
    case 18: return fmi2.SerializeFMUstate(c, states[slot], bytes, sizeof bytes);
    case 19: return fmi2.DeSerializeFMUstate(c, bytes, sizeof bytes, &states[slot]);
    case 20: return fmi2.SetDebugLogging(c, slot & 1, few % 3, texts);
    case 21: return fmi2.GetRealStatus(c, wholes[0], reals);
    case 22: return fmi2.GetStatus(c, wholes[0], NULL);
    case 23: return fmi2.DoStep(c, reals[0], reals[1], wholes[0]);
    case 24: return fmi2.GetDirectionalDerivative(c, vr, count, vr, count, reals, reals);
    case 25: return fmi2.CompletedIntegratorStep(c, 1, NULL, NULL);
    case 26: return fmi2.SetRealInputDerivatives(c, vr, count, wholes, reals);
    case 27: return fmi2.NewDiscreteStates(c, NULL);
    default: {
        const unsigned now = 0;
        double at;
        if (fmi2.GetReal(c, &now, 1, &at) == OK) *time = at;
        return fmi2.DoStep(c, *time, PERIOD, 1);
    }
    }
}

static int random3(Handle i, Handle *states) {
    unsigned references[8];
    double reals[64];
    int32_t wholes[64];
    int64_t wide[64];
    uint8_t small[64];
    bool flag;
    size_t size = PICK(sizes);
    for (int n = 0; n < 64; n++) {
        if (n < 8) references[n] = reference();
        reals[n] = PICK(numbers);
        wholes[n] = PICK(integers);
        wide[n] = wholes[n] * (int64_t)(n % 2 ? 1 : 1 << 20);
        small[n] = (uint8_t)wholes[n];
    }
    size_t count = next_random(&dice) % 9, values = next_random(&dice) % 65;
    if (size > SLOTS) *(next_random(&dice) % 2 ? &count : &values) = size;
    int slot = next_random(&dice) % 4;
    switch (next_random(&dice) % 32) {
    case 0: return fmi3.EnterInitializationMode(i, false, 0.0, 0.0, false, reals[0]);
    case 1: return fmi3.ExitInitializationMode(i);
    case 2: return fmi3.EnterEventMode(i);
    case 3: return fmi3.EnterStepMode(i);
    case 4: return fmi3.Reset(i);
    case 5: return next_random(&dice) % 8 ? OK : fmi3.Terminate(i);
    case 6: return fmi3.GetFloat64(i, references, count, reals, values);
    case 7: return fmi3.SetFloat64(i, references, count, reals, values);
    case 8: return fmi3.SetFloat64(i, references, 1, reals, 1);
    case 9: return fmi3.GetInt32(i, references, count, wholes, values);
    case 10: return fmi3.SetInt32(i, references, 1, wholes, 1);
    case 11: return fmi3.GetInt64(i, references, 1, wide, 1);
    case 12: return fmi3.SetInt64(i, references, 1, wide, 1);
    case 13: return fmi3.SetUInt64(i, references, 1, (uint64_t *)wide, 1);
    case 14: return fmi3.GetBoolean(i, references, count, small, values);
    case 15: return fmi3.SetBoolean(i, references, 1, small, 1);
    case 16: return fmi3.SetInt16(i, references, count, NULL, values);
    case 17: return fmi3.GetFMUState(i, &states[slot]);
    case 18: return fmi3.SetFMUState(i, states[slot]);
    case 19: return fmi3.FreeFMUState(i, &states[slot]);
    case 20: return fmi3.SerializeFMUState(i, states[slot], small, sizeof small);
    case 21: return fmi3.DeserializeFMUState(i, small, sizeof small, &states[slot]);
    case 22: return fmi3.GetNumberOfVariableDependencies(i, references[0], &size);
    case 23: return fmi3.UpdateDiscreteStates(i, &flag, &flag, &flag, &flag, &flag, reals);
    case 24: return fmi3.DoStep(i, reals[0], reals[1], true, &flag, &flag, &flag, reals + 2);
    case 25: return fmi3.GetClock(i, references, count % 2, NULL);
    case 26: return fmi3.EnterConfigurationMode(i);
    default: {
        const unsigned now = 0;
        double at = 0;
        if (fmi3.GetFloat64(i, &now, 1, &at, 1) != OK) at = 0;
        return fmi3.DoStep(i, at, PERIOD, true, &flag, &flag, &flag, reals);
    }
    }
}

void abuse_randomly(unsigned calls) {
    int seen[5] = {0};
    Heard heard = {0};
    for (int standard = 2; standard <= 3; standard++) {
        Handle states[4] = {NULL}, other_states[4] = {NULL};
        Handle h = standard == 2 ? new2(&heard) : new3(&heard, true);
        double time = 0.0;
        for (unsigned n = 0; n < calls; n++) {
            Handle *chest = next_random(&dice) % 64 ? states : other_states;
            int status = standard == 2 ? random2(h, chest, &time) : random3(h, chest);
            EXPECT(status >= OK && status < FATAL);
            if (status >= OK && status <= FATAL) seen[status]++;
            /* Errors are frequent: most of the time the life after them is looked at from anew. */
            if (status == ERROR && next_random(&dice) % 4) {
                STATUS(OK, standard == 2 ? fmi2.Reset(h) : fmi3.Reset(h));
                if (next_random(&dice) % 4) {
                    standard == 2 ? start2(h) : start3(h, true);
                    time = 0.0;
                }
            }
        }
        /* As if nothing had been. */
        STATUS(OK, standard == 2 ? fmi2.Reset(h) : fmi3.Reset(h));
        standard == 2 ? start2(h) : start3(h, true);
        for (unsigned k = 1; k <= 250; k++) STATUS(OK, standard == 2 ? step2(h, k) : step3(h, k));
        EXPECT((standard == 2 ? outputs2(h) : outputs3(h)) == undisturbed(250));
        standard == 2 ? fmi2.FreeInstance(h) : fmi3.FreeInstance(h);
    }
    /* The dice are fair: every kind of answer was given. */
    EXPECT(seen[OK] > 0 && seen[DISCARD] > 0 && seen[ERROR] > 0 && heard.count > 0);
}
