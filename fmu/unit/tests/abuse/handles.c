/* Instances that are none, and instances that are not made. */
#include <stdlib.h>
#include <string.h>

#include "fmi.h"

/* Every function of both standards that takes an instance, with a handle that leads nowhere. */
static void nowhere(Handle h) {
    unsigned vr = GYRO;
    double real = 1.0;
    int integer = 0;
    const char *text = "logAll";
    size_t size = 1;
    bool flag;
    Handle state = NULL;
    char bytes[8] = {0};
    STATUS(ERROR, fmi2.SetDebugLogging(h, 1, 1, &text));
    STATUS(ERROR, fmi2.SetupExperiment(h, 0, 0, 0, 0, 0));
    STATUS(ERROR, fmi2.EnterInitializationMode(h));
    STATUS(ERROR, fmi2.ExitInitializationMode(h));
    STATUS(ERROR, fmi2.Terminate(h));
    STATUS(ERROR, fmi2.Reset(h));
    STATUS(ERROR, fmi2.GetReal(h, &vr, 1, &real));
    STATUS(ERROR, fmi2.GetInteger(h, &vr, 1, &integer));
    STATUS(ERROR, fmi2.GetBoolean(h, &vr, 1, &integer));
    STATUS(ERROR, fmi2.GetString(h, &vr, 1, &text));
    STATUS(ERROR, fmi2.SetReal(h, &vr, 1, &real));
    STATUS(ERROR, fmi2.SetInteger(h, &vr, 1, &integer));
    STATUS(ERROR, fmi2.SetBoolean(h, &vr, 1, &integer));
    STATUS(ERROR, fmi2.SetString(h, &vr, 1, &text));
    STATUS(ERROR, fmi2.GetFMUstate(h, &state));
    STATUS(ERROR, fmi2.SetFMUstate(h, h));
    STATUS(ERROR, fmi2.FreeFMUstate(h, &state));
    STATUS(ERROR, fmi2.SerializedFMUstateSize(h, h, &size));
    STATUS(ERROR, fmi2.SerializeFMUstate(h, h, bytes, 8));
    STATUS(ERROR, fmi2.DeSerializeFMUstate(h, bytes, 8, &state));
    STATUS(ERROR, fmi2.GetDirectionalDerivative(h, &vr, 1, &vr, 1, &real, &real));
    STATUS(ERROR, fmi2.DoStep(h, 0.0, PERIOD, 1));
    STATUS(ERROR, fmi2.CancelStep(h));
    STATUS(ERROR, fmi2.GetStatus(h, 0, &integer));
    STATUS(ERROR, fmi2.GetRealStatus(h, 2, &real));
    STATUS(ERROR, fmi2.SetTime(h, 0.0));
    STATUS(ERROR, fmi2.GetDerivatives(h, &real, 1));
    STATUS(ERROR, fmi3.SetDebugLogging(h, true, 1, &text));
    STATUS(ERROR, fmi3.EnterInitializationMode(h, false, 0, 0, false, 0));
    STATUS(ERROR, fmi3.ExitInitializationMode(h));
    STATUS(ERROR, fmi3.EnterEventMode(h));
    STATUS(ERROR, fmi3.EnterStepMode(h));
    STATUS(ERROR, fmi3.Terminate(h));
    STATUS(ERROR, fmi3.Reset(h));
    STATUS(ERROR, fmi3.GetFloat64(h, &vr, 1, &real, 3));
    STATUS(ERROR, fmi3.SetFloat64(h, &vr, 1, &real, 3));
    STATUS(ERROR, fmi3.GetFMUState(h, &state));
    STATUS(ERROR, fmi3.SetFMUState(h, h));
    STATUS(ERROR, fmi3.FreeFMUState(h, &state));
    STATUS(ERROR, fmi3.GetNumberOfVariableDependencies(h, vr, &size));
    STATUS(ERROR, fmi3.DoStep(h, 0.0, PERIOD, true, &flag, &flag, &flag, &real));
    STATUS(ERROR, fmi3.EvaluateDiscreteStates(h));
    STATUS(ERROR, fmi3.ActivateModelPartition(h, vr, 0.0));
    fmi2.FreeInstance(h);
    fmi3.FreeInstance(h);
}

