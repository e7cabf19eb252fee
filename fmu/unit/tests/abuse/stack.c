/* How much of the caller's stack each function takes. Tools call FMUs from threads of 512 KiB and less. */
#define _GNU_SOURCE
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "fmi.h"

enum { STACK = 4 << 20, PAINT = 0xA5, STEPS = 400 };
/* What a function may take, with what the system's thread library keeps in the stack. */
static const size_t limit = 128 << 10;

/* Everything that the calls need. */
typedef struct {
    const char *token;
    bool is_calibrator;
    Handle instance, state;
    size_t size;
    uint8_t *bytes;
} Subject;

typedef void (*Work)(Subject *);
typedef struct {
    Work work;
    Subject *subject;
} Task;

static void *begin(void *task) {
    ((Task *)task)->work(((Task *)task)->subject);
    return NULL;
}

/* Runs the work on a stack of its own, painted before, and looks how far down the paint is gone. */
static void take(const char *standard, const char *name, Work work, Subject *subject) {
    /* Seen through a second mapping: valgrind takes what is below the end of a stack for no memory. */
    FILE *file = tmpfile();
    if (!file || ftruncate(fileno(file), STACK) != 0) {
        EXPECT(!"no file for a stack");
        return;
    }
    uint8_t *seen = mmap(NULL, STACK, PROT_READ | PROT_WRITE, MAP_SHARED, fileno(file), 0);
    uint8_t *stack = mmap(NULL, STACK, PROT_READ | PROT_WRITE, MAP_SHARED, fileno(file), 0);
    fclose(file);
    if (seen == MAP_FAILED || stack == MAP_FAILED) {
        EXPECT(!"no memory for a stack");
        return;
    }
    memset(seen, PAINT, STACK);
    pthread_attr_t attributes;
    pthread_t thread;
    Task task = {work, subject};
    EXPECT(pthread_attr_init(&attributes) == 0);
    EXPECT(pthread_attr_setstack(&attributes, stack, STACK) == 0);
    EXPECT(pthread_create(&thread, &attributes, begin, &task) == 0);
    EXPECT(pthread_join(thread, NULL) == 0);
    size_t untouched = 0;
    while (untouched < STACK && seen[untouched] == PAINT) {
        untouched++;
    }
    size_t taken = STACK - untouched;
    if (taken > limit || getenv("ABUSE_TELL")) {
        printf("%s %s of %.8s takes %zu KiB of stack\n", standard, name, subject->token, taken >> 10);
    }
    EXPECT(taken <= limit);
    pthread_attr_destroy(&attributes);
    munmap(stack, STACK);
    munmap(seen, STACK);
}

static void instantiate2(Subject *s) {
    static Heard heard;
    Callbacks2 callbacks = {hear2, calloc, free, NULL, &heard};
    s->instance = fmi2.Instantiate("stack", 1, s->token, NULL, &callbacks, 0, 1);
    EXPECT(s->instance != NULL);
}

static void enter2(Subject *s) {
    const unsigned method = ALIGNMENT_METHOD;
    const int given = 0;
    if (s->is_calibrator) {
        STATUS(OK, fmi2.SetInteger(s->instance, &method, 1, &given));
    }
    STATUS(OK, fmi2.SetupExperiment(s->instance, 0, 0.0, 0.0, 0, 0.0));
    STATUS(OK, fmi2.EnterInitializationMode(s->instance));
}

static void exit2(Subject *s) { STATUS(OK, fmi2.ExitInitializationMode(s->instance)); }

static void steps2(Subject *s) {
    for (unsigned k = 1; k <= STEPS; k++) {
        STATUS(OK, s->is_calibrator ? step2(s->instance, k) : fmi2.DoStep(s->instance, (k - 1) * PERIOD, PERIOD, 1));
    }
}

static void tune2(Subject *s) {
    const unsigned reference = s->is_calibrator ? GATE_NIS : PLANT_GYRO_BIAS;
    const double value = 25.0;
    STATUS(OK, fmi2.SetReal(s->instance, &reference, 1, &value));
}

