/* Steps the plant and the calibrator of one platform in closed loop, as a tool for FMI 3.0 would, and prints a hash of the
 * bits of all outputs after every step.
 *
 *   platforms PLANT CALIBRATOR STEPS     libraries of this platform
 *
 * wiring.h is made from both model descriptions by tests/rigs/fmu/platforms.py. The functions are declared here, by the text
 * of the standard, and not taken from Octant. */
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#ifdef _WIN32
#include <windows.h>
#define OPEN(path) ((void *)LoadLibraryA(path))
#define FIND(library, name) ((void *)(uintptr_t)GetProcAddress((HMODULE)(library), name))
#else
#include <dlfcn.h>
#define OPEN(path) dlopen(path, RTLD_NOW | RTLD_LOCAL)
#define FIND(library, name) dlsym(library, name)
#endif

/* Variables of one type: F Float64, I Int32, U UInt64, B Boolean, E enumeration. */
struct variable { char type; uint32_t reference; size_t count; };
struct wire { struct variable from; uint32_t to; };
#include "wiring.h"

enum { TYPES = 5, VALUES_MAX = 16 };
static const char LETTERS[] = "FIUBE";
static const char *NAME[TYPES] = {"Float64", "Int32", "UInt64", "Boolean", "Int64"};
static const size_t BYTES[TYPES] = {8, 4, 8, sizeof(bool), 8};

typedef void *instance;
typedef int get_t(instance, const uint32_t *, size_t, void *, size_t);
typedef int set_t(instance, const uint32_t *, size_t, const void *, size_t);
typedef void log_t(void *, int, const char *, const char *);
typedef instance instantiate_t(const char *, const char *, const char *, bool, bool, bool, bool, const uint32_t *, size_t,
                               void *, log_t *, void *);
typedef int initialize_t(instance, bool, double, double, bool, double);
typedef int plain_t(instance);
typedef void free_t(instance);
typedef int step_t(instance, double, double, bool, bool *, bool *, bool *, double *);

struct unit {
  instance handle;
  get_t *get[TYPES];
  set_t *set[TYPES];
  plain_t *terminate;
  free_t *free;
  step_t *step;
};

static void must(bool holds, const char *what) {
  if (holds) return;
  fprintf(stderr, "failed: %s\n", what);
  exit(1);
}

static void *function(void *library, const char *prefix, const char *name) {
  char whole[64];
  snprintf(whole, sizeof whole, "fmi3%s%s", prefix, name);
  void *found = FIND(library, whole);
  must(found != NULL, whole);
  return found;
}

static void told(void *environment, int status, const char *category, const char *message) {
  (void)environment;
  fprintf(stderr, "%d %s: %s\n", status, category, message);
}

static struct unit start(const char *path, const char *token) {
  void *library = OPEN(path);
  must(library != NULL, path);
  struct unit unit;
  for (int type = 0; type < TYPES; type++) {
    unit.get[type] = (get_t *)function(library, "Get", NAME[type]);
    unit.set[type] = (set_t *)function(library, "Set", NAME[type]);
  }
  unit.step = (step_t *)function(library, "", "DoStep");
  unit.terminate = (plain_t *)function(library, "", "Terminate");
  unit.free = (free_t *)function(library, "", "FreeInstance");
  instantiate_t *instantiate = (instantiate_t *)function(library, "", "InstantiateCoSimulation");
  unit.handle = instantiate("loop", token, NULL, false, false, false, false, NULL, 0, NULL, told, NULL);
  must(unit.handle != NULL, "fmi3InstantiateCoSimulation");
  initialize_t *enter = (initialize_t *)function(library, "", "EnterInitializationMode");
  must(enter(unit.handle, false, 0, 0, false, 0) == 0, "fmi3EnterInitializationMode");
  must(((plain_t *)function(library, "", "ExitInitializationMode"))(unit.handle) == 0, "fmi3ExitInitializationMode");
  return unit;
}

static int type_of(char letter) { return (int)(strchr(LETTERS, letter) - LETTERS); }

/* Values of a variable; the number of bytes. */
static size_t get(const struct unit *unit, struct variable of, void *values) {
  int type = type_of(of.type);
  must(of.count <= VALUES_MAX, "a variable of at most 16 elements");
  must(unit->get[type](unit->handle, &of.reference, 1, values, of.count) == 0, "fmi3Get");
  return of.count * BYTES[type];
}

static void pass(const struct unit *from, const struct unit *to, const struct wire *wires, size_t count) {
  uint64_t values[VALUES_MAX];
  for (size_t i = 0; i < count; i++) {
    int type = type_of(wires[i].from.type);
    get(from, wires[i].from, values);
    must(to->set[type](to->handle, &wires[i].to, 1, values, wires[i].from.count) == 0, "fmi3Set");
  }
}

/* FNV-1a over the bytes of all outputs, which are little-endian on every platform here. */
static uint64_t hash_outputs(uint64_t hash, const struct unit *unit, const struct variable *outputs, size_t count) {
  for (size_t i = 0; i < count; i++) {
    uint64_t values[VALUES_MAX];
    size_t bytes = get(unit, outputs[i], values);
    for (size_t at = 0; at < bytes; at++) hash = (hash ^ ((unsigned char *)values)[at]) * 1099511628211u;
  }
  return hash;
}

#define COUNT(array) (sizeof(array) / sizeof(array)[0])

int main(int count, char **arguments) {
  must(count == 4, "three arguments: PLANT CALIBRATOR STEPS");
  struct unit plant = start(arguments[1], PLANT_TOKEN), core = start(arguments[2], CALIBRATOR_TOKEN);
  long steps = strtol(arguments[3], NULL, 10);
  uint64_t hash = 14695981039346656037u;
  bool event, end, early;
  double last;
  for (long k = 0; k < steps; k++) {
    pass(&plant, &core, TO_CALIBRATOR, COUNT(TO_CALIBRATOR));
    pass(&core, &plant, TO_PLANT, COUNT(TO_PLANT));
    must(plant.step(plant.handle, k * 0.005, 0.005, true, &event, &end, &early, &last) == 0, "fmi3DoStep of the plant");
    must(core.step(core.handle, k * 0.005, 0.005, true, &event, &end, &early, &last) == 0, "fmi3DoStep of the core");
    hash = hash_outputs(hash, &plant, PLANT_OUTPUTS, COUNT(PLANT_OUTPUTS));
    hash = hash_outputs(hash, &core, CALIBRATOR_OUTPUTS, COUNT(CALIBRATOR_OUTPUTS));
  }
  uint64_t latitude[VALUES_MAX];
  get(&core, NAVIGATION_LATITUDE, latitude);
  printf("%ld steps, outputs %016llx, navigation.latitude %016llx\n", steps, (unsigned long long)hash,
         (unsigned long long)latitude[0]);
  must(plant.terminate(plant.handle) == 0 && core.terminate(core.handle) == 0, "fmi3Terminate");
  plant.free(plant.handle);
  core.free(core.handle);
  return 0;
}
