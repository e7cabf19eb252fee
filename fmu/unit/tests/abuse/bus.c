/* The model on a bus: clocks and binary variables in and out of order, and bytes that are nothing. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "fmi.h"

static uint64_t dice = 20261121;

static const unsigned rx_clock = BUS_RX_CLOCK, rx_data = BUS_RX_DATA;
static const unsigned tx_clock = BUS_TX_CLOCK, tx_data = BUS_TX_DATA;

static Handle new_bus(Heard *heard, bool notifications) {
    Handle i = fmi3.InstantiateCoSimulation(
        "abused", TOKEN_BUS, NULL, false, true, true, false, NULL, 0, heard, heard ? hear3 : NULL, NULL);
    EXPECT(i != NULL);
    if (notifications) {
        const unsigned reference = BUS_NOTIFICATIONS;
        const uint8_t on = 1;
        STATUS(OK, fmi3.SetBoolean(i, &reference, 1, &on, 1));
    }
    return i;
}

/* To its first event. */
static void start_bus(Handle i) {
    STATUS(OK, fmi3.EnterInitializationMode(i, false, 0.0, 0.0, false, 0.0));
    STATUS(OK, fmi3.ExitInitializationMode(i));
}

static int update(Handle i) {
    bool flag;
    double time;
    return fmi3.UpdateDiscreteStates(i, &flag, &flag, &flag, &flag, &flag, &time);
}

static int receive(Handle i, const uint8_t *bytes, size_t size) {
    const bool on = true;
    int status = fmi3.SetClock(i, &rx_clock, 1, &on);
    if (status == OK) status = fmi3.SetBinary(i, &rx_data, 1, &size, &bytes, 1);
    return status == OK ? update(i) : status;
}

/* Ticks until nothing is to be sent; how many bytes there were. */
static size_t drain(Handle i) {
    const bool on = true;
    size_t all = 0;
    for (int n = 0; n < 100000; n++) {
        double interval = -1;
        int qualifier = -1;
        STATUS(OK, fmi3.GetIntervalDecimal(i, &tx_clock, 1, &interval, &qualifier));
        if (qualifier == 0 || interval > 0.0) return all;
        size_t size = 0;
        const uint8_t *bytes = NULL;
        STATUS(OK, fmi3.SetClock(i, &tx_clock, 1, &on));
        STATUS(OK, fmi3.GetBinary(i, &tx_data, 1, &size, &bytes, 1));
        EXPECT(size == 0 || bytes != NULL);
        all += size;
        STATUS(OK, update(i));
    }
    EXPECT(!"an end of what is sent");
    return all;
}

/* A call that is refused with an error; afterwards the instance is as it was. */
#define AGAIN(call) \
    STATUS(ERROR, call); \
    STATUS(OK, fmi3.SetFMUState(i, kept))

