#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/setup/presets/preset.h"
#include "core/base/vec.h"
#include "core/distance/body_distance.h"
#include "core/sim/setup.h"

namespace core {
struct CadBody;
struct CadNames;
} // namespace core

namespace app {

class TableReader;
struct SetupFile;

/// When a body that is a frame moves during the program, and where it is then.
struct FrameMove {
    core::FixtureMove when; // line or code
    core::Transform machine_from_body;
    bool is_removed = false;
};

/// Poses of named frames in the machine: "machine", the work offsets, the bodies read so far.
struct NamedFrames {
    std::map<std::string, core::Transform> machine_from;
    std::map<std::string, std::vector<FrameMove>> moves; // of those that move

    std::optional<core::Transform> find(const std::string& name) const {
        const auto found = machine_from.find(name);
        if (found == machine_from.end()) return std::nullopt;
        return found->second;
    }
};

/// The folder of a table's meshes, and the list that receives notes about repairs and presets.
struct MeshSource {
    std::filesystem::path folder; // for relative paths
    std::vector<std::string>& assumptions;
    std::shared_ptr<core::CadNames>* cad_names = nullptr; // receives those of CAD files
};

/// Context shared by the readers of bodies.
struct BodyContext {
    std::filesystem::path folder; // for relative mesh paths
    NamedFrames frames;
    SetupFile& file;
    bool has_only_stock = false; // neither fixtures nor a part stand in the same frame

    MeshSource meshes();
};

/// A mesh, and how far it may be from the true surface, mm.
struct BodyMesh {
    core::Mesh mesh;
    double deviation = 0.0;
};

/// "meshed within 0.008 mm of its surface (proven)".
std::string meshed_text(const core::CadBody& body);

/// Reads the mesh file that a key of a table names, in mm. A mesh file has no unit of its own:
/// `mesh_unit` gives it. Of a CAD file, `solid` and `mesh_deviation` say what is wanted. Relative
/// paths are relative to the set-up. Empty after an error.
std::optional<BodyMesh> read_mesh_file(TableReader& table, const char* key,
                                       const MeshSource& source);

/// A body, and how far it may be from the true one, mm.
struct DeviatingBody {
    core::ExactBody body;
    double deviation = 0.0;
};

/// Reads the parameters of a preset that a table states. Refuses values out of their range.
PresetValues read_preset_values(TableReader& table, const Preset& preset);

/// Reads a body: its box, cylinder, mesh or preset, with `at` and `rotate_deg`; empty after an
/// error.
std::optional<DeviatingBody> read_exact_body(TableReader& table, const MeshSource& source,
                                             const core::Transform& target_from_frame);

/// Reads `[stock]`. The frame of the stock becomes the frame of everything else.
void read_stock(TableReader& table, BodyContext& context);

/// Reads `[part]`. The stock must have been read.
void read_part(TableReader& table, BodyContext& context);

/// Requests a stock inferred from the program, in the frame of G54.
void infer_stock(BodyContext& context);

/// Why a fixture cannot have this name, to follow the name in a sentence: it is that of a frame, in
/// capitals or not, of the part, or of a kind of body. Empty if it can.
std::string why_no_fixture_name(const std::string& name);

/// Reads one `[[fixture]]`. The stock must have been read.
void read_fixture(TableReader& table, BodyContext& context);

/// Adds the machine bodies that the tool can reach to the fixtures.
void add_machine_bodies(TableReader& table, core::Setup& setup);

} // namespace app
