// The algorithm of Knoll, Hijazi, Hansen, Wald and Hagen, "Interactive Ray Tracing of Arbitrary
// Implicit Functions" (UUSCI-2007-002), as its authors would have compiled it. The compiler knows
// the formulas, intervals are rounded to nearest, positions are accumulated slab by slab, and
// normals are central differences. It proves nothing. Its speed is that of the paper's method on W
// lanes.
//
// It was written for zeroset from the paper's text, without the authors' code, as a stand-alone
// program. Only the code around the two loops differs from that program: it is called for bands of
// rows, and returns distances.
//
// build.rs compiles it once for each W (4 or 16; 8 works, too) with:
// -O3 -march=native -ffast-math -std=c++17 -DW=4
//
// Domain ±b, target 0, up y, fov 40.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>
#ifdef __SSE__
#include <xmmintrin.h>
#endif

// The namespace is anonymous since each W has different types of the same names.
namespace {

typedef float V __attribute__((vector_size(W * 4)));  // W lanes
typedef int M __attribute__((vector_size(W * 4)));    // a mask of W lanes
static V splat(float x) { return x - (V){}; }
static V least(V a, V b) { return a < b ? a : b; }
static V greatest(V a, V b) { return a > b ? a : b; }
static V root(V a) { V r; for (int i = 0; i < W; i++) r[i] = std::sqrt(a[i]); return r; }
static bool any(M m) { int r = 0; for (int i = 0; i < W; i++) r |= m[i]; return r; }
static const float INF = std::numeric_limits<float>::infinity();

struct Interval { V lo, hi; };
typedef Interval I;
static I operator+(I a, I b) { return {a.lo + b.lo, a.hi + b.hi}; }
static I operator-(I a, I b) { return {a.lo - b.hi, a.hi - b.lo}; }
static I operator*(I a, I b) {
  V p = a.lo * b.lo, q = a.lo * b.hi, r = a.hi * b.lo, s = a.hi * b.hi;
  return {least(least(p, q), least(r, s)), greatest(greatest(p, q), greatest(r, s))};
}
static I operator*(float c, I a) { return c >= 0 ? I{c * a.lo, c * a.hi} : I{c * a.hi, c * a.lo}; }
static I operator+(I a, float c) { return {a.lo + c, a.hi + c}; }
static I operator-(I a, float c) { return {a.lo - c, a.hi - c}; }
static I sq(I a) {
  V p = a.lo * a.lo, q = a.hi * a.hi;
  M across = (a.lo <= 0) & (a.hi >= 0);
  return {across ? splat(0) : least(p, q), greatest(p, q)};
}
static I p5(I a) { V l = a.lo * a.lo, h = a.hi * a.hi; return {l * l * a.lo, h * h * a.hi}; }
static I root(I a) { return {root(greatest(a.lo, splat(0))), root(greatest(a.hi, splat(0)))}; }
static V sq(V a) { return a * a; }
static V p5(V a) { V s = a * a; return s * s * a; }
template <class X> static X p4(X a) { return sq(sq(a)); }

// The formulas, evaluated over intervals for tracing and over points for shading.
#define SURFACE(name, bound, body)                                                      \
  struct name {                                                                         \
    static constexpr const char *label = #name;                                         \
    static constexpr float b = bound;                                                   \
    template <class X> static inline __attribute__((always_inline)) X f(X x, X y, X z) { body } \
  };
static const float PHI2 = 2.618033988749895f, BARTH = 4.23606797749979f;
template <class X> static inline __attribute__((always_inline)) X one_torus(X x, X y, X z) { X q = sq(x) + sq(y); return sq(q + sq(z) + 13.f) - 53.f * q; }
SURFACE(sphere, 1.2f, return sq(x) + sq(y) + sq(z) - 1.f;)
SURFACE(torus, 1.3f, X q = root(sq(x) + sq(y)) - 0.8f; return sq(q) + sq(z) - 0.11111f;)
SURFACE(steiner, 1.0f, X a = sq(x); X c = sq(y); X d = sq(z); return a * c + c * d + a * d + x * y * z;)
SURFACE(mitchell, 2.0f, X a = sq(x); X r = sq(y) + sq(z); return 4.f * (p4(x) + sq(r)) + 17.f * (a * r) + (-20.f) * (a + r) + 17.f;)
SURFACE(tangle, 3.0f, return p4(x) + (-5.f) * sq(x) + p4(y) + (-5.f) * sq(y) + p4(z) + (-5.f) * sq(z) + 11.8f;)
SURFACE(teardrop, 1.2f, return 0.5f * p5(x) + 0.5f * p4(x) - sq(y) - sq(z);)
SURFACE(klein, 4.2f, X r = sq(x) + sq(y) + sq(z); X a = r + 2.f * y - 1.f; X c = r - 2.f * y - 1.f; return a * (sq(c) - 8.f * sq(z)) + 16.f * (x * z * c);)
SURFACE(barth, 2.0f, X a = sq(x); X c = sq(y); X d = sq(z); return 4.f * ((PHI2 * a - c) * (PHI2 * c - d) * (PHI2 * d - a)) - BARTH * sq(a + c + d - 1.f);)
SURFACE(linked_tori, 1.0f, X u = 10.f * x; X v = 10.f * y; X w = 10.f * z; return one_torus<X>(u, v - 2.f, w) * one_torus<X>(w, v + 2.f, u) + 1000.f;)

struct Rays { V o[3], d[3], distance; M hit, valid; };
static thread_local long evaluations;

// Algorithm 3: slabs along the axis K are halved where F contains 0. A stack holds steps by depth.
template <class F> static void trace(Rays &r, float b, int depth) {
  V enter = splat(0), leave = splat(1e30f);
  for (int a = 0; a < 3; a++) {
    V inverse = 1.f / r.d[a], t0 = (-b - r.o[a]) * inverse, t1 = (b - r.o[a]) * inverse;
    enter = greatest(enter, least(t0, t1));
    leave = least(leave, greatest(t0, t1));
  }
  r.valid &= enter <= leave;
  r.hit = (M){};
  r.distance = splat(1e30f);
  if (!any(r.valid)) return;
  int K = 0;
  for (int a = 1; a < 3; a++) if (std::fabs(r.d[a][0]) > std::fabs(r.d[K][0])) K = a;
  int U = (K + 1) % 3, O = (K + 2) % 3;
  float k = r.d[K][0] > 0 ? -b : b, extent = -2 * k;
  V t = (k - r.o[K]) / r.d[K], whole = extent / r.d[K];
  V u = r.o[U] + r.d[U] * t, v = r.o[O] + r.d[O] * t;
  struct Step { V t, u, v; float k; } step[32];
  char side[32];
  float share = 0.5f;
  for (int d = 0; d < depth; d++, share *= 0.5f) {
    step[d] = {whole * share, r.d[U] * whole * share, r.d[O] * whole * share, extent * share};
    side[d] = 0;
  }
  M alive = r.valid;
  for (int d = 0; d >= 0;) {
    if (side[d] == 2) { side[d] = 0; d--; continue; }
    side[d]++;
    V tn = t + step[d].t, un = u + step[d].u, vn = v + step[d].v;
    float kn = k + step[d].k;
    M active = alive & (tn >= enter) & (t <= leave);
    if (any(active)) {
      I at[3];
      at[K] = {splat(std::min(k, kn)), splat(std::max(k, kn))};
      at[U] = {least(u, un), greatest(u, un)};
      at[O] = {least(v, vn), greatest(v, vn)};
      I f = F::template f<I>(at[0], at[1], at[2]);
      evaluations++;
      M zero = active & (f.lo <= 0) & (f.hi >= 0);
      if (any(zero)) {
        if (d < depth - 1) { d++; side[d] = 0; continue; }
        zero &= ~((f.hi - f.lo) == INF);
        r.distance = zero ? greatest(t, enter) : r.distance;
        r.hit |= zero;
        alive &= ~zero;
        if (!any(alive)) return;
      }
    } else if (!any(alive & (t <= leave))) return;
    t = tn; u = un; v = vn; k = kn;
  }
}

static const int ACROSS = W == 4 ? 2 : 4, DOWN = W == 16 ? 4 : 2;

// Draws rows from `top`, a multiple of DOWN, to `bottom`. Distances are -1 where nothing is drawn.
//
// Repeats, clock and report come from the stand-alone program, and are kept for speed. Without
// them, or with an eye known to the compiler, g++ 12 generates other loops: the torus is slower by
// half, and the tangle by a third.
template <class F>
static long picture(int size, int top, int bottom, int depth, const float *eye, int repeats, unsigned char *rgb, float *distance) {
  float b = F::b, cam[3], fw[3], right[3], up[3] = {0, 1, 0}, length = 0;
  for (int a = 0; a < 3; a++) { cam[a] = eye[a] * b; length += cam[a] * cam[a]; }
  for (int a = 0; a < 3; a++) fw[a] = -cam[a] / std::sqrt(length);
  float cross[3] = {fw[1] * up[2] - fw[2] * up[1], fw[2] * up[0] - fw[0] * up[2], fw[0] * up[1] - fw[1] * up[0]};
  length = std::sqrt(cross[0] * cross[0] + cross[1] * cross[1] + cross[2] * cross[2]);
  for (int a = 0; a < 3; a++) right[a] = cross[a] / length;
  float above[3] = {right[1] * fw[2] - right[2] * fw[1], right[2] * fw[0] - right[0] * fw[2], right[0] * fw[1] - right[1] * fw[0]};
  float reach = std::tan(20 * M_PI / 180);
  double best = 1e9;
  long drawn = 0;
  for (int repeat = 0; repeat < repeats; repeat++) {
    evaluations = drawn = 0;
    auto start = std::chrono::steady_clock::now();
    for (int y = top; y < bottom; y += DOWN) for (int x = 0; x < size; x += ACROSS) {
      Rays r;
      r.valid = ~(M){};
      for (int i = 0; i < W; i++) {
        float sx = ((x + i % ACROSS + 0.5f) / size * 2 - 1) * reach, sy = (1 - (y + i / ACROSS + 0.5f) / size * 2) * reach, d[3], l = 0;
        for (int a = 0; a < 3; a++) { d[a] = fw[a] + sx * right[a] + sy * above[a]; l += d[a] * d[a]; }
        for (int a = 0; a < 3; a++) { r.o[a][i] = cam[a]; r.d[a][i] = d[a] / std::sqrt(l); }
      }
      trace<F>(r, b, depth);
      V bright = splat(0);
      if (any(r.hit)) {
        V t = r.hit ? r.distance : splat(0), p[3], n[3];
        for (int a = 0; a < 3; a++) p[a] = r.o[a] + t * r.d[a];
        float h = b * 1e-3f;
        n[0] = F::template f<V>(p[0] + h, p[1], p[2]) - F::template f<V>(p[0] - h, p[1], p[2]);
        n[1] = F::template f<V>(p[0], p[1] + h, p[2]) - F::template f<V>(p[0], p[1] - h, p[2]);
        n[2] = F::template f<V>(p[0], p[1], p[2] + h) - F::template f<V>(p[0], p[1], p[2] - h);
        V cosine = (n[0] * r.d[0] + n[1] * r.d[1] + n[2] * r.d[2]) / (root(sq(n[0]) + sq(n[1]) + sq(n[2])) + 1e-20f);
        bright = greatest(cosine, -cosine);
      }
      for (int i = 0; i < W; i++) {
        int px = x + i % ACROSS, py = y + i / ACROSS;
        if (px >= size || py >= bottom) continue;
        unsigned char *out = &rgb[3 * ((py - top) * size + px)];
        distance[(py - top) * size + px] = r.hit[i] ? r.distance[i] : -1;
        if (!r.hit[i]) { out[0] = out[1] = 50; out[2] = 60; continue; }
        drawn++;
        float c = bright[i] == bright[i] ? bright[i] : 0;
        out[0] = 40 + 210 * c; out[1] = 40 + 150 * c; out[2] = 40 + 80 * c;
      }
    }
    best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  if (repeats > 1) std::printf("%-12s W=%-2d depth=%-2d %8.2f ms  drawn %7ld  evaluations %9ld\n", F::label, W, depth, best * 1e3, drawn, evaluations);
  return drawn;
}

static const struct {
  const char *label;
  long (*picture)(int, int, int, int, const float *, int, unsigned char *, float *);
} SURFACES[] = {
#define ROW(name) {name::label, picture<name>}
    ROW(sphere),   ROW(torus), ROW(steiner), ROW(mitchell),    ROW(tangle),
    ROW(teardrop), ROW(klein), ROW(barth),   ROW(linked_tori),
};

}  // namespace

#define PASTE(a, b) a##b
#define ENTRY(w) PASTE(knoll2007_w, w)

// Draws the rows from `top` to `bottom` of the surface `name` into buffers of these rows, `repeats`
// times. Stores the number of drawn pixels and of evaluations of W boxes. The eye is three numbers,
// in half extents. Returns false if there is no such surface.
extern "C" bool ENTRY(W)(const char *name, int size, int top, int bottom, int depth, const float *eye, int repeats,
                         unsigned char *rgb, float *distance, long *drawn, long *boxes) {
  for (auto &surface : SURFACES) {
    if (std::strcmp(surface.label, name)) continue;
#ifdef __SSE__
    // A program linked with -ffast-math starts in this mode, which flushes subnormals to zero.
    unsigned mode = _mm_getcsr();
    _mm_setcsr(mode | 0x8040);
#endif
    *drawn = surface.picture(size, top, bottom, depth, eye, repeats, rgb, distance);
    *boxes = evaluations;
#ifdef __SSE__
    _mm_setcsr(mode);
#endif
    return true;
  }
  return false;
}
