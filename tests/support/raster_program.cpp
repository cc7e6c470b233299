#include "tests/support/raster_program.h"

#include <numbers>

namespace test_support {
namespace {

constexpr double wave = 2.0 * std::numbers::pi / 25.0;
constexpr double ball_radius = 3.0;

struct Slope {
    double x, y, length; // length of (x, y, 1)
};

Slope slope_at(double x, double y) {
    const double sx = 3.0 * wave * std::cos(wave * x) * std::cos(wave * y);
    const double sy = -3.0 * wave * std::sin(wave * x) * std::sin(wave * y);
    return {sx, sy, std::sqrt(1.0 + sx * sx + sy * sy)};
}

} // namespace

double raster_surface(double x, double y) {
    return -5.0 + 3.0 * std::sin(wave * x) * std::cos(wave * y);
}

double raster_tip(double x, double y, double radius) {
    // The point of contact (u, v) is one radius away from the centre along the normal there.
    double u = x, v = y;
    for (int i = 0; i < 200; ++i) {
        const Slope s = slope_at(u, v);
        const double next_u = 0.5 * (u + x + radius * s.x / s.length);
        const double next_v = 0.5 * (v + y + radius * s.y / s.length);
        const bool settled = std::abs(next_u - u) + std::abs(next_v - v) < 1e-13;
        u = next_u;
        v = next_v;
        if (settled) break;
    }
    return raster_surface(u, v) + radius / slope_at(u, v).length - radius;
}

RasterProgram raster_program(double stepover, double spacing) {
    constexpr double side = 100.0, clear = 5.0;
    const int rows = static_cast<int>(std::lround(side / stepover));
    const int columns = static_cast<int>(std::lround(side / spacing));
    RasterProgram program{{{0, 0, -30}, {side, side, 0}}, {}, {}};
    // Posted programs have three decimals.
    const auto posted = [](double value) { return std::round(value * 1000.0) / 1000.0; };
    for (int row = 0; row < rows; ++row)
        for (int k = 0; k < columns; ++k) {
            const double x = ((row % 2 ? columns - 1 - k : k) + 0.5) * spacing;
            const double y = (row + 0.5) * stepover;
            const core::Vec3 position(posted(x), posted(y), posted(raster_tip(x, y, ball_radius)));
            if (program.positions.empty()) {
                program.start = {position.x, position.y, clear};
                program.positions.push_back({position.x, position.y, 1.0});
            }
            program.positions.push_back(position);
        }
    const core::Vec3 last = program.positions.back();
    program.positions.push_back({last.x, last.y, 1.0});
    program.positions.push_back({last.x, last.y, clear});
    program.positions.push_back({program.start.x, program.start.y, clear});
    return program;
}

core::RevolvedProfile raster_ball() {
    return {{{ball_radius, 0.0, ball_radius, 0.0, ball_radius},
             {ball_radius, ball_radius, 30.0, ball_radius, 0.0}}};
}

std::vector<core::CutterSweep> sweeps_of(const RasterProgram& program,
                                         const core::RevolvedProfile& flutes, double path_error) {
    const auto cutter = std::make_shared<const core::Cutter>(core::make_cutter(flutes, path_error));
    std::vector<core::CutterSweep> sweeps;
    core::Vec3 at = program.start;
    for (const core::Vec3& position : program.positions) {
        sweeps.push_back(
            {cutter, at, position, core::Mat3(1.0), static_cast<uint32_t>(sweeps.size())});
        at = position;
    }
    return sweeps;
}

} // namespace test_support