static void arrays(void) {
    const uint8_t some[4] = {1, 2, 3, 4}, *bytes = some, *nothing = NULL, *got[2];
    size_t size = 4, sizes[2] = {4, SIZE_MAX};
    bool on = true, states[2];
    double interval[2];
    int qualifier[2];
    const unsigned bad[2] = {rx_data, UINT32_MAX};
    Handle kept = NULL, i = new_bus(NULL, false);
    start_bus(i);
    STATUS(OK, fmi3.SetClock(i, &rx_clock, 1, &on));
    STATUS(OK, fmi3.GetFMUState(i, &kept));
    AGAIN(fmi3.SetBinary(i, NULL, 1, &size, &bytes, 1));
    AGAIN(fmi3.SetBinary(i, &rx_data, 1, NULL, &bytes, 1));
    AGAIN(fmi3.SetBinary(i, &rx_data, 1, &size, NULL, 1));
    AGAIN(fmi3.SetBinary(i, &rx_data, 1, &size, &nothing, 1));
    AGAIN(fmi3.SetBinary(i, &rx_data, 1, &size, &bytes, 0));
    AGAIN(fmi3.SetBinary(i, &rx_data, 1, &size, &bytes, SIZE_MAX));
    AGAIN(fmi3.SetBinary(i, &rx_data, SIZE_MAX, &size, &bytes, SIZE_MAX));
    AGAIN(fmi3.SetBinary(i, bad, 2, sizes, &bytes, 2));
    AGAIN(fmi3.SetBinary(i, &tx_data, 1, &size, &bytes, 1));
    AGAIN(fmi3.SetBinary(i, &tx_clock, 1, &size, &bytes, 1));
    STATUS(DISCARD, fmi3.SetBinary(i, &rx_data, 1, &sizes[1], &bytes, 1));
    AGAIN(fmi3.GetBinary(i, NULL, 1, &size, got, 1));
    AGAIN(fmi3.GetBinary(i, &tx_data, 1, NULL, got, 1));
    AGAIN(fmi3.GetBinary(i, &tx_data, 1, &size, NULL, 1));
    AGAIN(fmi3.GetBinary(i, &tx_data, 1, &size, got, 2));
    AGAIN(fmi3.GetBinary(i, bad, 2, sizes, got, 2));
    AGAIN(fmi3.GetBinary(i, &rx_clock, 1, &size, got, 1));
    AGAIN(fmi3.SetClock(i, NULL, 1, &on));
    AGAIN(fmi3.SetClock(i, &rx_clock, 1, NULL));
    AGAIN(fmi3.SetClock(i, &rx_clock, SIZE_MAX, &on));
    AGAIN(fmi3.SetClock(i, &rx_data, 1, &on));
    AGAIN(fmi3.GetClock(i, &rx_clock, 1, NULL));
    AGAIN(fmi3.GetClock(i, bad, 2, states));
    AGAIN(fmi3.GetIntervalDecimal(i, &tx_clock, 1, NULL, qualifier));
    AGAIN(fmi3.GetIntervalDecimal(i, &tx_clock, 1, interval, NULL));
    AGAIN(fmi3.GetIntervalDecimal(i, NULL, 1, interval, qualifier));
    AGAIN(fmi3.GetIntervalDecimal(i, &rx_clock, 1, interval, qualifier));
    AGAIN(fmi3.GetIntervalDecimal(i, &rx_data, 1, interval, qualifier));
    AGAIN(fmi3.SetIntervalDecimal(i, &tx_clock, 1, interval));
    AGAIN(fmi3.GetShiftDecimal(i, &tx_clock, 1, interval));
    AGAIN(fmi3.GetFloat64(i, &rx_data, 1, interval, 1));
    AGAIN(fmi3.SetFloat64(i, &rx_clock, 1, interval, 1));
    /* Twice the same reference, and the clock that still ticks after all that. */
    const unsigned twice[2] = {rx_clock, rx_clock};
    STATUS(OK, fmi3.GetClock(i, twice, 2, states));
    EXPECT(states[0] && states[1]);
    STATUS(OK, fmi3.SetBinary(i, &rx_data, 1, &size, &bytes, 1));
    STATUS(OK, fmi3.GetBinary(i, &rx_data, 1, &size, got, 1));
    EXPECT(size == 4 && memcmp(got[0], some, 4) == 0);
    STATUS(OK, fmi3.FreeFMUState(i, &kept));
    fmi3.FreeInstance(i);
}

