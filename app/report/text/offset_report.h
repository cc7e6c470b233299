#pragma once

#include <string>
#include <vector>

namespace app {

struct OffsetComparison;

/// The names of what was compared.
struct ComparedFiles {
    std::string setup;                // path; empty: inferred from the program
    std::vector<std::string> control; // paths
};

/// A set-up compared with its control, as a table in mm and degrees.
std::string offset_text(const OffsetComparison& comparison, const ComparedFiles& files);

/// The same as one JSON object, schema 1.
std::string offset_json(const OffsetComparison& comparison, const ComparedFiles& files);

} // namespace app
