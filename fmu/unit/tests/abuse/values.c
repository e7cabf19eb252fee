/* Arrays that are missing, too long or too short, references that lead nowhere, values that are out
 * of every range: nothing is changed by them. */
#include <math.h>
#include <string.h>

#include "fmi.h"

static void arrays2(void) {
    unsigned references[3] = {GYRO, GYRO + 1, 1000000};
    double values[3] = {1e-6, 1e-6, 1e-6};
    int integers[3] = {0};
    Handle kept = NULL, c = new2(NULL);
    start2(c);
    STATUS(OK, fmi2.GetFMUstate(c, &kept));
#define AGAIN2(call) \
    do { \
        STATUS(ERROR, call); \
        STATUS(OK, fmi2.SetFMUstate(c, kept)); \
    } while (0)
    /* Nothing to do is nothing wrong. */
    STATUS(OK, fmi2.GetReal(c, NULL, 0, NULL));
    STATUS(OK, fmi2.SetReal(c, NULL, 0, NULL));
    STATUS(OK, fmi2.SetInteger(c, references, 0, integers));
    STATUS(OK, fmi2.GetBoolean(c, NULL, 0, integers));
    AGAIN2(fmi2.GetReal(c, NULL, 1, values));
    AGAIN2(fmi2.GetReal(c, references, 1, NULL));
    AGAIN2(fmi2.SetReal(c, NULL, 1, values));
    AGAIN2(fmi2.SetReal(c, references, 1, NULL));
    AGAIN2(fmi2.SetInteger(c, references, 1, NULL));
    AGAIN2(fmi2.GetReal(c, references, SIZE_MAX, values));
    AGAIN2(fmi2.SetReal(c, references, SIZE_MAX / 8, values));
    AGAIN2(fmi2.GetReal(c, references, (size_t)1 << 40, values));
    AGAIN2(fmi2.SetBoolean(c, references, SLOTS + 1, integers));
    AGAIN2(fmi2.GetReal(c, references, 3, values));
    AGAIN2(fmi2.SetReal(c, references, 3, values));
    AGAIN2(fmi2.GetInteger(c, references, 1, integers));
    AGAIN2(fmi2.SetBoolean(c, references, 1, integers));
    AGAIN2(fmi2.GetString(c, references, 1, NULL));
    AGAIN2(fmi2.SetString(c, references, 1, NULL));
    references[0] = UINT32_MAX;
    AGAIN2(fmi2.GetReal(c, references, 1, values));
    references[0] = SLOTS;
    AGAIN2(fmi2.SetReal(c, references, 1, values));
    references[0] = LATITUDE; /* an output */
    AGAIN2(fmi2.SetReal(c, references, 1, values));
    references[0] = SITE_LATITUDE; /* a parameter, after initialization */
    AGAIN2(fmi2.SetReal(c, references, 1, values));
    AGAIN2(fmi2.SetupExperiment(c, 0, 0.0, 0.0, 0, 0.0));
    fmi2.FreeInstance(c);
}

static void arrays3(void) {
    const unsigned references[2] = {GYRO, ACCELEROMETER};
    unsigned bad = GYRO + 1;
    double values[7] = {0};
    float few[1] = {0};
    size_t size[2];
    unsigned independent;
    int kind;
    const char *text = "x";
    const uint8_t *binary = NULL;
    Handle kept = NULL, i = new3(NULL, false);
    start3(i, false);
    STATUS(OK, fmi3.GetFMUState(i, &kept));
#define AGAIN3(call) \
    do { \
        STATUS(ERROR, call); \
        STATUS(OK, fmi3.SetFMUState(i, kept)); \
    } while (0)
    STATUS(OK, fmi3.GetFloat64(i, NULL, 0, NULL, 0));
    STATUS(OK, fmi3.SetFloat64(i, NULL, 0, NULL, 0));
    STATUS(OK, fmi3.GetFloat64(i, references, 2, values, 6));
    for (size_t wrong = 0; wrong < 8; wrong++) {
        if (wrong == 6) continue;
        AGAIN3(fmi3.GetFloat64(i, references, 2, values, wrong));
        AGAIN3(fmi3.SetFloat64(i, references, 2, values, wrong));
    }
    AGAIN3(fmi3.GetFloat64(i, NULL, 2, values, 6));
    AGAIN3(fmi3.GetFloat64(i, references, 2, NULL, 6));
    AGAIN3(fmi3.SetFloat64(i, NULL, 0, values, 6));
    AGAIN3(fmi3.GetFloat64(i, references, SIZE_MAX, values, 6));
    AGAIN3(fmi3.GetFloat64(i, references, 2, values, SIZE_MAX));
    AGAIN3(fmi3.SetFloat64(i, references, SIZE_MAX / 2, values, SIZE_MAX / 2));
    AGAIN3(fmi3.GetFloat64(i, &bad, 1, values, 1)); /* the second element is no variable */
    bad = UINT32_MAX;
    AGAIN3(fmi3.SetFloat64(i, &bad, 1, values, 1));
    AGAIN3(fmi3.GetFloat32(i, references, 1, few, 1));
    AGAIN3(fmi3.SetFloat32(i, references, 1, few, 1));
    AGAIN3(fmi3.GetUInt64(i, references, 1, (uint64_t *)values, 3));
    AGAIN3(fmi3.SetInt32(i, references, 1, (int32_t *)values, 3));
    AGAIN3(fmi3.SetInt8(i, references, 1, (int8_t *)values, 3));
    AGAIN3(fmi3.SetString(i, references, 1, &text, 1));
    AGAIN3(fmi3.GetBinary(i, references, 1, size, &binary, 1));
    AGAIN3(fmi3.GetNumberOfVariableDependencies(i, UINT32_MAX, size));
    AGAIN3(fmi3.GetNumberOfVariableDependencies(i, LATITUDE, NULL));
    AGAIN3(fmi3.GetVariableDependencies(i, LATITUDE, size, &independent, size, &kind, 1));
    STATUS(OK, fmi3.GetVariableDependencies(i, LATITUDE, NULL, NULL, NULL, NULL, 0));
    AGAIN3(fmi3.GetClock(i, references, 1, NULL));
    fmi3.FreeInstance(i);
}

