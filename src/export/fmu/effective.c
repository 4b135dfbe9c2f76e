/* The model on an effective road, whose height and rate are inputs. */
#include "core.h"

#include <math.h>

void motion_start(double *p, double *x)
{
    int i;
    MODEL(defaults)(p);
    for (i = 0; i < STATES; i++)
        x[i] = 0.0;
}

void motion_prepare(const double *p, double *constants)
{
    MODEL(prepare)(p, constants);
}

void motion_rates(const double *constants, double time, const double *x, const double *u, double *dx)
{
    (void)time;
    MODEL(derivative)(constants, x, u, dx);
}

void motion_outputs(const double *constants, double time, const double *x, const double *u, double *y)
{
    (void)time;
    MODEL(outputs)(constants, x, u, y);
}

double motion_longest_step(const double *constants)
{
    (void)constants;
    return HUGE_VAL;
}

int motion_directional(const double *p, const double *x, const double *u, const double *direction, double *change)
{
    int i;
    double nonzeros[MATRICES + PARAMETER_JACOBIAN + 1];
    for (i = 0; i < STATES + OUTPUTS; i++)
        change[i] = 0.0;
    MODEL(matrices)(p, x, u, nonzeros);
    for (i = 0; i < MATRICES; i++) {
        const MODEL(entry) *at = &MODEL(matrices_at)[i];
        const int is_output = at->matrix == 'C' || at->matrix == 'D';
        const int is_input = at->matrix == 'B' || at->matrix == 'D';
        const int from = (is_input ? FIRST_INPUT : FIRST_STATE) + at->column;
        change[(is_output ? STATES : 0) + at->row] += nonzeros[i] * direction[from];
    }
    MODEL(parameter_jacobian)(p, x, u, nonzeros);
    for (i = 0; i < PARAMETER_JACOBIAN; i++) {
        const MODEL(derivative_by_parameter) *at = &MODEL(parameter_jacobian_at)[i];
        change[(at->is_output ? STATES : 0) + at->row] += nonzeros[i] * direction[at->parameter];
    }
    return OK;
}
