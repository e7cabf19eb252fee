/* FMU states of others, states that are gone, bytes that are none. */
#include <stdlib.h>
#include <string.h>

#include "fmi.h"

static void handles(void) {
    Handle c = new2(NULL), other = new2(NULL), i = new3(NULL, false);
    Handle kept = NULL, theirs = NULL, third = NULL, none = NULL, gone;
    char bytes[8] = {0};
    size_t size = 0;
    start2(c);
    start2(other);
    start3(i, false);
    STATUS(OK, fmi2.GetFMUstate(c, &kept));
    STATUS(OK, fmi2.GetFMUstate(other, &theirs));
    STATUS(OK, fmi3.GetFMUState(i, &third));
    EXPECT(kept != NULL && kept != theirs && kept != third);
    /* Kept in place of an earlier one: the same handle. */
    Handle again = kept;
    STATUS(OK, fmi2.GetFMUstate(c, &again));
    EXPECT(again == kept);
    /* Freed: null afterwards, and none any more. */
    again = NULL;
    STATUS(OK, fmi2.GetFMUstate(c, &again));
    gone = again;
    STATUS(OK, fmi2.FreeFMUstate(c, &again));
    EXPECT(again == NULL);
    STATUS(OK, fmi2.FreeFMUstate(c, &again));
    STATUS(OK, fmi2.FreeFMUstate(c, NULL));
    Handle foreign[] = {theirs, third, gone, NULL, (Handle)&size, (Handle)UINTPTR_MAX, c};
    for (size_t n = 0; n < sizeof foreign / sizeof *foreign; n++) {
        Handle copy = foreign[n];
        STATUS(ERROR, fmi2.SetFMUstate(c, foreign[n]));
        STATUS(OK, fmi2.SetFMUstate(c, kept));
        STATUS(ERROR, fmi2.SerializedFMUstateSize(c, foreign[n], &size));
        STATUS(ERROR, fmi2.SerializeFMUstate(c, foreign[n], bytes, sizeof bytes));
        if (copy) {
            STATUS(ERROR, fmi2.FreeFMUstate(c, &copy));
            STATUS(ERROR, fmi2.GetFMUstate(c, &copy));
            EXPECT(copy == foreign[n]);
        }
        STATUS(OK, fmi2.SetFMUstate(c, kept));
    }
    STATUS(ERROR, fmi2.GetFMUstate(c, NULL));
    STATUS(OK, fmi2.SetFMUstate(c, kept));
    STATUS(ERROR, fmi2.SerializedFMUstateSize(c, kept, NULL));
    STATUS(ERROR, fmi2.SerializeFMUstate(c, kept, NULL, 1 << 20));
    STATUS(ERROR, fmi2.SerializeFMUstate(c, kept, bytes, 0));
    STATUS(ERROR, fmi2.SerializeFMUstate(c, kept, bytes, sizeof bytes));
    STATUS(ERROR, fmi2.DeSerializeFMUstate(c, NULL, 8, &none));
    STATUS(ERROR, fmi2.DeSerializeFMUstate(c, bytes, 8, NULL));
    STATUS(ERROR, fmi2.DeSerializeFMUstate(c, bytes, SIZE_MAX, &none));
    STATUS(ERROR, fmi2.DeSerializeFMUstate(c, bytes, 0, &none));
    EXPECT(none == NULL);
    /* A state outlives a reset, and leads out of it. */
    STATUS(OK, fmi2.Reset(c));
    STATUS(OK, fmi2.SetFMUstate(c, kept));
    STATUS(OK, step2(c, 1));
    fmi2.FreeInstance(c);
    fmi2.FreeInstance(other);
    fmi3.FreeInstance(i);
}

/* Bytes that are cut short or altered in any one place. */
static void damaged(void) {
    Handle kept = NULL, copy = NULL, c = new2(NULL);
    size_t size = 0;
    start2(c);
    for (unsigned k = 1; k <= 250; k++) STATUS(OK, step2(c, k));
    STATUS(OK, fmi2.GetFMUstate(c, &kept));
    STATUS(OK, fmi2.SerializedFMUstateSize(c, kept, &size));
    char *bytes = malloc(size);
    STATUS(OK, fmi2.SerializeFMUstate(c, kept, bytes, size));
    for (size_t length = 0; length < size; length += 1 + size / 97) {
        /* Memory of just this size, so that a look past its end is found. */
        char *cut = malloc(length + !length);
        memcpy(cut, bytes, length);
        STATUS(ERROR, fmi2.DeSerializeFMUstate(c, cut, length, &copy));
        STATUS(OK, fmi2.SetFMUstate(c, kept));
        free(cut);
    }
    for (size_t place = 0; place < size; place += 1 + size / 211) {
        bytes[place] ^= (char)(1 << place % 8);
        STATUS(ERROR, fmi2.DeSerializeFMUstate(c, bytes, size, &copy));
        STATUS(OK, fmi2.SetFMUstate(c, kept));
        bytes[place] ^= (char)(1 << place % 8);
    }
    EXPECT(copy == NULL);
    STATUS(OK, fmi2.DeSerializeFMUstate(c, bytes, size, &copy));
    /* On in a fresh instance, and in one of the other standard not at all. */
    Handle fresh = new2(NULL), theirs = NULL, i = new3(NULL, false);
    STATUS(OK, fmi2.DeSerializeFMUstate(fresh, bytes, size, &theirs));
    STATUS(OK, fmi2.SetFMUstate(fresh, theirs));
    STATUS(ERROR, fmi3.DeserializeFMUState(i, (uint8_t *)bytes, size, &theirs));
    for (unsigned k = 251; k <= 450; k++) STATUS(OK, step2(fresh, k));
    EXPECT(outputs2(fresh) == undisturbed(450));
    free(bytes);
    fmi2.FreeInstance(c);
    fmi2.FreeInstance(fresh);
    fmi3.FreeInstance(i);
}

void abuse_states(void) {
    handles();
    damaged();
}