static void order(void) {
    const uint8_t some[1] = {1}, *bytes = some, *got = NULL;
    size_t size = 1;
    bool on = true;
    /* There is no such model of FMI 2.0. */
    EXPECT(fmi2.Instantiate("abused", 1, TOKEN_BUS2, NULL, NULL, 0, 0) == NULL);
    /* A start value before the initialization; nothing ticks there. */
    Handle i = new_bus(NULL, false);
    STATUS(OK, fmi3.SetBinary(i, &rx_data, 1, &size, &bytes, 1));
    STATUS(OK, fmi3.GetBinary(i, &rx_data, 1, &size, &got, 1));
    EXPECT(size == 1 && got[0] == 1);
    STATUS(ERROR, fmi3.SetClock(i, &rx_clock, 1, &on));
    STATUS(OK, fmi3.Reset(i));
    STATUS(OK, fmi3.GetBinary(i, &rx_data, 1, &size, &got, 1));
    EXPECT(size == 0);
    /* In step mode neither. */
    start_bus(i);
    STATUS(OK, fmi3.EnterStepMode(i));
    STATUS(ERROR, fmi3.SetClock(i, &rx_clock, 1, &on));
    STATUS(OK, fmi3.Reset(i));
    start_bus(i);
    STATUS(OK, fmi3.EnterStepMode(i));
    STATUS(ERROR, fmi3.SetBinary(i, &rx_data, 1, &size, &bytes, 1));
    STATUS(OK, fmi3.GetBinary(i, &tx_data, 1, &size, &got, 1));
    EXPECT(size == 0);
    /* Steps that can't be, and that end nowhere. */
    STATUS(OK, fmi3.Reset(i));
    start_bus(i);
    STATUS(OK, fmi3.EnterStepMode(i));
    bool flag;
    double last;
    STATUS(DISCARD, fmi3.DoStep(i, NAN, 1.0, true, &flag, &flag, &flag, &last));
    STATUS(OK, fmi3.DoStep(i, 0.0, 1e308, true, &flag, &flag, &flag, &last));
    STATUS(DISCARD, fmi3.DoStep(i, 1e308, 1e308, true, &flag, &flag, &flag, &last));
    STATUS(OK, fmi3.EnterEventMode(i));
    drain(i);
    STATUS(OK, fmi3.Terminate(i));
    STATUS(ERROR, fmi3.SetClock(i, &rx_clock, 1, &on));
    fmi3.FreeInstance(i);
}

/* One operation, or what looks like one. */
static size_t scribble(uint8_t *to) {
    static const uint32_t codes[] = {0x01, 0x10, 0x10, 0x10, 0x11, 0x12, 0x20, 0x30, 0x31, 0x40, 0x41, 0x42, 0x99};
    uint32_t code = codes[next_random(&dice) % 13], length = 8 + next_random(&dice) % 90;
    uint32_t said = next_random(&dice) % 16 ? length : next_random(&dice);
    memcpy(to, &code, 4);
    memcpy(to + 4, &said, 4);
    for (uint32_t n = 8; n < length; n++) to[n] = next_random(&dice) % 3 ? 0 : (uint8_t)next_random(&dice);
    if (code == 0x10 && length >= 24) {
        /* A classic frame of the harness that is right but for its data. */
        uint32_t id = (next_random(&dice) % 29) << 5 | next_random(&dice) % 16;
        uint32_t exact = 24;
        memcpy(to + 4, &exact, 4);
        memcpy(to + 8, &id, 4);
        memset(to + 12, 0, 2);
        to[14] = 8, to[15] = 0;
        return 24;
    }
    return length;
}

