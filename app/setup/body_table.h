#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/base/vec.h"
#include "core/distance/body_distance.h"

namespace core {
struct Setup;
}

namespace app {

class TableReader;
struct SetupFile;

/// Where named frames stand in the machine: "machine", the work offsets, the bodies so far.
struct Frames {
    std::map<std::string, core::Transform> machine_from;

    std::optional<core::Transform> find(const std::string& name) const {
        const auto found = machine_from.find(name);
        if (found == machine_from.end()) return std::nullopt;
        return found->second;
    }
};

/// Where the meshes of a table come from, and where it is said what had to be repaired.
struct MeshSource {
    std::filesystem::path folder; // that relative paths start from
    std::vector<std::string>& assumptions;
};

/// What the readers of bodies share.
struct BodyContext {
    std::filesystem::path folder; // that relative mesh paths start from
    Frames frames;
    SetupFile& file;

    MeshSource meshes();
};

/// A body by its box, cylinder or mesh, and its `at` and `rotate_deg`; empty after a mistake.
std::optional<core::ExactBody> read_exact_body(TableReader& table, const MeshSource& source,
                                               const core::Transform& target_from_frame);

/// Reads `[stock]`: the stock's frame becomes the frame of everything else.
void read_stock(TableReader& table, BodyContext& context);

/// Reads `[part]`. The stock must have been read.
void read_part(TableReader& table, BodyContext& context);

/// A stock that is inferred from the program, in the frame of G54.
void infer_stock(BodyContext& context);

/// Reads one `[[fixture]]`. The stock must have been read.
void read_fixture(TableReader& table, BodyContext& context);

/// Adds the machine's own bodies that the tool can meet to the fixtures.
void add_machine_bodies(TableReader& table, core::Setup& setup);

} // namespace app
