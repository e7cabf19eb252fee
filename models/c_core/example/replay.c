/* Gives recorded samples to a core, and writes its answers.
 *
 *     replay CONFIG SAMPLES ANSWERS
 *
 * CONFIG is an octant_config. SAMPLES has, one after another, an octant_sample, an octant_aiding and whether the
 * reference is one (8 bytes, 0 or 1). ANSWERS gets an octant_output for each sample and one for the end, then the
 * parameters and their sigma. All are the structures as they lie in memory. In the middle the core is copied, and the
 * copy goes on. */
#include <stdio.h>
#include <stdlib.h>

#include "octant_core.h"

static void failed(const char *what, const char *why) {
    fprintf(stderr, "replay: %s: %s\n", what, why);
    exit(1);
}

static void *room(void) {
    size_t align = octant_core_align();
    size_t size = (octant_core_size() + align - 1) / align * align;
    void *memory = aligned_alloc(align < sizeof(void *) ? sizeof(void *) : align, size);
    if (memory == NULL) failed("memory", "there is none");
    return memory;
}

static void good(const char *what, int32_t code) {
    if (code != OCTANT_OK) failed(what, octant_status_text(code));
}

int main(int argc, char **argv) {
    static octant_config config;
    octant_sample sample;
    octant_aiding aiding;
    octant_output output;
    uint64_t has_aiding;
    double value[OCTANT_PARAMETERS], sigma[OCTANT_PARAMETERS];
    char why[200] = "";
    octant_core *core, *copy;
    unsigned long count = 0;

    if (argc != 4) failed("arguments", "expected CONFIG SAMPLES ANSWERS");
    FILE *from = fopen(argv[1], "rb");
    if (from == NULL || fread(&config, sizeof config, 1, from) != 1) failed(argv[1], "not an octant_config");
    fclose(from);
    int32_t code = octant_core_make(room(), octant_core_size(), &config, &core, why, sizeof why);
    if (code != OCTANT_OK) failed(argv[1], why[0] ? why : octant_status_text(code));
    FILE *samples = fopen(argv[2], "rb"), *answers = fopen(argv[3], "wb");
    if (samples == NULL || answers == NULL) failed(argv[2], "can not be read, or the answers not be written");
    while (fread(&sample, sizeof sample, 1, samples) == 1) {
        if (fread(&aiding, sizeof aiding, 1, samples) != 1 || fread(&has_aiding, sizeof has_aiding, 1, samples) != 1) {
            failed(argv[2], "ends within a sample");
        }
        good("step", octant_core_step(core, &sample, has_aiding ? &aiding : NULL, &output));
        fwrite(&output, sizeof output, 1, answers);
        if (++count == 5000) {
            good("copy", octant_core_copy(core, room(), octant_core_size(), &copy));
            core = copy;
        }
    }
    good("end", octant_core_end(core, &output));
    fwrite(&output, sizeof output, 1, answers);
    good("parameters", octant_core_parameters(core, &value, &sigma));
    fwrite(value, sizeof value, 1, answers);
    fwrite(sigma, sizeof sigma, 1, answers);
    if (fclose(answers) != 0) failed(argv[3], "can not be written");
    good("refusal", octant_core_refusal(core, why, sizeof why));
    printf("%lu samples, mode %d%s%s\n", count, (int)output.mode, why[0] ? ", refused: " : "", why);
    return 0;
}