static void nonsense(unsigned calls) {
    static uint8_t bytes[65536];
    for (int notifications = 0; notifications < 2; notifications++) {
        Handle kept = NULL, i = new_bus(NULL, notifications);
        start_bus(i);
        size_t said = drain(i);
        EXPECT(said > 0);
        for (unsigned n = 0; n < calls / 20; n++) {
            size_t size = 0;
            for (unsigned k = next_random(&dice) % 12; k > 0; k--) size += scribble(bytes + size);
            if (next_random(&dice) % 8 == 0) size = next_random(&dice) % 200;
            STATUS(OK, receive(i, bytes, size));
            if (n % 64 == 0) {
                STATUS(OK, fmi3.GetFMUState(i, &kept));
                size_t length = 0;
                STATUS(OK, fmi3.SerializedFMUStateSize(i, kept, &length));
                uint8_t *state = malloc(length);
                STATUS(OK, fmi3.SerializeFMUState(i, kept, state, length));
                Handle read = NULL;
                STATUS(OK, fmi3.DeserializeFMUState(i, state, length, &read));
                STATUS(OK, fmi3.SetFMUState(i, read));
                STATUS(OK, fmi3.FreeFMUState(i, &read));
                state[next_random(&dice) % length] ^= 1;
                STATUS(ERROR, fmi3.DeserializeFMUState(i, state, length, &read));
                free(state);
                STATUS(OK, fmi3.SetFMUState(i, kept));
            }
            drain(i);
        }
        memset(bytes, 0xFF, sizeof bytes);
        STATUS(OK, receive(i, bytes, 65535));
        drain(i);
        const unsigned mode = BUS_MODE;
        int64_t code = -1;
        STATUS(OK, fmi3.GetInt64(i, &mode, 1, &code, 1));
        EXPECT(code == 0);
        /* As if nothing had been. */
        STATUS(OK, fmi3.Reset(i));
        if (!notifications) {
            start_bus(i);
            EXPECT(drain(i) == said);
        }
        fmi3.FreeInstance(i);
    }
}

/* Every function, in any order. */
static void randomly(unsigned calls) {
    static const unsigned references[6] = {BUS_RX_CLOCK, BUS_RX_DATA, BUS_TX_CLOCK, BUS_TX_DATA, BUS_MODE, 1u << 30};
    int seen[5] = {0};
    uint8_t scratch[256];
    Handle states[4] = {NULL}, i = new_bus(NULL, false);
    for (unsigned n = 0; n < calls; n++) {
        unsigned reference = references[next_random(&dice) % 6];
        size_t size = scribble(scratch), count = next_random(&dice) % 3 ? 1 : 0;
        const uint8_t *bytes = scratch, *got;
        bool on = next_random(&dice) % 4, flag;
        double number = next_random(&dice) % 2 ? 0.005 : NAN, last = 0;
        int qualifier, status;
        const unsigned now = 0;
        Handle *state = &states[next_random(&dice) % 4];
        switch (next_random(&dice) % 16) {
        case 0: status = fmi3.EnterInitializationMode(i, false, 0.0, 0.0, false, 0.0); break;
        case 1: status = fmi3.ExitInitializationMode(i); break;
        case 2: status = fmi3.EnterEventMode(i); break;
        case 3: status = fmi3.EnterStepMode(i); break;
        case 4: status = fmi3.GetFMUState(i, state); break;
        case 5: status = fmi3.SetFMUState(i, *state); break;
        case 6: status = fmi3.SetClock(i, &reference, count, &on); break;
        case 7: status = fmi3.GetClock(i, &reference, count, &flag); break;
        case 8: case 9: status = fmi3.SetBinary(i, &reference, count, &size, &bytes, count); break;
        case 10: status = fmi3.GetBinary(i, &reference, count, &size, &got, count); break;
        case 11: status = fmi3.GetIntervalDecimal(i, &reference, count, &last, &qualifier); break;
        case 12: status = update(i); break;
        case 13: status = receive(i, scratch, size); break;
        default:
            status = fmi3.GetFloat64(i, &now, 1, &last, 1);
            if (status == OK) status = fmi3.DoStep(i, last, number, true, &flag, &flag, &flag, &last);
        }
        EXPECT(status >= OK && status < FATAL);
        seen[status]++;
        if (status == ERROR && next_random(&dice) % 4) {
            STATUS(OK, fmi3.Reset(i));
            if (next_random(&dice) % 4) start_bus(i);
        }
    }
    EXPECT(seen[OK] > 0 && seen[ERROR] > 0);
    fmi3.FreeInstance(i);
}

void abuse_bus(unsigned calls) {
    arrays();
    order();
    nonsense(calls);
    randomly(calls);
}
