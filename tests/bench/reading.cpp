#include <filesystem>
#include <fstream>
#include <random>
#include <string>

#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <unistd.h>

#include "gcode/exec/interpreter.h"
#include "gcode/language/dialect.h"
#include "gcode/language/environment.h"
#include "gcode/text/source.h"

namespace {

constexpr int line_count = 1'000'000;

enum class Lines { plain, modal, numbered };

/// A program of random straight moves in a temporary file.
class ProgramFile {
public:
    explicit ProgramFile(Lines lines)
        : path_(std::filesystem::temp_directory_path()
                / fmt::format("feeler-bench-{}-{}.nc", ::getpid(), static_cast<int>(lines))) {
        std::mt19937 random(1);
        const auto length = [&](int limit) {
            return static_cast<int>(random() % static_cast<unsigned>(2000 * limit)) / 1000.0
                   - limit;
        };
        std::ofstream out(path_, std::ios::binary);
        out << "G21 G90 G17\nF500\nG1\n";
        for (int line = 1; line <= line_count; ++line) {
            const double x = length(100), y = length(100), z = length(5);
            if (lines == Lines::plain) out << fmt::format("G1 X{:.4f} Y{:.4f} Z{:.4f}\n", x, y, z);
            if (lines == Lines::modal) out << fmt::format("X{:.3f}Y{:.3f}\n", x, y);
            if (lines == Lines::numbered)
                out << fmt::format("N{} G1 X{:.3f} Y{:.3f} Z{:.3f} F800.\n", line, x, y, z);
        }
        out << "M30\n";
    }
    ~ProgramFile() { std::filesystem::remove(path_); }
    ProgramFile(const ProgramFile&) = delete;
    ProgramFile& operator=(const ProgramFile&) = delete;

    const std::filesystem::path& path() const { return path_; }

private:
    std::filesystem::path path_;
};

/// Reads the file and runs every block; the commands are discarded.
size_t read_through(const std::string& path, gcode::DialectId dialect, benchmark::State& bench) {
    const auto program = gcode::open_program(path);
    if (!program) {
        bench.SkipWithError(program.error().message.c_str());
        return 0;
    }
    gcode::Environment environment;
    environment.dialect = dialect;
    gcode::ProgramLibrary library(*program, gcode::dialect(dialect));
    gcode::Interpreter interpreter(library, environment);
    gcode::InterpreterState state = gcode::initial_state(environment);
    size_t commands = 0;
    while (true) {
        const auto block = interpreter.next(state);
        if (!block) bench.SkipWithError(block.error().message.c_str());
        if (!block || !*block) return commands;
        commands += (*block)->commands.size();
    }
}

void read_program(benchmark::State& bench, Lines lines, gcode::DialectId dialect) {
    const ProgramFile file(lines);
    for (auto _ : bench) benchmark::DoNotOptimize(read_through(file.path(), dialect, bench));
    bench.SetItemsProcessed(bench.iterations() * line_count);
}

BENCHMARK_CAPTURE(read_program, plain_linuxcnc, Lines::plain, gcode::DialectId::linuxcnc)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(read_program, modal_linuxcnc, Lines::modal, gcode::DialectId::linuxcnc)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(read_program, plain_fanuc, Lines::plain, gcode::DialectId::fanuc)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(read_program, numbered_fanuc, Lines::numbered, gcode::DialectId::fanuc)
    ->Unit(benchmark::kMillisecond);

} // namespace

BENCHMARK_MAIN();
