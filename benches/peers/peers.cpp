// What others take for the work of `benches/peers.rs`, which starts this and asks it on standard input:
//
//   set NAME VALUE          a parameter
//   show TASK               the results, a line each, then `end`
//   time TASK COUNT         seconds of processor time for so many
//
// Built with WIDE, the hand-written code works on eight numbers at a time; with CASADI it has what `casadi_model.py` writes, and with CERES
// the fit is Ceres's. Each is a program of its own, so that what one needs is not needed by all.
#include "axle.h"
#include <cmath>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <map>
#include <string>
#include <vector>
#ifdef CERES
#include <ceres/ceres.h>
#endif
#ifdef CASADI
extern "C" {
#include "casadi_model.h"
}
#endif

#ifdef WIDE
typedef double Lane __attribute__((vector_size(64)));
#else
typedef double Lane;
#endif
constexpr int LANES = sizeof(Lane) / sizeof(double);
constexpr int LINES = 300, PADDED = 304;

static double parameters[PARAMETERS];
static double circular[PADDED];
static std::vector<double> re(ROWS *PADDED), im(ROWS *PADDED);

static double seconds() {
    timespec now;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return now.tv_sec + 1e-9 * now.tv_nsec;
}

static void prepare() {
    for (int line = 0; line < PADDED; line++) circular[line] = 2 * M_PI * 0.5 * std::pow(60.0, std::min(line, LINES - 1) / 299.0);
}

// Matrices and Jacobians: at one parameter set, or at one for each lane.
static Lane found[512];
__attribute__((noinline)) static int linearise() {
    Lane p[PARAMETERS];
    for (int i = 0; i < PARAMETERS; i++) p[i] = Lane() + parameters[i];
    return matrices(p, found);
}

// 300 lines, by the rows of `respond`.
__attribute__((noinline)) static void sweep(const double *p) {
    for (int line = 0; line < PADDED; line += LANES) {
        Lane w;
        std::memcpy(&w, circular + line, sizeof w);
        respond(p, w, [&](int row, const Complex<Lane> &value) INLINED {
            std::memcpy(&re[row * PADDED + line], &value.re, sizeof w);
            std::memcpy(&im[row * PADDED + line], &value.im, sizeof w);
        });
    }
}

#ifdef CASADI
static double casadi_a[CASADI_RESULTS], casadi_row[2 * ROWS];
static void casadi_linearise() {
    const double *given[1] = {parameters};
    double *into[2] = {casadi_a, casadi_a + CASADI_VALUES};
    axle_matrices(given, into, nullptr, nullptr, 0);
}
static void casadi_sweep(const double *p) {
    for (int line = 0; line < LINES; line++) {
        const double *given[2] = {p, circular + line};
        double *into[2] = {casadi_row, casadi_row + 2 * MASSES};
        axle_response(given, into, nullptr, nullptr, 0);
        for (int i = 0; i < MASSES; i++) {
            re[i * PADDED + line] = casadi_row[i], im[i * PADDED + line] = casadi_row[MASSES + i];
            for (int n = 0; n < PARAMETERS; n++) {
                // Dense, column by column.
                const double *column = casadi_row + 2 * MASSES * (1 + n);
                const int row = MASSES + i * PARAMETERS + n;
                re[row * PADDED + line] = column[i], im[row * PADDED + line] = column[MASSES + i];
            }
        }
    }
}
#endif

// The fit: magnitudes and phases of five ratios over the pad, weighed as qcar weighs them; 12 parameters from 1.2 times their values.
constexpr int FREE[] = {M_WHEEL, M_PWT, K_WHEEL, K_TM, K_SF, K_PWT, K_TIRE, C_WHEEL, C_TM, C_SF, C_PWT, C_TIRE};
constexpr int UNKNOWN = sizeof FREE / sizeof *FREE, RESIDUALS = 2 * MASSES * LINES;
constexpr double LAMBDA = 0.099;
static const double NEPERS = LAMBDA * 20 / std::log(10.0) / 3, RADIANS = (1 - LAMBDA) / M_PI;
static std::vector<double> measured(RESIDUALS);

