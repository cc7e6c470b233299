#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/support/program_text.h"

namespace test_support {

/// A part of LinuxCNC's language, and how random blocks of it are written: each leaves the modes
/// as the head of a program sets them, but for offsets, tool and what a block is about.
struct ProgramFeature {
    std::string name;
    void (*write)(ProgramText& text);
};

/// The parts of the language, a table for each topic.
std::vector<ProgramFeature> motion_features();
std::vector<ProgramFeature> offset_features();
std::vector<ProgramFeature> cycle_features();
std::vector<ProgramFeature> action_features();
std::vector<ProgramFeature> language_features();
std::vector<ProgramFeature> flow_features();

/// All of them.
const std::vector<ProgramFeature>& program_features();

/// A random program of so many blocks of one feature, or of all ("everything"), with moves between
/// them, that ends with M2. The same seed, the same program.
///
/// Result: mostly valid; the reference is the judge. Empty for a feature that does not exist.
std::string generated_program(const std::string& feature, uint32_t seed, int blocks = 20);

/// A program with one thing wrong, mostly: a word dropped, doubled, changed in letter or value, two
/// lines swapped, a bracket lost.
std::string spoilt_program(const std::string& program, uint32_t seed);

} // namespace test_support
