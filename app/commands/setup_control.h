#pragma once

#include <string>
#include <vector>

#include "app/commands/commands.h"
#include "core/base/result.h"

namespace app {

struct CheckJob;
struct OffsetComparison;
struct ProgramArguments;

/// The options of `feeler setup` that compare a set-up with its control.
struct ControlArguments {
    std::vector<std::string> files; // from the control; empty: nothing is compared
    std::string setup, format = "text";
};

/// Adds these options to a command. `arguments` must outlive it.
void add_control_arguments(CLI::App& command, ControlArguments& arguments);

/// Compares the offsets of a set-up with those in files from the control.
core::Result<OffsetComparison> comparison_of(const CheckJob& job,
                                             const std::vector<std::string>& files);

/// Compares the set-up of a program with files from the control, and writes the result to a file,
/// or to standard output if `output` is empty.
///
/// Result: `findings` if a value differs.
/// Errors: those of the program, the set-up and the files.
core::Result<ExitCode> compare_with_control(const std::string& program,
                                            const ProgramArguments& reading,
                                            const ControlArguments& arguments,
                                            const std::string& output);

} // namespace app
