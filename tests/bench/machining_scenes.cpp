#include "tests/bench/machining_scenes.h"

#include <cmath>

#include "tests/support/raster_program.h"

namespace bench {
namespace {

using core::Vec3;

core::CutModel block_of_stock(double h) {
    return core::make_cut_model({core::SolidBox{{{-50, -50, -30}, {50, 50, 0}}}, 0.0}, h).value();
}

void cut(core::CutModel& stock, const core::RevolvedProfile& flutes, const Vec3& from,
         const Vec3& to) {
    core::cut(stock, {std::make_shared<core::Cutter>(core::make_cutter(flutes, 0.0)), from, to});
}

MachiningScene facing(double h) {
    MachiningScene scene{"facing", {{{12, 20, 60, 20, 0}}}, block_of_stock(h), {}};
    for (int i = 0; i < 400; ++i) {
        const Vec3 from(-45 + 0.5 * (i % 180), -10.0 + i / 180, -10.8);
        scene.segments.push_back({from, from + Vec3(0.5, 0, 0), {}});
    }
    return scene;
}

MachiningScene pocket(double h) {
    MachiningScene scene{
        "pocket", {{{0, 3, 20, 3, 0}, {20, 12.5, 60, 12.5, 0}}}, block_of_stock(h), {}};
    cut(scene.stock, {{{0, 14.5, 40, 14.5, 0}}}, {0, 0, -25}, {0, 0, -25});
    scene.keep = 0.5;
    for (int i = 0; i < 400; ++i) {
        const double a = 0.1 * i, b = 0.1 * (i + 1), r = 0.3;
        scene.segments.push_back({{r * std::cos(a), r * std::sin(a), -23.5},
                                  {r * std::cos(b), r * std::sin(b), -23.5},
                                  {}});
    }
    return scene;
}

MachiningScene finishing(double h) {
    MachiningScene scene{
        "finishing", {{{4, 2.9, 30, 2.9, 0}, {30, 10, 60, 10, 0}}}, block_of_stock(h), {}};
    const test_support::RasterProgram program = test_support::raster_program(1.0, 0.5);
    const Vec3 shift = -Vec3(program.stock.center().x, program.stock.center().y, 0.0);
    const core::RevolvedProfile ball = test_support::raster_ball();
    for (const core::CutterSweep& sweep : test_support::sweeps_of(program, ball))
        cut(scene.stock, ball, sweep.from + shift, sweep.to + shift);
    scene.keep = 0.7;
    for (size_t i = 0; i < 400; ++i) {
        const size_t at = 5'000 + 17 * i;
        scene.segments.push_back(
            {program.positions[at] + shift, program.positions[at + 1] + shift, {}});
    }
    return scene;
}

} // namespace

std::vector<MachiningScene> machining_scenes() {
    const double h = 0.5;
    return {facing(h), pocket(h), finishing(h)};
}

} // namespace bench
