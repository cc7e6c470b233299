#include "app/base/shipped_files.h"

#include "core/base/file_reads.h"
#include "core/base/platform.h"

namespace app {

std::filesystem::path shipped_files_with(const std::filesystem::path& file) {
    namespace fs = std::filesystem;
    const fs::path program = core::platform::program_path().parent_path();
    if (program.empty()) return {};
    for (const fs::path& folder :
         {program.parent_path() / "share/feeler", program / "share/feeler"})
        if (core::is_file(folder / file)) return folder;
    fs::path above = program;
    for (int i = 0; i < 5; ++i, above = above.parent_path())
        if (core::is_file(above / "assets" / file)) return above / "assets";
    return {};
}

} // namespace app
