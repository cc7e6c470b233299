#include "core/distance/lane_kernels.h"

#include <bit>
#include <cstring>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/distance/lane_kernels.cpp"
#include <hwy/foreach_target.h> // includes this file once for each instruction set
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace core {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

constexpr size_t width = PointTree::width;
constexpr size_t leaf_size = PointTree::leaf_size;

using BoxTag = hn::CappedTag<float, width>;
using PointTag = hn::CappedTag<float, leaf_size>;

template <typename D, typename V>
HWY_INLINE V dot(D, V x, V y, V z, V ux, V uy, V uz) {
    return hn::Add(hn::Add(hn::Mul(x, ux), hn::Mul(y, uy)), hn::Mul(z, uz));
}

template <typename D, typename Mask>
HWY_INLINE uint32_t bits_of(D d, Mask mask) {
    uint8_t bytes[8] = {};
    hn::StoreMaskBits(d, mask, bytes);
    uint32_t bits = 0;
    std::memcpy(&bits, bytes, sizeof bits);
    return bits;
}

HWY_ATTR void project_boxes(const PointTree::Node& node, const FrameView& view, BoxLanes& out) {
    const BoxTag d;
    for (size_t i = 0; i < width; i += hn::Lanes(d)) {
        for (size_t k = 0; k < 3; ++k) {
            const auto ux = hn::Set(d, view.direction[k][0]);
            const auto uy = hn::Set(d, view.direction[k][1]);
            const auto uz = hn::Set(d, view.direction[k][2]);
            const auto along = [&](const std::array<PointTree::Lanes, 3>& v) HWY_ATTR {
                return dot(d, hn::Load(d, &v[0][i]), hn::Load(d, &v[1][i]), hn::Load(d, &v[2][i]),
                           ux, uy, uz);
            };
            const auto centre = along(node.centre);
            auto extent = hn::Mul(hn::Load(d, &node.half[0][i]), hn::Abs(along(node.axis[0])));
            for (size_t j = 1; j < 3; ++j)
                extent = hn::Add(
                    extent, hn::Mul(hn::Load(d, &node.half[j][i]), hn::Abs(along(node.axis[j]))));
            hn::Store(hn::Add(hn::Set(d, view.lower[k]), hn::Sub(centre, extent)), d,
                      &out.lower[k][i]);
            hn::Store(hn::Add(hn::Set(d, view.upper[k]), hn::Add(centre, extent)), d,
                      &out.upper[k][i]);
        }
    }
}

HWY_ATTR void project_points(const PointTree::Leaf& leaf, const FrameView& view, PointLanes& out) {
    const PointTag d;
    for (size_t i = 0; i < leaf_size; i += hn::Lanes(d)) {
        const auto x = hn::Load(d, &leaf.position[0][i]);
        const auto y = hn::Load(d, &leaf.position[1][i]);
        const auto z = hn::Load(d, &leaf.position[2][i]);
        for (size_t k = 0; k < 3; ++k) {
            const auto along =
                dot(d, x, y, z, hn::Set(d, view.direction[k][0]), hn::Set(d, view.direction[k][1]),
                    hn::Set(d, view.direction[k][2]));
            hn::Store(hn::Add(hn::Set(d, view.lower[k]), along), d, &out.at[k][i]);
        }
    }
}

HWY_ATTR uint32_t near_boxes(const BoxLanes& boxes, const FrameBox& box, float limit_squared,
                             PointTree::Lanes& squared) {
    const BoxTag d;
    uint32_t bits = 0;
    for (size_t i = 0; i < width; i += hn::Lanes(d)) {
        auto sum = hn::Zero(d);
        for (size_t k = 0; k < 3; ++k) {
            const auto above = hn::Sub(hn::Load(d, &boxes.lower[k][i]), hn::Set(d, box.upper[k]));
            const auto below = hn::Sub(hn::Set(d, box.lower[k]), hn::Load(d, &boxes.upper[k][i]));
            const auto gap = hn::Max(hn::Max(above, below), hn::Zero(d));
            sum = hn::Add(sum, hn::Mul(gap, gap));
        }
        hn::StoreU(sum, d, &squared[i]);
        bits |= bits_of(d, hn::Lt(sum, hn::Set(d, limit_squared))) << i;
    }
    return bits;
}

HWY_ATTR void middles_apart(const BoxLanes& boxes, const FrameBox& box, PointTree::Lanes& squared) {
    const BoxTag d;
    for (size_t i = 0; i < width; i += hn::Lanes(d)) {
        auto sum = hn::Zero(d);
        for (size_t k = 0; k < 3; ++k) {
            const auto apart =
                hn::Sub(hn::Add(hn::Load(d, &boxes.lower[k][i]), hn::Load(d, &boxes.upper[k][i])),
                        hn::Set(d, box.lower[k] + box.upper[k]));
            sum = hn::Add(sum, hn::Mul(apart, apart));
        }
        hn::StoreU(sum, d, &squared[i]);
    }
}

HWY_ATTR uint32_t near_box(const PointLanes& points, const FrameBox& box, float limit_squared) {
    const PointTag d;
    uint32_t bits = 0;
    for (size_t i = 0; i < leaf_size; i += hn::Lanes(d)) {
        auto sum = hn::Zero(d);
        for (size_t k = 0; k < 3; ++k) {
            const auto at = hn::Load(d, &points.at[k][i]);
            const auto gap = hn::Max(hn::Max(hn::Sub(at, hn::Set(d, box.upper[k])),
                                             hn::Sub(hn::Set(d, box.lower[k]), at)),
                                     hn::Zero(d));
            sum = hn::Add(sum, hn::Mul(gap, gap));
        }
        bits |= bits_of(d, hn::Le(sum, hn::Set(d, limit_squared))) << i;
    }
    return bits;
}

/// The points of A, as bits, that are within the limit of the path of a point of B.
HWY_INLINE HWY_ATTR uint16_t near_path(const PointLanes& a, const Float3& from, const Float3& sweep,
                                       float per_length, float limit_squared) {
    const PointTag d;
    const auto sx = hn::Set(d, sweep[0]), sy = hn::Set(d, sweep[1]), sz = hn::Set(d, sweep[2]);
    uint32_t bits = 0;
    for (size_t i = 0; i < leaf_size; i += hn::Lanes(d)) {
        auto x = hn::Sub(hn::Load(d, &a.at[0][i]), hn::Set(d, from[0]));
        auto y = hn::Sub(hn::Load(d, &a.at[1][i]), hn::Set(d, from[1]));
        auto z = hn::Sub(hn::Load(d, &a.at[2][i]), hn::Set(d, from[2]));
        if (per_length > 0.0F) {
            const auto fraction = hn::Mul(dot(d, x, y, z, sx, sy, sz), hn::Set(d, per_length));
            const auto t = hn::Min(hn::Max(fraction, hn::Zero(d)), hn::Set(d, 1.0F));
            x = hn::Sub(x, hn::Mul(t, sx));
            y = hn::Sub(y, hn::Mul(t, sy));
            z = hn::Sub(z, hn::Mul(t, sz));
        }
        bits |= bits_of(d, hn::Le(dot(d, x, y, z, x, y, z), hn::Set(d, limit_squared))) << i;
    }
    return static_cast<uint16_t>(bits);
}

Float3 point_of(const PointLanes& points, size_t row) {
    return {points.at[0][row], points.at[1][row], points.at[2][row]};
}

HWY_ATTR void near_points(const PointLanes& a, const PointLanes& b, uint32_t rows,
                          const Float3& sweep, float per_length, float limit_squared,
                          std::array<uint16_t, leaf_size>& columns) {
    for (; rows != 0; rows &= rows - 1) {
        const auto row = static_cast<size_t>(std::countr_zero(rows));
        columns[row] = near_path(a, point_of(b, row), sweep, per_length, limit_squared);
    }
}

const LaneKernels* kernels() {
    static constexpr LaneKernels table = {project_boxes, project_points, near_boxes,
                                          middles_apart, near_box,       near_points};
    return &table;
}

} // namespace
} // namespace HWY_NAMESPACE
} // namespace core
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace core {
namespace {
HWY_EXPORT(kernels);
} // namespace

const LaneKernels& lane_kernels() { return *HWY_DYNAMIC_DISPATCH(kernels)(); }

} // namespace core
#endif
