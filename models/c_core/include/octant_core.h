/* The calibration core for programs in C.
 *
 * The core is a state machine that takes one inertial sample after another, with a reference when there is one, and
 * answers with a gimbal command, its navigation solution and its health. It lives in memory that the caller gives it
 * (octant_core_size() bytes at a multiple of octant_core_align()), and has no other: it allocates nothing, has no global
 * data and reads no clock. Memory that is no longer needed is simply left: there is nothing to free. A core doesn't move:
 * to have it elsewhere, copy it with octant_core_copy. Different cores may be used by different threads at the same time.
 *
 * Angles are radians, everything is SI. A function returns OCTANT_OK or another code below; after any other code
 * nothing has changed. A pointer to a core leads to what octant_core_make, _copy or _load gave. */
#ifndef OCTANT_CORE_H
#define OCTANT_CORE_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Codes; octant_status_text has their texts. */
#define OCTANT_OK 0
#define OCTANT_NULL 1
#define OCTANT_MEMORY 2
#define OCTANT_NO_CORE 3
#define OCTANT_NO_ITEM 4
#define OCTANT_SEQUENCE 5
#define OCTANT_CONFIG 6
#define OCTANT_STATE 7
#define OCTANT_ROOM 8

#define OCTANT_STOPS_MAX 64
#define OCTANT_PARAMETERS 30

/* Stops of the gimbals, cumulative angles of at most 15.9 rad. Dwell times are relative to weight 1, above 0. */
typedef struct {
    double azimuth_rad[OCTANT_STOPS_MAX];
    double roll_rad[OCTANT_STOPS_MAX];
    double weight[OCTANT_STOPS_MAX];
    uint32_t count;
    uint32_t passes;
} octant_stops;

/* Configuration. What it means stands in docs/scenario.md under the same names. The estimator is the Kalman filter. */
typedef struct {
    double latitude_rad;
    double longitude_rad;
    double height_m;
    double alignment_duration_s;
    double alignment_q_nb[4];          /* alignment 0: unit quaternion w, x, y, z; takes b into n */
    double alignment_velocity_mps[3];  /* alignment 0: north, east, down */
    double calibration_duration_s;
    octant_stops calibration_stops;
    double prior_attitude_rad[3];      /* 1 sigma, as all priors */
    double prior_velocity_mps;
    double prior_position_m;
    double prior_parameters[7];        /* gyro bias, scale, misalignment, g-dependent; accel bias, scale, misalignment */
    double aiding_sigma;               /* m/s of a velocity, m of a position */
    double refuse_above_mean_nis;
    double navigation_duration_s;      /* 0: endless */
    double navigation_dwell_s;
    octant_stops navigation_stops;
    double turntable_rate_radps;
    double turntable_acceleration_radps2;
    double angle_random_walk;          /* rad/s^(1/2) */
    double velocity_random_walk;       /* m/s/s^(1/2) */
    double initial_parameters[OCTANT_PARAMETERS];
    double gate_nis;                   /* 0: no gate */
    double reset_attitude_rad;         /* gate_recovery 1 */
    double reset_velocity_mps;
    double reset_position_m;
    double drift_sigmas;               /* 0: no test */
    double base_angle_rad;             /* base 1 */
    double base_rate_radps;
    double base_acceleration_radps2;
    double base_force_mps2;
    double base_jerk_mps3;
    double encoder_sigma_rad;
    double resolution_theta_rad;
    double resolution_velocity_mps;
    double vibration_theta_rad;
    double vibration_velocity_mps;
    uint64_t sample_period_ns;
    uint64_t aiding_period_ns;         /* a multiple of the sample period */
    int32_t alignment;                 /* 0 given, 1 coarse, 2 inertial */
    int32_t calibrates;                /* 0 or 1, as all that follow without a list */
    int32_t navigates;
    int32_t error_model;               /* 0 phi, 1 psi */
    int32_t estimated[7];              /* groups as in prior_parameters */
    int32_t aiding;                    /* 0 velocity, 1 position */
    int32_t sway;                      /* 0 white, 1 coloured */
    int32_t gate_recovery;             /* 0 widening, 1 reset */
    int32_t base;                      /* 0 still, 1 moving */
    int32_t jumps;
    int32_t bridging;
    int32_t gimbals;
    int32_t checkpoints;
    int32_t aiding_stamps;
    uint32_t gate_rejections;
    uint32_t stuck_samples;            /* 0: no test */
} octant_config;