// Residuals, and where asked for their derivatives, a row for each residual.
static void residuals(const double *x, double *residual, double *jacobian) {
    double p[PARAMETERS];
    std::memcpy(p, parameters, sizeof p);
    for (int n = 0; n < UNKNOWN; n++) p[FREE[n]] = x[n];
    sweep(p);
    for (int i = 0; i < MASSES; i++)
        for (int line = 0; line < LINES; line++) {
            const int at = i * PADDED + line, row = i * LINES + line, below = MASSES * LINES + row;
            // Over the acceleration of the pad.
            const double a = -re[at], b = -im[at], size = a * a + b * b, turn = 2 * M_PI;
            const double w = circular[line];
            double phase = std::atan2(b, a) - measured[below];
            phase -= turn * std::round(phase / turn);
            residual[row] = NEPERS * (0.5 * std::log(size) - 2 * std::log(w) - measured[row]);
            residual[below] = RADIANS * phase;
            if (!jacobian) continue;
            for (int n = 0; n < UNKNOWN; n++) {
                const int slope = (MASSES + i * PARAMETERS + FREE[n]) * PADDED + line;
                const double da = -re[slope], db = -im[slope];
                jacobian[row * UNKNOWN + n] = NEPERS * (a * da + b * db) / size;
                jacobian[below * UNKNOWN + n] = RADIANS * (a * db - b * da) / size;
            }
        }
}

static void measure() {
    std::fill(measured.begin(), measured.end(), 0.0);
    double x[UNKNOWN];
    std::vector<double> own(RESIDUALS);
    for (int n = 0; n < UNKNOWN; n++) x[n] = parameters[FREE[n]];
    residuals(x, own.data(), nullptr);
    for (int row = 0; row < RESIDUALS; row++) measured[row] = own[row] / (row < RESIDUALS / 2 ? NEPERS : RADIANS);
}

static double solution[UNKNOWN];
static std::vector<double> residual(RESIDUALS), jacobian(RESIDUALS *UNKNOWN);

#ifdef CERES
struct Cost : ceres::SizedCostFunction<RESIDUALS, UNKNOWN> {
    bool Evaluate(double const *const *x, double *into, double **jacobians) const override {
        residuals(x[0], into, jacobians ? jacobians[0] : nullptr);
        return true;
    }
};
static void fit() {
    for (int n = 0; n < UNKNOWN; n++) solution[n] = 1.2 * parameters[FREE[n]];
    ceres::Problem problem;
    problem.AddResidualBlock(new Cost, nullptr, solution);
    for (int n = 0; n < UNKNOWN; n++) {
        problem.SetParameterLowerBound(solution, n, 0.5 * parameters[FREE[n]]);
        problem.SetParameterUpperBound(solution, n, 2 * parameters[FREE[n]]);
    }
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
    options.logging_type = ceres::SILENT;
    options.function_tolerance = 1e-9;
    options.gradient_tolerance = 1e-8;
    options.parameter_tolerance = 1e-7;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
}
#else
// Levenberg and Marquardt's method with the scale of the columns, within the bounds.
static void fit() {
    double a[UNKNOWN][UNKNOWN], g[UNKNOWN], x[UNKNOWN], damping = 1e-3, cost = 0;
    for (int n = 0; n < UNKNOWN; n++) solution[n] = 1.2 * parameters[FREE[n]];
    residuals(solution, residual.data(), jacobian.data());
    for (double r : residual) cost += r * r;
    for (int trial = 0; trial < 100; trial++) {
        double l[UNKNOWN][UNKNOWN], s[UNKNOWN], lower = 0;
        if (trial == 0 || damping < 1e10) {
            std::memset(a, 0, sizeof a), std::memset(g, 0, sizeof g);
            for (int row = 0; row < RESIDUALS; row++)
                for (int i = 0; i < UNKNOWN; i++) {
                    const double *j = &jacobian[row * UNKNOWN];
                    g[i] += j[i] * residual[row];
                    for (int n = 0; n <= i; n++) a[i][n] += j[i] * j[n];
                }
        }
        // Cholesky's factors of the damped normal equations.
        for (int i = 0; i < UNKNOWN; i++)
            for (int n = 0; n <= i; n++) {
                double sum = i == n ? a[i][i] * (1 + damping) : a[i][n];
                for (int m = 0; m < n; m++) sum -= l[i][m] * l[n][m];
                l[i][n] = i == n ? std::sqrt(sum) : sum / l[n][n];
            }
        for (int i = 0; i < UNKNOWN; i++) {
            s[i] = -g[i];
            for (int n = 0; n < i; n++) s[i] -= l[i][n] * s[n];
            s[i] /= l[i][i];
        }
        for (int i = UNKNOWN - 1; i >= 0; i--) {
            for (int n = i + 1; n < UNKNOWN; n++) s[i] -= l[n][i] * s[n];
            s[i] /= l[i][i];
        }
        double step = 0;
        for (int n = 0; n < UNKNOWN; n++) {
            const double own = parameters[FREE[n]];
            x[n] = std::min(std::max(solution[n] + s[n], 0.5 * own), 2 * own);
            step = std::max(step, std::abs(x[n] - solution[n]) / own);
        }
        std::vector<double> before = residual, slopes = jacobian;
        residuals(x, residual.data(), jacobian.data());
        for (double r : residual) lower += r * r;
        if (lower < cost) {
            const bool done = cost - lower < 1e-9 * cost || step < 1e-7;
            std::memcpy(solution, x, sizeof x);
            cost = lower, damping *= 0.1;
            if (done) break;
        } else {
            residual.swap(before), jacobian.swap(slopes), damping *= 10;
            if (step < 1e-7) break;
        }
    }
}
#endif

