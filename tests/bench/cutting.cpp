#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>

#include "tests/support/raster_program.h"

using namespace core;

int main(int argc, char** argv) {
    const double h = argc > 1 ? std::atof(argv[1]) : 0.5;
    const size_t most = argc > 2 ? std::strtoul(argv[2], nullptr, 10) : 1000000;
    const auto program = test_support::raster_program();
    auto sweeps = test_support::sweeps_of(program, test_support::raster_ball());
    if (sweeps.size() > most) sweeps.resize(most);
    const bool columns = argc > 3 && argv[3][0] == 'c';
    CutModel model = make_cut_model({SolidBox{program.stock}, 0.0}, h, default_memory_limit,
                                    columns ? WithColumns::yes : WithColumns::no)
                         .value();
    const clock_t start = clock();
    double removed = 0.0;
    for (const CutterSweep& sweep : sweeps) removed += cut(model, sweep);
    const double seconds = static_cast<double>(clock() - start) / CLOCKS_PER_SEC;
    std::printf("h %.2f: %zu blocks, %.3f s, %.0f blocks/s, removed %.6f\n", h, sweeps.size(),
                seconds, static_cast<double>(sweeps.size()) / seconds, removed);
}
