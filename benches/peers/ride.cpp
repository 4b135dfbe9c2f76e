// A ride of axle_d in z and x over a road, by hand or by Boost.odeint: what `benches/peers.rs` asks on standard input:
//
//   set NAME VALUE          a parameter, of the axle, the tyre or the ride
//   vertex X Z              a corner of the road, m, one after the other
//   show ride               the states at the end, a line each, then `end`
//   time ride COUNT         seconds of processor time for so many
//
// The tyre's circle meets the road by the area that both have in common, and the integrator is that of Dormand and Prince, of order 5(4).
// States are in parts of their scales, so that one tolerance is both relative and absolute.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <map>
#include <string>
#include <vector>
#ifdef ODEINT
#include <boost/numeric/odeint.hpp>
#endif

// Coordinates in z, then in x.
constexpr int AXES = 2, MASSES = 5, MOTIONS = AXES * MASSES, STATES = 2 * MOTIONS, WHEEL = 1;
static const char *const NAMES[AXES][MASSES] = {{"body", "wheel", "tm", "sf", "pwt"}, {"body", "wheel", "sf", "pwt", "wheel_other"}};
// A centimetre and a tenth of a metre per second.
constexpr double SCALES[2] = {0.01, 0.1};
typedef std::array<double, STATES> State;

static std::map<std::string, double> p;
static std::vector<std::array<double, 2>> road;

// So many pieces of road at a time are skipped if the circle does not reach their bounds.
constexpr std::size_t BLOCK = 8;
struct Bounds {
    double left, right, top;
};
static std::vector<Bounds> blocks;

// Stiffness and damping over mass, per scale of what they multiply and of what they move.
static double stiffness[AXES][MASSES][MASSES], damping[AXES][MASSES][MASSES], wheel_mass;
static double radius, static_rate, height, speed, load, linear, square, viscous, traction, tolerance, longest, start_time, end_time;

static double seconds() {
    timespec now;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return now.tv_sec + 1e-9 * now.tv_nsec;
}

struct Point {
    double x, z;
};
static inline Point operator*(double by, const Point &a) { return {by * a.x, by * a.z}; }
static inline Point operator+(const Point &a, const Point &b) { return {a.x + b.x, a.z + b.z}; }
static inline Point against(const Point &a) {
    const double size = std::sqrt(a.x * a.x + a.z * a.z);
    return size > 0 ? (-1 / size) * a : Point{0, 0};
}

// What the rim sweeps where it enters the ground, and where it leaves it; angles are from where it moves along itself.
struct Sweeps {
    Point along, down;
    double speed, flux[2] = {};
    Point moment[2] = {};

    explicit Sweeps(const Point &v) {
        speed = std::sqrt(v.x * v.x + v.z * v.z);
        along = (1 / speed) * v;
        down = {along.z, -along.x};
    }
    // An arc between two points of the rim, and its angle.
    double add(const Point &from, const Point &to) {
        double sine[2], cosine[2], angle[2];
        const Point ends[2] = {from, to};
        for (int i = 0; i < 2; i++) {
            sine[i] = (ends[i].x * along.x + ends[i].z * along.z) / radius;
            cosine[i] = (ends[i].x * down.x + ends[i].z * down.z) / radius;
            angle[i] = std::atan2(sine[i], cosine[i]);
        }
        auto put = [&](int i, double sign) {
            const int side = angle[i] < 0 || (angle[i] == 0 && angle[1 - i] < 0);
            const double by = side ? -sign : sign;
            flux[side] += by * (1 - cosine[i]);
            moment[side] = moment[side] + (by * 0.5 * (angle[i] - sine[i] * cosine[i])) * along + (by * 0.5 * sine[i] * sine[i]) * down;
        };
        put(1, 1), put(0, -1);
        return angle[1] - angle[0];
    }
};

// The deflection on a flat road at which the circle has this area in common with it.
static double deflection_of(double area) {
    const double wanted = area / (radius * radius);
    double d = std::cbrt(wanted * wanted * 9 / 32);
    for (int n = 0; n < 20; n++) {
        const double chord = std::sqrt(d * (2 - d)), excess = std::atan2(chord, 1 - d) - (1 - d) * chord - wanted;
        const double step = excess / (2 * chord);
        d -= step;
        if (std::abs(step) < 1e-14 * d) break;
    }
    return radius * d;
}

