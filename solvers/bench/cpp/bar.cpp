// The practical limit of a step of the bar: uGIMP in one dimension, linear elastic, periodic, double precision, one
// thread. One pass over the particles a step, in blocks of eight: interpolate, move, add to the nodes, whose sums wait
// in registers until the cell changes. Nothing is measured of the run but its error at the end.
// Usage: bar CELLS STEPS. Prints million particle-steps a second of processor time, and the largest error of x over
// the amplitude.
#if !defined(__AVX2__) || !defined(__FMA__)
#error "needs a processor with AVX2 and FMA"
#endif
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <immintrin.h>
#include <time.h>
#include <vector>
static double cpu() {
    timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return t.tv_sec + 1e-9 * t.tv_nsec;
}
struct Node {
    double m, p, f, pad;
};
struct NV {
    double v, a;
};
int main(int c, char **v) {
    if (c < 3) return 2;
    const int n = atoi(v[1]);
    const long steps = atol(v[2]);
    const int ppc = 4;
    const double L = 1, E = 100, rho = 1, h = L / n, ih = 1 / h, cs = std::sqrt(E / rho), k = 2 * M_PI / L, om = cs * k,
                 v0 = 0.1;
    const double dt = 2.5e-5;
    int N = n * ppc;
    std::vector<double> x(N), u(N, 0.), V(N), s(N, 0.), F(N, 1.);
    double lp = 0.5 / ppc, m = rho * h / ppc, Vp = h / ppc;
    for (int p = 0; p < N; p++) {
        x[p] = (p + 0.5) * h / ppc;
        V[p] = v0 * std::sin(k * x[p]);
    }
    std::vector<double> X(x);
    // ghost-padded arrays, periodic images folded: node index b+1 in [0,n+4)
    int G = n + 6;
    std::vector<Node> g(G + 2);
    std::vector<NV> gv(G + 2);
    auto zero = [&] { memset(g.data(), 0, sizeof(Node) * g.size()); };
    auto gridstep = [&] { // nodes 2..n+1 are real; halo 0,1 <- n, n+1 ; n+2.. -> 2..
        for (int i = 0; i < 2; i++) {
            Node &a = g[n + i], &b = g[i];
            a.m += b.m;
            a.p += b.p;
            a.f += b.f;
        }
        for (int i = 0; i < 4; i++) {
            Node &a = g[2 + i], &b = g[n + 2 + i];
            a.m += b.m;
            a.p += b.p;
            a.f += b.f;
        }
        for (int i = 2; i < n + 2; i++) {
            double im = g[i].m > 1e-14 ? 1 / g[i].m : 0;
            double a = g[i].f * im * dt;
            gv[i] = {g[i].p * im + a, a};
        }
        for (int i = 0; i < 2; i++) gv[i] = gv[n + i];
        for (int i = 0; i < 4; i++) gv[n + 2 + i] = gv[2 + i];
    };

    double begun;
    { // fused: one particle pass per step; block of 8 for weights+update in SIMD, ymm node rows, register accumulators
        const int Bk = 8;
        int NB = (N + Bk - 1) / Bk;
        int NP = NB * Bk;
        auto pad = [&](std::vector<double> &a, double val) { a.resize(NP, val); };
        pad(x, x[N - 1]);
        pad(u, 0);
        pad(V, 0);
        pad(s, 0);
        pad(F, 1);
        std::vector<double> mm(NP, 0.), xs(NP);
        for (int p = 0; p < N; p++) mm[p] = m;
        alignas(64) double W[3][Bk], D[3][Bk], vv[Bk], dv[Bk], LL[Bk], mv[Bk], vs[Bk];
        alignas(64) int bi[Bk];
        double r = 1 / (4 * lp);
        auto weights = [&](const double *xx) {
#pragma omp simd
            for (int l = 0; l < Bk; l++) {
                double xi = xx[l] * ih;
                double fb = std::floor(xi - lp);
                bi[l] = (int)fb;
                double f = xi - fb, a = f - lp, B0 = f + lp, A = 1 - a, B = std::max(0., 1 - B0),
                       C = std::max(0., B0 - 1);
                double q0 = (A * A - B * B) * r, q2 = C * C * r;
                W[0][l] = q0;
                W[2][l] = q2;
                W[1][l] = 1 - q0 - q2;
                double e0 = (B - A) * 2 * r, e2 = C * 2 * r;
                D[0][l] = e0;
                D[2][l] = e2;
                D[1][l] = -e0 - e2;
            }
        };
        struct alignas(16) V2 {
            double v, a;
        };
        auto pass = [&](bool g2p) {
            __m256d a0 = _mm256_setzero_pd(), a1 = a0, a2 = a0;
            int cb = -100;
            auto flush = [&] {
                if (cb > -50) {
                    double *q = (double *)&g[cb + 2];
                    _mm256_storeu_pd(q, _mm256_add_pd(_mm256_loadu_pd(q), a0));
                    _mm256_storeu_pd(q + 4, _mm256_add_pd(_mm256_loadu_pd(q + 4), a1));
                    _mm256_storeu_pd(q + 8, _mm256_add_pd(_mm256_loadu_pd(q + 8), a2));
                }
            };
            for (int B = 0; B < NB; B++) {
                double *X = &x[B * Bk];
                if (g2p) {
                    weights(X);
                    for (int l = 0; l < Bk; l++) {
                        const double *q = (const double *)&gv[bi[l] + 2];
                        __m128d n0 = _mm_loadu_pd(q), n1 = _mm_loadu_pd(q + 2), n2 = _mm_loadu_pd(q + 4);
                        __m128d t = _mm_mul_pd(n0, _mm_set1_pd(W[0][l]));
                        t = _mm_fmadd_pd(n1, _mm_set1_pd(W[1][l]), t);
                        t = _mm_fmadd_pd(n2, _mm_set1_pd(W[2][l]), t);
                        __m128d e = _mm_mul_sd(n0, _mm_set_sd(D[0][l]));
                        e = _mm_fmadd_sd(n1, _mm_set_sd(D[1][l]), e);
                        e = _mm_fmadd_sd(n2, _mm_set_sd(D[2][l]), e);
                        vv[l] = _mm_cvtsd_f64(t);
                        dv[l] = _mm_cvtsd_f64(_mm_unpackhi_pd(t, t));
                        LL[l] = _mm_cvtsd_f64(e);
                    }
                    double *Vv = &V[B * Bk], *U = &u[B * Bk], *S = &s[B * Bk], *FF = &F[B * Bk];
#pragma omp simd
                    for (int l = 0; l < Bk; l++) {
                        Vv[l] += dv[l];
                        double dx = dt * vv[l];
                        U[l] += dx;
                        double xn = X[l] + dx;
                        xn = xn >= L ? xn - L : (xn < 0 ? xn + L : xn);
                        X[l] = xn;
                        double e = dt * LL[l] * ih;
                        FF[l] *= 1 + e;
                        S[l] += E * e;
                    }
                }
                weights(X);
                {
                    double *Vv = &V[B * Bk], *S = &s[B * Bk], *M = &mm[B * Bk];
#pragma omp simd
                    for (int l = 0; l < Bk; l++) {
                        mv[l] = M[l] * Vv[l];
                        vs[l] = -Vp * (M[l] > 0 ? S[l] : 0) * ih;
                    }
                    for (int l = 0; l < Bk; l++) {
                        if (bi[l] != cb) {
                            flush();
                            cb = bi[l];
                            a0 = a1 = a2 = _mm256_setzero_pd();
                        }
                        __m256d A = _mm256_set_pd(0, 0, mv[l], M[l]), C = _mm256_set_pd(0, vs[l], 0, 0);
                        a0 = _mm256_fmadd_pd(A, _mm256_set1_pd(W[0][l]), a0);
                        a0 = _mm256_fmadd_pd(C, _mm256_set1_pd(D[0][l]), a0);
                        a1 = _mm256_fmadd_pd(A, _mm256_set1_pd(W[1][l]), a1);
                        a1 = _mm256_fmadd_pd(C, _mm256_set1_pd(D[1][l]), a1);
                        a2 = _mm256_fmadd_pd(A, _mm256_set1_pd(W[2][l]), a2);
                        a2 = _mm256_fmadd_pd(C, _mm256_set1_pd(D[2][l]), a2);
                    }
                }
            }
            flush();
        };
        zero();
        pass(false);
        begun = cpu();
        for (long st = 0; st < steps; st++) {
            gridstep();
            zero();
            pass(true);
        }
    }
    double took = cpu() - begun, T = steps * dt, err = 0;
    for (int p = 0; p < N; p++) {
        double ue = v0 / om * std::sin(om * T) * std::sin(k * X[p]);
        err = std::max(err, std::fabs(u[p] - ue));
    }
    printf("%.6g %.6g\n", 1e-6 * N * steps / took, err / (v0 / om));
}