static void work(const std::string &task) {
#ifdef CASADI
    if (task == "matrices") return casadi_linearise();
    if (task == "response") return casadi_sweep(parameters);
#endif
    if (task == "matrices") linearise();
    if (task == "response") sweep(parameters);
    if (task == "fit") fit();
}

static void show(const std::string &task) {
    work(task);
    if (task == "matrices") {
#ifdef CASADI
        for (int n = 0; n < CASADI_RESULTS; n++)
            if (casadi_place[n][2] < PARAMETERS) {
                const int parameter = casadi_place[n][2];
                std::printf("%d %d %s %.17g\n", casadi_place[n][0], casadi_place[n][1], parameter < 0 ? "-" : NAMES[parameter], casadi_a[n]);
            }
#else
        int count = 0;
        double p[PARAMETERS];
        std::memcpy(p, parameters, sizeof p);
        // Several shares may fall on an entry: whoever reads this adds them up.
        each_slope(p, [&](int row, int column, int parameter, double) {
            double first;
            std::memcpy(&first, &found[count++], sizeof first);
            std::printf("%d %d %s %.17g\n", row, column, parameter < 0 ? "-" : NAMES[parameter], first);
        });
#endif
    }
    if (task == "response")
        for (int i = 0; i < MASSES; i++)
            for (int n = -1; n < PARAMETERS; n++) {
                const int row = (n < 0 ? i : MASSES + i * PARAMETERS + n) * PADDED;
                for (int line : {0, 137, 299})
                    std::printf("%d %d %s %.17g %.17g\n", i, line, n < 0 ? "-" : NAMES[n], re[row + line], im[row + line]);
            }
    if (task == "fit")
        for (int n = 0; n < UNKNOWN; n++) std::printf("%s %.17g\n", NAMES[FREE[n]], solution[n]);
    std::printf("end\n");
}

int main() {
    char word[64], task[64];
    bool ready = false;
    while (std::scanf("%63s %63s", word, task) == 2) {
        if (!std::strcmp(word, "set")) {
            double value;
            if (std::scanf("%lf", &value) != 1) return 1;
            for (int n = 0; n < PARAMETERS; n++)
                if (!std::strcmp(NAMES[n], task)) parameters[n] = value;
            continue;
        }
        if (!ready) prepare(), measure(), ready = true;
        if (!std::strcmp(word, "show")) show(task);
        else {
            int count;
            if (std::scanf("%d", &count) != 1) return 1;
            const double start = seconds();
            for (int n = 0; n < count; n++) {
                work(task);
                asm volatile("" ::: "memory");
            }
            std::printf("%.9e\n", seconds() - start);
        }
        std::fflush(stdout);
    }
}
