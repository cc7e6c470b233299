#include "app/view/model/samples.h"

#include <algorithm>

#include "app/base/shipped_files.h"
#include "core/base/file_reads.h"
#include "core/base/platform.h"

namespace app::viewer {
namespace {

namespace fs = std::filesystem;

struct ShippedSample {
    const char *program, *setup, *title, *about;
};

constexpr ShippedSample shipped_samples[] = {
    {"clamped_plate_low.nc", "clamped_plate.toml", "Plate under clamps",
     "3 axes; a rapid too low hits the clamps"},
    {"TEST_G90.NC", "test_g90.toml", "Facing and boring", "3 axes; a stud that is too long"},
    {"indexed_flats_g99.nc", "indexed_flats.toml", "Four flats",
     "4 axes; the table turns under the drill"},
    {"tilted_faces_lead_in.nc", "tilted_faces.toml", "Tilted faces",
     "5 axes; a lead-in into the cradle"},
    {"dome_m428.ngc", "dome.toml", "Dome", "5 axes at once; the tip does not follow the work"},
    {"flutes.ngc", "flutes.toml", "Spiral flutes", "5 axes at once; no mistake"},
    {"PARALLEL.NC", "parallel.toml", "Curved surface", "3 axes, inches; no mistake"},
    {"clamped_plate.nc", "clamped_plate.toml", "Plate, corrected", "3 axes; no mistake"},
};

} // namespace

fs::path samples_folder() {
    return shipped_files_with(fs::path("programs") / shipped_samples[0].program);
}

std::vector<Sample> samples_in(const fs::path& folder) {
    std::vector<Sample> found;
    if (folder.empty()) return found;
    for (const ShippedSample& each : shipped_samples) {
        const fs::path program = folder / "programs" / each.program;
        const fs::path setup = folder / "setups" / each.setup;
        if (core::is_file(program) && core::is_file(setup))
            found.push_back(
                {program.generic_string(), setup.generic_string(), each.title, each.about});
    }
    return found;
}

fs::path own_folder() {
    const fs::path documents = core::platform::documents_folder();
    return core::is_folder(documents) ? documents : core::platform::home_folder();
}

bool is_below(const fs::path& path, const fs::path& folder) {
    if (folder.empty() || path.empty()) return false;
    std::error_code failure;
    const fs::path whole = fs::weakly_canonical(fs::absolute(path, failure), failure);
    const fs::path above = fs::weakly_canonical(folder, failure);
    if (failure) return false;
    const auto [end, rest] = std::mismatch(above.begin(), above.end(), whole.begin(), whole.end());
    static_cast<void>(rest);
    return end == above.end();
}

} // namespace app::viewer
