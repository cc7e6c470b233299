#include "core/geom/stl_bytes.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>

#include <fmt/format.h>

namespace core {
namespace {

constexpr size_t header_length = 84;
constexpr size_t triangle_length = 50;

uint32_t stated_count(std::string_view bytes) {
    std::array<unsigned char, 4> b{};
    std::memcpy(b.data(), bytes.data() + 80, 4);
    return uint32_t{b[0]} | uint32_t{b[1]} << 8U | uint32_t{b[2]} << 16U | uint32_t{b[3]} << 24U;
}

size_t stated_length(std::string_view bytes) {
    return header_length + triangle_length * size_t{stated_count(bytes)};
}

using Corner = std::array<float, 3>;

Corner corner_at(std::string_view bytes, size_t triangle, size_t corner) {
    Corner point{};
    std::memcpy(point.data(),
                bytes.data() + header_length + triangle * triangle_length + 12 * (corner + 1), 12);
    return point;
}

bool is_finite(const Corner& c) {
    return std::isfinite(c[0]) && std::isfinite(c[1]) && std::isfinite(c[2]);
}

} // namespace

bool has_length_of_binary_stl(std::string_view bytes) {
    return bytes.size() >= header_length && bytes.size() == stated_length(bytes);
}

Result<StlCount> checked_binary_stl(std::string_view bytes) {
    if (bytes.size() < header_length)
        return fail(ErrorCode::syntax,
                    fmt::format("a binary STL has a header of 84 bytes, the file "
                                "{}",
                                bytes.size()));
    const uint32_t count = stated_count(bytes);
    if (bytes.size() != stated_length(bytes))
        return fail(ErrorCode::syntax,
                    fmt::format("its header states {} triangles, which take {} bytes, but the file "
                                "has {}",
                                count, stated_length(bytes), bytes.size()));
    if (count == 0) return fail(ErrorCode::missing_value, "there are no triangles in it");
    StlCount found{.triangles = count, .degenerate = 0};
    for (size_t i = 0; i < count; ++i) {
        const Corner a = corner_at(bytes, i, 0), b = corner_at(bytes, i, 1),
                     c = corner_at(bytes, i, 2);
        if (!is_finite(a) || !is_finite(b) || !is_finite(c))
            return fail(ErrorCode::invalid_value,
                        fmt::format("triangle {} has a coordinate that is not finite", i + 1));
        if (a == b || b == c || c == a) ++found.degenerate;
    }
    return found;
}

} // namespace core
