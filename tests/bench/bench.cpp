#include <cstdio>
#include <exception>
#include <fstream>

#include <fmt/format.h>

#include "tests/bench/machine.h"
#include "tests/bench/measure.h"

namespace {

/// Collects the results of all scenes for one file.
class Collected final : public benchmark::BenchmarkReporter {
public:
    bool ReportContext(const Context&) override { return true; }
    void ReportRuns(const std::vector<Run>& runs) override { reports_.push_back(runs); }

    void write(std::ofstream& out) const {
        benchmark::JSONReporter json;
        json.SetOutputStream(&out);
        json.ReportContext(Context());
        for (const std::vector<Run>& runs : reports_) json.ReportRuns(runs);
        json.Finalize();
    }

private:
    std::vector<std::vector<Run>> reports_;
};

struct Options {
    std::string out;
    std::string only;
};

/// Reads --out FILE and --only SCENE; the rest goes to Google Benchmark.
Options options(std::vector<char*>& words) {
    Options result;
    int count = static_cast<int>(words.size());
    benchmark::Initialize(&count, words.data());
    for (int i = 1; i < count; ++i) {
        const std::string word = words[static_cast<size_t>(i)];
        if (word != "--out" && word != "--only") throw std::runtime_error("unknown option " + word);
        if (++i == count) throw std::runtime_error(word + " needs a word after it");
        (word == "--out" ? result.out : result.only) = words[static_cast<size_t>(i)];
    }
    return result;
}

void run(const Options& options) {
    for (const auto& [name, value] : bench::machine()) benchmark::AddCustomContext(name, value);
    benchmark::AddCustomContext("challenger", bench::challenger());
    const std::vector<bench::Contestant> contestants = bench::contestants();
    std::vector<bench::Scene> scenes = bench::scenes();
    if (!options.only.empty())
        std::erase_if(scenes, [&](const bench::Scene& s) { return s.name != options.only; });
    if (scenes.empty()) throw std::runtime_error("no scene " + options.only);
    std::ofstream out(options.out);
    if (!out) throw std::runtime_error("--out FILE must name a file that can be written");

    Collected collected;
    for (const bench::Scene& scene : scenes) {
        fmt::print(stderr, "feeler_bench: {}\n", scene.name);
        bench::measure(scene, contestants, collected);
    }
    collected.write(out);
}

} // namespace

int main(int argc, char** argv) try {
    std::vector<char*> words(argv, argv + argc);
    std::string shuffled = "--benchmark_enable_random_interleaving=true";
    words.insert(words.begin() + 1, shuffled.data());
    run(options(words));
    return 0;
} catch (const std::exception& error) {
    fmt::print(stderr, "feeler_bench: {}\n", error.what());
    return 1;
}
