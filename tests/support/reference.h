#pragma once

#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/shell.h"

namespace test_support {

/// A motion of LinuxCNC's interpreter as its canonical call: lengths in mm, in program coordinates.
struct ReferenceMotion {
    std::string call;           // straight_traverse, straight_feed, arc_feed, rigid_tap
    std::vector<double> values; // X Y Z; of an arc: ends, centres, turns and the normal axis
};

struct ReferenceRun {
    std::vector<ReferenceMotion> motions;
    std::string refusal; // empty: ran to its end; else the reason
};

inline bool reference_is_installed() {
    return std::filesystem::exists("/usr/bin/rs274") && std::filesystem::exists("/usr/bin/python3");
}

/// Runs programs, whose lines must end in M2, with LinuxCNC's interpreter. Some of its cycles never
/// end: the programs at the indices `may_be_endless` count as refused after a short time.
inline std::vector<ReferenceRun> run_reference(const std::vector<std::string>& programs,
                                               const std::vector<size_t>& may_be_endless = {}) {
    const ScopedFolder folder;
    std::string all;
    for (const std::string& program : programs) all += (all.empty() ? "" : "---\n") + program;
    const std::string script = FEELER_SOURCE_DIR "/tests/support/reference.py";
    std::vector<std::string> command = {"/usr/bin/python3", script, folder.write("programs", all)};
    for (const size_t index : may_be_endless) command.push_back(std::to_string(index));
    const Ran ran = run(command);
    std::vector<ReferenceRun> runs;
    std::istringstream lines(ran.out);
    for (std::string line; std::getline(lines, line);) {
        std::istringstream words(line);
        std::string call;
        words >> call;
        if (call == "program")
            runs.emplace_back();
        else if (call == "refused")
            runs.back().refusal = line.substr(8);
        else if (!call.empty() && call != "ended") {
            ReferenceMotion motion{call, {}};
            for (double value; words >> value;) motion.values.push_back(value);
            runs.back().motions.push_back(motion);
        }
    }
    return runs;
}

} // namespace test_support
