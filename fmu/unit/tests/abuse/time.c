/* Steps that are none, and times that are not now. */
#include <math.h>
#include <stddef.h>
#include <string.h>

#include "fmi.h"

static int do_step3(Handle i, double time, double step) {
    bool flag;
    double last;
    return fmi3.DoStep(i, time, step, true, &flag, &flag, &flag, &last);
}

void abuse_time(void) {
    static const struct {
        double time, step;
        int status;
    } bad[] = {
        {0.0, 0.0, ERROR},
        {0.0, -PERIOD, ERROR},
        {0.0, -0.0, ERROR},
        {0.0, NAN, ERROR},
        {0.0, INFINITY, ERROR},
        {0.0, -INFINITY, ERROR},
        {0.0, 5e-324, DISCARD},
        {0.0, 1.7e308, DISCARD},
        {0.0, 2 * PERIOD, DISCARD},
        {0.0, 0.5 * PERIOD, DISCARD},
        {0.0, PERIOD * (1 + 1e-5), DISCARD},
        {0.0, PERIOD * (1 - 1e-5), DISCARD},
        {0.0, 1e9, DISCARD},
        {NAN, PERIOD, DISCARD},
        {INFINITY, PERIOD, DISCARD},
        {-INFINITY, PERIOD, DISCARD},
        {-PERIOD, PERIOD, DISCARD},
        {PERIOD, PERIOD, DISCARD},
        {1e300, PERIOD, DISCARD},
        {0.51 * PERIOD, PERIOD, DISCARD},
        /* Rounding is no mistake. */
        {1e-9, PERIOD * (1 + 1e-9), OK},
        {-1e-9, PERIOD * (1 - 1e-9), OK},
    };
    const unsigned time_reference = 0;
    for (size_t n = 0; n < sizeof bad / sizeof *bad; n++) {
        Heard heard = {0};
        Handle kept = NULL, c = new2(&heard), i = new3(NULL, false);
        double now = -1, reached = -1;
        start2(c);
        start3(i, false);
        STATUS(OK, fmi2.GetFMUstate(c, &kept));
        expect_status(fmi2.DoStep(c, bad[n].time, bad[n].step, 1), bad[n].status, "fmi2DoStep", __FILE__, (int)n);
        expect_status(do_step3(i, bad[n].time, bad[n].step), bad[n].status, "fmi3DoStep", __FILE__, (int)n);
        if (bad[n].status != OK) {
            /* Nothing was done, and time stays. */
            STATUS(OK, fmi2.GetReal(c, &time_reference, 1, &now));
            EXPECT(now == 0.0 && heard.count > 0);
            if (bad[n].status == DISCARD) {
                STATUS(OK, fmi2.GetRealStatus(c, 2, &reached));
                EXPECT(reached == 0.0);
                STATUS(OK, step3(i, 1));
            }
            STATUS(OK, fmi2.SetFMUstate(c, kept));
            STATUS(OK, step2(c, 1));
        }
        fmi2.FreeInstance(c);
        fmi3.FreeInstance(i);
    }
    /* Starts and ends. */
    static const double starts[3] = {NAN, INFINITY, -INFINITY};
    for (int n = 0; n < 3; n++) {
        Handle c = new2(NULL), i = new3(NULL, false);
        STATUS(ERROR, fmi2.SetupExperiment(c, 0, 0.0, starts[n], 0, 0.0));
        STATUS(ERROR, fmi3.EnterInitializationMode(i, false, 0.0, starts[n], false, 0.0));
        STATUS(OK, fmi2.Reset(c));
        STATUS(OK, fmi3.Reset(i));
        STATUS(ERROR, fmi2.SetupExperiment(c, 1, NAN, 1.0, 1, 0.5));
        STATUS(ERROR, fmi3.EnterInitializationMode(i, true, NAN, 1.0, true, NAN));
        fmi2.FreeInstance(c);
        fmi3.FreeInstance(i);
    }
    /* A start that is no whole number of periods, and an end that is not to be passed. */
    Handle c = new2(NULL);
    STATUS(OK, fmi2.SetupExperiment(c, 1, 1e-6, 1000.0017, 1, 1000.0017 + 3 * PERIOD));
    STATUS(OK, fmi2.EnterInitializationMode(c));
    STATUS(OK, fmi2.ExitInitializationMode(c));
    for (int k = 0; k < 3; k++) {
        STATUS(OK, fmi2.DoStep(c, 1000.0017 + k * PERIOD, PERIOD, 1));
    }
    STATUS(ERROR, fmi2.DoStep(c, 1000.0017 + 3 * PERIOD, PERIOD, 1));
    fmi2.FreeInstance(c);
    /* Time adds up: an importer that sums its steps is followed for six minutes. */
    c = new2(NULL);
    start2(c);
    double time = 0.0;
    for (unsigned k = 0; k < 72000; k++) {
        int status = fmi2.DoStep(c, time, PERIOD, 1);
        if (status != OK) {
            STATUS(OK, status);
            break;
        }
        time += PERIOD;
    }
    double now = 0;
    STATUS(OK, fmi2.GetReal(c, &time_reference, 1, &now));
    EXPECT(now == 360.0);
    fmi2.FreeInstance(c);
}
