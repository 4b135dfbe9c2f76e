// axle_d in z by hand: its matrices and their Jacobians, and its response with its Jacobian, for a number or for several at once.
//
// Coordinates are body, wheel, tm, sf, pwt. A link of stiffness k along the travel g'z puts k g g' into the stiffness matrix.
#pragma once
#include <array>
#include <cstddef>

enum Parameter {
    M_CORNER, M_WHEEL, M_TM, M_SF, M_PWT, MR_SPRING, MR_DAMPER, K_WHEEL, K_TM, K_SF, K_PWT, K_TIRE, C_WHEEL, C_TM, C_SF, C_PWT, C_TIRE,
    PARAMETERS
};
inline const char *const NAMES[PARAMETERS] = {
    "m_corner", "m_wheel", "m_tm", "m_sf", "m_pwt", "mr_spring", "mr_damper", "k_wheel_z", "k_tm", "k_sf_z", "k_pwt_z", "k_tire",
    "c_wheel_z", "c_tm", "c_sf_z", "c_pwt_z", "c_tire"};

constexpr int MASSES = 5;
// What the compiler must see through.
#define INLINED __attribute__((always_inline))

// The travel of a link: its coordinates, and by how much each counts.
template <class T, int N> struct Travel {
    std::array<int, N> at;
    std::array<T, N> by;
};

template <class T> struct Links {
    Travel<T, 3> spring, damper;
    Travel<T, 3> spring_slope, damper_slope; // by the motion ratio
    Travel<T, 2> tm, sf, pwt;
    Travel<T, 1> tire;

    inline INLINED explicit Links(const T *p) {
        const T one = T() + 1.0, zero = T(), mr = p[MR_SPRING], md = p[MR_DAMPER];
        spring = {{0, 1, 3}, {one, -mr, mr - 1.0}};
        spring_slope = {{0, 1, 3}, {zero, -one, one}};
        damper = {{1, 2, 3}, {-md, one, md - 1.0}};
        damper_slope = {{1, 2, 3}, {-one, zero, one}};
        tm = {{0, 2}, {one, -one}};
        sf = {{0, 3}, {one, -one}};
        pwt = {{3, 4}, {-one, one}};
        tire = {{1}, {one}};
    }
};

// Calls `put(row, column, parameter, value)` for each derivative of A and B; columns from 10 on are those of B.
template <class T, class Put> inline INLINED void each_slope(const T *p, Put put) {
    const Links<T> links(p);
    const T body = 1.0 / (p[M_CORNER] - p[M_WHEEL] - p[M_TM] - p[M_SF] - p[M_PWT]);
    const T inverse[MASSES] = {body, 1.0 / p[M_WHEEL], 1.0 / p[M_TM], 1.0 / p[M_SF], 1.0 / p[M_PWT]};
    const T mr = p[MR_SPRING], md = p[MR_DAMPER];
    const T to_k = 1.0 / (mr * mr), to_c = 1.0 / (md * md), k = p[K_WHEEL] * to_k, c = p[C_WHEEL] * to_c;
    T m[MASSES][2 * MASSES] = {};
    auto link = [&](const auto &g, const T &coefficient, const T &by, int from, int parameter) INLINED {
        for (std::size_t i = 0; i < g.at.size(); i++)
            for (std::size_t j = 0; j < g.at.size(); j++) {
                const T slope = g.by[i] * g.by[j] * inverse[g.at[i]];
                m[g.at[i]][from + g.at[j]] -= coefficient * slope;
                put(g.at[i], from + g.at[j], parameter, -by * slope);
            }
    };
    const T one = T() + 1.0;
    link(links.spring, k, to_k, 0, K_WHEEL);
    link(links.tm, p[K_TM], one, 0, K_TM);
    link(links.sf, p[K_SF], one, 0, K_SF);
    link(links.pwt, p[K_PWT], one, 0, K_PWT);
    link(links.tire, p[K_TIRE], one, 0, K_TIRE);
    link(links.damper, c, to_c, 5, C_WHEEL);
    link(links.tm, p[C_TM], one, 5, C_TM);
    link(links.sf, p[C_SF], one, 5, C_SF);
    link(links.pwt, p[C_PWT], one, 5, C_PWT);
    link(links.tire, p[C_TIRE], one, 5, C_TIRE);
    auto ratio = [&](const auto &g, const auto &dg, const T &coefficient, const T &r, int from, int parameter) INLINED {
        const T change = -2.0 * coefficient / r;
        for (std::size_t i = 0; i < 3; i++)
            for (std::size_t j = 0; j < 3; j++) {
                const T slope = change * g.by[i] * g.by[j] + coefficient * (dg.by[i] * g.by[j] + g.by[i] * dg.by[j]);
                put(g.at[i], from + g.at[j], parameter, -slope * inverse[g.at[i]]);
            }
    };
    ratio(links.spring, links.spring_slope, k, mr, 0, MR_SPRING);
    ratio(links.damper, links.damper_slope, c, md, 5, MR_DAMPER);
    constexpr bool coupled[MASSES][2 * MASSES] = {
        {1, 1, 1, 1, 0, 1, 0, 1, 1, 0}, {1, 1, 0, 1, 0, 0, 1, 1, 1, 0}, {1, 0, 1, 0, 0, 1, 1, 1, 1, 0},
        {1, 1, 0, 1, 1, 1, 1, 1, 1, 1}, {0, 0, 0, 1, 1, 0, 0, 0, 1, 1}};
    for (int i = 0; i < MASSES; i++)
        for (int j = 0; j < 2 * MASSES; j++)
            if (coupled[i][j]) {
                const T slope = m[i][j] * inverse[i];
                put(i, j, M_CORNER + i, -slope);
                if (i == 0)
                    for (int other = M_WHEEL; other <= M_PWT; other++) put(0, j, other, slope);
            }
    const T wheel = inverse[1];
    put(1, 10, K_TIRE, wheel);
    put(1, 10, M_WHEEL, -p[K_TIRE] * wheel * wheel);
    put(1, 11, C_TIRE, wheel);
    put(1, 11, M_WHEEL, -p[C_TIRE] * wheel * wheel);
    put(1, 12, M_WHEEL, -wheel * wheel);
    // The matrices themselves.
    for (int i = 0; i < MASSES; i++)
        for (int j = 0; j < 2 * MASSES; j++)
            if (coupled[i][j]) put(i, j, -1, m[i][j]);
    put(1, 10, -1, p[K_TIRE] * wheel);
    put(1, 11, -1, p[C_TIRE] * wheel);
    put(1, 12, -1, wheel);
    for (int i = 0; i < MASSES; i++) put(i, 13, -1, -one);
}