static void bound() {
    blocks.clear();
    for (std::size_t first = 0; first + 1 < road.size(); first += BLOCK) {
        const std::size_t last = std::min(first + BLOCK, road.size() - 1);
        double top = road[first][1];
        for (std::size_t k = first + 1; k <= last; k++) top = std::max(top, road[k][1]);
        blocks.push_back({road[first][0], road[last][0], top});
    }
}

static inline bool reaches(const Point &centre, const Bounds &of) {
    const double dx = std::max({of.left - centre.x, centre.x - of.right, 0.0}), dz = std::max(centre.z - of.top, 0.0);
    return dx * dx + dz * dz < radius * radius;
}

// The force on a wheel with its centre here, in x and z.
static Point contact(const Point &centre, const Point &velocity, std::size_t &near) {
    while (near + 2 < road.size() && road[near + 1][0] < centre.x - radius) near++;
    while (near > 0 && road[near][0] > centre.x - radius) near--;
    Sweeps sweeps(velocity);
    double area = 0, deflection = 0;
    Point moment = {0, 0}, entry = {0, 0}, direction = {0, 1};
    int pieces = 0;
    const double squared = radius * radius;
    for (std::size_t k = near; k + 1 < road.size() && road[k][0] < centre.x + radius; k++) {
        if ((k == near || k % BLOCK == 0) && !reaches(centre, blocks[k / BLOCK])) {
            k += BLOCK - 1 - k % BLOCK;
            continue;
        }
        const Point from = {road[k][0] - centre.x, road[k][1] - centre.z}, to = {road[k + 1][0] - centre.x, road[k + 1][1] - centre.z};
        const Point d = {to.x - from.x, to.z - from.z};
        const double a = d.x * d.x + d.z * d.z, b = from.x * d.x + from.z * d.z, c = from.x * from.x + from.z * from.z - squared;
        const double end = a + 2 * b + c;
        double enters = 0, leaves = 1;
        // Most pieces are all inside, or outside with no nearest point between their ends.
        if (c >= 0 && end >= 0 && (b >= 0 || a + b <= 0)) continue;
        if (c >= 0 || end >= 0) {
            const double under = b * b - a * c;
            if (under <= 0) continue;
            const double root = std::sqrt(under);
            if (c >= 0) enters = (-b - root) / a;
            if (end >= 0) leaves = (-b + root) / a;
        }
        const Point first = enters > 0 ? from + enters * d : from, last = leaves < 1 ? from + leaves * d : to;
        if (enters > 0) entry = first;
        pieces++;
        // By Green's theorem, along the rim and back along the road.
        area -= 0.5 * (first.x * last.z - first.z * last.x);
        moment.x -= (last.z - first.z) * (first.x * first.x + first.x * last.x + last.x * last.x) / 6;
        moment.z += (last.x - first.x) * (first.z * first.z + first.z * last.z + last.z * last.z) / 6;
        if (leaves >= 1) continue;
        const double angle = sweeps.add(entry, last);
        area += 0.5 * squared * angle;
        auto side = [&](const Point &at) { return Point{at.z - at.z * at.z * at.z / (3 * squared), -at.x + at.x * at.x * at.x / (3 * squared)}; };
        const Point ends[2] = {side(entry), side(last)};
        moment = moment + (0.5 * squared) * Point{ends[1].x - ends[0].x, ends[1].z - ends[0].z};
        if (enters > 0) {
            const double length = std::sqrt(a);
            direction = {-d.z / length, d.x / length};
            deflection = radius + from.x * direction.x + from.z * direction.z;
        }
    }
    if (area <= 0) return {0, 0};
    if (pieces > 1) deflection = deflection_of(area), direction = against(moment);
    const double spring = std::max((linear + square * deflection) * deflection, 0.0), scale = radius * sweeps.speed * static_rate * viscous;
    const double growth = scale * sweeps.flux[0], shrinkage = std::min(scale * sweeps.flux[1], spring);
    return spring * direction + growth * against(sweeps.moment[0]) + (-shrinkage) * against(sweeps.moment[1]);
}