static void not_made(void) {
    Heard heard = {0};
    Callbacks2 callbacks = {hear2, NULL, NULL, NULL, &heard};
    static const struct {
        const char *name;
        int kind;
        const char *guid;
        const char *why;
    } bad[] = {
        {NULL, 1, TOKEN2, "no name"},
        {"", 1, TOKEN2, "no name"},
        {" \t", 1, TOKEN2, "no name"},
        {"n", 1, NULL, "null pointer"},
        {"n", 1, "", "token"},
        {"n", 1, "{00000000-0000-0000-0000-000000000000}", "token"},
        {"n", 1, TOKEN3, "token"},
        {"n", 0, TOKEN2, "model exchange"},
        {"n", 7, TOKEN2, "model exchange"},
    };
    for (size_t n = 0; n < sizeof bad / sizeof *bad; n++) {
        heard.count = 0;
        EXPECT(fmi2.Instantiate(bad[n].name, bad[n].kind, bad[n].guid, NULL, &callbacks, 0, 0) == NULL);
        EXPECT(heard.count == 1 && heard.status == ERROR);
        EXPECT(strstr(heard.text, bad[n].why) != NULL);
        EXPECT(fmi2.Instantiate(bad[n].name, bad[n].kind, bad[n].guid, NULL, NULL, 0, 1) == NULL);
    }
    heard.count = 0;
    EXPECT(fmi3.InstantiateModelExchange("n", TOKEN3, NULL, false, false, &heard, hear3) == NULL);
    EXPECT(heard.count == 1 && strstr(heard.text, "model exchange"));
    EXPECT(fmi3.InstantiateScheduledExecution(
               "n", TOKEN3, NULL, false, false, &heard, hear3, NULL, NULL, NULL) == NULL);
    EXPECT(heard.count == 2 && strstr(heard.text, "scheduled execution"));
    EXPECT(fmi3.InstantiateModelExchange(NULL, NULL, NULL, false, false, NULL, NULL) == NULL);
    const unsigned required = GYRO;
    EXPECT(fmi3.InstantiateCoSimulation(
               "n", TOKEN3, NULL, false, false, false, false, &required, 1, &heard, hear3, NULL) == NULL);
    EXPECT(heard.count == 3 && strstr(heard.text, "intermediate"));
    EXPECT(fmi3.InstantiateCoSimulation(
               NULL, NULL, NULL, false, false, false, false, NULL, 0, NULL, NULL, NULL) == NULL);
    EXPECT(fmi3.InstantiateCoSimulation(
               "n", TOKEN2, NULL, false, false, false, false, NULL, 0, &heard, hear3, NULL) == NULL);
    EXPECT(heard.count == 4 && strstr(heard.text, "token"));
}

/* Callbacks that are null, names and resources of any kind: legal. */
static void made(void) {
    Callbacks2 none = {0};
    Handle all[4] = {
        fmi2.Instantiate("100 % #1# \xff", 1, TOKEN2, "file:///nowhere/resources", &none, 1, 1),
        fmi2.Instantiate("n", 1, TOKEN2, NULL, NULL, 0, 0),
        fmi3.InstantiateCoSimulation(
            "n", TOKEN3, NULL, true, true, true, true, NULL, 0, NULL, NULL, NULL),
        fmi3.InstantiateCoSimulation(
            "%s%s%s%n", TOKEN3, "/nowhere/", false, false, false, false, NULL, 0, NULL, NULL, NULL),
    };
    for (int n = 0; n < 4; n++) {
        EXPECT(all[n] != NULL);
        for (int m = 0; m < n; m++) EXPECT(all[n] != all[m]);
    }
    /* Errors without anybody to hear of them. */
    STATUS(ERROR, fmi2.Terminate(all[0]));
    STATUS(ERROR, fmi2.Terminate(all[1]));
    STATUS(ERROR, fmi3.Terminate(all[2]));
    STATUS(ERROR, fmi3.EnterStepMode(all[3]));
    /* The handles of one standard are nothing to the other. */
    STATUS(ERROR, fmi3.Reset(all[0]));
    STATUS(ERROR, fmi2.Reset(all[2]));
    fmi3.FreeInstance(all[0]);
    STATUS(OK, fmi2.Reset(all[0]));
    fmi2.FreeInstance(all[0]);
    fmi2.FreeInstance(all[1]);
    fmi3.FreeInstance(all[2]);
    fmi3.FreeInstance(all[3]);
    for (int n = 0; n < 4; n++) nowhere(all[n]);
}

/* Messages are text, whatever is in a name or an argument. */
static void messages(void) {
    Heard heard = {0};
    Handle c = new2(&heard);
    const char *categories[3] = {"%s%n#1#", "logEvents", "logStatusWarning"};
    STATUS(WARNING, fmi2.SetDebugLogging(c, 1, 3, categories));
    EXPECT(heard.count == 1 && heard.status == WARNING);
    EXPECT(strstr(heard.text, "%s%n##1##") != NULL);
    EXPECT(strcmp(heard.category, "logStatusWarning") == 0);
    const char *missing[1] = {NULL};
    STATUS(ERROR, fmi2.SetDebugLogging(c, 1, 1, missing));
    STATUS(ERROR, fmi2.SetDebugLogging(c, 1, 2, NULL));
    STATUS(ERROR, fmi2.SetDebugLogging(c, 1, SIZE_MAX, categories));
    STATUS(OK, fmi2.SetDebugLogging(c, 0, 0, NULL));
    heard.count = 0;
    STATUS(ERROR, fmi2.DoStep(c, 0.0, PERIOD, 1));
    EXPECT(heard.count == 1 && heard.status == ERROR);
    fmi2.FreeInstance(c);
    /* FMI 3.0 says nothing once it has been told to be quiet. */
    Handle i = new3(&heard, false);
    heard.count = 0;
    STATUS(ERROR, fmi3.Terminate(i));
    EXPECT(heard.count == 1);
    STATUS(OK, fmi3.SetDebugLogging(i, false, 0, NULL));
    STATUS(ERROR, fmi3.Terminate(i));
    EXPECT(heard.count == 1);
    fmi3.FreeInstance(i);
}

void abuse_handles(void) {
    int local = 0;
    void *heap = malloc(64);
    nowhere(NULL);
    nowhere(&local);
    nowhere(heap);
    nowhere((Handle)(uintptr_t)1);
    nowhere((Handle)UINTPTR_MAX);
    nowhere((Handle)(uintptr_t)0x10000);
    nowhere((Handle)&fmi2);
    /* Compilers complain of what is done with a freed pointer: here it is the point. */
    volatile uintptr_t freed = (uintptr_t)heap;
    free(heap);
    nowhere((Handle)freed);
    not_made();
    made();
    messages();
}
