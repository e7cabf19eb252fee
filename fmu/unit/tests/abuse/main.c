/* Calls the interface of both standards as a hostile or careless importer would, and checks every
 * answer. Usage: abuse LIBRARY [CALLS]. Ends with 0 if all answers were right. */
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi.h"

Functions2 fmi2;
Functions3 fmi3;
int failures;

void expect_that(bool good, const char *what, const char *file, int line) {
    if (!good) {
        printf("%s:%d: not so: %s\n", file, line, what);
        __atomic_add_fetch(&failures, 1, __ATOMIC_RELAXED);
    }
}

void expect_status(int found, int expected, const char *what, const char *file, int line) {
    static const char *const names[] = {"OK", "Warning", "Discard", "Error", "Fatal"};
    if (found != expected) {
        const char *name = found >= OK && found <= FATAL ? names[found] : "no status";
        printf("%s:%d: %s expected, %s found: %s\n", file, line, names[expected], name, what);
        __atomic_add_fetch(&failures, 1, __ATOMIC_RELAXED);
    }
}

static void hear(Heard *heard, int status, const char *category, const char *text) {
    heard->count++;
    heard->status = status;
    snprintf(heard->category, sizeof heard->category, "%s", category);
    snprintf(heard->text, sizeof heard->text, "%s", text);
}

void hear2(void *environment, const char *name, int status, const char *category, const char *format, ...) {
    char text[512];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    EXPECT(name != NULL);
    hear(environment, status, category, text);
}

void hear3(void *environment, int status, const char *category, const char *text) {
    hear(environment, status, category, text);
}

Handle new2(Heard *heard) {
    Callbacks2 callbacks = {hear2, calloc, free, NULL, heard};
    return fmi2.Instantiate("abused", 1, TOKEN2, NULL, heard ? &callbacks : NULL, 0, 1);
}

Handle new3(Heard *heard, bool events) {
    return fmi3.InstantiateCoSimulation(
        "abused", TOKEN3, NULL, false, true, events, false, NULL, 0, heard, heard ? hear3 : NULL, NULL);
}

void start2(Handle c) {
    const unsigned method = ALIGNMENT_METHOD;
    const int given = 0;
    STATUS(OK, fmi2.SetInteger(c, &method, 1, &given));
    STATUS(OK, fmi2.SetupExperiment(c, 0, 0.0, 0.0, 0, 0.0));
    STATUS(OK, fmi2.EnterInitializationMode(c));
    STATUS(OK, fmi2.ExitInitializationMode(c));
}

void start3(Handle i, bool events) {
    const unsigned method = ALIGNMENT_METHOD;
    const int64_t given = 0;
    STATUS(OK, fmi3.SetInt64(i, &method, 1, &given, 1));
    STATUS(OK, fmi3.EnterInitializationMode(i, false, 0.0, 0.0, false, 0.0));
    STATUS(OK, fmi3.ExitInitializationMode(i));
    if (events) {
        STATUS(OK, fmi3.EnterStepMode(i));
    }
}

uint32_t next_random(uint64_t *state) {
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (uint32_t)(*state >> 33);
}

/* Counts as a level instrument at 30.5 degrees north would give them, with scattered noise. */
static void counts(unsigned k, double *theta, double *velocity) {
    uint64_t state = k;
    static const double rest[6] = {21590.0, 0.0, -12717.0, 0.0, 0.0, -52583000.0};
    for (int axis = 0; axis < 6; axis++) {
        int noise = (int)(next_random(&state) % 2001) - 1000;
        double count = rest[axis] + (axis < 3 ? noise : 40 * noise);
        if (axis < 3) {
            theta[axis] = count / 68719476736.0;
        } else {
            velocity[axis - 3] = count / 1073741824.0;
        }
    }
}

int set_sample2(Handle c, unsigned k) {
    static const unsigned reals[8] = {
        GYRO, GYRO + 1, GYRO + 2, ACCELEROMETER, ACCELEROMETER + 1, ACCELEROMETER + 2,
        GIMBAL_AZIMUTH, GIMBAL_ROLL};
    const unsigned valid = IMU_VALID;
    const unsigned integers[2] = {IMU_STATUS, REFERENCE_KIND};
    double values[8] = {0};
    counts(k, values, values + 3);
    const int truth = 1;
    /* No encoder; a velocity of zero once a second. */
    const int numbers[2] = {4, k % 200 == 0};
    int status = fmi2.SetReal(c, reals, 8, values);
    if (status == OK) status = fmi2.SetBoolean(c, &valid, 1, &truth);
    if (status == OK) status = fmi2.SetInteger(c, integers, 2, numbers);
    return status;
}

int set_sample3(Handle i, unsigned k) {
    static const unsigned reals[4] = {GYRO, ACCELEROMETER, GIMBAL_AZIMUTH, GIMBAL_ROLL};
    const unsigned valid = IMU_VALID, imu_status = IMU_STATUS, kind = REFERENCE_KIND;
    double values[8] = {0};
    counts(k, values, values + 3);
    const uint8_t truth = 1;
    const int32_t no_encoder = 4;
    const int64_t velocity = k % 200 == 0;
    int status = fmi3.SetFloat64(i, reals, 4, values, 8);
    if (status == OK) status = fmi3.SetBoolean(i, &valid, 1, &truth, 1);
    if (status == OK) status = fmi3.SetInt32(i, &imu_status, 1, &no_encoder, 1);
    if (status == OK) status = fmi3.SetInt64(i, &kind, 1, &velocity, 1);
    return status;
}

