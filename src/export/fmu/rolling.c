/* The model on a tyre that rolls over a profile at constant speed.
 *
 * The tyre feels the area that its unloaded circle has in common with the ground, and the changes of this area where the
 * circle enters the ground and where it leaves it. The profile is a line of straight pieces and vertical steps, level beyond
 * its ends; the inputs of the road lift all of it. */
#include "core.h"
#include "road.h"

#include <math.h>

/* x forward, z up. */
typedef struct {
    double x, z;
} Vector;

/* A piece of the profile seen from the centre of the circle: its points are origin + s * along. */
typedef struct {
    Vector origin, along;
    double start, end;
} Piece;

/* Integrals over a part of the rim by its angle ahead of the turning point, where the circle moves along itself. */
typedef struct {
    double flux, along, across;
} Sweep;

typedef struct {
    double radius;
    /* The speed along the circle at the turning point, positive to the front, and the direction there. */
    double speed;
    Vector forward;
    Sweep ahead, behind;
    double area;
    Vector moment;
} Overlap;

typedef struct {
    double deflection;
    Vector direction, growing, shrinking;
    double growth, shrinkage;
} Touch;

/* Behind the constants of the model. */
enum { RADIUS = MODEL_CONSTANTS, RATE, HEIGHT, LOAD, SPEED, LONGEST, TRACTION };

/* Further than any piece of ground that a tyre touches, m. */
#define FAR 1e9

static double dot(Vector a, Vector b) { return a.x * b.x + a.z * b.z; }
static Vector plus(Vector a, double times, Vector b) { return (Vector){a.x + times * b.x, a.z + times * b.z}; }

static Vector against(Vector v)
{
    const double size = sqrt(dot(v, v));
    return size > 0.0 ? (Vector){-v.x / size, -v.z / size} : (Vector){0.0, 0.0};
}

