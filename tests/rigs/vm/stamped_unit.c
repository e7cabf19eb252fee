// A unit whose clock PTP sets, as far as a program can be one: it reads the clock of the network card, waits,
// and then sends a reading with the time that it read. The wait is the delay of its line.
//
// And what keeps that clock, in place of a program that speaks PTP: the clock of QEMU's network card stands still
// between two settings.
//
// Usage: stamped_unit CLOCK PORT PERIOD_MS DELAY_MS
//        stamped_unit CLOCK keep PERIOD_MS
#include <arpa/inet.h>
#include <fcntl.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

// Sleeps until so long after the last time that this was called for.
static void sleep_ms(long ms) {
    static struct timespec until;
    if (until.tv_sec == 0) clock_gettime(CLOCK_MONOTONIC, &until);
    until.tv_nsec += ms * 1000000;
    until.tv_sec += until.tv_nsec / 1000000000;
    until.tv_nsec %= 1000000000;
    while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, NULL) != 0) {}
}

int main(int count, char **words) {
    int keeps = count == 4 && strcmp(words[2], "keep") == 0;
    if (!keeps && count != 5) return 2;
    int device = open(words[1], keeps ? O_RDWR : O_RDONLY), line = socket(AF_INET, SOCK_DGRAM, 0);
    if (device < 0 || line < 0) { perror(words[1]); return 1; }
    // The id of a clock that a device is, from linux/posix-timers.h.
    clockid_t clock = (clockid_t)(~(unsigned)device << 3 | 3);
    while (keeps) {
        struct timespec before, now;
        if (clock_gettime(clock, &before) != 0) { perror("clock_gettime"); return 1; }
        clock_gettime(CLOCK_REALTIME, &now); // TAI is 37 s ahead of it
        now.tv_sec += 37;
        // So far behind was the clock until now: what keeps it was starved.
        double behind_ms = (double)(now.tv_sec - before.tv_sec) * 1e3 + (double)(now.tv_nsec - before.tv_nsec) * 1e-6;
        if (behind_ms > 9.0 && behind_ms < 1e6) { printf("%d\n", (int)behind_ms + 1); fflush(stdout); }
        if (clock_settime(clock, &now) != 0) { perror("clock_settime"); return 1; }
        sleep_ms(atol(words[3]));
    }
    struct sockaddr_in to = {.sin_family = AF_INET, .sin_port = htons((uint16_t)atoi(words[2]))};
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    for (unsigned number = 0;; number++) {
        struct timespec now;
        if (clock_gettime(clock, &now) != 0) { perror("clock_gettime"); return 1; }
        uint64_t stamp_ns = (uint64_t)now.tv_sec * 1000000000u + (uint64_t)now.tv_nsec;
        float values[6] = {1e-5f, 0, 0, 0, 0, 9.8f};
        uint8_t frame[36] = "PT", sum = 0;
        memcpy(frame + 2, &stamp_ns, 8);
        memcpy(frame + 10, values, 24);
        frame[34] = (uint8_t)number;
        for (int i = 0; i < 35; i++) sum += frame[i];
        frame[35] = sum;
        sleep_ms(atol(words[4]));
        // Nobody may listen yet.
        sendto(line, frame, sizeof frame, 0, (struct sockaddr *)&to, sizeof to);
        sleep_ms(atol(words[3]) - atol(words[4]));
    }
}
