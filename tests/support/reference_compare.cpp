#include <fstream>
#include <iostream>

#include <fmt/format.h>

#include "tests/support/plain_trace.h"
#include "tests/support/program_generator.h"
#include "tests/support/reference_differences.h"
#include "tests/support/reference_interpreter.h"
#include "tests/support/run_difference.h"
#include "tests/support/scoped_folder.h"

// Command line tool: prints the differences between our interpreter and LinuxCNC's.
//     reference_compare FILE...                          programs
//     reference_compare --generate FEATURE SEED COUNT    random programs from a seed on
//     reference_compare --spoil FEATURE SEED COUNT       nearly valid programs
//     reference_compare --print FEATURE SEED             the program of a seed
//     reference_compare --print-spoilt FEATURE SEED      the damaged program of a seed
//     reference_compare --judge COUNT                    share of each feature that is accepted
namespace test_support {
namespace {

std::vector<std::string> generated(const std::string& feature, uint32_t seed, int count,
                                   bool spoilt) {
    std::vector<std::string> programs;
    for (int i = 0; i < count; ++i) {
        const uint32_t own_seed = seed + static_cast<uint32_t>(i);
        std::string program = generated_program(feature, own_seed);
        programs.push_back(spoilt ? spoilt_program(program, own_seed) : program);
    }
    return programs;
}

int compare(const std::vector<std::string>& programs, const std::vector<std::string>& names) {
    const std::vector<PlainRun> reference = run_reference(programs);
    const std::vector<std::string> accepted = reference_differences().refusals;
    size_t equal = 0, total = 0, good = 0;
    for (size_t i = 0; i < programs.size(); ++i) {
        const RunComparison comparison =
            compare_runs(reference[i], run_feeler(programs[i]), accepted);
        equal += comparison.equal, total += comparison.total;
        good += comparison.differences.empty();
        if (!reference[i].problem.empty())
            fmt::print("{}: reference: {}\n", names[i], reference[i].problem);
        if (!comparison.differences.empty())
            fmt::print("{}: {}", names[i], report_of(comparison, programs[i]));
    }
    fmt::print("{} of {} programs and {} of {} commands are equal\n", good, programs.size(), equal,
               total);
    return good == programs.size() ? 0 : 1;
}

int judge(int count) {
    for (const ProgramFeature& feature : program_features()) {
        const auto runs = run_reference(generated(feature.name, 1, count, false));
        int accepted = 0;
        std::string why;
        for (const PlainRun& run : runs) {
            accepted += !run.refused;
            if (run.refused) why = fmt::format("{}: {}", *run.refused, run.message);
            if (!run.problem.empty()) fmt::print("  {}\n", run.problem);
            if (!run.doubt.empty()) fmt::print("  doubt: {}\n", run.doubt);
        }
        fmt::print("{} {} of {} {}\n", feature.name, accepted, count, why);
    }
    return 0;
}

int chosen(const std::vector<std::string>& words) {
    const std::string first = words.empty() ? "" : words[0];
    if (first == "--judge" && words.size() == 2) return judge(std::stoi(words[1]));
    if ((first == "--print" || first == "--print-spoilt") && words.size() == 3) {
        const auto seed = static_cast<uint32_t>(std::stoul(words[2]));
        std::cout << generated(words[1], seed, 1, first == "--print-spoilt").front();
        return 0;
    }
    if ((first == "--generate" || first == "--spoil") && words.size() == 4) {
        const int seed = std::stoi(words[2]), count = std::stoi(words[3]);
        std::vector<std::string> names;
        for (int i = 0; i < count; ++i) names.push_back(fmt::format("{} {}", words[1], seed + i));
        return compare(generated(words[1], static_cast<uint32_t>(seed), count, first == "--spoil"),
                       names);
    }
    std::vector<std::string> programs;
    for (const std::string& path : words) programs.push_back(bytes_of(path));
    return compare(programs, words);
}

} // namespace
} // namespace test_support

int main(int count, char** words) { return test_support::chosen({words + 1, words + count}); }
