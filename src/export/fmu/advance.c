/* The integrator of Co-Simulation: the explicit pair of order 5(4) of Dormand and Prince (1980, RK5(4)7M) with error control.
 *
 * It needs no event handling for laws that bend: a step over a bend fails and is shortened. A law that jumps and holds the
 * motion at its jump would shorten steps without end; so a step of SHORTEST_OVER_A_KINK that crosses a kink stands, and the
 * motion stays at the jump but for what it does in that time. */
#include "core.h"

#include <math.h>
#include <string.h>

#define STAGES 7
#define SHORTEST_OVER_A_KINK 1e-6
#define SHORTEST 1e-12
#define FIRST_STEP 1e-4

static const double NODES[STAGES] = {0.0, 1.0 / 5, 3.0 / 10, 4.0 / 5, 8.0 / 9, 1.0, 1.0};
static const double WEIGHTS[STAGES][STAGES - 1] = {
    {0},
    {1.0 / 5},
    {3.0 / 40, 9.0 / 40},
    {44.0 / 45, -56.0 / 15, 32.0 / 9},
    {19372.0 / 6561, -25360.0 / 2187, 64448.0 / 6561, -212.0 / 729},
    {9017.0 / 3168, -355.0 / 33, 46732.0 / 5247, 49.0 / 176, -5103.0 / 18656},
    {35.0 / 384, 0.0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84},
};
/* The solution of order 5 less that of order 4. */
static const double ERRORS[STAGES] = {71.0 / 57600,      0.0,        -71.0 / 16695, 71.0 / 1920,
                                      -17253.0 / 339200, 22.0 / 525, -1.0 / 40};

typedef struct {
    Core *core;
    /* Where the communication step began, and the inputs there. */
    double from;
    double u_from[INPUTS + 1];
    double k[STAGES][STATES + 1];
    double x[STATES + 1];
} Integration;

static void inputs_at(Integration *of, double time, double *u)
{
    int i;
    for (i = 0; i < INPUTS; i++)
        u[i] = of->u_from[i] + of->core->now.u_rate[i] * (time - of->from);
}

static void rate(Integration *of, double time, const double *x, double *dx)
{
    double u[INPUTS + 1];
    inputs_at(of, time, u);
    motion_rates(of->core->constants, time, x, u, dx);
}

/* The state that a stage begins from. */
static void stage(Integration *of, int which, double h)
{
    int i, j;
    for (i = 0; i < STATES; i++) {
        double sum = 0.0;
        for (j = 0; j < which; j++)
            sum += WEIGHTS[which][j] * of->k[j][i];
        of->x[i] = of->core->now.x[i] + h * sum;
    }
}

/* Tries a step from now; gives its error in tolerances, and leaves the new state in x. */
static double attempt(Integration *of, double h)
{
    int i, j, which;
    double worst = 0.0;
    const Snapshot *now = &of->core->now;
    for (which = 1; which < STAGES; which++) {
        stage(of, which, h);
        rate(of, now->time + NODES[which] * h, of->x, of->k[which]);
    }
    for (i = 0; i < STATES; i++) {
        double error = 0.0, size = fmax(fabs(now->x[i]), fabs(of->x[i]));
        for (j = 0; j < STAGES; j++)
            error += ERRORS[j] * of->k[j][i];
        error = fabs(h * error) / (of->core->tolerance * (size + core_nominal(i)));
        /* What is no number is too large. */
        worst = error <= worst ? worst : error;
    }
    return worst == worst ? worst : HUGE_VAL;
}

static int crosses_a_kink(Integration *of, double h)
{
    int i;
    double u[INPUTS + 1], before[KINKS + 1], after[KINKS + 1];
    const Snapshot *now = &of->core->now;
    inputs_at(of, now->time, u);
    MODEL(kinks)(of->core->constants, now->x, u, before);
    inputs_at(of, now->time + h, u);
    MODEL(kinks)(of->core->constants, of->x, u, after);
    for (i = 0; i < KINKS; i++)
        if ((before[i] > 0.0) != (after[i] > 0.0) || (before[i] < 0.0) != (after[i] < 0.0))
            return 1;
    return 0;
}

static int is_finite(const double *values, int count)
{
    int i;
    for (i = 0; i < count; i++)
        if (!(fabs(values[i]) < HUGE_VAL))
            return 0;
    return 1;
}

/* The length of the step after one that has failed. */
static double shorter(double h, double factor)
{
    const int passes = h > SHORTEST_OVER_A_KINK && factor * h < SHORTEST_OVER_A_KINK;
    return passes ? SHORTEST_OVER_A_KINK : factor * h;
}

/* Takes one step, at most to the end. */
static int step(Integration *of, double end)
{
    Snapshot *now = &of->core->now;
    for (;;) {
        /* What is left is one step, or two of the same length. */
        const double left = end - now->time, wanted = fmin(now->step, motion_longest_step(of->core->constants));
        const int last = wanted >= left;
        const double h = last ? left : wanted > left / 2 ? left / 2 : wanted;
        const double error = attempt(of, h);
        const double factor = error < HUGE_VAL ? fmin(5.0, fmax(0.2, 0.9 * pow(error, -0.2))) : 0.2;
        if (error <= 1.0 || (error < HUGE_VAL && h <= SHORTEST_OVER_A_KINK && crosses_a_kink(of, h))) {
            if (!is_finite(of->x, STATES))
                return NOT_FINITE;
            memcpy(now->x, of->x, sizeof now->x);
            memcpy(of->k[0], of->k[STAGES - 1], sizeof of->k[0]);
            now->time = last ? end : now->time + h;
            /* A step that the end cut short says little of the next one, unless that may be longer still. */
            if (error <= 1.0 && (!last || factor * h > now->step))
                now->step = factor * h;
            return OK;
        }
        if (h < SHORTEST)
            return error < HUGE_VAL ? TOO_STIFF : NOT_FINITE;
        now->step = shorter(h, factor);
    }
}

int core_advance(Core *core, double duration)
{
    Integration of;
    int i, result = OK;
    const double end = core->now.time + duration;
    core_compute(core);
    of.core = core;
    of.from = core->now.time;
    memcpy(of.u_from, core->now.u, sizeof of.u_from);
    memcpy(of.k[0], core->dx, sizeof of.k[0]);
    if (!is_finite(core->dx, STATES))
        return NOT_FINITE;
    if (core->now.step <= 0.0)
        core->now.step = FIRST_STEP;
    if (STATES > 0)
        while (result == OK && core->now.time < end)
            result = step(&of, end);
    else
        core->now.time = end;
    inputs_at(&of, core->now.time, core->now.u);
    for (i = 0; i < INPUTS; i++)
        core->now.u_rate[i] = 0.0;
    core->is_computed = 0;
    return result;
}
