#include "tests/bench/machine.h"

#include <fstream>
#include <thread>

namespace bench {
namespace {

#ifdef __clang__
constexpr const char* compiler = __VERSION__;
#else
constexpr const char* compiler = "g++ " __VERSION__;
#endif

/// The text after the colon in the first line of a file that starts with `key`.
std::string value_in(const std::string& file, const std::string& key) {
    std::ifstream in(file);
    for (std::string line; std::getline(in, line);) {
        if (!line.starts_with(key)) continue;
        const size_t from = line.find_first_not_of(" \t\"", line.find_first_of(":=") + 1);
        if (from != std::string::npos) return line.substr(from, line.find('"', from) - from);
    }
    return "unknown";
}

std::string vector_instructions() {
#if defined(__x86_64__)
    if (__builtin_cpu_supports("avx512bw")) return "AVX-512";
    if (__builtin_cpu_supports("avx2")) return "AVX2";
    if (__builtin_cpu_supports("avx")) return "AVX";
    if (__builtin_cpu_supports("sse4.2")) return "SSE4.2";
    return "SSE2";
#else
    return "unknown";
#endif
}

} // namespace

std::vector<std::pair<std::string, std::string>> machine() {
    std::vector<std::pair<std::string, std::string>> facts = {
        {"cpu", value_in("/proc/cpuinfo", "model name")},
        {"cores", std::to_string(std::thread::hardware_concurrency())},
        {"simd", vector_instructions()},
        {"system", value_in("/etc/os-release", "PRETTY_NAME")},
        {"compiler", compiler},
    };
#ifdef FEELER_BENCH_FCL
    facts.emplace_back("fcl", FEELER_BENCH_FCL);
#endif
#ifdef FEELER_BENCH_NANOFLANN
    facts.emplace_back("nanoflann", FEELER_BENCH_NANOFLANN);
#endif
#ifdef FEELER_BENCH_EMBREE
    facts.emplace_back("embree", FEELER_BENCH_EMBREE);
#endif
    return facts;
}

} // namespace bench
