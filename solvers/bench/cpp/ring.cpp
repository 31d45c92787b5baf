// The practical limit of a step of the ring: a quarter of it in the plane, neo-Hookean, with the body force of the
// manufactured solution, double precision, one thread. One pass over the particles a step, in blocks of eight;
// a node is a vector of eight numbers, and the sums of a particle's nine nodes wait in registers until the cell
// changes. Particles are sorted by cell now and then. Nothing is measured of the run but its error at the end. Usage:
// ring SHAPE CELLS STEPS with SHAPE ugimp, cpgimp or cpdi. Prints million particle-steps a second of processor time,
// and the largest error of x over the amplitude. Good up to t = 0.01 s, a tenth of a period.
#ifndef __AVX512F__
#error "needs a processor with AVX-512"
#endif
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <immintrin.h>
#include <string>
#include <time.h>
#include <vector>
static double cpu() {
    timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return t.tv_sec + 1e-9 * t.tv_nsec;
}
enum Shape { UG, CP, CD };
static const double Ri = .4, Ro = .6, E = 1e7, rho = 1000, nu = 0.0, mu = E / 2 / (1 + nu),
                    lam = E * nu / ((1 + nu) * (1 - 2 * nu)), cw = std::sqrt(E / rho), Aamp = 0.1, Ldom = 0.75;
static const double c1 = -6 * Ri / (Ro * (Ro - 3 * Ri)), c2 = 3 * (Ro + Ri) / (Ro * Ro * (Ro - 3 * Ri)),
                    c3 = -2 / (Ro * Ro * (Ro - 3 * Ri));
