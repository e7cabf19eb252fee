/* The program `octant` of the wheel: loads the extension module, which holds the program too, and runs it without Python.
 * So the code is in the wheel once, and a process starts as fast as the program alone.
 *
 * stubs.h, which tests/wheel makes, defines the symbols of Python that the module asks for: nothing of the program uses them,
 * but the loader wants them all. OCTANT_PROGRAM is the name of the function, with the version. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <glob.h>
#include <limits.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include "stubs.h"

/* Where pip puts packages, seen from the folder of the program: environments and prefixes, Debian's own prefix, `--target`. */
static const char *const PLACES[] = {
    "../lib/python3*/site-packages", "../lib64/python3*/site-packages", "../lib/python3*/dist-packages", "../..",
};

typedef int program(void);

static program *load(const char *folder, char *why, size_t size) {
  for (size_t i = 0; i < sizeof PLACES / sizeof *PLACES; i++) {
    char pattern[2 * PATH_MAX];
    snprintf(pattern, sizeof pattern, "%s/octant/_octant.abi3.so", PLACES[i]);
    glob_t found;
    /* From inside the folder: its own name may have characters of patterns. */
    if (chdir(folder) != 0 || glob(pattern, 0, NULL, &found) != 0) continue;
    for (size_t k = 0; k < found.gl_pathc; k++) {
      char path[PATH_MAX];
      if (realpath(found.gl_pathv[k], path) == NULL) continue;
      void *module = dlopen(path, RTLD_LAZY | RTLD_LOCAL);
      program *start = module == NULL ? NULL : (program *)dlsym(module, OCTANT_PROGRAM);
      if (start != NULL) {
        globfree(&found);
        return start;
      }
      snprintf(why, size, "%s", dlerror());
    }
    globfree(&found);
  }
  return NULL;
}

int main(void) {
  char file[PATH_MAX], why[512] = "no file octant/_octant.abi3.so in the packages beside it";
  ssize_t length = readlink("/proc/self/exe", file, sizeof file - 1);
  if (length < 0) {
    fprintf(stderr, "error: failed to find the program's own file: %s\n", strerror(errno));
    return 4;
  }
  file[length] = 0;
  *strrchr(file, '/') = 0;
  int here = open(".", O_PATH | O_CLOEXEC);
  program *start = here < 0 ? NULL : load(file, why, sizeof why);
  if (here < 0 || fchdir(here) != 0) {
    fprintf(stderr, "error: failed to come back to the current folder: %s\n", strerror(errno));
    return 4;
  }
  close(here);
  if (start == NULL) {
    fprintf(stderr, "error: failed to load octant of this wheel from %s: %s\n", file, why);
    return 4;
  }
  /* As at the start of every Rust program: a reader that has gone is an error of a write, not the end. */
  signal(SIGPIPE, SIG_IGN);
  return start();
}