static std::size_t near_piece;
static long evaluations;

static void rates(const State &y, State &dy, double t) {
    evaluations++;
    const int z = WHEEL, x = MASSES + WHEEL;
    const Point centre = {speed * t + SCALES[0] * y[x], height + SCALES[0] * y[z]};
    const Point velocity = {speed + SCALES[1] * y[MOTIONS + x], SCALES[1] * y[MOTIONS + z]};
    const Point force = contact(centre, velocity, near_piece);
    for (int n = 0; n < MOTIONS; n++) dy[n] = y[MOTIONS + n] * (SCALES[1] / SCALES[0]);
    for (int axis = 0; axis < AXES; axis++) {
        double sum[MASSES] = {};
        for (int j = 0; j < MASSES; j++)
            for (int i = 0; i < MASSES; i++)
                sum[i] -= stiffness[axis][j][i] * y[axis * MASSES + j] + damping[axis][j][i] * y[MOTIONS + axis * MASSES + j];
        for (int i = 0; i < MASSES; i++) dy[MOTIONS + axis * MASSES + i] = sum[i];
    }
    dy[MOTIONS + z] += (force.z - load) / (wheel_mass * SCALES[1]);
    dy[MOTIONS + x] += (force.x + traction) / (wheel_mass * SCALES[1]);
}

static void prepare() {
    const double body_z = p["m_corner"] - p["m_wheel"] - p["m_tm"] - p["m_sf"] - p["m_pwt"];
    const double body_x = p["m_half_vehicle"] - p["m_wheel"] - p["m_sf"] - p["m_pwt"] - p["m_wheel_other_axle"];
    const double mass[AXES][MASSES] = {{body_z, p["m_wheel"], p["m_tm"], p["m_sf"], p["m_pwt"]},
                                       {body_x, p["m_wheel"], p["m_sf"], p["m_pwt"], p["m_wheel_other_axle"]}};
    std::memset(stiffness, 0, sizeof stiffness), std::memset(damping, 0, sizeof damping);
    typedef std::array<double, MASSES> Travel;
    auto add = [&](double (&into)[MASSES][MASSES], const double *mass, const Travel &g, double by, double scale) {
        for (int i = 0; i < MASSES; i++)
            for (int j = 0; j < MASSES; j++) into[j][i] += by * g[i] * g[j] / mass[i] * scale / SCALES[1];
    };
    auto link = [&](int axis, const Travel &g, double k, double c) {
        add(stiffness[axis], mass[axis], g, k, SCALES[0]), add(damping[axis], mass[axis], g, c, SCALES[1]);
    };
    const double mr = p["mr_spring"], md = p["mr_damper"];
    link(0, {1, -mr, 0, mr - 1, 0}, p["k_wheel_z"] / (mr * mr), 0);
    link(0, {0, -md, 1, md - 1, 0}, 0, p["c_wheel_z"] / (md * md));
    link(0, {1, 0, -1, 0, 0}, p["k_tm"], p["c_tm"]);
    link(0, {1, 0, 0, -1, 0}, p["k_sf_z"], p["c_sf_z"]);
    link(0, {0, 0, 0, -1, 1}, p["k_pwt_z"], p["c_pwt_z"]);
    link(1, {0, 1, -1, 0, 0}, p["k_wheel_x"], p["c_wheel_x"]);
    link(1, {-1, 0, 1, 0, 0}, p["k_sf_x"], p["c_sf_x"]);
    link(1, {0, 0, -1, 1, 0}, p["k_pwt_x"], p["c_pwt_x"]);
    link(1, {-1, 0, 0, 0, 1}, p["k_wheel_x_other"], p["c_wheel_x_other"]);
    wheel_mass = p["m_wheel"], radius = p["radius"], speed = p["speed"], load = p["static_tire_load"], viscous = p["c_tire"];
    tolerance = p["tolerance"], start_time = p["start"], end_time = p["end"];
    const double d = p["static_tire_def"], mean = load / d;
    linear = 2 * mean - p["k_tire"], square = (p["k_tire"] - mean) / d;
    height = road[0][1] + radius - d;
    const double patch = 2 * std::sqrt(d * (2 * radius - d));
    static_rate = 1 / patch, longest = 0.25 * patch / speed;
    // On the flat the tyre's damping is a drag, which a constant force balances.
    near_piece = 0, bound();
    traction = -contact({speed * start_time, height}, {speed, 0}, near_piece).x;
}

