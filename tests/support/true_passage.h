#pragma once

#include "tests/support/true_path.h"

namespace test_support {

/// The minimum of a convex function on 0..1 and its argument, by golden section.
template <typename Function>
std::pair<double, double> least_of(const Function& f, double low, double high, int steps = 32) {
    constexpr double golden = 0.6180339887498949;
    double best = f(low), at = low;
    const auto offer = [&](double t) {
        const double value = f(t);
        if (value < best) best = value, at = t;
        return value;
    };
    offer(high);
    double a = high - golden * (high - low), b = low + golden * (high - low);
    double fa = offer(a), fb = offer(b);
    for (int i = 0; i < steps && low < high; ++i) {
        if (fa > fb) {
            low = a, a = b, fa = fb;
            fb = offer(b = low + golden * (high - low));
        } else {
            high = b, b = a, fb = fa;
            fa = offer(a = high - golden * (high - low));
        }
    }
    return {best, at};
}

/// The least distance of a profile to a passing point up to a fraction of the path, and when: a
/// distance that actually occurs, so never below the true one. Searches no farther than `limit`.
inline std::pair<double, double> nearest_passage(const TrueProfile& part, const SeenPoint& seen,
                                                 double until, double limit) {
    std::pair<double, double> best{core::infinity, 0.0};
    const int pieces =
        seen.path.is_straight() ? 1 : 2 + static_cast<int>(seen.path.bend() * until / 0.25);
    for (int i = 0; i < pieces; ++i) {
        const double low = until * i / pieces, high = until * (i + 1) / pieces;
        const core::Vec3 a = seen(low), b = seen(high);
        const double way = glm::distance(a, b), off = seen.off(high - low);
        const auto is_far = [&](const core::ProfileElement& e) {
            return 0.5 * (true_distance(e, a) + true_distance(e, b) - way) - off
                   >= std::min(limit, best.first);
        };
        if (is_far(part.hull)) continue;
        for (const core::ProfileElement& e : part.profile.elements) {
            if (is_far(e)) continue;
            const auto found =
                seen.path.is_straight()
                    ? least_of([&](double t) { return true_distance(e, a + t * (b - a)); }, 0, 1)
                    : least_of([&](double t) { return true_distance(e, seen(t)); }, low, high, 16);
            if (found.first < best.first)
                best = {found.first, seen.path.is_straight() ? until * found.second : found.second};
        }
    }
    return best;
}

/// Whether the uncertainty of 0.01 mm on a curved path counts.
enum class Doubt : uint8_t { counts, does_not_count };

/// The first fraction at which a piece is nearer to the point than `level`; exact on a straight
/// path.
inline std::optional<double> first_straight(const core::ProfileElement& e, const core::Vec3& a,
                                            const core::Vec3& b, double level) {
    const auto at = [&](double t) { return true_distance(e, a + t * (b - a)); };
    if (at(0.0) <= level) return 0.0;
    const auto [least, when] = least_of(at, 0.0, 1.0, 44);
    if (least > level) return std::nullopt;
    double out = 0.0, in = when;
    for (int i = 0; i < 40; ++i) {
        const double middle = 0.5 * (out + in);
        (at(middle) > level ? out : in) = middle;
    }
    return out;
}

/// A fraction at which the profile is nearer than `level` and just before which it is not. It is
/// nearer at `high` and not at `low`.
inline double certain_crossing(const TrueProfile& part, const SeenPoint& seen, double low,
                               double high, double level) {
    for (int i = 0; i < 30; ++i) {
        const double middle = 0.5 * (low + high);
        (true_distance(part.profile, seen(middle)) > level ? low : high) = middle;
    }
    return high;
}

/// The first fraction between two at which the profile may be nearer than `level`, up to 0.01 mm
/// too early; or, if uncertainty does not count, certainly is.
inline std::optional<double> first_bent(const TrueProfile& part, const SeenPoint& seen, double low,
                                        double high, double level, Doubt doubt) {
    constexpr double fine = 0.01; // mm
    const core::Vec3 a = seen(low), b = seen(high);
    const double way = glm::distance(a, b), off = seen.off(high - low);
    if (0.5 * (true_distance(part.hull, a) + true_distance(part.hull, b) - way) - off > level)
        return std::nullopt;
    const double at_a = true_distance(part.profile, a), at_b = true_distance(part.profile, b);
    if (at_a <= level) return low;
    if (0.5 * (at_a + at_b - way) - off > level) return std::nullopt;
    if (way < fine && off < fine) {
        if (doubt == Doubt::counts) return low;
        return at_b <= level ? std::optional(certain_crossing(part, seen, low, high, level))
                             : std::nullopt;
    }
    const double middle = 0.5 * (low + high);
    if (const auto first = first_bent(part, seen, low, middle, level, doubt)) return first;
    return first_bent(part, seen, middle, high, level, doubt);
}

/// The first fraction of the path at which the profile is nearer to the point than `level`.
inline std::optional<double> first_within(const TrueProfile& part, const SeenPoint& seen,
                                          double level, Doubt doubt) {
    if (!seen.path.is_straight()) return first_bent(part, seen, 0.0, 1.0, level, doubt);
    const core::Vec3 a = seen(0.0), b = seen(1.0);
    const double way = glm::distance(a, b);
    const auto is_far = [&](const core::ProfileElement& e) {
        return 0.5 * (true_distance(e, a) + true_distance(e, b) - way) > level;
    };
    std::optional<double> first;
    if (is_far(part.hull)) return first;
    for (const core::ProfileElement& e : part.profile.elements) {
        if (is_far(e)) continue;
        const auto found = first_straight(e, a, b, level);
        if (found && (!first || *found < *first)) first = found;
    }
    return first;
}

} // namespace test_support
