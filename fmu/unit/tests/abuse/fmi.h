/* The functions of both standards, by name from a library, and what the abuse shares. */
#ifndef FMI_H
#define FMI_H

#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Value references and tokens of the Calibrator, written by the test from its table. */
#include "calibrator.h"

enum { OK, WARNING, DISCARD, ERROR, FATAL };

typedef void *Handle;
typedef void (*Logger2)(void *, const char *, int, const char *, const char *, ...);
typedef struct {
    Logger2 logger;
    void *(*allocate)(size_t, size_t);
    void (*free)(void *);
    void (*finished)(void *, int);
    void *environment;
} Callbacks2;
typedef void (*Logger3)(void *, int, const char *, const char *);
typedef struct {
    int need, terminate, nominals, values, defined;
    double time;
} EventInfo2;

#define FMI2(F) \
    F(const char *, GetTypesPlatform, (void)) \
    F(const char *, GetVersion, (void)) \
    F(int, SetDebugLogging, (Handle, int, size_t, const char *const *)) \
    F(Handle, Instantiate, (const char *, int, const char *, const char *, const Callbacks2 *, int, int)) \
    F(void, FreeInstance, (Handle)) \
    F(int, SetupExperiment, (Handle, int, double, double, int, double)) \
    F(int, EnterInitializationMode, (Handle)) \
    F(int, ExitInitializationMode, (Handle)) \
    F(int, Terminate, (Handle)) \
    F(int, Reset, (Handle)) \
    F(int, GetReal, (Handle, const unsigned *, size_t, double *)) \
    F(int, GetInteger, (Handle, const unsigned *, size_t, int *)) \
    F(int, GetBoolean, (Handle, const unsigned *, size_t, int *)) \
    F(int, GetString, (Handle, const unsigned *, size_t, const char **)) \
    F(int, SetReal, (Handle, const unsigned *, size_t, const double *)) \
    F(int, SetInteger, (Handle, const unsigned *, size_t, const int *)) \
    F(int, SetBoolean, (Handle, const unsigned *, size_t, const int *)) \
    F(int, SetString, (Handle, const unsigned *, size_t, const char *const *)) \
    F(int, GetFMUstate, (Handle, Handle *)) \
    F(int, SetFMUstate, (Handle, Handle)) \
    F(int, FreeFMUstate, (Handle, Handle *)) \
    F(int, SerializedFMUstateSize, (Handle, Handle, size_t *)) \
    F(int, SerializeFMUstate, (Handle, Handle, char *, size_t)) \
    F(int, DeSerializeFMUstate, (Handle, const char *, size_t, Handle *)) \
    F(int, GetDirectionalDerivative, (Handle, const unsigned *, size_t, const unsigned *, size_t, const double *, double *)) \
    F(int, EnterEventMode, (Handle)) \
    F(int, NewDiscreteStates, (Handle, EventInfo2 *)) \
    F(int, EnterContinuousTimeMode, (Handle)) \
    F(int, CompletedIntegratorStep, (Handle, int, int *, int *)) \
    F(int, SetTime, (Handle, double)) \
    F(int, SetContinuousStates, (Handle, const double *, size_t)) \
    F(int, GetDerivatives, (Handle, double *, size_t)) \
    F(int, GetEventIndicators, (Handle, double *, size_t)) \
    F(int, GetContinuousStates, (Handle, double *, size_t)) \
    F(int, GetNominalsOfContinuousStates, (Handle, double *, size_t)) \
    F(int, SetRealInputDerivatives, (Handle, const unsigned *, size_t, const int *, const double *)) \
    F(int, GetRealOutputDerivatives, (Handle, const unsigned *, size_t, const int *, double *)) \
    F(int, DoStep, (Handle, double, double, int)) \
    F(int, CancelStep, (Handle)) \
    F(int, GetStatus, (Handle, int, int *)) \
    F(int, GetRealStatus, (Handle, int, double *)) \
    F(int, GetIntegerStatus, (Handle, int, int *)) \
    F(int, GetBooleanStatus, (Handle, int, int *)) \
    F(int, GetStringStatus, (Handle, int, const char **))

