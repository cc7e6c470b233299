#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/base/vec.h"
#include "core/dbm/interval.h"

namespace core {

/// A stretch of a parameter: of a motion, of a line.
struct Range {
    double first, last;

    bool empty() const { return !(first < last); }
    double clamp(double t) const { return std::clamp(t, first, last); }
};

/// A quantity that changes evenly: at + t * by.
struct Linear {
    double at, by;

    double operator()(double t) const { return at + t * by; }
};

/// Where `f` is not negative, within `range`.
inline Range where_not_negative(const Linear& f, Range range) {
    if (f.by == 0.0) return f.at >= 0.0 ? range : Range{1.0, 0.0};
    const double root = -f.at / f.by;
    if (f.by > 0.0) return {std::max(range.first, root), range.last};
    return {range.first, std::min(range.last, root)};
}

/// a t^2 + 2 b t + c.
struct Quadratic {
    double a, b, c;

    double operator()(double t) const { return (a * t + 2.0 * b) * t + c; }
};

/// The zeros of q, lower one first, from its discriminant >= 0. Nothing cancels, so that a very
/// small `a` does no harm; a zero that is not there (a = 0) comes out infinite.
inline Range zeros(const Quadratic& q, double discriminant) {
    const double far = -q.b - std::copysign(std::sqrt(discriminant), q.b);
    if (far == 0.0) return {0.0, 0.0};
    const double one = far / q.a, other = q.c / far;
    return {std::min(one, other), std::max(one, other)};
}

/// Where q <= 0, for a >= 0, within `range`.
inline Range where_not_positive(const Quadratic& q, Range range) {
    if (q.a == 0.0) return where_not_negative({-q.c, -2.0 * q.b}, range);
    const double discriminant = q.b * q.b - q.a * q.c;
    if (discriminant < 0.0) return {1.0, 0.0};
    const Range below = zeros(q, discriminant);
    return {std::max(range.first, below.first), std::min(range.last, below.last)};
}

/// Least and greatest of two functions over the candidates that were tried.
struct Extent {
    double least = infinity, greatest = -infinity;

    void add(double low, double high) {
        least = std::min(least, low);
        greatest = std::max(greatest, high);
    }
    std::optional<Interval> interval() const {
        if (!(least < greatest)) return std::nullopt;
        return Interval{least, greatest};
    }
};

inline Quadratic squared(const Linear& f) { return {f.by * f.by, f.at * f.by, f.at * f.at}; }

inline Quadratic operator+(const Quadratic& p, const Quadratic& q) {
    return {p.a + q.a, p.b + q.b, p.c + q.c};
}

inline Quadratic operator-(const Quadratic& p, const Quadratic& q) {
    return {p.a - q.a, p.b - q.b, p.c - q.c};
}

} // namespace core