/* One sample. */
typedef struct {
    uint64_t sequence;                 /* from 1 */
    uint64_t device_time_ns;           /* end of its interval */
    int32_t delta_theta[3];            /* counts of 2^-36 rad */
    int32_t delta_velocity[3];         /* counts of 2^-30 m/s */
    int32_t azimuth;                   /* counts of 2^-27 rad, cumulative */
    int32_t roll;
    uint32_t status;                   /* 1 gyro, 2 accelerometer saturated; 4 gimbal, 8 inertial counts not to be used */
    uint32_t reserved;
} octant_sample;

/* A reference that holds at the end of a sample. */
typedef struct {
    double value[3];                   /* north, east, down, m/s; or latitude, longitude (rad), height (m) */
    uint64_t device_time_ns;
    int32_t kind;                      /* 0 velocity, 1 position */
    uint32_t reserved;
} octant_aiding;

/* The answer to a sample. */
typedef struct {
    double latitude_rad;
    double longitude_rad;
    double height_m;
    double velocity_mps[3];
    double q_nb[4];
    double nis;                        /* not a number where nothing was measured */
    uint64_t sequence;
    uint64_t device_time_ns;
    int32_t mode;                      /* 0 aligning, 1 calibrating, 2 refused, 3 navigating, 4 done */
    int32_t command_azimuth;           /* set point, counts of 2^-27 rad */
    int32_t command_roll;
    int32_t moving;
    uint32_t stop;
    uint32_t health;                   /* flags of octant_sample::Health */
    uint32_t parameters_revision;
    uint32_t reserved;
} octant_output;

typedef struct octant_core octant_core;

size_t octant_core_size(void);
size_t octant_core_align(void);
const char *octant_status_text(int32_t code);

/* Makes a core. Where the configuration contradicts itself, `why` gets the reason (cut off at why_size; may be null).
 * Making, copying and loading take up to 1.2 MiB of stack. */
int32_t octant_core_make(void *memory, size_t size, const octant_config *config, octant_core **core, char *why,
                         size_t why_size);
/* Changes the gate, the sigma of the reference, the check of its stamp and the limits of refusal, from the next
 * measurement on; everything else in the configuration has to be as it was. */
int32_t octant_core_tune(octant_core *core, const octant_config *config, char *why, size_t why_size);
/* Takes a sample, and a reference or null. */
int32_t octant_core_step(octant_core *core, const octant_sample *sample, const octant_aiding *aiding,
                         octant_output *output);
/* Ends the samples: a calibration that runs is concluded with what it has. */
int32_t octant_core_end(octant_core *core, octant_output *output);
/* Estimated parameters and their sigma, SI: gyro bias x y z, scale x y z, misalignment xy xz yx yz zx zy, g-dependent by
 * rows, accelerometer bias x y z, scale x y z, misalignment yx zx zy. */
int32_t octant_core_parameters(octant_core *core, double (*value)[OCTANT_PARAMETERS],
                               double (*sigma)[OCTANT_PARAMETERS]);
/* Why the calibration was refused; empty if it wasn't. */
int32_t octant_core_refusal(octant_core *core, char *text, size_t size);
/* A copy in other memory continues as the original, bit for bit. */
int32_t octant_core_copy(octant_core *core, void *memory, size_t size, octant_core **copy);

/* Only in a library that was built with the feature `state`, which allocates for them. */
#ifdef OCTANT_CORE_STATE
/* Writes the state as bytes with version and checksum, and their number; with room 0 the number alone. */
int32_t octant_core_save(octant_core *core, uint8_t *bytes, size_t room, size_t *length);
/* Makes a core that continues from the bytes, bit for bit. */
int32_t octant_core_load(void *memory, size_t size, const uint8_t *bytes, size_t length, octant_core **core);
#endif

#ifdef __cplusplus
}
#endif

#endif
