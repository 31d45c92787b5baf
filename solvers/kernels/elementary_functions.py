"""Sine, cosine and logarithm in double precision, on all devices.

On CPUs they are the compiler's own. Vulkan has none in double precision, so on a GPU they are computed here, equally on
all of them: an accurate reduction of the argument, and polynomials with the coefficients of fdlibm (Sun Microsystems
1993), to one or two units in the last place. Angles may be up to a million.
"""

import taichi as ti

from solvers.kernels import runtime

#: pi/2 in three parts; the first two end in so many zeros that whole multiples up to 2^20 are exact.
HALF_PI, HALF_PI_NEXT, HALF_PI_LAST = 1.57079632673412561417, 6.07710050630396597660e-11, 2.02226624879595063154e-21
SIN = (-1.66666666666666324348e-01, 8.33333333332248946124e-03, -1.98412698298579493134e-04,
       2.75573137070700676789e-06, -2.50507602534068634195e-08, 1.58969099521155010221e-10)
COS = (4.16666666666666019037e-02, -1.38888888888741095749e-03, 2.48015872894767294178e-05,
       -2.75573143513906633035e-07, 2.08757232129817482790e-09, -1.13596475577881948265e-11)
LOG = (6.666666666666735130e-01, 3.999999999940941908e-01, 2.857142874366239149e-01, 2.222219843214978396e-01,
       1.818357216161805012e-01, 1.531383769920937332e-01, 1.479819860511658591e-01)
LOG_2, LOG_2_REST = 6.93147180369123816490e-01, 1.90821492927058770002e-10
EXPONENT_BITS, BIAS = 52, 1023  # of a double: where its exponent begins, and what is added to it


@ti.func
def sin(x):
    """Returns the sine of an angle in radians, of size up to 1e6."""
    value = 0.0
    if ti.static(runtime.runs_on_cpu()):
        value = ti.sin(x)
    else:
        value = _sine_of_quarter(x, 0)
    return value


@ti.func
def cos(x):
    """Returns the cosine of an angle in radians, of size up to 1e6."""
    value = 0.0
    if ti.static(runtime.runs_on_cpu()):
        value = ti.cos(x)
    else:
        value = _sine_of_quarter(x, 1)
    return value


@ti.func
def log(x):
    """Returns the natural logarithm of a normal number above 0."""
    value = 0.0
    if ti.static(runtime.runs_on_cpu()):
        value = ti.log(x)
    else:
        bits = ti.bit_cast(x, ti.i64)
        whole = ti.cast(bits >> EXPONENT_BITS, ti.i32) - BIAS
        mantissa = ti.cast(1, ti.i64) << EXPONENT_BITS
        m = ti.bit_cast((bits & (mantissa - 1)) | (ti.cast(BIAS, ti.i64) << EXPONENT_BITS), ti.f64)  # in [1, 2)
        if m > 1.4142135623730951:
            m, whole = 0.5 * m, whole + 1
        f, power = m - 1, ti.cast(whole, ti.f64)
        s = f / (2 + f)  # log(1 + f) = 2 atanh(s)
        rest = _polynomial(s * s, LOG)
        half = 0.5 * f * f
        value = power * LOG_2 - ((half - (s * (half + rest) + power * LOG_2_REST)) - f)
    return value


@ti.func
def _sine_of_quarter(x, quarters):
    """Returns sin(x + quarters pi/2) for an angle x in radians and an integer. Conditions are integers: on Vulkan,
    Taichi 1.7.4 loses booleans between one loop of a kernel and the next."""
    turns = ti.floor(x / (HALF_PI + HALF_PI_NEXT) + 0.5)
    y = ((x - turns * HALF_PI) - turns * HALF_PI_NEXT) - turns * HALF_PI_LAST
    square = y * y
    quadrant = (ti.cast(turns, ti.i32) + quarters) & 3
    odd, sign = quadrant & 1, 1 - (quadrant & 2)
    sine = y + y * _polynomial(square, SIN)
    cosine = 1 - (0.5 * square - square * _polynomial(square, COS))
    return sign * ((1 - odd) * sine + odd * cosine)


@ti.func
def _polynomial(z, coefficients: ti.template()):
    """Returns z (c_0 + z (c_1 + ...)) for compile-time ``coefficients`` c."""
    total = 0.0
    for k in ti.static(range(len(coefficients) - 1, -1, -1)):
        total = (total + coefficients[k]) * z
    return total