static const double om = cw * M_PI;
struct P {
    double x, y, vx, vy, fxx, fxy, fyx, fyy, txx, txy, tyy, bx, by, m, V0, X, Y;
}; // txx.. = V0*kirchhoff
struct alignas(64) Nd {
    double m, px, py, fx, fy, pad[3];
};
struct alignas(32) Nv {
    double vx, vy, ax, ay;
};
static double C0, C1; // processor time at the first and the last step
static int n, G;
static double h, ih, dt;
static const int OFF = 3; // ghost cells low side
static inline double gR(double R) { return ((c3 * R + c2) * R + c1) * R; }
static inline double gp(double R) { return (3 * c3 * R + 2 * c2) * R + c1; }
static inline double gpp(double R) { return 6 * c3 * R + 2 * c2; }
// radial body force (per mass) at reference radius R for time factor s=A sin(om t)
static inline double brad(double R, double iR, double s) {
    double Fr = 1 + s * gp(R), Ft = 1 + s * gR(R) * iR, J = Fr * Ft, lJ = std::log(J), iFr = 1 / Fr, iFt = 1 / Ft;
    double dFr = s * gpp(R), dFt = s * (gp(R) - gR(R) * iR) * iR, dlJ = dFr * iFr + dFt * iFt;
    double Pr = lam * lJ * iFr + mu * (Fr - iFr), Pt = lam * lJ * iFt + mu * (Ft - iFt);
    double dPr = lam * (dlJ * iFr - lJ * dFr * iFr * iFr) + mu * (dFr + dFr * iFr * iFr);
    return -om * om * s * gR(R) - (dPr + (Pr - Pt) * iR) * (1 / rho);
}
static const int B = 8, SORTED_EVERY = 16; // particles of a block; steps
struct alignas(64) Blk {
    double x[B], y[B], vx[B], vy[B], fxx[B], fxy[B], fyx[B], fyy[B], m[B], V0[B], X[B], Y[B];
}; // AoSoA; 96 doubles
struct Thr {
    Nd *g;
    std::vector<int> lo, hi;
    int rlo, rhi;
};
template <Shape S> struct Wt;
template <> struct Wt<UG> {
    alignas(64) double wx[3][B], dx[3][B], wy[3][B], dy[3][B];
    alignas(64) int bi[B], bj[B];
};
template <> struct Wt<CP> : Wt<UG> {};
template <> struct Wt<CD> {
    alignas(64) double w[9][B], gx[9][B], gy[9][B];
    alignas(64) int bi[B], bj[B];
};
template <Shape S> static inline void wts(const Blk &k, Wt<S> &w) {
#pragma omp simd
    for (int l = 0; l < B; l++) {
        double lx = .25, ly = .25;
        if (S == CP) {
            lx *= k.fxx[l];
            ly *= k.fyy[l];
        }
        {
            double xi = k.x[l] * ih + OFF, fb = std::floor(xi - lx);
            w.bi[l] = (int)fb;
            double f = xi - fb, a = f - lx, B0 = f + lx, A = 1 - a, Bq = std::max(0., 1 - B0), C = std::max(0., B0 - 1),
                   r = 1 / (4 * lx), r2 = 2 * r * ih;
            double q0 = (A * A - Bq * Bq) * r, q2 = C * C * r, e0 = (Bq - A) * r2, e2 = C * r2;
            w.wx[0][l] = q0;
            w.wx[1][l] = 1 - q0 - q2;
            w.wx[2][l] = q2;
            w.dx[0][l] = e0;
            w.dx[1][l] = -e0 - e2;
            w.dx[2][l] = e2;
        }
        {
            double xi = k.y[l] * ih + OFF, fb = std::floor(xi - ly);
            w.bj[l] = (int)fb;
            double f = xi - fb, a = f - ly, B0 = f + ly, A = 1 - a, Bq = std::max(0., 1 - B0), C = std::max(0., B0 - 1),
                   r = 1 / (4 * ly), r2 = 2 * r * ih;
            double q0 = (A * A - Bq * Bq) * r, q2 = C * C * r, e0 = (Bq - A) * r2, e2 = C * r2;
            w.wy[0][l] = q0;
            w.wy[1][l] = 1 - q0 - q2;
            w.wy[2][l] = q2;
            w.dy[0][l] = e0;
            w.dy[1][l] = -e0 - e2;
            w.dy[2][l] = e2;
        }
    }
}
// Not inlined: the compiler runs out of registers otherwise, and CPDI is a quarter slower.
template <> __attribute__((noinline)) void wts<CD>(const Blk &k, Wt<CD> &w) {
#pragma omp simd
    for (int l = 0; l < B; l++) {
        double hx = .5;
        double ax = k.fxx[l] * hx, ay = k.fyx[l] * hx, bx = k.fxy[l] * hx, by = k.fyy[l] * hx;
        double x = k.x[l] * ih + OFF, y = k.y[l] * ih + OFF;
        double ex = .5 * (std::fabs(ax) + std::fabs(bx)), ey = .5 * (std::fabs(ay) + std::fabs(by));
        double fi = std::floor(x - ex), fj = std::floor(y - ey);
        w.bi[l] = (int)fi;
        w.bj[l] = (int)fj;
        double iv = 0.5 / (ax * by - ay * bx) * ih;
        double p13x = (ay - by) * iv, p24x = (ay + by) * iv, p13y = (bx - ax) * iv, p24y = (-ax - bx) * iv;
        x -= fi;
        y -= fj;
        double N[4][9];
        const double sx[4] = {-.5, .5, .5, -.5}, sy[4] = {-.5, -.5, .5, .5};
#pragma GCC unroll 4
        for (int c = 0; c < 4; c++) {
            double X = x + sx[c] * ax + sy[c] * bx, Y = y + sx[c] * ay + sy[c] * by;
            double h0 = std::max(0., 1 - X), h2 = std::max(0., X - 1), h1 = 1 - h0 - h2, k0 = std::max(0., 1 - Y),
                   k2 = std::max(0., Y - 1), k1 = 1 - k0 - k2;
            N[c][0] = h0 * k0;
            N[c][1] = h1 * k0;
            N[c][2] = h2 * k0;
            N[c][3] = h0 * k1;
            N[c][4] = h1 * k1;
            N[c][5] = h2 * k1;
            N[c][6] = h0 * k2;
            N[c][7] = h1 * k2;
            N[c][8] = h2 * k2;
        }
#pragma GCC unroll 9
        for (int q = 0; q < 9; q++) {
            double a = N[0][q], b = N[1][q], c = N[2][q], d = N[3][q];
            w.w[q][l] = .25 * ((a + b) + (c + d));
            w.gx[q][l] = p13x * (a - c) + p24x * (b - d);
            w.gy[q][l] = p13y * (a - c) + p24y * (b - d);
        }
    }
}
// NOTE: 3x3 stencil is valid while a particle domain is no wider than one cell (true here: half cell * stretch < 2)
template <Shape S> void pass(std::vector<Blk> &bk, const Nv *gv, Thr &T, double s, bool g2p) {
    Wt<S> w;
    __m512d a[9];
    for (auto &q : a) q = _mm512_setzero_pd();
    long cb = -1;
    T.rlo = 1 << 30;
    T.rhi = -1;
    int cbi = 0, cbj = 0;
    const size_t GG = G;
    auto flush = [&] {
        if (cb < 0) return;
        double *q = (double *)(T.g + cb);
        for (int j = 0; j < 3; j++)
            for (int i = 0; i < 3; i++) {
                double *r = q + (j * GG + i) * 8;
                _mm512_store_pd(r, _mm512_add_pd(_mm512_load_pd(r), a[j * 3 + i]));
            }
        T.rlo = std::min(T.rlo, cbj);
        T.rhi = std::max(T.rhi, cbj + 2);
        T.lo[cbj] = std::min(T.lo[cbj], cbi);
        T.hi[cbj] = std::max(T.hi[cbj], cbi + 2);
    };
    alignas(64) double o[8][B], t[3][B], fb[2][B], mv[2][B];
    for (Blk &k : bk) {
        if (g2p) {
            wts<S>(k, w);
            for (int l = 0; l < B; l++) {
                const double *q = (const double *)(gv + (size_t)w.bj[l] * GG + w.bi[l]);
                __m256d v, gx, gy;
                if constexpr (S != CD) {
                    __m256d y0 = _mm256_set1_pd(w.wy[0][l]), y1 = _mm256_set1_pd(w.wy[1][l]),
                            y2 = _mm256_set1_pd(w.wy[2][l]), e0 = _mm256_set1_pd(w.dy[0][l]),
                            e1 = _mm256_set1_pd(w.dy[1][l]), e2 = _mm256_set1_pd(w.dy[2][l]);
                    __m256d T[3], U[3];
                    for (int i = 0; i < 3; i++) {
                        __m256d n0 = _mm256_load_pd(q + i * 4), n1 = _mm256_load_pd(q + GG * 4 + i * 4),
                                n2 = _mm256_load_pd(q + GG * 8 + i * 4);
                        T[i] = _mm256_fmadd_pd(y2, n2, _mm256_fmadd_pd(y1, n1, _mm256_mul_pd(y0, n0)));
                        U[i] = _mm256_fmadd_pd(e2, n2, _mm256_fmadd_pd(e1, n1, _mm256_mul_pd(e0, n0)));
                    }
                    __m256d x0 = _mm256_set1_pd(w.wx[0][l]), x1 = _mm256_set1_pd(w.wx[1][l]),
                            x2 = _mm256_set1_pd(w.wx[2][l]);
                    v = _mm256_fmadd_pd(x2, T[2], _mm256_fmadd_pd(x1, T[1], _mm256_mul_pd(x0, T[0])));
                    gy = _mm256_fmadd_pd(x2, U[2], _mm256_fmadd_pd(x1, U[1], _mm256_mul_pd(x0, U[0])));
                    gx = _mm256_fmadd_pd(_mm256_set1_pd(w.dx[2][l]), T[2],
                                         _mm256_fmadd_pd(_mm256_set1_pd(w.dx[1][l]), T[1],
                                                         _mm256_mul_pd(_mm256_set1_pd(w.dx[0][l]), T[0])));
                } else {
                    v = gx = gy = _mm256_setzero_pd();
                    for (int j = 0; j < 3; j++)
                        for (int i = 0; i < 3; i++) {
                            __m256d nn = _mm256_load_pd(q + j * GG * 4 + i * 4);
                            int z = j * 3 + i;
                            v = _mm256_fmadd_pd(_mm256_set1_pd(w.w[z][l]), nn, v);
                            gx = _mm256_fmadd_pd(_mm256_set1_pd(w.gx[z][l]), nn, gx);
                            gy = _mm256_fmadd_pd(_mm256_set1_pd(w.gy[z][l]), nn, gy);
                        }
                }
                alignas(32) double r[4];
                _mm256_store_pd(r, v);
                o[0][l] = r[0];
                o[1][l] = r[1];
                o[2][l] = r[2];
                o[3][l] = r[3];
                __m128d X = _mm256_castpd256_pd128(gx), Y = _mm256_castpd256_pd128(gy);
                _mm_storel_pd(&o[4][l], X);
                _mm_storeh_pd(&o[6][l], X);
                _mm_storel_pd(&o[5][l], Y);
                _mm_storeh_pd(&o[7][l], Y);
            }
#pragma omp simd
            for (int l = 0; l < B; l++) {
                k.vx[l] += o[2][l];
                k.vy[l] += o[3][l];
                k.x[l] += dt * o[0][l];
                k.y[l] += dt * o[1][l];
                double A = k.fxx[l], b = k.fxy[l], c = k.fyx[l], d = k.fyy[l];
                k.fxx[l] = A + dt * (o[4][l] * A + o[5][l] * c);
                k.fxy[l] = b + dt * (o[4][l] * b + o[5][l] * d);
                k.fyx[l] = c + dt * (o[6][l] * A + o[7][l] * c);
                k.fyy[l] = d + dt * (o[6][l] * b + o[7][l] * d);
            }
        }
        wts<S>(k, w);
#pragma omp simd
        for (int l = 0; l < B; l++) {
            double A = k.fxx[l], b = k.fxy[l], c = k.fyx[l], d = k.fyy[l], J = A * d - b * c, L = lam * std::log(J),
                   V = k.V0[l];
            t[0][l] = -V * (mu * (A * A + b * b - 1) + L);
            t[2][l] = -V * (mu * (c * c + d * d - 1) + L);
            t[1][l] = -V * mu * (A * c + b * d);
            double R = std::sqrt(k.X[l] * k.X[l] + k.Y[l] * k.Y[l]), iR = 1 / R, q = brad(R, iR, s) * k.m[l] * iR;
            fb[0][l] = q * k.X[l];
            fb[1][l] = q * k.Y[l];
            mv[0][l] = k.m[l] * k.vx[l];
            mv[1][l] = k.m[l] * k.vy[l];
        }
        for (int l = 0; l < B; l++) {
            long nb = (long)w.bj[l] * GG + w.bi[l];
            if (nb != cb) {
                flush();
                cb = nb;
                cbi = w.bi[l];
                cbj = w.bj[l];
                for (int z = 0; z < 9; z++) a[z] = _mm512_setzero_pd();
            }
            __m512d Av = _mm512_set_pd(0, 0, 0, fb[1][l], fb[0][l], mv[1][l], mv[0][l], k.m[l]),
                    Bv = _mm512_set_pd(0, 0, 0, t[1][l], t[0][l], 0, 0, 0),
                    Cv = _mm512_set_pd(0, 0, 0, t[2][l], t[1][l], 0, 0, 0);
            if constexpr (S != CD) {
                __m512d y[3], e[3];
                for (int j = 0; j < 3; j++) {
                    y[j] = _mm512_set1_pd(w.wy[j][l]);
                    e[j] = _mm512_set1_pd(w.dy[j][l]);
                }
                for (int i = 0; i < 3; i++) {
                    __m512d wx = _mm512_set1_pd(w.wx[i][l]), dx = _mm512_set1_pd(w.dx[i][l]);
                    __m512d Pq = _mm512_fmadd_pd(dx, Bv, _mm512_mul_pd(wx, Av)), Q = _mm512_mul_pd(wx, Cv);
                    for (int j = 0; j < 3; j++)
                        a[j * 3 + i] = _mm512_fmadd_pd(e[j], Q, _mm512_fmadd_pd(y[j], Pq, a[j * 3 + i]));
                }
            } else
                for (int z = 0; z < 9; z++)
                    a[z] = _mm512_fmadd_pd(_mm512_set1_pd(w.gy[z][l]), Cv,
                                           _mm512_fmadd_pd(_mm512_set1_pd(w.gx[z][l]), Bv,
                                                           _mm512_fmadd_pd(_mm512_set1_pd(w.w[z][l]), Av, a[z])));
        }
    }
    flush();
}
template <Shape S> void run(std::vector<P> &ps, long steps) {
    int N = ps.size(), NB = (N + B - 1) / B;
    std::vector<Blk> bk(NB), tmp(NB);
    std::vector<int> cell(N), cnt;
    auto put = [&](Blk &k, int l, const P &p) {
        k.x[l] = p.x;
        k.y[l] = p.y;
        k.vx[l] = p.vx;
        k.vy[l] = p.vy;
        k.fxx[l] = p.fxx;
        k.fxy[l] = p.fxy;
        k.fyx[l] = p.fyx;
        k.fyy[l] = p.fyy;
        k.m[l] = p.m;
        k.V0[l] = p.V0;
        k.X[l] = p.X;
        k.Y[l] = p.Y;
    };
    std::vector<int> idx(NB * B);
    for (int p = 0; p < NB * B; p++) {
        P q = ps[std::min(p, N - 1)];
        if (p >= N) {
            q.m = 0;
            q.V0 = 0;
            q.vx = q.vy = 0;
        }
        put(bk[p / B], p % B, q);
        idx[p] = p;
    }
    std::vector<int> idt(NB * B);
    size_t GN = (size_t)G * G;
    Nd *gb = (Nd *)aligned_alloc(64, GN * sizeof(Nd));
    Nv *gv = (Nv *)aligned_alloc(64, GN * sizeof(Nv));
    memset((void *)gb, 0, GN * sizeof(Nd));
    memset((void *)gv, 0, GN * sizeof(Nv));
    Thr t{gb, std::vector<int>(G, 1 << 30), std::vector<int>(G, -1), 0, 0};
    auto resort = [&] {
        cnt.assign((size_t)G * G + 1, 0);
        int M = NB * B;
        cell.resize(M);
        for (int b = 0; b < NB; b++)
            for (int l = 0; l < B; l++) {
                const Blk &k = bk[b];
                double lx = .25, ly = .25;
                int c;
                if (S == UG) {
                } else if (S == CP) {
                    lx *= k.fxx[l];
                    ly *= k.fyy[l];
                } else {
                    lx = .25 * (std::fabs(k.fxx[l]) + std::fabs(k.fxy[l]));
                    ly = .25 * (std::fabs(k.fyx[l]) + std::fabs(k.fyy[l]));
                }
                c = (int)std::floor(k.y[l] * ih + OFF - ly) * G + (int)std::floor(k.x[l] * ih + OFF - lx);
                cell[b * B + l] = c;
                cnt[c + 1]++;
            }
        for (size_t i = 1; i < cnt.size(); i++) cnt[i] += cnt[i - 1];
        for (int p = 0; p < M; p++) {
            int d = cnt[cell[p]]++;
            const double *s = &bk[p / B].x[p % B];
            double *q = &tmp[d / B].x[d % B];
            for (int f = 0; f < 12; f++) q[f * B] = s[f * B];
            idt[d] = idx[p];
        }
        bk.swap(tmp);
        idx.swap(idt);
    };
    {
        resort();
        pass<S>(bk, gv, t, Aamp * std::sin(0.), false);
        C0 = cpu();
        for (long st = 0; st < steps; st++) {
            for (int j = t.rlo; j <= t.rhi; j++) {
                int lo = 1 << 30, hi = -1;
                for (int d = 0; d < 3 && j - d >= 0; d++) {
                    lo = std::min(lo, t.lo[j - d]);
                    hi = std::max(hi, t.hi[j - d]);
                }
                for (int i = lo; i <= hi; i++) {
                    size_t z = (size_t)j * G + i;
                    __m512d a = _mm512_load_pd((double *)(t.g + z));
                    _mm512_store_pd((double *)(t.g + z), _mm512_setzero_pd());
                    alignas(64) double r[8];
                    _mm512_store_pd(r, a);
                    Nv v = {0, 0, 0, 0};
                    if (r[0] > 1e-14) {
                        double im = 1 / r[0], ax = dt * r[3] * im, ay = dt * r[4] * im, vx = r[1] * im, vy = r[2] * im;
                        if (i <= OFF) ax = -vx;
                        if (j <= OFF) ay = -vy;
                        v = {vx + ax, vy + ay, ax, ay};
                    }
                    gv[z] = v;
                }
            }
            std::fill(t.lo.begin(), t.lo.end(), 1 << 30);
            std::fill(t.hi.begin(), t.hi.end(), -1);
            pass<S>(bk, gv, t, Aamp * std::sin(om * (st + 1) * dt), true);
            if ((st + 1) % SORTED_EVERY == 0) {
                resort();
            }
        }
        C1 = cpu();
    }
    for (int p = 0; p < NB * B; p++)
        if (idx[p] < N) {
            P &q = ps[idx[p]];
            Blk &k = bk[p / B];
            int l = p % B;
            q.x = k.x[l];
            q.y = k.y[l];
            q.vx = k.vx[l];
            q.vy = k.vy[l];
        }
    free(gb);
    free(gv);
}
int main(int c, char **v) {
    if (c < 4) return 2;
    std::string sh = v[1];
    n = atoi(v[2]);
    const long steps = atol(v[3]);
    h = Ldom / n;
    ih = 1 / h;
    G = n + 2 * OFF + 2;
    dt = 0.2 * h / cw;
    std::vector<P> ps;
    for (int j = 0; j < n; j++)
        for (int i = 0; i < n; i++)
            for (int b = 0; b < 2; b++)
                for (int a = 0; a < 2; a++) {
                    double X = (i + .25 + .5 * a) * h, Y = (j + .25 + .5 * b) * h, R = std::hypot(X, Y);
                    if (R < Ri || R > Ro) continue;
                    P p{};
                    p.x = p.X = X;
                    p.y = p.Y = Y;
                    double q = Aamp * om * gR(R) / R;
                    p.vx = q * X;
                    p.vy = q * Y;
                    p.fxx = p.fyy = 1;
                    p.V0 = .25 * h * h;
                    p.m = rho * p.V0;
                    ps.push_back(p);
                }
    if (sh == "ugimp")
        run<UG>(ps, steps);
    else if (sh == "cpgimp")
        run<CP>(ps, steps);
    else if (sh == "cpdi")
        run<CD>(ps, steps);
    else
        return 2;
    double s = Aamp * std::sin(om * steps * dt), err = 0;
    for (auto &p : ps) {
        double R = std::hypot(p.X, p.Y),
               e = std::hypot(p.x - p.X * (1 + s * gR(R) / R), p.y - p.Y * (1 + s * gR(R) / R));
        err = std::max(err, e);
    }
    printf("%.6g %.6g\n", 1e-6 * ps.size() * steps / (C1 - C0), err / Aamp);
}