#define ACCESS3(F, Name, Type) \
    F(int, Get##Name, (Handle, const unsigned *, size_t, Type *, size_t)) \
    F(int, Set##Name, (Handle, const unsigned *, size_t, const Type *, size_t))

#define FMI3(F) \
    F(const char *, GetVersion, (void)) \
    F(int, SetDebugLogging, (Handle, bool, size_t, const char *const *)) \
    F(Handle, InstantiateModelExchange, (const char *, const char *, const char *, bool, bool, void *, Logger3)) \
    F(Handle, InstantiateCoSimulation, (const char *, const char *, const char *, bool, bool, bool, bool, const unsigned *, size_t, void *, Logger3, void *)) \
    F(Handle, InstantiateScheduledExecution, (const char *, const char *, const char *, bool, bool, void *, Logger3, void *, void *, void *)) \
    F(void, FreeInstance, (Handle)) \
    F(int, EnterInitializationMode, (Handle, bool, double, double, bool, double)) \
    F(int, ExitInitializationMode, (Handle)) \
    F(int, EnterEventMode, (Handle)) \
    F(int, Terminate, (Handle)) \
    F(int, Reset, (Handle)) \
    ACCESS3(F, Float32, float) \
    ACCESS3(F, Float64, double) \
    ACCESS3(F, Int8, int8_t) \
    ACCESS3(F, UInt8, uint8_t) \
    ACCESS3(F, Int16, int16_t) \
    ACCESS3(F, UInt16, uint16_t) \
    ACCESS3(F, Int32, int32_t) \
    ACCESS3(F, UInt32, uint32_t) \
    ACCESS3(F, Int64, int64_t) \
    ACCESS3(F, UInt64, uint64_t) \
    ACCESS3(F, Boolean, uint8_t) \
    F(int, GetString, (Handle, const unsigned *, size_t, const char **, size_t)) \
    F(int, SetString, (Handle, const unsigned *, size_t, const char *const *, size_t)) \
    F(int, GetBinary, (Handle, const unsigned *, size_t, size_t *, const uint8_t **, size_t)) \
    F(int, SetBinary, (Handle, const unsigned *, size_t, const size_t *, const uint8_t *const *, size_t)) \
    F(int, GetClock, (Handle, const unsigned *, size_t, bool *)) \
    F(int, SetClock, (Handle, const unsigned *, size_t, const bool *)) \
    F(int, GetNumberOfVariableDependencies, (Handle, unsigned, size_t *)) \
    F(int, GetVariableDependencies, (Handle, unsigned, size_t *, unsigned *, size_t *, int *, size_t)) \
    F(int, GetFMUState, (Handle, Handle *)) \
    F(int, SetFMUState, (Handle, Handle)) \
    F(int, FreeFMUState, (Handle, Handle *)) \
    F(int, SerializedFMUStateSize, (Handle, Handle, size_t *)) \
    F(int, SerializeFMUState, (Handle, Handle, uint8_t *, size_t)) \
    F(int, DeserializeFMUState, (Handle, const uint8_t *, size_t, Handle *)) \
    F(int, GetDirectionalDerivative, (Handle, const unsigned *, size_t, const unsigned *, size_t, const double *, size_t, double *, size_t)) \
    F(int, GetAdjointDerivative, (Handle, const unsigned *, size_t, const unsigned *, size_t, const double *, size_t, double *, size_t)) \
    F(int, EnterConfigurationMode, (Handle)) \
    F(int, ExitConfigurationMode, (Handle)) \
    F(int, GetIntervalDecimal, (Handle, const unsigned *, size_t, double *, int *)) \
    F(int, GetIntervalFraction, (Handle, const unsigned *, size_t, uint64_t *, uint64_t *, int *)) \
    F(int, GetShiftDecimal, (Handle, const unsigned *, size_t, double *)) \
    F(int, GetShiftFraction, (Handle, const unsigned *, size_t, uint64_t *, uint64_t *)) \
    F(int, SetIntervalDecimal, (Handle, const unsigned *, size_t, const double *)) \
    F(int, SetIntervalFraction, (Handle, const unsigned *, size_t, const uint64_t *, const uint64_t *)) \
    F(int, SetShiftDecimal, (Handle, const unsigned *, size_t, const double *)) \
    F(int, SetShiftFraction, (Handle, const unsigned *, size_t, const uint64_t *, const uint64_t *)) \
    F(int, EvaluateDiscreteStates, (Handle)) \
    F(int, UpdateDiscreteStates, (Handle, bool *, bool *, bool *, bool *, bool *, double *)) \
    F(int, EnterContinuousTimeMode, (Handle)) \
    F(int, CompletedIntegratorStep, (Handle, bool, bool *, bool *)) \
    F(int, SetTime, (Handle, double)) \
    F(int, SetContinuousStates, (Handle, const double *, size_t)) \
    F(int, GetContinuousStateDerivatives, (Handle, double *, size_t)) \
    F(int, GetEventIndicators, (Handle, double *, size_t)) \
    F(int, GetContinuousStates, (Handle, double *, size_t)) \
    F(int, GetNominalsOfContinuousStates, (Handle, double *, size_t)) \
    F(int, GetNumberOfEventIndicators, (Handle, size_t *)) \
    F(int, GetNumberOfContinuousStates, (Handle, size_t *)) \
    F(int, EnterStepMode, (Handle)) \
    F(int, GetOutputDerivatives, (Handle, const unsigned *, size_t, const int32_t *, double *, size_t)) \
    F(int, DoStep, (Handle, double, double, bool, bool *, bool *, bool *, double *)) \
    F(int, ActivateModelPartition, (Handle, unsigned, double))

#define MEMBER(Result, Name, Arguments) Result(*Name) Arguments;
typedef struct {
    FMI2(MEMBER)
} Functions2;
typedef struct {
    FMI3(MEMBER)
} Functions3;
extern Functions2 fmi2;
extern Functions3 fmi3;

/* One sample period, s. */
#define PERIOD 0.005

/* What was expected and found otherwise, so far. */
extern int failures;
void expect_that(bool good, const char *what, const char *file, int line);
void expect_status(int found, int expected, const char *what, const char *file, int line);
#define EXPECT(good) expect_that((good), #good, __FILE__, __LINE__)
#define STATUS(expected, call) expect_status((call), (expected), #call, __FILE__, __LINE__)

/* Messages: how many, and the last. */
typedef struct {
    int count;
    int status;
    char category[64];
    char text[512];
} Heard;
void hear2(void *environment, const char *name, int status, const char *category, const char *format, ...);
void hear3(void *environment, int status, const char *category, const char *text);

/* Instances; null loggers where `heard` is null. */
Handle new2(Heard *heard);
Handle new3(Heard *heard, bool events);
/* From an instance to its first step. A given alignment, so that the filter runs at once. */
void start2(Handle c);
void start3(Handle i, bool events);

/* Sample k of a level instrument at rest, from 1: sets all inputs. */
int set_sample2(Handle c, unsigned k);
int set_sample3(Handle i, unsigned k);
/* One step; sample k is the one that is taken. */
int step2(Handle c, unsigned k);
int step3(Handle i, unsigned k);
/* A hash of all outputs and of the time. */
uint64_t outputs2(Handle c);
uint64_t outputs3(Handle i);
/* The outputs after `steps` samples of an undisturbed instance. */
uint64_t undisturbed(unsigned steps);

/* A number, every time another. */
uint32_t next_random(uint64_t *state);

void abuse_handles(void);
void abuse_order2(void);
void abuse_order3(void);
void abuse_values(void);
void abuse_time(void);
void abuse_states(void);
void abuse_randomly(unsigned calls);
void abuse_threads(unsigned steps);
void abuse_bus(unsigned calls);
void abuse_stack(void);

#endif