static State state;

#ifdef ODEINT
static void ride() {
    using namespace boost::numeric::odeint;
    state.fill(0), near_piece = 0;
    auto stepper = make_controlled(tolerance, tolerance, longest, runge_kutta_dopri5<State>());
    integrate_adaptive(stepper, rates, state, start_time, end_time, 1e-4);
}
#else
static void ride() {
    static const double A[6][6] = {{1. / 5},
                                   {3. / 40, 9. / 40},
                                   {44. / 45, -56. / 15, 32. / 9},
                                   {19372. / 6561, -25360. / 2187, 64448. / 6561, -212. / 729},
                                   {9017. / 3168, -355. / 33, 46732. / 5247, 49. / 176, -5103. / 18656},
                                   {35. / 384, 0, 500. / 1113, 125. / 192, -2187. / 6784, 11. / 84}};
    static const double TIMES[6] = {0.2, 0.3, 0.8, 8. / 9, 1, 1};
    static const double ERROR[7] = {71. / 57600, 0, -71. / 16695, 71. / 1920, -17253. / 339200, 22. / 525, -1. / 40};
    State k[7], y;
    state.fill(0), near_piece = 0;
    double t = start_time, step = 1e-4;
    rates(state, k[0], t);
    while (t < end_time) {
        const bool last = t + step >= end_time;
        if (last) step = end_time - t;
        for (int stage = 0; stage < 6; stage++) {
            for (int n = 0; n < STATES; n++) {
                double sum = 0;
                for (int i = 0; i <= stage; i++) sum += A[stage][i] * k[i][n];
                y[n] = state[n] + step * sum;
            }
            rates(y, k[stage + 1], t + TIMES[stage] * step);
        }
        double worst = 0;
        for (int n = 0; n < STATES; n++) {
            double sum = 0;
            for (int i = 0; i < 7; i++) sum += ERROR[i] * k[i][n];
            const double part = step * sum / (tolerance * (1 + std::max(std::abs(state[n]), std::abs(y[n]))));
            worst += part * part;
        }
        worst = std::sqrt(worst / STATES);
        if (worst <= 1) {
            t = last ? end_time : t + step;
            state = y, k[0] = k[6];
        }
        step = std::min(longest, step * std::min(5.0, std::max(0.2, 0.9 * std::pow(worst + 1e-12, -0.2))));
    }
}
#endif

static void show() {
    evaluations = 0;
    ride();
    for (int axis = 0; axis < AXES; axis++)
        for (int n = 0; n < MASSES; n++)
            for (int order = 0; order < 2; order++)
                std::printf("%s %s %d %.17g\n", NAMES[axis][n], axis ? "x" : "z", order, SCALES[order] * state[order * MOTIONS + axis * MASSES + n]);
    std::printf("end\n");
}

int main() {
    char word[64], task[64];
    while (std::scanf("%63s %63s", word, task) == 2) {
        double value;
        if (!std::strcmp(word, "show")) {
            prepare(), show();
        } else {
            if (std::scanf("%lf", &value) != 1) return 1;
            if (!std::strcmp(word, "set")) p[task] = value;
            if (!std::strcmp(word, "vertex")) road.push_back({std::atof(task), value});
            if (!std::strcmp(word, "time")) {
                prepare();
                const double begun = seconds();
                for (int n = 0; n < value; n++) {
                    ride();
                    asm volatile("" ::: "memory");
                }
                std::printf("%.9e\n", seconds() - begun);
            }
        }
        std::fflush(stdout);
    }
}
