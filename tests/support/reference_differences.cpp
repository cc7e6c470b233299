#include "tests/support/reference_differences.h"

#include <fstream>
#include <sstream>

namespace test_support {
namespace {

/// The cells of a table row, without surrounding blanks and back quotes.
std::vector<std::string> cells_of(const std::string& row) {
    std::vector<std::string> cells;
    std::istringstream stream(row.substr(1));
    for (std::string cell; std::getline(stream, cell, '|');) {
        const size_t first = cell.find_first_not_of(" `");
        const size_t last = cell.find_last_not_of(" `");
        cells.push_back(first == std::string::npos ? "" : cell.substr(first, last - first + 1));
    }
    return cells;
}

ReferenceDifferences read() {
    ReferenceDifferences differences;
    std::ifstream list(FEELER_SOURCE_DIR "/tests/gcode/reference_differences.md");
    for (std::string line; std::getline(list, line);) {
        if (line.empty() || line[0] != '|') continue;
        const std::vector<std::string> cells = cells_of(line);
        if (cells.size() < 3) continue;
        if (cells[0] == "refusal") differences.refusals.push_back(cells[1]);
        if (cells[0] == "program") differences.programs[cells[1]] = cells[2];
    }
    return differences;
}

} // namespace

const ReferenceDifferences& reference_differences() {
    static const ReferenceDifferences differences = read();
    return differences;
}

} // namespace test_support