// Those numbers in a row, of A and B and again of C and D.
template <class T> inline INLINED int matrices(const T *p, T *out) {
    int count = 0;
    each_slope(p, [&](int, int, int, const T &value) INLINED { out[count] = value, out[256 + count] = value, count++; });
    return count;
}

template <class T> struct Complex {
    T re, im;
};
template <class T> inline INLINED Complex<T> operator*(const Complex<T> &a, const Complex<T> &b) {
    return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
}
template <class T> inline INLINED Complex<T> operator*(const T &a, const Complex<T> &b) { return {a * b.re, a * b.im}; }
template <class T> inline INLINED Complex<T> operator+(const Complex<T> &a, const Complex<T> &b) { return {a.re + b.re, a.im + b.im}; }
template <class T> inline INLINED Complex<T> operator-(const Complex<T> &a, const Complex<T> &b) { return {a.re - b.re, a.im - b.im}; }
template <class T> inline INLINED Complex<T> inverse(const Complex<T> &a) {
    const T size = 1.0 / (a.re * a.re + a.im * a.im);
    return {a.re * size, -a.im * size};
}

// Rows of a response: five accelerations per metre of pad, then their derivatives, mass by mass.
constexpr int ROWS = MASSES * (1 + PARAMETERS);

// At the circular frequencies `w`; `put(row, value)` gets each. The inverse of the dynamic stiffness serves the response and all derivatives.
template <class T, class Put> inline INLINED void respond(const double *parameters, const T &w, Put put) {
    T p[PARAMETERS];
    for (int i = 0; i < PARAMETERS; i++) p[i] = T() + parameters[i];
    const Links<T> links(p);
    const T mr = p[MR_SPRING], md = p[MR_DAMPER], to_k = 1.0 / (mr * mr), to_c = 1.0 / (md * md);
    const T k = p[K_WHEEL] * to_k, c = p[C_WHEEL] * to_c, square = w * w;
    const T mass[MASSES] = {p[M_CORNER] - p[M_WHEEL] - p[M_TM] - p[M_SF] - p[M_PWT], p[M_WHEEL], p[M_TM], p[M_SF], p[M_PWT]};
    using Z = Complex<T>;
    Z z[MASSES][MASSES] = {};
    auto add = [&](const auto &g, const Z &stiffness) INLINED {
        for (std::size_t i = 0; i < g.at.size(); i++)
            for (std::size_t j = 0; j < g.at.size(); j++) z[g.at[i]][g.at[j]] = z[g.at[i]][g.at[j]] + (g.by[i] * g.by[j]) * stiffness;
    };
    const T none = T();
    add(links.spring, {k, none});
    add(links.damper, {none, w * c});
    add(links.tm, {p[K_TM], w * p[C_TM]});
    add(links.sf, {p[K_SF], w * p[C_SF]});
    add(links.pwt, {p[K_PWT], w * p[C_PWT]});
    const Z tire = {p[K_TIRE], w * p[C_TIRE]};
    add(links.tire, tire);
    for (int i = 0; i < MASSES; i++) z[i][i].re -= square * mass[i];
    // Z = L D L', and its inverse from that.
    Z l[MASSES][MASSES], d[MASSES];
    for (int j = 0; j < MASSES; j++) {
        for (int i = j + 1; i < MASSES; i++) l[i][j] = z[i][j];
        d[j] = inverse(z[j][j]);
        for (int i = j + 1; i < MASSES; i++) {
            l[i][j] = l[i][j] * d[j];
            for (int n = j + 1; n <= i; n++) z[i][n] = z[i][n] - l[i][j] * z[n][j];
        }
    }
    Z v[MASSES][MASSES];
    for (int j = MASSES - 1; j >= 0; j--) {
        for (int i = MASSES - 1; i > j; i--) {
            Z sum = {none, none};
            for (int n = j + 1; n < MASSES; n++) sum = sum - l[n][j] * (n > i ? v[n][i] : v[i][n]);
            v[i][j] = v[j][i] = sum;
        }
        Z sum = d[j];
        for (int n = j + 1; n < MASSES; n++) sum = sum - l[n][j] * v[n][j];
        v[j][j] = sum;
    }
    Z x[MASSES];
    for (int i = 0; i < MASSES; i++) x[i] = tire * v[i][1], put(i, (-square) * x[i]);
    auto slope = [&](int parameter, auto value) INLINED {
        for (int i = 0; i < MASSES; i++) put(MASSES + i * PARAMETERS + parameter, value(i));
    };
    auto along = [&](const auto &g, int i) INLINED {
        Z sum = {none, none};
        for (std::size_t n = 0; n < g.at.size(); n++) sum = sum + g.by[n] * v[i][g.at[n]];
        return sum;
    };
    auto travel = [&](const auto &g) INLINED {
        Z sum = {none, none};
        for (std::size_t n = 0; n < g.at.size(); n++) sum = sum + g.by[n] * x[g.at[n]];
        return sum;
    };
    // By a stiffness, and by a damping: the same times iω.
    auto link = [&](const auto &g, int stiffness, const T &by_k, int damping, const T &by_c) INLINED {
        const Z moved = travel(g), scaled = square * moved;
        const Z turned = {-w * scaled.im, w * scaled.re};
        for (int i = 0; i < MASSES; i++) {
            const Z own = along(g, i);
            if (stiffness >= 0) put(MASSES + i * PARAMETERS + stiffness, by_k * (scaled * own));
            if (damping >= 0) put(MASSES + i * PARAMETERS + damping, by_c * (turned * own));
        }
    };
    const T one = T() + 1.0;
    link(links.spring, K_WHEEL, to_k, -1, one);
    link(links.damper, -1, one, C_WHEEL, to_c);
    link(links.tm, K_TM, one, C_TM, one);
    link(links.sf, K_SF, one, C_SF, one);
    link(links.pwt, K_PWT, one, C_PWT, one);
    const Z left = {(x[1].re - 1.0) * square, x[1].im * square};
    const Z turned = {-w * left.im, w * left.re};
    slope(K_TIRE, [&](int i) INLINED { return left * v[i][1]; });
    slope(C_TIRE, [&](int i) INLINED { return turned * v[i][1]; });
    // By a mass, which the body lacks where another has it.
    const T fourth = square * square;
    const Z body = fourth * x[0];
    slope(M_CORNER, [&](int i) INLINED { return Z{none, none} - body * v[i][0]; });
    for (int n = 1; n < MASSES; n++) {
        const Z own = fourth * x[n];
        slope(M_CORNER + n, [&](int i) INLINED { return body * v[i][0] - own * v[i][n]; });
    }
    auto ratio = [&](const auto &g, const auto &dg, const Z &coefficient, const T &r, int parameter) INLINED {
        const Z moved = coefficient * travel(g), changed = coefficient * travel(dg), twice = (-2.0 / r) * moved;
        slope(parameter, [&](int i) INLINED {
            return square * ((twice + changed) * along(g, i) + moved * along(dg, i));
        });
    };
    ratio(links.spring, links.spring_slope, Z{k, none}, mr, MR_SPRING);
    ratio(links.damper, links.damper_slope, Z{none, w * c}, md, MR_DAMPER);
}
