#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "tests/fuzz/chosen_program.h"
#include "tests/fuzz/import_runs.h"
#include "tests/fuzz/program_runs.h"

namespace test_support {
namespace {

std::vector<std::vector<uint8_t>> inputs_of(const std::string& folder) {
    std::vector<std::filesystem::path> paths;
    const auto root = std::filesystem::path(FEELER_SOURCE_DIR) / "tests/fuzz/seeds" / folder;
    for (const auto& entry : std::filesystem::directory_iterator(root))
        paths.push_back(entry.path());
    std::sort(paths.begin(), paths.end());
    std::vector<std::vector<uint8_t>> inputs;
    for (const auto& path : paths) {
        std::ifstream stream(path, std::ios::binary);
        inputs.emplace_back(std::istreambuf_iterator<char>(stream),
                            std::istreambuf_iterator<char>());
    }
    return inputs;
}

TEST(FuzzSeeds, BytesKeepEveryPromise) {
    const auto inputs = inputs_of("bytes");
    ASSERT_FALSE(inputs.empty());
    for (const auto& input : inputs) run_any_bytes(input);
}

TEST(FuzzSeeds, ChosenProgramsKeepEveryPromise) {
    const auto inputs = inputs_of("programs");
    ASSERT_FALSE(inputs.empty());
    for (const auto& input : inputs) run_chosen_program(input);
}

TEST(FuzzSeeds, ImportsKeepEveryPromise) {
    const auto inputs = inputs_of("imports");
    ASSERT_FALSE(inputs.empty());
    for (const auto& input : inputs) run_any_import(input);
}

TEST(FuzzSeeds, RandomChoicesKeepEveryPromise) {
    std::mt19937 random(20100613);
    for (int round = 0; round < 4000; ++round) {
        std::vector<uint8_t> choices(20 + random() % 400);
        for (uint8_t& choice : choices) choice = static_cast<uint8_t>(random());
        run_chosen_program(choices);
    }
}

TEST(FuzzSeeds, ChosenProgramsAreMostlyRun) {
    std::mt19937 random(7);
    std::vector<uint8_t> choices(300);
    for (uint8_t& choice : choices) choice = static_cast<uint8_t>(random());
    EXPECT_GT(chosen_program(choices).text.size(), 300u);
}

} // namespace
} // namespace test_support
