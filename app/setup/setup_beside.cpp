#include "app/setup/setup_beside.h"

#include <filesystem>

#include "core/base/file_reads.h"

namespace app {

std::string setup_beside(const std::string& program) {
    const std::filesystem::path setup = std::filesystem::path(program).replace_extension(".toml");
    const bool is_one =
        setup.filename() != project_file_name && setup != program && core::is_there(setup);
    return is_one ? setup.string() : std::string();
}

} // namespace app