static void get2(Subject *s) { STATUS(OK, fmi2.GetFMUstate(s->instance, &s->state)); }
static void set2(Subject *s) { STATUS(OK, fmi2.SetFMUstate(s->instance, s->state)); }
static void serialize2(Subject *s) {
    STATUS(OK, fmi2.SerializedFMUstateSize(s->instance, s->state, &s->size));
    s->bytes = malloc(s->size);
    STATUS(OK, fmi2.SerializeFMUstate(s->instance, s->state, (char *)s->bytes, s->size));
}
static void deserialize2(Subject *s) {
    Handle again = NULL;
    STATUS(OK, fmi2.DeSerializeFMUstate(s->instance, (char *)s->bytes, s->size, &again));
    STATUS(OK, fmi2.FreeFMUstate(s->instance, &again));
    STATUS(OK, fmi2.FreeFMUstate(s->instance, &s->state));
    free(s->bytes);
}
static void terminate2(Subject *s) { STATUS(OK, fmi2.Terminate(s->instance)); }
static void reset2(Subject *s) { STATUS(OK, fmi2.Reset(s->instance)); }
static void free2(Subject *s) { fmi2.FreeInstance(s->instance); }

static void instantiate3(Subject *s) {
    s->instance = fmi3.InstantiateCoSimulation("stack", s->token, NULL, false, true, false, false, NULL, 0, NULL, NULL, NULL);
    EXPECT(s->instance != NULL);
}

static void enter3(Subject *s) {
    const unsigned method = ALIGNMENT_METHOD;
    const int64_t given = 0;
    if (s->is_calibrator) {
        STATUS(OK, fmi3.SetInt64(s->instance, &method, 1, &given, 1));
    }
    STATUS(OK, fmi3.EnterInitializationMode(s->instance, false, 0.0, 0.0, false, 0.0));
}

static void exit3(Subject *s) { STATUS(OK, fmi3.ExitInitializationMode(s->instance)); }

static void steps3(Subject *s) {
    bool event, terminate, early;
    double last;
    for (unsigned k = 1; k <= STEPS; k++) {
        STATUS(OK, s->is_calibrator ? step3(s->instance, k)
                                    : fmi3.DoStep(s->instance, (k - 1) * PERIOD, PERIOD, true, &event, &terminate, &early, &last));
    }
}

static void tune3(Subject *s) {
    const unsigned reference = s->is_calibrator ? GATE_NIS : PLANT_GYRO_BIAS;
    const double values[3] = {25.0, 0.0, 0.0};
    STATUS(OK, fmi3.SetFloat64(s->instance, &reference, 1, values, s->is_calibrator ? 1 : 3));
}

static void get3(Subject *s) { STATUS(OK, fmi3.GetFMUState(s->instance, &s->state)); }
static void set3(Subject *s) { STATUS(OK, fmi3.SetFMUState(s->instance, s->state)); }
static void serialize3(Subject *s) {
    STATUS(OK, fmi3.SerializedFMUStateSize(s->instance, s->state, &s->size));
    s->bytes = malloc(s->size);
    STATUS(OK, fmi3.SerializeFMUState(s->instance, s->state, s->bytes, s->size));
}
static void deserialize3(Subject *s) {
    Handle again = NULL;
    STATUS(OK, fmi3.DeserializeFMUState(s->instance, s->bytes, s->size, &again));
    STATUS(OK, fmi3.FreeFMUState(s->instance, &again));
    STATUS(OK, fmi3.FreeFMUState(s->instance, &s->state));
    free(s->bytes);
}
static void terminate3(Subject *s) { STATUS(OK, fmi3.Terminate(s->instance)); }
static void reset3(Subject *s) { STATUS(OK, fmi3.Reset(s->instance)); }
static void free3(Subject *s) { fmi3.FreeInstance(s->instance); }

#define STEP(Standard, Name) take("FMI " #Standard, #Name, Name##Standard, subject);
#define LIFE(Standard) \
    STEP(Standard, instantiate) STEP(Standard, enter) STEP(Standard, exit) STEP(Standard, steps) STEP(Standard, tune) \
    STEP(Standard, get) STEP(Standard, set) STEP(Standard, serialize) STEP(Standard, deserialize) \
    STEP(Standard, terminate) STEP(Standard, reset) STEP(Standard, enter) STEP(Standard, exit) STEP(Standard, free)

void abuse_stack(void) {
    Subject of2[2] = {{.token = TOKEN2, .is_calibrator = true}, {.token = TOKEN_PLANT2}};
    Subject of3[2] = {{.token = TOKEN3, .is_calibrator = true}, {.token = TOKEN_PLANT3}};
    for (int n = 0; n < 2; n++) {
        Subject *subject = &of2[n];
        LIFE(2)
        subject = &of3[n];
        LIFE(3)
    }
    /* The one on a bus has clocks, which it is stepped with elsewhere. */
    Subject bus = {.token = TOKEN_BUS}, *subject = &bus;
    STEP(3, instantiate) STEP(3, enter) STEP(3, exit) STEP(3, get) STEP(3, set) STEP(3, serialize)
    STEP(3, deserialize) STEP(3, terminate) STEP(3, reset) STEP(3, free)
}
