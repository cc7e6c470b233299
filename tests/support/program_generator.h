#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/support/program_text.h"

namespace test_support {

/// A part of LinuxCNC's language and the generator of random blocks for it. Each block restores the
/// modes that the head of the program sets, except offsets, tool and the subject of the block.
struct ProgramFeature {
    std::string name;
    void (*write)(ProgramText& text);
};

/// The features of the language by topic.
std::vector<ProgramFeature> motion_features();
std::vector<ProgramFeature> offset_features();
std::vector<ProgramFeature> cycle_features();
std::vector<ProgramFeature> action_features();
std::vector<ProgramFeature> language_features();
std::vector<ProgramFeature> flow_features();

/// The features of all topics.
const std::vector<ProgramFeature>& program_features();

/// A random program with a number of blocks of one feature, or of all ("everything"), with moves in
/// between, ending with M2. The same seed gives the same program.
///
/// Result: mostly valid, as judged by the reference. Empty for a feature that does not exist.
std::string generated_program(const std::string& feature, uint32_t seed, int blocks = 20);

/// A program with usually one error: a word removed, duplicated or changed in letter or value, two
/// lines swapped, a bracket lost.
std::string spoilt_program(const std::string& program, uint32_t seed);

} // namespace test_support
