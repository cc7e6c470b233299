#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <numbers>
#include <random>
#include <string>

#include <fmt/format.h>

#include "tests/support/raster_program.h"

namespace {

using namespace core;
using test_support::raster_program;

struct Task {
    Aabb stock;
    std::vector<CutterSweep> sweeps;
};

/// The resident memory of the process, MB.
double resident() {
    std::ifstream file("/proc/self/statm");
    double pages = 0.0;
    file >> pages >> pages;
    return pages * 4096.0 / 1e6;
}

struct Measured {
    double cpu = 0.0, wall = 0.0, removed = 0.0;
};

Measured cut_all(CutModel& model, const std::vector<CutterSweep>& sweeps, unsigned threads) {
    const clock_t cpu = clock();
    const auto wall = std::chrono::steady_clock::now();
    Measured m;
    if (threads == 0)
        for (const CutterSweep& sweep : sweeps) m.removed += cut(model, sweep);
    else
        for (const double volume : cut(model, sweeps, threads)) m.removed += volume;
    m.cpu = static_cast<double>(clock() - cpu) / CLOCKS_PER_SEC;
    m.wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - wall).count();
    return m;
}

void measure(const std::string& name, const Task& task, double h, WithColumns columns,
             unsigned threads) {
    const double before = resident();
    CutModel model =
        make_cut_model({SolidBox{task.stock}, 0.0}, h, default_memory_limit, columns).value();
    const Measured m = cut_all(model, task.sweeps, threads);
    const auto blocks = static_cast<double>(task.sweeps.size());
    fmt::print("{:<34} h {:<4} {:>9.0f} blocks/CPU s {:>9.0f} blocks/s {:>6.1f} MB {:>12.3f} mm3\n",
               name, h, blocks / m.cpu, blocks / m.wall, resident() - before, m.removed);
}

/// The exact envelope, by search among all moves near a line along Z.
double envelope(const Task& task, double x, double y, double below) {
    double lowest = below;
    for (const CutterSweep& s : task.sweeps) {
        if (std::min(s.from.x, s.to.x) - 3.1 > x || std::max(s.from.x, s.to.x) + 3.1 < x
            || std::min(s.from.y, s.to.y) - 3.1 > y || std::max(s.from.y, s.to.y) + 3.1 < y)
            continue;
        const auto height = [&](double t) {
            const Vec3 tip = s.from + t * (s.to - s.from);
            const double away = std::hypot(x - tip.x, y - tip.y);
            return away < 3.0 ? tip.z + 3.0 - std::sqrt((3.0 - away) * (3.0 + away)) : infinity;
        };
        double low = 0.0, high = 1.0;
        for (int i = 0; i < 100; ++i) {
            const double a = low + (high - low) / 3.0, b = high - (high - low) / 3.0;
            (height(a) <= height(b) ? high : low) = height(a) <= height(b) ? b : a;
        }
        lowest = std::min({lowest, height(0.0), height(1.0), height(0.5 * (low + high))});
    }
    return lowest;
}

void measure_error(const Task& task, double h) {
    CutModel model = make_cut_model({SolidBox{task.stock}, 0.0}, h).value();
    cut_all(model, task.sweeps, 0);
    std::mt19937 rng(5);
    double most = 0.0, squares = 0.0;
    constexpr int samples = 300;
    for (int i = 0; i < samples; ++i) {
        const int u = static_cast<int>(rng() % static_cast<unsigned>(model.lines.grid.count(0)));
        const int v = static_cast<int>(rng() % static_cast<unsigned>(model.lines.grid.count(1)));
        const double truth = envelope(task, model.lines.grid.coordinate(0, u),
                                      model.lines.grid.coordinate(1, v), 0.0);
        const double error = std::abs(model.lines.families[2].line(u, v).back().upper - truth);
        most = std::max(most, error);
        squares += error * error;
    }
    fmt::print("ends of {} lines along Z, h {}: off by {:.2g} mm at most, {:.2g} rms\n", samples, h,
               most, std::sqrt(squares / samples));
}

Task raster(const RevolvedProfile& flutes, size_t most = ~size_t{0}) {
    const test_support::RasterProgram program = raster_program();
    Task task{program.stock, sweeps_of(program, flutes)};
    task.sweeps.resize(std::min(task.sweeps.size(), most));
    return task;
}

/// Helical bores of many turns, in chords within 0.0025 mm of the arc.
Task helices() {
    constexpr double chord_error = 0.0025, radius = 6.0;
    const auto cutter =
        std::make_shared<const Cutter>(make_cutter({{{0, 3, 30, 3, 0}}}, chord_error));
    const double step = 2.0 * std::acos(1.0 - chord_error / radius);
    Task task{{{0, 0, -30}, {100, 100, 0}}, {}};
    for (int bore = 0; bore < 5; ++bore) {
        const auto at = [&](double angle) {
            return Vec3(10 + 20 * (bore % 5) + radius * std::cos(angle),
                        10 + 20 * (bore / 5) + radius * std::sin(angle),
                        -0.25 * angle / std::numbers::pi);
        };
        for (double angle = 0.0; angle < 4.0 * 2.0 * std::numbers::pi; angle += step)
            task.sweeps.push_back({cutter, at(angle), at(angle + step)});
    }
    return task;
}

} // namespace

int main(int argc, char** argv) {
    std::setvbuf(stdout, nullptr, _IOLBF, 0);
    const bool quick = argc > 1 && std::string(argv[1]) == "--quick";
    const size_t most = quick ? 20000 : ~size_t{0};
    const RevolvedProfile ball = test_support::raster_ball();
    for (const double h : {0.5, 0.2, 0.1}) {
        const Task task = raster(ball, most);
        measure("ball, lines only", task, h, WithColumns::no, 0);
        measure("ball, lines and outer model", task, h, WithColumns::yes, 0);
        measure("  in batches, one thread", task, h, WithColumns::yes, 1);
        measure("  in batches, two threads", task, h, WithColumns::yes, 2);
        if (!quick) measure_error(task, h);
    }
    const size_t few = quick ? 2000 : 20000;
    measure("flat", raster({{{0, 3, 30, 3, 0}}}, few), 0.2, WithColumns::no, 0);
    measure("bull", raster({{{1, 2, 1, 2, 1}, {1, 3, 30, 3, 0}}}, few), 0.2, WithColumns::no, 0);
    measure("taper", raster({{{0, 1, 10, 3, 0}, {10, 3, 30, 3, 0}}}, few), 0.2, WithColumns::no, 0);
    measure("form", raster({{{0, 3, 2, 1, 0}, {2, 1, 30, 1, 0}}}, few), 0.2, WithColumns::no, 0);
    measure("helices, flat, in chords", helices(), 0.2, WithColumns::no, 0);
}
