/* One instance of the model, whatever the version of the interface. */
#ifndef CORE_H
#define CORE_H

#include "fmu_model.h"
#include "motion.h"

#include <stddef.h>

/* Value references count parameters, inputs, states, derivatives, outputs and kinks, in this order; the last is time. */
enum {
    FIRST_PARAMETER = 0,
    FIRST_INPUT = FIRST_PARAMETER + PARAMETERS,
    FIRST_STATE = FIRST_INPUT + INPUTS,
    FIRST_DERIVATIVE = FIRST_STATE + STATES,
    FIRST_OUTPUT = FIRST_DERIVATIVE + STATES,
    FIRST_KINK = FIRST_OUTPUT + OUTPUTS,
    TIME_REFERENCE = FIRST_KINK + KINKS
};

/* All that a state of the simulation is. No array is of no entries. */
typedef struct {
    double time;
    double p[PARAMETERS + 1];
    double u[INPUTS + 1];
    /* How fast each input grows in the communication step to come, per second. */
    double u_rate[INPUTS + 1];
    double x[STATES + 1];
    /* The length of the next step of the integrator, s; 0 before the first. */
    double step;
} Snapshot;

typedef struct {
    Snapshot now;
    /* What depends on the parameters alone, and whether it is that of now.p. */
    double constants[CONSTANTS + 1];
    int is_prepared;
    /* Derivatives and outputs, and whether they are those of now. */
    double dx[STATES + 1], y[OUTPUTS + 1];
    int is_computed;
    /* Relative tolerance of the integrator. */
    double tolerance;
} Core;

enum { OK = 0, UNKNOWN_VARIABLE, NOT_TO_BE_SET, NOT_FINITE, TOO_STIFF, NO_DIRECTIONS };

/* What to say of such a result. */
const char *core_message(int result);

/* Start values, at time 0. */
void core_reset(Core *core);
/* The time of the start, and a tolerance, which counts where it is tighter than ours. */
void core_begin(Core *core, double start, double tolerance);
/* Goes back to where a snapshot was taken. */
void core_restore(Core *core, const Snapshot *to);

int core_get(Core *core, unsigned int reference, double *value);
int core_set(Core *core, unsigned int reference, double value);
/* The rate of an input in the communication step to come. */
int core_set_rate(Core *core, unsigned int reference, double rate);

/* All of a kind at once; the count must be right. */
int core_set_states(Core *core, const double *x, size_t count);
int core_get_states(Core *core, double *x, size_t count);
int core_get_derivatives(Core *core, double *dx, size_t count);
int core_get_kinks(Core *core, double *kinks, size_t count);
int core_get_nominals(double *nominals, size_t count);

/* What the integrator needs: dx, and the size below which a state counts as small. */
void core_compute(Core *core);
double core_nominal(int state);

/* seed and sensitivity are directions in what is known and unknown; an unknown is a derivative or an output, what is known a
 * state, an input or a parameter. */
int core_directional(Core *core, const unsigned int *unknown, size_t unknowns, const unsigned int *known, size_t knowns,
                     const double *seed, double *sensitivity);

/* Integrates from now.time for a while, with inputs that grow at their rates. */
int core_advance(Core *core, double duration);

#endif