/* The number of points of the profile up to x: the piece that lies over x. */
static int piece_at(double x)
{
    int low = 0, high = ROAD_POINTS;
    while (low < high) {
        const int middle = (low + high) / 2;
        if (ROAD[middle][0] <= x)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

static Piece piece(int k, Vector centre)
{
    const double *from = ROAD[k > 0 ? k - 1 : 0], *to = ROAD[k < ROAD_POINTS ? k : ROAD_POINTS - 1];
    const double dx = to[0] - from[0], dz = to[1] - from[1], length = sqrt(dx * dx + dz * dz);
    Piece own = {{from[0] - centre.x, from[1] - centre.z}, {1.0, 0.0}, 0.0, FAR};
    if (k == 0) {
        own.start = -FAR;
        own.end = 0.0;
    } else if (k < ROAD_POINTS) {
        own.along = (Vector){dx / length, dz / length};
        own.end = length;
    }
    return own;
}

/* The part of a piece that lies in the circle; 0 where none does. */
static int clip(const Piece *own, double radius, double *from, double *to)
{
    const double foot = -dot(own->origin, own->along);
    const double distance = own->along.z * own->origin.x - own->along.x * own->origin.z;
    const double squared = radius * radius - distance * distance;
    const double half = squared > 0.0 ? sqrt(squared) : 0.0;
    *from = fmax(own->start, foot - half);
    *to = fmin(own->end, foot + half);
    return squared > 0.0 && *from < *to;
}

/* The lower arc from the turning point to a point of the rim. */
static Sweep rim(const Overlap *of, Vector point, double *angle)
{
    const Vector down = {of->forward.z, -of->forward.x};
    const double sine = dot(point, of->forward) / of->radius, cosine = dot(point, down) / of->radius;
    *angle = atan2(sine, cosine);
    return (Sweep){1.0 - cosine, 0.5 * (*angle - sine * cosine), 0.5 * sine * sine};
}

static void add(Sweep *to, double times, Sweep own)
{
    to->flux += times * own.flux;
    to->along += times * own.along;
    to->across += times * own.across;
}

/* Closes a stretch of ground in the circle: takes from what lies below the ground what lies below the rim. */
static void close_patch(Overlap *of, Vector from, Vector to)
{
    double first, last;
    const double squared = of->radius * of->radius;
    const Sweep rear = rim(of, from, &first), front = rim(of, to, &last);
    if (first < 0.0 && 0.0 < last) {
        add(&of->ahead, 1.0, front);
        add(&of->behind, -1.0, rear);
    } else {
        Sweep *side = first < 0.0 ? &of->behind : &of->ahead;
        add(side, 1.0, front);
        add(side, -1.0, rear);
    }
    of->area -= 0.5 * (to.x * to.z - from.x * from.z - squared * (last - first));
    of->moment.x += (to.z * to.z * to.z - from.z * from.z * from.z) / 3.0;
    of->moment.z -= 0.5 * (squared * (to.x - from.x) - (to.x * to.x * to.x - from.x * from.x * from.x) / 3.0);
}

/* Adds what lies below a straight piece of ground: area and first moments, down to the height of the centre. */
static void add_ground(Overlap *of, Vector from, Vector to)
{
    const double width = to.x - from.x, sum = from.z + to.z;
    of->area += 0.5 * width * sum;
    of->moment.x += width * (from.x * (2.0 * from.z + to.z) + to.x * (from.z + 2.0 * to.z)) / 6.0;
    of->moment.z += width * (from.z * from.z + from.z * to.z + to.z * to.z) / 6.0;
}

static Overlap overlap(double radius, Vector centre, Vector velocity)
{
    Overlap of = {0};
    const int last = piece_at(centre.x + radius);
    int k, is_open = 0;
    Vector entry = {0}, end = {0};
    of.radius = radius;
    of.speed = copysign(sqrt(dot(velocity, velocity)), velocity.x);
    of.forward.x = 1.0;
    if (of.speed != 0.0)
        of.forward = (Vector){velocity.x / of.speed, velocity.z / of.speed};
    for (k = piece_at(centre.x - radius); k <= last; k++) {
        const Piece own = piece(k, centre);
        double from, to;
        const int is_in = clip(&own, radius, &from, &to);
        if (is_open && !(is_in && from == own.start)) {
            close_patch(&of, entry, end);
            is_open = 0;
        }
        if (!is_in)
            continue;
        if (!is_open)
            entry = plus(own.origin, from, own.along);
        end = plus(own.origin, to, own.along);
        add_ground(&of, plus(own.origin, from, own.along), end);
        is_open = 1;
        if (to < own.end) {
            close_patch(&of, entry, end);
            is_open = 0;
        }
    }
    if (is_open)
        close_patch(&of, entry, end);
    return of;
}

/* The chord of the unit circle in level ground at a deflection. */
static double chord(double deflection) { return 2.0 * sqrt(fmax(deflection * (2.0 - deflection), 0.0)); }

/* The deflection of the unit circle on level ground at which both have this area in common, by Newton's method from that of the
 * parabola, kept between bounds. */
static double level_deflection(double area)
{
    double low = 0.0, high = 2.0, deflection = fmin(cbrt(9.0 / 32.0 * area * area), 1.9);
    int i;
    for (i = 0; i < 60; i++) {
        const double cosine = 1.0 - deflection, sine = 0.5 * chord(deflection);
        const double excess = atan2(sine, cosine) - cosine * sine - area;
        double next = deflection - excess / chord(deflection);
        if (excess > 0.0)
            high = deflection;
        else
            low = deflection;
        if (!(low < next && next < high))
            next = 0.5 * (low + high);
        if (fabs(next - deflection) <= 2.3e-16 * deflection)
            return next;
        deflection = next;
    }
    return deflection;
}

/* The direction of what is swept, turned back from the turning point. */
static Vector swept(const Overlap *of, Sweep own)
{
    const Vector down = {of->forward.z, -of->forward.x};
    return against(plus(plus((Vector){0}, own.along, of->forward), own.across, down));
}

/* 0 where the circle is clear of the ground. */
static int touches(const double *constants, Vector centre, Vector velocity, Touch *touch)
{
    const Overlap of = overlap(constants[RADIUS], centre, velocity);
    const double scale = of.radius * fabs(of.speed) * constants[RATE];
    const Sweep back = {-of.behind.flux, -of.behind.along, -of.behind.across};
    const int is_forward = of.speed > 0.0;
    const Sweep grows = is_forward ? of.ahead : back, shrinks = is_forward ? back : of.ahead;
    if (of.area <= 0.0)
        return 0;
    touch->deflection = of.radius * level_deflection(of.area / (of.radius * of.radius));
    touch->direction = against(of.moment);
    touch->growth = scale * grows.flux;
    touch->growing = swept(&of, grows);
    touch->shrinkage = scale * shrinks.flux;
    touch->shrinking = swept(&of, shrinks);
    return 1;
}

static double law(const double *constants, const double *x, double s, double v)
{
    double force;
    MODEL(contact_force)(constants, x, s, v, &force);
    return force;
}

/* What the ground gives to the wheel: the spring pushes from the centroid of the contact; what grows pushes, what shrinks pulls,
 * but never more than the spring pushes. */
static MODEL(contact) contact(const double *constants, const double *x, Vector centre, Vector velocity)
{
    Touch touch;
    Vector force = {0};
    MODEL(contact) given = {0};
    double at_rest, spring, growth, shrinkage;
    if (!touches(constants, centre, velocity, &touch))
        return given;
    given.s = -touch.deflection;
    given.v = touch.shrinkage - touch.growth;
    at_rest = law(constants, x, given.s, 0.0);
    spring = fmax(-at_rest, 0.0);
    growth = fmax(at_rest - law(constants, x, given.s, -touch.growth), 0.0);
    shrinkage = fmin(fmax(law(constants, x, given.s, touch.shrinkage) - at_rest, 0.0), spring);
    force = plus(force, spring, touch.direction);
    force = plus(force, growth, touch.growing);
    force = plus(force, -shrinkage, touch.shrinking);
    given.force[0] = force.z;
    given.force[1] = force.x;
    return given;
}

static MODEL(contact) contact_at(const double *constants, double time, const double *x, const double *u)
{
    Vector centre, velocity;
    centre.x = ROAD_START + constants[SPEED] * time + WHEEL_X(x);
    centre.z = constants[HEIGHT] + x[WHEEL_Z] - ROAD_HEIGHT(u);
    velocity.x = constants[SPEED] + WHEEL_VX(x);
    velocity.z = x[WHEEL_VZ] - ROAD_RATE(u);
    return contact(constants, x, centre, velocity);
}

/* What moves the wheel from its rest: beside the contact's force the static load, and the traction against the drag of rolling. */
static MODEL(contact) driven(const double *constants, MODEL(contact) given)
{
    given.force[0] -= constants[LOAD];
    given.force[1] += constants[TRACTION];
    return given;
}

void motion_start(double *p, double *x)
{
    static const double extra[] = EXTRA_VALUES, rest[STATES + 1] = REST;
    int i;
    MODEL(defaults)(p);
    for (i = MODEL_PARAMETERS; i < PARAMETERS; i++)
        p[i] = extra[i - MODEL_PARAMETERS];
    for (i = 0; i < STATES; i++)
        x[i] = rest[i];
}

void motion_prepare(const double *p, double *constants)
{
    static const double rest[STATES + 1] = REST;
    Vector centre, velocity = {0};
    const double radius = TYRE_RADIUS(p), deflection = TYRE_DEFLECTION(p);
    MODEL(prepare)(p, constants);
    constants[RADIUS] = radius;
    constants[RATE] = 1.0 / (radius * chord(deflection / radius));
    constants[HEIGHT] = ROAD[0][1] + radius - deflection;
    constants[LOAD] = TYRE_LOAD(p);
    constants[SPEED] = velocity.x = CAR_SPEED(p);
    /* A quarter of the contact's length: a circle feels what is within that. */
    constants[LONGEST] = 0.25 * radius * chord(deflection / radius) / velocity.x;
    /* On the level ground before the first point of the profile. */
    centre.x = ROAD[0][0] - 2.0 * radius;
    centre.z = constants[HEIGHT] + rest[WHEEL_Z];
    constants[TRACTION] = -contact(constants, rest, centre, velocity).force[1];
}

void motion_rates(const double *constants, double time, const double *x, const double *u, double *dx)
{
    MODEL(rolling_derivative)(constants, x, u, driven(constants, contact_at(constants, time, x, u)), dx);
}

void motion_outputs(const double *constants, double time, const double *x, const double *u, double *y)
{
    const MODEL(contact) given = contact_at(constants, time, x, u);
    MODEL(rolling_outputs)(constants, x, u, driven(constants, given), y);
    y[MODEL_OUTPUTS] = given.force[0];
    y[MODEL_OUTPUTS + 1] = given.force[1];
}

double motion_longest_step(const double *constants)
{
    return constants[LONGEST];
}

int motion_directional(const double *p, const double *x, const double *u, const double *direction, double *change)
{
    (void)p;
    (void)x;
    (void)u;
    (void)direction;
    (void)change;
    return NO_DIRECTIONS;
}
