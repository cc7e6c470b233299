// Compiled once for each instruction set: included from within foreach_target, no other way.
#if defined(FEELER_LANE_TILT_H) == defined(HWY_TARGET_TOGGLE)
#ifdef FEELER_LANE_TILT_H
#undef FEELER_LANE_TILT_H
#else
#define FEELER_LANE_TILT_H
#endif

#include "core/dbm/lane_row.h"

HWY_BEFORE_NAMESPACE();
namespace core {
namespace HWY_NAMESPACE {
namespace {

/// A point of each line of a chunk, in the frame of the tool.
struct RowPoint {
    Row x, y, z;
};

HWY_INLINE RowPoint moved_by(const RowPoint& p, const Row& k, const Vec3& by) {
    return {p.x + k * by.x, p.y + k * by.y, p.z + k * by.z};
}
HWY_INLINE Row dot(const RowPoint& p, const Vec3& n) { return p.x * n.x + p.y * n.y + p.z * n.z; }

/// Ranges of a parameter, empty where `first` is above `last`.
struct RowRange {
    Row first, last;
};

/// Narrows ranges to where at + k * by is not negative.
HWY_INLINE void narrow_to_positive(const Row& at, double by, RowRange& range) {
    if (by == 0.0) {
        const RowMask outside = below(at, row_of(0.0));
        range.first = choose(outside, row_of(infinity), range.first);
    } else if (by > 0.0) {
        range.first = most(range.first, at * (-1.0 / by));
    } else {
        range.last = least(range.last, at * (-1.0 / by));
    }
}

/// The least and the greatest candidate of each line.
struct RowExtent {
    Row least_end, greatest_end;

    HWY_INLINE void offer(const RowMask& valid, const Row& low, const Row& high) {
        least_end = choose(valid & below(low, least_end), low, least_end);
        greatest_end = choose(valid & below(greatest_end, high), high, greatest_end);
    }
};

/// tilted_cone of swept_line.cpp, with the same names.
struct TiltedCone {
    static constexpr double slack = 1e-10; // mm

    const TiltedLanes& c;
    RowPoint p; // of the lines where they are at 0, from the origin of the piece at the start

    /// The range of s in the cone at one time of the motion.
    HWY_INLINE void offer_chord(double t, RowExtent& extent) const {
        const RowPoint position{p.x - row_of(t * c.m.x), p.y - row_of(t * c.m.y),
                                p.z - row_of(t * c.m.z)};
        const Row shift = row_of(0.0) - dot(position, c.d);
        const RowPoint q = moved_by(position, shift, c.d);
        RowRange range{row_of(-infinity), row_of(infinity)};
        narrow_to_positive(q.z - c.z0 + slack, c.d.z, range);
        narrow_to_positive(row_of(c.z1 + slack) - q.z, -c.d.z, range);
        const Row radius = (q.z - c.z0) * c.slope + c.r0;
        const double by_z = c.slope * c.d.z;
        const Row b = q.x * c.d.x + q.y * c.d.y - radius * by_z;
        // Counted from the middle of the two crossings, so that nothing cancels.
        const Row middle = b * (-1.0 / c.chord_a);
        const Row fx = q.x + middle * c.d.x, fy = q.y + middle * c.d.y, fz = radius + middle * by_z;
        const Row away = root(fx * fx + fy * fy);
        const Row square = (away - fz) * (away + fz) * (-1.0 / c.chord_a);
        const Row half = root(square);
        if (c.chord_a > 0.0) {
            const RowMask misses = below(square, row_of(0.0));
            range.first = choose(misses, row_of(infinity), most(range.first, middle - half));
            range.last = least(range.last, middle + half);
        } else if (by_z > 0.0) { // steeper than the flank: only one nappe belongs to the piece
            range.first = most(range.first, middle + half);
        } else {
            range.last = least(range.last, middle - half);
        }
        extent.offer(at_most(range.first, range.last), range.first + shift, range.last + shift);
    }

