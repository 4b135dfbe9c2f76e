/* One instance of the model: its variables and their derivatives. */
#include "core.h"

#include <math.h>
#include <string.h>

const char *core_message(int result)
{
    switch (result) {
    case UNKNOWN_VARIABLE: return "there is no variable of this value reference here; see modelDescription.xml";
    case NOT_TO_BE_SET: return "this variable is computed and cannot be set; set parameters, inputs or states";
    case NOT_FINITE: return "a result is no finite number; correct the parameters, of which one is too large or zero";
    case TOO_STIFF: return "the model needs steps below 1e-12 s; correct its parameters";
    case NO_DIRECTIONS: return "a unit whose tyre rolls has no directional derivatives; take differences";
    default: return "";
    }
}

void core_reset(Core *core)
{
    int i;
    Snapshot *now = &core->now;
    now->time = 0.0;
    now->step = 0.0;
    motion_start(now->p, now->x);
    for (i = 0; i < INPUTS; i++)
        now->u[i] = now->u_rate[i] = 0.0;
    core->is_prepared = 0;
    core->is_computed = 0;
    core->tolerance = TOLERANCE;
}

void core_begin(Core *core, double start, double tolerance)
{
    core->now.time = start;
    if (tolerance >= 1e-13 && tolerance < TOLERANCE)
        core->tolerance = tolerance;
}

void core_restore(Core *core, const Snapshot *to)
{
    core->now = *to;
    core->is_prepared = 0;
    core->is_computed = 0;
}

static void prepare(Core *core)
{
    if (!core->is_prepared) {
        motion_prepare(core->now.p, core->constants);
        core->is_prepared = 1;
    }
}

void core_compute(Core *core)
{
    if (!core->is_computed) {
        const Snapshot *now = &core->now;
        prepare(core);
        motion_rates(core->constants, now->time, now->x, now->u, core->dx);
        motion_outputs(core->constants, now->time, now->x, now->u, core->y);
        core->is_computed = 1;
    }
}

double core_nominal(int state)
{
    static const double nominals[STATES + 1] = NOMINALS;
    return nominals[state];
}

/* Copies all of a kind, where as many are wanted as there are. */
static int copy(double *to, const double *from, size_t wanted, size_t count)
{
    if (wanted != count)
        return UNKNOWN_VARIABLE;
    memcpy(to, from, count * sizeof *to);
    return OK;
}

int core_set_states(Core *core, const double *x, size_t count)
{
    core->is_computed = 0;
    return copy(core->now.x, x, count, STATES);
}

int core_get_states(Core *core, double *x, size_t count)
{
    return copy(x, core->now.x, count, STATES);
}

int core_get_derivatives(Core *core, double *dx, size_t count)
{
    core_compute(core);
    return copy(dx, core->dx, count, STATES);
}

int core_get_kinks(Core *core, double *kinks, size_t count)
{
    double all[KINKS + 1];
    prepare(core);
    MODEL(kinks)(core->constants, core->now.x, core->now.u, all);
    return copy(kinks, all, count, KINKS);
}

int core_get_nominals(double *nominals, size_t count)
{
    size_t i;
    if (count != STATES)
        return UNKNOWN_VARIABLE;
    for (i = 0; i < count; i++)
        nominals[i] = core_nominal((int)i);
    return OK;
}

int core_get(Core *core, unsigned int reference, double *value)
{
    const int place = (int)reference;
    if (reference > TIME_REFERENCE)
        return UNKNOWN_VARIABLE;
    if (place == TIME_REFERENCE) {
        *value = core->now.time;
    } else if (place >= FIRST_KINK) {
        double kinks[KINKS + 1];
        const int result = core_get_kinks(core, kinks, KINKS);
        *value = kinks[place - FIRST_KINK];
        return result;
    } else if (place >= FIRST_OUTPUT) {
        core_compute(core);
        *value = core->y[place - FIRST_OUTPUT];
    } else if (place >= FIRST_DERIVATIVE) {
        core_compute(core);
        *value = core->dx[place - FIRST_DERIVATIVE];
    } else if (place >= FIRST_STATE) {
        *value = core->now.x[place - FIRST_STATE];
    } else if (place >= FIRST_INPUT) {
        *value = core->now.u[place - FIRST_INPUT];
    } else {
        *value = core->now.p[place];
    }
    return OK;
}

int core_set(Core *core, unsigned int reference, double value)
{
    const int place = (int)reference;
    if (reference > TIME_REFERENCE)
        return UNKNOWN_VARIABLE;
    if (place >= FIRST_DERIVATIVE)
        return NOT_TO_BE_SET;
    if (!(fabs(value) <= 1.7976931348623157e308))
        return NOT_FINITE;
    core->is_computed = 0;
    if (place >= FIRST_STATE) {
        core->now.x[place - FIRST_STATE] = value;
    } else if (place >= FIRST_INPUT) {
        core->now.u[place - FIRST_INPUT] = value;
    } else {
        core->now.p[place] = value;
        core->is_prepared = 0;
    }
    return OK;
}

int core_set_rate(Core *core, unsigned int reference, double rate)
{
    const int place = (int)reference - FIRST_INPUT;
    if (reference > TIME_REFERENCE || place < 0 || place >= INPUTS)
        return UNKNOWN_VARIABLE;
    core->now.u_rate[place] = rate;
    return OK;
}

/* The direction of what is known, spread over the places of parameters, inputs and states. */
static int spread(const unsigned int *known, size_t knowns, const double *seed, double *direction)
{
    size_t i;
    for (i = 0; i < FIRST_DERIVATIVE; i++)
        direction[i] = 0.0;
    for (i = 0; i < knowns; i++) {
        if (known[i] >= FIRST_DERIVATIVE)
            return UNKNOWN_VARIABLE;
        direction[known[i]] += seed[i];
    }
    return OK;
}

int core_directional(Core *core, const unsigned int *unknown, size_t unknowns, const unsigned int *known, size_t knowns,
                     const double *seed, double *sensitivity)
{
    size_t i;
    double direction[FIRST_DERIVATIVE + 1], change[STATES + OUTPUTS + 1];
    int result = spread(known, knowns, seed, direction);
    if (result == OK)
        result = motion_directional(core->now.p, core->now.x, core->now.u, direction, change);
    if (result != OK)
        return result;
    for (i = 0; i < unknowns; i++) {
        if (unknown[i] < FIRST_DERIVATIVE || unknown[i] >= FIRST_KINK)
            return UNKNOWN_VARIABLE;
        sensitivity[i] = change[unknown[i] - FIRST_DERIVATIVE];
    }
    return OK;
}
