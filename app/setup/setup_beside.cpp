#include "app/setup/setup_beside.h"

#include <filesystem>

namespace app {

std::string setup_beside(const std::string& program) {
    const std::filesystem::path setup = std::filesystem::path(program).replace_extension(".toml");
    std::error_code ignored;
    const bool is_one = setup.filename() != project_file_name && setup != program
                        && std::filesystem::is_regular_file(setup, ignored);
    return is_one ? setup.string() : std::string();
}

} // namespace app
