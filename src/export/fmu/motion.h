/* How the model is driven: by an effective road, or on a tyre that rolls over a profile. A unit has one of both. */
#ifndef MOTION_H
#define MOTION_H

/* Start values. */
void motion_start(double *p, double *x);
/* What depends on the parameters alone. */
void motion_prepare(const double *p, double *constants);
void motion_rates(const double *constants, double time, const double *x, const double *u, double *dx);
void motion_outputs(const double *constants, double time, const double *x, const double *u, double *y);
/* The longest step that passes over no part of a road unseen, s. */
double motion_longest_step(const double *constants);
/* By what derivatives, then outputs, change in a direction of parameters, inputs and states. */
int motion_directional(const double *p, const double *x, const double *u, const double *direction, double *change);

#endif