int step2(Handle c, unsigned k) {
    int status = set_sample2(c, k);
    return status == OK ? fmi2.DoStep(c, (k - 1) * PERIOD, PERIOD, 1) : status;
}

int step3(Handle i, unsigned k) {
    bool event, terminate, early;
    double last;
    int status = set_sample3(i, k);
    if (status == OK) {
        status = fmi3.DoStep(i, (k - 1) * PERIOD, PERIOD, true, &event, &terminate, &early, &last);
    }
    return status;
}

static uint64_t hash(uint64_t sofar, const void *bytes, size_t size) {
    for (size_t n = 0; n < size; n++) {
        sofar = (sofar ^ ((const unsigned char *)bytes)[n]) * 1099511628211u;
    }
    return sofar;
}

static uint64_t hash_outputs(double time, const double *reals, int mode, uint64_t sequence) {
    uint64_t sum = hash(14695981039346656037u, &time, sizeof time);
    sum = hash(sum, reals, 71 * sizeof *reals);
    sum = hash(sum, &mode, sizeof mode);
    return hash(sum, &sequence, sizeof sequence);
}

/* Latitude, longitude, height, velocity, attitude, NIS, parameters and sigma: 71 numbers. */
uint64_t outputs2(Handle c) {
    const unsigned mode = MODE, sequence = ANSWER_SEQUENCE, time = 0;
    unsigned references[71];
    double values[71], number = 0, now = 0;
    int code = -1;
    for (unsigned n = 0; n < 10; n++) references[n] = LATITUDE + n;
    references[10] = NIS;
    for (unsigned n = 0; n < 60; n++) references[11 + n] = PARAMETERS + n;
    STATUS(OK, fmi2.GetReal(c, references, 71, values));
    STATUS(OK, fmi2.GetInteger(c, &mode, 1, &code));
    STATUS(OK, fmi2.GetReal(c, &sequence, 1, &number));
    STATUS(OK, fmi2.GetReal(c, &time, 1, &now));
    return hash_outputs(now, values, code, (uint64_t)number);
}

uint64_t outputs3(Handle i) {
    const unsigned mode = MODE, sequence = ANSWER_SEQUENCE, time = 0;
    const unsigned references[20] = {LATITUDE, LONGITUDE, HEIGHT, VELOCITY, ATTITUDE, NIS, OUTPUT_GROUPS};
    double values[71], now = 0;
    int64_t code = -1;
    uint64_t number = 0;
    STATUS(OK, fmi3.GetFloat64(i, references, 20, values, 71));
    STATUS(OK, fmi3.GetInt64(i, &mode, 1, &code, 1));
    STATUS(OK, fmi3.GetUInt64(i, &sequence, 1, &number, 1));
    STATUS(OK, fmi3.GetFloat64(i, &time, 1, &now, 1));
    return hash_outputs(now, values, (int)code, number);
}

uint64_t undisturbed(unsigned steps) {
    Handle c = new2(NULL);
    start2(c);
    for (unsigned k = 1; k <= steps; k++) {
        STATUS(OK, step2(c, k));
    }
    uint64_t sum = outputs2(c);
    fmi2.FreeInstance(c);
    return sum;
}

#define LOAD2(Result, Name, Arguments) \
    *(void **)&fmi2.Name = dlsym(library, "fmi2" #Name); \
    if (!fmi2.Name) missing("fmi2" #Name);
#define LOAD3(Result, Name, Arguments) \
    *(void **)&fmi3.Name = dlsym(library, "fmi3" #Name); \
    if (!fmi3.Name) missing("fmi3" #Name);

static void missing(const char *name) {
    printf("the library has no %s\n", name);
    exit(1);
}

int main(int count, char **arguments) {
    setvbuf(stdout, NULL, _IOLBF, 0);
    void *library = count > 1 ? dlopen(arguments[1], RTLD_NOW | RTLD_LOCAL) : NULL;
    if (!library) {
        printf("usage: abuse LIBRARY [CALLS]: %s\n", dlerror());
        return 2;
    }
    unsigned calls = count > 2 ? (unsigned)atoi(arguments[2]) : 200000;
    FMI2(LOAD2)
    FMI3(LOAD3)
    EXPECT(strcmp(fmi2.GetVersion(), "2.0") == 0);
    EXPECT(strcmp(fmi2.GetTypesPlatform(), "default") == 0);
    EXPECT(strcmp(fmi3.GetVersion(), "3.0") == 0);
    abuse_handles();
    abuse_order2();
    abuse_order3();
    abuse_values();
    abuse_time();
    abuse_states();
    abuse_randomly(calls);
    abuse_threads(calls / 400);
    abuse_bus(calls);
    abuse_stack();
    printf("%d answers were wrong\n", failures);
    return failures != 0;
}
