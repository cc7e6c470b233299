#include "app/setup/search_path.h"

#include <sstream>

namespace app {

std::vector<std::string> split_search_path(const std::string& text) {
    std::istringstream stream(text);
    std::vector<std::string> folders;
    for (std::string folder; std::getline(stream, folder, ':');)
        if (!folder.empty()) folders.push_back(std::move(folder));
    return folders;
}

} // namespace app