    /// The range of s in which the lines pass through an end face of the piece, at any time.
    HWY_INLINE void offer_face(double z, double radius, RowExtent& extent) const {
        if (c.face_s == 0.0 && c.face_t == 0.0) return;
        const Row rise = row_of(z) - p.z;
        const Row s0 = rise * c.face_s, t0 = rise * c.face_t;
        const RowPoint q = moved_by(moved_by(p, s0, c.d), row_of(0.0) - t0, c.m);
        RowRange range{row_of(-infinity), row_of(infinity)};
        narrow_to_positive(t0 + slack, c.face_t_by, range);
        narrow_to_positive(row_of(c.length + slack) - t0, -c.face_t_by, range);
        const double wide = radius + slack;
        const Vec3& e = c.face_e;
        const double a = e.x * e.x + e.y * e.y;
        RowMask met{};
        if (a == 0.0) {
            met = at_most(q.x * q.x + q.y * q.y, row_of(wide * wide));
        } else {
            const Row foot = (q.x * e.x + q.y * e.y) * (-1.0 / a);
            const Row nx = q.x + foot * e.x, ny = q.y + foot * e.y;
            const Row away = root(nx * nx + ny * ny);
            met = at_most(away, row_of(wide));
            const Row half = root((row_of(radius) - away) * (away + radius) * (1.0 / a));
            range.first = most(range.first, foot - half);
            range.last = least(range.last, foot + half);
        }
        met = met & at_most(range.first, range.last) & below(row_of(-infinity), range.first)
              & below(range.last, row_of(infinity));
        // Of lanes that are not met, the products need not be numbers.
        const Row first = choose(met, range.first, row_of(0.0));
        const Row last = choose(met, range.last, row_of(0.0));
        const Row one = s0 + first * c.face_s_by, other = s0 + last * c.face_s_by;
        extent.offer(met, least(one, other), most(one, other));
    }

    /// Where the lines meet the envelope of the moving flank.
    HWY_INLINE void offer_touches(RowExtent& extent) const {
        constexpr double outside = 5e-10; // mm
        if (!c.has_silhouette) return;
        const Row radius = (p.z - c.z0) * c.slope + c.r0;
        const RowPoint at{p.x, p.y, radius};
        const Row h = dot(at, c.touch_n), s_foot = dot(at, c.touch_s_foot),
                  t_foot = dot(at, c.touch_t_foot);
        for (const double y : c.touch_y) {
            if (!std::isfinite(y)) continue;
            const Row s = h * y;
            const Row t = h * c.touch_t_by_h + s * c.touch_t_by_s + t_foot;
            const Row along = s + s_foot;
            const RowPoint q = moved_by(moved_by(p, along, c.d), row_of(0.0) - t, c.m);
            const RowMask in_time = below(row_of(-slack), t) & below(t, row_of(c.length + slack));
            const RowMask in_height =
                at_most(row_of(c.z0 - outside), q.z) & at_most(q.z, row_of(c.z1 + outside));
            const Row away = root(q.x * q.x + q.y * q.y);
            const RowMask in_flank = at_most(away - ((q.z - c.z0) * c.slope + c.r0),
                                             row_of(outside * std::sqrt(1.0 + c.slope * c.slope)));
            extent.offer(in_time & in_height & in_flank, along, along);
        }
    }
};

/// Adds what a tilted cone sweeps. The set of (s, t), position on the line and time, is convex, so
/// its extremes in s are on one of its four straight borders or at a turning point of the section.
HWY_INLINE void add_tilted(const TiltedLanes& c, const Row& u, double v, Swept& all) {
    const Vec3 first = c.origin + v * c.by_v;
    const TiltedCone cone{c,
                          {u * c.by_u.x + first.x, u * c.by_u.y + first.y, u * c.by_u.z + first.z}};
    RowExtent extent{row_of(infinity), row_of(-infinity)};
    cone.offer_chord(0.0, extent);
    if (c.length > 0.0) {
        cone.offer_chord(c.length, extent);
        cone.offer_face(c.z0, c.r0, extent);
        cone.offer_face(c.z1, c.r1, extent);
        cone.offer_touches(extent);
    }
    const RowMask found = below(extent.least_end, extent.greatest_end);
    unite_low(all, found, extent.least_end + c.from_a, row_of(1.0));
    unite_high(all, found, extent.greatest_end + c.from_a, row_of(1.0));
}

} // namespace
} // namespace HWY_NAMESPACE
} // namespace core
HWY_AFTER_NAMESPACE();

#endif
