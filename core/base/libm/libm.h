/* What the sources of musl in this folder need from their surroundings, in place of musl's own
 * libm.h; the macros below are from there. Included before each source (core/base/CMakeLists.txt).
 *
 * All names get a prefix, so that neither they nor those of the C library replace each other.
 */
#ifndef FEELER_LIBM_H
#define FEELER_LIBM_H

#include <float.h>
#include <math.h>
#include <stdint.h>

#if FLT_EVAL_METHOD != 0
#error "the same bits need double arithmetic without excess precision, as with SSE2"
#endif

#define acos feeler_acos
#define asin feeler_asin
#define atan feeler_atan
#define atan2 feeler_atan2
#define cos feeler_cos
#define exp feeler_exp
#define hypot feeler_hypot
#define log feeler_log
#define log10 feeler_log10
#define pow feeler_pow
#define scalbn feeler_scalbn
#define sin feeler_sin
#define tan feeler_tan
#define __cos feeler_kernel_cos
#define __sin feeler_kernel_sin
#define __tan feeler_kernel_tan
#define __exp_data feeler_exp_data
#define __log_data feeler_log_data
#define __pow_log_data feeler_pow_log_data
#define __math_divzero feeler_math_divzero
#define __math_invalid feeler_math_invalid
#define __math_oflow feeler_math_oflow
#define __math_uflow feeler_math_uflow
#define __math_xflow feeler_math_xflow
#define __rem_pio2 feeler_rem_pio2
#define __rem_pio2_large feeler_rem_pio2_large

double acos(double);
double asin(double);
double atan(double);
double atan2(double, double);
double cos(double);
double exp(double);
double hypot(double, double);
double log(double);
double log10(double);
double pow(double, double);
double scalbn(double, int);
double sin(double);
double tan(double);

double __cos(double, double);
double __sin(double, double, int);
double __tan(double, double, int);
double __math_divzero(uint32_t);
double __math_invalid(double);
double __math_oflow(uint32_t);
double __math_uflow(uint32_t);
double __math_xflow(uint32_t, double);
int __rem_pio2(double, double*);
int __rem_pio2_large(double*, double*, int, int, int);

#define hidden
#define WANT_ROUNDING 1
#define TOINT_INTRINSICS 0
#define issignaling_inline(x) 0
#define predict_true(x) __builtin_expect(!!(x), 1)
#define predict_false(x) __builtin_expect(x, 0)

static inline double eval_as_double(double x) { return x; }

static inline double fp_barrier(double x) {
    volatile double y = x;
    return y;
}

static inline void fp_force_eval(double x) {
    volatile double y = x;
    (void)y;
}

#define FORCE_EVAL(x) fp_force_eval(x)

#define asuint64(f) ((union { double _f; uint64_t _i; }){f})._i
#define asdouble(i) ((union { uint64_t _i; double _f; }){i})._f

#define EXTRACT_WORDS(hi, lo, d)    \
    do {                            \
        uint64_t __u = asuint64(d); \
        (hi) = __u >> 32;           \
        (lo) = (uint32_t)__u;       \
    } while (0)

#define GET_HIGH_WORD(hi, d)      \
    do {                          \
        (hi) = asuint64(d) >> 32; \
    } while (0)

#define GET_LOW_WORD(lo, d)         \
    do {                            \
        (lo) = (uint32_t)asuint64(d); \
    } while (0)

#define INSERT_WORDS(d, hi, lo)                                  \
    do {                                                         \
        (d) = asdouble(((uint64_t)(hi) << 32) | (uint32_t)(lo)); \
    } while (0)

#define SET_HIGH_WORD(d, hi) INSERT_WORDS(d, hi, (uint32_t)asuint64(d))
#define SET_LOW_WORD(d, lo) INSERT_WORDS(d, asuint64(d) >> 32, lo)

#endif
