/* 64 instances on 8 threads, and instances that several threads are in at once. */
#include <pthread.h>
#include <stdlib.h>

#include "fmi.h"

enum { THREADS = 8, EACH = 8 };

static unsigned steps;
static uint64_t expected;
static Handle shared2, shared3, doomed;

/* Instances of its own: they go on as if there were no others. */
static void *own(void *argument) {
    Handle all[EACH];
    (void)argument;
    for (int n = 0; n < EACH; n++) {
        all[n] = n % 2 ? new3(NULL, false) : new2(NULL);
        n % 2 ? start3(all[n], false) : start2(all[n]);
    }
    for (unsigned k = 1; k <= steps; k++) {
        for (int n = 0; n < EACH; n++) STATUS(OK, n % 2 ? step3(all[n], k) : step2(all[n], k));
    }
    for (int n = 0; n < EACH; n++) {
        EXPECT((n % 2 ? outputs3(all[n]) : outputs2(all[n])) == expected);
        n % 2 ? fmi3.FreeInstance(all[n]) : fmi2.FreeInstance(all[n]);
    }
    return NULL;
}

/* Instances of everybody: who comes while another is in is refused, and nothing breaks. */
static void *everybodys(void *argument) {
    const unsigned latitude = LATITUDE, now = 0;
    unsigned long done = 0;
    (void)argument;
    for (unsigned n = 0; n < 20 * steps; n++) {
        double value, time = 0;
        bool flag;
        int status = fmi2.GetReal(shared2, &latitude, 1, &value);
        EXPECT(status == OK || status == ERROR);
        if (fmi2.GetReal(shared2, &now, 1, &time) == OK) {
            status = fmi2.DoStep(shared2, time, PERIOD, 1);
            done += status == OK;
            EXPECT(status >= OK && status <= ERROR);
            /* Another was faster, and the step is behind the time. */
            if (status == DISCARD) fmi2.Reset(shared2);
        }
        status = fmi3.DoStep(shared3, time, PERIOD, true, &flag, &flag, &flag, &value);
        EXPECT(status >= OK && status <= ERROR);
        Handle state = NULL;
        if (fmi3.GetFMUState(shared3, &state) == OK) {
            status = fmi3.FreeFMUState(shared3, &state);
            EXPECT(status == OK || status == ERROR);
        }
        /* Freed by the one, used by the other. */
        fmi2.GetReal(doomed, &now, 1, &time);
        if (n == 10 * steps) fmi2.FreeInstance(doomed);
    }
    return (void *)(uintptr_t)done;
}

static void all(void *(*work)(void *)) {
    pthread_t threads[THREADS];
    for (int n = 0; n < THREADS; n++) pthread_create(&threads[n], NULL, work, NULL);
    for (int n = 0; n < THREADS; n++) pthread_join(threads[n], NULL);
}

void abuse_threads(unsigned count) {
    steps = count;
    expected = undisturbed(steps);
    all(own);
    shared2 = new2(NULL);
    shared3 = new3(NULL, false);
    doomed = new2(NULL);
    start2(shared2);
    start3(shared3, false);
    start2(doomed);
    all(everybodys);
    /* Whatever they did to each other, a reset leaves good instances. */
    STATUS(OK, fmi2.Reset(shared2));
    STATUS(OK, fmi3.Reset(shared3));
    start2(shared2);
    start3(shared3, false);
    for (unsigned k = 1; k <= steps; k++) {
        STATUS(OK, step2(shared2, k));
        STATUS(OK, step3(shared3, k));
    }
    EXPECT(outputs2(shared2) == expected);
    EXPECT(outputs3(shared3) == expected);
    fmi2.FreeInstance(shared2);
    fmi3.FreeInstance(shared3);
    fmi2.FreeInstance(doomed);
}