/* Refused values change nothing: the run goes on as if they had never been. */
static void refused(void) {
    static const double no_numbers[] = {NAN, INFINITY, -INFINITY};
    const unsigned steps = 450;
    Heard heard = {0};
    Handle c = new2(&heard), i = new3(&heard, false);
    start2(c);
    start3(i, false);
    for (unsigned k = 1; k <= steps; k++) {
        STATUS(OK, set_sample2(c, k));
        STATUS(OK, set_sample3(i, k));
        double bad = no_numbers[k % 3];
        unsigned reals[3] = {GYRO + k % 3, ACCELEROMETER, GIMBAL_ROLL};
        double mixed[3] = {0.001, bad, 0.1};
        STATUS(DISCARD, fmi2.SetReal(c, reals, 3, mixed));
        mixed[1] = 0.01, mixed[2] = 17.0; /* beyond the encoders */
        STATUS(DISCARD, fmi2.SetReal(c, reals, 3, mixed));
        heard.text[0] = 0;
        double row[3] = {bad, 0, 0};
        unsigned gyro = GYRO;
        STATUS(DISCARD, fmi3.SetFloat64(i, &gyro, 1, row, 3));
        EXPECT(strstr(heard.text, "gyro.delta_theta[1] can't be") != NULL);
        unsigned kind = REFERENCE_KIND, valid = IMU_VALID, status = IMU_STATUS, count = IMU_SEQUENCE;
        int three = 3, minus = -1, many = 65536;
        STATUS(DISCARD, fmi2.SetInteger(c, &kind, 1, &three));
        STATUS(DISCARD, fmi2.SetInteger(c, &kind, 1, &minus));
        STATUS(DISCARD, fmi2.SetInteger(c, &status, 1, &many));
        STATUS(DISCARD, fmi2.SetBoolean(c, &valid, 1, &minus));
        static const double fractions[4] = {0.5, -1.0, 1e16, NAN};
        STATUS(DISCARD, fmi2.SetReal(c, &count, 1, &fractions[k % 4]));
        int64_t far = (int64_t)1 << 32;
        uint8_t two = 2;
        STATUS(DISCARD, fmi3.SetInt64(i, &kind, 1, &far, 1));
        STATUS(DISCARD, fmi3.SetBoolean(i, &valid, 1, &two, 1));
        STATUS(OK, fmi2.DoStep(c, (k - 1) * PERIOD, PERIOD, 1));
        bool flag;
        double last;
        STATUS(OK, fmi3.DoStep(i, (k - 1) * PERIOD, PERIOD, true, &flag, &flag, &flag, &last));
        EXPECT(last == k * PERIOD);
    }
    uint64_t expected = undisturbed(steps);
    EXPECT(outputs2(c) == expected);
    EXPECT(outputs3(i) == expected);
    fmi2.FreeInstance(c);
    fmi3.FreeInstance(i);
}

/* References may be no numbers: the core answers for them. */
static void references(void) {
    const unsigned velocity[3] = {REFERENCE_VELOCITY, REFERENCE_VELOCITY + 1, REFERENCE_VELOCITY + 2};
    const double no_numbers[3] = {NAN, INFINITY, 0};
    const unsigned health = HEALTH;
    int flags = 0;
    Handle c = new2(NULL);
    start2(c);
    STATUS(OK, fmi2.SetReal(c, velocity, 3, no_numbers));
    for (unsigned k = 1; k <= 200; k++) STATUS(OK, step2(c, k));
    STATUS(OK, fmi2.GetInteger(c, &health, 1, &flags));
    EXPECT(flags & 1024); /* kept out */
    fmi2.FreeInstance(c);
}

/* Parameters that contradict themselves: the end of the initialization says so, and after a reset it
 * can be tried again. */
static void parameters(void) {
    Heard heard = {0};
    const unsigned method = ALIGNMENT_METHOD, duration = ALIGNMENT_DURATION;
    const double forever = 1e6;
    const int coarse = 1;
    Handle c = new2(&heard);
    STATUS(OK, fmi2.SetInteger(c, &method, 1, &coarse));
    STATUS(OK, fmi2.SetReal(c, &duration, 1, &forever));
    STATUS(OK, fmi2.SetupExperiment(c, 0, 0.0, 0.0, 0, 0.0));
    STATUS(OK, fmi2.EnterInitializationMode(c));
    STATUS(ERROR, fmi2.ExitInitializationMode(c));
    EXPECT(strstr(heard.text, "the alignment takes 1000000 s") != NULL);
    STATUS(ERROR, fmi2.DoStep(c, 0.0, PERIOD, 1));
    STATUS(OK, fmi2.Reset(c));
    start2(c);
    STATUS(OK, step2(c, 1));
    fmi2.FreeInstance(c);
}

void abuse_values(void) {
    arrays2();
    arrays3();
    refused();
    references();
    parameters();
}
